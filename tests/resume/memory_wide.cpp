// SPDX-License-Identifier: GPL-3.0-or-later
#define MEMORY_WIDTH 2
#include "memory.cpp"
