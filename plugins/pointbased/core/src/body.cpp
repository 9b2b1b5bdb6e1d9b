// SPDX-License-Identifier: Apache-2.0
#include "pointbased/body.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pointbased {

std::shared_ptr<const RestState> buildRestState(const PhyxelCloud &cloud, const NeighborChoice &choice, double shapeVolume,
                                                std::span<const Vec3> surfacePositions, std::span<const Vec3> surfaceNormals,
                                                const ParallelFor &parallelFor) {
  auto rest = std::make_shared<RestState>();
  rest->spacing = cloud.spacing;
  rest->shapeVolume = shapeVolume;
  rest->volumes = cloud.volumes;
  rest->contactRadii = cloud.contactRadii;
  for (const Vec3 &x : cloud.positions) rest->origin += x / static_cast<double>(cloud.positions.size());
  rest->positions.reserve(cloud.positions.size());
  for (const Vec3 &x : cloud.positions) rest->positions.push_back(x - rest->origin);
  Neighborhoods found = findNeighborhoods(rest->positions, choice, cloud.spacing, parallelFor);
  rest->stencils = buildPhyxelStencils(rest->positions, found.neighbors, found.supportRadii, rest->volumes, parallelFor);
  rest->neighbors = std::move(found.neighbors);
  std::vector<Vec3> surface(surfacePositions.begin(), surfacePositions.end());
  for (Vec3 &x : surface) x -= rest->origin;
  rest->surfels = bindSurfels(surface, surfaceNormals, rest->positions, parallelFor);
  return rest;
}

Neighbours countNeighbours(const RestState &rest) {
  Neighbours out;
  const std::size_t n = rest.neighbors.rows();
  if (n == 0) return out;
  out.min = rest.neighbors.indices.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t k = rest.neighbors.offsets[i + 1] - rest.neighbors.offsets[i];
    out.min = std::min(out.min, k);
    out.max = std::max(out.max, k);
  }
  out.mean = static_cast<double>(rest.neighbors.indices.size()) / static_cast<double>(n);
  return out;
}

Body::Body(std::string name, std::shared_ptr<const RestState> rest, const Material &material, double stabilisation,
           const ParallelFor &parallelFor)
    : name_(std::move(name)), rest_(std::move(rest)), material_(material), stabilisation_(stabilisation) {
  const std::size_t n = rest_->phyxelCount();
  const std::size_t points = rest_->stencils.pointCount();
  state_.displacements.assign(n, Vec3::Zero());
  state_.velocities.assign(n, Vec3::Zero());
  masses_.resize(n);
  forces_.assign(n, Vec3::Zero());
  entryForces_.assign(rest_->stencils.phyxels.indices.size(), Vec3::Zero());
  gradients_.assign(points, Mat3::Identity());
  rates_.assign(points, Mat3::Zero());
  stresses_.assign(points, Mat3::Zero());
  tangentRatios_.assign(points, 1.0);
  setMaterial(material, stabilisation, parallelFor);
}

void Body::setMaterial(const Material &material, double stabilisation, const ParallelFor &parallelFor) {
  // All stiffnesses are proportional to E and all masses to the density: only another Poisson's ratio or stabilisation
  // changes the shape of the problem, and a slider may send many values a second.
  const bool sameShape = restFrequency_ > 0.0 && material.poissonRatio == material_.poissonRatio &&
                         stabilisation == stabilisation_;
  const double scale = sameShape ? std::sqrt(material.youngsModulus / material_.youngsModulus * material_.restDensity /
                                             material.restDensity)
                                 : 1.0;
  material_ = material;
  stabilisation_ = stabilisation;
  for (std::size_t i = 0; i < masses_.size(); ++i) masses_[i] = material_.restDensity * rest_->volumes[i];
  restFrequency_ = sameShape ? scale * restFrequency_
                             : largestFrequency(material_, stabilisation_, rest_->stencils, rest_->positions, masses_,
                                                parallelFor);
}

double Body::stableStepFor(double tangentRatio) const {
  if (!(restFrequency_ > 0.0)) return std::numeric_limits<double>::infinity();
  const double frequency = restFrequency_ * std::sqrt(tangentRatio);
  // Viscous forces are taken at the velocity half a step before: the bound of central differences with lagged damping.
  const double relaxation = 2.0 * material_.viscosity / (material_.lambda() + 2.0 * material_.mu());
  const double xi = 0.5 * relaxation * restFrequency_;
  return 2.0 / frequency * (std::sqrt(1.0 + xi * xi) - xi);
}

void Body::computeGradients(const ParallelFor &parallelFor) {
  deformationGradients(rest_->stencils, state_.displacements, gradients_, parallelFor);
}

void Body::computeStresses(const ParallelFor &parallelFor) {
  std::span<const Mat3> rates;
  if (material_.viscosity > 0.0) {
    gradientRates(rest_->stencils, state_.velocities, rates_, parallelFor);
    rates = rates_;
  }
  tangentRatio_ = stresses(material_, rest_->stencils, gradients_, rates, stresses_, tangentRatios_, parallelFor);
}

void Body::computeForces(const ParallelFor &parallelFor) {
  internalForces(material_, stabilisation_, rest_->stencils, rest_->positions, state_.displacements, gradients_, stresses_,
                 entryForces_, forces_, parallelFor);
}

ElasticEnergy Body::elasticEnergy() const {
  return pointbased::elasticEnergy(material_, stabilisation_, rest_->stencils, rest_->positions, state_.displacements,
                                   gradients_);
}

double Body::kineticEnergy() const {
  double energy = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i) energy += 0.5 * masses_[i] * state_.velocities[i].squaredNorm();
  return energy;
}

double Body::totalMass() const {
  double mass = 0.0;
  for (const double m : masses_) mass += m;
  return mass;
}

std::span<const Vec3> Body::worldPositions() {
  worldPositions_.resize(state_.displacements.size());
  for (std::size_t i = 0; i < worldPositions_.size(); ++i)
    worldPositions_[i] = rest_->origin + rest_->positions[i] + state_.displacements[i];
  return worldPositions_;
}

void Body::restoreState() {
  state_ = kept_;
  contact.clearance.clear();  // what was known of distances may be of the failed step
}

void Body::reset() {
  std::fill(state_.displacements.begin(), state_.displacements.end(), Vec3::Zero());
  std::fill(state_.velocities.begin(), state_.velocities.end(), Vec3::Zero());
  std::fill(forces_.begin(), forces_.end(), Vec3::Zero());
  std::fill(gradients_.begin(), gradients_.end(), Mat3::Identity());
  tangentRatio_ = 1.0;
  contact = ContactMemory();
}

}  // namespace pointbased
