// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/fill_labels.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "kernel/base/vec3.hpp"
#include "kernel/images/label_surface.hpp"
#include "kernel/parts/carry_sets.hpp"
#include "kernel/parts/clip.hpp"
#include "kernel/parts/filled_cubes.hpp"

namespace suture {
namespace {

/// Voxels of a row that belong to the same region.
struct Run {
  std::uint64_t first, count, j, k;
};

/// Calls visit(run, region) for runs, divided into pieces of at most `longest` voxels.
template <class Visit>
void for_each_piece(const LabelImage& image, std::uint64_t longest, Visit&& visit) {
  for (std::uint64_t k = 0; k < image.size[2]; ++k)
    for (std::uint64_t j = 0; j < image.size[1]; ++j) {
      const std::uint16_t* row = image.region_of.data() + image.place(0, j, k);
      for (std::uint64_t i = 0, end = 0; i < image.size[0]; i = end) {
        while (end < image.size[0] && row[end] == row[i] && end - i < longest) ++end;
        if (row[i] != 0) visit(Run{i, end - i, j, k}, static_cast<std::uint16_t>(row[i] - 1));
      }
    }
}

class ContentSum {
 public:
  ContentSum(const LabelImage& image, const FilledCubes& cubes) : image_(image), cubes_(cubes) {
    for (const Vec3& step : image.steps)
      is_straight_ = is_straight_ && std::ranges::count(step, 0.0) == 2;
    const double voxels = cubes.edge() / (2 * norm(image.steps[0]));
    const auto longest = static_cast<std::uint64_t>(std::clamp(voxels, 1.0, 1e9));
    for_each_piece(image, longest, [&](const Run& run, Index region) { add(run, region); });
  }

  /// Ascending by element, then region.
  std::vector<Content> contents() const {
    std::vector<Content> result;
    for (const auto& [key, volume] : volumes_)
      result.push_back(
          {static_cast<Index>(key / regions()), static_cast<Index>(key % regions()), volume});
    std::ranges::sort(result, {}, [&](const Content& c) { return key_of(c.element, c.material); });
    return result;
  }

 private:
  std::uint64_t regions() const { return image_.regions.size(); }
  std::uint64_t key_of(Index element, Index region) const { return element * regions() + region; }

  void add(const Run& run, Index region) {
    std::array<Vec3, 8> corners;
    Box box = no_box;
    for (std::size_t c = 0; c < 8; ++c) {
      corners[c] = image_.corner(double(run.first + (c & 1) * run.count),
                                 double(run.j + (c >> 1 & 1)), double(run.k + (c >> 2)));
      include(box, corners[c]);
    }
    cubes_.for_each_in(box, [&](Index element) {
      const double volume = common_volume(corners, box, cubes_.box_of(element), run);
      if (volume > 0) volumes_[key_of(element, region)] += volume;
    });
  }
  /// Returns the volume that a run has in common with a cube. `corners`, `box`: of the run.
  double common_volume(const std::array<Vec3, 8>& corners, const Box& box, const Box& cube,
                       const Run& run) const {
    double common = 1;
    bool is_within = true;
    for (std::size_t a = 0; a < 3; ++a) {
      common *=
          std::max(0.0, std::min(box.high[a], cube.high[a]) - std::max(box.low[a], cube.low[a]));
      is_within = is_within && box.low[a] >= cube.low[a] && box.high[a] <= cube.high[a];
    }
    if (is_straight_ || common == 0) return common;
    if (is_within) return double(run.count) * image_.voxel_volume();
    double sum = 0;
    for (const auto& tetrahedron : tetrahedra_of(corners)) sum += volume_within(tetrahedron, cube);
    return sum;
  }

  const LabelImage& image_;
  const FilledCubes& cubes_;
  bool is_straight_ = true;  ///< the axes of the image are those of the scene, in some order
  std::unordered_map<std::uint64_t, double> volumes_;  ///< by element and region
};

}  // namespace

Mesh fill_labels(const LabelImage& image, const CubeSize& size, Diagnostics& diagnostics) {
  Mesh mesh = fill_surface(surface_of(image), size, diagnostics);
  std::map<std::string, std::vector<Index>> sets;
  for (Index region = 0; region < image.regions.size(); ++region)
    sets[image.regions[region]] = {region};
  carry_sets(ContentSum(image, FilledCubes(mesh)).contents(), sets, mesh, diagnostics);
  return mesh;
}

}  // namespace suture
