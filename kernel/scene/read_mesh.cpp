// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <charconv>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

std::optional<std::array<Index, 3>> read_cells(ObjectReader& box) {
  const JsonValue* value = box.require("cells", "the number of cells along each axis [nx, ny, nz]");
  if (value == nullptr) return {};
  const std::string path = box.path_of("cells");
  if (value->kind != JsonValue::Kind::array || value->items.size() != 3) {
    box.mistakes().add(value->at, path,
                       "must be three whole numbers [nx, ny, nz], is " + describe(*value));
    return {};
  }
  std::array<Index, 3> cells{};
  bool good = true;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto count =
        read_natural(value->items[a], child_path(path, a), 1, max_elements, box.mistakes());
    cells[a] = static_cast<Index>(count.value_or(0));
    good = good && count.has_value();
  }
  if (!good) return {};
  if (double(cells[0]) * cells[1] * cells[2] > max_elements) {
    box.complain("cells", "are more in total than the map can number, at most " +
                              std::to_string(max_elements));
  }
  return cells;
}

void read_box(const JsonValue& value, const std::string& path, Reading& reading) {
  ObjectReader box(value, path, reading.mistakes);
  BoxOptions options;
  box.require("size", "the lengths along the axes [x, y, z] in m");
  options.size = box.vector("size", Limits::positive("m")).value_or(options.size);
  options.cells = read_cells(box).value_or(options.cells);
  options.origin = box.vector("origin", Limits::any("m")).value_or(options.origin);
  options.grading = box.vector("grading", Limits::positive("1")).value_or(options.grading);
  box.finish();
  reading.scene.mesh.box = options;
}

void read_voxels(const JsonValue& value, const std::string& path, Reading& reading) {
  ObjectReader voxels(value, path, reading.mistakes);
  VoxelOptions options;
  voxels.require("size", "the edge length of a cube in m");
  options.size = voxels.number("size", Limits::positive("m")).value_or(options.size);
  options.layers = static_cast<Index>(voxels.natural("layers", 1, 100'000).value_or(1));
  options.origin = voxels.vector("origin", Limits::any("m")).value_or(options.origin);
  if (const JsonValue* rows = voxels.require("rows", "the drawing, one string per row")) {
    const std::string rows_path = voxels.path_of("rows");
    const auto* items = read_array(*rows, rows_path, "strings", reading.mistakes);
    bool any = items == nullptr;
    for (std::size_t i = 0; items != nullptr && i < items->size(); ++i) {
      auto row = read_string((*items)[i], child_path(rows_path, i), reading.mistakes);
      options.rows.push_back(row.value_or("#"));
      any = any || options.rows.back().find_first_not_of(" .") != std::string::npos;
    }
    if (!any)
      voxels.complain("rows", "contains no cube; every character except '.' and ' ' is a cube");
  }
  voxels.finish();
  reading.scene.mesh.voxels = options;
}

/// The keys "cells" and "edge" of a filled body.
CubeSize read_cube_size(ObjectReader& mesh) {
  CubeSize size;
  static const std::array<std::string, 2> keys{"cells", "edge"};
  mesh.one_of(keys);
  size.cells = mesh.natural("cells", 1, 67'000'000).value_or(0);
  size.edge = mesh.number("edge", Limits::positive("m")).value_or(0);
  return size;
}

/// {"1": "liver", "2": "vessel"}.
LabelNames read_label_names(const JsonValue& value, const std::string& path, Mistakes& mistakes) {
  LabelNames labels;
  ObjectReader reader(value, path, mistakes);  // reports other kinds of values, and duplicates
  if (!reader.is_object()) return labels;
  if (value.members.empty())
    reader.complain("is empty; name at least one label: {\"1\": \"liver\"}");
  for (const JsonMember& member : value.members) {
    std::int64_t label = 0;
    const char* const end = member.key.data() + member.key.size();
    const auto [stop, error] = std::from_chars(member.key.data(), end, label);
    if (error != std::errc{} || stop != end)
      mistakes.add(member.at, path,
                   quote(member.key) + " is not a label; labels are whole numbers");
    const auto name = read_string(member.value, child_path(path, member.key), mistakes);
    if (name && name->empty())
      mistakes.add(member.value.at, child_path(path, member.key), "is empty; name the region");
    labels[label] = name.value_or("");
  }
  return labels;
}

/// The voxels of some images are in a second file, which provenance names, too.
void add_voxel_file(const std::filesystem::path& image, Scene& scene) {
  try {
    const std::filesystem::path voxels = read_image_header(image).data.lexically_normal();
    if (voxels != image) scene.files.push_back(voxels);
  } catch (const InputError&) {  // who reads the voxels says what is wrong
  }
}

/// A body that is filled up to the surface of a file.
FilledBody read_filled(ObjectReader& mesh, const std::string& source, Reading& reading) {
  FilledBody body;
  body.file = read_file(*mesh.find(source), mesh.path_of(source), reading);
  if (const JsonValue* labels = mesh.find("labels")) {
    body.labels = read_label_names(*labels, mesh.path_of("labels"), reading.mistakes);
    add_voxel_file(body.file, reading.scene);
  }
  body.is_shape = source == "file";
  body.size = read_cube_size(mesh);
  body.repair = mesh.boolean("repair").value_or(false);
  return body;
}

/// Keys that only some sources have.
void refuse_keys(ObjectReader& mesh, std::initializer_list<const char*> keys,
                 const std::string& text) {
  for (const char* key : keys)
    if (mesh.find(key) != nullptr) mesh.complain(key, text);
}

std::string nearest_file(const std::filesystem::path& file) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(file.parent_path(), ignored))
    if (entry.is_regular_file(ignored)) names.push_back(entry.path().filename().string());
  return did_you_mean(file.filename().string(), names);
}

/// Why the path is not that of a file to read, or "".
std::string fault_of(const std::filesystem::path& file) {
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if (std::filesystem::is_regular_file(status)) return "";
  if (std::filesystem::is_directory(status))
    return quote(file.string()) + " is a folder; give a file in it";
  if (std::filesystem::exists(status))
    return quote(file.string()) + " is a pipe, a socket or a device; give a regular file";
  return "there is no file " + quote(file.string()) + nearest_file(file) +
         "; paths are relative to the folder of the scene";
}

}  // namespace

std::filesystem::path read_file(const JsonValue& value, const std::string& path, Reading& reading) {
  const auto name = read_string(value, path, reading.mistakes);
  if (!name) return {};
  const std::filesystem::path file = (reading.folder / *name).lexically_normal();
  if (const std::string fault = fault_of(file); !fault.empty())
    reading.mistakes.add(value.at, path, fault);
  reading.scene.files.push_back(file);
  return file;
}

void read_mesh(const JsonValue& value, Reading& reading) {
  ObjectReader mesh(value, "/mesh", reading.mistakes);
  static const std::array<std::string, 4> sources{"box", "file", "voxels", "surface"};
  const bool given = reading.scene.mesh.given != nullptr;
  for (const std::string& key : sources)
    if (given && mesh.find(key) != nullptr)
      mesh.complain(key, "is not allowed here: the program that runs the scene gives the mesh");
  const auto source = given ? std::nullopt : mesh.one_of(sources);
  if (source) {
    const JsonValue& inner = *mesh.find(sources[*source]);
    const std::string path = mesh.path_of(sources[*source]);
    if (*source == 0) read_box(inner, path, reading);
    const bool is_shape =
        *source == 1 && (mesh.find("cells") != nullptr || mesh.find("edge") != nullptr ||
                         mesh.find("labels") != nullptr);
    if (*source == 1 && !is_shape) reading.scene.mesh.file = read_file(inner, path, reading);
    if (*source == 2) read_voxels(inner, path, reading);
    if (*source == 3 || is_shape)
      reading.scene.mesh.filled = read_filled(mesh, sources[*source], reading);
  }

  MeshSource& result = reading.scene.mesh;
  const std::string& kind = sources[source.value_or(1)];
  if (given || kind == "box" || kind == "voxels")
    refuse_keys(mesh, {"scale"},
                "is only allowed with 'file' and 'surface'" +
                    (given ? "" : "; the size of a " + kind + " is given by its own keys"));
  if (!result.filled)
    refuse_keys(
        mesh, {"cells", "edge", "repair"},
        "is only allowed where a body is filled: with 'surface', or with 'file' and 'cells'");
  if (kind != "file") refuse_keys(mesh, {"labels"}, "is only allowed with 'file', an image");
  result.scale = mesh.number("scale", Limits::positive("1"));
  result.merge = mesh.number("merge", Limits::positive("m")).value_or(0);
  if (mesh.find("merge") != nullptr && (kind != "file" || result.filled))
    mesh.complain("merge", "is only allowed with 'file', a mesh of hexahedra");
  static const std::array<std::string, 2> treatments{"split", "refuse"};
  if (mesh.choice("pinched", treatments) == 1u) {
    result.import.non_manifold = ImportOptions::NonManifold::refuse;
  }
  static const std::array<std::string, 2> bad_elements{"refuse", "drop"};
  result.drop_bad_elements = mesh.choice("bad_elements", bad_elements) == 1u;
  result.import.allow_inverted_rest = mesh.boolean("allow_inverted_rest").value_or(false);
  result.import.renumber = mesh.boolean("renumber").value_or(true);
  mesh.finish();
}

}  // namespace suture::scene_parts
