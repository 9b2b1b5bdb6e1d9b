// SPDX-License-Identifier: Apache-2.0
#include "solvers/multigrid.h"

#include <algorithm>
#include <cmath>

namespace pointbased::detail {
namespace {

using Lanes = Eigen::Vector4f;

constexpr std::size_t kNode = 4;
constexpr std::size_t kRowGrain = 128;
constexpr double kSpringShare = 0.4;  // about four springs share a node

inline void store(const Lanes &v, float *out) {
  Eigen::Map<Lanes> to(out);
  to = v;
}

}  // namespace

void Multigrid::reset(std::shared_ptr<const GridHierarchy> hierarchy, std::shared_ptr<const void> source) {
  hierarchy_ = std::move(hierarchy);
  source_ = std::move(source);
  levels_.clear();
  if (!hierarchy_) return;
  levels_.resize(hierarchy_->levels.size());
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    const GridLevel &grid = hierarchy_->levels[l];
    levels_[l].blocks.assign(9 * grid.columns.size(), 0);
    levels_[l].inverses.assign(3 * kNode * grid.nodes(), 0.0F);
    levels_[l].roots.assign(grid.nodes(), 1.0F);
    levels_[l].scales.assign(grid.nodes(), 1.0F);
    levels_[l].x.assign(kNode * grid.nodes(), 0.0F);
    levels_[l].b.assign(kNode * grid.nodes(), 0.0F);
  }
}

double Multigrid::entries() const {
  double sum = 0.0;
  if (hierarchy_)
    for (const GridLevel &level : hierarchy_->levels) sum += static_cast<double>(level.rows.indices.size());
  return sum;
}

double Multigrid::rowDensity() const {
  constexpr double kOfTrilinear = 27.0;
  const GridLevel &finest = hierarchy_->levels.front();
  return std::max(
      1.0, static_cast<double>(finest.rows.indices.size()) / (kOfTrilinear * static_cast<double>(finest.nodes())));
}

// Block of the finest matrix.
Mat3 Multigrid::block(std::size_t i, std::size_t j) const {
  const GridLevel &grid = hierarchy_->levels.front();
  const Level &level = levels_.front();
  Mat3 out = Mat3::Zero();
  if (i == j) {
    for (std::size_t k = 0; k < 9; ++k) out.data()[k] = static_cast<double>(own_[9 * i + k]);
  } else {
    const auto begin = grid.columns.begin() + 8 * static_cast<std::ptrdiff_t>(grid.eights[2 * i]);
    const auto end = grid.columns.begin() + 8 * static_cast<std::ptrdiff_t>(grid.eights[2 * i + 2]);
    const auto found = std::find(begin, end, static_cast<Index>(j));
    if (found == end) return out;
    const auto at = static_cast<std::size_t>(found - grid.columns.begin());
    for (std::size_t k = 0; k < 9; ++k)
      out.data()[k] = static_cast<double>(kernels::SweepRows::kUnit) * level.blocks[72 * (at / 8) + 8 * k + at % 8];
  }
  return static_cast<double>(level.roots[i]) * static_cast<double>(level.roots[j]) * out;
}

void Multigrid::invertSprings(const Csr &springs, const StopRequest *stop) {
  springs_ = Csr();
  springInverses_.clear();
  for (std::size_t p = 0; p < springs.rows(); ++p) {
    throwIfStopRequested(stop);
    const std::size_t begin = springs_.indices.size();
    for (const Index j : springs.row(p))
      if (held_[hierarchy_->number[j]] == 0) springs_.indices.push_back(hierarchy_->number[j]);
    const auto n = static_cast<Eigen::Index>(springs_.indices.size() - begin);
    if (n == 0) continue;
    springs_.offsets.push_back(static_cast<Index>(springs_.indices.size()));
    const std::span<const Index> nodes = std::span<const Index>(springs_.indices).subspan(begin);
    Eigen::MatrixXd dense(3 * n, 3 * n);
    for (Eigen::Index a = 0; a < n; ++a)
      for (Eigen::Index b = 0; b < n; ++b)
        dense.block<3, 3>(3 * a, 3 * b) = block(nodes[static_cast<std::size_t>(a)], nodes[static_cast<std::size_t>(b)]);
    dense.diagonal() *= 1.0 + 1e-4;
    springInverses_.emplace_back(
        (kSpringShare * dense.llt().solve(Eigen::MatrixXd::Identity(3 * n, 3 * n))).cast<float>());
  }
}

// x += Σ_p share R_p^T A_p^-1 R_p r: additive Schwarz.
void Multigrid::solveSprings() {
  Eigen::VectorXf right, found;
  for (std::size_t p = 0; p < springs_.rows(); ++p) {
    const auto nodes = springs_.row(p);
    right.resize(static_cast<Eigen::Index>(3 * nodes.size()));
    for (std::size_t a = 0; a < nodes.size(); ++a)
      right.segment<3>(static_cast<Eigen::Index>(3 * a)) =
          Eigen::Map<const Eigen::Vector3f>(residual_.data() + kNode * nodes[a]);
    found.noalias() = springInverses_[p] * right;
    for (std::size_t a = 0; a < nodes.size(); ++a)
      Eigen::Map<Eigen::Vector3f>(levels_.front().x.data() + kNode * nodes[a]) +=
          levels_.front().roots[nodes[a]] * found.segment<3>(static_cast<Eigen::Index>(3 * a));
  }
}

// Calls visit(first, last) for the nodes of every slab of a half.
template <class Visit>
void Multigrid::forSlabs(const GridLevel &grid, bool isFirstHalf, const Visit &visit) const {
  const std::size_t start = isFirstHalf ? 0 : grid.firstHalf;
  const std::size_t count = isFirstHalf ? grid.firstHalf : grid.slabs.size() - 1 - grid.firstHalf;
  const auto some = [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = start + begin; s < start + end; ++s) visit(grid.slabs[s], grid.slabs[s + 1]);
  };
  parallelFor_(count, 1, std::cref(some));
}

kernels::SweepRows Multigrid::rowsOf(std::size_t l) {
  const GridLevel &grid = hierarchy_->levels[l];
  Level &level = levels_[l];
  return {level.blocks.data(),   grid.columns.data(), grid.eights.data(),
          level.inverses.data(), level.b.data(),      level.x.data()};
}

// From x = 0: later nodes have not moved yet.
void Multigrid::smoothForwards(std::size_t l) {
  const kernels::SweepRows rows = rowsOf(l);
  for (const bool isFirstHalf : {true, false})
    forSlabs(hierarchy_->levels[l], isFirstHalf,
             [&](Index first, Index last) { kernels::sweepForwards(rows, first, last); });
}

void Multigrid::smoothBackwards(std::size_t l) {
  const kernels::SweepRows rows = rowsOf(l);
  for (const bool isFirstHalf : {false, true})
    forSlabs(hierarchy_->levels[l], isFirstHalf,
             [&](Index first, Index last) { kernels::sweepBackwards(rows, first, last); });
}

// Right-hand side of the coarser level: P^T of the residual, which after a forward sweep is the contribution of later
// nodes.
void Multigrid::restrictResidual(std::size_t l) {
  const GridLevel &fine = hierarchy_->levels[l], &coarse = hierarchy_->levels[l + 1];
  const Level &from = levels_[l];
  Level &to = levels_[l + 1];
  residual_.resize(std::max(residual_.size(), kNode * fine.nodes()));
  const kernels::SweepRows matrix = rowsOf(l);
  const auto residuals = [&](std::size_t begin, std::size_t end) {
    kernels::residualsAfter(matrix, residual_.data(), begin, end);
    for (std::size_t i = begin; i < end; ++i) Eigen::Map<Lanes>(residual_.data() + kNode * i) *= from.roots[i];
  };
  parallelFor_(fine.nodes(), kRowGrain, std::cref(residuals));
  const auto rows = [&](std::size_t begin, std::size_t end) {
    for (std::size_t I = begin; I < end; ++I) {
      Lanes sum = Lanes::Zero();
      for (Index k = coarse.children.offsets[I]; k < coarse.children.offsets[I + 1]; ++k) {
        const Index i = coarse.children.indices[k];
        if (l == 0 && held_[i] != 0) continue;
        sum += coarse.childWeights[k] * Eigen::Map<const Lanes>(residual_.data() + kNode * i);
      }
      store(to.scales[I] * sum, to.b.data() + kNode * I);
    }
  };
  parallelFor_(coarse.nodes(), kRowGrain, std::cref(rows));
}

void Multigrid::prolong(std::size_t l) {
  const GridLevel &fine = hierarchy_->levels[l];
  Level &to = levels_[l];
  const Level &from = levels_[l + 1];
  const auto rows = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (l == 0 && held_[i] != 0) continue;
      Lanes sum = Lanes::Zero();
      for (Index p = fine.parents.offsets[i]; p < fine.parents.offsets[i + 1]; ++p) {
        const Index I = fine.parents.indices[p];
        sum += (fine.parentWeights[p] * from.scales[I]) * Eigen::Map<const Lanes>(from.x.data() + kNode * I);
      }
      Eigen::Map<Lanes>(to.x.data() + kNode * i) += to.roots[i] * sum;
    }
  };
  parallelFor_(fine.nodes(), kRowGrain, std::cref(rows));
}

void Multigrid::cycle(std::size_t l) {
  Level &level = levels_[l];
  if (l + 1 == levels_.size()) {
    const std::size_t n = hierarchy_->levels[l].nodes();
    if (!isDense_) {
      smoothForwards(l);
      smoothBackwards(l);
      return;
    }
    Eigen::VectorXd right(static_cast<Eigen::Index>(3 * n));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t c = 0; c < 3; ++c) right[static_cast<Eigen::Index>(3 * i + c)] = level.b[kNode * i + c];
    coarsest_.solveInPlace(right);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        level.x[kNode * i + c] = static_cast<float>(right[static_cast<Eigen::Index>(3 * i + c)]);
    return;
  }
  smoothForwards(l);
  restrictResidual(l);
  if (l == 0) solveSprings();
  cycle(l + 1);
  prolong(l);
  smoothBackwards(l);
}

void Multigrid::multiply(std::span<const Vec3> in, std::span<Vec3> out) const {
  const GridLevel &grid = hierarchy_->levels.front();
  for (std::size_t i = 0; i < grid.nodes(); ++i) {
    Vec3 sum = Vec3::Zero();
    for (const Index j : grid.rows.row(i)) sum += block(i, j) * in[hierarchy_->order[j]];
    out[hierarchy_->order[i]] = sum;
  }
}

void Multigrid::apply(std::span<const Vec3> in, std::span<Vec3> out) {
  const std::vector<Index> &order = hierarchy_->order;
  Level &finest = levels_.front();
  // The range of floats starts at 1e-38: a residual of any magnitude is scaled to about one.
  double largest = 0.0;
  for (const Vec3 &v : in) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  if (!(largest > 0.0) || !std::isfinite(largest)) {
    std::copy(in.begin(), in.end(), out.begin());
    return;
  }
  const double scale = 1.0 / largest;
  const auto take = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        finest.b[kNode * i + c] =
            finest.scales[i] * static_cast<float>(scale * in[order[i]][static_cast<Eigen::Index>(c)]);
  };
  parallelFor_(order.size(), 4 * kRowGrain, std::cref(take));
  cycle(0);
  const auto give = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        out[order[i]][static_cast<Eigen::Index>(c)] =
            largest * static_cast<double>(finest.scales[i] * finest.x[kNode * i + c]);
  };
  parallelFor_(order.size(), 4 * kRowGrain, std::cref(give));
}

}  // namespace pointbased::detail
