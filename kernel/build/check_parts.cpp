// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/check_parts.hpp"

#include "kernel/base/error.hpp"

namespace suture {
namespace {

constexpr const char* acts_on_whole_faces =
    "acts on whole faces of elements, and the surface of this body lies inside of elements; ";
constexpr const char* or_whole_cubes =
    " or fill the surface with whole cubes: 'suture mesh voxelize', and \"file\" in /mesh";

class PartsCheck {
 public:
  void check(const Scene& scene) {
    if (scene.contact.pieces)
      refuse(scene.contact.self ? "/contact/self" : "/contact/pieces", "remove it,");
    for (const Obstacle& obstacle : scene.contact.obstacles)
      if (obstacle.coupling)
        add(obstacle.path + "/coupling",
            std::string("needs nodes that move independently of each other, and points of this "
                        "surface share theirs; remove it, so that the tool moves along its path,") +
                or_whole_cubes);
    for (const Event& event : scene.events) check(event);
    if (scene.output.cuts)
      add("/output/cuts",
          "shows whole faces of elements, and those of this body reach out of it; give "
          "\"surface\": true, whose field \"cut\" marks the faces that were cut");
  }
  void check(const Event& event) {
    if (std::holds_alternative<SewFaces>(event.what)) refuse(event.path + "/suture", "remove it,");
  }
  void throw_if_any() const {
    if (!mistakes_.empty()) throw InputError(mistakes_);
  }

 private:
  void add(const std::string& path, const std::string& text) {
    mistakes_ += (mistakes_.empty() ? "" : "\n") + path + ": " + text;
  }
  void refuse(const std::string& path, const std::string& remedy) {
    add(path, acts_on_whole_faces + remedy + or_whole_cubes);
  }

  std::string mistakes_;
};

}  // namespace

void check_parts(const Scene& scene, const Parts& parts) {
  if (parts.empty() && scene.output.surface)
    throw InputError(
        "/output/surface: is for bodies with \"surface\" in /mesh; remove it, and let the viewer "
        "extract the surface of the frames");
  if (parts.empty()) return;
  PartsCheck check;
  check.check(scene);
  check.throw_if_any();
}

void check_parts(const Event& event, const Parts& parts) {
  if (parts.empty()) return;
  PartsCheck check;
  check.check(event);
  check.throw_if_any();
}

}  // namespace suture
