// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <random>
#include <vector>

#include "kernel/dynamics/body.hpp"
#include "kernel/model_check/cell_batch.hpp"
#include "kernel/model_check/parameter_sets.hpp"

namespace suture {

/// The rest shapes of the elements of a sample.
enum class SampleShape { boxes, parallelepipeds, hexahedra, parts, general_parts };
inline constexpr const char* sample_shapes[] = {"boxes", "parallelepipeds", "general hexahedra",
                                                "parts of parallelepipeds",
                                                "parts of general hexahedra"};
inline bool is_of_parts(SampleShape shape) {
  return shape == SampleShape::parts || shape == SampleShape::general_parts;
}
inline bool is_of_general_hexahedra(SampleShape shape) {
  return shape == SampleShape::hexahedra || shape == SampleShape::general_parts;
}

/// What a check is made on: everything about a sample that is chosen.
struct SampleOptions {
  ParameterSet set;
  SampleShape shape = SampleShape::boxes;
  std::uint64_t seed = 1;
  std::array<Vec3, 3> rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< of rest shape and state
  double irregular = 0;  ///< how far one node is moved at rest, in edges
  double scale = 1;      ///< of the rest shape
  double stretch = 1;    ///< of the state, in all directions
  double time = 0;       ///< s, at which forces of the whole body are computed
  bool halves = false;   ///< two instances, on the halves of the body
};

/// A block of 2x2x2 elements with edges of about 5 cm and one model, in a deformed state that
/// moves: every component of a strain is about 10 %. A model on lips acts between its halves.
class SampleBody {
 public:
  /// Throws InputError if the model refuses the parameters or the shape, PluginError.
  SampleBody(const suture_model& model, const SampleOptions& options);
  SampleBody(const SampleBody&) = delete;

  const SampleOptions& options() const { return options_; }
  Body& body() { return body_; }
  Instance& instance() { return *body_.attributes().instances()[0]; }
  const suture_model& model() const { return model_; }
  /// Whether some node has mass by the model: a model of a field may leave it to others.
  bool gives_mass() const { return gives_mass_; }

  /// Functors that run with these parameters; on elements of which only a part is material, what
  /// replaces them there.
  std::vector<const suture_functor*> functors();
  /// Up to 8 cells of a functor, chosen at random, at different times (sample_times). Empty if none
  /// has the functor's shape.
  std::vector<CellBatch> batches(const suture_functor& functor, std::size_t count);

  /// Forces of all functors, 3 numbers per vertex.
  std::vector<double> forces();
  std::vector<double> at_vertices(Column& column, int components = 3) const;
  /// Moves all vertices to their places at rest, without velocities, at time 0, and gives fields
  /// their initial values.
  void go_to_rest();
  void stop();  ///< without velocities
  /// Gives the fields of the model values about their initial ones: random, the same in each call.
  void vary_fields();
  /// A dart of each face inside the body.
  std::vector<Dart> inner_faces();

 private:
  void add_model(const suture_model& model, std::vector<Index> elements);
  void open_lips();
  std::vector<double> parameters() const;
  std::vector<GivenColumn> given_columns() const;
  void give_mass();
  void deform();
  std::vector<Index> cells_of(const suture_functor& functor);

  SampleOptions options_;
  const suture_model& model_;
  std::mt19937_64 random_;
  Diagnostics diagnostics_;
  Body body_;
  bool gives_mass_ = false;
};

Vec3 rotated(const std::array<Vec3, 3>& rotation, const Vec3& v);
/// From the components of a quaternion.
std::array<Vec3, 3> random_rotation(std::mt19937_64& random);
double between(std::mt19937_64& random, double low, double high);

}  // namespace suture
