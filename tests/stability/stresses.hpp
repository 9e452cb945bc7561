// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "tests/stability/trial.hpp"

namespace suture::test {

/// One family per stress, with a trial per model and solver. A trial whose scene is null does not
/// apply; its title says why.
std::vector<Family> stress_families();
std::string stress_trial_name(const std::string& stress, unsigned index);

}  // namespace suture::test
