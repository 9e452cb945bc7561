// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/diagnostics.hpp"
#include "kernel/scene/object_reader.hpp"
#include "kernel/scene/scene.hpp"
#include "kernel/scene/scene_reader.hpp"

/// The parts of read_scene, one per top-level key of a scene. Each reads its value into the Scene
/// and adds every mistake; none throws.
namespace suture::scene_parts {

struct Reading {
  Scene& scene;
  std::filesystem::path folder;          ///< of the scene file
  std::filesystem::path working_folder;  ///< the output folder is relative to it
  std::filesystem::path resumed_folder;  ///< that of the checkpoint, if output goes there
  const ModelLookup& lookup;
  Mistakes& mistakes;
  Diagnostics& diagnostics;

  void warn(const JsonPosition& at, const std::string& path, const std::string& text) const {
    diagnostics.warn(mistakes.place(at) + ": " + path + ": " + text);
  }
};

void read_sets(ObjectReader& top, Reading& reading);
Selection read_selection(const JsonValue& value, const std::string& path, Mistakes& mistakes);
/// Two selections of elements, the value of `key` in `object`.
std::optional<std::array<Selection, 2>> read_two_regions(const JsonValue& value,
                                                         ObjectReader& object,
                                                         const std::string& key);
/// A direction: three numbers that are not all zero.
std::optional<Vec3> read_direction(ObjectReader& object, const std::string& key);
/// A required vector of any length.
Vec3 require_vector(ObjectReader& object, const std::string& key, const std::string& unit,
                    const std::string& what);
TimeRamp read_ramp(const JsonValue& value, const std::string& path, Mistakes& mistakes);
/// Reads every object of the array at `key`, if present.
void for_each_object(ObjectReader& parent, const std::string& key, const std::string& of_what,
                     const std::function<void(ObjectReader&)>& read);
/// A file that must exist, relative to the scene's folder, as an absolute path.
std::filesystem::path read_file(const JsonValue& value, const std::string& path, Reading& reading);
/// The keys "file", "scale" and "translation" of a surface.
struct SurfaceFile {
  std::filesystem::path file{};
  double scale = 1;
  Vec3 translation{};  ///< m, after scaling
};
SurfaceFile read_surface_file(ObjectReader& surface, Reading& reading);
/// Points [[x, y, z], ...] in m, at least `least` of them.
std::vector<Vec3> read_points(const JsonValue& value, const std::string& path, std::size_t least,
                              Mistakes& mistakes);
/// What pairs of numbers [x, y] must be, and how messages name them.
struct PairRules {
  const char* pairs;     ///< "pairs [time, value]"
  const char* pair;      ///< "a time in s and a value"
  const char* order;     ///< what a pair breaks whose x is not larger than the x before
  Limits first, second;  ///< of x and y
};
/// Pairs [[x, y], ...] with ascending x, at least two.
std::vector<std::array<double, 2>> read_ascending_pairs(const JsonValue& value,
                                                        const std::string& path,
                                                        const PairRules& rules, Mistakes& mistakes);
/// A box {"min", "max"} in m.
Selection::InBox read_box(ObjectReader box);
/// Pairs of element numbers [[4, 5], ...].
std::vector<std::array<std::uint64_t, 2>> read_pairs(const JsonValue& value,
                                                     const std::string& path, Mistakes& mistakes);
/// The range of a parameter.
Limits limits_of(const suture_parameter& parameter);
/// Reads a parameter that is a direction or given by an array or a table; false if it is neither.
bool read_parameter_values(ObjectReader& parameters, const suture_parameter& parameter,
                           ModelUse& use);
/// The required value of elements at `key`: one number, or a table over regions.
CellValues read_element_values(ObjectReader& object, const std::string& key, const Limits& limits,
                               const std::string& what);
/// The start of the model's attributes, "start".
void read_start(ObjectReader& model, ModelUse& use);
/// Checks a name that becomes part of file and field names.
bool is_good_name(std::string_view name);

/// "on_inversion": "stop" or "warn"; by_model if absent.
OnInversion read_on_inversion(ObjectReader& object);
/// "on_failure": "skip" or "stop"; by_solver if absent.
OnFailure read_on_failure(ObjectReader& object);

void read_mesh(const JsonValue& value, Reading& reading);
void read_models(ObjectReader& top, Reading& reading);
/// Parameters of a model that change during a run.
void read_changes(ObjectReader& object, const suture_model& model, std::vector<double>& values);
/// A station {"at", "translation", "angle"} of a path, which must be later than `previous`, unless
/// that is null.
RigidPath::Station read_pose(ObjectReader& object, const RigidPath::Station* previous);
/// A key that names components: "xz" gives the bits 1 and 4, no key gives all three.
std::uint8_t read_components(ObjectReader& object, const char* key);

/// The key "move" of a constraint, its "ramp" and its "components".
void read_motion(ObjectReader& object, Reading& reading, Constraint& constraint);
void read_gravity(ObjectReader& top, Reading& reading);
void read_initial_motion(ObjectReader& top, Reading& reading);
void read_foundations(ObjectReader& top, Reading& reading);
void read_constraints(ObjectReader& top, Reading& reading);
void read_loads(ObjectReader& top, Reading& reading);
void read_solver(const JsonValue& value, Reading& reading);
/// After read_models and read_solver: models declare fields, and not every solver follows them.
void read_field_conditions(ObjectReader& top, Reading& reading);
/// After read_solver: not every solver sees obstacles.
void read_contact(ObjectReader& top, Reading& reading);
/// The operations of an event (read_cut.cpp, read_operations.cpp).
EventOperation read_cut(ObjectReader cut, Reading& reading);
Pierce read_pierce(ObjectReader pierce);
Tear read_tear(ObjectReader tear, Reading& reading);
SewFaces read_suture(ObjectReader suture);
RemoveIslands read_remove_islands(ObjectReader remove);
/// Grasps (read_grasp.cpp).
Grasp read_grasp(ObjectReader grasp, Reading& reading);
/// The key "name" of a grasp or a constraint.
std::string read_name(ObjectReader& object);
/// After all events: names of grasps differ, and events release what there is.
void check_grasps(ObjectReader& top, const Scene& scene);
/// After read_solver and read_models: events must lie within the run, and may refer to fields that
/// a model declares.
void read_events(ObjectReader& top, Reading& reading);
/// After read_events: cuts along blades make islands of any size.
void read_debris(ObjectReader& top, Reading& reading);
/// An event without a time.
Event read_event_now(ObjectReader& object, Reading& reading);
/// After read_models: models add their own fields.
void read_output(const JsonValue* value, Reading& reading);
/// After read_solver and read_output.
void read_checkpoint(const JsonValue* value, Reading& reading);

}  // namespace suture::scene_parts
