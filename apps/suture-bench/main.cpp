// SPDX-License-Identifier: GPL-3.0-or-later
//
// suture-bench: the figures of this program on this machine. One file per
// subcommand; each prints a table and, with --json, writes the same as JSON.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "apps/suture-bench/commands.hpp"
#include "kernel/base/error.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Benchmarks of Suture on this machine"};
  app.fallthrough();  // --json behind a subcommand, too
  std::string json;
  app.add_option("--json", json, "Write the figures to this file as well");
  std::vector<suture::bench::Command> commands;
  suture::bench::add_build(app, commands);
  suture::bench::add_cut(app, commands);
  suture::bench::add_blade(app, commands);
  suture::bench::add_force(app, commands);
  suture::bench::add_tangent(app, commands);
  suture::bench::add_events(app, commands);
  suture::bench::add_event_runs(app, commands);
  suture::bench::add_step(app, commands);
  suture::bench::add_scaling(app, commands);
  suture::bench::add_startup(app, commands);
  suture::bench::add_skip(app, commands);
  suture::bench::add_frame(app, commands);
  suture::bench::add_count(app, commands);
  suture::bench::add_realtime(app, commands);
  suture::bench::add_haptic(app, commands);
  suture::bench::add_rest(app, commands);
  suture::bench::add_solve(app, commands);
  suture::bench::add_static(app, commands);
  suture::bench::add_implicit(app, commands);
  suture::bench::add_quasi_static(app, commands);
  suture::bench::add_modes(app, commands);
  suture::bench::add_contact(app, commands);
  suture::bench::add_work_precision(app, commands);
  suture::bench::add_paper(app, commands);
  suture::bench::add_bodies(app, commands);
  CLI11_PARSE(app, argc, argv);
  try {
    suture::bench::Report report;
    // Without a subcommand: all of them.
    const bool all = app.get_subcommands().empty();
    for (const auto& command : commands)
      if ((all && command.measures) || command.app->parsed()) command.run(report);
    if (!json.empty()) report.write_json(json);
  } catch (const suture::Error& error) {
    std::fprintf(stderr, "suture-bench: %s\n", error.what());
    return error.exit_code();
  }
  return 0;
}
