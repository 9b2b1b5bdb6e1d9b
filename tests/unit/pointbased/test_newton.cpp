// SPDX-License-Identifier: Apache-2.0
#include "pointbased/newton.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "shapes.h"
#include "solvers/conjugate_gradients.h"
#include "support/catch.h"

using namespace pointbased;
using Catch::Matchers::WithinRel;

namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

void addBlock(Triplets &out, std::size_t i, std::size_t j, const Mat3 &m) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out.emplace_back(static_cast<int>(3 * i) + r, static_cast<int>(3 * j) + c, m(r, c));
}

Mat3 outer(const Vec3 &v) { return v * v.transpose(); }

// Common base of the problems below: an assembled Hessian, and counters.
class Assembled : public IncrementalPotential {
 public:
  [[nodiscard]] std::size_t phyxels() const override { return u_.size(); }
  [[nodiscard]] std::span<const std::uint8_t> prescribed() const override { return held; }
  [[nodiscard]] bool setState(std::span<const Vec3> u) override {
    ++moves;
    u_.assign(u.begin(), u.end());
    current_ = false;
    return allowed(u_);
  }
  void product(std::span<const Vec3> du, std::span<Vec3> out) override {
    if (!current_) exact_ = hessian(false);
    current_ = true;
    const Eigen::Map<const Eigen::VectorXd> x(du.front().data(), exact_.cols());
    Eigen::Map<Eigen::VectorXd>(out.front().data(), exact_.rows()) = exact_ * x;
  }
  void diagonalBlocks(std::span<Mat3> out) override {
    const Matrix h = hessian(true);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(3 * i);
      out[i] = Mat3(h.block(at, at, 3, 3));
    }
  }
  [[nodiscard]] bool assemble(Matrix &out) override {
    ++assemblies;
    if (!canAssemble) return false;
    out = hessian(true);
    return true;
  }

  std::vector<std::uint8_t> held;
  int moves = 0, assemblies = 0;
  bool canAssemble = true;

 protected:
  explicit Assembled(std::size_t n) : u_(n, Vec3::Zero()) {}
  [[nodiscard]] virtual bool allowed(const std::vector<Vec3> &) const { return true; }
  [[nodiscard]] virtual Matrix hessian(bool positive) const = 0;
  [[nodiscard]] Matrix from(const Triplets &t) const {
    Matrix m(3 * static_cast<Eigen::Index>(u_.size()), 3 * static_cast<Eigen::Index>(u_.size()));
    m.setFromTriplets(t.begin(), t.end());
    return m;
  }
  std::vector<Vec3> u_;

 private:
  Matrix exact_;  // of the current state, if `current_`
  bool current_ = false;
};

// 1/2 u·A u - b·u on a grid: springs along the edges, stiffer along than across, and a weak ground.
class GridProblem : public Assembled {
 public:
  explicit GridProblem(int n, double stiffness = 100.0) : Assembled(static_cast<std::size_t>(n * n * n)) {
    Triplets t;
    const auto id = [n](int x, int y, int z) { return static_cast<std::size_t>((z * n + y) * n + x); };
    const auto couple = [&](std::size_t i, std::size_t j, const Vec3 &along) {
      const Mat3 k = stiffness * (outer(along) + 0.3 * Mat3::Identity());
      addBlock(t, i, i, k);
      addBlock(t, j, j, k);
      addBlock(t, i, j, -k);
      addBlock(t, j, i, -k);
    };
    for (int z = 0; z < n; ++z)
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
          if (x + 1 < n) couple(id(x, y, z), id(x + 1, y, z), Vec3::UnitX());
          if (y + 1 < n) couple(id(x, y, z), id(x, y + 1, z), Vec3(0, 0.8, 0.6));
          if (z + 1 < n) couple(id(x, y, z), id(x, y, z + 1), Vec3::UnitZ());
          addBlock(t, id(x, y, z), id(x, y, z), 0.1 * Mat3::Identity());
        }
    matrix = from(t);
    shapes::Random random(3);
    load.resize(matrix.rows());
    for (Eigen::Index i = 0; i < load.size(); ++i) load[i] = random();
  }
  [[nodiscard]] double energy() override { return flat().dot(0.5 * (matrix * flat()) - load); }
  void gradient(std::span<Vec3> out) override {
    Eigen::Map<Eigen::VectorXd>(out.front().data(), load.size()) = matrix * flat() - load;
  }
  Matrix matrix;
  Eigen::VectorXd load;

 protected:
  [[nodiscard]] Matrix hessian(bool) const override { return matrix; }
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> flat() const { return {u_.front().data(), load.size()}; }
};

// A column of springs along x whose ends are pushed together, with bending stiffness and a guide that is softer in y
// than in z: the straight state is a saddle, the column buckles in y.
class Column : public Assembled {
 public:
  explicit Column(std::size_t n) : Assembled(n) {
    held.assign(n, 0);
    held[0] = held[1] = held[n - 2] = held[n - 1] = 1;
  }
  static constexpr double kSpring = 1000.0, kBending = 2.0, kLength = 0.1;
  static constexpr double kGuide[3] = {0.0, 0.01, 2.0};

  [[nodiscard]] Vec3 at(std::size_t i) const { return Vec3(kLength * static_cast<double>(i), 0, 0) + u_[i]; }
  [[nodiscard]] Vec3 bend(std::size_t i) const { return at(i - 1) - 2.0 * at(i) + at(i + 1); }

  // Straight, `shortening` along, and out of line by `disturbance`.
  [[nodiscard]] std::vector<Vec3> start(double shortening, double disturbance) const {
    const std::size_t n = u_.size();
    std::vector<Vec3> u(n);
    shapes::Random random(5);
    for (std::size_t i = 0; i < n; ++i) {
      u[i] = Vec3(-shortening * kLength * static_cast<double>(i), 0, 0);
      if (held[i] == 0) u[i] += disturbance * random.vector();
    }
    return u;
  }

  [[nodiscard]] double energy() override {
    double e = 0.0;
    const Vec3 guide(kGuide[0], kGuide[1], kGuide[2]);
    for (std::size_t i = 0; i + 1 < u_.size(); ++i) {
      const double d = (at(i + 1) - at(i)).norm() - kLength;
      e += 0.5 * kSpring * d * d;
      if (i > 0) e += 0.5 * kBending * bend(i).squaredNorm();
      e += 0.5 * guide.dot(u_[i].cwiseAbs2());
    }
    return e;
  }
  void gradient(std::span<Vec3> out) override {
    const Vec3 guide(kGuide[0], kGuide[1], kGuide[2]);
    for (Vec3 &g : out) g.setZero();
    for (std::size_t i = 0; i + 1 < u_.size(); ++i) {
      const Vec3 e = at(i + 1) - at(i);
      const Vec3 f = kSpring * (e.norm() - kLength) * e.normalized();
      out[i + 1] += f;
      out[i] -= f;
      if (i > 0) {
        const Vec3 b = kBending * bend(i);
        out[i - 1] += b;
        out[i] -= 2.0 * b;
        out[i + 1] += b;
      }
      out[i] += guide.cwiseProduct(u_[i]);
    }
  }

 protected:
  [[nodiscard]] Matrix hessian(bool positive) const override {
    Triplets t;
    const Mat3 guide = Vec3(kGuide[0], kGuide[1], kGuide[2]).asDiagonal();
    for (std::size_t i = 0; i + 1 < u_.size(); ++i) {
      const Vec3 e = at(i + 1) - at(i);
      const Mat3 along = outer(e.normalized());
      const double across = 1.0 - kLength / e.norm();
      const Mat3 k = kSpring * (along + (positive ? std::max(0.0, across) : across) * (Mat3::Identity() - along));
      addBlock(t, i, i, k);
      addBlock(t, i + 1, i + 1, k);
      addBlock(t, i, i + 1, -k);
      addBlock(t, i + 1, i, -k);
      if (i > 0) {
        const double c[3] = {1.0, -2.0, 1.0};
        for (std::size_t a = 0; a < 3; ++a)
          for (std::size_t b = 0; b < 3; ++b)
            addBlock(t, i + a - 1, i + b - 1, kBending * c[a] * c[b] * Mat3::Identity());
      }
      addBlock(t, i, i, guide);
    }
    addBlock(t, u_.size() - 1, u_.size() - 1, Mat3::Identity());
    return from(t);
  }
};

// Σ 1/2 |u - a|² - log(1 - |u|²) per phyxel with a far outside of the unit ball; undefined outside it.
class Walled : public Assembled {
 public:
  explicit Walled(std::size_t n) : Assembled(n) {}
  Vec3 target = Vec3(30, 40, 0);
  bool silent = false;  // returns an energy that is not finite instead of an error
  double largest = 1.0;

  [[nodiscard]] double energy() override {
    double e = 0.0;
    for (const Vec3 &u : u_) e += 0.5 * (u - target).squaredNorm() - std::log(1.0 - u.squaredNorm());
    return e;
  }
  void gradient(std::span<Vec3> out) override {
    for (std::size_t i = 0; i < u_.size(); ++i) out[i] = u_[i] - target + 2.0 / (1.0 - u_[i].squaredNorm()) * u_[i];
  }
  [[nodiscard]] double largestStep(std::span<const Vec3> direction) override {
    asked = std::max(asked, direction[0].norm());
    return largest;
  }
  double asked = 0.0;

 protected:
  [[nodiscard]] bool allowed(const std::vector<Vec3> &u) const override {
    return silent || std::all_of(u.begin(), u.end(), [](const Vec3 &v) { return v.squaredNorm() < 1.0; });
  }
  [[nodiscard]] Matrix hessian(bool) const override {
    Triplets t;
    for (std::size_t i = 0; i < u_.size(); ++i) {
      const double g = 1.0 - u_[i].squaredNorm();
      addBlock(t, i, i, (1.0 + 2.0 / g) * Mat3::Identity() + 4.0 / (g * g) * outer(u_[i]));
    }
    return from(t);
  }
};

double difference(const std::vector<Vec3> &a, const std::vector<Vec3> &b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

NewtonSettings with(Preconditioner preconditioner, double tolerance = 1e-9) {
  return NewtonSettings{.toleranceDisplacement = tolerance, .preconditioner = preconditioner};
}

constexpr Preconditioner kAll[] = {Preconditioner::automatic, Preconditioner::blockJacobi, Preconditioner::incomplete,
                                   Preconditioner::factorised};

}  // namespace

TEST_CASE("the minimum of a quadratic is the direct solution, with every preconditioner") {
  for (const Preconditioner p : kAll) {
    GridProblem problem(6);
    const Eigen::SimplicialLDLT<Matrix> direct(problem.matrix);
    const Eigen::VectorXd truth = direct.solve(problem.load);
    std::vector<Vec3> u(problem.phyxels(), Vec3::Zero());
    NewtonSolver solver;
    const NewtonResult result = solver.solve(problem, u, with(p));
    CAPTURE(static_cast<int>(p), result.iterations, result.linearIterations);
    CHECK(result.outcome == NewtonOutcome::converged);
    CHECK(result.iterations <= 6);  // each solves to 1e-2 or better, tightening
    double error = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i)
      error = std::max(error, (u[i] - truth.segment<3>(static_cast<Eigen::Index>(3 * i))).norm());
    CHECK(error < 1e-9);  // the tolerance; the solution is of order 1
    CHECK(result.lastStep <= 1e-9);
  }
}

TEST_CASE("a complete factorisation of a quadratic solves it in one or two linear iterations a step") {
  GridProblem problem(6);
  std::vector<Vec3> u(problem.phyxels(), Vec3::Zero());
  NewtonSolver solver;
  const NewtonResult result = solver.solve(problem, u, with(Preconditioner::factorised));
  CHECK(result.good());
  CHECK(result.iterations <= 3);  // the factor has seven digits: 1, 1e-6, 1e-12 of the distance remain
  CHECK(result.linearIterations <= 2 * result.iterations);
  CHECK(result.factorisations == 1);
}

TEST_CASE("prescribed phyxels stay where they are, bit for bit, and the rest follows them") {
  for (const Preconditioner p : kAll) {
    GridProblem problem(4);
    problem.held.assign(problem.phyxels(), 0);
    std::vector<Vec3> u(problem.phyxels(), Vec3::Zero());
    shapes::Random random(11);
    for (std::size_t i = 0; i < u.size(); i += 5) {
      problem.held[i] = 1;
      u[i] = random.vector();
    }
    const std::vector<Vec3> before = u;
    NewtonSolver solver;
    const NewtonResult result = solver.solve(problem, u, with(p));
    CHECK(result.good());
    std::vector<Vec3> g(u.size());
    problem.gradient(g);  // the problem is left at u
    double heldForce = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) {
      if (problem.held[i] != 0) {
        CHECK(std::memcmp(u[i].data(), before[i].data(), sizeof(Vec3)) == 0);
        heldForce = std::max(heldForce, g[i].norm());
      } else {
        CHECK(g[i].norm() < 1e-6);  // 1e-9 m times the stiffness of a phyxel, some 600 N/m
      }
    }
    CHECK(heldForce > 1.0);  // they would have moved
  }
}

TEST_CASE("a pressed column gives way although its Hessian is not positive there, with every preconditioner") {
  const bool withinRadius = GENERATE(false, true);
  Column column(21);
  std::vector<std::vector<Vec3>> found;
  for (const Preconditioner p : kAll) {
    std::vector<Vec3> u = column.start(0.05, 1e-6);
    REQUIRE(column.setState(u));
    const double straight = column.energy();
    NewtonSettings settings = with(p);
    settings.maxIterations = 100;
    settings.trustRegion = withinRadius;
    NewtonSolver solver;
    const NewtonResult result = solver.solve(column, u, settings);
    CAPTURE(static_cast<int>(p), withinRadius, result.iterations, result.linearIterations,
            static_cast<int>(result.outcome));
    CHECK(result.good());
    CHECK(column.energy() < 0.5 * straight);
    double sag = 0.0, aside = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) {
      sag = std::max(sag, std::abs(u[i][1]));
      aside = std::max(aside, std::abs(u[i][2]));
    }
    CHECK(sag > Column::kLength);  // the arc of a chord 5 % shorter has a sag of about 0.2 of its length
    CHECK(aside < 1e-6);
    if (u[10][1] < 0.0)  // both sides are equivalent
      for (Vec3 &v : u) v[1] = -v[1];
    found.push_back(u);
  }
  for (const auto &u : found) CHECK(difference(u, found.front()) < 1e-7);
}

TEST_CASE("conjugate gradients go as far as a radius allows, downhill and where the curvature is negative") {
  const GridProblem grid(6);
  const auto n = static_cast<std::size_t>(grid.load.size() / 3);
  double shift = 0.0;  // of all curvatures; those of the weak ground become negative
  const detail::Apply product = [&](std::span<const Vec3> in, std::span<Vec3> out) {
    const Eigen::Map<const Eigen::VectorXd> x(in.front().data(), grid.load.size());
    Eigen::Map<Eigen::VectorXd>(out.front().data(), grid.load.size()) = grid.matrix * x - shift * x;
  };
  const Eigen::VectorXd blocks = grid.matrix.diagonal();
  const detail::Apply precondition = [&](std::span<const Vec3> in, std::span<Vec3> out) {
    const Eigen::Map<const Eigen::VectorXd> x(in.front().data(), grid.load.size());
    Eigen::Map<Eigen::VectorXd>(out.front().data(), grid.load.size()) = x.cwiseQuotient(blocks);
  };
  std::vector<Vec3> b(n);
  for (std::size_t i = 0; i < n; ++i) b[i] = grid.load.segment<3>(static_cast<Eigen::Index>(3 * i));
  const auto lengthOf = [&](std::span<const Vec3> v) {
    const Eigen::Map<const Eigen::VectorXd> x(v.front().data(), grid.load.size());
    return std::sqrt(x.dot(blocks.cwiseProduct(x)));
  };
  const auto gainOf = [&](std::span<const Vec3> v) {
    std::vector<Vec3> image(n);
    product(v, image);
    return detail::dot(b, v) - 0.5 * detail::dot(v, image);
  };
  const double endless = std::numeric_limits<double>::infinity();
  detail::ConjugateGradients cg;
  cg.begin(b, precondition);
  REQUIRE(cg.run(product, precondition, 1e-10, 1000, endless) == detail::LinearEnd::tolerance);
  CHECK_THAT(cg.length(), WithinRel(lengthOf(cg.x()), 1e-8));
  CHECK_THAT(cg.gain(), WithinRel(gainOf(cg.x()), 1e-8));
  const double whole = cg.length(), most = cg.gain();

  double before = 0.0;
  for (const double part : {0.02, 0.1, 0.5, 0.9}) {
    std::vector<Vec3> onPath;
    cg.pointOnPath(part * whole, onPath);
    // Between recorded iterates the path is straight, so a little shorter.
    CHECK(lengthOf(onPath) < part * whole * (1.0 + 1e-9));
    CHECK(lengthOf(onPath) > 0.7 * part * whole);
    detail::ConjugateGradients bounded;
    bounded.begin(b, precondition);
    REQUIRE(bounded.run(product, precondition, 1e-10, 1000, part * whole) == detail::LinearEnd::radius);
    CHECK_THAT(lengthOf(bounded.x()), WithinRel(part * whole, 1e-8));
    CHECK_THAT(bounded.gain(), WithinRel(gainOf(bounded.x()), 1e-8));
    CHECK(bounded.gain() > before);
    CHECK(bounded.gain() < most);
    before = bounded.gain();
  }

  shift = 1.0;
  detail::ConjugateGradients indefinite;
  indefinite.begin(b, precondition);
  REQUIRE(indefinite.run(product, precondition, 1e-10, 1000, endless) == detail::LinearEnd::negativeCurvature);
  indefinite.begin(b, precondition);
  REQUIRE(indefinite.run(product, precondition, 1e-10, 1000, 10.0 * whole) == detail::LinearEnd::radius);
  CHECK_THAT(lengthOf(indefinite.x()), WithinRel(10.0 * whole, 1e-8));
  CHECK_THAT(indefinite.gain(), WithinRel(gainOf(indefinite.x()), 1e-8));
}

TEST_CASE("small steps at a saddle are not taken for convergence") {
  for (const Preconditioner p : kAll) {
    Column column(21);
    std::vector<Vec3> u = column.start(0.05, 1e-17);
    NewtonSettings settings = with(p, 1e-5);  // the first steps are far smaller than this
    settings.linearTolerance = 1e-3;
    settings.maxIterations = 100;
    NewtonSolver solver;
    CHECK(solver.solve(column, u, settings).good());
    double sag = 0.0;
    for (const Vec3 &v : u) sag = std::max(sag, std::abs(v[1]));
    CHECK(sag > Column::kLength);
  }
}

TEST_CASE("steps into a zone that cannot be evaluated are halved until they stay out") {
  // |u| + 2|u| / (1 - |u|²) = 50 along the target's direction, by bisection
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 200; ++i) {
    const double r = 0.5 * (low + high);
    (r + 2.0 * r / (1.0 - r * r) < 50.0 ? low : high) = r;
  }
  for (const bool silent : {false, true})
    for (const Preconditioner p : kAll) {
      Walled problem(5);
      problem.silent = silent;
      std::vector<Vec3> u(5, Vec3(0.1, 0, 0));
      NewtonSolver solver;
      const NewtonResult result = solver.solve(problem, u, with(p));
      CHECK(result.good());
      for (const Vec3 &v : u) CHECK((v - low * Vec3(0.6, 0.8, 0)).norm() < 1e-9);
    }
}

TEST_CASE("a start that cannot be evaluated is reported as such") {
  Walled problem(4);
  NewtonSolver solver;
  std::vector<Vec3> outside(4, Vec3(2, 0, 0));
  CHECK(solver.solve(problem, outside, {}).outcome == NewtonOutcome::notFinite);
  problem.silent = true;
  CHECK(solver.solve(problem, outside, {}).outcome == NewtonOutcome::notFinite);
  std::vector<Vec3> broken(4, Vec3::Zero());
  broken[2][1] = std::numeric_limits<double>::quiet_NaN();
  const NewtonResult result = solver.solve(problem, broken, {});
  CHECK(result.outcome == NewtonOutcome::notFinite);
  CHECK(result.worst == 2);
}

TEST_CASE("no step is longer than the problem allows") {
  Walled problem(3);
  problem.target = Vec3(0.5, 0, 0);
  problem.largest = 0.25;
  std::vector<Vec3> u(3, Vec3::Zero());
  NewtonSettings settings = with(Preconditioner::blockJacobi);
  settings.maxIterations = 1;
  NewtonSolver solver;
  const NewtonResult result = solver.solve(problem, u, settings);
  CHECK(result.outcome == NewtonOutcome::iterationLimit);
  CHECK(result.lastStep > 0.0);
  CHECK(result.lastStep == Approx(0.25 * problem.asked));
  // All steps are cut, so none of them may count as the last; only the residual may.
  settings.maxIterations = 200;
  settings.toleranceForce = 1e-9;
  CHECK(solver.solve(problem, u, settings).good());
  problem.largest = 0.0;
  u.assign(3, Vec3::Zero());
  CHECK(solver.solve(problem, u, settings).outcome == NewtonOutcome::noDescent);
  CHECK(u[0] == Vec3::Zero());
}

TEST_CASE("out of iterations, the worst phyxel and its residual are named") {
  Column column(21);
  std::vector<Vec3> u = column.start(0.05, 1e-3);
  NewtonSettings settings = with(Preconditioner::blockJacobi, 1e-12);
  settings.maxIterations = 2;
  NewtonSolver solver;
  const NewtonResult result = solver.solve(column, u, settings);
  CHECK(result.outcome == NewtonOutcome::iterationLimit);
  CHECK(result.iterations == 2);
  std::vector<Vec3> g(u.size());
  REQUIRE(column.setState(u));
  column.gradient(g);
  double worst = 0.0;
  for (std::size_t i = 0; i < g.size(); ++i)
    if (column.held[i] == 0) worst = std::max(worst, g[i].norm());
  CHECK(result.residual == Approx(worst));
  CHECK(column.held[result.worst] == 0);
  CHECK(g[result.worst].norm() == Approx(worst));
}

namespace {
// An energy that is inconsistent with its gradient: it cannot decrease along it.
class Deceitful : public GridProblem {
 public:
  Deceitful() : GridProblem(3) {}
  [[nodiscard]] double energy() override { return -GridProblem::energy(); }
};
}  // namespace

TEST_CASE("where no step helps, the solver says so and goes nowhere") {
  Deceitful problem;
  std::vector<Vec3> u(problem.phyxels(), Vec3(0.1, 0.2, 0.3));
  const std::vector<Vec3> before = u;
  NewtonSolver solver;
  const NewtonResult result = solver.solve(problem, u, {});
  CHECK(result.outcome == NewtonOutcome::noDescent);
  CHECK(difference(u, before) < 1e-7);  // the tolerance: no significant step
  std::vector<Vec3> g(u.size());
  problem.gradient(g);
  CHECK(g[result.worst].norm() == Approx(result.residual));
}

TEST_CASE("the solver stops when it is told to") {
  Column column(21);
  std::vector<Vec3> u = column.start(0.05, 1e-3);
  int asked = 0;
  NewtonSolver solver;
  const NewtonResult result = solver.solve(column, u, {}, [&](const NewtonResult &so) {
    CHECK(so.iterations == asked);
    return ++asked < 3;
  });
  CHECK(result.outcome == NewtonOutcome::cancelled);
  CHECK(result.iterations == 2);
}

TEST_CASE("a minimum is recognised without moving anything") {
  GridProblem problem(4);
  const Eigen::VectorXd truth = Eigen::SimplicialLDLT<Matrix>(problem.matrix).solve(problem.load);
  std::vector<Vec3> u(problem.phyxels());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = truth.segment<3>(static_cast<Eigen::Index>(3 * i));
  NewtonSolver solver;
  // The residual is round-off, so it cannot fall by much; the step is still far below the tolerance.
  const NewtonResult near = solver.solve(problem, u, with(Preconditioner::blockJacobi));
  CHECK(near.good());
  CHECK(near.iterations <= 2);
  CHECK(near.lastStep < 1e-12);
  problem.load.setZero();
  u.assign(u.size(), Vec3::Zero());
  const NewtonResult exact = solver.solve(problem, u, with(Preconditioner::blockJacobi));
  CHECK(exact.good());
  CHECK(exact.iterations == 0);
}

TEST_CASE("a tolerance below round-off ends at round-off, not in the iteration limit") {
  for (const Preconditioner p : kAll) {
    Column column(21);
    std::vector<Vec3> u = column.start(0.05, 1e-3);
    NewtonSettings settings = with(p, 0.0);
    settings.maxIterations = 200;
    NewtonSolver solver;
    const NewtonResult result = solver.solve(column, u, settings);
    CAPTURE(static_cast<int>(p), result.iterations, result.residual);
    CHECK(result.good());
    CHECK(result.iterations < 100);
    CHECK(result.residual < 1e-9);  // springs of 1000 N/m resolve 1e-16 m times the length 2 m in units of 0.1 m
  }
}

TEST_CASE("a factorisation is kept as long as it serves and renewed when it does not") {
  GridProblem problem(8);
  NewtonSolver solver;
  std::vector<Vec3> u(problem.phyxels(), Vec3::Zero());
  CHECK(solver.solve(problem, u, with(Preconditioner::factorised)).factorisations == 1);
  CHECK(problem.assemblies == 1);

  // The same matrix, other loads: the preconditioner is kept.
  for (int i = 0; i < 5; ++i) {
    problem.load *= -1.5;
    const NewtonResult result = solver.solve(problem, u, with(Preconditioner::factorised));
    CHECK(result.good());
    CHECK(result.factorisations == 0);
  }
  CHECK(problem.assemblies == 1);

  // A very different matrix: a new preconditioner pays off soon; afterwards the solves are as short as before.
  GridProblem other(8, 1e-3);
  int factorisations = 0;
  NewtonResult last;
  for (int i = 0; i < 20; ++i) {
    other.load *= -1.1;
    last = solver.solve(other, u, with(Preconditioner::factorised));
    CHECK(last.good());
    factorisations += last.factorisations;
  }
  CHECK(factorisations == 1);
  CHECK(last.linearIterations <= 2 * last.iterations);

  // Other held phyxels, another size, or a reset: a new one at once.
  problem.held.assign(problem.phyxels(), 0);
  problem.held[7] = 1;
  CHECK(solver.solve(problem, u, with(Preconditioner::factorised)).factorisations == 1);
  solver.forget();
  problem.load *= 2.0;
  CHECK(solver.solve(problem, u, with(Preconditioner::factorised)).factorisations == 1);
  GridProblem small(3);
  std::vector<Vec3> v(small.phyxels(), Vec3::Zero());
  CHECK(solver.solve(small, v, with(Preconditioner::factorised)).factorisations == 1);
}

TEST_CASE("a large body begins with the cheap factorisation and changes when its iterations have paid for the other") {
  GridProblem problem(16, 1e4);
  NewtonSolver solver;
  std::vector<Vec3> u(problem.phyxels(), Vec3::Zero());
  NewtonSettings settings = with(Preconditioner::automatic, 1e-6);
  const NewtonResult first = solver.solve(problem, u, settings);
  CHECK(first.good());
  CHECK(first.factorisations == 1);
  CHECK(first.linearIterations > 20);  // not the complete one
  int solves = 1;
  NewtonResult later = first;
  for (; solves < 100 && (solves == 1 || later.factorisations == 0); ++solves) {
    problem.load *= -1.01;
    later = solver.solve(problem, u, settings);
    CHECK(later.good());
  }
  CAPTURE(solves);
  REQUIRE(solves < 100);
  problem.load *= -1.01;
  later = solver.solve(problem, u, settings);
  CHECK(later.factorisations == 0);
  CHECK(later.linearIterations <= 2 * later.iterations);
}

TEST_CASE("a problem that cannot be assembled is solved with its blocks") {
  for (const Preconditioner p : kAll) {
    GridProblem problem(5);
    problem.canAssemble = false;
    std::vector<Vec3> u(problem.phyxels(), Vec3::Zero());
    NewtonSolver solver;
    const NewtonResult result = solver.solve(problem, u, with(p));
    CHECK(result.good());
    CHECK(result.factorisations == 0);
  }
}

TEST_CASE("a repeated solve has the same bits and the same counts") {
  for (const Preconditioner p : kAll) {
    std::vector<Vec3> results[2];
    NewtonResult counts[2];
    for (int run = 0; run < 2; ++run) {
      Column column(31);
      std::vector<Vec3> u = column.start(0.08, 1e-4);
      NewtonSolver solver;
      NewtonSettings settings = with(p);
      settings.maxIterations = 100;
      counts[run] = solver.solve(column, u, settings);
      // Another start with the retained data of the solver.
      u[15][1] += 0.05;
      const NewtonResult again = solver.solve(column, u, settings);
      counts[run].linearIterations += again.linearIterations;
      results[run] = u;
    }
    CHECK(counts[0].iterations == counts[1].iterations);
    CHECK(counts[0].linearIterations == counts[1].linearIterations);
    CHECK(std::memcmp(results[0].data(), results[1].data(), results[0].size() * sizeof(Vec3)) == 0);
  }
}

TEST_CASE("nothing to solve is solved") {
  GridProblem problem(2);
  problem.held.assign(problem.phyxels(), 1);
  std::vector<Vec3> u(problem.phyxels(), Vec3(1, 2, 3));
  NewtonSolver solver;
  const NewtonResult result = solver.solve(problem, u, {});
  CHECK(result.good());
  CHECK(result.iterations == 0);
  CHECK(u[3] == Vec3(1, 2, 3));
}
