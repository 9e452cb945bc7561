// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/check_parts.hpp"

#include "kernel/base/error.hpp"

namespace suture {
namespace {

constexpr const char* or_whole_cubes =
    " or fill the surface with whole cubes: 'suture mesh voxelize', and \"file\" in /mesh";
constexpr const char* or_along_faces = " or cut along \"faces\"";

class PartsCheck {
 public:
  /// `by_blade`: cuts make parts.
  explicit PartsCheck(bool by_blade) : by_blade_(by_blade) {}
  void check(const Scene& scene) {
    for (const Obstacle& obstacle : scene.contact.obstacles)
      if (obstacle.coupling)
        add(obstacle.path + "/coupling",
            std::string("needs nodes that move independently of each other, and points of this "
                        "surface share theirs; remove it, so that the tool moves along its path,") +
                or_instead());
  }
  void throw_if_any() const {
    if (!mistakes_.empty()) throw InputError(mistakes_);
  }

 private:
  void add(const std::string& path, const std::string& text) {
    mistakes_ += (mistakes_.empty() ? "" : "\n") + path + ": " + text;
  }
  const char* or_instead() const { return by_blade_ ? or_along_faces : or_whole_cubes; }
  bool by_blade_;
  std::string mistakes_;
};

}  // namespace

void check_parts(const Scene& scene, const Parts& parts) {
  const bool by_blade = scene.divides_elements();
  if (parts.empty() && !by_blade && scene.output.surface)
    throw InputError(
        "/output/surface: is for bodies with \"surface\" in /mesh, and for cuts along a blade; "
        "remove "
        "it, and let the viewer extract the surface of the frames");
  if (parts.empty() && !by_blade) return;
  PartsCheck check(by_blade);
  check.check(scene);
  check.throw_if_any();
}

void check_parts(const Event& event, bool may_grow) {
  if (event.is_along_blade() && !may_grow)
    throw InputError(event.path +
                     "/cut/along: the scene has no cut along a blade, so its models are not "
                     "prepared for parts of elements; set \"divisible\": true in the scene");
}

}  // namespace suture
