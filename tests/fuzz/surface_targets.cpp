// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdlib>

#include "kernel/geometry/surface_file.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/fuzz/targets.hpp"

namespace suture::fuzz {
namespace {

void read(const std::string& name, std::string_view bytes) {
  answered([&] {
    const PolygonSoup soup = read_soup(input_file(name, bytes));
    require(soup.offsets.front() == 0 && soup.offsets.back() == soup.corners.size());
    for (std::size_t i = 0; i < soup.size(); ++i) require(soup.offsets[i] <= soup.offsets[i + 1]);
    for (const Index corner : soup.corners) require(corner < soup.points.size());
    for (const Vec3& x : soup.points)
      for (const double c : x) require(std::isfinite(c));
  });
}

}  // namespace

void obj(std::string_view bytes) { read("s.obj", bytes); }
void off(std::string_view bytes) { read("s.off", bytes); }
void ply(std::string_view bytes) { read("s.ply", bytes); }
void stl(std::string_view bytes) { read("s.stl", bytes); }
void vtp(std::string_view bytes) { read("s.vtp", bytes); }

}  // namespace suture::fuzz
