// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <span>

#include "kernel/base/escape.hpp"
#include "kernel/plugin_host/output_fields.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

/// The fields that models bring, by where their values lie.
struct ModelFields {
  std::vector<std::string> of_cells;    ///< of vertices and elements: in frames and probes
  std::vector<std::string> of_springs;  ///< of edges: in the series of springs
  std::vector<std::string> of_faces;    ///< in the series of faces

  void add(std::uint32_t dimension, const char* name) {
    if (dimension == 0 || dimension == 3) of_cells.emplace_back(name);
    if (dimension == 1) of_springs.emplace_back(name);
    if (dimension == 2) of_faces.emplace_back(name);
  }
};

// Columns marked for output and the fields of the output extension of functors.
ModelFields model_fields(const Scene& scene) {
  ModelFields names;
  for (const ModelUse& use : scene.models) {
    for (std::uint32_t i = 0; use.model != nullptr && i < use.model->attribute_count; ++i) {
      const suture_attribute& attribute = use.model->attributes[i];
      if (is_shown(attribute)) names.add(attribute.dimension, attribute.name);
    }
    for (std::uint32_t i = 0; use.model != nullptr && i < use.model->functor_count; ++i) {
      const suture_functor& functor = use.model->functors[i];
      for (const suture_field& field : output_fields(functor))
        names.add(functor.dimension, field.name);
    }
  }
  return names;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool has_stress(const Scene& scene) {
  return std::ranges::any_of(scene.models, [](const ModelUse& use) {
    return use.model != nullptr && provides_field(*use.model, 3, "stress", 6);
  });
}

std::vector<std::string> known_fields(const Scene& scene) {
  std::vector<std::string> names = standard_fields();
  if (has_stress(scene)) names.insert(names.end(), stress_fields().begin(), stress_fields().end());
  if (scene.contact.is_wanted())
    names.insert(names.end(), contact_fields().begin(), contact_fields().end());
  for (std::string& name : model_fields(scene).of_cells) {
    if (!contains(names, name)) names.push_back(std::move(name));
  }
  return names;
}

// A model that could not be found might know any name.
bool all_models_found(const Scene& scene) {
  return std::all_of(scene.models.begin(), scene.models.end(),
                     [](const ModelUse& use) { return use.model != nullptr; });
}

/// Some model has functors on cells of this dimension.
bool has_functors(const Scene& scene, std::uint32_t dimension) {
  return std::ranges::any_of(scene.models, [&](const ModelUse& use) {
    const std::span functors(use.model->functors, use.model->functor_count);
    return std::ranges::any_of(functors, [&](const auto& f) { return f.dimension == dimension; });
  });
}

/// A series of files with the cells of functors of one dimension.
bool read_series(ObjectReader& object, const char* key, std::uint32_t dimension, const char* cells,
                 Reading& reading) {
  const bool wanted = object.boolean(key).value_or(false);
  if (wanted && all_models_found(reading.scene) && !has_functors(reading.scene, dimension))
    object.complain(key, std::string("no model of this scene has ") + cells +
                             ", so every file would be empty; remove this key");
  return wanted;
}

/// Why a name that exists elsewhere is not a field of frames and probes of this scene: it belongs
/// to a separate series, or the scene lacks what it is computed from. Otherwise "".
std::string other_place(const ModelFields& fields, const std::string& name) {
  if (contains(fields.of_springs, name))
    return " is a value on springs, not on nodes or elements; set \"springs\": true in /output to "
           "write it for every spring";
  if (contains(fields.of_faces, name))
    return " is a value of faces, not of nodes or elements; \"faces\": true in /output writes it "
           "for every face";
  if (contains(stress_fields(), name))
    return " is computed from the element field 'stress', which no model of this scene provides; "
           "use a model that does, such as tm-faure, or remove this name";
  if (contains(contact_fields(), name))
    return " is a value of contact, and the scene has none; give /contact obstacles or pieces, or "
           "remove this name";
  return "";
}

/// Names of fields, each once. Values of springs and faces have places of their own.
std::vector<std::string> read_names(const std::vector<JsonValue>& items, const std::string& path,
                                    const std::vector<std::string>& known, Reading& reading) {
  const ModelFields fields = model_fields(reading.scene);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const JsonValue& item = items[i];
    const std::string item_path = child_path(path, i);
    const std::string place = contains(known, item.text) ? "" : other_place(fields, item.text);
    if (!place.empty()) {
      reading.mistakes.add(item.at, item_path, quote(item.text) + place);
      continue;
    }
    const auto index = read_choice(item, item_path, known, reading.mistakes);
    if (!index) continue;
    if (contains(names, known[*index]))
      reading.mistakes.add(item.at, item_path, "given a second time");
    names.push_back(known[*index]);
  }
  return names;
}

void read_fields(ObjectReader& object, Reading& reading) {
  std::vector<std::string>& fields = reading.scene.output.fields;
  fields = {"displacement"};
  const JsonValue* value = object.find("fields");
  if (value == nullptr) return;
  const std::string path = object.path_of("fields");
  const auto* items = read_array(*value, path, "names", reading.mistakes);
  if (items == nullptr) return;
  fields.clear();
  if (all_models_found(reading.scene))
    fields = read_names(*items, path, known_fields(reading.scene), reading);
}

void read_rhythm(ObjectReader& object, Reading& reading) {
  OutputOptions& output = reading.scene.output;
  if (object.find("every") != nullptr && object.find("every_steps") != nullptr) {
    object.complain("must have 'every' (s) or 'every_steps', not both");
  }
  output.every = object.number("every", Limits::positive("s")).value_or(0);
  output.every_steps = object.natural("every_steps", 1).value_or(0);
  const SolverOptions& solver = reading.scene.solver;
  const bool none = output.every == 0 && output.every_steps == 0;
  if (none && solver.integrator == "static") output.every_steps = 1;  // "frames" of /solver/static
  if (output.every > 0 && solver.dt && output.every < *solver.dt) {
    reading.warn(object.find("every")->at, "/output/every",
                 "is shorter than a step; a frame is written at every step");
  }
}

void read_probe_fields(ObjectReader& object, Reading& reading, Probe& probe) {
  static const std::array<std::string, 4> reductions{"mean", "sum", "min", "max"};
  if (const auto choice = object.choice("of", reductions))
    probe.of = static_cast<Probe::Of>(*choice);
  const JsonValue* value = object.find("fields");
  if (value == nullptr) return;
  const std::string path = object.path_of("fields");
  const auto* items = read_array(*value, path, "names", reading.mistakes);
  if (items == nullptr) return;
  if (items->empty()) {
    object.complain(
        "fields", "is empty; name a field, or remove the key for position, displacement and force");
  }
  if (!all_models_found(reading.scene)) return;
  std::vector<std::string> known{"position"};
  for (std::string& name : known_fields(reading.scene)) known.push_back(std::move(name));
  probe.fields = read_names(*items, path, known, reading);
}

Probe read_probe(ObjectReader& object, Reading& reading) {
  const OutputOptions& output = reading.scene.output;
  Probe probe;
  probe.path = object.path();
  object.require("name", "the name of the columns in probes.csv");
  probe.name = object.string("name").value_or("");
  if (object.find("name") != nullptr && !is_good_name(probe.name)) {
    object.complain("name", "must consist of letters, digits, '_', '-' and '.'");
  }
  for (const Probe& earlier : output.probes) {
    if (earlier.name == probe.name) {
      object.complain(
          "name",
          "'" + probe.name + "' is already the name of an earlier probe; names must be unique");
    }
  }
  static const std::array<std::string, 2> kinds{"point", "where"};
  const auto kind = object.one_of(kinds);
  if (kind == 0u) {
    probe.where.what =
        Selection::Nearest{object.vector("point", Limits::any("m")).value_or(Vec3{})};
    probe.where.path = object.path_of("point");
    probe.at_point = true;
  } else if (kind == 1u) {
    probe.where = read_selection(*object.find("where"), object.path_of("where"), object.mistakes());
  }
  read_probe_fields(object, reading, probe);
  return probe;
}

void require_obstacles(ObjectReader& object, const char* key, const Reading& reading) {
  if (reading.scene.contact.obstacles.empty())
    object.complain(key,
                    "needs obstacles, and the scene has none; add /contact/obstacles, or remove "
                    "this key");
}

void read_tables(ObjectReader& object, Reading& reading) {
  OutputOptions& output = reading.scene.output;
  if (const JsonValue* value = object.find("energies")) {
    ObjectReader energies(*value, object.path_of("energies"), object.mistakes());
    output.energies_every = energies.natural("every_steps", 1).value_or(1);
    energies.finish();
  }
  if (const JsonValue* value = object.find("tools")) {
    ObjectReader tools(*value, object.path_of("tools"), object.mistakes());
    output.tools_every = tools.natural("every_steps", 1).value_or(1);
    tools.finish();
    if (std::ranges::none_of(reading.scene.events, [](const Event& event) {
          return std::holds_alternative<Grasp>(event.what);
        }))
      require_obstacles(object, "tools", reading);
  }
  if (const JsonValue* value = object.find("probes")) {
    ObjectReader probes(*value, object.path_of("probes"), object.mistakes());
    output.probes_every = probes.natural("every_steps", 1).value_or(1);
    probes.require("at", "an array of {\"name\", \"point\"} or {\"name\", \"where\"}");
    for_each_object(probes, "at", "probes", [&](ObjectReader& probe) {
      output.probes.push_back(read_probe(probe, reading));
    });
    probes.finish();
  }
}

void read_directory(ObjectReader& object, Reading& reading) {
  OutputOptions& output = reading.scene.output;
  const std::string standard = "out/" + reading.scene.file.stem().string();
  const std::string directory = object.string("directory").value_or(standard);
  if (directory.empty()) object.complain("directory", "must not be empty");
  const JsonValue* value = object.find("directory");
  const bool is_named = value != nullptr && value->at.set != 0;  // by --output or --set
  if (!is_named && !reading.resumed_folder.empty()) {
    output.directory = reading.resumed_folder;
    return;
  }
  const std::filesystem::path here = std::filesystem::current_path();
  output.directory =
      ((is_named ? here : reading.working_folder) / (directory.empty() ? standard : directory))
          .lexically_normal();
  if (is_named) return;
  output.root = here;
  if (*output.directory.lexically_relative(output.root).begin() == "..")
    object.complain("directory", "leads out of the folder where suture runs, " +
                                     output.root.string() +
                                     "; name a folder below it, or this one on the command line: "
                                     "--output '" +
                                     output.directory.string() + "'");
}

/// A run that writes tables only has no use for what frames contain.
void read_frames(ObjectReader& object, OutputOptions& output) {
  output.frames = object.boolean("frames").value_or(true);
  if (output.frames) return;
  for (const char* key : {"every", "every_steps", "fields", "compression", "pieces", "springs",
                          "faces", "cuts", "obstacles", "surface"})
    if (object.find(key) != nullptr)
      object.complain(key, "is about frames, but \"frames\" is false; remove one of the two");
}

}  // namespace

void read_output(const JsonValue* value, Reading& reading) {
  OutputOptions& output = reading.scene.output;
  JsonValue defaults;  // what an absent object stands for
  defaults.kind = JsonValue::Kind::object;
  defaults.at = {1, 1};
  output.enabled = value == nullptr || value->kind != JsonValue::Kind::boolean || value->boolean;
  const bool is_flag = value != nullptr && value->kind == JsonValue::Kind::boolean;
  ObjectReader object(value == nullptr || is_flag ? defaults : *value, "/output", reading.mistakes);
  read_directory(object, reading);
  read_frames(object, output);
  read_rhythm(object, reading);
  read_fields(object, reading);
  static const std::array<std::string, 3> compressions{"none", "lz4", "zlib"};
  if (const auto choice = object.choice("compression", compressions)) {
    output.compression = static_cast<OutputOptions::Compression>(*choice);
  }
  output.pieces = object.boolean("pieces").value_or(false);
  read_tables(object, reading);
  output.springs = read_series(object, "springs", 1, "springs (functors on edges)", reading);
  output.faces = read_series(object, "faces", 2, "functors on faces", reading);
  output.cuts = object.boolean("cuts").value_or(false);
  output.surface = object.boolean("surface").value_or(false);
  output.obstacles = object.boolean("obstacles").value_or(false);
  if (output.obstacles) require_obstacles(object, "obstacles", reading);
  object.finish();
}

void read_checkpoint(const JsonValue* value, Reading& reading) {
  if (value == nullptr) return;
  CheckpointOptions& checkpoint = reading.scene.checkpoint;
  ObjectReader object(*value, "/checkpoint", reading.mistakes);
  checkpoint.enabled = true;
  if (!reading.scene.output.enabled) {
    object.complain(
        "needs an output folder, but \"output\" is false; add an output or remove the checkpoint");
  }
  const std::array<std::string, 3> rhythms{"every_steps", "every", "minutes"};
  if (std::count_if(rhythms.begin(), rhythms.end(),
                    [&](const std::string& key) { return object.find(key) != nullptr; }) > 1) {
    object.complain(
        "must have at most one of 'every_steps', 'every' (s of simulated time) and 'minutes' "
        "(wall-clock time)");
  }
  checkpoint.every_steps = object.natural("every_steps", 1).value_or(0);
  checkpoint.every = object.number("every", Limits::positive("s")).value_or(0);
  checkpoint.minutes = object.number("minutes", Limits::positive("min")).value_or(0);
  constexpr unsigned max_kept = 1'000'000;
  checkpoint.keep =
      static_cast<unsigned>(object.natural("keep", 1, max_kept).value_or(checkpoint.keep));
  const SolverOptions& solver = reading.scene.solver;
  if (checkpoint.every > 0 && solver.dt && checkpoint.every < *solver.dt) {
    reading.warn(object.find("every")->at, object.path_of("every"),
                 "is shorter than a step; a checkpoint is written at every step");
  }
  object.finish();
}

}  // namespace suture::scene_parts
