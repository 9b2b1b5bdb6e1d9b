// SPDX-License-Identifier: Apache-2.0
#include "solvers/preconditioner.h"

#include <Eigen/Cholesky>
#include <Eigen/IterativeLinearSolvers>
#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/multifrontal_cholesky.h"
#include "solvers/multigrid.h"

namespace pointbased::detail {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
// Phyxels are sorted in space; their order needs a third fewer iterations than minimum degree (measured).
using Incomplete = Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::NaturalOrdering<int>>;

constexpr std::size_t kMaxOfWhole = 1500;  // phyxels of several parts that are factorised together

// Costs in approximate nanoseconds, measured by bench_newton; only their ratios matter.
constexpr double kProductCost = 1.15;         // per entry of the Hessian, matrix-free
constexpr double kAssemblyCost = 50.0;        // per entry of the Hessian
constexpr double kIncompleteCost = 80.0;      // per entry of the factor
constexpr double kIncompleteSolveCost = 0.8;  // per entry of the factor, forward and backward
constexpr double kCompleteCost = 0.12;        // per multiply-add
constexpr double kCompleteSolveCost = 0.5;    // per entry of the factor, forward and backward

constexpr double kGridAssemblyCost = 50.0;  // per block of the matrices of all lattices
constexpr double kGridCost = 5.0;           // per such block: a V-cycle and the other work of an iteration
// Of a complete factorisation that has not been analysed, from the number of phyxels: n² and n^(4/3), for bodies of
// equal extent in all directions. With r times the blocks in a row of trilinear functions a factorisation costs r² times
// as much, a solve r times.
constexpr double kGuessedCompleteCost = 10.0, kGuessedSolveCost = 40.0;

constexpr double kCheap = 200.0;  // iterations; see the header
// More iterations of a V-cycle than this times those of a fresh one, plus kSlack, are attributed to its age: iterations
// also vary from step to step.
constexpr double kScatter = 1.2, kSlack = 1.0;
constexpr int kFresh = 2;       // solves that measure a fresh V-cycle: those of a step differ, and strain ages it
constexpr double kUsual = 8.0;  // iterations of a solve with a complete one that is almost fresh
constexpr std::size_t kMaxAnalysed = 30000;  // phyxels; beyond, `automatic` does not consider a complete one
constexpr double kMaxEntries = 2.5e8;        // of a complete factor: 1 GB

double decimals(double tolerance) { return std::max(1.0, -std::log10(tolerance)); }

}  // namespace

struct AdaptivePreconditioner::Impl {
  Preconditioner choice = Preconditioner::blockJacobi;
  Preconditioner kind = Preconditioner::blockJacobi;  // current choice of `automatic`
  std::vector<std::uint8_t> mask;
  std::size_t phyxels = 0;
  bool valid = false;
  bool blocksInstead = false;  // nothing could be factorised
  int factorisations = 0;

  std::vector<Mat3> blocks;
  Sparse matrix;
  std::vector<int> outer, inner;  // pattern analysed for `complete`
  MultifrontalCholesky complete;
  Incomplete incomplete;
  Multigrid grid;

  // Cost accounting, in the unit of the costs. A fresh factorisation needs `rate` iterations per decimal of tolerance;
  // -1: unknown.
  double price = 0.0, iteration = 1.0, rate = -1.0, excess = 0.0;
  int solves = 0;  // since it was built, at most kFresh
  // For a complete factorisation while another one is in use; infinite price: not available.
  double completePrice = 0.0, completeIteration = 0.0, lost = 0.0;
  bool isTooLarge = false;  // a complete one, according to its analysis

  [[nodiscard]] bool mayImprove() const {
    return choice == Preconditioner::automatic && std::isfinite(completePrice) &&
           (kind == Preconditioner::incomplete || kind == Preconditioner::multigrid);
  }
  // Iterations of a solve that are not due to age.
  [[nodiscard]] double usual(double tolerance) const {
    return kind == Preconditioner::multigrid ? kScatter * rate * decimals(tolerance) + kSlack
                                             : rate * decimals(tolerance);
  }
  void invalidate() {
    valid = false;
    rate = -1.0;
    excess = 0.0;
    solves = 0;
  }
  void decideAnew() {
    invalidate();
    kind = choice == Preconditioner::automatic ? Preconditioner::multigrid : choice;
    completePrice = std::numeric_limits<double>::infinity();
    lost = 0.0;
    isTooLarge = false;
    outer.clear();
    inner.clear();
  }
  void makeBlocks(IncrementalPotential &problem);
  bool assemble(IncrementalPotential &problem);
  void analyse();
  bool factoriseComplete(const StopRequest *stop);
  bool factoriseIncomplete();
};

AdaptivePreconditioner::AdaptivePreconditioner() : impl_(std::make_unique<Impl>()) {}
AdaptivePreconditioner::~AdaptivePreconditioner() = default;
AdaptivePreconditioner::AdaptivePreconditioner(AdaptivePreconditioner &&) noexcept = default;
AdaptivePreconditioner &AdaptivePreconditioner::operator=(AdaptivePreconditioner &&) noexcept = default;

int AdaptivePreconditioner::factorisations() const { return impl_->factorisations; }
bool AdaptivePreconditioner::isStrong() const {
  return !impl_->blocksInstead &&
         (impl_->kind == Preconditioner::multigrid || impl_->kind == Preconditioner::factorised);
}
void AdaptivePreconditioner::forget() { impl_->decideAnew(); }

void AdaptivePreconditioner::Impl::makeBlocks(IncrementalPotential &problem) {
  blocks.resize(phyxels);
  problem.diagonalBlocks(blocks);
  for (std::size_t i = 0; i < phyxels; ++i) {
    if (!mask.empty() && mask[i] != 0) {
      blocks[i].setIdentity();
      continue;
    }
    const Eigen::LLT<Mat3> llt(blocks[i]);
    const double diagonal = blocks[i].diagonal().cwiseAbs().maxCoeff();
    if (llt.info() == Eigen::Success && llt.matrixLLT().diagonal().minCoeff() > 0.0) {
      const Mat3 inverse = llt.solve(Mat3::Identity());
      blocks[i] = 0.5 * (inverse + inverse.transpose());
    } else {
      blocks[i] = (std::isfinite(diagonal) && diagonal > 0.0 ? 1.0 / diagonal : 1.0) * Mat3::Identity();
    }
  }
}

bool AdaptivePreconditioner::Impl::assemble(IncrementalPotential &problem) {
  if (!problem.assemble(matrix) || static_cast<std::size_t>(matrix.rows()) != 3 * phyxels) return false;
  if (!mask.empty()) {
    const auto free = [this](Eigen::Index i) { return mask[static_cast<std::size_t>(i / 3)] == 0; };
    matrix.prune([&](Eigen::Index i, Eigen::Index j, double) { return i == j || (free(i) && free(j)); });
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
      if (!free(i)) matrix.coeffRef(i, i) = 1.0;
  }
  matrix.makeCompressed();
  return true;
}

// Order and fronts of the complete factorisation, unless the pattern has been analysed already.
void AdaptivePreconditioner::Impl::analyse() {
  const int *outerBegin = matrix.outerIndexPtr(), *outerEnd = outerBegin + matrix.outerSize() + 1;
  const int *innerBegin = matrix.innerIndexPtr(), *innerEnd = innerBegin + matrix.nonZeros();
  if (std::equal(outerBegin, outerEnd, outer.begin(), outer.end()) &&
      std::equal(innerBegin, innerEnd, inner.begin(), inner.end()))
    return;
  outer.assign(outerBegin, outerEnd);
  inner.assign(innerBegin, innerEnd);
  complete.analyse(matrix);
}

bool AdaptivePreconditioner::Impl::factoriseComplete(const StopRequest *stop) {
  analyse();
  if (complete.entries() > kMaxEntries) return false;
  // The diagonal of a matrix that is indefinite by round-off only, or singular (a free body), is shifted slightly.
  for (const double diagonalShift : {0.0, 1e-9, 1e-6, 1e-3, 1e-1})
    if (complete.factorise(matrix, diagonalShift, stop)) return true;
  return false;
}

bool AdaptivePreconditioner::Impl::factoriseIncomplete() {
  incomplete.compute(matrix);
  return incomplete.info() == Eigen::Success;
}

void AdaptivePreconditioner::prepare(IncrementalPotential &problem, Preconditioner choice, const StopRequest *stop) {
  Impl &m = *impl_;
  const std::size_t n = problem.phyxels();
  const std::span<const std::uint8_t> mask = problem.prescribed();
  if (n != m.phyxels || choice != m.choice) {
    m.phyxels = n;
    m.choice = choice;
    m.decideAnew();
  }
  if (!std::equal(mask.begin(), mask.end(), m.mask.begin(), m.mask.end())) {
    m.mask.assign(mask.begin(), mask.end());
    m.invalidate();
  }
  if (m.kind == Preconditioner::blockJacobi || !m.valid || m.blocksInstead || m.excess > m.price) renew(problem, stop);
}

void AdaptivePreconditioner::renew(IncrementalPotential &problem, const StopRequest *stop) {
  Impl &m = *impl_;
  throwIfStopRequested(stop);
  m.invalidate();
  m.valid = true;
  if (m.kind == Preconditioner::multigrid) {
    if (problem.assembleGrids(m.grid, stop)) {
      m.blocksInstead = false;
      m.price = kGridAssemblyCost * m.grid.entries();
      m.iteration = kGridCost * m.grid.entries();
      const auto n = static_cast<double>(m.phyxels);
      if (m.choice == Preconditioner::automatic && m.phyxels <= kMaxAnalysed && !m.isTooLarge) {
        const double density = m.grid.rowDensity();
        m.completePrice = kGuessedCompleteCost * n * n * density * density;
        m.completeIteration = kGuessedSolveCost * std::pow(n, 4.0 / 3.0) * density;
      }
      ++m.factorisations;
      return;
    }
    if (m.choice == Preconditioner::multigrid) {
      m.blocksInstead = true;
      return m.makeBlocks(problem);
    }
    m.kind = Preconditioner::incomplete;
  }
  m.blocksInstead = m.kind != Preconditioner::blockJacobi && !m.assemble(problem);
  if (m.kind == Preconditioner::blockJacobi || m.blocksInstead) {
    m.makeBlocks(problem);
    return;
  }

  throwIfStopRequested(stop);
  const double entries = static_cast<double>(m.matrix.nonZeros()), half = 0.5 * entries;
  m.price = kAssemblyCost * entries + kIncompleteCost * half;
  m.iteration = kProductCost * entries + kIncompleteSolveCost * half;
  if (m.kind == Preconditioner::factorised || (m.choice == Preconditioner::automatic && m.phyxels <= kMaxAnalysed)) {
    m.analyse();
    m.completePrice = m.complete.entries() > kMaxEntries ? std::numeric_limits<double>::infinity()
                                                         : kAssemblyCost * entries + kCompleteCost * m.complete.work();
    m.completeIteration = kProductCost * entries + kCompleteSolveCost * m.complete.entries();
    m.isTooLarge = !std::isfinite(m.completePrice);
    // A V-cycle had been replaced by it before its size was known.
    if (m.isTooLarge && m.choice == Preconditioner::automatic && m.kind == Preconditioner::factorised &&
        m.grid.exists()) {
      m.kind = Preconditioner::multigrid;
      return renew(problem, stop);
    }
    if (m.mayImprove() && m.completePrice <= kCheap * m.iteration) m.kind = Preconditioner::factorised;
  }
  bool done = false;
  if (m.kind == Preconditioner::factorised) {
    m.price = m.completePrice;
    m.iteration = m.completeIteration;
    done = m.factoriseComplete(stop);
  } else {
    done = m.factoriseIncomplete();
  }
  if (done) {
    ++m.factorisations;
  } else {
    m.blocksInstead = true;  // the next step tries again
    m.makeBlocks(problem);
  }
}

void AdaptivePreconditioner::apply(std::span<const Vec3> in, std::span<Vec3> out) {
  Impl &m = *impl_;
  if (m.kind == Preconditioner::blockJacobi || m.blocksInstead) {
    for (std::size_t i = 0; i < in.size(); ++i) out[i] = m.blocks[i] * in[i];
  } else if (m.kind == Preconditioner::multigrid) {
    m.grid.apply(in, out);
  } else if (m.kind == Preconditioner::factorised) {
    m.complete.solve(in, out);
  } else {
    const auto size = static_cast<Eigen::Index>(3 * in.size());
    Eigen::Map<Eigen::VectorXd>(out.front().data(), size) =
        m.incomplete.solve(Eigen::Map<const Eigen::VectorXd>(in.front().data(), size));
  }
}

int AdaptivePreconditioner::iterationBudget(double tolerance, int most) const {
  const Impl &m = *impl_;
  if (m.kind == Preconditioner::blockJacobi || m.blocksInstead) return most;
  double left = most;
  if (m.rate >= 0.0) left = std::min(left, m.usual(tolerance) + (m.price - m.excess) / m.iteration);
  if (m.mayImprove()) left = std::min(left, (m.completePrice - m.lost + kUsual * m.completeIteration) / m.iteration);
  return left < most ? std::max(0, static_cast<int>(left)) + 1 : most;
}

void AdaptivePreconditioner::book(int iterations, double tolerance, bool complete) {
  Impl &m = *impl_;
  if (m.kind == Preconditioner::blockJacobi || m.blocksInstead) return;
  if (m.kind == Preconditioner::multigrid && complete && m.solves < kFresh) {
    m.rate = std::max(m.rate, std::max(1, iterations) / decimals(tolerance));
    ++m.solves;
  } else if (m.rate >= 0.0) {
    m.excess += m.iteration * std::max(0.0, iterations - m.usual(tolerance));
  } else if (complete) {
    m.rate = std::max(1, iterations) / decimals(tolerance);
  }
  if (m.mayImprove()) {
    m.lost = std::max(0.0, m.lost + iterations * m.iteration - kUsual * m.completeIteration);
    if (m.lost > m.completePrice) {
      m.kind = Preconditioner::factorised;
      m.invalidate();
    }
  }
}

void PreconditionerOfParts::prepare(IncrementalPotential &problem, Preconditioner choice, const StopRequest *stop) {
  const std::span<IncrementalPotential *const> parts = problem.parts();
  isWhole_ = parts.empty() || choice == Preconditioner::incomplete || choice == Preconditioner::factorised ||
             (choice == Preconditioner::automatic && parts.size() > 1 && problem.phyxels() <= kMaxOfWhole);
  sizes_.clear();
  if (isWhole_)
    sizes_.push_back(problem.phyxels());
  else
    for (IncrementalPotential *part : parts) sizes_.push_back(part->phyxels());
  keepers_.resize(sizes_.size());
  if (isWhole_) return keepers_.front().prepare(problem, choice, stop);
  // The coupling of the parts costs iterations that no factorisation of a single part saves.
  const Preconditioner ofPart = choice == Preconditioner::automatic ? Preconditioner::multigrid : choice;
  for (std::size_t k = 0; k < parts.size(); ++k) keepers_[k].prepare(*parts[k], ofPart, stop);
}

void PreconditionerOfParts::renew(IncrementalPotential &problem, const StopRequest *stop) {
  if (isWhole_) return keepers_.front().renew(problem, stop);
  const std::span<IncrementalPotential *const> parts = problem.parts();
  for (std::size_t k = 0; k < parts.size(); ++k) keepers_[k].renew(*parts[k], stop);
}

void PreconditionerOfParts::apply(std::span<const Vec3> in, std::span<Vec3> out) {
  std::size_t first = 0;
  for (std::size_t k = 0; k < sizes_.size(); ++k) {
    keepers_[k].apply(in.subspan(first, sizes_[k]), out.subspan(first, sizes_[k]));
    first += sizes_[k];
  }
}

int PreconditionerOfParts::iterationBudget(double tolerance, int most) const {
  for (const AdaptivePreconditioner &keeper : keepers_) most = std::min(most, keeper.iterationBudget(tolerance, most));
  return most;
}

void PreconditionerOfParts::book(int iterations, double tolerance, bool complete) {
  for (AdaptivePreconditioner &keeper : keepers_) keeper.book(iterations, tolerance, complete);
}

int PreconditionerOfParts::factorisations() const {
  int sum = 0;
  for (const AdaptivePreconditioner &keeper : keepers_) sum += keeper.factorisations();
  return sum;
}

void PreconditionerOfParts::forget() {
  for (AdaptivePreconditioner &keeper : keepers_) keeper.forget();
}

}  // namespace pointbased::detail
