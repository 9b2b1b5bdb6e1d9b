// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "pointbased/contact.h"
#include "pointbased/engine.h"
#include "pointbased/material.h"
#include "pointbased/neighborhood.h"
#include "pointbased/sampling.h"
#include "pointbased/surfels.h"

namespace pointbased {

/// What follows from the reference shape; const once it is built. Positions are relative to `origin`, so that a body far
/// from the world's origin loses no digits.
struct RestState {
  Vec3 origin = Vec3::Zero();        ///< world, m
  double spacing = 0.0;              ///< m
  double shapeVolume = 0.0;          ///< m³, of the shape that was filled
  std::vector<Vec3> positions;       ///< [phyxels] X, m
  std::vector<double> volumes;       ///< [phyxels] m³
  std::vector<double> contactRadii;  ///< [phyxels] m
  Csr neighbors;                     ///< [phyxels] symmetric
  StencilSet stencils;               ///< evaluation points
  SurfelBinding surfels;

  [[nodiscard]] std::size_t phyxelCount() const { return positions.size(); }
};

/// @param surfacePositions, surfaceNormals  world, m; the surfels
[[nodiscard]] std::shared_ptr<const RestState> buildRestState(const PhyxelCloud &cloud, const NeighborChoice &choice,
                                                              double shapeVolume, std::span<const Vec3> surfacePositions,
                                                              std::span<const Vec3> surfaceNormals,
                                                              const ParallelFor &parallelFor);

/// What moves.
struct State {
  std::vector<Vec3> displacements;  ///< [phyxels] u, m
  std::vector<Vec3> velocities;     ///< [phyxels] m/s
};

struct Neighbours {
  std::size_t min = 0, max = 0;
  double mean = 0.0;
};
[[nodiscard]] Neighbours countNeighbours(const RestState &rest);

/// A deformable body: rest state, material, state, and the scratch of its step.
class Body {
 public:
  Body(std::string name, std::shared_ptr<const RestState> rest, const Material &material, double stabilisation,
       const ParallelFor &parallelFor);

  [[nodiscard]] const std::string &name() const { return name_; }
  [[nodiscard]] const RestState &rest() const { return *rest_; }
  [[nodiscard]] const std::shared_ptr<const RestState> &sharedRest() const { return rest_; }
  [[nodiscard]] const Material &material() const { return material_; }
  [[nodiscard]] double stabilisation() const { return stabilisation_; }
  [[nodiscard]] const State &state() const { return state_; }
  [[nodiscard]] State &state() { return state_; }
  [[nodiscard]] std::span<const double> masses() const { return masses_; }
  /// F of the last force evaluation; the identity before the first.
  [[nodiscard]] std::span<const Mat3> gradients() const { return gradients_; }
  [[nodiscard]] std::span<const Vec3> forces() const { return forces_; }
  [[nodiscard]] std::span<Vec3> forces() { return forces_; }

  /// Takes effect with the next force evaluation; the stable step is found anew.
  void setMaterial(const Material &material, double stabilisation, const ParallelFor &parallelFor);

  /// Largest explicit step at rest without margin, s; infinite for a body without internal forces.
  [[nodiscard]] double stableStepAtRest() const { return stableStepFor(1.0); }
  /// The same at the present deformation, from the tangent moduli of the last force evaluation.
  [[nodiscard]] double stableStep() const { return stableStepFor(tangentRatio_); }

  void computeGradients(const ParallelFor &parallelFor);
  void computeStresses(const ParallelFor &parallelFor);
  void computeForces(const ParallelFor &parallelFor);

  [[nodiscard]] ElasticEnergy elasticEnergy() const;
  [[nodiscard]] double kineticEnergy() const;
  [[nodiscard]] double totalMass() const;

  /// x of every phyxel in the world, m; valid until the next call.
  [[nodiscard]] std::span<const Vec3> worldPositions();

  /// The state before a step, kept in case the step fails.
  void keepState() { kept_ = state_; }
  void restoreState();

  /// To the initial state, bit for bit.
  void reset();

  ContactMemory contact;

 private:
  [[nodiscard]] double stableStepFor(double tangentRatio) const;

  std::string name_;
  std::shared_ptr<const RestState> rest_;
  Material material_;
  double stabilisation_;
  State state_, kept_;
  std::vector<double> masses_;
  std::vector<Vec3> forces_, entryForces_, worldPositions_;
  std::vector<Mat3> gradients_, rates_, stresses_;
  std::vector<double> tangentRatios_;
  double tangentRatio_ = 1.0;
  double restFrequency_ = 0.0;  // rad/s
};

}  // namespace pointbased
