// SPDX-License-Identifier: Apache-2.0
#include "pointbased/patch_solver.h"

#include <Eigen/SparseCholesky>
#include <algorithm>

#include "base/expects.h"

namespace pointbased {

namespace {

// Of squared frequency × dt²: springs up to this are applied as explicit forces, stiffer ones are solved for. Cells use
// (0.8 · 2)² of the stability limit of 4 (kStepSafety), so larger values can become unstable; smaller: more rows to
// solve.
constexpr double kMild = 0.3;

/// A = Pᵀ L D Lᵀ P. The time of a solution is that of reading L. It is read once for three right-hand sides, in float,
/// because the next step corrects rounding errors.
class Factor {
 public:
  void compute(const Eigen::SparseMatrix<double> &A) {
    x_.clear();
    if (A.cols() == 0) return;
    solver_.compute(A);
    const Eigen::SparseMatrix<double> &L = solver_.matrixL().nestedExpression();
    const auto n = static_cast<std::size_t>(L.cols());
    entries_.clear();
    starts_.assign(1, 0);
    for (Eigen::Index j = 0; j < L.cols(); ++j) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(L, j); it; ++it)
        if (it.row() > j) entries_.push_back({static_cast<float>(it.value()), static_cast<Index>(it.row())});
      starts_.push_back(static_cast<Index>(entries_.size()));
    }
    x_.resize(n);
    inverseD_ = solver_.vectorD().cwiseInverse();
  }
  /// Replaces right-hand sides by solutions.
  void solve(std::span<Vec3> x) {
    const auto &place = solver_.permutationP().indices();
    const std::size_t n = x_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(place[static_cast<Eigen::Index>(i)]);
      x_[at] << x[i], 0.0;
    }
    for (std::size_t j = 0; j < n; ++j) {
      const Eigen::Array4d here = x_[j];
      for (Index e = starts_[j]; e < starts_[j + 1]; ++e) x_[entries_[e].row] -= double{entries_[e].value} * here;
    }
    for (std::size_t j = n; j-- > 0;) {
      Eigen::Array4d sum = x_[j] * inverseD_[static_cast<Eigen::Index>(j)];
      for (Index e = starts_[j]; e < starts_[j + 1]; ++e) sum -= double{entries_[e].value} * x_[entries_[e].row];
      x_[j] = sum;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(place[static_cast<Eigen::Index>(i)]);
      x[i] = x_[at].head<3>();
    }
  }

 private:
  struct Entry {
    float value;
    Index row;
  };
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
  std::vector<Entry> entries_;  // of L below its diagonal, column by column
  std::vector<Index> starts_;
  std::vector<Eigen::Array4d> x_;
  Eigen::VectorXd inverseD_;
};

}  // namespace

struct PatchSolver::Impl {
  Csr rows;
  std::vector<double> weights, stiffness, inverseMasses;
  std::vector<Vec3> forces;
  Eigen::SparseMatrix<double> coupling;  // C M⁻¹ Cᵀ
  Factor factor;
  double factorisedDt = -1.0;
  std::vector<Index> mild, stiff;  // rows applied as forces in a step of factorisedDt, and rows that are solved for
  std::vector<Vec3> change;        // [stiff]
  // M⁻¹ Cᵀ λ at the phyxels loaded by patches; used by both halves of a kick.
  std::vector<Index> pulled;
  std::vector<Vec3> acceleration;  // [phyxels]
  bool isAccelerationOld = true;
  void accelerate();

  [[nodiscard]] Vec3 mean(std::size_t p, std::span<const Vec3> field) const {
    Vec3 sum = Vec3::Zero();
    for (Index e = rows.offsets[p]; e < rows.offsets[p + 1]; ++e) sum += weights[e] * field[rows.indices[e]];
    return sum;
  }
  void divide(double dt);
};

void PatchSolver::Impl::accelerate() {
  for (const Index j : pulled) acceleration[j].setZero();
  for (std::size_t p = 0; p < rows.rows(); ++p)
    for (Index e = rows.offsets[p]; e < rows.offsets[p + 1]; ++e)
      acceleration[rows.indices[e]] += weights[e] * forces[p];
  for (const Index j : pulled) acceleration[j] *= inverseMasses[j];
  isAccelerationOld = false;
}

// Gershgorin bound: K^½ C M⁻¹ Cᵀ K^½ dt² of the mild rows has no eigenvalue above kMild.
void PatchSolver::Impl::divide(double dt) {
  mild.clear();
  stiff.clear();
  std::vector<int> place(rows.rows(), -1);
  for (std::size_t p = 0; p < rows.rows(); ++p) {
    double sum = 0.0;
    for (Eigen::SparseMatrix<double>::InnerIterator it(coupling, static_cast<Eigen::Index>(p)); it; ++it)
      sum += std::abs(it.value());
    if (!(stiffness[p] * dt * dt * sum > kMild)) {
      mild.push_back(static_cast<Index>(p));
      continue;
    }
    place[p] = static_cast<int>(stiff.size());
    stiff.push_back(static_cast<Index>(p));
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (const Index p : stiff) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(coupling, static_cast<Eigen::Index>(p)); it; ++it)
      if (const int row = place[static_cast<std::size_t>(it.row())]; row >= 0)
        entries.emplace_back(row, place[p], it.value());
    entries.emplace_back(place[p], place[p], 1.0 / (stiffness[p] * dt * dt));
  }
  const auto n = static_cast<Eigen::Index>(stiff.size());
  Eigen::SparseMatrix<double> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  factor.compute(A);
  change.resize(stiff.size());
  factorisedDt = dt;
}

PatchSolver::PatchSolver() : impl_(std::make_unique<Impl>()) {}
PatchSolver::~PatchSolver() = default;
PatchSolver::PatchSolver(PatchSolver &&) noexcept = default;
PatchSolver &PatchSolver::operator=(PatchSolver &&) noexcept = default;

std::size_t PatchSolver::rows() const { return impl_->rows.rows(); }
const Csr &PatchSolver::phyxels() const { return impl_->rows; }
std::span<const double> PatchSolver::weights() const { return impl_->weights; }
std::span<const double> PatchSolver::stiffness() const { return impl_->stiffness; }
std::size_t PatchSolver::solvedRows() const { return impl_->stiff.size(); }
std::span<const Vec3> PatchSolver::forces() const { return impl_->forces; }
std::vector<Vec3> &PatchSolver::forces() {
  impl_->isAccelerationOld = true;
  return impl_->forces;
}

void PatchSolver::clearForces() {
  impl_->forces.assign(rows(), Vec3::Zero());
  impl_->isAccelerationOld = true;
}

void PatchSolver::set(const Csr &rows, std::span<const double> weights, std::span<const double> stiffness,
                      std::span<const double> inverseMasses) {
  POINTBASED_EXPECTS(weights.size() == rows.indices.size(), "one weight per entry of the rows");
  POINTBASED_EXPECTS(stiffness.size() == rows.rows(), "one stiffness per patch");
  POINTBASED_EXPECTS(
      std::all_of(rows.indices.begin(), rows.indices.end(), [&](Index j) { return j < inverseMasses.size(); }),
      "rows name phyxels that there are");
  Impl &m = *impl_;
  m.rows = rows;
  m.weights.assign(weights.begin(), weights.end());
  m.stiffness.assign(stiffness.begin(), stiffness.end());
  m.inverseMasses.assign(inverseMasses.begin(), inverseMasses.end());
  m.factorisedDt = -1.0;
  m.pulled = rows.indices;
  std::sort(m.pulled.begin(), m.pulled.end());
  m.pulled.erase(std::unique(m.pulled.begin(), m.pulled.end()), m.pulled.end());
  m.acceleration.resize(inverseMasses.size());
  clearForces();
  const auto n = static_cast<Eigen::Index>(rows.rows());
  if (n == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t p = 0; p < rows.rows(); ++p)
    for (Index e = rows.offsets[p]; e < rows.offsets[p + 1]; ++e)
      entries.emplace_back(static_cast<int>(p), static_cast<int>(rows.indices[e]), m.weights[e]);
  Eigen::SparseMatrix<double> C(n, static_cast<Eigen::Index>(inverseMasses.size()));
  C.setFromTriplets(entries.begin(), entries.end());
  const Eigen::Map<const Eigen::VectorXd> inverse(m.inverseMasses.data(),
                                                  static_cast<Eigen::Index>(inverseMasses.size()));
  m.coupling = C * inverse.asDiagonal() * C.transpose();
}

void PatchSolver::correct(double dt, std::span<const Vec3> targets, std::span<Vec3> displacements,
                          std::span<Vec3> velocities) {
  Impl &m = *impl_;
  const std::size_t n = rows();
  if (n == 0) return;
  POINTBASED_EXPECTS(dt > 0.0, "a step");
  POINTBASED_EXPECTS(targets.size() == n, "one target per patch");
  POINTBASED_EXPECTS(displacements.size() == m.inverseMasses.size() && velocities.size() == m.inverseMasses.size(),
                     "one displacement and one velocity per phyxel");
  // Parts of a step may differ in their last digits.
  if (!(std::abs(dt - m.factorisedDt) <= 1e-9 * dt)) m.divide(dt);
  for (std::size_t i = 0; i < m.stiff.size(); ++i) {
    const Index p = m.stiff[i];
    m.change[i] = (targets[p] - m.mean(p, displacements) - m.forces[p] / m.stiffness[p]) / (dt * dt);
  }
  m.factor.solve(m.change);
  for (std::size_t i = 0; i < m.stiff.size(); ++i) {
    const Index p = m.stiff[i];
    const Vec3 &change = m.change[i];
    m.forces[p] += change;
    for (Index e = m.rows.offsets[p]; e < m.rows.offsets[p + 1]; ++e) {
      const Index j = m.rows.indices[e];
      const Vec3 kick = dt * m.inverseMasses[j] * m.weights[e] * change;
      velocities[j] += kick;
      displacements[j] += dt * kick;
    }
  }
  for (const Index p : m.mild) m.forces[p] = m.stiffness[p] * (targets[p] - m.mean(p, displacements));
  m.isAccelerationOld = true;
}

void PatchSolver::kick(double h, std::span<Vec3> velocities) {
  Impl &m = *impl_;
  POINTBASED_EXPECTS(velocities.size() == m.inverseMasses.size(), "one velocity per phyxel");
  if (m.isAccelerationOld) m.accelerate();
  for (const Index j : m.pulled) velocities[j] += h * m.acceleration[j];
}

void PatchSolver::addForces(std::span<Vec3> forces) const {
  const Impl &m = *impl_;
  for (std::size_t p = 0; p < rows(); ++p)
    for (Index e = m.rows.offsets[p]; e < m.rows.offsets[p + 1]; ++e)
      forces[m.rows.indices[e]] += m.weights[e] * m.forces[p];
}

double PatchSolver::energy(std::span<const Vec3> targets, std::span<const Vec3> u) const {
  POINTBASED_EXPECTS(targets.size() == rows(), "one target per patch");
  double sum = 0.0;
  for (std::size_t p = 0; p < rows(); ++p)
    sum += 0.5 * impl_->stiffness[p] * (impl_->mean(p, u) - targets[p]).squaredNorm();
  return sum;
}

void PatchSolver::updateForces(std::span<const Vec3> targets, std::span<const Vec3> u) {
  POINTBASED_EXPECTS(targets.size() == rows(), "one target per patch");
  for (std::size_t p = 0; p < rows(); ++p) impl_->forces[p] = impl_->stiffness[p] * (targets[p] - impl_->mean(p, u));
  impl_->isAccelerationOld = true;
}

void PatchSolver::addProduct(std::span<const Vec3> du, std::span<Vec3> out) const {
  const Impl &m = *impl_;
  for (std::size_t p = 0; p < rows(); ++p) {
    const Vec3 force = m.stiffness[p] * m.mean(p, du);
    for (Index e = m.rows.offsets[p]; e < m.rows.offsets[p + 1]; ++e) out[m.rows.indices[e]] += m.weights[e] * force;
  }
}

void PatchSolver::addDiagonal(std::span<Mat3> blocks) const {
  const Impl &m = *impl_;
  for (std::size_t p = 0; p < rows(); ++p)
    for (Index e = m.rows.offsets[p]; e < m.rows.offsets[p + 1]; ++e)
      blocks[m.rows.indices[e]].diagonal().array() += m.stiffness[p] * m.weights[e] * m.weights[e];
}

void PatchSolver::addTriplets(std::vector<Eigen::Triplet<double>> &out) const {
  const Impl &m = *impl_;
  for (std::size_t p = 0; p < rows(); ++p)
    for (Index a = m.rows.offsets[p]; a < m.rows.offsets[p + 1]; ++a)
      for (Index b = m.rows.offsets[p]; b < m.rows.offsets[p + 1]; ++b)
        for (int c = 0; c < 3; ++c)
          out.emplace_back(static_cast<int>(3 * m.rows.indices[a]) + c, static_cast<int>(3 * m.rows.indices[b]) + c,
                           m.stiffness[p] * m.weights[a] * m.weights[b]);
}

}  // namespace pointbased
