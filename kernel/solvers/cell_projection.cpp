// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/cell_projection.hpp"

#include <algorithm>

#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

constexpr std::size_t lanes = 8;

/// half[i] = sum over j of weight[j] K[i][j], 9 numbers, for all nodes i: one column of K P. Of 8
/// cells at once.
SUTURE_CLONES
void multiply_column(const double* matrix, const double* weights, std::size_t nodes, double* half) {
  const std::size_t size = nodes * 3;
  for (std::size_t row = 0; row < size; ++row) {
    double sums[3][lanes] = {};
    for (std::size_t j = 0; j < nodes; ++j)
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t l = 0; l < lanes; ++l)
          sums[c][l] += weights[j * lanes + l] * matrix[(row * size + j * 3 + c) * lanes + l];
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t l = 0; l < lanes; ++l) half[(row * 3 + c) * lanes + l] = sums[c][l];
  }
}

/// block = sum over i of weight[i] half[i]. Of 8 cells at once.
SUTURE_CLONES
void multiply_row(const double* weights, const double* half, std::size_t nodes, double* block) {
  double sums[9][lanes] = {};
  for (std::size_t i = 0; i < nodes; ++i)
    for (std::size_t k = 0; k < 9; ++k)
      for (std::size_t l = 0; l < lanes; ++l)
        sums[k][l] += weights[i * lanes + l] * half[(i * 9 + k) * lanes + l];
  for (std::size_t k = 0; k < 9; ++k)
    for (std::size_t l = 0; l < lanes; ++l) block[k * lanes + l] = sums[k][l];
}

/// The place of the block (a, b), a <= b, among those of the upper triangle.
std::size_t upper(std::size_t a, std::size_t b) { return b * (b + 1) / 2 + a; }

}  // namespace

CellProjection::CellProjection(const Interpolation& interpolation,
                               const std::vector<std::uint8_t>& free, BlockRows<double>& sum)
    : p_(interpolation), free_(free), sum_(sum) {}

void CellProjection::subtract(const CellTangents& cells) {
  list_nodes(cells);
  set_weights(cells);
  copy_free(cells);
  project(cells.nodes);
  for (std::size_t l = 0; l < cells.cells; ++l) collect(l);
}

void CellProjection::list_nodes(const CellTangents& cells) {
  width_ = 0;
  for (std::size_t l = 0; l < cells.cells; ++l) {
    std::vector<Index>& list = lists_[l];
    list.clear();
    for (Index n = 0; n < cells.nodes; ++n) {
      const Index v = cells.vertices[l * cells.nodes + n];
      list.insert(list.end(), p_.node.begin() + p_.begin[v], p_.node.begin() + p_.begin[v + 1]);
    }
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
    width_ = std::max(width_, list.size());
  }
}

void CellProjection::set_weights(const CellTangents& cells) {
  weights_.assign(width_ * cells.nodes * lanes, 0.0);
  for (std::size_t l = 0; l < cells.cells; ++l)
    for (std::size_t n = 0; n < cells.nodes; ++n) {
      const Index v = cells.vertices[l * cells.nodes + n];
      for (Index i = p_.begin[v]; i < p_.begin[v + 1]; ++i) {
        const auto at = std::ranges::lower_bound(lists_[l], p_.node[i]) - lists_[l].begin();
        weights_[(static_cast<std::size_t>(at) * cells.nodes + n) * lanes + l] = p_.weight[i];
      }
    }
}

/// The matrices without the rows and columns of components that are not free.
void CellProjection::copy_free(const CellTangents& cells) {
  const std::size_t size = std::size_t{cells.nodes} * 3;
  matrix_.assign(cells.values, cells.values + size * size * lanes);
  for (std::size_t l = 0; l < cells.cells; ++l)
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t v = cells.vertices[l * cells.nodes + i / 3];
      if (free_[v * 3 + i % 3]) continue;
      for (std::size_t j = 0; j < size; ++j)
        matrix_[(i * size + j) * lanes + l] = matrix_[(j * size + i) * lanes + l] = 0;
    }
}

void CellProjection::project(Index nodes) {
  half_.resize(std::size_t{nodes} * 9 * lanes);
  coarse_.resize(upper(0, width_) * 9 * lanes);
  for (std::size_t b = 0; b < width_; ++b) {
    multiply_column(matrix_.data(), weights_.data() + b * nodes * lanes, nodes, half_.data());
    for (std::size_t a = 0; a <= b; ++a)
      multiply_row(weights_.data() + a * nodes * lanes, half_.data(), nodes,
                   coarse_.data() + upper(a, b) * 9 * lanes);
  }
}

void CellProjection::collect(std::size_t lane) {
  if (lists_[lane] != pending_nodes_) {
    finish();
    pending_nodes_ = lists_[lane];
    pending_.assign(upper(0, pending_nodes_.size()) * 9, 0.0);
  }
  for (std::size_t i = 0; i < pending_.size(); ++i) pending_[i] -= coarse_[i * lanes + lane];
}

void CellProjection::finish() {
  for (std::size_t a = 0; a < pending_nodes_.size(); ++a)
    sum_.add_row(pending_nodes_[a], pending_nodes_, [&](std::size_t b, double* block) {
      const double* values = pending_.data() + upper(std::min(a, b), std::max(a, b)) * 9;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
          const double one = values[i * 3 + j], other = values[j * 3 + i];
          block[3 * j + i] += a < b ? one : a > b ? other : 0.5 * (one + other);
        }
    });
  pending_nodes_.clear();
}

}  // namespace suture
