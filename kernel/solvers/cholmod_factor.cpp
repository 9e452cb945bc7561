// SPDX-License-Identifier: GPL-3.0-or-later
//
// The module itself: factors by CHOLMOD.
#include <suitesparse/cholmod.h>

#include <algorithm>
#include <new>

#include "kernel/solvers/sparse_factor.hpp"

// In the OpenMP runtime with which Debian links CHOLMOD; <omp.h> may belong to another one.
extern "C" int omp_get_max_active_levels();
extern "C" void omp_set_max_active_levels(int levels);

namespace suture {
namespace {

/// While it lives, OpenMP gives this thread no others: how many a run uses is the user's choice
/// (`--threads`), and CHOLMOD takes four whatever that says.
class OneThread {
 public:
  OneThread() { omp_set_max_active_levels(0); }
  ~OneThread() { omp_set_max_active_levels(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_ = omp_get_max_active_levels();
};

/// Bodies are three-dimensional: for many unknowns, nested dissection fills less than AMD; for few,
/// it takes longer than it saves.
constexpr std::size_t least_dissected = 3000;

class CholmodFactor final : public SparseFactor {
 public:
  CholmodFactor() {
    cholmod_start(&common_);
    common_.print = 0;
    common_.quick_return_if_not_posdef = 1;
    // Calls of BLAS are too expensive for the small blocks of small systems (default: 40).
    common_.supernodal_switch = 100;
    common_.final_ll = 1;  // which does not exist where the matrix is not positive definite
    common_.method[0].ordering = CHOLMOD_AMD;
    common_.method[1].ordering = CHOLMOD_METIS;
  }
  ~CholmodFactor() override {
    cholmod_free_dense(&solution_, &common_);
    cholmod_free_dense(&work_, &common_);
    cholmod_free_dense(&more_work_, &common_);
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;

  double analyse(const LowerTriangle& a) override {
    const OneThread one_thread;
    cholmod_free_factor(&factor_, &common_);
    cholmod_sparse matrix = view(a);
    common_.nmethods = matrix.nrow < least_dissected ? 1 : 2;
    factor_ = cholmod_analyze(&matrix, &common_);
    if (factor_ == nullptr) throw std::bad_alloc();
    return common_.fl;
  }

  bool factor(const LowerTriangle& a) override {
    const OneThread one_thread;
    cholmod_sparse matrix = view(a);
    cholmod_factorize(&matrix, factor_, &common_);
    if (common_.status < CHOLMOD_OK) throw std::bad_alloc();
    return common_.status == CHOLMOD_OK && factor_->minor == factor_->n;
  }

  void solve(std::span<double> x) override {
    const OneThread one_thread;
    cholmod_dense right{};
    right.nrow = right.d = right.nzmax = x.size();
    right.ncol = 1;
    right.x = x.data();
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    if (!cholmod_solve2(CHOLMOD_A, factor_, &right, nullptr, &solution_, nullptr, &work_,
                        &more_work_, &common_))
      throw std::bad_alloc();
    std::copy_n(static_cast<const double*>(solution_->x), x.size(), x.data());
  }

  std::size_t bytes() const override {
    return factor_->is_super ? factor_->xsize * sizeof(double)
                             : factor_->nzmax * (sizeof(double) + sizeof(int));
  }

 private:
  /// CHOLMOD reads these arrays only.
  template <class T>
  static void* mutable_data(std::span<const T> values) {
    return const_cast<T*>(values.data());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  }
  static cholmod_sparse view(const LowerTriangle& a) {
    cholmod_sparse matrix{};
    matrix.nrow = matrix.ncol = a.begin.size() - 1;
    matrix.nzmax = a.row.size();
    matrix.p = mutable_data(a.begin);
    matrix.i = mutable_data(a.row);
    matrix.x = mutable_data(a.value);
    matrix.stype = -1;
    matrix.itype = CHOLMOD_INT;
    matrix.xtype = a.value.empty() ? CHOLMOD_PATTERN : CHOLMOD_REAL;
    matrix.dtype = CHOLMOD_DOUBLE;
    matrix.sorted = matrix.packed = 1;
    return matrix;
  }

  cholmod_common common_{};
  cholmod_factor* factor_ = nullptr;
  cholmod_dense *solution_ = nullptr, *work_ = nullptr, *more_work_ = nullptr;
};

}  // namespace
}  // namespace suture

extern "C" __attribute__((visibility("default"))) suture::SparseFactor* suture_cholmod_factor_1() {
  return new suture::CholmodFactor;
}
