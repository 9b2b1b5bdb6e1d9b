// SPDX-License-Identifier: Apache-2.0
#include "thesis_body.h"

#include <string>

namespace baselines {
namespace {

constexpr std::size_t kSurfelNeighbours = 16;
constexpr double kInside = 0.5;     // part of a cell from which on its middle counts as inside
constexpr double kTouching = 1e-5;  // of half a cell: what only touches a region is not in it

reference::Vec3 vector(const Vec3 &v) { return {v[0], v[1], v[2]}; }

std::vector<Vec3> middles(const Lattice &lattice) {
  std::vector<Vec3> out;
  for (const Lattice::Cell &cell : lattice.cells())
    if (cell.filled >= kInside) out.push_back(lattice.centre(cell));
  return out;
}

std::vector<reference::Vec3> vectors(const std::vector<Vec3> &points) {
  std::vector<reference::Vec3> out;
  for (const Vec3 &x : points) out.push_back(vector(x));
  return out;
}

}  // namespace

ThesisBody::ThesisBody(Lattice lattice, Surface skin, std::vector<Elasticity> materials, std::size_t neighbours,
                       const reference::Errata &errata)
    : PointBody(lattice, std::move(skin), middles(lattice)) {
  if (points().size() <= neighbours)
    throw sdk::Error(C3DE_E_ARG, "the body has " + std::to_string(points().size()) + " phyxels, each of which needs " +
                                     std::to_string(neighbours) + " others; accepted: a smaller sampling.spacing");
  body_.errata = errata;
  neighborhoods_ = reference::nearestNeighbors(vectors(points()), neighbours, errata);
  for (const Lattice::Cell &cell : lattice.cells())
    volume_m3_ += cell.filled * lattice.spacing() * lattice.spacing() * lattice.spacing();
  setMaterials(std::move(materials));
  bindSkin();
}

void ThesisBody::setMaterials(std::vector<Elasticity> materials) {
  const Elasticity m = materials.front();
  for (const Elasticity &other : materials)
    if (other.youngsModulus_Pa != m.youngsModulus_Pa || other.poissonRatio != m.poissonRatio ||
        other.density_kg_m3 != m.density_kg_m3)
      throw sdk::Error(C3DE_E_UNSUPPORTED, "the thesis's method has one material per body; accepted: no parts");
  keepMaterials(std::move(materials));
  reference::Material material;
  material.youngsModulus = m.youngsModulus_Pa;
  material.poissonRatio = m.poissonRatio;
  material.density = m.density_kg_m3;
  const std::vector<double> equal(points().size(), 1.0);
  body_ = reference::buildBody(vectors(points()), neighborhoods_, material, equal, volume_m3_, body_.errata);
  setMasses(body_.mass, body_.volume);

  // The blocks of the stiffness of an evaluation, v C d_j d_k, row by row; four times as printed.
  const double nu = m.poissonRatio, modulus = m.youngsModulus_Pa * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)),
               factor = body_.errata.factorFour ? 4.0 : 1.0;
  const reference::Neighborhoods &n = neighborhoods_;
  std::vector<double> bounds(points().size(), 0.0);
  for (std::size_t i = 0; i < points().size(); ++i) {
    double sum = body_.dSelf[i].norm();
    for (std::size_t k = n.first[i]; k < n.first[i + 1]; ++k) sum += body_.d[k].norm();
    const double share = factor * body_.volume[i] * modulus * sum;
    bounds[i] += share * body_.dSelf[i].norm();
    for (std::size_t k = n.first[i]; k < n.first[i + 1]; ++k) bounds[n.neighbors[k]] += share * body_.d[k].norm();
  }
  double fastest = 0.0;
  for (std::size_t i = 0; i < bounds.size(); ++i) fastest = std::max(fastest, bounds[i] / masses()[i]);
  setStiffness(std::move(bounds), fastest, 0.0);
}

Bound ThesisBody::bind(const Vec3 &point, double *off) const {
  (void)PointBody::bind(point, off);
  std::vector<std::pair<double, std::uint32_t>> byDistance;
  for (std::uint32_t i = 0; i < points().size(); ++i) byDistance.emplace_back(length(point - points()[i]), i);
  const std::size_t count = std::min(kSurfelNeighbours, byDistance.size());
  std::partial_sort(byDistance.begin(), byDistance.begin() + static_cast<std::ptrdiff_t>(count), byDistance.end());
  byDistance.resize(count);

  // u = sum_i w_i (u_i + (J_i - I) (X - X_i)) / sum_i w_i, and J_i - I = sum_k (u_k - u_i) d_k^T: linear in all u.
  std::map<std::uint32_t, double> weights;
  const double h = byDistance.back().first;
  double sum = 0.0;
  for (const auto &[r, i] : byDistance) sum += std::exp(-r * r / (h * h));
  for (const auto &[r, i] : byDistance) {
    const double w = std::exp(-r * r / (h * h)) / sum;
    const reference::Vec3 way = vector(point - points()[i]);
    weights[i] += w * (1.0 + body_.dSelf[i].dot(way));
    for (std::size_t k = neighborhoods_.first[i]; k < neighborhoods_.first[i + 1]; ++k)
      weights[static_cast<std::uint32_t>(neighborhoods_.neighbors[k])] += w * body_.d[k].dot(way);
  }
  Bound bound;
  for (const auto &[node, weight] : weights) {
    bound.nodes.push_back(node);
    bound.weights.push_back(weight);
  }
  return bound;
}

bool ThesisBody::isHeldBy(const c3de_sim_region &region, std::uint32_t point) const {
  // The place of the cell that is nearest to what the region is about.
  const Vec3 &middle = points()[point];
  const double half = 0.5 * (1.0 - kTouching) * lattice().spacing();
  const Vec3 a = vectorOf(region.a), b = vectorOf(region.b);
  Vec3 nearest = middle;
  for (std::size_t c = 0; c < 3; ++c) {
    double to = middle[c];
    if (region.kind == C3DE_SIM_REGION_BOX) to = std::clamp(middle[c], a[c], b[c]);
    if (region.kind == C3DE_SIM_REGION_SPHERE) to = a[c];
    if (region.kind == C3DE_SIM_REGION_HALF_SPACE) to = middle[c] - (b[c] > 0.0 ? half : b[c] < 0.0 ? -half : 0.0);
    nearest[c] = std::clamp(to, middle[c] - half, middle[c] + half);
  }
  return contains(region, nearest);
}

void ThesisBody::addInternalForces(double) {
  for (std::size_t i = 0; i < points().size(); ++i) body_.u[i] = vector(state().positions[i] - points()[i]);
  reference::computeForces(body_);
  for (std::uint32_t i = 0; i < points().size(); ++i)
    addForce(i, {body_.force[i][0], body_.force[i][1], body_.force[i][2]});
}

}  // namespace baselines
