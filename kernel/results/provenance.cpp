// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/provenance.hpp"

#include <sys/utsname.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "kernel/base/checksum.hpp"
#include "kernel/base/input_file.hpp"

namespace suture {
namespace {

using Json = nlohmann::ordered_json;

Json describe_file(const std::filesystem::path& path, const std::string& shown) {
  Json file{{"file", shown}};
  InputFile input(path);
  if (!input.problem().empty()) return file;  // gone since it was read
  Checksum sum;
  std::vector<char> buffer(std::size_t{1} << 20);
  while (const std::size_t bytes = input.read(buffer))
    sum.add(std::string_view(buffer.data(), bytes));
  file["bytes"] = input.size();
  file["xxh64"] = sum.text();
  return file;
}

Json describe_machine(const BuiltScene& built) {
  Json machine;
  utsname system{};
  if (::uname(&system) == 0)
    machine["system"] = std::string(system.sysname) + ' ' + system.release + ' ' + system.machine;
  std::ifstream processors("/proc/cpuinfo");
  for (std::string line; std::getline(processors, line);) {
    if (!line.starts_with("model name")) continue;
    machine["processor"] = line.substr(std::min(line.size(), line.find(':') + 2));
    break;
  }
  machine["instruction_set"] = built.body().models().isa();
  return machine;
}

Json describe_models(const Scene& scene, PluginHost& host) {
  Json models = Json::array();
  for (const ModelUse& use : scene.models) {
    const suture_plugin& plugin = host.plugin_of(*use.model);
    Json model{{"id", use.model->id},
               {"plugin", plugin.id},
               {"version", plugin.version},
               {"license", plugin.license},
               {"citation", use.model->citation}};
    const std::filesystem::path file = host.file_of(*use.model);
    model["from"] = describe_file(file, file.filename().string());
    if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
  }
  return models;
}

/// As they are when the first results are written.
Json describe_processes(const BodyShare& share) {
  Json processes = Json::array();
  for (const BodyShare::Part& part : share.parts())
    processes.push_back({{"machine", part.machine},
                         {"threads", part.threads},
                         {"elements", {part.elements.begin, part.elements.end}},
                         {"vertices", part.vertices}});
  return processes;
}

std::string describe(const Scene& scene, PluginHost& host, const BuiltScene& built) {
  Json all{{"suture", SUTURE_VERSION}, {"machine", describe_machine(built)}};
  if (const BodyShare* share = built.body().share()) all["processes"] = describe_processes(*share);
  all["models"] = describe_models(scene, host);
  all["files"] = Json::array();
  for (const std::filesystem::path& file : scene.files)
    all["files"].push_back(
        describe_file(file, file.lexically_relative(scene.file.parent_path()).string()));
  const std::string& text = scene.text_that_counts;
  all["scene"] = {{"file", scene.file.filename().string()},
                  {"hash", scene.hash},
                  {"text", text.empty() ? Json() : Json::parse(text)}};
  return all.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace

std::string provenance_line(const Scene& scene, PluginHost& host, const BuiltScene& built) {
  std::ostringstream text;
  text << "suture " SUTURE_VERSION "; scene " << scene.file.filename().string() << ' ' << scene.hash
       << "; mesh " << built.mesh_source() << ';';
  for (const ModelUse& use : scene.models) {
    const suture_plugin& plugin = host.plugin_of(*use.model);
    text << ' ' << use.model->id << " (" << plugin.id << ' ' << plugin.version << ", "
         << host.file_of(*use.model).filename().string() << ");";
  }
  text << ' ' << built.body().models().isa();
  return text.str();
}

Provenance provenance_of(PluginHost& host, const BuiltScene& built) {
  const Scene& scene = built.scene();
  return {provenance_line(scene, host, built),
          [&host, &built] { return describe(built.scene(), host, built); }};
}

}  // namespace suture
