// SPDX-License-Identifier: Apache-2.0
#include "spring_body.h"

#include <map>

namespace mass_spring {
namespace {

// Stiffness of the springs of one cell in units of Young's modulus times spacing: the isotropic lattice whose face and
// body diagonals bear alike. Derived in docs/plugin/mass_spring.md.
constexpr double kEdge = 3.0 / 5.0, kFaceDiagonal = 1.0 / 5.0, kBodyDiagonal = 3.0 / 20.0;
// Squared bound of the frequencies of one cell, times density spacing² / Young's modulus: twice the stiffness at a
// corner over an eighth of its mass. No assembly of cells swings faster than its fastest one.
constexpr double kFastest = 2.0 * (3.0 * kEdge / 4.0 + 3.0 * kFaceDiagonal / 2.0 + kBodyDiagonal) * 8.0;

}  // namespace

SpringBody::SpringBody(Lattice lattice, Surface skin, std::vector<Elasticity> materials)
    : PointBody(std::move(lattice), std::move(skin)) {
  setMaterials(std::move(materials));
  bindSkin();
}

void SpringBody::setMaterials(std::vector<Elasticity> materials) {
  keepMaterials(std::move(materials));
  addMassesOfCells();
  const double h = lattice().spacing();
  struct Sum {
    double stiffness = 0.0, damping = 0.0, length = 0.0;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Sum> sums;
  double fastest = 0.0, slowestDecay_s = 0.0;
  for (std::size_t c = 0; c < lattice().cells().size(); ++c) {
    const Lattice::Cell &cell = lattice().cells()[c];
    const Elasticity &m = this->materials()[c];
    fastest = std::max(fastest, kFastest * m.youngsModulus_Pa / (m.density_kg_m3 * h * h));
    slowestDecay_s = std::max(slowestDecay_s, m.retardationTime_s);
    for (std::size_t a = 0; a < 8; ++a)
      for (std::size_t b = a + 1; b < 8; ++b) {
        const std::size_t differ = a ^ b, axes = (differ & 1) + (differ >> 1 & 1) + (differ >> 2);
        // An edge belongs to four cells, the diagonal of a face to two.
        const double share = axes == 1 ? kEdge / 4.0 : axes == 2 ? kFaceDiagonal / 2.0 : kBodyDiagonal;
        const double k = share * cell.filled * m.youngsModulus_Pa * h;
        Sum &sum = sums[{std::min(cell.nodes[a], cell.nodes[b]), std::max(cell.nodes[a], cell.nodes[b])}];
        sum.stiffness += k;
        sum.damping += k * m.retardationTime_s;
        sum.length = h * std::sqrt(static_cast<double>(axes));
      }
  }
  springs_.clear();
  std::vector<double> bounds(points().size(), 0.0);
  for (const auto &[ends, sum] : sums) {
    springs_.push_back({ends.first, ends.second, sum.length, sum.stiffness, sum.damping});
    for (const std::uint32_t end : {ends.first, ends.second}) bounds[end] += 2.0 * sum.stiffness;
  }
  setStiffness(std::move(bounds), fastest, slowestDecay_s);
}

void SpringBody::addInternalForces(double) {
  for (const Spring &s : springs_) {
    const Vec3 d = state().positions[s.b] - state().positions[s.a];
    const double l = length(d);
    if (!(l > 0.0)) continue;  // no direction, no force
    const Vec3 n = (1.0 / l) * d;
    const double speed = dot(state().velocities[s.b] - state().velocities[s.a], n);
    const Vec3 f = (s.stiffness_N_m * (l - s.length_m) + s.damping_Ns_m * speed) * n;
    addForce(s.a, f);
    addForce(s.b, -1.0 * f);
  }
}

double SpringBody::elasticEnergy_J() const {
  double sum = 0.0;
  for (const Spring &s : springs_) {
    const double longer = length(state().positions[s.b] - state().positions[s.a]) - s.length_m;
    sum += 0.5 * s.stiffness_N_m * longer * longer;
  }
  return sum;
}

std::vector<double> SpringBody::stretches() const {
  std::vector<double> out(points().size(), 0.0), count(points().size(), 0.0);
  for (const Spring &s : springs_) {
    const double stretch = length(state().positions[s.b] - state().positions[s.a]) / s.length_m;
    for (const std::uint32_t end : {s.a, s.b}) {
      out[end] += stretch;
      count[end] += 1.0;
    }
  }
  for (std::size_t i = 0; i < out.size(); ++i) out[i] /= count[i];
  return out;
}

}  // namespace mass_spring
