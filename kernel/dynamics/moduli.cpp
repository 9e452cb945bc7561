// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/moduli.hpp"

#include <numeric>

#include "kernel/base/vec3.hpp"
#include "kernel/base/zeroed_vector.hpp"
#include "kernel/forces/sum_of_blocks.hpp"

namespace suture {

/// Each of several processes has the rows that it needs for its own vertices.
double sum_of_moduli(Body& body, const UniformGradient& gradient, double time) {
  ForceLoop& models = body.models();
  PartialRows& partial = body.attributes().partial_rows();
  const bool divides = models.may_divide();
  if (divides && !models.knows_share()) models.find_share();
  const PartialRows::OwnIsEnough enough(partial, divides);
  const Column& position = body.attributes().position();
  ZeroedVector<double> u(3 * std::size_t{position.size()}), image(u.size());
  const PartialRows::Range all{0, position.size()};
  for (const auto& [first, end] : divides ? partial.known() : std::span(&all, 1))
    for (Index v = first; v < end; ++v)
      for (std::size_t c = 0; c < 3; ++c)
        u[3 * std::size_t{v} + c] =
            dot(gradient[c], Vec3{position.get(v, 0), position.get(v, 1), position.get(v, 2)});
  if (divides)
    models.add_own_tangent(u.data(), -1, 0, time, image.data());
  else
    models.add_tangent(u.data(), -1, 0, time, image.data());
  return sum_of_blocks(divides ? body.share() : nullptr, position.size(), BodyShare::block,
                       [&](Index first, Index end) {
                         return std::inner_product(&u[3 * std::size_t{first}],
                                                   u.data() + 3 * std::size_t{end},
                                                   &image[3 * std::size_t{first}], 0.0);
                       });
}

}  // namespace suture
