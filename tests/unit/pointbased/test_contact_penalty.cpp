// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "contact_cases.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;
using namespace shapes;

namespace {

// A body pressed into a moving plane, with normal forces and stored tangential displacements: every branch of the
// energy is exercised.
struct Pressed {
  std::unique_ptr<Body> body = latticeBox(Vec3(-0.03, 0, -0.03), Vec3(0.03, 0.06, 0.03), 0.02, rubber(2e4));
  ContactPenalty penalty{30.0, {}, 0.02, 0.01};
  std::vector<Vec3> start, now;
  Random random{7};

  Pressed() {
    const std::size_t n = body->rest().phyxelCount();
    penalty.moduli = body->contactModuli();
    start.assign(n, Vec3::Zero());
    now.assign(n, Vec3::Zero());
    for (Vec3 &u : now) u = Vec3(2e-4, -1e-4, 0) + 3e-4 * random.vector();
    ContactState &memory = body->contact;
    for (std::size_t p = 0; p < points().count(); ++p) {
      Contact c;
      c.point = static_cast<Index>(p);
      c.normal = (Vec3::UnitY() + 0.2 * random.vector()).normalized();
      c.gap = 1e-4 * random();
      c.initialPenetration = 5e-5 * (1.0 + random());
      c.surfaceVelocity = 1e-2 * random.vector();
      c.friction = p % 3 == 0 ? 0.0 : 0.3;
      c.normalForce = p % 5 == 0 ? 0.0 : 0.05 * (1.0 + random());
      c.tangentialDisplacement = 1e-5 * random.vector();
      c.tangentialDisplacement -= c.normal.dot(c.tangentialDisplacement) * c.normal;
      memory.active.push_back(c);
    }
  }
  [[nodiscard]] const ContactPoints &points() const { return body->rest().contact; }
  [[nodiscard]] double energy() const { return contactEnergy(points(), body->contact, penalty, start, now); }
  [[nodiscard]] std::vector<Vec3> forces() const {
    std::vector<Vec3> f(now.size(), Vec3::Zero());
    addContactForces(points(), body->contact, penalty, start, now, f);
    return f;
  }
};

}  // namespace

TEST_CASE("contact forces are minus the gradient of the contact energy") {
  Pressed scene;
  const std::vector<Vec3> forces = scene.forces();
  double largest = 0.0, worst = 0.0;
  for (const Vec3 &f : forces) largest = std::max(largest, f.norm());
  REQUIRE(largest > 0.0);
  const double step = 1e-9;
  for (std::size_t i = 0; i < forces.size(); i += 3)
    for (int c = 0; c < 3; ++c) {
      double &u = scene.now[i][c];
      const double at = u;
      u = at + step;
      const double plus = scene.energy();
      u = at - step;
      const double minus = scene.energy();
      u = at;
      worst = std::max(worst, std::abs((plus - minus) / (2 * step) + forces[i][c]));
    }
  // Central differences of a function with kinks in its second derivative: step k_p of error at most.
  CHECK(worst < 1e-4 * largest);
}

TEST_CASE("the contact Hessian is the derivative of the forces, symmetric and never negative") {
  Pressed scene;
  const std::size_t n = scene.now.size();
  const double step = 1e-10;
  for (int direction = 0; direction < 5; ++direction) {
    std::vector<Vec3> du(n), product(n, Vec3::Zero());
    for (Vec3 &d : du) d = scene.random.vector();
    addContactProduct(scene.points(), scene.body->contact, scene.penalty, scene.start, scene.now, du, product);
    const std::vector<Vec3> base = scene.now;
    for (std::size_t i = 0; i < n; ++i) scene.now[i] = base[i] + step * du[i];
    const std::vector<Vec3> plus = scene.forces();
    for (std::size_t i = 0; i < n; ++i) scene.now[i] = base[i] - step * du[i];
    const std::vector<Vec3> minus = scene.forces();
    scene.now = base;
    double error = 0.0, size = 0.0, work = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      error = std::max(error, ((plus[i] - minus[i]) / (2 * step) + product[i]).norm());
      size = std::max(size, product[i].norm());
      work += product[i].dot(du[i]);
    }
    CHECK(error < 1e-4 * size);
    CHECK(work >= 0.0);
  }
}

TEST_CASE("products, diagonal blocks and triplets are of the same contact Hessian") {
  Pressed scene;
  const std::size_t n = scene.now.size();
  std::vector<Eigen::Triplet<double>> triplets;
  addContactTriplets(scene.points(), scene.body->contact, scene.penalty, scene.start, scene.now, triplets);
  Eigen::SparseMatrix<double> matrix(static_cast<Eigen::Index>(3 * n), static_cast<Eigen::Index>(3 * n));
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  std::vector<Vec3> du(n), product(n, Vec3::Zero());
  for (Vec3 &d : du) d = scene.random.vector();
  addContactProduct(scene.points(), scene.body->contact, scene.penalty, scene.start, scene.now, du, product);
  const Eigen::Map<const Eigen::VectorXd> flat(du.front().data(), static_cast<Eigen::Index>(3 * n));
  const Eigen::VectorXd whole = matrix * flat;
  const double size = whole.norm();
  REQUIRE(size > 0.0);
  std::vector<Mat3> blocks(n, Mat3::Zero());
  addContactBlocks(scene.points(), scene.body->contact, scene.penalty, scene.start, scene.now, blocks);
  for (std::size_t i = 0; i < n; ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    CHECK((whole.segment<3>(at) - product[i]).norm() < 1e-12 * size);
    CHECK((Mat3(matrix.block(at, at, 3, 3)) - blocks[i]).norm() < 1e-12 * size);
  }
  CHECK(Eigen::MatrixXd(matrix).isApprox(Eigen::MatrixXd(matrix).transpose(), 1e-12));
}

TEST_CASE("friction of a stage that is over holds no more than Coulomb allows") {
  Pressed scene;
  updateNormalForces(scene.points(), scene.penalty, scene.start, scene.now, scene.body->contact);
  endContactStage(scene.points(), scene.penalty, scene.start, scene.now, scene.body->contact);
  std::size_t holding = 0;
  for (const Contact &c : scene.body->contact.active) {
    const double k =
        scene.penalty.stiffness * scene.penalty.moduli[c.point] * scene.points().areas[c.point] / scene.penalty.spacing;
    CHECK(k * c.tangentialDisplacement.norm() <= c.friction * c.normalForce * (1.0 + 1e-12));
    if (c.tangentialDisplacement.norm() > 0.0) ++holding;
  }
  CHECK(holding > 0);
}
