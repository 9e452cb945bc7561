// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kernel/mesh/box.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "tests/dynamics/rig.hpp"

namespace rig {

/// A block of one model, with its rig.
struct Model : suture::Body {
  Model(const std::string& id, std::map<std::string, double> wanted,
        std::array<suture::Index, 3> cells, double cell)
      : suture::Body(imported(cells, cell)) {
    static suture::PluginHost host;
    const suture_model& model = host.model(id);
    std::vector<double> values;
    for (const suture_parameter& p : std::span(model.parameters, model.parameter_count))
      values.push_back(wanted.contains(p.name) ? wanted[p.name] : p.default_value);
    suture::Diagnostics diagnostics;
    attributes().add(std::make_unique<suture::Instance>(model, id, values, diagnostics), complex(),
                     {});
    compile(diagnostics);
  }
  static suture::Imported imported(std::array<suture::Index, 3> cells, double cell) {
    suture::Diagnostics diagnostics;
    const suture::Vec3 size{cell * cells[0], cell * cells[1], cell * cells[2]};
    return suture::import_mesh(suture::make_box({.size = size, .cells = cells}), {}, diagnostics);
  }
};

struct Block : Model, Rig {
  Block(const std::string& id, const std::map<std::string, double>& wanted,
        std::array<suture::Index, 3> cells, double cell, const Options& options)
      : Model(id, wanted, cells, cell), Rig(*this, options) {}
  suture::Vec3 rest(suture::Index v) {
    const suture::Column& rest = attributes().rest();
    return {rest.get(v, 0), rest.get(v, 1), rest.get(v, 2)};
  }
  std::vector<suture::Index> vertices(const auto& chosen) {
    std::vector<suture::Index> found;
    for (suture::Index v = 0; v < attributes().vertex_count(); ++v)
      if (chosen(rest(v))) found.push_back(v);
    return found;
  }
};

/// A cantilever along z, 0.25 x 0.25 x 1 m, under a quarter of its weight; the ledger has begun.
/// Its held end may move. `across`: cells over its height.
struct Cantilever : Block {
  Cantilever(const std::string& id, const std::map<std::string, double>& wanted, Options options,
             const suture::PrescribedMotion& motion = {}, suture::Index across = 2)
      : Block(id, wanted, {across, across, 4 * across}, 0.25 / across, heavy(std::move(options))) {
    hold(vertices([](const suture::Vec3& x) { return x[2] < 1e-9; }), 7, motion);
    start();
  }
  static Options heavy(Options options) {
    options.gravity = {0, -2.45, 0};
    return options;
  }
  /// Mean displacement of the free end, m.
  double tip() {
    double sum = 0;
    const auto end = vertices([](const suture::Vec3& x) { return x[2] > 1 - 1e-9; });
    for (const suture::Index v : end) sum += shift(v, 1) / static_cast<double>(end.size());
    return sum;
  }
};

}  // namespace rig
