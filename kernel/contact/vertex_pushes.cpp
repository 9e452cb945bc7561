// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/vertex_pushes.hpp"

#include <algorithm>

namespace suture {
namespace {

// Over all contacts between pieces.
constexpr int max_piece_sweeps = 32;

}  // namespace

void VertexPushes::find_touching(const ContactStep& step) {
  std::vector<ContactInProgress::Near>& all = step_.near;
  const std::span<const ContactInProgress::Pushed> pushed = step_.pushed;
  all.erase(all.begin() + std::ptrdiff_t(pushed.size()), all.end());
  shared_.clear();
  pieces_->begin(step.dt, step.whole_gain, *step.moving);
  const DenseSet& touching = pieces_->touching();
  near_place_.assign(touching.items().size(), none);
  for (Index i = 0; i < pushed.size(); ++i) {
    if (!touching.contains(pushed[i].vertex)) continue;
    near_place_[touching.place(pushed[i].vertex)] = i;
    shared_.push_back(i);
  }
  for (std::size_t i = 0; i < near_place_.size(); ++i) {
    if (near_place_[i] != none) continue;
    near_place_[i] = static_cast<Index>(all.size());
    step_.add_near(attributes_, touching.items()[i]);
  }
  pieces_->apply_last_forces();
}

/// After the first sweep, only pieces move vertices.
void VertexPushes::push(double dt) {
  const bool meet = pieces_ && !pieces_->touches().empty();
  bool changes = meet && pieces_->sweep();
  for (std::size_t i = 0; i < step_.pushed.size(); ++i) settle(i, meet, dt);
  for (int sweep = 1; changes && sweep < max_piece_sweeps; ++sweep) {
    changes = pieces_->sweep();
    for (const Index i : shared_)
      if (velocity(i) != step_.pushed[i].settled) settle(i, meet, dt);
  }
  if (!meet) return;
  for (const ContactInProgress::Near& near : std::span(step_.near).subspan(step_.pushed.size()))
    move(near, dt);
}

void VertexPushes::settle(std::size_t i, bool meets, double dt) {
  ContactInProgress::Pushed& pushed = step_.pushed[i];
  const Vec3 before = velocity(i);
  if (meets) move(step_.near[i], dt);
  push_out(i, dt);
  pushed.settled = velocity(i);
  if (meets) pieces_->disturb(pushed.vertex, dt * norm(minus(pushed.settled, before)));
}

/// To where the changed velocity takes it.
void VertexPushes::move(const ContactInProgress::Near& near, double dt) {
  const Vec3 change = minus(row(attributes_.velocity().rows(), near.vertex), near.free_velocity);
  const Vec3 end = plus(near.free_end, scaled(dt, change));
  std::ranges::copy(end, attributes_.position().rows() + 4 * std::size_t{near.vertex});
}

/// Out of one obstacle after the other, until it is in none. What an earlier sweep did is taken
/// back before: other pieces may hold the vertex now.
void VertexPushes::push_out(std::size_t i, double dt) {
  ContactInProgress::Pushed& pushed = step_.pushed[i];
  double* x = attributes_.position().rows() + 4 * std::size_t{pushed.vertex};
  double* v = attributes_.velocity().rows() + 4 * std::size_t{pushed.vertex};
  const Vec3 last = pushed.change;
  const Vec3 end = minus({x[0], x[1], x[2]}, scaled(dt, last));
  const Vec3 velocity = minus({v[0], v[1], v[2]}, last);
  const auto fixed = static_cast<unsigned>(attributes_.fixed().rows()[pushed.vertex]);
  VertexPath path{minus(end, scaled(dt, velocity)), end, {}, fixed, dt};
  step_.push_path(path, step_.pushes_on(i), edge_);
  pushed.change = path.change;
  if (path.change == Vec3{} && last == Vec3{}) return;
  for (std::size_t c = 0; c < 3; ++c) {
    x[c] = path.end[c];
    v[c] = velocity[c] + path.change[c];
  }
}

}  // namespace suture
