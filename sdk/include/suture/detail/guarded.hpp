// SPDX-License-Identifier: MIT
//
// suture/detail/guarded.hpp - runs an author's function: exceptions and forces that are not
// finite become a status and a message. Authors need not read it.
#ifndef SUTURE_DETAIL_GUARDED_HPP
#define SUTURE_DETAIL_GUARDED_HPP

#include <cmath>
#include <cstdio>
#include <cstring>

#include "suture/cell.hpp"

namespace suture::detail {

inline int last_lane(const suture_batch& batch) { return int(batch.valid) - 1; }
inline int last_lane(const suture_single_batch& batch) { return int(batch.lanes) - 1; }

template <class Batch>
void describe(const suture_context* context, const Batch* batch, const failure& f) {
  suture_error* const e = context->error;
  if (!e) return;
  e->code = f.code;
  e->cell = UINT32_MAX;
  if (f.lane >= 0 && batch) {
    const int last = last_lane(*batch);  // later lanes repeat the last valid one
    e->cell = batch->cell_ids[f.lane < last ? f.lane : last];
  }
  e->step_factor = f.step_factor;
  std::snprintf(e->text, sizeof e->text, "%s", f.what());
}

/// Reports an exception other than a failure. Allocates nothing: memory may have run out.
inline suture_status fault(const suture_context* context, const char* thrown) {
  suture_error* const e = context->error;
  if (!e) return SUTURE_FAULT;
  e->code = 0;
  e->cell = UINT32_MAX;
  e->step_factor = 0;
  std::snprintf(e->text, sizeof e->text,
                "the plugin threw an exception (%.256s); catch it, and call suture::stop() or "
                "suture::retry() where the law is not defined",
                thrown);
  return SUTURE_FAULT;
}

/// Runs `work`; an exception becomes a status and a suture_error.
template <class Batch, class Work>
SUTURE_INLINE suture_status guarded(const suture_context* context, const Batch* batch,
                                    Work&& work) noexcept {
  try {
    work();
    return SUTURE_OK;
  } catch (const failure& f) {
    describe(context, batch, f);
    return f.status;
  } catch (const std::exception& e) {
    return fault(context, e.what());
  } catch (...) {
    return fault(context, "of a type that does not derive from std::exception");
  }
}

/// Calls work(lane) for the first lane of every pack of a batch.
template <class Pack = native, class Work>
SUTURE_INLINE suture_status for_packs(const suture_context* context, const batch_of<Pack>* batch,
                                      Work&& work) noexcept {
  return guarded(context, batch, [&] {
    for (int lane = 0; lane < batch_of_scalar<Pack>::lanes; lane += lanes_of<Pack>) work(lane);
  });
}

/// Reports the lane and cause of a force that is not finite; zeroes the forces of the batch.
template <int Nodes>
[[noreturn, gnu::cold, gnu::noinline]] void fail_not_finite(const suture_batch* batch,
                                                            const char* result) {
  int bad = -1;
  for (int lane = 0; lane < int(SUTURE_LANES) && bad < 0; ++lane)
    for (int i = 0; i < Nodes * 3; ++i)
      if (!std::isfinite(batch->force[i * int(SUTURE_LANES) + lane])) bad = lane;
  bool input = true;
  for (int i = 0; i < Nodes * 3; ++i) {
    if (batch->position) input &= std::isfinite(batch->position[i * int(SUTURE_LANES) + bad]) != 0;
    if (batch->velocity) input &= std::isfinite(batch->velocity[i * int(SUTURE_LANES) + bad]) != 0;
  }
  std::memset(batch->force, 0, sizeof(double) * Nodes * 3 * SUTURE_LANES);
  failure f(input ? SUTURE_RETRY : SUTURE_STOP,
            input ? "the " + std::string(result) +
                        " is not finite although positions and velocities are: the cell is outside "
                        "the range in which its law is valid"
                  : "positions or velocities are not finite");
  f.lane = bad;
  throw f;
}

}  // namespace suture::detail

#endif
