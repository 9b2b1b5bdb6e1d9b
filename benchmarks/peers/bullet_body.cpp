// SPDX-License-Identifier: Apache-2.0
#include "bullet_body.h"

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace peers {

namespace {

btVector3 toBullet(const Vec3 &x) {
  return {static_cast<btScalar>(x[0]), static_cast<btScalar>(x[1]), static_cast<btScalar>(x[2])};
}
Vec3 fromBullet(const btVector3 &x) { return {x.x(), x.y(), x.z()}; }

/// The components that both kinds of worlds need, in the order of their lifetimes.
struct Stage {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
};

class BulletBody : public MovingBody {
 public:
  BulletBody(const TetraMesh &mesh, const Solid &solid, double dt) : mesh_(mesh), density_(solid.density), dt_(dt) {}

  void stop() override {
    for (int i = 0; i < body_->m_nodes.size(); ++i)
      body_->m_nodes[i].m_v = body_->m_nodes[i].m_vn = body_->m_nodes[i].m_splitv = btVector3(0, 0, 0);
  }
  [[nodiscard]] double kineticEnergy() const override {
    double sum = 0.0;
    for (std::size_t i = 0; i < mesh_.freeNodes; ++i) sum += 0.5 * massOf(i) * fromBullet(node(i).m_v).squaredNorm();
    return sum;
  }
  [[nodiscard]] double surplus() const override {
    double fallen = 0.0;
    for (std::size_t i = 0; i < mesh_.freeNodes; ++i) fallen += massOf(i) * kGravity.dot(displacementOf(i));
    return kineticEnergy() - fallen;
  }
  [[nodiscard]] Vec3 displacement() const override {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) sum += mesh_.weights[i] * displacementOf(i);
    return sum;
  }
  [[nodiscard]] double largestDisplacement() const override {
    double most = 0.0;
    for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
      const double u = displacementOf(i).norm();
      if (!(u <= most)) most = u;  // NaN propagates
    }
    return most;
  }
  [[nodiscard]] std::vector<Vec3> displacements() const {
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) out.push_back(displacementOf(i));
    return out;
  }
  void setDisplacements(const std::vector<Vec3> &u) {
    for (std::size_t i = 0; i < mesh_.freeNodes; ++i) {
      btSoftBody::Node &n = body_->m_nodes[static_cast<int>(i)];
      n.m_x = n.m_q = toBullet(mesh_.nodes[i] + u[i]);
    }
    stop();
  }

 protected:
  [[nodiscard]] const btSoftBody::Node &node(std::size_t i) const { return body_->m_nodes[static_cast<int>(i)]; }
  [[nodiscard]] double massOf(std::size_t i) const { return density_ * mesh_.volumes[i]; }
  [[nodiscard]] Vec3 displacementOf(std::size_t i) const { return fromBullet(node(i).m_x) - mesh_.nodes[i]; }

  /// Nodes with their masses; fixed nodes have mass zero, which fixes them in Bullet.
  std::unique_ptr<btSoftBody> makeNodes(btSoftBodyWorldInfo &info) const {
    btAlignedObjectArray<btVector3> positions;
    btAlignedObjectArray<btScalar> masses;
    for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
      positions.push_back(toBullet(mesh_.nodes[i]));
      masses.push_back(i < mesh_.freeNodes ? static_cast<btScalar>(massOf(i)) : btScalar(0));
    }
    auto body = std::make_unique<btSoftBody>(&info, positions.size(), &positions[0], &masses[0]);
    body->setActivationState(DISABLE_DEACTIVATION);
    body->setSelfCollision(false);
    return body;
  }

  const TetraMesh &mesh_;
  double density_, dt_;
  std::unique_ptr<btSoftBody> body_;
};

class MassSpring final : public BulletBody {
 public:
  MassSpring(const TetraMesh &mesh, const Solid &solid, double dt) : BulletBody(mesh, solid, dt) {
    btSoftBodyWorldInfo &info = world_.getWorldInfo();
    info.m_gravity = toBullet(kGravity);
    info.air_density = 0;
    body_ = makeNodes(info);
    std::set<std::pair<int, int>> edges;
    for (const auto &t : mesh.tetrahedra)
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4; ++b) edges.insert(std::minmax(t[a], t[b]));
    for (const auto &[a, b] : edges) body_->appendLink(a, b);
    body_->randomizeConstraints();  // as Bullet's own body factories do; in the order of the nodes the bodies whip
    world_.setGravity(toBullet(kGravity));
    world_.addSoftBody(body_.get());
  }
  ~MassSpring() override { world_.removeSoftBody(body_.get()); }
  double step() override {
    world_.stepSimulation(static_cast<btScalar>(dt_), 0);
    return dt_;
  }

 private:
  Stage stage_;
  btSequentialImpulseConstraintSolver solver_;
  btSoftRigidDynamicsWorld world_{&stage_.dispatcher, &stage_.broadphase, &solver_, &stage_.configuration};
};

class Deformable final : public BulletBody {
 public:
  Deformable(const TetraMesh &mesh, const Solid &solid, const BulletSettings &settings, double dt)
      : BulletBody(mesh, solid, dt) {
    constraints_.setDeformableSolver(&solver_);
    world_ = std::make_unique<btDeformableMultiBodyDynamicsWorld>(&stage_.dispatcher, &stage_.broadphase, &constraints_,
                                                                  &stage_.configuration, &solver_);
    world_->setImplicit(settings.implicit);
    // Without it, implicit steps of 3.24 do not hold the fixed nodes; every example of Bullet with implicit steps sets
    // it.
    world_->setUseProjection(settings.implicit);
    body_ = makeNodes(world_->getWorldInfo());
    for (const auto &t : mesh.tetrahedra) body_->appendTetra(t[0], t[1], t[2], t[3]);
    // Bullet's own file readers call this after the last tetrahedron.
    body_->initializeDmInverse();
    body_->m_tetraScratches.resize(body_->m_tetras.size());
    body_->m_tetraScratchesTn.resize(body_->m_tetras.size());
    world_->addSoftBody(body_.get());
    world_->setGravity(btVector3(0, 0, 0));
    gravity_ = std::make_unique<btDeformableGravityForce>(toBullet(kGravity));
    const double nu = solid.poissonRatio, mu = solid.youngsModulus / (2.0 * (1.0 + nu)),
                 lambda = solid.youngsModulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    if (settings.model == BulletModel::neoHookean) {
      const double m = settings.matched ? 4.0 / 3.0 * mu : mu, l = settings.matched ? lambda + 5.0 / 6.0 * mu : lambda;
      auto force = std::make_unique<btDeformableNeoHookeanForce>(static_cast<btScalar>(m), static_cast<btScalar>(l));
      if (!settings.damped) force->setDamping(0);
      elastic_ = std::move(force);
    } else {
      auto force =
          std::make_unique<btDeformableLinearElasticityForce>(static_cast<btScalar>(mu), static_cast<btScalar>(lambda));
      if (!settings.damped) force->setDamping(0, 0);
      elastic_ = std::move(force);
    }
    world_->addForce(body_.get(), elastic_.get());
    world_->addForce(body_.get(), gravity_.get());
  }
  ~Deformable() override { world_->removeSoftBody(body_.get()); }
  double step() override {
    world_->stepSimulation(static_cast<btScalar>(dt_), 0);
    return dt_;
  }

 private:
  Stage stage_;
  btDeformableBodySolver solver_;
  btDeformableMultiBodyConstraintSolver constraints_;
  std::unique_ptr<btDeformableMultiBodyDynamicsWorld> world_;
  std::unique_ptr<btDeformableGravityForce> gravity_;
  std::unique_ptr<btDeformableLagrangianForce> elastic_;
};

}  // namespace

std::string bulletVersion() {
  return std::to_string(btGetVersion() / 100) + "." + std::to_string(btGetVersion() % 100);
}

std::string nameOf(const BulletSettings &settings) {
  if (settings.model == BulletModel::massSpring) return "mass-spring";
  std::string name = settings.model == BulletModel::neoHookean ? "FEM neo-Hookean" : "FEM linear";
  name += settings.implicit ? " implicit" : " explicit";
  if (!settings.damped) name += " undamped";
  return name;
}

std::unique_ptr<MovingBody> makeBulletBody(const TetraMesh &mesh, const Solid &solid, const BulletSettings &settings,
                                           double dt) {
  if (settings.model == BulletModel::massSpring) return std::make_unique<MassSpring>(mesh, solid, dt);
  return std::make_unique<Deformable>(mesh, solid, settings, dt);
}

std::vector<Vec3> bulletDisplacements(const MovingBody &body) {
  return dynamic_cast<const BulletBody &>(body).displacements();
}

void setBulletDisplacements(MovingBody &body, const std::vector<Vec3> &displacements) {
  dynamic_cast<BulletBody &>(body).setDisplacements(displacements);
}

}  // namespace peers
