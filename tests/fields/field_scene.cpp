// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fields/field_scene.hpp"

#include <cmath>

#include "kernel/scene/scene_reader.hpp"

namespace suture::test {

PluginHost& plugins() {
  static PluginHost host;
  return host;
}

Scene field_scene(const std::string& members) {
  Diagnostics diagnostics;
  return read_scene_text(R"({"suture": 1, "output": false, )" + members + "}", "field.json", {},
                         lookup_of(plugins()), diagnostics);
}

Scene bar(int n, const std::string& solver, const std::string& more) {
  return field_scene(R"("mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [)" + std::to_string(n) +
                     R"(, 1, 1]}}, "models": [{"model": "heat", "parameters": {"k": 2, "c": 4,
                     "rho": 1}}], "constraints": [{"fix": "xyz", "where": "all"}], "solver": {)" +
                     solver + "}, " + more);
}

FieldRun& FieldRun::run_to(double time) {
  simulation.run_to(time, observer);
  return *this;
}

double FieldRun::value(Index vertex) const {
  return simulation.attributes().fields().front().values->get(vertex, 0);
}

std::vector<double> FieldRun::values() const {
  std::vector<double> values;
  for (Index v = 0; v < simulation.attributes().vertex_count(); ++v) values.push_back(value(v));
  return values;
}

double FieldRun::at(double x) const {
  double sum = 0, count = 0;
  for (Index v = 0; v < simulation.attributes().vertex_count(); ++v) {
    if (std::abs(simulation.attributes().rest().get(v, 0) - x) > 1e-9) continue;
    sum += value(v);
    ++count;
  }
  return sum / count;
}

double FieldRun::error(const std::function<double(double)>& exact) const {
  double largest = 0;
  for (Index v = 0; v < simulation.attributes().vertex_count(); ++v)
    largest =
        std::max(largest, std::abs(value(v) - exact(simulation.attributes().rest().get(v, 0))));
  return largest;
}

}  // namespace suture::test
