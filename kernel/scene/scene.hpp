// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernel/base/types.hpp"
#include "kernel/dynamics/motion_path.hpp"
#include "kernel/dynamics/step_budget.hpp"
#include "kernel/forces/load_profile.hpp"
#include "kernel/forces/time_ramp.hpp"
#include "kernel/geometry/obstacle.hpp"
#include "kernel/images/label_image.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh.hpp"
#include "kernel/mesh/voxels.hpp"
#include "kernel/parts/fill_surface.hpp"
#include "kernel/scene/cell_values.hpp"
#include "kernel/scene/constraint.hpp"
#include "kernel/scene/event.hpp"
#include "kernel/scene/field_condition.hpp"
#include "kernel/scene/initial_motion.hpp"
#include "kernel/scene/scene_places.hpp"
#include "kernel/scene/selection.hpp"
#include "kernel/topology/import.hpp"
#include "suture/plugin.h"

namespace suture {

/// The checked contents of a scene file: plain data, nothing built. Every member that can still
/// turn out to be wrong (an empty selection) holds its JSON path.

/// A body that is filled with hexahedra up to its boundary.
struct FilledBody {
  std::filesystem::path file;  ///< absolute: a closed surface, or
  bool is_shape = false;       ///< cells of any kind (read_shape()), or
  LabelNames labels = {};      ///< unless empty: a label image, the named regions of it
  CubeSize size;
  bool repair = false;  ///< fill holes, accept sheets that cross each other
};

struct MeshSource {
  std::optional<BoxOptions> box;       ///< or
  std::optional<VoxelOptions> voxels;  ///< or
  std::optional<FilledBody> filled;    ///< or
  std::shared_ptr<const Mesh> given;   ///< by the program that runs the scene, or
  std::filesystem::path file;          ///< absolute
  /// Factor of the coordinates in a file; without it, 1, or what an image states.
  std::optional<double> scale;
  bool drop_bad_elements = false;
  double merge = 0;  ///< m: points of a file that are so near to each other become one; 0: none do
  ImportOptions import;
};

/// What happens when an element inverts.
enum class OnInversion { by_model, stop, warn };

struct ModelUse {
  std::string name;  ///< name of the instance; default: the id, id-2, ...
  const suture_model* model = nullptr;
  std::vector<double> parameters;  ///< in declared order, defaults filled in; NaN: in `values`
  std::vector<CellValues> values;
  Selection region;
  /// In place of a region, if the model acts on lips.
  std::optional<std::array<Selection, 2>> between{};
  std::string over{};  ///< an earlier model, which this one replaces where both are; or none
  bool adds = false;   ///< its mass and forces add to those of earlier models
  OnInversion on_inversion = OnInversion::by_model;  ///< takes precedence over the solver's
  std::string path;
};

/// A set that a scene defines, of nodes or elements.
struct NamedSelection {
  std::string name;
  Selection where;
};

/// Springs and dampers between faces and the ground (kernel/forces/foundations.hpp).
struct Foundation {
  double normal = 0, tangential = 0;  ///< Pa/m
  double damping = 0;                 ///< Pa s/m
  Selection where;
};

struct Load {
  enum class Kind {
    force,
    traction,
    pressure,
    volume
  };  ///< N in total, Pa, Pa (inward, follows the surface), Pa per relative change of the volume
  Kind kind = Kind::force;
  Vec3 value{};
  double pressure = 0;
  LoadProfile profile;  ///< of a traction or a pressure
  Selection where;
  TimeRamp ramp;
};

/// What bodies touch.
struct ContactOptions {
  std::vector<Obstacle> obstacles;
  bool pieces = false;  ///< separate pieces and the lips of cuts touch each other, too
  bool self = false;    ///< everything does
  double friction = 0;  ///< between pieces
  bool is_wanted() const { return pieces || !obstacles.empty(); }
  double thickness = 0;  ///< m: the distance that the body keeps from them
  bool penalty = false;  ///< obstacles push with springs (PenaltyForces), not with impulses
};

struct SolverOptions {
  std::string integrator = "symplectic-euler";
  std::optional<double> dt;  ///< s; none: "auto"
  double safety = 0.8;       ///< of the stable step, for "auto"
  /// The error of a step, relative to the largest displacement: for "auto" steps chosen by their
  /// error.
  std::optional<double> step_error;
  std::optional<double> end;  ///< s
  bool until_rest = false;
  double tolerance = 1e-6;           ///< of the residual, for rest
  double step_tolerance = 1e-8;      ///< of the equations of a step, for implicit integrators
  std::optional<double> softness;    ///< of "xpbd", for "auto"
  bool compensate = false;           ///< "xpbd": cells are stiffer by what steps leave out
  std::optional<StepBudget> budget;  ///< of a step, for implicit Euler
  bool hold_free_pieces = false;     ///< static equilibria: by inertia relief; false: refuse them
  bool follow_path = false;          ///< static equilibria: through limit points
  double kick = 0;                   ///< m, along an unstable mode at rest; 0: none
  std::uint64_t max_steps = 0;       ///< 0: no limit, except for rest (10 million)
  double damping = 0;                ///< 1/s, mass-proportional: f = -damping m v
  bool automatic_damping = false;    ///< with until_rest
  unsigned threads = 0;              ///< 0: as many as are useful
  double sleep_acceleration = 0;     ///< m/s^2; 0: no island sleeps
  double sleep_velocity = 0;         ///< m/s
  OnInversion on_inversion = OnInversion::by_model;
  OnFailure on_failure = OnFailure::skip;  ///< of an event
};

/// Which islands are too small to be computed, and what becomes of them.
struct DebrisOptions {
  bool removes = false;
  double fraction = 0.1;           ///< below: of the volume of a typical element; or
  std::optional<double> volume{};  ///< below, m^3
};

/// One or more columns of probes.csv: fields over some nodes (or elements).
struct Probe {
  enum class Of { mean, sum, min, max };
  std::string name;
  Selection where;
  std::vector<std::string> fields{};  ///< none: position, displacement and force
  std::optional<Of> of{};             ///< none: the sum of force and reaction, the mean of others
  std::string path{};                 ///< "/output/probes/at/0"
  bool at_point = false;  ///< `where` is a node; element fields use the elements around it
};

struct OutputOptions {
  bool enabled = true;
  std::filesystem::path directory;  ///< absolute; default: out/NAME in the working folder
  std::filesystem::path root{};     ///< no link is followed below it; empty: links are followed
  bool on_request = false;          ///< the program that runs the scene may ask for any field
  bool frames = true;               ///< false: tables only
  bool pieces = false;              ///< each process writes a piece of each frame
  double every = 0;                 ///< s between frames; 0: first and last only
  std::uint64_t every_steps = 0;    ///< instead of seconds
  std::vector<std::string> fields;  ///< "displacement", ...
  enum class Compression { off, lz4, zlib };
  Compression compression = Compression::lz4;
  std::uint64_t energies_every = 0;  ///< steps; 0: no energies.csv
  std::uint64_t probes_every = 0;
  std::vector<Probe> probes;
  bool springs = false;           ///< springs_NNNN.vtu: edges with the fields of models
  bool faces = false;             ///< faces_NNNN.vtu: faces with the fields of models
  std::uint64_t tools_every = 0;  ///< steps; 0: no tools.csv
  bool obstacles = false;         ///< obstacles_NNNN.vtu: the obstacles at the time of a frame
  bool cuts = false;              ///< cuts_NNNN.vtu: faces that cuts and tears opened, and blades
  bool surface = false;           ///< surface_NNNN.vtu: that of a body made from a surface
};

/// When checkpoints are written, in addition to that of an interrupted run.
struct CheckpointOptions {
  bool enabled = false;
  std::uint64_t every_steps = 0;  ///< or
  double every = 0;               ///< s of simulated time; or
  double minutes = 0;             ///< of wall-clock time
  unsigned keep = 2;              ///< number of files kept
};

/// The complete source of a scene, from which the same scene can be read in any working folder.
struct SceneSource {
  std::string text;            ///< JSON, after --set
  std::filesystem::path file;  ///< absolute; mesh and plugin files are relative to its folder
  std::filesystem::path working_folder;  ///< absolute; the output folder is relative to it
  /// That of the checkpoint from which a run is resumed: output goes there unless --output is
  /// given.
  std::filesystem::path resumed_folder{};
};

struct Scene {
  std::string title;
  std::filesystem::path file;
  /// The text after --set in canonical form, without threads, checkpoints and the output folder,
  /// which change no result; "" for a scene that a program has put together.
  std::string text_that_counts;
  std::string hash;  ///< of it, and of a mesh that a program gives
  MeshSource mesh;
  std::vector<NamedSelection> sets;  ///< each may use earlier ones
  std::vector<ModelUse> models;
  Vec3 gravity{};  ///< m/s^2
  TimeRamp gravity_ramp;
  std::vector<Constraint> constraints;
  std::vector<InitialMotion> initial_motion;
  std::vector<Foundation> foundations;
  std::vector<Load> loads;
  std::vector<FieldCondition> fields;
  ContactOptions contact;
  std::vector<Event> events;       ///< by time (Event::start)
  bool cuts_follow_blade = false;  ///< unless they say "along": version 2 of the format
  bool is_divisible = false;       ///< models are prepared for cuts along blades that are added
  DebrisOptions debris;
  SolverOptions solver;
  OutputOptions output;
  CheckpointOptions checkpoint;
  std::vector<std::filesystem::path> files;  ///< meshes, surfaces and tables that it names
  SceneSource source;
  ScenePlaces places;

  /// Whether it has cuts along blades, which leave parts of elements, or may get them.
  bool divides_elements() const {
    return is_divisible || std::ranges::any_of(events, &Event::is_along_blade);
  }
  /// Whether cuts that programs add to the run follow the blade unless they say "along".
  bool added_cuts_follow_blade() const { return cuts_follow_blade && divides_elements(); }
};

}  // namespace suture
