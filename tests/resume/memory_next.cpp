// SPDX-License-Identifier: GPL-3.0-or-later
#define MEMORY_VERSION "2.0"
#include "memory.cpp"
