// SPDX-License-Identifier: GPL-3.0-or-later
//
// Work whose instructions callgrind counts: two runs that differ in --repeat differ by
// nothing else. See tests/house/counted.sh.

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"

namespace suture::bench {
namespace {

struct CountOptions {
  std::string model = "tm-faure", work = "step";
  std::vector<std::string> parameters;  ///< names and values in turn
  bool distorted = false;
  int repeat = 1;
};

constexpr int strips = 8;

std::map<std::string, double> values_of(const std::vector<std::string>& parameters) {
  std::map<std::string, double> values;
  for (std::size_t i = 0; i + 1 < parameters.size(); i += 2)
    values[parameters[i]] = std::stod(parameters[i + 1]);
  return values;
}

void run_count(const CountOptions& options, Report& report) {
  PluginHost host;
  // 1024 faces between two layers: 128 in a strip.
  const bool cuts = options.work == "cut";
  BenchBody body(host,
                 {.model = options.model,
                  .parameters = values_of(options.parameters),
                  .cells = cuts ? std::array<Index, 3>{2, 32, 32} : std::array<Index, 3>{8, 8, 8},
                  .distorted = options.distorted});
  std::vector<std::vector<Dart>> faces;
  for (int part = 0; part < strips && cuts; ++part) faces.push_back(body.strip(part, strips));
  for (int i = 0; i < options.repeat; ++i) {
    if (options.work == "force")
      body.body().models().add_forces(0, 0);
    else if (cuts)
      body.cut(faces[static_cast<std::size_t>(i)]);
    else
      body.step();
  }
  report.begin("count", "cells of one repetition");
  report.add(Line().add("cells", cuts ? static_cast<double>(faces[0].size())
                                      : static_cast<double>(body.element_count())));
}

}  // namespace

void add_count(CommandLine& line) {
  auto [command, options] =
      line.add("count", "Work for counting with callgrind, not for timing", run_count);
  command.option("--model", &options.model, "Model");
  command.option("--parameter", &options.parameters, "Parameter of the model: NAME VALUE");
  command.flag("--distorted", &options.distorted, "General hexahedra");
  command.option("--work", &options.work, "The work to repeat").one_of({"force", "step", "cut"});
  command.option("--repeat", &options.repeat, "Number of repetitions; at most 8 for cuts")
      .within(1, strips);
  command.only_by_name();
}

}  // namespace suture::bench
