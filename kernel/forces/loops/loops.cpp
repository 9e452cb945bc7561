// SPDX-License-Identifier: GPL-3.0-or-later
//
// Compiled three times (base, x86-64-v3, x86-64-v4); see loops.hpp. Built with
// -ffp-contract=off, so that an integrator rounds the same whether two half
// kicks are fused into one pass or not, and on every instruction set.

#include "kernel/forces/loops/loops.hpp"

#include "kernel/base/reset_error.hpp"
#include "kernel/forces/loops/lanes.hpp"
#include "kernel/forces/loops/stretch.hpp"

namespace {

using namespace suture::loops;

#if defined(__AVX512F__)
constexpr const char* isa_name = "avx512";
#elif defined(__AVX2__)
constexpr const char* isa_name = "avx2";
#else
constexpr const char* isa_name = "base";
#endif

// ------------------------------------------------------------------- gather --

inline uint32_t cell_of(const Job& job, uint32_t row) { return job.cells ? job.cells[row] : row; }

/// The rows of a whole block: most batches of most bodies. Numbers, not an array.
struct BlockRows {
  uint32_t first;
  static constexpr uint32_t valid = lanes;
};
inline uint32_t row_in(const BlockRows& rows, uint32_t l) { return rows.first + l; }
inline uint32_t row_in(const BatchRows& rows, uint32_t l) { return rows.row[l]; }

/// Rows row .. row+valid-1, which all live; lanes behind the last repeat it.
inline BatchRows rows_of_block(uint32_t row, uint32_t valid) {
  BatchRows rows;
  rows.valid = valid;
  for (uint32_t l = 0; l < lanes; ++l) rows.row[l] = row + (l < valid ? l : valid - 1);
  return rows;
}

template <uint32_t N>
inline __attribute__((always_inline)) Cells<N> find_cells(const Job& job, const BatchRows& rows) {
  Cells<N> cells;
  for (uint32_t l = 0; l < lanes; ++l)
    cells.nodes[l] = job.nodes + static_cast<uint64_t>(cell_of(job, rows.row[l])) * N;
  return cells;
}

template <class R>
inline void fill_ids(const Job& job, const R& rows, uint32_t* ids) {
  for (uint32_t l = 0; l < lanes; ++l) {
    const uint32_t r = row_in(rows, l), cell = cell_of(job, r);
    ids[l] = job.row_ids ? job.row_ids[r] : job.ids ? job.ids[cell] : cell;
  }
}

template <uint32_t N, class C>
inline __attribute__((always_inline)) void gather_rows(const double* rows, const C& cells,
                                                       double* out) {
  for (uint32_t n = 0; n < N; ++n) gather_node(rows, cells, n, out + n * 3 * lanes);
}

/// Vertex columns into scratch; returns the first free double behind them.
template <uint32_t N, class C>
double* gather_vertex_columns(const Job& job, const Worker& worker, const C& cells) {
  double* out = worker.scratch;
  for (uint32_t i = 0; i < job.vertex_column_count; ++i) {
    const VertexColumn& column = job.vertex_columns[i];
    worker.vertex_columns[i] = out;
    for (uint32_t n = 0; n < N; ++n, out += column.components * lanes)
      for (uint32_t l = 0; l < lanes; ++l) {
        const uint32_t vertex = cells.vertex(l, n);
        const uint64_t row = column.rows ? column.rows[vertex] : vertex;
        for (uint32_t c = 0; c < column.components; ++c)
          out[c * lanes + l] = column.data[row * column.stride + c];
      }
  }
  return out;
}

/// Columns of the cells are read in place if the batch is a block from its beginning on;
/// behind the last row of a table they repeat it. Those of vertices lie in rows.
inline bool in_place(const Job& job, const BatchRows& rows) {
  if (job.node_count == 1) return false;
  if (rows.row[0] % lanes != 0 || (job.live && rows.valid != lanes)) return false;
  return rows.row[rows.valid - 1] - rows.row[0] + 1 == rows.valid;
}

/// Where a component of a row is.
inline uint64_t place_in(const CellColumn& column, uint32_t row, uint32_t component) {
  if (column.stride != 0) return static_cast<uint64_t>(row) * column.stride + component;
  return row / lanes * column.block + component * lanes + row % lanes;
}

/// Otherwise the lanes are moved to the front, through scratch.
void move_cell_columns(const Job& job, const Worker& worker, const BatchRows& rows, double* spare) {
  for (uint32_t i = 0; i < job.cell_column_count; ++i) {
    const CellColumn& column = job.cell_columns[i];
    const uint32_t doubles = column.components * lanes;
    for (uint32_t k = 0; k < doubles; ++k)
      spare[k] = column.data[place_in(column, rows.row[k % lanes], k / lanes)];
    worker.cell_columns[i] = spare;
    worker.trial_columns[i] = column.trial ? spare + doubles : nullptr;
    spare += 2 * doubles;
  }
}

void point_to_cell_columns(const Job& job, const Worker& worker, const BlockRows& rows, double*) {
  const uint64_t block = rows.first / lanes;
  for (uint32_t i = 0; i < job.cell_column_count; ++i) {
    const CellColumn& column = job.cell_columns[i];
    worker.cell_columns[i] = column.data + block * column.block;
    worker.trial_columns[i] = column.trial ? column.trial + block * column.block : nullptr;
  }
}

void point_to_cell_columns(const Job& job, const Worker& worker, const BatchRows& rows,
                           double* spare) {
  if (!in_place(job, rows)) return move_cell_columns(job, worker, rows, spare);
  point_to_cell_columns(job, worker, BlockRows{rows.row[0]}, spare);
}

inline void return_trials(const Job&, const Worker&, const BlockRows&) {}

/// Trial values of lanes that were moved go home.
void return_trials(const Job& job, const Worker& worker, const BatchRows& rows) {
  if (in_place(job, rows)) return;
  for (uint32_t i = 0; i < job.cell_column_count; ++i) {
    const CellColumn& column = job.cell_columns[i];
    if (!column.trial) continue;
    for (uint32_t c = 0; c < column.components; ++c)
      for (uint32_t l = 0; l < rows.valid; ++l)
        column.trial[place_in(column, rows.row[l], c)] = worker.trial_columns[i][c * lanes + l];
  }
}

/// Rest positions of cells that have their own instead of their vertices'.
template <class R>
void take_own_rest(const Job& job, const R& rows, double* rest) {
  const uint32_t nodes = job.node_count;
  for (uint32_t l = 0; l < lanes; ++l) {
    const uint32_t slot = job.rest_slots[cell_of(job, row_in(rows, l))];
    if (slot == UINT32_MAX) continue;
    const double* own = job.own_rest + static_cast<uint64_t>(slot) * nodes * 4;
    for (uint32_t n = 0; n < nodes; ++n)
      for (uint32_t c = 0; c < 3; ++c) rest[(n * 3 + c) * lanes + l] = own[n * 4 + c];
  }
}

template <uint32_t N, class R, class C>
inline __attribute__((always_inline)) void gather_batch(const Job& job, const Worker& worker,
                                                        const R& rows, const C& cells,
                                                        Buffers& buffers, suture_batch& batch) {
  batch.valid = rows.valid;
  if (job.position) gather_rows<N>(job.position, cells, buffers.position);
  if (job.rest) gather_rows<N>(job.rest, cells, buffers.rest);
  if (job.velocity) gather_rows<N>(job.velocity, cells, buffers.velocity);
  double* spare = worker.scratch;
  if (job.vertex_column_count != 0) spare = gather_vertex_columns<N>(job, worker, cells);
  if (job.cell_column_count != 0) point_to_cell_columns(job, worker, rows, spare);
  fill_ids(job, rows, buffers.ids);
}

/// What stands where nothing is gathered.
alignas(64) constexpr double zeros[8 * 3 * lanes] = {};

void begin_batches(const Job& job, const Worker& worker, Buffers& buffers, suture_batch& batch) {
  batch.size = sizeof batch;
  batch.lanes = lanes;
  batch.valid = 0;
  batch.nodes = job.node_count;
  batch.time = job.time;
  batch.dt = job.dt;
  batch.rest = job.rest ? buffers.rest : zeros;
  batch.position = job.position ? buffers.position : zeros;
  batch.velocity = job.velocity ? buffers.velocity : zeros;
  batch.cell_columns = job.cell_column_count != 0 ? worker.cell_columns : nullptr;
  batch.vertex_columns = job.vertex_column_count != 0 ? worker.vertex_columns : nullptr;
  batch.cell_ids = buffers.ids;
  batch.force = nullptr;
  batch.trial_columns = job.has_trial ? worker.trial_columns : nullptr;
}

// ------------------------------------------------------------------- forces --

template <uint32_t N, class R, class C>
inline __attribute__((always_inline)) void one_batch(const Job& job, const Worker& worker,
                                                     const R& rows, const C& cells,
                                                     Buffers& buffers, suture_batch& batch) {
  gather_batch<N>(job, worker, rows, cells, buffers, batch);
  if (job.rest_slots && job.rest) take_own_rest(job, rows, buffers.rest);
  suture::reset(*worker.context->error);
  const suture_status status = job.function(worker.context, &batch);
  if (status != 0) worker.failed(worker.data, status, &batch);
  for (uint32_t n = 0; n < N; ++n)
    scatter_node(job.force, cells, n, rows.valid, batch.force + n * 3 * lanes);
  if (job.has_trial) return_trials(job, worker, rows);
}

/// One batch after the other, each in `batch`.
template <uint32_t N>
inline __attribute__((always_inline)) void forces_in(const Job& job, const Worker& worker,
                                                     const Rows& range, Buffers& buffers,
                                                     suture_batch& batch) {
  const uint32_t end = range.end;
  for (uint32_t row = range.begin; row < end;) {
    const uint32_t to_block = lanes - row % lanes;
    const uint32_t here = end - row < to_block ? end - row : to_block;
    const bool whole = !job.live || job.live[row / lanes] == 0xFF;
    if (N > 1 && here == lanes && !job.cells && whole) {
      const Block<N> cells{job.nodes + static_cast<uint64_t>(row) * N};
      one_batch<N>(job, worker, BlockRows{row}, cells, buffers, batch);
    } else {
      const BatchRows rows = whole ? rows_of_block(row, here) : live_rows(job.live, row, here);
      if (rows.valid != 0)
        one_batch<N>(job, worker, rows, find_cells<N>(job, rows), buffers, batch);
    }
    row += here;
  }
}

template <uint32_t N>
void forces_of(const Job& job, const Worker& worker, const Rows* ranges, uint32_t count) {
  Buffers buffers;
  alignas(64) double force[N * 3 * lanes];
  suture_batch batch;
  begin_batches(job, worker, buffers, batch);
  batch.force = force;
  *worker.present = &batch;
  try {
    for (uint32_t i = 0; i < count; ++i) forces_in<N>(job, worker, ranges[i], buffers, batch);
  } catch (...) {
    worker.thrown(worker.data);
  }
  *worker.present = nullptr;
}

void forces(const Job* job, const Worker* worker, const Rows* ranges, uint32_t count) {
  if (job->node_count == 1) return forces_of<1>(*job, *worker, ranges, count);
  if (job->node_count == 2) return forces_of<2>(*job, *worker, ranges, count);
  if (job->node_count == 4) return forces_of<4>(*job, *worker, ranges, count);
  forces_of<8>(*job, *worker, ranges, count);
}

template <uint32_t N>
void gather_one(const Job& job, const Worker& worker, const BatchRows& rows, Buffers& buffers,
                suture_batch& batch) {
  begin_batches(job, worker, buffers, batch);
  gather_batch<N>(job, worker, rows, find_cells<N>(job, rows), buffers, batch);
  if (job.rest_slots && job.rest) take_own_rest(job, rows, buffers.rest);
  suture::reset(*worker.context->error);
}

void gather(const Job* job, const Worker* worker, const BatchRows* rows, Buffers* buffers,
            suture_batch* batch) {
  if (job->node_count == 1) return gather_one<1>(*job, *worker, *rows, *buffers, *batch);
  if (job->node_count == 2) return gather_one<2>(*job, *worker, *rows, *buffers, *batch);
  if (job->node_count == 4) return gather_one<4>(*job, *worker, *rows, *buffers, *batch);
  gather_one<8>(*job, *worker, *rows, *buffers, *batch);
}

// -------------------------------------------------------------- integrators --

/// Number of rows by which a pass prefetches: with three columns written, the
/// processor's own prefetcher left a third of the time waiting (9.5 -> 6 ns per vertex on the
/// 60 x 60 x 120 grid).
constexpr uint32_t prefetch_distance = 24;

typedef double Row __attribute__((vector_size(32), aligned(32)));
/// Two rows side by side: a register of AVX-512, two of AVX2.
typedef double TwoRows __attribute__((vector_size(64), aligned(32)));
typedef double Eight __attribute__((vector_size(64), aligned(8)));
typedef int64_t Places __attribute__((vector_size(64)));

template <class V = Row>
inline V load(const double* p) {
  return *reinterpret_cast<const V*>(p);
}
template <class V>
inline void store(double* p, V v) {
  *reinterpret_cast<V*>(p) = v;
}

/// Sums of a pass, lane by lane; `zero` stays zero unless a velocity is infinite or no number.
struct RowSums {
  Row zero, before, after, inertia;
};
struct TwoRowSums {
  TwoRows zero, before, after, inertia;
};

/// Moves the vertices of a row or two.
template <int Kicks, bool Drift, class V, class S>
inline __attribute__((always_inline)) void move(const Motion& m, uint64_t at, V inverse, V mass,
                                                V gravity, S& sums) {
  const V a = load<V>(m.force + at) * inverse + gravity;
  const V before = load<V>(m.velocity + at);
  V v = before * m.decay[0] + a * m.gain[0];
  if (Kicks == 2) v = v * m.decay[1] + a * m.gain[1];
  const V momentum = v * mass;
  sums.zero += v * 0.0;
  sums.before += a * before * mass;
  sums.after += a * momentum;
  sums.inertia += v * momentum;
  store(m.velocity + at, v);
  if (Drift) {
    store(m.position + at, load<V>(m.position + at) + v * m.drift);
    store(m.force + at, V{});
  }
}

/// A block that is not whole, or of which only some vertices live.
template <int Kicks, bool Drift>
void move_some(const Motion& m, uint32_t first, uint32_t count, Row gravity, RowSums& sums) {
  for (uint32_t l = 0; l < count; ++l)
    if (!m.live || (m.live[first / lanes] >> l & 1) != 0)
      move<Kicks, Drift>(m, static_cast<uint64_t>(first + l) * 4, Row{} + 1.0 / m.mass[first + l],
                         Row{} + m.mass[first + l], gravity, sums);
}

/// The values at the places; clang, of the fuzzers, has no shuffle by a variable.
inline TwoRows picked(const Eight& values, const Places& places) {
#ifdef __clang__
  TwoRows result{};
  for (int i = 0; i < 8; ++i) result[i] = values[places[i]];
  return result;
#else
  return __builtin_shuffle(values, places);
#endif
}

/// A whole block, two vertices at a time; masses are inverted together (a division per
/// vertex would cost as much as the rest), and two sums break the chain of additions.
template <int Kicks, bool Drift>
inline void move_block(const Motion& m, uint32_t first, TwoRows gravity, TwoRowSums (&sums)[2]) {
  const uint64_t at = static_cast<uint64_t>(first) * 4;
  for (uint32_t l = 0; l < lanes; l += 2) {
    const uint64_t ahead = at + (l + prefetch_distance) * 4;
    __builtin_prefetch(m.force + ahead, 1);
    __builtin_prefetch(m.velocity + ahead, 1);
    __builtin_prefetch(m.position + ahead, 1);
  }
  const Eight masses = load<Eight>(m.mass + first), inverses = 1.0 / masses;
  const auto two = [&](int64_t l) __attribute__((always_inline)) {
    const Places each{l, l, l, l, l + 1, l + 1, l + 1, l + 1};
    const TwoRows inverse = picked(inverses, each);
    const TwoRows mass = picked(masses, each);
    move<Kicks, Drift>(m, at + static_cast<uint64_t>(l) * 4, inverse, mass, gravity,
                       sums[l / 2 % 2]);
  };
  two(0);
  two(2);
  two(4);
  two(6);
}

inline double sum3(Row r) { return r[0] + r[1] + r[2]; }

/// The two halves of a register, and the sums of single rows.
inline Row fold(const TwoRows& a, const TwoRows& b, Row single) {
  const TwoRows both = a + b;
  return single + Row{both[0] + both[4], both[1] + both[5], both[2] + both[6], 0};
}

template <int Kicks, bool Drift>
int32_t pass(const Motion* motion, uint32_t begin, uint32_t end, PassSums* result) {
  const Motion m = *motion;
  const double* const g = m.gravity;
  const Row gravity = {g[0], g[1], g[2], 0};
  const TwoRows gravities = {g[0], g[1], g[2], 0, g[0], g[1], g[2], 0};
  RowSums single = {};
  TwoRowSums twos[2] = {};
  for (uint32_t first = begin; first < end; first += lanes) {
    if (end - first >= lanes && (!m.live || m.live[first / lanes] == 0xFF))
      move_block<Kicks, Drift>(m, first, gravities, twos);
    else
      move_some<Kicks, Drift>(m, first, end - first < lanes ? end - first : lanes, gravity, single);
  }
  result->before = sum3(fold(twos[0].before, twos[1].before, single.before));
  result->after = sum3(fold(twos[0].after, twos[1].after, single.after));
  result->inertia = sum3(fold(twos[0].inertia, twos[1].inertia, single.inertia));
  const Row zero = fold(twos[0].zero, twos[1].zero, single.zero);
  return zero[0] == 0 && zero[1] == 0 && zero[2] == 0 ? 0 : 1;
}

/// 1 where a component moves, 0 where it is held.
inline Row free_components(double fixed) {
  const int bits = static_cast<int>(fixed);
  return Row{bits & 1 ? 0.0 : 1.0, bits & 2 ? 0.0 : 1.0, bits & 4 ? 0.0 : 1.0, 0.0};
}

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

// ------------------------------------------------------------------- checks --

/// Triple product of the three edges that leave corner n along the axes, for all
/// lanes: the Jacobian there, positive for a right-handed corner.
inline void corner_jacobian(const double* x, uint32_t n, double* out) {
  const double* p = x + n * 24;
  const double* q[3];
  for (uint32_t a = 0; a < 3; ++a) q[a] = x + (n ^ (1u << a)) * 24;
  const double sign = (n & 1) ^ ((n >> 1) & 1) ^ ((n >> 2) & 1) ? -1.0 : 1.0;
  for (uint32_t l = 0; l < lanes; ++l) {
    double e[3][3];
    for (uint32_t a = 0; a < 3; ++a)
      for (uint32_t c = 0; c < 3; ++c) e[a][c] = q[a][c * lanes + l] - p[c * lanes + l];
    const double triple = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
                          e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
                          e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
    const double jacobian = triple * sign;
    out[l] = out[l] < jacobian ? out[l] : jacobian;
  }
}

uint32_t inverted(const uint32_t* nodes, const uint8_t* live, const double* position,
                  uint32_t begin, uint32_t end, uint32_t* first) {
  Job job = {};
  job.nodes = nodes;
  alignas(64) double x[192];
  uint32_t found = 0;
  for (uint32_t row = begin; row < end;) {
    const uint32_t to_block = lanes - row % lanes;
    const uint32_t here = end - row < to_block ? end - row : to_block;
    const BatchRows rows = live_rows(live, row, here);
    row += here;
    if (rows.valid == 0) continue;
    gather_rows<8>(position, find_cells<8>(job, rows), x);
    double smallest[lanes];
    for (uint32_t l = 0; l < lanes; ++l) smallest[l] = __builtin_inf();
    for (uint32_t n = 0; n < 8; ++n) corner_jacobian(x, n, smallest);
    for (uint32_t l = 0; l < rows.valid; ++l) {
      if (smallest[l] > 0) continue;
      if (found == 0) *first = rows.row[l];
      ++found;
    }
  }
  return found;
}

const Table table = {sizeof(Table),
                     0,
                     isa_name,
                     forces,
                     gather,
                     pass<1, true>,
                     pass<2, true>,
                     pass<1, false>,
                     kinetic,
                     rest_sums,
                     inverted,
                     stretched<MayStrain>,
                     stretched<MayElongate>};

}  // namespace

#ifndef SUTURE_LOOPS_FUNCTION
#define SUTURE_LOOPS_FUNCTION suture_loops
#endif

extern "C" __attribute__((visibility("default"))) const suture::loops::Table* SUTURE_LOOPS_FUNCTION(
    void) {
  return &table;
}
