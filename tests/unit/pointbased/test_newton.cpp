// SPDX-License-Identifier: Apache-2.0
#include "pointbased/newton.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "newton_problems.h"
#include "shapes.h"
#include "solvers/conjugate_gradients.h"
#include "support/catch.h"

using namespace pointbased;
using namespace newton_problems;
using Catch::Matchers::WithinRel;

namespace {

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
