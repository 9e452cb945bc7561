// SPDX-License-Identifier: GPL-3.0-or-later
//
// Work whose instructions callgrind counts: those of counted_work() alone. See
// tests/house/counted.sh.

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"

namespace suture::bench {
namespace {

struct CountOptions {
  std::string model = "tm-faure", work = "step";
  NamedValues parameters;
  bool distorted = false;
};

constexpr int strips = 8, first_counted = 2, last_counted = 5;  ///< repetitions

/// A name that callgrind finds.
template <class Work>
[[gnu::noinline]] void counted_work(const Work& work) {
  for (int i = first_counted; i <= last_counted; ++i) work(i);
}

void run_count(const CountOptions& options, Report& report) {
  PluginHost host;
  // 1024 faces between two layers: 128 in a strip.
  const bool cuts = options.work == "cut";
  BenchBody body(host,
                 {.model = options.model,
                  .parameters = {options.parameters.begin(), options.parameters.end()},
                  .cells = cuts ? std::array<Index, 3>{2, 32, 32} : std::array<Index, 3>{8, 8, 8},
                  .distorted = options.distorted});
  std::vector<std::vector<Dart>> faces;
  for (int part = 0; part < strips && cuts; ++part) faces.push_back(body.strip(part, strips));
  const auto work = [&](int i) {
    if (options.work == "force")
      body.body().models().add_forces(0, 0);
    else if (cuts)
      body.cut(faces[static_cast<std::size_t>(i)]);
    else
      body.step();
  };
  for (int i = 0; i < first_counted; ++i) work(i);
  counted_work(work);
  const int repetitions = last_counted - first_counted + 1;
  report.begin("count", "cells whose instructions are counted");
  report.add(Line().add("cells", repetitions * (cuts ? static_cast<double>(faces[0].size())
                                                     : static_cast<double>(body.element_count()))));
}

}  // namespace

void add_count(CommandLine& line) {
  auto [command, options] =
      line.add("count", "Work for counting with callgrind, not for timing", run_count);
  command.option("--model", &options.model, "Model");
  command.option("--parameter", &options.parameters, "Parameter of the model: NAME VALUE");
  command.flag("--distorted", &options.distorted, "General hexahedra");
  command.option("--work", &options.work, "The work to repeat").one_of({"force", "step", "cut"});
  command.only_by_name();
}

}  // namespace suture::bench
