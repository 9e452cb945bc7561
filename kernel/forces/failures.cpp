// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/failures.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <sstream>
#include <string_view>
#include <tuple>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/forces/force_loop.hpp"

namespace suture {
namespace {

constexpr double default_step_factor = 0.5;  // where a model proposes none

}  // namespace

bool Failure::comes_before(const Failure& other) const {
  // Negative states stop; where both do or both do not, place decides.
  return std::make_tuple(!is_fault_, status_ > 0, functor_, cell_) <
         std::make_tuple(!other.is_fault_, other.status_ > 0, other.functor_, other.cell_);
}

void Failure::note(suture_status status, Index functor, const suture_error& error,
                   const suture_batch& batch) {
  Failure now;
  now.status_ = status;
  now.functor_ = functor;
  now.cell_known_ = error.cell != none;
  now.cell_ = now.cell_known_ ? error.cell
                              : *std::min_element(batch.cell_ids, batch.cell_ids + batch.valid);
  now.code_ = error.code;
  now.text_ = text_of(error);
  const bool proposal = error.step_factor > 0 && error.step_factor < 1;
  if (status > 0) now.step_factor_ = proposal ? error.step_factor : default_step_factor;
  merge(now);
}

void Failure::note_fault(Index functor, const PluginCall& call, std::string text) {
  Failure now;
  now.status_ = SUTURE_STOP;
  now.is_fault_ = true;
  now.functor_ = functor;
  now.cell_ = *std::min_element(call.batch->cell_ids, call.batch->cell_ids + call.batch->valid);
  now.text_ = std::move(text);
  merge(now);
}

void Failure::merge(const Failure& other) {
  if (!other.any()) return;
  const double factor = std::min(step_factor_, other.step_factor_);
  if (!any() || other.comes_before(*this)) *this = other;
  step_factor_ = factor;
}

std::string Failure::packed() const {
  std::ostringstream stream;
  stream.precision(std::numeric_limits<double>::max_digits10);
  stream << status_ << ' ' << is_fault_ << ' ' << functor_ << ' ' << cell_ << ' ' << cell_known_
         << ' ' << code_ << ' ' << step_factor_ << ' ' << text_;
  return stream.str();
}

Failure Failure::unpacked(const std::string& text) {
  std::istringstream stream(text);
  Failure failure;
  stream >> failure.status_ >> failure.is_fault_ >> failure.functor_ >> failure.cell_ >>
      failure.cell_known_ >> failure.code_ >> failure.step_factor_;
  stream.ignore();
  failure.text_.assign(std::istreambuf_iterator<char>(stream), {});
  return failure;
}

void Failure::raise(const std::string& title, const char* cell_word, double time) const {
  if (is_fault_) throw PluginError(timed(time, text_));
  std::string text = timed(time, title);
  if (cell_known_)
    text += std::string(", ") + cell_word + " " + std::to_string(cell_);
  else
    text += std::string(", near ") + cell_word + " " + std::to_string(cell_);
  text += ": " + text_;
  if (code_ != 0) text += " (code " + std::to_string(code_) + ")";
  const std::uint64_t where =
      cell_word == std::string_view("element") ? std::uint64_t{cell_} : NumericalError::nowhere;
  if (status_ > 0) throw StepRejected(text, step_factor_, where);
  throw NumericalError(text, where);
}

}  // namespace suture
