// SPDX-License-Identifier: Apache-2.0
// Assembly of the matrices of a V-cycle.
#include <algorithm>
#include <cmath>

#include "solvers/cell_matrix_kernel.h"
#include "solvers/multigrid.h"

namespace pointbased::detail {
namespace {

constexpr std::size_t kEight = 8, kBlock = 9;
constexpr std::size_t kRowGrain = 128, kCellGrain = 16;
constexpr std::size_t kMaxDense = 400;  // nodes of a dense factorisation
constexpr double kShift = 1e-6;         // of the diagonal: for rigid motions of unsupported bodies

std::size_t widthOf(std::size_t nodes) { return StiffnessFactors::width(nodes); }

// y += s x; n is a multiple of eight
void addScaled(float s, const float *x, float *y, std::size_t n) {
  for (std::size_t k = 0; k < n; k += kEight)
    for (std::size_t j = 0; j < kEight; ++j) y[k + j] += s * x[k + j];
}

// Makes the matrix symmetric to the last bit: rounding would grow otherwise.
void mirror(float *matrix, std::size_t nodes) {
  const std::size_t width = widthOf(nodes);
  for (std::size_t J = 0; J < nodes; ++J)
    for (std::size_t n = 0; n < kBlock; ++n)
      for (std::size_t K = J; K < nodes; ++K)
        matrix[width * (kBlock * K + 3 * (n % 3) + n / 3) + J] = matrix[width * (kBlock * J + n) + K];
}

Mat3 inverseOf(Mat3 d) {
  d.diagonal().array() += kShift * d.trace() / 3.0;
  const Vec3 x = d.col(1).cross(d.col(2)), y = d.col(2).cross(d.col(0)), z = d.col(0).cross(d.col(1));
  const double determinant = d.col(0).dot(x);
  if (!(d(0, 0) > 0.0 && z[2] > 0.0 && determinant > 0.0)) {
    const double largest = d.diagonal().cwiseAbs().maxCoeff();
    return (largest > 0.0 && std::isfinite(largest) ? 1.0 / largest : 1.0) * Mat3::Identity();
  }
  Mat3 inverse;
  inverse.row(0) = x.transpose();
  inverse.row(1) = y.transpose();
  inverse.row(2) = z.transpose();
  return inverse / determinant;
}

}  // namespace

struct Multigrid::Sources {
  const StiffnessFactors &factors, &coarserFactors;  // of the rows, and of coarser levels
  std::span<const Mat3> blocks;
  const SpringRows &springs;

  [[nodiscard]] std::size_t points() const { return factors.first.size(); }
  [[nodiscard]] bool isSpring(std::size_t q) const { return q >= points(); }
  [[nodiscard]] float stiffness(std::size_t q) const { return static_cast<float>(springs.stiffness[q - points()]); }
  /// @param cells  the rows that `e` is an entry of
  [[nodiscard]] float weight(const Csr &cells, std::size_t e) const {
    return static_cast<float>(springs.weights[e - cells.offsets[points()]]);
  }
  void addRow(std::size_t q, std::size_t width, std::size_t entry, float *out) const {
    const float *numbers = factors.numbers.data() + factors.first[q];
    kernels::addCellRow(numbers, width, entry, factors.lambda[q], factors.mu[q], out);
    if (factors.hasStrainGradient(q))
      kernels::addStrainGradientRow(numbers + StiffnessFactors::kNumbers * width, width, entry,
                                    factors.strainGradientLambda[q], factors.strainGradientMu[q], out);
  }
  // Diagonal of the block of an entry with itself, N/m.
  [[nodiscard]] Vec3 diagonal(std::size_t q, std::size_t width, std::size_t entry) const {
    const float *own = factors.numbers.data() + factors.first[q] + entry;
    const auto squares = [&](std::size_t n) {
      return Eigen::Vector3f(own[n * width], own[(n + 1) * width], own[(n + 2) * width]).cwiseAbs2().eval();
    };
    float isotropic = 0.0F;
    for (std::size_t n = 3; n < StiffnessFactors::kNumbers; ++n) isotropic += own[n * width] * own[n * width];
    Eigen::Vector3f sum = (factors.lambda[q] + factors.mu[q]) * squares(0);
    if (factors.hasStrainGradient(q))
      for (std::size_t n = 0; n < StiffnessFactors::kStrainGradientNumbers; n += 3) {
        const Eigen::Vector3f of = squares(StiffnessFactors::kNumbers + n);
        sum += (factors.strainGradientLambda[q] + factors.strainGradientMu[q]) * of;
        isotropic += factors.strainGradientMu[q] * of.sum();
      }
    return (sum.array() + isotropic).cast<double>();
  }
};

// Row i, [1 + eights][9][8]: GridLevel::slotOf().
void Multigrid::sumRow(const Sources &from, std::size_t l, std::size_t i, Floats &row, Floats &scratch) const {
  const GridLevel &grid = hierarchy_->levels[l];
  const Level &level = levels_[l];
  row.assign(kEight * kBlock * (1 + grid.eights[2 * i + 2] - grid.eights[2 * i]), 0.0F);
  if (l == 0) {
    const Mat3 own = held_[i] != 0 ? Mat3(Mat3::Identity()) : from.blocks[hierarchy_->order[i]];
    for (std::size_t n = 0; n < kBlock; ++n) row[kEight * n] = static_cast<float>(own.data()[n]);
    if (held_[i] != 0) return;
  }
  const std::uint16_t *slots = grid.slots.data() + grid.firstSlot[i];
  const Csr &rowCells = grid.rowCells();
  for (const Index e : grid.cellsOf.row(i)) {
    const std::size_t q = grid.cellOfEntry[e];
    const auto nodes = rowCells.row(q);
    const std::size_t m = nodes.size(), width = widthOf(m), a = e - rowCells.offsets[q];
    if (l == 0 && from.isSpring(q)) {
      const float k_i = from.stiffness(q) * from.weight(rowCells, e);
      for (std::size_t k = 0; k < m; ++k)
        if (held_[nodes[k]] == 0)
          for (const std::size_t n : {0U, 4U, 8U})
            row[slots[k] + kEight * n] += k_i * from.weight(rowCells, rowCells.offsets[q] + k);
      slots += m;
      continue;
    }
    const float *numbers = nullptr;
    if (l == 0) {
      scratch.assign(kBlock * width, 0.0F);
      from.addRow(q, width, a, scratch.data());
      numbers = scratch.data();
    } else {
      numbers = level.cells.data() + level.firstNumber[q] + kBlock * width * a;
    }
    float *const sums = row.data();
    const std::uint8_t *const held = held_.data();
    for (std::size_t k = 0; k < m; ++k) {
      if (l == 0 && held[nodes[k]] != 0) continue;
      float *to = sums + slots[k];
      for (std::size_t n = 0; n < kBlock; ++n) to[kEight * n] += numbers[n * width + k];
    }
    slots += m;
  }
}

void Multigrid::assemble(const StiffnessFactors &factors, const StiffnessFactors *coarserFactors,
                         std::span<const Mat3> blocks, const SpringRows &springs, std::span<const std::uint8_t> held,
                         const ParallelFor &parallelFor, const StopRequest *stop) {
  parallelFor_ = parallelFor;
  const GridLevel &finest = hierarchy_->levels.front();
  held_.assign(finest.nodes(), 0);
  if (!held.empty())
    for (std::size_t i = 0; i < finest.nodes(); ++i) held_[i] = held[hierarchy_->order[i]];
  const Sources from{factors, coarserFactors != nullptr ? *coarserFactors : factors, blocks, springs};
  own_.resize(kBlock * finest.nodes());
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    throwIfStopRequested(stop);
    if (l > 0) sumCells(from, l);
    if (l > 1) levels_[l - 1].cells = {};
    assembleRows(from, l);
  }
  throwIfStopRequested(stop);
  factoriseCoarsest(from);
  levels_.back().cells = {};
  invertSprings(springs.rows, stop);
}

// Rows of a level, scaled by their diagonals, and the inverses of the diagonal blocks.
void Multigrid::assembleRows(const Sources &from, std::size_t l) {
  const GridLevel &grid = hierarchy_->levels[l];
  Level &level = levels_[l];
  const auto diagonals = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 own = Vec3::Zero();
      if (l == 0) own = held_[i] != 0 ? Vec3(Vec3::Ones()) : Vec3(from.blocks[hierarchy_->order[i]].diagonal());
      for (const Index e : grid.cellsOf.row(i)) {
        if (l == 0 && held_[i] != 0) break;
        const Csr &cells = grid.rowCells();
        const std::size_t q = grid.cellOfEntry[e], width = widthOf(cells.row(q).size()), a = e - cells.offsets[q];
        if (l > 0) {
          const float *numbers = level.cells.data() + level.firstNumber[q] + kBlock * width * a + a;
          for (std::size_t c = 0; c < 3; ++c)
            own[static_cast<Eigen::Index>(c)] += static_cast<double>(numbers[4 * c * width]);
        } else if (from.isSpring(q)) {
          const float weight = from.weight(cells, e);
          own.array() += static_cast<double>(from.stiffness(q) * weight * weight);
        } else {
          own += from.diagonal(q, width, a);
        }
      }
      const double largest = own.maxCoeff();
      level.roots[i] = largest > 0.0 && std::isfinite(largest) ? static_cast<float>(std::sqrt(largest)) : 1.0F;
      level.scales[i] = 1.0F / level.roots[i];
    }
  };
  parallelFor_(grid.nodes(), kRowGrain, std::cref(diagonals));
  const auto rows = [&](std::size_t begin, std::size_t end) {
    Floats row, scratch;
    for (std::size_t i = begin; i < end; ++i) {
      sumRow(from, l, i, row, scratch);
      keepRow(l, i, row, scratch);
    }
  };
  parallelFor_(grid.nodes(), kRowGrain, std::cref(rows));
}

void Multigrid::keepRow(std::size_t l, std::size_t i, const Floats &row, Floats &scratch) {
  const GridLevel &grid = hierarchy_->levels[l];
  Level &level = levels_[l];
  const float scale = level.scales[i];
  const std::size_t eights = grid.eights[2 * i + 2] - grid.eights[2 * i];
  const Index *columns = grid.columns.data() + kEight * grid.eights[2 * i];
  scratch.resize(2 * kEight * eights);
  float *to = scratch.data(), *back = to + kEight * eights;
  for (std::size_t k = 0; k < kEight * eights; ++k) {
    to[k] = scale * level.scales[columns[k]] * 32767.0F;
    back[k] = scale * level.roots[columns[k]] * kernels::SweepRows::kUnit;
  }
  float lost[kBlock] = {};
  kernels::roundRow(row.data() + kEight * kBlock, to, back, eights,
                    level.blocks.data() + kEight * kBlock * grid.eights[2 * i], lost);
  // Rounding errors of the neighbours are added to the node itself, so that the forces of translations are preserved.
  Mat3 own;
  for (std::size_t n = 0; n < kBlock; ++n)
    own.data()[n] = static_cast<double>(scale * scale * row[kEight * n] + lost[n]);
  const Mat3 symmetric = 0.5 * (own + own.transpose());
  const Mat3 inverse = inverseOf(symmetric);
  for (std::size_t n = 0; n < kBlock; ++n) {
    level.inverses[12 * i + 4 * (n / 3) + n % 3] = static_cast<float>(inverse.data()[n]);
    if (l == 0) own_[kBlock * i + n] = static_cast<float>(symmetric.data()[n]);
  }
}

// P^T A P of the cells of the previous level, each coarser cell separately.
void Multigrid::sumCells(const Sources &from, std::size_t l) {
  const GridLevel &coarse = hierarchy_->levels[l];
  Level &to = levels_[l];
  to.firstNumber.assign(1, 0);
  for (std::size_t Q = 0; Q < coarse.cells.rows(); ++Q) {
    const std::size_t m = coarse.cells.row(Q).size();
    to.firstNumber.push_back(to.firstNumber.back() + kBlock * widthOf(m) * m);
  }
  to.cells.resize(to.firstNumber.back());
  const auto cells = [&](std::size_t begin, std::size_t end) {
    Floats scratch;
    for (std::size_t Q = begin; Q < end; ++Q) {
      std::fill(to.cells.data() + to.firstNumber[Q], to.cells.data() + to.firstNumber[Q + 1], 0.0F);
      for (const Index q : coarse.finer.row(Q)) {
        if (l > 1) {
          addCell(l - 1, q, Q, scratch);
        } else if (from.isSpring(q)) {
          addFinestSpring(from, q, Q);
        } else {
          addFinestCell(from, q, Q, scratch);
        }
      }
      mirror(to.cells.data() + to.firstNumber[Q], coarse.cells.row(Q).size());
    }
  };
  parallelFor_(coarse.finer.rows(), kCellGrain, std::cref(cells));
}

// Factors of a cell are transferred to its coarser nodes like displacements.
void Multigrid::addFinestCell(const Sources &from, std::size_t q, std::size_t coarse, Floats &scratch) {
  constexpr std::size_t kNumbers = StiffnessFactors::kNumbers, kPadded = (kNumbers + kEight - 1) / kEight * kEight;
  const GridLevel &fine = hierarchy_->levels[0], &grid = hierarchy_->levels[1];
  const std::size_t M = grid.cells.row(coarse).size(), width = widthOf(M),
                    fineWidth = widthOf(fine.cells.row(q).size());
  float *out = levels_[1].cells.data() + levels_[1].firstNumber[coarse];
  const float *factors = from.coarserFactors.numbers.data() + from.coarserFactors.first[q];
  scratch.assign((kPadded + kNumbers) * width, 0.0F);  // node by node, then number by number
  for (Index e = fine.cells.offsets[q]; e < fine.cells.offsets[q + 1]; ++e, ++factors) {
    const Index i = fine.cells.indices[e];
    if (held_[i] != 0) continue;
    const std::uint16_t *place = fine.places.data() + fine.firstPlace[e];
    const std::size_t parents = fine.parents.row(i).size();
    const float *weights = fine.parentWeights.data() + fine.parents.offsets[i];
    float numbers[kPadded] = {};
    for (std::size_t n = 0; n < kNumbers; ++n) numbers[n] = factors[n * fineWidth];
    for (std::size_t p = 0; p < parents; ++p)
      addScaled(weights[p], numbers, scratch.data() + kPadded * place[p], kPadded);
    // Blocks of the node itself, once.
    if (fine.firstEntry[i] != e) continue;
    const Mat3 &own = from.blocks[hierarchy_->order[i]];
    for (std::size_t p = 0; p < parents; ++p)
      for (std::size_t r = 0; r < parents; ++r)
        for (std::size_t n = 0; n < kBlock; ++n)
          out[width * (kBlock * place[p] + n) + place[r]] +=
              weights[p] * weights[r] * static_cast<float>(own.data()[n]);
  }
  float *coarser = scratch.data() + kPadded * width;
  for (std::size_t n = 0; n < kNumbers; ++n)
    for (std::size_t k = 0; k < width; ++k) coarser[n * width + k] = scratch[kPadded * k + n];
  for (std::size_t J = 0; J < M; ++J)
    kernels::addCellRow(coarser, width, J, from.coarserFactors.lambda[q], from.coarserFactors.mu[q],
                        out + kBlock * width * J);
}

void Multigrid::addFinestSpring(const Sources &from, std::size_t q, std::size_t coarse) {
  const GridLevel &fine = hierarchy_->levels[0], &grid = hierarchy_->levels[1];
  const std::size_t M = grid.cells.row(coarse).size(), width = widthOf(M);
  float *out = levels_[1].cells.data() + levels_[1].firstNumber[coarse];
  std::vector<float> w(M, 0.0F);
  for (Index e = fine.cells.offsets[q]; e < fine.cells.offsets[q + 1]; ++e) {
    const Index i = fine.cells.indices[e];
    if (held_[i] != 0) continue;
    const std::uint16_t *place = fine.places.data() + fine.firstPlace[e];
    for (Index p = fine.parents.offsets[i]; p < fine.parents.offsets[i + 1]; ++p)
      w[*place++] += fine.parentWeights[p] * from.weight(fine.cells, e);
  }
  for (std::size_t J = 0; J < M; ++J)
    for (std::size_t K = 0; K < M; ++K)
      for (const std::size_t n : {0U, 4U, 8U}) out[width * (kBlock * J + n) + K] += from.stiffness(q) * w[J] * w[K];
}

// P^T (P^T A)^T: rows, twice.
void Multigrid::addCell(std::size_t l, std::size_t q, std::size_t coarse, Floats &scratch) {
  const GridLevel &fine = hierarchy_->levels[l], &grid = hierarchy_->levels[l + 1];
  const std::size_t m = fine.cells.row(q).size(), M = grid.cells.row(coarse).size();
  const std::size_t narrow = widthOf(m), width = widthOf(M);
  const Index begin = fine.cells.offsets[q];
  const float *from = levels_[l].cells.data() + levels_[l].firstNumber[q];
  float *out = levels_[l + 1].cells.data() + levels_[l + 1].firstNumber[coarse];
  const auto forParents = [&](std::size_t a, const auto &visit) {
    const Index i = fine.cells.indices[begin + a];
    const std::uint16_t *place = fine.places.data() + fine.firstPlace[begin + a];
    for (Index p = fine.parents.offsets[i]; p < fine.parents.offsets[i + 1]; ++p)
      visit(*place++, fine.parentWeights[p]);
  };
  scratch.assign(kBlock * (narrow * M + width * m), 0.0F);
  float *turned = scratch.data() + kBlock * narrow * M;
  for (std::size_t a = 0; a < m; ++a)
    forParents(a, [&](std::size_t J, float weight) {
      addScaled(weight, from + kBlock * narrow * a, scratch.data() + kBlock * narrow * J, kBlock * narrow);
    });
  for (std::size_t J = 0; J < M; ++J)
    for (std::size_t n = 0; n < kBlock; ++n)
      for (std::size_t b = 0; b < m; ++b)
        turned[width * (kBlock * b + 3 * (n % 3) + n / 3) + J] = scratch[narrow * (kBlock * J + n) + b];
  for (std::size_t b = 0; b < m; ++b)
    forParents(b, [&](std::size_t K, float weight) {
      addScaled(weight, turned + kBlock * width * b, out + kBlock * width * K, kBlock * width);
    });
}

void Multigrid::factoriseCoarsest(const Sources &from) {
  const std::size_t l = levels_.size() - 1;
  const GridLevel &grid = hierarchy_->levels[l];
  const Level &level = levels_[l];
  isDense_ = grid.nodes() <= kMaxDense;
  if (!isDense_) return;
  const auto n = static_cast<Eigen::Index>(3 * grid.nodes());
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
  Floats row, scratch;
  for (std::size_t i = 0; i < grid.nodes(); ++i) {
    sumRow(from, l, i, row, scratch);
    const auto put = [&](std::size_t j, std::size_t slot) {
      for (std::size_t k = 0; k < kBlock; ++k)
        dense(static_cast<Eigen::Index>(3 * i + k % 3), static_cast<Eigen::Index>(3 * j + k / 3)) +=
            static_cast<double>(row[slot + kEight * k]);
    };
    put(i, 0);
    const std::size_t first = kEight * std::size_t{grid.eights[2 * i]},
                      last = kEight * std::size_t{grid.eights[2 * i + 2]};
    for (std::size_t k = first; k < last; ++k) put(grid.columns[k], GridLevel::slotOf(k - first));
  }
  Eigen::VectorXd scale(n);
  for (Eigen::Index k = 0; k < n; ++k) scale[k] = static_cast<double>(level.scales[static_cast<std::size_t>(k / 3)]);
  dense = (scale.asDiagonal() * (0.5 * (dense + dense.transpose())) * scale.asDiagonal()).eval();
  const double mean = dense.trace() / static_cast<double>(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    dense(k, k) += kShift * (dense(k, k) + mean);
    if (!(dense(k, k) > 0.0)) dense(k, k) = mean > 0.0 ? mean : 1.0;
  }
  coarsest_.compute(dense);
  isDense_ = coarsest_.info() == Eigen::Success;
}

}  // namespace pointbased::detail
