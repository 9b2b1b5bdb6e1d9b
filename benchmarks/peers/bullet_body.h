// SPDX-License-Identifier: Apache-2.0
// Bullet's three models of a soft body, with its own defaults.
#pragma once

#include "moving_body.h"
#include "tetra_mesh.h"

namespace peers {

enum class BulletModel {
  massSpring,        ///< links along all edges of the tetrahedra, btSoftRigidDynamicsWorld
  linearElasticity,  ///< corotated linear tetrahedra, btDeformableMultiBodyDynamicsWorld
  neoHookean         ///< tetrahedra of Smith et al.'s energy, in the same world
};

struct BulletSettings {
  BulletModel model = BulletModel::linearElasticity;
  bool implicit = true;  ///< of the deformable world
  bool damped = true;    ///< Bullet's default damping; false: none
  /// The Lamé constants of Bullet's neo-Hookean energy that give Young's modulus and Poisson's ratio at small strain:
  /// 4/3 mu and lambda + 5/6 mu (Smith et al. 2018, section 3.4). False: setYoungsModulus() and setPoissonRatio() as
  /// they are.
  bool matched = true;
};

[[nodiscard]] std::string bulletVersion();
[[nodiscard]] std::string nameOf(const BulletSettings &settings);

/// The mesh must outlive it.
[[nodiscard]] std::unique_ptr<MovingBody> makeBulletBody(const TetraMesh &mesh, const Solid &solid,
                                                         const BulletSettings &settings, double dt);

/// Current displacements of the nodes, m, and a setter (velocities become zero): to begin near equilibrium.
[[nodiscard]] std::vector<Vec3> bulletDisplacements(const MovingBody &body);
void setBulletDisplacements(MovingBody &body, const std::vector<Vec3> &displacements);

}  // namespace peers
