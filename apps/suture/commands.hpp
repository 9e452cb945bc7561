// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "apps/suture/command_line.hpp"
#include "apps/suture/console.hpp"
#include "kernel/plugin_host/plugin_host.hpp"

namespace suture {

/// Commands that only inspect a scene run no code from files that it names, unless the user
/// allows it.
template <class Command>
PluginHost::Trust trust_of(const Command& command) {
  return command.trust ? PluginHost::Trust::all : PluginHost::Trust::search_path;
}

/// One function per subcommand, each in the file of its name. They return the
/// exit code and throw the errors of kernel/base/error.hpp.
int run(const RunCommand& command, Console& console);
int live(const LiveCommand& command, Console& console);
int check(const CheckCommand& command, Console& console);
int cite(const CiteCommand& command, Console& console);
int explain(const ExplainCommand& command, Console& console);
int modes(const ModesCommand& command, Console& console);
int sweep(const SweepCommand& command, Console& console);
int fit(const FitCommand& command, Console& console);
int compare(const CompareCommand& command, Console& console);
int plot(const PlotCommand& command, Console& console);
/// Parts of plot(), which end as Python programs: of runs or a study; of a frame with the boundary
/// of a mesh, whose fields of points are its sets.
int plot_results(const PlotCommand& command);
int plot_surface(const std::filesystem::path& frame, const std::string& title,
                 const std::filesystem::path& picture);
int models(const ModelsCommand& command, Console& console);
int schema(const SchemaCommand& command, Console& console);
int new_scene(const NewSceneCommand& command, Console& console);
int new_model(const NewModelCommand& command, Console& console);
int check_model(const CheckModelCommand& command, Console& console);
int replay(const ReplayCommand& command, Console& console);
int describe(const DescribeCommand& command, Console& console);
int mesh_info(const MeshInfoCommand& command, Console& console);
int mesh_convert(const MeshConvertCommand& command, Console& console);
int mesh_generate_box(const MeshBoxCommand& command, Console& console);
int mesh_voxelize(const MeshVoxelizeCommand& command, Console& console);
int mesh_fill(const MeshFillCommand& command, Console& console);

}  // namespace suture
