// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "kernel/model_check/sample_body.hpp"

namespace suture {

/// What a check found: `figure` is compared with the limit of the check.
struct Measured {
  double figure = 0;
  std::string where;  ///< "node 1, component x, of cell 7: the force is 2, expected 1"
};
/// Nothing if the check does not apply.
using Result = std::optional<Measured>;

/// A law that does not hold at all, without a figure.
class BrokenLaw : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A batch of a functor, with what checks need to call it.
struct BatchCase {
  Instance& instance;
  const CellBatch& batch;
  std::uint64_t seed;
};

/// A body of a model, and the tables of all builds of its plugin that this processor runs.
struct BodyCase {
  SampleBody& sample;
  std::span<const suture_model* const> builds;
};

/// One law that every model obeys.
struct ModelCheck {
  const char* name;  ///< "gradient", for --only
  const char* law;   ///< "force = -dE/dx"
  const char* not_applicable;
  double limit;
  Result (*of_batch)(const BatchCase&);
  Result (*of_body)(const BodyCase&);  ///< exactly one of both is set
  std::uint32_t unless = 0;            ///< not of models that declare one of these flags
};

/// All checks, in the order in which they are made.
std::span<const ModelCheck> model_checks();
/// Throws UsageError with the nearest name if there is none of this name.
const ModelCheck& find_check(const std::string& name);

/// The worst case of a check.
struct CheckOutcome {
  enum class Status { passed, failed, not_applicable } status = Status::not_applicable;
  double figure = 0;
  std::string text;  ///< where the worst figure was found, or why the check does not apply
  // Where the law is broken:
  std::optional<SampleOptions> sample;
  std::optional<CellBatch> batch;
};

/// Makes a check with each parameter set, shape and functor; stops at the first case that fails.
/// Throws the errors of plugins at fault.
CheckOutcome make_check(const ModelCheck& check, std::span<const suture_model* const> builds,
                        std::span<const ParameterSet> sets, std::uint64_t seed);

/// Makes it on one sample only; on a batch, if it is given, in place of those of the sample.
CheckOutcome repeat_check(const ModelCheck& check, std::span<const suture_model* const> builds,
                          const SampleOptions& sample, const std::optional<CellBatch>& batch);

// ------------------------------------------------------------- for the checks --

/// Whether a model declares that its forces are linear in displacements.
inline bool is_linear(const suture_model& model) { return (model.flags & SUTURE_LINEAR) != 0; }
/// The largest absolute value; NaN if one is not finite.
double largest(std::span<const double> values);
/// Largest difference over the largest value of both.
double relative_difference(std::span<const double> a, std::span<const double> b);
/// "node 1, component x, of edge 12".
std::string place_text(const CellBatch& batch, std::size_t place);
/// Where two arrays with the layout of forces differ most, and by how much relative to `scale`.
Measured compare(const CellBatch& batch, std::span<const double> found,
                 std::span<const double> expected, double scale, const char* what);

}  // namespace suture
