// SPDX-License-Identifier: GPL-3.0-or-later
//
// Commands of the Python module: studies, whose processes are the runs, fits, comparisons and
// pictures.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "apps/suture/commands.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/module.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

/// Whether the package `suture` is in this folder with its compiled part, which is built later.
bool has_module(const fs::path& folder) {
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "suture", failed))
    if (entry.path().filename().string().starts_with("_suture.")) return true;
  return false;
}

/// The folder that contains the package: in the build tree or in an installation.
fs::path python_folder() {
  const fs::path prefix = own_prefix();
  for (const fs::path& folder : {prefix / "python", prefix / SUTURE_INSTALL_PYTHONDIR})
    if (has_module(folder)) return folder;
  throw IoError("the Python module of Suture is missing below " + prefix.string() +
                "; build all of Suture ('./dev build' or 'cmake --build build') with python3-dev, "
                "python3-numpy and pybind11-dev");
}

/// Becomes Python that runs a module of the package. `python3 -m` would look for every module in
/// the working folder first.
int become_python(const std::string& module, const std::vector<std::string>& arguments) {
  const fs::path start = python_folder() / "suture" / "_start.py";
  std::vector<std::string> words{SUTURE_PYTHON, start.string(), module};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  ::execv(SUTURE_PYTHON, pointers.data());
  throw IoError("cannot start " SUTURE_PYTHON ": " + std::string(std::strerror(errno)));
}

}  // namespace

int sweep(const SweepCommand& command, Console&) {
  std::vector<std::string> words{command.study.string()};
  if (command.jobs > 0) words.insert(words.end(), {"--jobs", std::to_string(command.jobs)});
  if (!command.slurm.empty()) words.insert(words.end(), {"--slurm", command.slurm.string()});
  return become_python("suture._sweep", words);
}

int fit(const FitCommand& command, Console&) {
  std::vector<std::string> words{command.study.string()};
  if (command.jobs > 0) words.insert(words.end(), {"--jobs", std::to_string(command.jobs)});
  return become_python("suture._fit", words);
}

int compare(const CompareCommand& command, Console&) {
  std::vector<std::string> words = command.runs;
  if (command.common) words.emplace_back("--common");
  if (!command.tolerance.empty()) words.insert(words.end(), {"--tolerance", command.tolerance});
  return become_python("suture._compare", words);
}

int plot_results(const PlotCommand& command) {
  std::vector<std::string> words = command.what;
  if (!command.picture.empty()) words.insert(words.end(), {"--output", command.picture.string()});
  if (!command.only.empty()) words.emplace_back("--only");
  words.insert(words.end(), command.only.begin(), command.only.end());
  return become_python("suture._plot", words);
}

int plot_surface(const fs::path& frame, const std::string& title, const fs::path& picture) {
  return become_python("suture._plot_mesh", {frame.string(), title, picture.string()});
}

}  // namespace suture
