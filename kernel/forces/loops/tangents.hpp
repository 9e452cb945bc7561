// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/forces/loops/loops.hpp"

namespace suture::loops {

/// Products of tangents and directions: entries of Table, see there.
void tangents_of_doubles(const Job*, const Worker*, const Rows*, uint32_t count,
                         const Product<double>*);
void tangents_of_floats(const Job*, const Worker*, const Rows*, uint32_t count,
                        const Product<float>*);
void single_tangents(const Job*, const Worker*, const Rows*, uint32_t count, const SingleProduct*);

}  // namespace suture::loops
