// SPDX-License-Identifier: GPL-3.0-or-later
//
// Work whose instructions callgrind counts: two runs that differ in --repeat differ by
// nothing else. See tests/house/counted.sh.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"

namespace suture::bench {
namespace {

struct Options {
  std::string model = "tm-faure", work = "step";
  std::map<std::string, double> parameters;
  bool distorted = false;
  int repeat = 1;
};

constexpr int strips = 8;

void run(const Options& options, Report& report) {
  PluginHost host;
  // 1024 faces between two layers: 128 in a strip.
  const bool cuts = options.work == "cut";
  BenchBody body(host,
                 {.model = options.model,
                  .parameters = options.parameters,
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

void add_count(CLI::App& app, std::vector<Command>& commands) {
  auto* command = app.add_subcommand("count", "Work for counting with callgrind, not for timing");
  auto options = std::make_shared<Options>();
  command->add_option("--model", options->model, "Model");
  command->add_option_function<std::vector<std::string>>(
      "--parameter",
      [options](const std::vector<std::string>& given) {
        for (std::size_t i = 0; i + 1 < given.size(); i += 2)
          options->parameters[given[i]] = std::stod(given[i + 1]);
      },
      "Parameter of the model: NAME VALUE");
  command->add_flag("--distorted", options->distorted, "General hexahedra");
  command->add_option("--work", options->work, "The work to repeat")
      ->check(CLI::IsMember({"force", "step", "cut"}));
  command->add_option("--repeat", options->repeat, "Number of repetitions; at most 8 for cuts")
      ->check(CLI::Range(1, strips));
  commands.push_back({command, [options](Report& report) { run(*options, report); }, false});
}

}  // namespace suture::bench
