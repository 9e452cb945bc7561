// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/notes_on_steps.hpp"

#include <iomanip>
#include <sstream>

#include "kernel/base/message_text.hpp"
#include "kernel/implicit/newton.hpp"

namespace suture {
namespace {

// A part of the stiffness: the error of displacements is proportional to less.
constexpr double estimable = 0.2;

}  // namespace

std::string note_on(const Newton::Iteration& i, const Newton& newton) {
  std::ostringstream text;
  text << "Newton iteration " << i.number;
  if (i.coarse_nodes > 0) {
    text << " on " << i.coarse_nodes << " coarse nodes: residual " << i.residual / i.scale
         << " of the first one, step " << i.step;
    return text.str();
  }
  text << ": residual " << i.residual / i.scale << " of the forces, " << i.linear_iterations
       << " linear iterations (" << newton.preconditioner() << "), step " << i.step
       << (i.indefinite ? ", the tangent is indefinite" : "");
  return text.str();
}

std::string rounding_warning(Dynamics& dynamics, double tolerance) {
  const Newton* newton = dynamics.newton();
  if (!newton || newton->limited_steps() == 0) return "";
  std::ostringstream text;
  text << "rounding kept the residual of " << count_text(newton->limited_steps(), "step")
       << " above the tolerance of " << tolerance << " of the forces, at "
       << newton->rounding_limit() << ": the tolerance is below rounding error";
  return text.str();
}

std::vector<std::string> notes_on_steps(Dynamics& dynamics) {
  std::vector<std::string> notes;
  const Newton* newton = dynamics.newton();
  if (newton && !newton->budget_text().empty()) notes.push_back(newton->budget_text());
  const double softness = dynamics.softness();
  std::ostringstream text;
  if (dynamics.compensates()) {
    text << "cells were stiffer by what steps would have left out of the stiffness; of it, about "
         << std::setprecision(3) << 100 * softness << " % is still missing";
    if (softness == 0) text << ", but for the error of this estimate";
    text << "; compare with half of dt";
    notes.push_back(text.str());
  } else if (softness > 0) {
    text << "the stiffness depends on the step: steps left out about " << std::setprecision(3)
         << 100 * softness << " % of it";
    if (softness < estimable)
      text << ", so displacements are too large by about as much; half of dt leaves out a quarter "
              "of that";
    else
      text << ", which is too much to say what displacements would be without; reduce dt";
    notes.push_back(text.str());
  }
  return notes;
}

}  // namespace suture
