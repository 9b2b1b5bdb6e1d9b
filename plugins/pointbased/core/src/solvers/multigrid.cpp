// SPDX-License-Identifier: Apache-2.0
#include "solvers/multigrid.h"

#include <algorithm>
#include <cmath>

namespace pointbased::detail {
namespace {

using Block = Eigen::Matrix3f;
using Lanes = Eigen::Vector4f;
using ConstBlock = Eigen::Map<const Eigen::Matrix3f>;

constexpr std::size_t kBlock = 9, kNode = 4;
constexpr std::size_t kRowGrain = 128;
constexpr std::size_t kMostDense = 400;  // nodes of a dense factorisation
constexpr double kSpringShare = 0.4;     // about four springs share a node
constexpr double kShift = 1e-6;          // of the diagonal: rigid motions of what nothing holds

// y += B x; the fourth lane is of no meaning. Reads one number beyond the block.
inline void multiplyAdd(const float *block, const float *x, Lanes &y) {
  y += Eigen::Map<const Lanes>(block) * x[0];
  y += Eigen::Map<const Lanes>(block + 3) * x[1];
  y += Eigen::Map<const Lanes>(block + 6) * x[2];
}

inline void store(const Lanes &v, float *out) {
  Eigen::Map<Lanes> to(out);
  to = v;
}

Block inverseOf(const Block &block) {
  Mat3 d = block.cast<double>();
  d.diagonal().array() += kShift * d.trace() / 3.0;
  const Eigen::LLT<Mat3> llt(d);
  if (llt.info() != Eigen::Success || !(d.trace() > 0.0)) {
    const double largest = d.diagonal().cwiseAbs().maxCoeff();
    return (largest > 0.0 && std::isfinite(largest) ? static_cast<float>(1.0 / largest) : 1.0F) * Block::Identity();
  }
  return llt.solve(Mat3::Identity()).cast<float>();
}

}  // namespace

// x of node i where its balance is, with what its neighbours pull.
void Multigrid::relax(Level &level, std::size_t i, const Eigen::Vector4f &neighbours) {
  const Lanes right = Eigen::Map<const Lanes>(level.b.data() + kNode * i) - neighbours;
  Lanes x = Lanes::Zero();
  multiplyAdd(level.inverses.data() + kBlock * i, right.data(), x);
  store(x, level.x.data() + kNode * i);
}

void Multigrid::reset(std::shared_ptr<const GridHierarchy> hierarchy, std::shared_ptr<const void> source) {
  hierarchy_ = std::move(hierarchy);
  source_ = std::move(source);
  levels_.clear();
  if (!hierarchy_) return;
  levels_.resize(hierarchy_->levels.size());
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    const GridLevel &grid = hierarchy_->levels[l];
    levels_[l].blocks.assign(kBlock * grid.rows.indices.size() + kNode, 0.0F);
    levels_[l].inverses.assign(kBlock * grid.nodes() + kNode, 0.0F);
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

void Multigrid::assemble(const StencilSet &s, const StiffnessFactors &factors, std::span<const Mat3> blocks,
                         const SpringRows &springs, std::span<const std::uint8_t> held, const ParallelFor &parallelFor,
                         const StopRequest *stop) {
  parallelFor_ = parallelFor;
  const GridLevel &grid = hierarchy_->levels.front();
  std::vector<float> &out = levels_.front().blocks;
  held_.assign(grid.nodes(), 0);
  if (!held.empty())
    for (std::size_t i = 0; i < grid.nodes(); ++i) held_[i] = held[hierarchy_->order[i]];
  const auto rows = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index first = grid.rows.offsets[i], last = grid.rows.offsets[i + 1], phyxel = hierarchy_->order[i];
      std::fill(out.begin() + static_cast<std::ptrdiff_t>(kBlock * first),
                out.begin() + static_cast<std::ptrdiff_t>(kBlock * last), 0.0F);
      float *own = out.data() + kBlock * grid.diagonal[i];
      if (held_[i] != 0) {
        own[0] = own[4] = own[8] = 1.0F;
        continue;
      }
      for (const Index j : s.entriesOfPhyxel.row(phyxel)) {
        const Index q = s.pointOfEntry(j), begin_q = s.phyxels.offsets[q], end_q = s.phyxels.offsets[q + 1];
        const Index *slots = hierarchy_->slots.data() + hierarchy_->pairs[q] + (j - begin_q) * (end_q - begin_q);
        const Eigen::Vector3f &a = factors.gradients[j];
        const Eigen::Vector3f la = factors.lambda[q] * a, ma = factors.mu[q] * a;
        const Lanes &h = factors.modes[j];
        for (Index l = begin_q; l < end_q; ++l) {
          const Eigen::Vector3f &c = factors.gradients[l];
          float *at = out.data() + kBlock * slots[l - begin_q];
          const float d = ma.dot(c) + h.dot(factors.modes[l]);
          // (λ a c^T + μ c a^T + d I), by columns
          for (int column = 0; column < 3; ++column)
            for (int row = 0; row < 3; ++row) at[3 * column + row] += la[row] * c[column] + c[row] * ma[column];
          at[0] += d;
          at[4] += d;
          at[8] += d;
        }
      }
      Eigen::Map<Block>(own) += blocks[phyxel].cast<float>();
      for (Index e = first; e < last; ++e)
        if (held_[grid.rows.indices[e]] != 0) std::fill_n(out.data() + kBlock * e, kBlock, 0.0F);
    }
  };
  parallelFor(grid.nodes(), kRowGrain, std::cref(rows));
  addSprings(springs);
  invertSprings(springs);
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    endIfRaised(stop);
    if (l > 0) coarsen(l - 1);
    invertDiagonal(l);
  }
  const GridLevel &last = hierarchy_->levels.back();
  isDense_ = last.nodes() <= kMostDense;
  if (isDense_) {
    const auto n = static_cast<Eigen::Index>(3 * last.nodes());
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t i = 0; i < last.nodes(); ++i)
      for (Index e = last.rows.offsets[i]; e < last.rows.offsets[i + 1]; ++e)
        dense.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * last.rows.indices[e])) =
            ConstBlock(levels_.back().blocks.data() + kBlock * e).cast<double>();
    dense = 0.5 * (dense + dense.transpose().eval());
    const double mean = dense.trace() / static_cast<double>(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      dense(k, k) += kShift * (dense(k, k) + mean);
      if (!(dense(k, k) > 0.0)) dense(k, k) = mean > 0.0 ? mean : 1.0;
    }
    coarsest_.compute(dense);
    isDense_ = coarsest_.info() == Eigen::Success;
  }
}

void Multigrid::addSprings(const SpringRows &springs) {
  std::vector<float> &out = levels_.front().blocks;
  const std::vector<Index> &number = hierarchy_->number;
  for (std::size_t p = 0; p < springs.rows.rows(); ++p) {
    const Index *slot = hierarchy_->springSlots.data() + hierarchy_->springPairs[p];
    for (Index a = springs.rows.offsets[p]; a < springs.rows.offsets[p + 1]; ++a)
      for (Index b = springs.rows.offsets[p]; b < springs.rows.offsets[p + 1]; ++b, ++slot) {
        if (held_[number[springs.rows.indices[a]]] != 0 || held_[number[springs.rows.indices[b]]] != 0) continue;
        const auto k = static_cast<float>(springs.stiffness[p] * springs.weights[a] * springs.weights[b]);
        for (const std::size_t c : {0U, 4U, 8U}) out[kBlock * *slot + c] += k;
      }
  }
}

void Multigrid::invertSprings(const SpringRows &springs) {
  const GridLevel &grid = hierarchy_->levels.front();
  const std::vector<Index> &number = hierarchy_->number;
  springs_ = Csr();
  springInverses_.clear();
  for (std::size_t p = 0; p < springs.rows.rows(); ++p) {
    const std::size_t begin = springs_.indices.size();
    for (const Index j : springs.rows.row(p))
      if (held_[number[j]] == 0) springs_.indices.push_back(number[j]);
    const auto n = static_cast<Eigen::Index>(springs_.indices.size() - begin);
    if (n == 0) continue;
    springs_.offsets.push_back(static_cast<Index>(springs_.indices.size()));
    const std::span<const Index> nodes = std::span<const Index>(springs_.indices).subspan(begin);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    for (Eigen::Index a = 0; a < n; ++a) {
      const auto row = grid.rows.row(nodes[static_cast<std::size_t>(a)]);
      for (Eigen::Index b = 0; b < n; ++b) {
        const auto at = std::lower_bound(row.begin(), row.end(), nodes[static_cast<std::size_t>(b)]);
        const std::size_t e =
            grid.rows.offsets[nodes[static_cast<std::size_t>(a)]] + static_cast<std::size_t>(at - row.begin());
        dense.block<3, 3>(3 * a, 3 * b) = ConstBlock(levels_.front().blocks.data() + kBlock * e).cast<double>();
      }
    }
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
          found.segment<3>(static_cast<Eigen::Index>(3 * a));
  }
}

void Multigrid::invertDiagonal(std::size_t l) {
  const GridLevel &grid = hierarchy_->levels[l];
  Level &level = levels_[l];
  const auto rows = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      Eigen::Map<Block>(level.inverses.data() + kBlock * i) =
          inverseOf(ConstBlock(level.blocks.data() + kBlock * grid.diagonal[i]));
  };
  parallelFor_(grid.nodes(), kRowGrain, std::cref(rows));
}

// P^T A P, row by row: rows of finer children together, then to their parents.
void Multigrid::coarsen(std::size_t l) {
  const GridLevel &fine = hierarchy_->levels[l], &coarse = hierarchy_->levels[l + 1];
  const Level &from = levels_[l];
  Level &to = levels_[l + 1];
  constexpr Index kNone = ~Index{0};
  const auto rows = [&](std::size_t begin, std::size_t end) {
    std::vector<Index> place(fine.nodes(), kNone), slot(coarse.nodes(), kNone), touched;
    std::vector<Block> sums;
    for (std::size_t I = begin; I < end; ++I) {
      touched.clear();
      sums.clear();
      for (Index k = coarse.children.offsets[I]; k < coarse.children.offsets[I + 1]; ++k) {
        const Index i = coarse.children.indices[k];
        if (l == 0 && held_[i] != 0) continue;
        const float w = coarse.childWeights[k];
        for (Index e = fine.rows.offsets[i]; e < fine.rows.offsets[i + 1]; ++e) {
          const Index j = fine.rows.indices[e];
          if (l == 0 && held_[j] != 0) continue;
          if (place[j] == kNone) {
            place[j] = static_cast<Index>(touched.size());
            touched.push_back(j);
            sums.emplace_back(Block::Zero());
          }
          sums[place[j]] += w * ConstBlock(from.blocks.data() + kBlock * e);
        }
      }
      const Index first = coarse.rows.offsets[I], last = coarse.rows.offsets[I + 1];
      for (Index e = first; e < last; ++e) slot[coarse.rows.indices[e]] = e;
      std::fill(to.blocks.begin() + static_cast<std::ptrdiff_t>(kBlock * first),
                to.blocks.begin() + static_cast<std::ptrdiff_t>(kBlock * last), 0.0F);
      for (const Index j : touched) {
        for (Index p = fine.parents.offsets[j]; p < fine.parents.offsets[j + 1]; ++p)
          Eigen::Map<Block>(to.blocks.data() + kBlock * slot[fine.parents.indices[p]]) +=
              fine.parentWeights[p] * sums[place[j]];
        place[j] = kNone;
      }
    }
  };
  parallelFor_(coarse.nodes(), kRowGrain, std::cref(rows));
}

// visit(first, last) for the nodes of every slab of a half.
template <class Visit>
void Multigrid::forSlabs(const GridLevel &grid, bool isFirstHalf, const Visit &visit) const {
  const std::size_t start = isFirstHalf ? 0 : grid.firstHalf;
  const std::size_t count = isFirstHalf ? grid.firstHalf : grid.slabs.size() - 1 - grid.firstHalf;
  const auto some = [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = start + begin; s < start + end; ++s) visit(grid.slabs[s], grid.slabs[s + 1]);
  };
  parallelFor_(count, 1, std::cref(some));
}

// From x = 0: what comes later in the order has not moved yet.
void Multigrid::smoothForwards(std::size_t l) {
  const GridLevel &grid = hierarchy_->levels[l];
  Level &level = levels_[l];
  const float *blocks = level.blocks.data();
  for (const bool isFirstHalf : {true, false})
    forSlabs(grid, isFirstHalf, [&](Index first, Index last) {
      for (std::size_t i = first; i < last; ++i) {
        Lanes sum = Lanes::Zero();
        for (Index e = grid.rows.offsets[i]; e < grid.diagonal[i]; ++e)
          multiplyAdd(blocks + kBlock * e, level.x.data() + kNode * grid.rows.indices[e], sum);
        relax(level, i, sum);
      }
    });
}

void Multigrid::smoothBackwards(std::size_t l) {
  const GridLevel &grid = hierarchy_->levels[l];
  Level &level = levels_[l];
  const float *blocks = level.blocks.data();
  for (const bool isFirstHalf : {false, true})
    forSlabs(grid, isFirstHalf, [&](Index first, Index last) {
      for (std::size_t i = last; i-- > first;) {
        Lanes sum = Lanes::Zero();
        for (Index e = grid.rows.offsets[i]; e < grid.diagonal[i]; ++e)
          multiplyAdd(blocks + kBlock * e, level.x.data() + kNode * grid.rows.indices[e], sum);
        for (Index e = grid.diagonal[i] + 1; e < grid.rows.offsets[i + 1]; ++e)
          multiplyAdd(blocks + kBlock * e, level.x.data() + kNode * grid.rows.indices[e], sum);
        relax(level, i, sum);
      }
    });
}

// Right side of the coarser level: P^T of the residual, which after a forward sweep is what later ones have added.
void Multigrid::restrictResidual(std::size_t l) {
  const GridLevel &fine = hierarchy_->levels[l], &coarse = hierarchy_->levels[l + 1];
  Level &from = levels_[l], &to = levels_[l + 1];
  residual_.resize(kNode * fine.nodes());
  const auto residuals = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Lanes sum = Lanes::Zero();
      for (Index e = fine.diagonal[i] + 1; e < fine.rows.offsets[i + 1]; ++e)
        multiplyAdd(from.blocks.data() + kBlock * e, from.x.data() + kNode * fine.rows.indices[e], sum);
      store(-sum, residual_.data() + kNode * i);
    }
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
      store(sum, to.b.data() + kNode * I);
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
      Lanes sum = Eigen::Map<const Lanes>(to.x.data() + kNode * i);
      for (Index p = fine.parents.offsets[i]; p < fine.parents.offsets[i + 1]; ++p)
        sum += fine.parentWeights[p] * Eigen::Map<const Lanes>(from.x.data() + kNode * fine.parents.indices[p]);
      store(sum, to.x.data() + kNode * i);
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
    for (Index e = grid.rows.offsets[i]; e < grid.rows.offsets[i + 1]; ++e)
      sum += ConstBlock(levels_.front().blocks.data() + kBlock * e).cast<double>() *
             in[hierarchy_->order[grid.rows.indices[e]]];
    out[hierarchy_->order[i]] = sum;
  }
}

void Multigrid::apply(std::span<const Vec3> in, std::span<Vec3> out) {
  const std::vector<Index> &order = hierarchy_->order;
  Level &finest = levels_.front();
  // Floats reach from 1e-38: a residual of any size is brought near one.
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
        finest.b[kNode * i + c] = static_cast<float>(scale * in[order[i]][static_cast<Eigen::Index>(c)]);
  };
  parallelFor_(order.size(), 4 * kRowGrain, std::cref(take));
  cycle(0);
  const auto give = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        out[order[i]][static_cast<Eigen::Index>(c)] = largest * static_cast<double>(finest.x[kNode * i + c]);
  };
  parallelFor_(order.size(), 4 * kRowGrain, std::cref(give));
}

}  // namespace pointbased::detail
