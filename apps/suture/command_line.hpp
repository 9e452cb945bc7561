// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "kernel/geometry/voxelize.hpp"
#include "kernel/images/label_image.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/parts/fill_surface.hpp"

namespace suture {

struct RunCommand {
  std::filesystem::path scene, resume;  ///< exactly one is set
  std::vector<std::string> sets;
  bool skip = true, check_plugins = false;
  unsigned processes = 1;  ///< that make the run together
};
struct LiveCommand {
  std::filesystem::path scene, recording;  ///< "": a name made from that of the scene
  std::vector<std::string> sets;
  unsigned port = 0;               ///< 0: any that is free
  std::string host, device, hold;  ///< "": none
};
struct CheckCommand {
  std::filesystem::path scene;
  std::vector<std::string> sets;
  bool trust = false, check_plugins = false;
};
struct ExplainCommand {
  std::filesystem::path scene;
  std::vector<std::string> sets;
  bool json = false, skip = true, trust = false;
};
struct CiteCommand {
  std::filesystem::path scene;
  std::vector<std::string> sets;
  bool trust = false;
};
struct ReplayCommand {
  std::filesystem::path journal;  ///< or a failed check
  bool trust = false;
};
struct NewModelCommand {
  std::string name, level = "law";
  std::filesystem::path output;  ///< the folder around that of the model
};
struct NewSceneCommand {
  std::filesystem::path to = "beam.json";
};
struct CheckModelCommand {
  std::string model;  ///< its id, or a plugin file
  std::vector<std::string> only;
  std::map<std::string, std::string> sets;  ///< values of parameters
  std::uint64_t seed = 1;
  double timeout = 60;  ///< of one check, s
  std::filesystem::path output = ".";
  bool json = false, list = false;
};
struct ModesCommand {
  std::filesystem::path scene;
  std::vector<std::string> sets;
  unsigned count = 10;
  bool at_equilibrium = false, names_folder = false;
};
struct SweepCommand {
  std::filesystem::path study;
  unsigned jobs = 0;            ///< 0: as the study says, or one per core
  std::filesystem::path slurm;  ///< "": run
};
struct FitCommand {
  std::filesystem::path study;
  unsigned jobs = 0;  ///< as of SweepCommand
};
struct CompareCommand {
  std::vector<std::string> runs;  ///< two output folders; or three, from coarse to fine
  bool common = false;            ///< only frames of common times
  std::string tolerance{};        ///< of relative differences; "": none
};
struct PlotCommand {
  std::vector<std::string> what;  ///< output folders, or one study, mesh, surface or scene
  std::filesystem::path picture;  ///< "": a name that follows from `what`
  std::vector<std::string> only;  ///< columns whose names contain one of these
  std::vector<std::string> sets;  ///< of a scene
  double scale = 1;               ///< of a mesh or surface
  bool trust = false;
};
struct ModelsCommand {};
struct SchemaCommand {};
struct DescribeCommand {
  std::string model;
};
struct MeshInfoCommand {
  std::filesystem::path file;
  std::optional<double> scale;
};
struct MeshConvertCommand {
  std::filesystem::path from, to;
  double scale = 1;
  bool drop_bad = false;
};
struct MeshBoxCommand {
  BoxOptions box;
  std::filesystem::path to;
};
struct MeshVoxelizeCommand {
  std::filesystem::path from, to;
  VoxelizeOptions options;
  double scale = 1;
  bool repair = false;
};
struct MeshFillCommand {
  std::filesystem::path from, to;
  CubeSize size;
  LabelNames labels;
  std::optional<double> scale;
  bool repair = false;
};
/// --help, --version: a text for standard output.
struct TextCommand {
  std::string text;
};

struct CommandLine {
  bool quiet = false, verbose = false;
  std::variant<RunCommand, LiveCommand, CheckCommand, CiteCommand, ExplainCommand,
               CheckModelCommand, NewModelCommand, NewSceneCommand, ReplayCommand, ModesCommand,
               SweepCommand, FitCommand, CompareCommand, PlotCommand, ModelsCommand,
               DescribeCommand, SchemaCommand, MeshInfoCommand, MeshConvertCommand, MeshBoxCommand,
               MeshVoxelizeCommand, MeshFillCommand, TextCommand>
      command;
};

/// Throws UsageError; for an unknown command or option, it suggests the nearest one.
CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace suture
