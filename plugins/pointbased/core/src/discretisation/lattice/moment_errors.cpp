// SPDX-License-Identifier: Apache-2.0
#include "discretisation/lattice/moment_errors.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "base/cancellation_poll.h"
#include "discretisation/lattice/lattice_grid.h"

namespace pointbased::lattice {
namespace {

// Polynomials of first and second degree are dropped if orthogonalisation reduces their squared norm below this
// fraction: the phyxels of the patch do not determine them.
constexpr double kIndependent[] = {1e-8, 1e-3};
constexpr int kIterations = 10;
// An iteration that reduces the errors by less than this is the last one.
constexpr double kLeastGain = 0.05;
// Part of the available decrease of a phyxel that first moments may use in one iteration.
constexpr double kFirstMomentPart = 0.9;
// Extents below this many spacings are not divided.
constexpr double kUndivided = 1.5;

constexpr int kTerms = 10, kLinear = 4;
// Moments of 1; x, y, z; x², y², z²; xy, xz, yz.
using PatchMoments = Eigen::Matrix<double, kTerms, 1>;

PatchMoments termsAt(const Vec3 &y) {
  PatchMoments q;
  q << 1.0, y, y.cwiseAbs2(), y[0] * y[1], y[0] * y[2], y[1] * y[2];
  return q;
}

// Transfers moments of zero total volume from the point y to the origin.
PatchMoments transferred(const Vec3 &y, PatchMoments moments) {
  const Vec3 first = moments.segment<3>(1);
  moments.segment<3>(4) += 2.0 * y.cwiseProduct(first);
  for (int a = 0; a < 3; ++a)
    for (int b = a + 1; b < 3; ++b) moments[6 + a + b] += y[a] * first[b] + y[b] * first[a];
  return moments;
}

Mat3 secondOf(const PatchMoments &m) {
  Mat3 out;
  out << m[4], m[7], m[8], m[7], m[5], m[9], m[8], m[9], m[6];
  return out;
}

// Node of the grid of patches.
using Node = std::array<int, 3>;

// Grid of patches, symmetric about the centre of the bounds. Their hat functions sum to one.
struct PatchGrid {
  Vec3 low, width;
  Node cells{};

  PatchGrid(std::span<const Vec3> positions, double spacing) {
    Vec3 high = low = positions.front();
    for (const Vec3 &x : positions) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    for (int a = 0; a < 3; ++a) {
      const double extent = high[a] - low[a];
      const int n = extent < kUndivided * spacing ? 0 : static_cast<int>(std::lround(extent / spacing));
      cells[static_cast<std::size_t>(a)] = n;
      width[a] = n == 0 ? spacing : extent / n;
      if (n == 0) low[a] += 0.5 * extent;
    }
  }
  // In widths, from the first node.
  [[nodiscard]] Vec3 local(const Vec3 &x) const { return (x - low).cwiseQuotient(width); }
  [[nodiscard]] static Vec3 place(const Node &node) { return {1.0 * node[0], 1.0 * node[1], 1.0 * node[2]}; }
  // Calls visit(node, value of its hat function).
  template <class Visit>
  void at(const Vec3 &x, const Visit &visit) const {
    const Vec3 u = local(x);
    for (int corner = 0; corner < 8; ++corner) {
      Node node;
      double hat = 1.0;
      for (int a = 0; a < 3; ++a) {
        const auto axis = static_cast<std::size_t>(a);
        const int up = corner >> a & 1, first = std::clamp(static_cast<int>(u[a]), 0, std::max(0, cells[axis] - 1));
        const double t = cells[axis] == 0 ? 0.0 : std::clamp(u[a] - first, 0.0, 1.0);
        node[axis] = first + up;
        hat *= up != 0 ? t : 1.0 - t;
      }
      if (hat > 0.0) visit(node, hat);
    }
  }
};

struct Member {
  Index phyxel;
  double hat;
};

struct Patch {
  std::vector<Member> members;
  PatchMoments error = PatchMoments::Zero();  // about its node; m³, with lengths in widths of the grid
};

// Polynomials for the changes of one patch, orthogonal with the available decreases as weights.
struct PatchPolynomials {
  PatchMoments linear = PatchMoments::Zero(), quadratic = PatchMoments::Zero();  // coefficients

  // @param gram  Σ available q qᵀ, with the terms q about the mean  @param error  of the terms, likewise
  PatchPolynomials(const Eigen::Matrix<double, kTerms, kTerms> &gram, const PatchMoments &error) {
    // Gram-Schmidt: each polynomial is orthogonal to those before it and does not change their moments.
    Eigen::Matrix<double, kTerms, kTerms> basis = Eigen::Matrix<double, kTerms, kTerms>::Identity();
    PatchMoments norms = PatchMoments::Zero();
    for (int k = 0; k < kTerms; ++k) {
      for (int e = 0; e < k; ++e)
        if (norms[e] > 0.0) basis.col(k) -= basis.col(e).dot(gram * basis.col(k)) / norms[e] * basis.col(e);
      const double norm = basis.col(k).dot(gram * basis.col(k));
      if (!(norm > kIndependent[k < kLinear ? 0 : 1] * gram(k, k))) continue;
      norms[k] = norm;
      (k < kLinear ? linear : quadratic) -= basis.col(k).dot(error) / norm * basis.col(k);
    }
  }
};

// Largest error of a second moment in any direction, relative to the moment in that direction.
double relativeError(const Mat3 &error, Mat3 moments) {
  moments.diagonal().array() += 1e-12 * moments.trace();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Mat3> eigen(error, moments, Eigen::EigenvaluesOnly | Eigen::Ax_lBx);
  return eigen.eigenvalues().cwiseAbs().maxCoeff();
}

class Correction {
 public:
  Correction(std::span<const Vec3> positions, const PatchGrid &grid, std::vector<double> &volumes,
             std::vector<double> available, const ParallelFor &parallelFor)
      : positions_(positions), grid_(grid), volumes_(volumes), available_(std::move(available)),
        changes_(volumes.size(), 0.0), poll_(parallelFor) {}

  // Whether the moments of a patch are less accurate than MomentErrors::kTolerated.
  [[nodiscard]] bool isInaccurate(const Vec3 &node, const Patch &patch) {
    const Vec3 mean = meanOf(node, patch, volumes_);
    Mat3 second = Mat3::Zero();
    for (const Member &m : patch.members) {
      const Vec3 y = grid_.local(positions_[m.phyxel]) - node - mean;
      second += m.hat * volumes_[m.phyxel] * y * y.transpose();
    }
    return second.trace() > 0.0 &&
           relativeError(secondOf(transferred(-mean, patch.error)), second) > MomentErrors::kTolerated;
  }
  // Adds changes that reduce the error of a patch.
  void correct(const Vec3 &node, Patch &patch) {
    const Vec3 origin = node + meanOf(node, patch, available_);
    const auto placeOf = [&](const Member &m) -> Vec3 { return grid_.local(positions_[m.phyxel]) - origin; };
    Eigen::Matrix<double, kTerms, kTerms> gram = Eigen::Matrix<double, kTerms, kTerms>::Zero();
    for (const Member &m : patch.members) {
      poll_();
      const PatchMoments q = termsAt(placeOf(m));
      gram += m.hat * available_[m.phyxel] * q * q.transpose();
    }
    const PatchPolynomials polynomials(gram, transferred(node - origin, patch.error));
    // First moments have priority. A factor of -1 uses the whole available decrease of a phyxel.
    double ofLinear = 1.0, ofQuadratic = 1.0;
    for (const Member &m : patch.members)
      if (const double factor = polynomials.linear.dot(termsAt(placeOf(m)));
          available_[m.phyxel] > 0.0 && factor < -kFirstMomentPart)
        ofLinear = std::min(ofLinear, -kFirstMomentPart / factor);
    for (const Member &m : patch.members) {
      const PatchMoments q = termsAt(placeOf(m));
      const double rest = 1.0 + ofLinear * polynomials.linear.dot(q), factor = polynomials.quadratic.dot(q);
      if (available_[m.phyxel] > 0.0 && factor < -rest) ofQuadratic = std::min(ofQuadratic, -rest / factor);
    }
    const PatchMoments polynomial = ofLinear * polynomials.linear + ofQuadratic * polynomials.quadratic;
    for (const Member &m : patch.members) {
      const double change = m.hat * available_[m.phyxel] * polynomial.dot(termsAt(placeOf(m)));
      changes_[m.phyxel] += change;
      patch.error += change * termsAt(grid_.local(positions_[m.phyxel]) - node);
    }
  }
  void apply() {
    for (std::size_t i = 0; i < changes_.size(); ++i) {
      volumes_[i] += changes_[i];
      available_[i] = std::max(0.0, available_[i] + std::exchange(changes_[i], 0.0));
    }
  }

 private:
  // Mean position of the members by these weights, from the node.
  [[nodiscard]] Vec3 meanOf(const Vec3 &node, const Patch &patch, const std::vector<double> &weights) {
    double sum = 0.0;
    Vec3 first = Vec3::Zero();
    for (const Member &m : patch.members) {
      poll_();
      sum += m.hat * weights[m.phyxel];
      first += m.hat * weights[m.phyxel] * (grid_.local(positions_[m.phyxel]) - node);
    }
    return sum > 0.0 ? Vec3(first / sum) : Vec3::Zero();
  }

  std::span<const Vec3> positions_;
  const PatchGrid &grid_;
  std::vector<double> &volumes_, available_, changes_;
  detail::CancellationPoll poll_;
};

}  // namespace

MomentErrors::MomentErrors(std::span<const Vec3> positions, std::vector<Index> components)
    : positions_(positions), components_(std::move(components)), record_(positions.size(), kNone) {}

void MomentErrors::add(Index about, Index phyxel, double volume) {
  if (record_[about] == kNone) {
    record_[about] = static_cast<Index>(errors_.size());
    errors_.emplace_back();
  }
  const Vec3 arm = positions_[phyxel] - positions_[about];
  errors_[record_[about]].first += volume * arm;
  errors_[record_[about]].second += volume * arm * arm.transpose();
}

void MomentErrors::correct(std::vector<double> &volumes, std::vector<double> available, double spacing,
                           const ParallelFor &parallelFor) const {
  if (errors_.empty()) return;
  const PatchGrid grid(positions_, spacing);
  std::map<std::pair<Node, Index>, Patch> patches;  // by node and component
  detail::CancellationPoll poll(parallelFor);
  for (std::size_t i = 0; i < record_.size(); ++i) {
    poll();
    if (record_[i] == kNone) continue;
    const Moments &error = errors_[record_[i]];
    const Vec3 first = error.first.cwiseQuotient(grid.width);
    const Mat3 second = error.second.cwiseQuotient(grid.width * grid.width.transpose());
    PatchMoments moments;
    moments << 0.0, first, second.diagonal(), second(0, 1), second(0, 2), second(1, 2);
    const Vec3 at = grid.local(positions_[i]);
    grid.at(positions_[i], [&](const Node &node, double hat) {
      patches[{node, components_[i]}].error += hat * transferred(at - PatchGrid::place(node), moments);
    });
  }
  for (std::size_t i = 0; i < record_.size(); ++i) {
    poll();
    grid.at(positions_[i], [&](const Node &node, double hat) {
      if (const auto found = patches.find({node, components_[i]}); found != patches.end())
        found->second.members.push_back({static_cast<Index>(i), hat});
    });
  }
  Correction correction(positions_, grid, volumes, std::move(available), parallelFor);
  std::map<Index, Patch> components;  // with a patch that was corrected
  double before = 0.0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    double sum = 0.0;
    for (auto &[key, patch] : patches) {
      const Vec3 node = PatchGrid::place(key.first);
      if (!correction.isInaccurate(node, patch)) continue;
      sum += patch.error.lpNorm<1>();
      components[key.second];
      correction.correct(node, patch);
    }
    correction.apply();
    if (sum == 0.0 || (iteration > 0 && sum > (1.0 - kLeastGain) * before)) break;
    before = sum;
  }
  // The remaining error is corrected over each of these components, which also corrects its centre of mass.
  if (components.empty()) return;
  const Vec3 middle = 0.5 * PatchGrid::place(grid.cells);
  for (const auto &[key, patch] : patches)
    if (const auto found = components.find(key.second); found != components.end())
      found->second.error += transferred(PatchGrid::place(key.first) - middle, patch.error);
  for (std::size_t i = 0; i < components_.size(); ++i)
    if (const auto found = components.find(components_[i]); found != components.end())
      found->second.members.push_back({static_cast<Index>(i), 1.0});
  for (auto &[root, component] : components) correction.correct(middle, component);
  correction.apply();
}

}  // namespace pointbased::lattice
