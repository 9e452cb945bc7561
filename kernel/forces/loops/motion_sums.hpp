// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Sums over vertices: kinetic energy, and what a search for rest measures. Included by loops.cpp
// only; internal linkage throughout.

#include "kernel/forces/loops/integrators.hpp"

namespace {

using namespace suture::loops;

/// By the components that are held: 0 for these.
alignas(32) constexpr double free_rows[8][4] = {{1, 1, 1, 0}, {0, 1, 1, 0}, {1, 0, 1, 0},
                                                {0, 0, 1, 0}, {1, 1, 0, 0}, {0, 1, 0, 0},
                                                {1, 0, 0, 0}, {0, 0, 0, 0}};

/// 1 where a component moves, 0 where it is held.
inline Row free_components(double fixed) { return load(free_rows[static_cast<int>(fixed)]); }

double kinetic(const Motion* motion, const double* fixed, uint32_t begin, uint32_t end) {
  const Motion& m = *motion;
  const Row gravity = {m.gravity[0], m.gravity[1], m.gravity[2], 0};
  Row sum = {};
  for (uint32_t i = begin; i < end; ++i) {
    if (m.live && (m.live[i / lanes] >> i % lanes & 1) == 0) continue;
    const uint64_t at = static_cast<uint64_t>(i) * 4;
    const Row v = load(m.velocity + at);
    const Row a = load(m.force + at) / m.mass[i] + gravity;
    const Row kicked = v * m.decay[0] + a * m.gain[0];
    const Row now = v + (kicked - v) * free_components(fixed[i]);
    sum += now * now * m.mass[i];
  }
  return 0.5 * (sum[0] + sum[1] + sum[2]);
}

/// sum m dv^2 of the change dv of the velocities by a kick.
double forcing(const Motion* motion, const double* fixed, uint32_t begin, uint32_t end) {
  const Motion& m = *motion;
  const Row gravity = {m.gravity[0], m.gravity[1], m.gravity[2], 0};
  Row sum = {};
  for (uint32_t i = begin; i < end; ++i) {
    if (m.live && (m.live[i / lanes] >> i % lanes & 1) == 0) continue;
    const uint64_t at = static_cast<uint64_t>(i) * 4;
    const Row a = load(m.force + at) / m.mass[i] + gravity;
    const Row change = a * m.gain[0] - load(m.velocity + at) * (1 - m.decay[0]);
    sum += change * change * free_components(fixed[i]) * m.mass[i];
  }
  return sum[0] + sum[1] + sum[2];
}

RestSums rest_sums(const RestInput* input, uint32_t begin, uint32_t end) {
  const RestInput& in = *input;
  const Row gravity = {in.gravity[0], in.gravity[1], in.gravity[2], 0};
  Row residual = {}, external = {}, reaction = {}, kinetic = {}, work = {}, inertia = {};
  for (uint32_t i = begin; i < end; ++i) {
    const uint64_t at = static_cast<uint64_t>(i) * 4;
    const Row free = free_components(in.fixed[i]);
    const Row weight = gravity * in.mass[i];
    const Row load_here = in.external ? weight + load(in.external + at) : weight;
    const Row f = load(in.force + at), x = load(in.position + at), v = load(in.velocity + at);
    const Row r = f + weight;
    residual += r * r * free;
    reaction += r * r * (1.0 - free);
    external += load_here * load_here * free;
    kinetic += v * v * free * (0.5 * in.mass[i]);
    const Row dx = (x - load(in.old_position + at)) * free;
    work -= dx * (f - load(in.old_force + at));
    inertia += dx * dx * in.mass[i];
    store(in.old_position + at, x);
    store(in.old_force + at, f);
  }
  return {sum3(residual), sum3(external), sum3(reaction), sum3(kinetic), sum3(work), sum3(inertia)};
}

}  // namespace
