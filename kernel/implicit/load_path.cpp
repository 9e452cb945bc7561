// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/implicit/load_path.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

#include "kernel/base/message_text.hpp"
#include "kernel/dynamics/distortion.hpp"
#include "kernel/dynamics/inversion.hpp"

namespace suture {

void LoadPath::begin(const StepEquations& end, double start) {
  Body& body = motion_.body();
  const double* x = body.attributes().position().rows();
  position_.assign(x, x + std::size_t{body.attributes().vertex_count()} * 4);
  inverted_ = find_inverted(body.complex(), body.attributes());
  unbalanced_.clear();
  failure_ = {};
  start_ = start;
  end_ = end;
}

void LoadPath::hold_back() { unbalanced_ = newton_.residual(equations_at(0)); }

bool LoadPath::drop_prediction() { return std::exchange(end_.is_predicted, false); }

StepEquations LoadPath::equations_at(double part) const {
  StepEquations equations = end_;
  if (part == 1) return equations;
  equations.is_predicted = false;
  equations.time = start_ + std::clamp(part, 0.0, 1.0) * (end_.time - start_);
  equations.loads = {{end_.time, part}};
  const bool has_loads = motion_.last_step() > 0 || start_ > motion_.time();
  if (has_loads) equations.loads.push_back({start_, 1 - part});
  equations.held_back = unbalanced_;
  for (double& force : equations.held_back) force *= 1 - part;
  return equations;
}

double LoadPath::turn(double from, double to) const {
  const double length = end_.time - start_;
  return motion_.body().constraints().largest_turn(start_ + from * length, start_ + to * length);
}

bool LoadPath::try_at(double part) {
  try {
    newton_.solve(equations_at(part));
    accept();
    return true;
  } catch (const StepRejected&) {
    throw;
  } catch (const NumericalError& error) {
    return_from(error);
    return false;
  }
}

void LoadPath::accept() {
  refuse_inversion();
  const double* x = motion_.body().attributes().position().rows();
  std::copy_n(x, position_.size(), position_.begin());
}

void LoadPath::return_from(const NumericalError& error) {
  failure_ = {error.what(), error.element, dynamic_cast<const Unsettled*>(&error) != nullptr};
  std::ranges::copy(position_, motion_.body().attributes().position().rows());
  for_each_with<ConstraintTerm>(motion_.body().terms(),
                                [&](ConstraintTerm& term) { term.begin_step(motion_.time()); });
}

/// Laws that are finite beyond it have equilibria there, which no path leads to.
void LoadPath::refuse_inversion() const {
  Body& body = motion_.body();
  const Inversion found = judge_inversion(body, find_inverted(body, inverted_), forbids_inversion_);
  const Index element = found.turned.empty() ? found.fatal : found.turned.front();
  if (element == none) return;
  const Index number = body.user_element(element);
  throw NumericalError("the solution turns element " + std::to_string(number) + " inside out",
                       number);
}

std::string LoadPath::interval() const {
  std::ostringstream text;
  text << time_text(start_) << " to " << end_.time << " s";
  return text.str();
}

void LoadPath::refuse(const std::string& what, const std::string& how) const {
  std::ostringstream text;
  text << "no equilibrium was found: " << what << " from " << interval() << ' ' << how << ", where "
       << describe(measure_distortion(motion_.body()), motion_.body());
  if (!failure_.reason.empty()) text << "; beyond that, " << failure_.reason;
  if (failure_.is_unsettled) throw Unsettled(text.str(), failure_.element);
  throw NumericalError(text.str(), failure_.element);
}

std::string percent(double part) {
  std::ostringstream text;
  text << 100 * part << " %";
  return text.str();
}

}  // namespace suture
