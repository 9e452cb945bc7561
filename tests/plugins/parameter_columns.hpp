// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string_view>
#include <vector>

#include "kernel/base/aligned.hpp"
#include "suture/plugin.h"

namespace suture::test {

/// The columns of a model's parameters that may differ from element to element, for batches that
/// are filled by hand: every element has the parameter of the instance.
class ParameterColumns {
 public:
  ParameterColumns(const suture_model& model, const double* parameters) {
    for (std::uint32_t a = 0; a < model.attribute_count; ++a) {
      if ((model.attributes[a].flags & SUTURE_PARAMETER) == 0) continue;
      for (std::uint32_t p = 0; p < model.parameter_count; ++p)
        if (std::string_view(model.parameters[p].name) == model.attributes[a].name)
          columns_[a].assign(std::size_t{8} * model.attributes[a].components, parameters[p]);
      pointers_.push_back(columns_[a].data());
    }
  }
  ParameterColumns(const ParameterColumns&) = delete;

  const double* const* all() const { return pointers_.empty() ? nullptr : pointers_.data(); }
  /// Null unless the attribute holds a parameter.
  const AlignedVector<double>* find(std::uint32_t attribute) const {
    const auto found = columns_.find(attribute);
    return found == columns_.end() ? nullptr : &found->second;
  }

 private:
  std::map<std::uint32_t, AlignedVector<double>> columns_;
  std::vector<const double*> pointers_;
};

}  // namespace suture::test
