// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/evidence.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/dynamics/inversion.hpp"
#include "kernel/output/frame_writer.hpp"
#include "kernel/results/frame_parts.hpp"

namespace suture {
namespace {

enum : std::int64_t { sound = 0, inverted = 1, not_finite = 2 };

bool is_finite(const Vec3& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

void fill_points(BuiltScene& built, Frame& frame) {
  const Column &x = built.body().attributes().position(), &rest = built.body().attributes().rest(),
               &v = built.body().attributes().velocity();
  FrameField displacement{"displacement", 3, {}, {}}, velocity{"velocity", 3, {}, {}};
  for (Index i = 0; i < x.size(); ++i) {
    frame.points.push_back(built.frame().in_scene({x.get(i, 0), x.get(i, 1), x.get(i, 2)}));
    for (int c = 0; c < 3; ++c) {
      displacement.values.push_back(x.get(i, c) - rest.get(i, c));
      velocity.values.push_back(v.get(i, c));
    }
  }
  frame.point_fields = {std::move(displacement), std::move(velocity)};
}

Frame frame_of(BuiltScene& built, double time) {
  Frame frame;
  frame.time = time;
  fill_points(built, frame);
  const auto hexahedra = built.body().complex().vertices();
  frame.hexahedra.assign(hexahedra.begin(), hexahedra.end());
  FrameField failure{"failure", 1, {}, {}};
  failure.ids.assign(frame.hexahedra.size(), sound);
  for (const Index e : find_inverted(built.body().complex(), built.body().attributes()))
    failure.ids[e] = inverted;
  for (std::size_t e = 0; e < frame.hexahedra.size(); ++e)
    if (std::ranges::any_of(frame.hexahedra[e], [&](Index v) {
          return v != none &&  // of an element that was removed
                 (!is_finite(frame.points[v]) ||
                  !std::isfinite(frame.point_fields[1].values[std::size_t{v} * 3]));
        }))
      failure.ids[e] = not_finite;
  frame.cell_fields = {std::move(failure)};
  leave_out(frame, built);
  return frame;
}

}  // namespace

Evidence::Evidence(BuiltScene& built, double time) : failed_(frame_of(built, time)) {}

void Evidence::add_last_good(BuiltScene& built, double time) { good_ = frame_of(built, time); }

std::string Evidence::write(std::shared_ptr<OutputFolder> folder) {
  const auto finite_or = [](double value, double other) {
    return std::isfinite(value) ? value : other;
  };
  for (std::size_t i = 0; i < failed_.points.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      failed_.points[i][c] = finite_or(failed_.points[i][c], good_ ? good_->points[i][c] : 0);
      for (std::size_t f = 0; f < failed_.point_fields.size(); ++f) {
        double& value = failed_.point_fields[f].values[3 * i + c];
        value = finite_or(value, good_ ? good_->point_fields[f].values[3 * i + c] : 0);
      }
    }
  try {
    FrameWriterOptions options;
    options.folder = std::move(folder);
    options.prefix = options.collection = "failed";
    options.background = false;
    FrameWriter writer(options);
    std::size_t number = 0;
    for (Frame* frame : {good_ ? &*good_ : nullptr, &failed_}) {
      if (!frame) continue;
      frame->number = number++;
      writer.submit(std::move(*frame));
    }
    writer.finish();
    return writer.collection() +
           (number == 2 ? " contains the last good state and this one" : " contains this state");
  } catch (const Error& error) {
    return std::string("No frame of this state was written: ") + error.what();
  }
}

}  // namespace suture
