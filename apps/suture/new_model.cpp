// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <system_error>

#include "apps/suture/commands.hpp"
#include "apps/suture/model_templates.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/file.hpp"
#include "kernel/base/nearest.hpp"
#include "suture/note.h"

namespace suture {
namespace {

namespace fs = std::filesystem;

bool is_letter(char c) { return c >= 'a' && c <= 'z'; }
bool belongs_to_id(char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '-'; }

bool is_id(const std::string& name) {
  return !name.empty() && name.size() < SUTURE_NOTE_PLUGIN_CHARS && is_letter(name.front()) &&
         std::ranges::all_of(name, belongs_to_id);
}

/// "my-model" for "My model".
std::string nearest_id(const std::string& name) {
  std::string id;
  for (const char c : fs::path(name).filename().string()) {
    const char lower = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    id += belongs_to_id(lower) ? lower : '-';
  }
  id.erase(id.begin(), std::ranges::find_if(id, is_letter));
  id.resize(std::min<std::size_t>(id.size(), SUTURE_NOTE_PLUGIN_CHARS - 1));
  return is_id(id) ? id : "my-model";
}

/// "MyModel" for "my-model".
std::string struct_name(const std::string& id) {
  std::string name;
  bool starts_word = true;
  for (const char c : id) {
    if (c != '-') name += starts_word ? static_cast<char>(std::toupper(c)) : c;
    starts_word = c == '-';
  }
  return name;
}

void require_free(const std::string& id, const fs::path& folder) {
  if (!is_id(id))
    throw UsageError(
        "the name of a model consists of lower-case letters, digits and '-', a letter "
        "first, at most 63 in all; it is " +
        quote(id) + ", try " + quote(nearest_id(id)) +
        " (--output names the folder to put it into)");
  for (const PluginHost::Listing& known : PluginHost().list())
    if (std::ranges::find(known.models, id) != known.models.end())
      throw UsageError("there is a model " + quote(id) + " already, in " + known.file.string() +
                       "; choose another name");
  std::error_code error;
  if (fs::exists(fs::symlink_status(folder, error)))
    throw UsageError(folder.string() + " exists already; choose another name, or remove it");
}

const ModelLevel& find_level(const std::string& name) {
  std::vector<std::string> names;
  for (const ModelLevel& level : model_levels()) {
    if (level.name == name) return level;
    names.emplace_back(level.name);
  }
  throw UsageError(
      "--kind must be law, springs, nodes, faces, field, constraint, lips, batches or c, is " +
      quote(name) + did_you_mean(name, names));
}

std::string replaced(std::string text, const std::string& what, std::string_view by) {
  for (auto at = text.find(what); at != text.npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

/// All files or none.
void write_files(const fs::path& folder, const ModelLevel& level, const std::string& id) {
  std::error_code error;
  if (!fs::create_directory(folder, error)) fail_io(folder, "created", error.value());
  try {
    for (const TemplateFile& file : files_of(level)) {
      std::string text = replaced(std::string(file.text), "@parameters@", level.parameters);
      text = replaced(text, "@solid@", level.solid);
      text = replaced(text, "@motion@", level.motion);
      text = replaced(text, "@integrator@", level.integrator);
      text = replaced(text, "@file@", level.file);
      text = replaced(text, "@Struct@", struct_name(id));
      const fs::path to = folder / file.name;
      fs::create_directories(to.parent_path());
      write_file(to, replaced(text, "@id@", id));
    }
  } catch (...) {
    fs::remove_all(folder, error);
    throw;
  }
}

/// The option with which CMake finds this program's installation; empty if it is not installed.
std::string prefix_option() {
  std::error_code error;
  const fs::path prefix = fs::read_symlink("/proc/self/exe", error).parent_path().parent_path();
  const bool installed = fs::exists(prefix / SUTURE_INSTALL_LIBDIR / "cmake/Suture", error);
  return installed ? " -DCMAKE_PREFIX_PATH=" + prefix.string() : "";
}

}  // namespace

int new_model(const NewModelCommand& command, Console& console) {
  const ModelLevel& level = find_level(command.level);
  const fs::path folder = command.output / command.name;
  require_free(command.name, folder);
  write_files(folder, level, command.name);
  const std::string build = (folder / "build").string(), prefix = prefix_option();
  if (prefix.empty())
    console.note(
        "this Suture is not installed: `cmake --install BUILD --prefix FOLDER` does that, and "
        "the first command then needs -DCMAKE_PREFIX_PATH=FOLDER");
  console.print("cmake -S " + folder.string() + " -B " + build + prefix + " && cmake --build " +
                build);
  console.print("ctest --test-dir " + build + " --output-on-failure");
  console.print("suture run " + (folder / "scene.json").string());
  return 0;
}

}  // namespace suture
