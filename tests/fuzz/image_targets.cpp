// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "kernel/images/label_image.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/fuzz/targets.hpp"

namespace suture::fuzz {
namespace {

void read(const std::string& name, std::string_view bytes) {
  answered([&] {
    Diagnostics diagnostics;
    const LabelImage image = read_labels(input_file(name, bytes), {.memory = 1e7}, diagnostics);
    require(image.region_of.size() == image.size[0] * image.size[1] * image.size[2]);
    for (const auto region : image.region_of) require(region <= image.regions.size());
    require(std::isfinite(image.voxel_volume()) && image.voxel_volume() > 0);
  });
}

}  // namespace

void mha(std::string_view bytes) { read("s.mha", bytes); }
void nii(std::string_view bytes) { read("s.nii", bytes); }
void nrrd(std::string_view bytes) { read("s.nrrd", bytes); }

}  // namespace suture::fuzz
