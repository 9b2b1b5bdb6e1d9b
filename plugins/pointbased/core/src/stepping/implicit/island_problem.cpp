// SPDX-License-Identifier: Apache-2.0
#include "stepping/implicit/island_problem.h"

#include <algorithm>

namespace pointbased::detail {

IslandProblem::IslandProblem(std::vector<StageProblem *> parts, StageCoupling &coupling)
    : parts_(std::move(parts)), coupling_(coupling), mask_(coupling.phyxels(), 0), displacements_(coupling.phyxels()) {
  potentials_.assign(parts_.begin(), parts_.end());
  forParts([&](const StageProblem &part, std::size_t first, std::size_t) {
    std::copy(part.prescribed().begin(), part.prescribed().end(), mask_.begin() + static_cast<std::ptrdiff_t>(first));
  });
}

bool IslandProblem::setState(std::span<const Vec3> u) {
  std::copy(u.begin(), u.end(), displacements_.begin());
  bool good = true;
  forParts(
      [&](StageProblem &part, std::size_t first, std::size_t n) { good = part.setState(u.subspan(first, n)) && good; });
  return good;
}

double IslandProblem::energy() {
  double sum = coupling_.energy(displacements_);
  for (StageProblem *part : parts_) sum += part->energy();
  return sum;
}

double IslandProblem::roundOff() const {
  double sum = 0.0;
  for (const StageProblem *part : parts_) sum += part->roundOff();
  return sum;
}

void IslandProblem::gradient(std::span<Vec3> out) {
  forParts([&](StageProblem &part, std::size_t first, std::size_t n) { part.gradient(out.subspan(first, n)); });
  forces_.assign(displacements_.size(), Vec3::Zero());
  coupling_.addForces(displacements_, forces_);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] -= forces_[i];
}

double IslandProblem::reach(std::span<const Vec3> gradient) const {
  double farthest = 0.0;
  forParts([&](const StageProblem &part, std::size_t first, std::size_t n) {
    farthest = std::max(farthest, part.reach(gradient.subspan(first, n)));
  });
  return farthest;
}

void IslandProblem::product(std::span<const Vec3> du, std::span<Vec3> out) {
  forParts([&](StageProblem &part, std::size_t first, std::size_t n) {
    part.product(du.subspan(first, n), out.subspan(first, n));
  });
  coupling_.addProduct(displacements_, du, out);
}

void IslandProblem::diagonalBlocks(std::span<Mat3> out) {
  // parts() may have given them their share of the coupling, which would be counted twice.
  forParts([&](StageProblem &part, std::size_t first, std::size_t n) {
    part.setCoupling({});
    part.diagonalBlocks(out.subspan(first, n));
  });
  coupling_.addBlocks(displacements_, out);
}

std::span<IncrementalPotential *const> IslandProblem::parts() {
  blocks_.assign(displacements_.size(), Mat3::Zero());
  coupling_.addBlocks(displacements_, blocks_);
  forParts([&](StageProblem &part, std::size_t first, std::size_t n) {
    part.setCoupling(std::span<const Mat3>(blocks_).subspan(first, n));
  });
  return potentials_;
}

bool IslandProblem::assemble(Eigen::SparseMatrix<double> &out) {
  triplets_.clear();
  bool good = true;
  forParts([&](StageProblem &part, std::size_t first, std::size_t) {
    if (!good || !(good = part.assemble(part_))) return;
    const auto shift = static_cast<int>(3 * first);
    for (int column = 0; column < part_.outerSize(); ++column)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(part_, column); entry; ++entry)
        triplets_.emplace_back(shift + static_cast<int>(entry.row()), shift + column, entry.value());
  });
  if (!good) return false;
  coupling_.addTriplets(displacements_, triplets_);
  const auto size = static_cast<Eigen::Index>(3 * displacements_.size());
  out.resize(size, size);
  out.setFromTriplets(triplets_.begin(), triplets_.end());
  return true;
}

}  // namespace pointbased::detail
