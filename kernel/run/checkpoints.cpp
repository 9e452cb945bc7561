// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/checkpoints.hpp"

#include <cmath>

#include "kernel/base/checksum.hpp"
#include "kernel/base/error.hpp"
#include "kernel/run/simulation.hpp"

namespace suture {
namespace {

void add(const Column& column, Checksum& sum) {
  for (Index row = 0; row < column.size(); ++row)
    for (int c = 0; c < column.spec().components; ++c) {
      const double value = column.get(row, c);
      sum.add(std::as_bytes(std::span(&value, 1)));
    }
}

/// The identity of a run: what determines the bits of its results, and where it began.
std::string identity_of(const CheckpointHeader& run, const CheckpointHeader& earlier = {}) {
  Checksum sum;
  const auto add = [&](const std::string& text) {
    sum.add(std::as_bytes(std::span(text.c_str(), text.size() + 1)));
  };
  for (const std::string* text : {&run.program, &run.isa, &run.scene_text, &run.scene_file,
                                  &run.working_folder, &run.mesh_hash, &earlier.run})
    add(*text);
  for (const CheckpointHeader::Plugin& plugin : run.plugins) add(plugin.id + ' ' + plugin.version);
  add(std::to_string(earlier.step));
  return sum.text();
}

}  // namespace

CheckpointHeader checkpoint_header(BuiltScene& built, const PluginHost& host) {
  const Scene& scene = built.scene();
  CheckpointHeader header;
  header.program = "suture " SUTURE_VERSION;
  header.isa = built.body().models().isa();
  header.scene_text = scene.source.text;
  header.scene_file = scene.source.file.string();
  header.working_folder = scene.source.working_folder.string();
  header.scene_hash = scene.hash;
  header.mesh_source = built.mesh_source();
  header.mesh_hash = suture::mesh_hash(built.body());
  for (const ModelUse& use : scene.models) {
    const suture_plugin& plugin = host.plugin_of(*use.model);
    header.plugins.push_back({plugin.id, plugin.version, host.file_of(*use.model).string()});
  }
  header.run = identity_of(header);
  return header;
}

void require_fit(const CheckpointHeader& checkpoint, const CheckpointHeader& run,
                 const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& why) { throw InputError(file.string() + ": " + why); };
  if (checkpoint.program != run.program)
    refuse("it was written by " + checkpoint.program + ", but this is " + run.program +
           "; resume it with that version");
  if (checkpoint.mesh_hash != run.mesh_hash)
    refuse("it was written for a different mesh: " + run.mesh_source +
           " has changed since; restore the file");
  for (std::size_t i = 0; i < checkpoint.plugins.size() && i < run.plugins.size(); ++i) {
    const CheckpointHeader::Plugin &then = checkpoint.plugins[i], &now = run.plugins[i];
    if (then.id != now.id || then.version != now.version)
      throw PluginError(file.string() + ": it was written with the plugin " + then.id + ' ' +
                        then.version + ", but the one found is " + now.id + ' ' + now.version +
                        " (" + now.file + "); install the earlier version");
  }
}

void save_checkpoint(Simulation& run, CheckpointHeader header, const std::filesystem::path& file) {
  header.step = run.step();
  header.time = run.time();
  write_checkpoint(file, std::move(header), run.save());
}

void load_checkpoint(const std::filesystem::path& file, const std::function<void()>& load) {
  try {
    load();
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  } catch (const PluginError& error) {
    throw PluginError(file.string() + ": " + error.what());
  }
}

std::string mesh_hash(Body& body) {
  Checksum sum;
  const auto elements = body.complex().vertices();
  sum.add(std::as_bytes(std::span(elements)));
  const Column& rest = body.attributes().rest();
  sum.add(std::as_bytes(std::span(rest.rows(), std::size_t{rest.size()} * 4)));
  for (const auto& instance : body.attributes().instances())
    for (const Column* column : instance->columns_given_by_cell()) add(*column, sum);
  return sum.text();
}

Checkpoints::Checkpoints(BuiltScene& built, const PluginHost& host,
                         std::shared_ptr<OutputFolder> folder)
    : built_(built), host_(host), options_(built.scene().checkpoint) {
  writing_.folder = std::move(folder);
  if (!options_.enabled) return;
  header_ = checkpoint_header(built, host);
  writing_.keep = options_.keep;
  writing_.folder->set_run(header_.run);
}

bool Checkpoints::is_due(const Clock& clock) const {
  if (!options_.enabled || clock.step() == last_step_) return false;
  if (options_.every_steps > 0) return clock.step() % options_.every_steps == 0;
  if (options_.every > 0)
    return std::floor(clock.time() / options_.every) > std::floor(last_time_ / options_.every);
  const std::chrono::duration<double> since = Wall::now() - written_;
  return options_.minutes > 0 && since.count() >= 60 * options_.minutes;
}

const CheckpointHeader& Checkpoints::header_at(const Clock& clock) {
  header_.step = clock.step();
  header_.time = clock.time();
  return header_;
}

void Checkpoints::write(const CheckpointHeader& header, StateTree&& state) {
  if (!writer_) writer_ = std::make_unique<CheckpointWriter>(writing_);
  writer_->submit(header, std::move(state));
}

void Checkpoints::note_written(const Clock& clock) {
  last_step_ = clock.step();
  last_time_ = clock.time();
  written_ = Wall::now();
}

void Checkpoints::finish() {
  if (writer_) writer_->finish();
}

std::string Checkpoints::newest() const { return writer_ ? writer_->newest().string() : ""; }

/// A run that writes none has no header yet.
void Checkpoints::check(const CheckpointHeader& header, const std::filesystem::path& file) {
  if (!options_.enabled) header_ = checkpoint_header(built_, host_);
  require_fit(header, header_, file);
}

/// Elsewhere than in its own folder, a run that is resumed replaces nothing: the results there may
/// be those of a copy that has gone on differently.
void Checkpoints::take_folder(const CheckpointHeader& header, const std::filesystem::path& file) {
  if (!built_.scene().output.enabled) return;
  OutputFolder& folder = *writing_.folder;
  const bool has_results = header.number > 0;
  folder.continue_run(has_results && same_folder(file.parent_path(), folder.path()) ? header.run
                                                                                    : "");
  header_.run = identity_of(header_, header);
  folder.set_run(header_.run);
}

void Checkpoints::continue_from(const CheckpointHeader& header, const std::filesystem::path& file,
                                const Clock& clock) {
  writing_.resumed_from = file;
  writing_.resumed_number = header.number;
  writer_ = std::make_unique<CheckpointWriter>(writing_);  // keeps the earlier ones
  last_step_ = clock.step();
  last_time_ = clock.time();
}

}  // namespace suture
