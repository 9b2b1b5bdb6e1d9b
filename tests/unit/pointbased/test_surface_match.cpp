// SPDX-License-Identifier: Apache-2.0
// The inverse problem on truths: what a partly seen, noisy surface says about the inside of a deformed body.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <random>

#include "c3de/core/thread_pool.h"
#include "match_truths.h"
#include "matching/load_estimate.h"
#include "matching/load_patterns.h"
#include "matching/match_springs.h"
#include "matching/skin_distance.h"
#include "matching/warped_response.h"
#include "pointbased/integrators.h"
#include "support/catch.h"

using namespace match_truths;

namespace {

constexpr double kNoise = 1e-3;  // m
constexpr std::size_t kPoints = 500;

class Raised final : public StopRequest {
 public:
  [[nodiscard]] bool isRaised() const noexcept override { return true; }
};

// The space of the measurement is known: a body on supports in a tracked frame.
SurfaceMatchSettings inFrameOf(const Truth &truth) {
  SurfaceMatchSettings settings;
  settings.noise = kNoise;
  settings.start = truth.motion;
  settings.isMotionKnown = true;
  return settings;
}

Organ organNamed(const std::string &name) {
  for (const Organ &organ : organs())
    if (organ.name == name) return organ;
  throw std::runtime_error("no organ " + name);
}

SurfaceMatch matchFor(const Organ &organ, double stiffness, const ParallelFor &loops = serialFor()) {
  auto match = matchOf(organ, stiffness, loops);
  REQUIRE((match ? "" : match.error()) == "");
  return std::move(*match);
}

SurfaceMatchResult found(SurfaceMatch &match, const Truth &truth, const SurfaceMatchSettings &settings) {
  auto result = match.match(truth.points, truth.landmarks, settings);
  REQUIRE((result ? "" : result.error()) == "");
  return std::move(*result);
}

struct Calibration {
  double expected = 0.0;             // m, mean
  double within = 0.0, below = 0.0;  // shares of points whose error is within a factor of 1.5, and at most 1.5 times it
  double unknown = 0.0;
};

Calibration calibrationOf(const Organ &organ, const Truth &truth, const SurfaceMatchResult &result) {
  const std::vector<double> errors = errorsOf(organ, truth, result);
  const std::vector<double> expected = expectedErrorsOf(organ, truth, result);
  Calibration out;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double ratio = errors[i] / expected[i], share = 1.0 / static_cast<double>(errors.size());
    out.expected += share * expected[i];
    if (ratio < 1.5) out.below += share;
    if (ratio < 1.5 && ratio > 1.0 / 1.5) out.within += share;
  }
  for (const std::uint8_t one : result.isUnknown) out.unknown += one / static_cast<double>(result.isUnknown.size());
  return out;
}

// Errors of an organ under all loads, with a modulus that is wrong by a factor.
void checkTargets(const std::string &name, double stiffness, double most, double part) {
  const Organ organ = organNamed(name);
  SurfaceMatch match = matchFor(organ, stiffness);
  for (int load = 0; load < kLoads; ++load) {
    const Truth truth = truthOf(organ, load, kPoints, kNoise);
    match.reset();
    const SurfaceMatchResult result = found(match, truth, inFrameOf(truth));
    const double rigid = meanOf(rigidErrorsOf(truth, result)), error = meanOf(errorsOf(organ, truth, result));
    CAPTURE(name, stiffness, load, rigid, error, result.distance, result.iterations);
    CHECK(error < most);
    CHECK(error < part * rigid);
    CHECK(result.distance < 1.2 * kNoise);
    CHECK(result.usedPart > 0.9);
  }
}

}  // namespace

TEST_CASE("the inside of a held beam is found within 2 mm and a quarter of the error without deformation",
          "[match][slow]") {
  checkTargets("beam", 2.0, 2e-3, 0.25);
  checkTargets("beam", 0.5, 2e-3, 0.25);
}

// That error is 12 to 20 mm, under loads of which some are on the side that is not seen.
TEST_CASE("the inside of the shipped organ is found within a fifth of the error without deformation", "[match][slow]") {
  checkTargets("organ", 2.0, 4e-3, 0.2);
  checkTargets("organ", 0.5, 4e-3, 0.2);
}

// The best rigid motion of the seen part leaves 20 mm inside.
TEST_CASE("with an unknown position a quarter of the error remains, and less than 1.5 times the expected one",
          "[match]") {
  const Organ organ = organNamed("organ");
  SurfaceMatch match = matchFor(organ, 2.0);
  for (const int load : {0, 3}) {
    const Truth truth = truthOf(organ, load, kPoints, kNoise);
    SurfaceMatchSettings settings;
    settings.noise = kNoise;
    match.reset();
    const SurfaceMatchResult result = found(match, truth, settings);
    const double rigid = meanOf(rigidErrorsOf(truth, result)), error = meanOf(errorsOf(organ, truth, result));
    const Calibration of = calibrationOf(organ, truth, result);
    CAPTURE(load, rigid, error, of.expected, of.below, result.distance, result.iterations);
    CHECK(rigid > 15e-3);
    CHECK(error < 0.25 * rigid);
    CHECK(of.below > 0.9);
    CHECK(result.hasConverged);
  }
}

// Prints the tables of docs/theory/inverse.md: test_inverse "[.errors]"
TEST_CASE("Errors of matches with a given and with an unknown position", "[.errors]") {
  const char *name = GENERATE("beam", "ellipsoid", "organ");
  const double stiffness = GENERATE(2.0, 0.5);
  DYNAMIC_SECTION(name << " " << stiffness) {
    const Organ organ = organNamed(name);
    SurfaceMatch match = matchFor(organ, stiffness);
    for (int load = 0; load < kLoads; ++load) {
      const Truth truth = truthOf(organ, load, kPoints, kNoise);
      for (const bool isKnown : {true, false}) {
        SurfaceMatchSettings settings = inFrameOf(truth);
        settings.isMotionKnown = isKnown;
        if (!isKnown) settings.start = MatchMotion();
        match.reset();
        const std::clock_t begin = std::clock();
        const SurfaceMatchResult result = found(match, truth, settings);
        const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        const double rigid = meanOf(rigidErrorsOf(truth, result)), error = meanOf(errorsOf(organ, truth, result));
        const Calibration of = calibrationOf(organ, truth, result);
        std::printf(
            "%-9s E x %.1f load %d %-7s rigid %5.2f mm, match %5.2f mm (%3.0f %%), expected %5.2f mm; points "
            "within a factor 1.5: %3.0f %%, below 1.5: %3.0f %%, unknown %3.0f %%; distance %.2f mm; "
            "%d iterations, %.1f s%s\n",
            name, stiffness, load, isKnown ? "given" : "unknown", 1e3 * rigid, 1e3 * error, 100.0 * error / rigid,
            1e3 * of.expected, 100.0 * of.within, 100.0 * of.below, 100.0 * of.unknown, 1e3 * result.distance,
            result.iterations, seconds, result.stiffness > 0.0 ? ", springs" : "");
        std::fflush(stdout);
      }
    }
  }
}

TEST_CASE("the forces found hold the body in the shape found", "[match][slow]") {
  const Organ organ = organNamed("beam");
  SurfaceMatch match = matchFor(organ, 2.0);
  const Truth truth = truthOf(organ, 1, kPoints, kNoise);
  const SurfaceMatchResult result = found(match, truth, inFrameOf(truth));
  const auto body = bodyOf(organ, 2.0);
  body->quasiStatic = true;
  body->state().displacements = result.displacements;
  std::vector<Vec3> forces = result.forces;
  body->swapExternalForces(forces);
  NewtonSolver solver;
  StageClock clock(stageNames());
  const ParallelFor loops = serialFor();
  Environment environment;
  environment.parallelFor = &loops;
  environment.clock = &clock;
  REQUIRE(quasiStaticStep(*body, solver, environment, 1.0, 1.0).failure == "");
  double most = 0.0;
  for (std::size_t i = 0; i < result.displacements.size(); ++i)
    most = std::max(most, (body->state().displacements[i] - result.displacements[i]).norm());
  CHECK(most < 1e-6);
  CHECK(shapes::largest(result.displacements) > 5e-3);
}

TEST_CASE("a match has the same bits for any threads, and a next frame starts from it", "[match][slow]") {
  const Organ organ = organNamed("beam");
  const Truth truth = truthOf(organ, 3, kPoints, kNoise);
  c3de::ThreadPool pool(3);
  SurfaceMatch one = matchFor(organ, 2.0), several = matchFor(organ, 2.0, shapes::loopsOf(pool));
  SurfaceMatchSettings settings = inFrameOf(truth);
  settings.isMotionKnown = false;
  const SurfaceMatchResult first = found(one, truth, settings), second = found(several, truth, settings);
  CHECK(first.displacements == second.displacements);
  CHECK(first.expectedErrors == second.expectedErrors);
  CHECK(first.motion.translation == second.motion.translation);
  one.reset();
  CHECK(found(one, truth, settings).displacements == first.displacements);

  settings.isMotionKnown = true;
  settings.findsExpectedErrors = false;
  one.reset();
  const int fresh = found(one, truth, settings).iterations, next = found(one, truth, settings).iterations;
  CAPTURE(fresh, next);
  CHECK(next < fresh);
}

namespace {

// Bends everything that was measured, and the points inside.
// @param deflection  m, at both ends
void bend(const Organ &organ, double deflection, Truth &truth) {
  Vec3 low = organ.surface.positions.front(), high = low;
  for (const Vec3 &x : organ.surface.positions) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const Vec3 centre = 0.5 * (low + high), size = high - low;
  Eigen::Index along = 0;
  size.maxCoeff(&along);
  const Eigen::Index across = (along + 1) % 3;
  const auto moved = [&](const Vec3 &y) {
    Vec3 x = truth.motion.inverse(y);
    const double at = 2.0 * (x[along] - centre[along]) / size[along];
    x[across] += deflection * at * at;
    return truth.motion.of(x);
  };
  for (MatchPoint &point : truth.points) point.position = moved(point.position);
  for (MatchLandmark &landmark : truth.landmarks) landmark.position = moved(landmark.position);
  for (Vec3 &position : truth.positions) position = moved(position);
}

}  // namespace

TEST_CASE("errors of further frames are within 1.2 times those of matches from rest", "[match][slow]") {
  const auto [name, isKnown] =
      GENERATE(std::pair<std::string, bool>{"beam", true}, std::pair<std::string, bool>{"organ", true},
               std::pair<std::string, bool>{"organ", false});
  const Organ organ = organNamed(name);
  SurfaceMatch following = matchFor(organ, 2.0), fresh = matchFor(organ, 2.0);
  Truth truth = truthOf(organ, 3, kPoints, kNoise);
  SurfaceMatchSettings settings = inFrameOf(truth);
  settings.isMotionKnown = isKnown;
  double sumFollowing = 0.0, sumFresh = 0.0;
  int iterations = 0, fromRest = 0;
  for (int frame = 0; frame < 6; ++frame) {
    const SurfaceMatchResult next = found(following, truth, settings);
    fresh.reset();
    SurfaceMatchSettings first = inFrameOf(truth);
    first.isMotionKnown = isKnown;
    const SurfaceMatchResult alone = found(fresh, truth, first);
    settings.start = next.motion;
    if (frame > 0) {
      sumFollowing += meanOf(errorsOf(organ, truth, next));
      sumFresh += meanOf(errorsOf(organ, truth, alone));
      iterations += next.iterations;
      fromRest += alone.iterations;
      CHECK(next.distance < 1.2 * kNoise);
    }
    bend(organ, 1.5e-3, truth);
  }
  CAPTURE(name, isKnown, sumFollowing, sumFresh, iterations, fromRest);
  CHECK(sumFollowing < 1.2 * sumFresh);
  CHECK(iterations < 0.7 * fromRest);
}

TEST_CASE("a match does not depend on the one before a reset, also where both shapes are near", "[match]") {
  const Organ organ = organNamed("beam");
  const Truth truth = truthOf(organ, 1, 100, kNoise);
  SurfaceMatch match = matchFor(organ, 2.0), fresh = matchFor(organ, 2.0);
  SurfaceMatchSettings settings = inFrameOf(truth);
  CHECK(shapes::largest(found(match, truth, settings).displacements) > 1e-3);
  match.reset();
  settings.noise = 0.05;  // m: derivatives are kept for shapes that differ by less than a half of it
  CHECK(found(match, truth, settings).displacements == found(fresh, truth, settings).displacements);
}

TEST_CASE("distances that remain are in the expected error", "[match]") {
  const Organ organ = organNamed("beam");
  SurfaceMatch match = matchFor(organ, 2.0);
  const Truth truth = truthOf(organ, 1, 100, kNoise);
  SurfaceMatchSettings settings = inFrameOf(truth);
  settings.start.translation += Vec3(0.0, 0.0, 0.05);  // not the true position
  settings.maxIterations = 1;
  const SurfaceMatchResult result = found(match, truth, settings);
  CHECK_FALSE(result.hasConverged);
  REQUIRE(result.distance > 3.0 * kNoise);
  CHECK(*std::min_element(result.expectedErrors.begin(), result.expectedErrors.end()) > 0.9 * result.distance);
}

TEST_CASE("false points get no weight and hardly change a match", "[match][slow]") {
  const Organ organ = organNamed("beam");
  SurfaceMatch match = matchFor(organ, 2.0);
  Truth truth = truthOf(organ, 1, kPoints, kNoise);
  const double clean = meanOf(errorsOf(organ, truth, found(match, truth, inFrameOf(truth))));
  std::mt19937 random(3);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 - 0.5; };
  for (std::size_t i = 0; i < kPoints; i += 5)
    truth.points[i].position += Vec3(0.02 * uniform(), 0.02 * uniform(), 0.03 + 0.02 * uniform());
  match.reset();
  const SurfaceMatchResult result = found(match, truth, inFrameOf(truth));
  const double dirty = meanOf(errorsOf(organ, truth, result));
  CAPTURE(clean, dirty);
  CHECK(dirty < clean + 1e-3);
  // A few have been moved along a side of the beam, on which they remain.
  std::size_t weightless = 0;
  for (std::size_t i = 0; i < kPoints; i += 5) weightless += result.weights[i] < 0.1 ? 1 : 0;
  CHECK(weightless > kPoints / 5 * 8 / 10);
}

TEST_CASE("input that cannot be matched is refused with index, value and range", "[match]") {
  const Organ organ = organNamed("beam");
  SurfaceMatch match = matchFor(organ, 1.0);
  const Truth truth = truthOf(organ, 0, 50, kNoise);
  const auto errorOf = [&](std::vector<MatchPoint> points, std::vector<MatchLandmark> landmarks,
                           const SurfaceMatchSettings &settings) {
    const auto result = match.match(points, landmarks, settings);
    return result ? std::string() : result.error();
  };
  SurfaceMatchSettings settings = inFrameOf(truth);
  std::vector<MatchPoint> points = truth.points;
  points[7].position[1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(errorOf(points, {}, settings), Contains("point 7"));
  points = truth.points;
  points[3].normal = Vec3(0.0, 0.0, 2.0);
  CHECK_THAT(errorOf(points, {}, settings), Contains("point 3") && Contains("length 2"));
  CHECK_THAT(errorOf({truth.points[0]}, {truth.landmarks[0]}, settings), Contains("at least 3"));
  CHECK_THAT(errorOf({}, {}, settings), Contains("0 points"));
  SurfaceMatchSettings other = settings;
  other.noise = 0.0;
  CHECK_THAT(errorOf(truth.points, {}, other), Contains("noise 0 m"));
  other = settings;
  other.start.rotation *= -1.0;
  CHECK_THAT(errorOf(truth.points, {}, other), Contains("rotation"));
  other = settings;
  other.progress = [](const SurfaceMatchProgress &) { return false; };
  CHECK(errorOf(truth.points, {}, other) == "cancelled");
  const Raised stop;
  other = settings;
  other.stop = &stop;
  CHECK(errorOf(truth.points, {}, other) == "cancelled");
  CHECK(errorOf(truth.points, {}, settings) == "");

  Organ loose = organ;
  loose.name = "loose beam";
  loose.fixes.clear();
  const auto nothing = matchOf(loose, 1.0);
  REQUIRE(!nothing);
  CHECK_THAT(nothing.error(), Contains("nothing holds the body"));
}

TEST_CASE("the closest point of a skin does not depend on the guess", "[match]") {
  const Surface skin = organNamed("ellipsoid").surface;
  detail::SkinDistance distance(skin.triangles);
  distance.move(skin.positions);
  shapes::Random random{5};
  for (int k = 0; k < 50; ++k) {
    const Vec3 x = 0.1 * random.vector();
    const detail::ClosestSkinPoint found = distance.closest(x, Vec3::Zero(), 0.0, detail::ClosestSkinPoint::kNone);
    double least = std::numeric_limits<double>::infinity();
    for (const auto &[a, b, c] : skin.triangles) {
      const Vec3 w = detail::closestOfTriangle(x, skin.positions[a], skin.positions[b], skin.positions[c]);
      CHECK(w.minCoeff() >= 0.0);
      CHECK(std::abs(w.sum() - 1.0) < 1e-12);
      least =
          std::min(least, (x - w[0] * skin.positions[a] - w[1] * skin.positions[b] - w[2] * skin.positions[c]).norm());
    }
    CHECK(std::abs((x - found.position).norm() - least) < 1e-12);
    for (const Index guess : {Index{0}, Index{77}, found.triangle})
      CHECK(distance.closest(x, Vec3::Zero(), 0.0, guess).triangle == found.triangle);
    // Seen from the opposite side there is another one, or none.
    const detail::ClosestSkinPoint back = distance.closest(x, -found.normal, 0.1, found.triangle);
    CHECK((back.triangle == detail::ClosestSkinPoint::kNone || back.normal.dot(found.normal) < 0.0));
  }
}

TEST_CASE("a linear response becomes a large deformation without stretch by rotation", "[match]") {
  // A bar that is bent into an arc of 1.5 rad by the linear response of pure bending.
  Organ bar = organNamed("beam");
  const auto body = bodyOf(bar, 1.0);
  const RestState &rest = body->rest();
  detail::WarpedResponse warped(*body);
  constexpr double angle = 1.5, length = 0.16;
  const double curvature = angle / length;
  std::vector<Vec3> v, u(rest.phyxelCount());
  double left = 1.0, middle = 0.0;
  for (const Vec3 &X : rest.positions) {
    left = std::min(left, X[0]);
    middle += X[2] / static_cast<double>(rest.phyxelCount());
  }
  for (const Vec3 &X : rest.positions) {
    const double x = X[0] - left, z = X[2] - middle;
    v.emplace_back(-curvature * x * z, 0.0, 0.5 * curvature * x * x);
  }
  warped.deform(v, u, serialFor());
  double most = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double x = rest.positions[i][0] - left, z = rest.positions[i][2] - middle, turn = curvature * x;
    const Vec3 arc((1.0 / curvature - z) * std::sin(turn) - x, 0.0,
                   (1.0 / curvature) - (1.0 / curvature - z) * std::cos(turn) - z);
    most = std::max(most, (u[i] - arc).norm());
  }
  // The linear response itself is off by 60 mm at the end.
  CAPTURE(most);
  CHECK(most < 0.02 * length);

  // Derivatives are exact where the change of the strain commutes with it, here within a few per cent.
  std::vector<Vec3> dv, forward = v, backward = v, above(u), below(u);
  constexpr double step = 1e-4;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec3 &X = rest.positions[i];
    dv.emplace_back(-X[1] * (X[0] - left), 0.5 * (X[0] - left) * (X[0] - left), 0.1 * X[2] * (X[0] - left));
    forward[i] += step * dv[i];
    backward[i] -= step * dv[i];
  }
  const auto n = static_cast<Eigen::Index>(v.size());
  // The second of two responses.
  detail::ResponseMatrix responses = detail::ResponseMatrix::Zero(n, 6), derivatives;
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index c = 0; c < 3; ++c)
      responses(i, 2 * c + 1) = static_cast<float>(dv[static_cast<std::size_t>(i)][c]);
  warped.setResponses(responses, serialFor());
  warped.differentiate(derivatives, serialFor());
  warped.deform(forward, above, serialFor());
  warped.deform(backward, below, serialFor());
  double off = 0.0, all = 0.0;
  for (Eigen::Index c = 0; c < 3; ++c) {
    const Eigen::Index column = c * (derivatives.cols() / 3) + 1;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const double difference = (above[i][c] - below[i][c]) / (2.0 * step);
      off += std::pow(derivatives(static_cast<Eigen::Index>(i), column) - difference, 2);
      all += difference * difference;
    }
  }
  CAPTURE(std::sqrt(off / all));
  CHECK(std::sqrt(off / all) < 0.03);
}

TEST_CASE("loads are estimated as their prior and the measurements say", "[match]") {
  // One load, measured directly and often; a motion that the second half of the measurements shows alone.
  constexpr Eigen::Index n = 400;
  constexpr double sigma = 1e-3, load = 3e-2, shift = 5e-3;
  detail::LinearMeasurements rows;
  rows.A = Eigen::MatrixXd::Zero(n, 2);
  rows.C = Eigen::MatrixXd::Zero(n, 6);
  rows.A.col(0).head(n / 2).setOnes();
  rows.C.col(3).setOnes();
  rows.weights = Eigen::VectorXd::Constant(n, 1.0 / (sigma * sigma));
  shapes::Random random{4};
  rows.d = load * rows.A.col(0) + shift * rows.C.col(3);
  for (Eigen::Index i = 0; i < n; ++i) rows.d[i] += sigma * std::sqrt(3.0) * random.vector()[0];
  const detail::LoadEstimate found =
      detail::estimateLoads(rows, Eigen::VectorXd::Ones(6), 1e-3, 1e-1, detail::LoadSize::mean);
  const double expected = sigma * std::sqrt(4.0 / n);  // difference of two means
  CHECK(std::abs(found.loads[0] - load) < 4.0 * expected);
  CHECK(std::abs(found.motion[3] - shift) < 4.0 * expected);
  CHECK(std::abs(std::sqrt(found.covariance()(0, 0)) / expected - 1.0) < 0.05);
  // Nothing was measured of the second load: it keeps its prior.
  CHECK(std::abs(found.loads[1]) < 1e-12);
  CHECK(std::abs(found.covariance()(1, 1) / found.variance - 1.0) < 1e-9);
  CHECK(std::sqrt(found.variance) > 0.3 * load);
}

TEST_CASE("uniform stresses have no resultant, and a body force is uniform", "[match]") {
  const auto body = bodyOf(organNamed("ellipsoid"), 1.0);
  const RestState &rest = body->rest();
  const detail::LoadPatterns patterns(rest);
  std::vector<Vec3> forces(rest.phyxelCount());
  double area = 0.0;
  for (std::size_t p = patterns.count() - 9; p < patterns.count(); ++p) {
    patterns.forces(p, forces);
    Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
    double sizes = 0.0;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      sum += forces[i];
      moment += rest.positions[i].cross(forces[i]);
      sizes += forces[i].norm();
    }
    CAPTURE(p, sizes);
    CHECK(sizes > 0.0);
    if (p < patterns.count() - 6) {
      area = sizes;
      CHECK(std::abs(sum.norm() - sizes) < 1e-9 * sizes);
    } else {
      CHECK(sum.norm() < 1e-9 * sizes);
      CHECK(moment.norm() < 1e-9 * sizes);
      CHECK(sizes < 6.0 * area);
    }
  }
}

TEST_CASE("the springs of a match have the derivatives of their energy", "[match]") {
  shapes::Random random{9};
  detail::MatchSprings springs;
  constexpr std::size_t n = 6;
  for (int i = 0; i < 4; ++i) {
    for (Index j = 0; j < 5; ++j) springs.add((j * static_cast<Index>(i + 1)) % n, 0.1 + 0.2 * j);
    const Mat3 root = Mat3::Random();
    detail::MatchSprings::Columns columns;
    for (int a = 0; a < 6; ++a) columns.col(a) = random.vector();
    springs.finish(root * root.transpose(), random.vector(), columns);
  }
  std::vector<Vec3> v(n), dv(n), forces(n, Vec3::Zero()), product(n, Vec3::Zero());
  for (std::size_t j = 0; j < n; ++j) v[j] = random.vector(), dv[j] = random.vector();
  springs.addForces(v, forces);
  springs.addProduct(dv, product);
  const auto along = [&](double h) {
    std::vector<Vec3> at = v;
    for (std::size_t j = 0; j < n; ++j) at[j] += h * dv[j];
    return springs.energy(at);
  };
  double slope = 0.0, curvature = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    slope -= forces[j].dot(dv[j]);
    curvature += product[j].dot(dv[j]);
  }
  // The energy is quadratic, so that differences are exact but for round-off.
  CHECK(std::abs(0.5 * (along(1.0) - along(-1.0)) - slope) < 1e-10 * std::abs(slope));
  CHECK(std::abs(along(1.0) - 2.0 * along(0.0) + along(-1.0) - curvature) < 1e-9 * curvature);
  std::vector<Eigen::Triplet<double>> triplets;
  springs.addTriplets(triplets);
  double assembled = 0.0;
  for (const auto &t : triplets)
    assembled += t.value() * dv[static_cast<std::size_t>(t.row() / 3)][t.row() % 3] *
                 dv[static_cast<std::size_t>(t.col() / 3)][t.col() % 3];
  CHECK(std::abs(assembled - curvature) < 1e-10 * curvature);
}
