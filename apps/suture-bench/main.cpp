// SPDX-License-Identifier: GPL-3.0-or-later
//
// suture-bench: the figures of this program on this machine. One file per
// subcommand; each prints a table and, with --json, writes the same as JSON.
#include <cstdio>

#include "apps/suture-bench/commands.hpp"
#include "kernel/base/error.hpp"

int main(int argc, char** argv) {
  suture::bench::CommandLine line;
  suture::bench::add_build(line);
  suture::bench::add_cut(line);
  suture::bench::add_blade(line);
  suture::bench::add_force(line);
  suture::bench::add_tangent(line);
  suture::bench::add_events(line);
  suture::bench::add_event_costs(line);
  suture::bench::add_event_runs(line);
  suture::bench::add_step(line);
  suture::bench::add_scaling(line);
  suture::bench::add_startup(line);
  suture::bench::add_skip(line);
  suture::bench::add_frame(line);
  suture::bench::add_count(line);
  suture::bench::add_realtime(line);
  suture::bench::add_haptic(line);
  suture::bench::add_live(line);
  suture::bench::add_rest(line);
  suture::bench::add_solve(line);
  suture::bench::add_static(line);
  suture::bench::add_implicit(line);
  suture::bench::add_quasi_static(line);
  suture::bench::add_modes(line);
  suture::bench::add_contact(line);
  suture::bench::add_bodies(line);
  try {
    return line.run(argc, argv);
  } catch (const suture::Error& error) {
    std::fprintf(stderr, "suture-bench: %s\n", error.what());
    return error.exit_code();
  }
}
