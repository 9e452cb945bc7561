// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/run/simulation.hpp"
#include "tests/stability/runner.hpp"

namespace suture::test {

/// Runs to the end; what the check measures there, or the largest values on the way.
Values run_and_measure(const Check& check, Simulation& simulation, Observer& observer,
                       RunSummary& summary);

/// Largest difference (of a check that looks on the way: excess) relative to the largest value
/// expected; infinite where a value is not finite.
double difference_to(const Check& check, const Values& expected, const Values& values);

/// What a model and a solver do under a stress: right, refused, stopped or warned of, and nothing
/// else.
void judge_stress(const Trial& trial, Result& result);

}  // namespace suture::test
