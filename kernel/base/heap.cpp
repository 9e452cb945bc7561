// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/heap.hpp"

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "kernel/base/bulk.hpp"

namespace suture {

void trim_heap() noexcept {
  release_spare_bulk();
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace suture
