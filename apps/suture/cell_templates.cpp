// SPDX-License-Identifier: GPL-3.0-or-later
//
// New models on nodes, faces and lips, constraints, and those that compute batches by themselves.
#include "apps/suture/model_templates.hpp"

namespace suture::templates {

const std::string_view nodes = R"model(// SPDX-License-Identifier: MIT
#include "suture/model.hpp"

/// Under each node a floor, which pushes and does not pull, and drag. It acts between the body and
/// the world, and gives no mass: use it on the same elements as a model that does.
struct @Struct@ : suture::model, suture::on_vertices {
  static constexpr const char *id = "@id@", *doc = "An elastic floor under the body, and drag",
                              *formula = "f = k <Z - gap - z> e_z - c m v, <x> = max(x, 0)",
                              *citation = "textbook";
  enum { k, gap, c };
  static constexpr suture::parameter parameters[] = {
      suture::number("k", "N/m", "Stiffness of the floor under a node").above(0),
      suture::number("gap", "m", "How far a node falls before it touches").at_least(0).or_else(0),
      suture::number("c", "1/s", "Drag per mass").at_least(0).or_else(0)};
  static constexpr auto reads = SUTURE_READ_REST | SUTURE_READ_POSITION | SUTURE_READ_VELOCITY;
  static constexpr auto vertex_columns = suture::columns(suture::vertex_mass);

  template <class Cell>
  static auto depth(const Cell& node) {
    const auto fall = node.rest(0)[2] - node.position(0)[2] - node.parameter(gap);
    return max(fall, 0.0 * fall);
  }
  template <class Cell>
  static void force(const Cell& node) {
    const auto m = node.vertex_column(suture::vertex_mass, 0);
    auto f = (-node.parameter(c) * m) * node.velocity(0);
    f[2] += node.parameter(k) * depth(node);
    node.force(0, f);
  }
  template <class Cell>
  static auto energy(const Cell& node) {
    return 0.5 * node.parameter(k) * depth(node) * depth(node);
  }
};
SUTURE_PLUGIN("@id@", "1.0", "MIT", "Elastic floor with drag", @Struct@)
)model";

const std::string_view faces = R"model(// SPDX-License-Identifier: MIT
#include "suture/model.hpp"

/// A pressure on the boundary, which follows the faces as they turn and grow. It has no energy, as
/// its work may depend on the path, and gives no mass: use it on the same elements as a model that
/// does.
struct @Struct@ : suture::model, suture::on_faces {
  static constexpr const char *id = "@id@", *doc = "A pressure on the boundary of the body",
                              *formula = "f = -p A n / 4 on each node of a face",
                              *citation = "textbook";
  enum { pressure, duration };
  static constexpr suture::parameter parameters[] = {
      suture::number("p", "Pa", "Pressure, inward"),
      suture::number("ramp", "s", "Time in which it rises from 0").at_least(0).or_else(0)};
  static constexpr auto faces = SUTURE_BOUNDARY_FACES;

  template <class Cell>
  static void force(const Cell& face) {
    const double ramp = face.parameter(duration);
    const double part = face.time() < ramp ? face.time() / ramp : 1;
    // Half the cross product of the diagonals is the area times the outward normal.
    const auto twice_area =
        cross(face.position(2) - face.position(0), face.position(3) - face.position(1));
    const auto f = (-part * face.parameter(pressure) / 8) * twice_area;
    for (int n = 0; n < 4; ++n) face.force(n, f);
  }
};
SUTURE_PLUGIN("@id@", "1.0", "MIT", "Pressure on the boundary", @Struct@)
)model";

const std::string_view constraint = R"model(// SPDX-License-Identifier: MIT
#include "suture/hexahedron.hpp"
#include "suture/model.hpp"

/// A constraint C = 0 on each element, here that it keeps its volume. Its energy is C^2 / (2 a) with
/// the compliance a: position based dynamics ("integrator": "xpbd") projects C, and every other
/// solver takes the force -dU/dx. It gives no mass: use it on the same elements as a model that does.
struct @Struct@ : suture::model, suture::on_volumes {
  static constexpr const char *id = "@id@", *doc = "Keeps the volume of the elements",
                              *formula = "U = C^2 / (2 a), C = V - V0, a = V0 / kappa",
                              *citation = "Macklin, Mueller, Chentanez, XPBD, MIG 2016";
  enum { kappa };
  static constexpr suture::parameter parameters[] = {
      suture::number("kappa", "Pa", "Pressure per relative change of the volume").above(0)};
  static constexpr auto reads = SUTURE_READ_REST | SUTURE_READ_POSITION;

  static constexpr double side(int node, int axis) { return (node >> axis & 1) ? 1 : -1; }
  /// The volume of the parallelepiped with the element's mean edges A: V = A0 . (A1 x A2).
  template <class T>
  struct Volume {
    suture::mat3<T> across;  // columns A1 x A2, A2 x A0, A0 x A1
    T value;
    suture::vec3<T> gradient(int n) const {  // dV/dx_n
      const auto& a = across.column;
      return 0.25 * (side(n, 0) * a[0] + side(n, 1) * a[1] + side(n, 2) * a[2]);
    }
  };
  template <class T, class Place>
  static Volume<T> volume(Place place) {
    suture::vec3<T> x[8];
    for (int n = 0; n < 8; ++n) x[n] = place(n);
    const auto edges = suture::mean_edges(x), across = cofactor(edges);
    return {across, dot(edges.column[0], across.column[0])};
  }
  template <class Cell>
  static auto now(const Cell& c) {
    return volume<typename Cell::scalar>([&](int n) { return c.position(n); });
  }
  template <class Cell>
  static auto at_rest(const Cell& c) {
    return volume<typename Cell::real>([&](int n) { return c.rest(n); }).value;
  }

  template <class Cell>
  static void force(const Cell& c) {
    const auto V = now(c);
    const auto pull = -c.parameter(kappa) * (V.value / at_rest(c) - 1.0);  // -C / a
    for (int n = 0; n < 8; ++n) c.force(n, V.gradient(n) * pull);
  }
  template <class Cell>
  static auto energy(const Cell& c) {
    const auto rest = at_rest(c);
    const auto C = now(c).value - rest;
    return 0.5 * c.parameter(kappa) / rest * (C * C);
  }
};
SUTURE_PLUGIN("@id@", "1.0", "MIT", "Volume of the elements", @Struct@)
)model";

const std::string_view lips = R"model(// SPDX-License-Identifier: MIT
#include "suture/lips.hpp"

/// Springs between opposite nodes of two regions, which the scene names by "between".
struct @Struct@ : suture::model, suture::on_lips {
  static constexpr const char *id = "@id@", *doc = "Holds two regions together",
                              *formula = "U = k A / 8 sum over pairs of nodes of |u|^2",
                              *citation = "textbook";
  enum { k };
  static constexpr suture::parameter parameters[] = {
      suture::number("k", "Pa/m", "Traction per distance").above(0)};
  static constexpr auto reads = SUTURE_READ_REST | SUTURE_READ_POSITION;

  /// Node 4 + i of the second lip lies opposite node i of the first.
  template <class Cell>
  static auto distance(const Cell& c, int i) {
    return c.position(4 + i) - c.position(i);
  }
  template <class Cell>
  static auto stiffness_of_pair(const Cell& c) {
    const auto twice_area = norm(cross(c.rest(2) - c.rest(0), c.rest(3) - c.rest(1)));
    return c.parameter(k) / 8 * twice_area;
  }
  template <class Cell>
  static void force(const Cell& c) {
    const auto stiffness = stiffness_of_pair(c);
    for (int i = 0; i < 4; ++i) {
      const auto f = distance(c, i) * stiffness;
      c.force(i, f);
      c.force(4 + i, -f);
    }
  }
  template <class Cell>
  static auto energy(const Cell& c) {
    typename Cell::scalar sum(0.0);
    for (int i = 0; i < 4; ++i) sum += dot(distance(c, i), distance(c, i));
    return 0.5 * stiffness_of_pair(c) * sum;
  }
};
SUTURE_PLUGIN("@id@", "1.0", "MIT", "Springs between two regions", @Struct@)
)model";

const std::string_view batches = R"model(// SPDX-License-Identifier: MIT
//
// Dashpots along edges, computed for a whole batch: eight edges, whose values lie side by side
// (value(node, component, lane) = p[(node * 3 + component) * 8 + lane], suture/plugin.h). The compiler
// makes vectors of the loops over lanes. The tables are written by hand.
#include <cmath>
#include <cstdio>
#include <cstring>

#include "suture/declarations.hpp"
#include "suture/note.h"

namespace {

constexpr int lanes = SUTURE_LANES;
using row = const double*;
row at(const double* values, int node, int component) {
  return values + (node * 3 + component) * lanes;
}

suture_status fail(const suture_context* context, const suture_batch* batch, int lane) {
  context->error->cell = batch->cell_ids[lane];
  std::snprintf(context->error->text, sizeof context->error->text,
                "the force is not finite: the state of this edge is not, or its length is 0");
  return SUTURE_STOP;
}

/// f = c (w.u) u on the first node, -f on the second.
suture_status force(const suture_context* context, const suture_batch* batch) {
  const double viscosity = context->parameters[0];
  alignas(SUTURE_ALIGNMENT) double pull[lanes] = {}, square[lanes] = {};
  for (int i = 0; i < 3; ++i) {
    const row a = at(batch->position, 0, i), b = at(batch->position, 1, i);
    const row v = at(batch->velocity, 0, i), w = at(batch->velocity, 1, i);
    for (int l = 0; l < lanes; ++l) {
      pull[l] += (b[l] - a[l]) * (w[l] - v[l]);
      square[l] += (b[l] - a[l]) * (b[l] - a[l]);
    }
  }
  for (int l = 0; l < lanes; ++l) pull[l] *= viscosity / square[l];
  for (int i = 0; i < 3; ++i) {
    const row a = at(batch->position, 0, i), b = at(batch->position, 1, i);
    for (int l = 0; l < lanes; ++l) {
      const double f = pull[l] * (b[l] - a[l]);
      batch->force[i * lanes + l] = f;
      batch->force[(3 + i) * lanes + l] = -f;
    }
  }
  for (int l = 0; l < lanes; ++l)
    if (!std::isfinite(pull[l] * square[l])) return fail(context, batch, l);
  return SUTURE_OK;
}

/// C <= 2 c on either node; no stiffness.
suture_status bounds(const suture_context* context, const suture_batch*, double* stiffness,
                     double* damping) {
  std::memset(stiffness, 0, sizeof(double) * 2 * 6 * lanes);
  std::memset(damping, 0, sizeof(double) * 2 * 6 * lanes);
  for (int node = 0; node < 2; ++node)
    for (int c = 0; c < 3; ++c)
      for (int l = 0; l < lanes; ++l)
        damping[(node * 6 + c) * lanes + l] = 2 * context->parameters[0];
  return SUTURE_OK;
}
constexpr suture_stable_dt_1 stable_dt = {sizeof(suture_stable_dt_1), 0, bounds};

const void* extension(const char* id) {
  return std::strcmp(id, SUTURE_STABLE_DT_1) == 0 ? &stable_dt : nullptr;
}

constexpr suture::parameter parameters[] = {
    suture::number("c", "N s/m", "Viscosity of an edge").at_least(0)};

constexpr suture_functor make_functor() {
  suture_functor f{};
  f.size = sizeof f;
  f.dimension = 1;
  f.cell_type = SUTURE_EDGE;
  f.lanes = SUTURE_LANES;
  f.reads = SUTURE_READ_POSITION | SUTURE_READ_VELOCITY;
  f.name = "dashpots";
  f.doc = "Dashpots along edges";
  f.force = force;
  f.extension = extension;
  return f;
}
constexpr suture_functor functor = make_functor();

constexpr suture_model make_model() {
  suture_model m{};
  m.size = sizeof m;
  m.id = "@id@";
  m.doc = "Dashpots along edges";
  m.formula = "f = c (w.u) u, w the difference of the velocities, u the direction of the edge";
  m.citation = "textbook";
  m.parameter_count = 1;
  m.functor_count = 1;
  m.parameters = parameters;
  m.functors = &functor;
  return m;
}
constexpr suture_model model = make_model();

const suture_plugin plugin = {sizeof(suture_plugin), SUTURE_MAGIC, SUTURE_ABI_MAJOR,
                              SUTURE_ABI_MINOR, SUTURE_LANES, 1, "@id@", "1.0", "MIT",
                              "Dashpots along edges", &model, 0, 0, nullptr};

}  // namespace

SUTURE_NOTE("@id@", "@id@")
extern "C" [[gnu::visibility("default")]] const suture_plugin* suture_plugin_v1() {
  return &plugin;
}
)model";

const std::string_view plain_c = R"model(/* SPDX-License-Identifier: MIT
 *
 * Springs to the ground with drag, in plain C. A function computes a batch of eight nodes, whose
 * values lie side by side: value(component, lane) = p[component * 8 + lane] (suture/plugin.h). */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "suture/note.h"
#include "suture/plugin.h"

enum { K, C, VALUES = 3 * SUTURE_LANES };

static suture_status force(const suture_context* context, const suture_batch* batch) {
  const double k = context->parameters[K], c = context->parameters[C];
  for (int i = 0; i < VALUES; ++i)
    batch->force[i] = -k * (batch->position[i] - batch->rest[i]) - c * batch->velocity[i];
  for (int i = 0; i < VALUES; ++i)
    if (!isfinite(batch->force[i])) {
      context->error->cell = batch->cell_ids[i % SUTURE_LANES];
      snprintf(context->error->text, sizeof context->error->text,
               "the force is not finite, as the state of this node is not");
      return SUTURE_STOP;
    }
  return SUTURE_OK;
}

static suture_status energy(const suture_context* context, const suture_batch* batch,
                            double* out) {
  memset(out, 0, sizeof(double) * SUTURE_LANES);
  for (int i = 0; i < VALUES; ++i) {
    const double u = batch->position[i] - batch->rest[i];
    out[i % SUTURE_LANES] += context->parameters[K] / 2 * u * u;
  }
  return SUTURE_OK;
}

static suture_status tangent(const suture_context* context, const suture_batch* batch,
                             const double* dx, const double* dv, double* df) {
  (void)batch;
  for (int i = 0; i < VALUES; ++i)
    df[i] = -context->parameters[K] * dx[i] - context->parameters[C] * dv[i];
  return SUTURE_OK;
}

static suture_status bounds(const suture_context* context, const suture_batch* batch,
                            double* stiffness, double* damping) {
  (void)batch;
  memset(stiffness, 0, sizeof(double) * 6 * SUTURE_LANES);
  memset(damping, 0, sizeof(double) * 6 * SUTURE_LANES);
  for (int i = 0; i < VALUES; ++i) {
    stiffness[i] = context->parameters[K];
    damping[i] = context->parameters[C];
  }
  return SUTURE_OK;
}

static const suture_energy_1 energy_1 = {sizeof(suture_energy_1), 0, energy};
static const suture_tangent_1 tangent_1 = {sizeof(suture_tangent_1), 0, tangent};
static const suture_stable_dt_1 stable_dt_1 = {sizeof(suture_stable_dt_1), 0, bounds};

static const void* extension(const char* id) {
  if (strcmp(id, SUTURE_ENERGY_1) == 0) return &energy_1;
  if (strcmp(id, SUTURE_TANGENT_1) == 0) return &tangent_1;
  if (strcmp(id, SUTURE_STABLE_DT_1) == 0) return &stable_dt_1;
  return NULL;
}

static const suture_parameter parameters[] = {
    {.size = sizeof(suture_parameter), .type = SUTURE_NUMBER, .flags = SUTURE_REQUIRED,
     .name = "k", .unit = "N/m", .doc = "Stiffness of a node", .minimum = 0, .maximum = INFINITY},
    {.size = sizeof(suture_parameter), .type = SUTURE_NUMBER, .name = "c", .unit = "N s/m",
     .doc = "Drag of a node", .minimum = 0, .maximum = INFINITY}};

static const suture_functor functor = {
    .size = sizeof(suture_functor), .dimension = 0, .cell_type = SUTURE_VERTEX,
    .lanes = SUTURE_LANES,
    .reads = SUTURE_READ_REST | SUTURE_READ_POSITION | SUTURE_READ_VELOCITY,
    .name = "springs", .doc = "Springs to the ground", .force = force, .extension = extension};

static const suture_model model = {
    .size = sizeof(suture_model), .id = "@id@", .doc = "Springs to the ground",
    .formula = "f = -k (x - X) - c v", .citation = "textbook", .parameter_count = 2,
    .functor_count = 1, .parameters = parameters, .functors = &functor};

static const suture_plugin plugin = {
    .size = sizeof(suture_plugin), .magic = SUTURE_MAGIC, .abi_major = SUTURE_ABI_MAJOR,
    .abi_minor = SUTURE_ABI_MINOR, .lanes = SUTURE_LANES, .model_count = 1, .id = "@id@",
    .version = "1.0", .license = "MIT", .description = "Springs to the ground", .models = &model};

SUTURE_NOTE("@id@", "@id@")
__attribute__((visibility("default"))) const suture_plugin* suture_plugin_v1(void) {
  return &plugin;
}
)model";

}  // namespace suture::templates
