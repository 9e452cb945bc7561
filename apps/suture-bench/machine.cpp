// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/machine.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <chrono>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "kernel/base/error.hpp"
#include "kernel/base/isa.hpp"
#include "kernel/base/parallel.hpp"

namespace suture::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int chains = 12;  // independent sums: more than latency x ports asks for
constexpr int turns = 2'000'000;

// Each returns a sum, so that nothing is optimised away. Operations: turns x chains
// x lanes x 2.
#if defined(__x86_64__)
__attribute__((target("avx512f"))) double multiply_add_512(double x) {
  __m512d sum[chains];
  for (int c = 0; c < chains; ++c) sum[c] = _mm512_set1_pd(x + c);
  const __m512d factor = _mm512_set1_pd(0.999999), more = _mm512_set1_pd(1e-9);
  for (int t = 0; t < turns; ++t)
    for (auto& s : sum) s = _mm512_fmadd_pd(s, factor, more);
  double total = 0;
  for (const auto& s : sum) total += s[0];
  return total;
}

__attribute__((target("avx2,fma"))) double multiply_add_256(double x) {
  __m256d sum[chains];
  for (int c = 0; c < chains; ++c) sum[c] = _mm256_set1_pd(x + c);
  const __m256d factor = _mm256_set1_pd(0.999999), more = _mm256_set1_pd(1e-9);
  for (int t = 0; t < turns; ++t)
    for (auto& s : sum) s = _mm256_fmadd_pd(s, factor, more);
  double total = 0;
  for (const auto& s : sum) total += s[0];
  return total;
}
#endif

typedef double Pair __attribute__((vector_size(16)));

double multiply_add_128(double x) {
  Pair sum[chains];
  for (int c = 0; c < chains; ++c) sum[c] = Pair{x + c, x};
  for (int t = 0; t < turns; ++t)
    for (auto& s : sum) s = s * 0.999999 + 1e-9;
  double total = 0;
  for (const auto& s : sum) total += s[0];
  return total;
}

struct Arithmetic {
  double (*run)(double);
  int lanes;
};

Arithmetic arithmetic() {
#if defined(__x86_64__)
  if (best_isa() == "avx512") return {multiply_add_512, 8};
  if (best_isa() == "avx2") return {multiply_add_256, 4};
#endif
  return {multiply_add_128, 2};
}

/// Seconds of the best of a few rounds of body(worker number).
template <class BenchBody>
double best_of(unsigned threads, int rounds, BenchBody body) {
  const Workers workers(threads);
  double best = 1e9;
  for (int round = 0; round < rounds; ++round) {
    const auto start = Clock::now();
    workers.parallel_for(threads, body);
    best = std::min(best, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return best;
}

Machine measure_machine(unsigned threads) {
  Machine result;
  const Arithmetic work = arithmetic();
  std::vector<double> sink(threads * std::size_t{8});
  const double seconds =
      best_of(threads, 9, [&](std::size_t i) { sink[8 * i] += work.run(static_cast<double>(i)); });
  result.flops = 2.0 * threads * turns * chains * work.lanes / seconds;

  constexpr std::size_t length = std::size_t{1} << 24;
  std::vector<double> a(length, 1), b(length, 2), c(length, 3);
  const double streamed = best_of(threads, 9, [&](std::size_t part) {
    const std::size_t end = length * (part + 1) / threads;
    for (std::size_t i = length * part / threads; i < end; ++i) a[i] = b[i] + 1.5 * c[i];
  });
  result.bandwidth = 24.0 * length / streamed;
  return result;
}

}  // namespace

const Machine& machine(unsigned threads) {
  static std::map<unsigned, Machine> known;
  const auto found = known.find(threads);
  return found != known.end() ? found->second
                              : known.emplace(threads, measure_machine(threads)).first->second;
}

double peak_bytes() {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("VmHWM:")) return 1024 * std::stod(line.substr(6));
  throw IoError("/proc/self/status does not report the peak memory (VmHWM)");
}

// Linux since 4.0; if the file cannot be written, the peak of the process remains.
void forget_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

double bytes_per_element(BenchBody& body) {
  const Instance& instance = *body.attributes().instances()[0];
  const suture_model& model = instance.model();
  const double vertices = body.complex().count(0);
  double bytes = 0;
  for (std::size_t i = 0; i < model.functor_count; ++i) {
    const suture_functor& f = model.functors[i];
    const double rows = instance.table(static_cast<int>(f.dimension)).cells.size();
    const bool general = f.shape == SUTURE_GENERAL && instance.general_begin == rows;
    const bool boxes = f.shape == SUTURE_PARALLELEPIPED && instance.general_begin == 0;
    if (!instance.functor(i).runs || general || boxes) continue;
    bytes += rows * 4 * (std::size_t{1} << f.dimension);
    for (const std::uint32_t a : std::span(f.cell_columns, f.cell_column_count))
      if (!instance.column(a)->is_constant())
        bytes += rows * 8 * instance.column(a)->spec().components;
    const std::uint32_t reads = instance.functor(i).reads;
    const int vectors = 2 + ((reads & SUTURE_READ_REST) != 0) +
                        ((reads & SUTURE_READ_POSITION) != 0) +
                        ((reads & SUTURE_READ_VELOCITY) != 0);
    bytes += vertices * (32 * vectors + 8 * f.vertex_column_count);
  }
  return bytes / body.element_count();
}

}  // namespace suture::bench
