// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <string>

namespace suture {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The number in a file of one word; infinite for "max" and without the file.
double number_in(const char* file) {
  std::ifstream in(file);
  double number = 0;
  return in >> number ? number : infinity;
}

double available_to_all() {
  std::ifstream in("/proc/meminfo");
  for (std::string key, rest; in >> key; std::getline(in, rest)) {
    double kilobytes = 0;
    if (key == "MemAvailable:" && in >> kilobytes) return 1024 * kilobytes;
  }
  return infinity;
}

/// Version 2, or 1.
double limit_of_group() {
  return std::min(number_in("/sys/fs/cgroup/memory.max"),
                  number_in("/sys/fs/cgroup/memory/memory.limit_in_bytes"));
}

double limit_of_process() {
  rlimit limit{};
  const bool is_known = getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return is_known ? double(limit.rlim_cur) : infinity;
}

/// By this process: its addresses, and what is in memory.
std::array<double, 2> used() {
  std::array<double, 2> pages{};
  std::ifstream("/proc/self/statm") >> pages[0] >> pages[1];
  for (double& x : pages) x *= double(sysconf(_SC_PAGESIZE));
  return pages;
}

}  // namespace

double available_memory() {
  const auto [addresses, resident] = used();
  return std::max(0.0, std::min({available_to_all(), limit_of_group() - resident,
                                 limit_of_process() - addresses}));
}

}  // namespace suture
