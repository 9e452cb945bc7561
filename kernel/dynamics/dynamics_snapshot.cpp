// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/dynamics_impl.hpp"

namespace suture {

struct Dynamics::Snapshot::State {
  double time = 0, last_dt = 0;
  Kick pending;
  bool is_pending = false;
  std::vector<double> motion;   ///< x and v, six doubles per vertex
  std::vector<double> columns;  ///< states of the models
  Ledger::State ledger;
};

Dynamics::Snapshot::Snapshot() = default;
Dynamics::Snapshot::Snapshot(Snapshot&&) noexcept = default;
Dynamics::Snapshot& Dynamics::Snapshot::operator=(Snapshot&&) noexcept = default;
Dynamics::Snapshot::~Snapshot() = default;
double Dynamics::Snapshot::time() const { return state_->time; }

void Dynamics::save(Snapshot& snapshot) const {
  if (!snapshot.state_) snapshot.state_ = std::make_unique<Snapshot::State>();
  Snapshot::State& s = *snapshot.state_;
  s.time = impl_->time;
  s.last_dt = impl_->last_dt;
  s.pending = impl_->pending;
  s.is_pending = impl_->is_pending;
  const Index vertices = impl_->attributes.vertex_count();
  const double *x = impl_->attributes.position().rows(), *v = impl_->attributes.velocity().rows();
  s.motion.resize(std::size_t{vertices} * 6);
  double* out = s.motion.data();
  for (Index i = 0; i < vertices; ++i, x += 4, v += 4, out += 6)
    out[0] = x[0], out[1] = x[1], out[2] = x[2], out[3] = v[0], out[4] = v[1], out[5] = v[2];
  s.columns.clear();
  impl_->attributes.save_states(s.columns);
  s.ledger = impl_->ledger.save();
}

void Dynamics::restore(const Snapshot& snapshot) {
  const Snapshot::State& s = *snapshot.state_;
  const Index vertices = impl_->attributes.vertex_count();
  if (s.motion.size() != std::size_t{vertices} * 6)
    throw std::logic_error("a snapshot of other vertices");
  impl_->forget_forces();
  impl_->clear_forces();  // a pass that failed has left some
  impl_->time = s.time;
  impl_->last_dt = s.last_dt;
  impl_->pending = s.pending;
  impl_->is_pending = s.is_pending;
  double *x = impl_->attributes.position().rows(), *v = impl_->attributes.velocity().rows();
  const double* in = s.motion.data();
  for (Index i = 0; i < vertices; ++i, x += 4, v += 4, in += 6)
    x[0] = in[0], x[1] = in[1], x[2] = in[2], v[0] = in[3], v[1] = in[4], v[2] = in[5];
  impl_->attributes.restore_states(s.columns);
  impl_->ledger.restore(s.ledger);
}

}  // namespace suture
