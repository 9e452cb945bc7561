// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scenes with which defects were seen, and what they must do now.
#include <iterator>

#include "tests/stability/draft.hpp"

namespace suture::test {
namespace {

struct Named {
  const char* what;
  Expected expected;
  const char* scene;
};

const Named scenes[] = {{"a twist by 15 degrees", Expected::right, R"({
      "suture": 1, "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [20, 5, 5]}},
      "models": [{"model": "tm-faure", "parameters": {"E": 4e5, "nu": 0.3, "rho": 1000}}],
      "constraints": [{"fix": "xyz", "where": {"set": "x0"}},
        {"move": {"rotation": {"axis": [1, 0, 0], "angle": 15, "centre": [0, 0.125, 0.125]}},
         "ramp": 1.0, "where": {"set": "x1"}}],
      "solver": {"until": "rest"}, "output": false})"},
                        {"a pull, then a cut", Expected::right, R"({
      "suture": 1, "mesh": {"box": {"size": [1, 1, 1], "cells": [8, 4, 4]}},
      "models": [{"model": "tm-faure", "parameters": {"E": 3000, "nu": 0.25, "rho": 1}}],
      "constraints": [{"where": {"set": "x0"}, "fix": "xyz"},
        {"where": {"set": "x1"}, "move": {"translation": [0.1, 0, 0]}, "ramp": 0.3}],
      "solver": {"end": 1},
      "events": [{"at": 0.5, "cut": {"plane": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}}}],
      "output": false})"},
                        {"a stretch by 40 %", Expected::right, R"({
      "suture": 1, "mesh": {"box": {"size": [1, 0.5, 0.5], "cells": [6, 3, 3]}},
      "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
      "constraints": [{"fix": "xyz", "where": {"set": "x0"}},
        {"move": {"translation": [0.4, 0, 0]}, "ramp": 2.0, "where": {"set": "x1"}}],
      "solver": {"until": "rest"}, "output": false})"},
                        {"a stretch by 60 % over 2 s", Expected::right, R"({
      "suture": 1, "mesh": {"box": {"size": [1, 0.5, 0.5], "cells": [6, 3, 3]}},
      "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
      "constraints": [{"fix": "xyz", "where": {"set": "x0"}},
        {"move": {"translation": [0.6, 0, 0]}, "ramp": 2.0, "where": {"set": "x1"}}],
      "solver": {"end": 4}, "output": false})"},
                        {"a hanging block", Expected::right, R"({
      "suture": 1, "mesh": {"box": {"size": [0.3, 0.1, 0.1], "cells": [12, 4, 4]}},
      "models": [{"model": "tm-faure", "parameters": {"E": 1e4, "nu": 0.25, "rho": 1000}}],
      "gravity": [9.8, 0, 0], "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
      "solver": {"end": 10}, "output": false})"},
                        {"a hanging block of 5 kPa", Expected::right, R"({
      "suture": 1, "mesh": {"box": {"size": [0.3, 0.1, 0.1], "cells": [6, 2, 2]}},
      "models": [{"model": "tm-faure", "parameters": {"E": 5e3, "nu": 0.25, "rho": 1000}}],
      "gravity": [9.8, 0, 0], "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
      "solver": {"end": 30}, "output": false})"},
                        {"a spinning body", Expected::right, R"({
      "suture": 1, "mesh": {"box": {"size": [0.5, 0.2, 0.2], "cells": [10, 4, 4]}},
      "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
      "constraints": [{"move": {"rotation": {"axis": [0.1, 0.3, 1], "angle": 180,
        "centre": [0.3, 0.1, 0.1]}}, "ramp": 0.5, "where": {"set": "x0"}}],
      "solver": {"end": 100, "on_inversion": "warn"},
      "events": [{"at": 0.45, "pierce": {"where": {"box": {"min": [-1, -1, -1],
        "max": [0.1, 1, 1]}}}, "shape": "rest"}],
      "output": false})"},
                        {"springs under their weight, unwatched", Expected::right, R"({
      "suture": 1, "mesh": {"box": {"size": [0.3, 0.15, 0.15], "cells": [4, 2, 2]}},
      "models": [{"model": "mss-baudet", "parameters": {"E": 4e3, "nu": 0.25, "rho": 1000}}],
      "gravity": [0, -9.8, 0], "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
      "solver": {"end": 1}, "output": false})"},
                        {"a column at ten times its Euler load", Expected::buckles, R"({
      "suture": 1, "mesh": {"box": {"size": [1, 0.1, 0.1], "cells": [20, 4, 4]}},
      "models": [{"model": "tm-faure", "parameters": {"E": 1e6, "nu": 0.3, "rho": 1000}}],
      "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
      "loads": [{"traction": [-2e4, 0, 0], "where": {"set": "x1"}, "ramp": 3.0}],
      "solver": {"until": "rest"}, "output": false})"},
                        {"corrected springs at a quarter of the weight", Expected::right, R"({
      "suture": 1, "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [40, 10, 10]}},
      "models": [{"model": "mss-baudet", "parameters": {"E": 4e5, "nu": 0.3, "rho": 1000,
        "correction": true}}],
      "gravity": [0, -2.45, 0], "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
      "solver": {"until": "rest", "tolerance": 1e-4}, "output": false})"},
                        {"a ramp of 1 us", Expected::right, R"({
      "suture": 1, "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [12, 3, 3]}},
      "models": [{"model": "tm-faure", "parameters": {"E": 4e5, "nu": 0.3, "rho": 1000}}],
      "constraints": [{"fix": "xyz", "where": {"set": "x0"}},
        {"move": {"translation": [0, 0.01, 0]}, "ramp": 1e-6, "where": {"set": "x1"}}],
      "solver": {"end": 10}, "output": false})"},
                        {"a body 10,000 km away", Expected::right, R"({
      "suture": 1, "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [12, 3, 3],
        "origin": [1e7, -1e7, 1e7]}},
      "models": [{"model": "tm-faure", "parameters": {"E": 4e5, "nu": 0.3, "rho": 1000}}],
      "gravity": [0, -2, 0], "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
      "solver": {"end": 10}, "output": false})"},
                        {"an end that no run reaches", Expected::refused, R"({
      "suture": 1, "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [4, 1, 1]}},
      "models": [{"model": "tm-faure", "parameters": {"E": 4e5, "nu": 0.3, "rho": 1000}}],
      "gravity": [0, -2, 0], "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
      "solver": {"end": 1e19, "max_steps": 20000}, "output": false})"},
                        {"a traction for stretch 1.15 at once", Expected::right, R"({
      "suture": 1, "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [12, 3, 3]}},
      "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
      "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
      "loads": [{"traction": [18543, 0, 0], "where": {"set": "x1"}}],
      "solver": {"end": 30}, "output": false})"}};

void named(Draft& d) {
  const Named& named = scenes[d.index];
  d.trial.title = named.what;
  d.trial.scene = Json::parse(named.scene);
  d.trial.expected = named.expected;
  d.trial.scene["solver"]["threads"] = 1;
  d.trial.is_conservative = false;  // judged by the ledger alone
  d.trial.stable = stable_step_of(d.trial);
}

}  // namespace

std::vector<Family> trial_families() {
  return {{"named", static_cast<unsigned>(std::size(scenes)), named}};
}

}  // namespace suture::test
