// SPDX-License-Identifier: GPL-3.0-or-later
//
// For LD_PRELOAD: the first checkpoint takes 6 seconds to get its name.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

int renameat(int from_folder, const char* from, int to_folder, const char* to) {
  static atomic_flag is_over = ATOMIC_FLAG_INIT;
  if (strstr(to, "checkpoint_") && !atomic_flag_test_and_set(&is_over)) sleep(6);
  int (*next)(int, const char*, int, const char*) = NULL;
  *(void**)&next = dlsym(RTLD_NEXT, "renameat");
  return next(from_folder, from, to_folder, to);
}
