// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// A function that is compiled for several instruction sets; the loader chooses. For loops over 8
/// lanes. It must call nothing that is not inlined. Contraction of products and sums is switched
/// off for these sources (CMakeLists.txt), so the results are the same for all.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define SUTURE_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define SUTURE_CLONES
#endif
