// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/failed_check.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "kernel/base/error.hpp"
#include "kernel/base/file.hpp"
#include "kernel/base/input_file.hpp"
#include "kernel/plugin_host/part_functors.hpp"

namespace suture {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no NaN, which stands for the parameters of directions.
Json numbers_to_json(const auto& values) {
  Json list = Json::array();
  for (const double x : values) list.push_back(std::isnan(x) ? Json() : Json(x));
  return list;
}

template <class Values>
Values numbers_from(const Json& list) {
  Values values;
  for (const Json& x : list)
    values.push_back(x.is_null() ? std::numeric_limits<double>::quiet_NaN() : x.get<double>());
  return values;
}

Json columns_to_json(const std::vector<AlignedVector<double>>& columns) {
  Json list = Json::array();
  for (const auto& column : columns) list.push_back(numbers_to_json(column));
  return list;
}

std::vector<AlignedVector<double>> columns_from(const Json& list) {
  std::vector<AlignedVector<double>> columns;
  for (const Json& column : list) columns.push_back(numbers_from<AlignedVector<double>>(column));
  return columns;
}

Json to_json(const SampleOptions& sample) {
  return {{"set", sample.set.name},
          {"values", numbers_to_json(sample.set.values)},
          {"differs", sample.set.differs},
          {"is_first", sample.set.is_first},
          {"shape", static_cast<int>(sample.shape)},
          {"seed", sample.seed},
          {"time", sample.time}};
}

SampleOptions sample_from(const Json& json) {
  SampleOptions sample;
  sample.set = {json.at("set").get<std::string>(),
                numbers_from<std::vector<double>>(json.at("values")),
                json.at("differs").get<bool>(), json.at("is_first").get<bool>()};
  const int shape = json.at("shape").get<int>();
  if (shape < 0 || shape > 3) throw InputError("\"shape\" must be 0, 1, 2 or 3");
  sample.shape = static_cast<SampleShape>(shape);
  sample.seed = json.at("seed").get<std::uint64_t>();
  sample.time = json.value("time", 0.0);
  return sample;
}

Json to_json(const CellBatch& batch) {
  return {{"valid", batch.valid},
          {"time", batch.time},
          {"dt", batch.dt},
          {"cells", batch.ids},
          {"rest", numbers_to_json(batch.rest)},
          {"position", numbers_to_json(batch.position)},
          {"velocity", numbers_to_json(batch.velocity)},
          {"cell_columns", columns_to_json(batch.cell_columns)},
          {"vertex_columns", columns_to_json(batch.vertex_columns)}};
}

CellBatch batch_from(const Json& json) {
  CellBatch batch;
  batch.valid = json.at("valid").get<std::uint32_t>();
  batch.time = json.at("time").get<double>();
  batch.dt = json.at("dt").get<double>();
  batch.ids = json.at("cells").get<decltype(batch.ids)>();
  batch.rest = numbers_from<AlignedVector<double>>(json.at("rest"));
  batch.position = numbers_from<AlignedVector<double>>(json.at("position"));
  batch.velocity = numbers_from<AlignedVector<double>>(json.at("velocity"));
  batch.cell_columns = columns_from(json.at("cell_columns"));
  batch.vertex_columns = columns_from(json.at("vertex_columns"));
  if (batch.valid < 1 || batch.valid > SUTURE_LANES)
    throw InputError("\"valid\" must be from 1 to 8");
  return batch;
}

FailedCheck failed_check_from(const Json& json) {
  FailedCheck failed;
  json.at("suture-check").get_to(failed.check);
  json.at("model").get_to(failed.model);
  json.at("instruction_set").get_to(failed.isa);
  failed.plugin = json.at("plugin").get<std::string>();
  failed.sample = sample_from(json.at("sample"));
  if (!json.contains("batch")) return failed;
  json.at("functor").get_to(failed.functor);
  failed.batch = batch_from(json.at("batch"));
  return failed;
}

const suture_functor& functor_of(const suture_model& model, const std::string& name) {
  for (const suture_functor& functor : std::span(model.functors, model.functor_count))
    if (functor.name == name) return functor;
  for (const suture_functor& functor : std::span(model.functors, model.functor_count))
    if (const suture_functor* part = functor_on_parts(functor); part && part->name == name)
      return *part;
  throw InputError("model '" + std::string(model.id) + "' has no functor '" + name +
                   "': the plugin has changed since the check failed; run check-model again");
}

/// Whether the columns are those of the attributes, for each of `nodes` nodes.
bool fit(const std::vector<AlignedVector<double>>& columns, std::span<const std::uint32_t> places,
         const suture_model& model, std::size_t nodes) {
  if (columns.size() != places.size()) return false;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::size_t components =
        places[i] == UINT32_MAX ? 1 : cell_attribute(model, places[i]).components;
    if (columns[i].size() != nodes * components * SUTURE_LANES) return false;
  }
  return true;
}

}  // namespace

void resolve(FailedCheck& failed, const suture_model& model) {
  if (!failed.batch) return;
  CellBatch& batch = *failed.batch;
  const suture_functor& f = functor_of(model, failed.functor);
  batch.functor = &f;
  bool good =
      fit(batch.cell_columns, {f.cell_columns, f.cell_column_count}, model, 1) &&
      fit(batch.vertex_columns, {f.vertex_columns, f.vertex_column_count}, model, batch.nodes());
  for (const auto* vectors : {&batch.rest, &batch.position, &batch.velocity})
    good = good && vectors->size() == batch.vector_size();
  if (!good)
    throw InputError("the arrays of the batch do not fit functor '" + failed.functor +
                     "': the file is damaged, or the plugin has changed; run check-model again");
}

bool is_failed_check(const std::filesystem::path& file) {
  InputFile input(file);
  char first = 0;
  return input.problem().empty() && input.read({&first, 1}) == 1 && first == '{';
}

FailedCheck read_failed_check(const std::filesystem::path& file) {
  try {
    return failed_check_from(Json::parse(InputFile(file).read_all()));
  } catch (const nlohmann::json::exception& error) {
    throw InputError(file.string() +
                     ": is not a failed check as `suture check-model` writes it: " + error.what());
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
}

void write_failed_check(const std::filesystem::path& file, const FailedCheck& failed) {
  Json json = {{"suture-check", failed.check},
               {"model", failed.model},
               {"plugin", failed.plugin.string()},
               {"instruction_set", failed.isa},
               {"sample", to_json(failed.sample)}};
  if (failed.batch) {
    json["functor"] = failed.functor;
    json["batch"] = to_json(*failed.batch);
  }
  write_file(file, json.dump(1) + "\n");
}

}  // namespace suture
