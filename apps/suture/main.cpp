// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>
#include <new>

#include "apps/suture/commands.hpp"
#include "apps/suture/processes.hpp"
#include "apps/suture/signals.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/out_of_memory.hpp"
#include "kernel/plugin_host/plugin_call.hpp"
#include "kernel/plugin_host/plugin_faults.hpp"

namespace suture {
namespace {

/// Chooses the function of a command.
struct Dispatch {
  Console& console;
  int operator()(const RunCommand& command) const { return run(command, console); }
  int operator()(const LiveCommand& command) const { return live(command, console); }
  int operator()(const CheckCommand& command) const { return check(command, console); }
  int operator()(const CiteCommand& command) const { return cite(command, console); }
  int operator()(const ExplainCommand& command) const { return explain(command, console); }
  int operator()(const NewSceneCommand& command) const { return new_scene(command, console); }
  int operator()(const NewModelCommand& command) const { return new_model(command, console); }
  int operator()(const CheckModelCommand& command) const { return check_model(command, console); }
  int operator()(const ReplayCommand& command) const { return replay(command, console); }
  int operator()(const ModesCommand& command) const { return modes(command, console); }
  int operator()(const SweepCommand& command) const { return sweep(command, console); }
  int operator()(const FitCommand& command) const { return fit(command, console); }
  int operator()(const CompareCommand& command) const { return compare(command, console); }
  int operator()(const PlotCommand& command) const { return plot(command, console); }
  int operator()(const ModelsCommand& command) const { return models(command, console); }
  int operator()(const DescribeCommand& command) const { return describe(command, console); }
  int operator()(const SchemaCommand& command) const { return schema(command, console); }
  int operator()(const MeshInfoCommand& command) const { return mesh_info(command, console); }
  int operator()(const MeshConvertCommand& command) const { return mesh_convert(command, console); }
  int operator()(const MeshBoxCommand& command) const {
    return mesh_generate_box(command, console);
  }
  int operator()(const MeshVoxelizeCommand& command) const {
    return mesh_voxelize(command, console);
  }
  int operator()(const MeshFillCommand& command) const { return mesh_fill(command, console); }
  int operator()(const TextCommand& command) const {
    std::fputs(command.text.c_str(), stdout);
    return 0;
  }
};

// Calls f; an exception becomes a message and an exit code.
template <class F>
int guarded(Console& console, F&& f) {
  try {
    return f();
  } catch (const Error& error) {
    console.error(error.what());
    return error.exit_code();
  } catch (const OutOfMemory& error) {
    console.error(std::string("out of memory: ") + error.what() +
                  "; 'suture explain' shows how much a scene needs");
    return 6;
  } catch (const std::bad_alloc&) {
    console.error("out of memory; 'suture explain' shows how much a scene needs");
    return 6;
  } catch (const std::exception& error) {
    console.error(std::string("unexpected: ") + error.what() +
                  "; this is a bug in Suture, please report it");
    return 1;
  }
}

}  // namespace
}  // namespace suture

int main(int argc, char** argv) {
  using namespace suture;
  report_failed_writes();
  CommandLine line;
  Console early(false, false);
  const int usage = guarded(early, [&] {
    guard_plugin_calls();
    line = parse_command_line(argc, argv);
    return 0;
  });
  if (usage != 0) return usage;
  Console console(line.quiet, line.verbose);
  bool has_met_error = true;
  const int code = guarded(console, [&] {
    const int result = std::visit(Dispatch{console}, line.command);
    has_met_error = false;
    return result;
  });
  has_met_error ? leave_processes_after_error(code, console) : leave_processes();
  deliver_plugin_warnings(console.diagnostics());
  console.count_warnings();
  return code != 0 ? code : console.finish();
}
