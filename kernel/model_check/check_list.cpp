// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/model_check/check_list.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/model_check/checks.hpp"

namespace suture {
namespace {

constexpr const char* no_energy = "no functor has an energy";
constexpr const char* no_tangent = "not every functor has a tangent";
constexpr const char* not_inner = "its functors act between the body and the world";
constexpr const char* no_rate = "no functor changes a field";
constexpr double any = std::numeric_limits<double>::infinity();

// Limits are far above the rounding of sound models (1e-16 to 1e-12, by differences 1e-11, in
// single precision 1e-6), and far below what a wrong term changes.
constexpr ModelCheck all_checks[] = {
    {"outputs", "every output is set, and nothing else", "", 0, checks::outputs, nullptr},
    {"inputs", "results depend on declared inputs only", "", 1e-12, checks::declared_inputs,
     nullptr},
    {"lanes", "each cell of a batch is computed for itself", "", 1e-12, checks::lanes, nullptr},
    {"repetition", "equal calls give equal bits, in any thread", "", 0, checks::repetition,
     nullptr},
    {"bad-states", "what is not finite gives a status", "no functor reads positions", 0,
     checks::bad_states, nullptr},
    {"gradient", "force = -dE/dx", no_energy, 1e-6, checks::gradient, nullptr},
    {"tangent", "tangent = df/dx and df/dv", no_tangent, 1e-6, checks::tangent, nullptr},
    {"single-tangent", "the tangent in single precision is that in double",
     "no functor offers suture.tangent-single/1", 1e-3, checks::single_tangent, nullptr},
    {"step-bounds", "the bounds of the stable step are bounds",
     "no functor offers both bounds and "
     "a tangent",
     1e-2, checks::step_bounds, nullptr},
    {"balance", "forces and torques of a cell sum to zero", not_inner, 1e-9, checks::balance,
     nullptr},
    {"translation", "the place of a body does not matter", "", 1e-9, checks::translation, nullptr},
    {"objectivity", "forces turn with the body", not_inner, 1e-9, checks::objectivity, nullptr,
     SUTURE_LINEAR},
    {"orientation", "no axis of space is different", not_inner, 1e-8, nullptr, checks::orientation},
    {"shapes", "functors of different shapes agree", "general hexahedra only", 1e-5, nullptr,
     checks::shapes},
    {"patch", "parts of elements have the mean gradient of their material",
     "the model is no continuum that runs on parts of elements", 1e-11, checks::patch, nullptr},
    {"rest", "a body at rest is in equilibrium",
     "it has no stiffness, or acts on vertices or faces", 1e-9, nullptr, checks::rest,
     SUTURE_ACTIVE},
    {"stiffness", "the stiffness at rest is not negative", "it has no stiffness, or acts on faces",
     1e-9, nullptr, checks::stiffness, SUTURE_ACTIVE},
    {"mass", "mass is positive and follows the volume", "the model gives no mass", 1e-9, nullptr,
     checks::mass},
    {"cut", "a cut keeps mass and momentum, and adds no energy", not_inner, 1e-9, nullptr,
     checks::cut},
    {"regions", "two halves are a whole", not_inner, 1e-9, nullptr, checks::regions},
    {"instances", "instances do not disturb each other", "", 0, nullptr, checks::instances},
    {"parameters", "every number has an effect", "", 0, nullptr, checks::parameters},
    {"slopes", "forces have derivatives by parameters, which add up over elements",
     "no number has a derivative", 1e-4, nullptr, checks::slopes},
    {"state", "states follow time, not steps", "the model has no state", 0.75, checks::state,
     nullptr},
    {"order", "the error of states falls with the step, along a changing strain",
     "the model has no state", any, checks::order, nullptr},
    {"builds", "all instruction sets give the same forces", "there is one build only", 1e-9,
     nullptr, checks::builds},
    {"allocations", "no function of a functor allocates memory", "", 0, checks::no_allocation,
     nullptr},
    {"rates", "what flows out of nodes flows into others, and rates have symmetric derivatives",
     no_rate, 1e-6, checks::rates, nullptr},
    {"field-cut", "capacities are positive, and cuts and seams keep the content of fields", no_rate,
     1e-11, nullptr, checks::field_cut},
    {"coupling", "what the motion gives to a field is what the field takes from the motion",
     "no rate depends on the motion", 1e-5, nullptr, checks::coupling},
    {"speed", "ns per cell", "", any, checks::speed, nullptr}};

std::string text_of_sample(const SampleOptions& sample) {
  return sample.set.name + ", " + sample_shapes[static_cast<int>(sample.shape)];
}

/// Makes one check on one sample after the other, and keeps the worst case.
class Checking {
 public:
  Checking(const ModelCheck& check, std::span<const suture_model* const> builds)
      : check_(check), builds_(builds) {
    outcome_.text = check.not_applicable;
  }

  /// Returns false once the law is broken. A sample whose parameters or shape the model refuses is
  /// passed over.
  bool on(const SampleOptions& options, const std::optional<CellBatch>& given = {}) {
    std::unique_ptr<SampleBody> sample;
    try {
      sample = std::make_unique<SampleBody>(*builds_.front(), options);
    } catch (const InputError& error) {
      if (refusal_.empty()) refusal_ = error.what();
      return true;
    } catch (const PluginError& error) {
      return note(options, nullptr, [&]() -> Result { throw BrokenLaw(error.what()); });
    }
    accepted_ = true;
    if (check_.of_body != nullptr) {
      const BodyCase of{*sample, builds_};
      return note(options, nullptr, [&] { return check_.of_body(of); });
    }
    if (given) return on_batch(*sample, *given);
    for (const suture_functor* functor : sample->functors())
      for (const CellBatch& batch : sample->batches(*functor, 2))
        if (!on_batch(*sample, batch)) return false;
    return true;
  }

  CheckOutcome outcome() {
    if (!accepted_ && !refusal_.empty())
      throw PluginError(
          "the model accepts none of the values with which it is checked (give others "
          "with --set NAME=VALUE): " +
          refusal_);
    return std::move(outcome_);
  }

 private:
  bool on_batch(SampleBody& sample, const CellBatch& batch) {
    const BatchCase of{sample.instance(), batch, sample.options().seed};
    return note(sample.options(), &batch, [&] { return check_.of_batch(of); });
  }

  template <class Make>
  bool note(const SampleOptions& sample, const CellBatch* batch, Make make) {
    using enum CheckOutcome::Status;
    Result result;
    std::string broken;
    try {
      result = make();
    } catch (const BrokenLaw& law) {
      broken = law.what();
    } catch (const Error& error) {
      broken = error.what();
    }
    if (!result && broken.empty()) return true;
    const bool fails = !broken.empty() || !(result->figure <= check_.limit);
    const bool is_worst =
        outcome_.status == not_applicable || fails || result->figure > outcome_.figure;
    if (!is_worst) return true;
    outcome_.status = fails ? failed : passed;
    outcome_.figure = result ? result->figure : 0;
    outcome_.text = result ? result->where : broken;
    const std::string functor =
        batch ? "functor '" + std::string(batch->functor->name) + "', " : "";
    if (!outcome_.text.empty()) outcome_.text += " (" + functor + text_of_sample(sample) + ")";
    if (fails) {
      outcome_.sample = sample;
      if (batch != nullptr) outcome_.batch = *batch;
    }
    return !fails;
  }

  const ModelCheck& check_;
  std::span<const suture_model* const> builds_;
  CheckOutcome outcome_;
  std::string refusal_;  ///< the first one
  bool accepted_ = false;
};

}  // namespace

std::span<const ModelCheck> model_checks() { return all_checks; }

const ModelCheck& find_check(const std::string& name) {
  std::vector<std::string> names;
  for (const ModelCheck& check : all_checks) {
    if (check.name == name) return check;
    names.emplace_back(check.name);
  }
  throw UsageError("there is no check " + quote(name) + did_you_mean(name, names) +
                   "; `suture check-model --list` lists them");
}

CheckOutcome make_check(const ModelCheck& check, std::span<const suture_model* const> builds,
                        std::span<const ParameterSet> sets, std::uint64_t seed) {
  if (const std::uint32_t flags = builds.front()->flags & check.unless; flags != 0) {
    CheckOutcome outcome;
    outcome.text = flags == SUTURE_LINEAR ? "declared linear" : "declared active";
    return outcome;
  }
  Checking checking(check, builds);
  for (const ParameterSet& set : sets) {
    const std::vector<double> times = sample_times(*builds.front(), set);
    for (const SampleShape shape :
         {SampleShape::boxes, SampleShape::parallelepipeds, SampleShape::hexahedra,
          SampleShape::parts, SampleShape::general_parts}) {
      SampleOptions options;
      options.set = set;
      options.shape = shape;
      options.seed = seed;
      options.time = times[static_cast<std::size_t>(shape) % times.size()];
      if (!checking.on(options)) return checking.outcome();
    }
  }
  return checking.outcome();
}

CheckOutcome repeat_check(const ModelCheck& check, std::span<const suture_model* const> builds,
                          const SampleOptions& sample, const std::optional<CellBatch>& batch) {
  Checking checking(check, builds);
  checking.on(sample, batch);
  return checking.outcome();
}

// ------------------------------------------------------------- for the checks --

double largest(std::span<const double> values) {
  double value = 0;
  for (const double x : values)
    if (!(std::abs(x) <= value)) value = std::abs(x);
  return value;
}

double relative_difference(std::span<const double> a, std::span<const double> b) {
  const double scale = std::max(largest(a), largest(b));
  double difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(std::abs(a[i] - b[i]) <= difference)) difference = std::abs(a[i] - b[i]);
  return scale == 0 ? 0 : difference / scale;
}

std::string place_text(const CellBatch& batch, std::size_t place) {
  constexpr const char* cells[] = {"vertex", "edge", "face", "element"};
  const std::size_t row = place / SUTURE_LANES;
  return "node " + std::to_string(row / 3) + ", component " + std::to_string(row % 3) + ", of " +
         cells[batch.functor->dimension] + " " + std::to_string(batch.ids[place % SUTURE_LANES]);
}

Measured compare(const CellBatch& batch, std::span<const double> found,
                 std::span<const double> expected, double scale, const char* what) {
  double difference = -1;
  std::size_t place = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i % SUTURE_LANES >= batch.valid) continue;
    if (std::abs(found[i] - expected[i]) <= difference) continue;
    difference = std::abs(found[i] - expected[i]);
    place = i;
    if (std::isnan(difference)) break;
  }
  std::ostringstream text;
  text << what << " on " << place_text(batch, place) << " is " << found[place] << ", expected "
       << expected[place];
  return {difference == 0 ? 0 : difference / scale, text.str()};
}

}  // namespace suture
