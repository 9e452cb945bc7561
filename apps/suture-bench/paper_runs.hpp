// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/suture-bench/report.hpp"

namespace suture::bench {

/// A whole run of `suture run`, and the columns of its probes.csv, by name.
struct ProbeTable {
  int code = 0;    ///< exit code of the run
  double cpu = 0;  ///< s, of the whole process
  std::map<std::string, std::vector<double>> columns{};

  explicit ProbeTable(const nlohmann::json& scene);
  /// NaN if the run has no such column.
  double last(const std::string& column) const;
  /// The value at a time, NaN if the run has no row there.
  double at(double time, const std::string& column) const;
};

/// A moving run of a scene for `end` seconds, and the value in which it ends.
struct SchemeRuns {
  nlohmann::json scene;
  double end, damping;  ///< s, 1/s
  std::string column;
  double scale, equilibrium;

  /// One line for each scheme: explicit steps, and others with steps of which a run costs as much
  /// time as explicit steps do.
  void report_all(const std::string& model, Report& report) const;
};

}  // namespace suture::bench
