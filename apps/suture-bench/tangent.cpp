// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <string>
#include <vector>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/base/aligned.hpp"

namespace suture::bench {
namespace {

struct TangentCase {
  const char* name;
  const char* model;
  std::map<std::string, double> parameters;
  bool distorted;
};

const std::vector<TangentCase>& tangent_cases() {
  static const std::vector<TangentCase> list{
      {"TM boxes, gauss2", "tm-faure", {}, false},
      {"TM boxes, exact", "tm-faure", {{"quadrature", 1}}, false},
      {"TM general, gauss2", "tm-faure", {}, true},
      {"TM general, gauss2, geometry recomputed", "tm-faure", {{"geometry", 1}}, true},
      {"MSS undamped", "mss-baudet", {}, false},
      {"MSS, viscosity", "mss-baudet", {{"viscosity", 1}}, false},
      {"MSS, correction", "mss-baudet", {{"correction", 1}}, false},
  };
  return list;
}

struct TangentOptions {
  std::vector<Index> sizes{4000, 32000, 256000};
  std::string only;
  unsigned threads = 1;
  double seconds = 0.5;
};

/// Seconds of a product with vectors of Real of this size.
template <class Real>
double product(ForceLoop& models, std::size_t size, const TangentOptions& options) {
  AlignedVector<Real> direction(size), image(size);
  for (std::size_t i = 0; i < size; ++i)
    direction[i] = static_cast<Real>(1e-3 * std::sin(static_cast<double>(i)));
  const auto call = [&] { models.add_tangent(direction.data(), 1, 0, 0, image.data()); };
  return measure(call, options.threads, options.seconds).median;
}

void measure_tangent(const TangentCase& c, Index size, const TangentOptions& options,
                     PluginHost& host, Report& report) {
  BenchBody body(host, {.model = c.model,
                        .parameters = c.parameters,
                        .cells = grid_of(size),
                        .distorted = c.distorted,
                        .threads = options.threads});
  ForceLoop& models = body.body().models();
  const double elements = body.element_count();
  const std::size_t vertices = body.attributes().vertex_count();
  const auto force = [&] { models.add_forces(0, 0); };
  const double forces = measure(force, options.threads, options.seconds).median;
  const double in_double = product<double>(models, 3 * vertices, options);
  const double in_single = product<float>(models, 4 * vertices, options);
  report.add(Line()
                 .add("case", std::string(c.name))
                 .add("elements", elements)
                 .add("force ns/el", 1e9 * forces / elements)
                 .add("double ns/el", 1e9 * in_double / elements)
                 .add("single ns/el", 1e9 * in_single / elements)
                 .add("double/force", in_double / forces)
                 .add("single/force", in_single / forces));
}

void run_tangent(const TangentOptions& options, Report& report) {
  PluginHost host;
  for (const TangentCase& c : tangent_cases()) {
    if (std::string(c.name).find(options.only) == std::string::npos) continue;
    report.begin(std::string("tangent: ") + c.name,
                 "the product of the tangent and a direction beside the force, " +
                     std::to_string(options.threads) + " thread(s), medians");
    for (const Index size : options.sizes) measure_tangent(c, size, options, host, report);
  }
}

}  // namespace

void add_tangent(CommandLine& line) {
  auto [command, options] =
      line.add("tangent", "Products of the models' tangents and a direction, by size", run_tangent);
  command.option("--sizes", &options.sizes, "Elements");
  command.option("--only", &options.only, "Cases whose name contains this");
  command.option("--threads", &options.threads, "Threads").positive();
  command.option("--seconds", &options.seconds, "Time spent on each figure");
}

}  // namespace suture::bench
