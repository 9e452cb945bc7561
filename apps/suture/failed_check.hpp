// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "kernel/model_check/check_list.hpp"

namespace suture {

/// A case in which a model breaks a law, as `suture check-model` writes it and `suture replay`
/// repeats it. JSON; numbers are exact.
struct FailedCheck {
  std::string check, model, isa;
  std::filesystem::path plugin;
  SampleOptions sample;
  std::string functor;             ///< of the batch; empty: the law of a whole body
  std::optional<CellBatch> batch;  ///< its functor is null until the model is loaded
};

/// Whether the file could be one: JSON.
bool is_failed_check(const std::filesystem::path& file);
/// Throws InputError with the file and what is wrong.
FailedCheck read_failed_check(const std::filesystem::path& file);
/// Gives the batch its functor. Throws InputError if the model has none of this name, or one with
/// other arrays.
void resolve(FailedCheck& failed, const suture_model& model);
/// Throws IoError.
void write_failed_check(const std::filesystem::path& file, const FailedCheck& failed);

}  // namespace suture
