// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/notes_on_steps.hpp"

#include <iomanip>
#include <sstream>

#include "kernel/base/message_text.hpp"
#include "kernel/dynamics/motion.hpp"
#include "kernel/forces/nonsmooth_term.hpp"
#include "kernel/implicit/newton.hpp"

namespace suture {
namespace {

// A part of the stiffness: the error of displacements is proportional to less.
constexpr double estimable = 0.2;

std::string note_on_softness(const Dynamics& dynamics) {
  const double softness = dynamics.softness();
  std::ostringstream text;
  text << std::setprecision(3) << "the stiffness depends on the step: steps left out about "
       << 100 * softness << " % of it";
  if (softness >= estimable)
    text << ", which is too much to say what displacements would be without; reduce dt";
  else if (dynamics.compensates())
    text << ", for which cells made up; in bodies of many cells the error that is left is at most "
            "about a tenth of that, "
         << 10 * softness << " %, and half of dt leaves a quarter";
  else
    text << ", so displacements are too large by about as much; half of dt leaves out a quarter of "
            "that";
  return text.str();
}

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
  for_each_with<NonsmoothTerm>(dynamics.motion().body().loads(), [&](const NonsmoothTerm& term) {
    if (const std::string note = term.note(); !note.empty()) notes.push_back(note);
  });
  if (dynamics.softness() > 0) notes.push_back(note_on_softness(dynamics));
  return notes;
}

}  // namespace suture
