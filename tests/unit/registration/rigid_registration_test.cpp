// SPDX-License-Identifier: Apache-2.0
#include "c3de/registration/rigid_registration.h"

#include <chrono>
#include <limits>

#include "c3de/geometry/mesh_io.h"
#include "measured_shapes.h"
#include "support/catch.h"

using namespace measured_shapes;
using registration::kFewestSurfacePoints;
using registration::MeasuredSurface;
using registration::registerRigid;
using registration::RegistrationOptions;
using registration::RegistrationVerdict;
using registration::RigidRegistration;

namespace {

RigidRegistration registered(const TriangleMesh &body, const MeasuredSurface &measured,
                             const RegistrationOptions &options = {}) {
  const auto out = registerRigid(body, measured, options);
  if (!out) FAIL(out.error().message);
  return *out;
}

RigidRegistration registered(const TriangleMesh &body, const std::vector<Vec3> &points) {
  MeasuredSurface measured;
  measured.points_mm = points;
  return registered(body, measured);
}

std::string refusal(const TriangleMesh &body, const MeasuredSurface &measured,
                    const RegistrationOptions &options = {}) {
  const auto out = registerRigid(body, measured, options);
  if (out) return "";
  CHECK(out.error().code == ErrorCode::usage);
  return out.error().message;
}

std::string refusal(const TriangleMesh &body, const std::vector<Vec3> &points) {
  MeasuredSurface measured;
  measured.points_mm = points;
  return refusal(body, measured);
}

bool warns(const RigidRegistration &of, const std::string &part) {
  return std::any_of(of.warnings.begin(), of.warnings.end(),
                     [&](const std::string &text) { return text.find(part) != std::string::npos; });
}

double determinant(const Mat4 &m) { return dot({m[0], m[1], m[2]}, cross({m[4], m[5], m[6]}, {m[8], m[9], m[10]})); }

}  // namespace

TEST_CASE("A quarter of a surface with noise is found from any position") {
  const TriangleMesh body = organ();
  for (unsigned k = 0; k < 5; ++k) {
    INFO(k);
    const Mat4 truth = someMotion(k);
    Measurement how;
    how.seed = 20 + k;
    how.towards = {k % 2 == 0 ? 0.3 : -0.8, 0.5, k < 2 ? 0.8 : -0.2};
    const RigidRegistration out = registered(body, measure(body, how, truth));
    CHECK(out.verdict == RegistrationVerdict::found);
    CHECK(out.candidates.size() == 1);
    // The motion is known better than a point: 500 of them with 1 mm determine 6 unknowns. What was not seen
    // moves more.
    CHECK(errorOf(body, out.measuredFromBody, truth) < 5.0);
    CHECK_THAT(out.after.rms_mm, WithinAbs(1.0, 0.15));
    CHECK(out.after.inlierShare > 0.97);
    CHECK_THAT(out.coverage, WithinAbs(0.25, 0.06));
    CHECK(out.before.rms_mm >= 0.0);
    CHECK(out.before.p95_mm > 20.0);
    CHECK_THAT(determinant(out.measuredFromBody), WithinAbs(1.0, 1e-9));
    CHECK(out.after.distance_mm.size() == how.points);
  }
}

TEST_CASE("A whole surface 10 cm away is found") {
  const TriangleMesh body = organ();
  Mat4 truth = kIdentity4;
  truth[12] = 100.0;
  Measurement how;
  how.share = 1.0;
  const RigidRegistration out = registered(body, measure(body, how, truth));
  CHECK(out.verdict == RegistrationVerdict::found);
  CHECK(errorOf(body, out.measuredFromBody, truth) < 1.5);
  CHECK(out.coverage > 0.95);
}

TEST_CASE("Half of the points may be outliers") {
  const TriangleMesh body = organ();
  for (const double share : {1.0, 0.25}) {
    INFO(share);
    Measurement how;
    how.share = share;
    how.outliers = 0.5;
    const Mat4 truth = someMotion(11);
    const RigidRegistration out = registered(body, measure(body, how, truth));
    CHECK(out.verdict == RegistrationVerdict::found);
    CHECK(errorOf(body, out.measuredFromBody, truth) < 8.0);
    // Some outliers are near the surface by chance.
    CHECK(out.after.inlierShare > 0.5);
    CHECK(out.after.inlierShare < 0.7);
    CHECK(warns(out, "were left out"));
  }
}

TEST_CASE("Points without a body under them give no result") {
  const TriangleMesh body = organ();
  const std::vector<Vec3> points = measure(body, {}, kIdentity4);
  CHECK_THAT(refusal(body, std::vector<Vec3>{}), Contains("0 measured points; accepted: at least 12"));
  CHECK_THAT(refusal(body, {points.begin(), points.begin() + 5}), Contains("5 measured points; accepted: at least 12"));
  std::vector<Vec3> same(40, points[3]);
  CHECK_THAT(refusal(body, same), Contains("1 measured point besides 39 at equal positions"));
  std::vector<Vec3> broken = points;
  broken[17][1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(refusal(body, broken), Contains("measured point 18 is (") && Contains("nan") && Contains("finite"));
  std::vector<Vec3> metres = points;
  for (Vec3 &p : metres) p = 1e-3 * p;
  CHECK_THAT(refusal(body, metres), Contains("metres") && Contains("multiply them by 1000"));
  std::vector<Vec3> large = points;
  for (Vec3 &p : large) p = 1000.0 * p;
  CHECK_THAT(refusal(body, large), Contains("accepted: points in mm, of at most 20 times"));
  MeasuredSurface measured;
  measured.points_mm = points;
  measured.normals.assign(3, Vec3{0, 0, 1});
  CHECK_THAT(refusal(body, measured), Contains("3 normals for 500 measured points"));
  measured.normals.clear();
  CHECK_THAT(refusal(body, measured, {.noise_mm = 0.0}), Contains("noise is 0 mm"));
  measured.pairs.push_back({{0, 0, 0}, {0, std::numeric_limits<double>::infinity(), 0}});
  CHECK_THAT(refusal(body, measured), Contains("landmark pair 1"));
  CHECK_THAT(refusal(TriangleMesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}, points), Contains("no area"));
}

TEST_CASE("Duplicates count once, and few points give no confident result") {
  const TriangleMesh body = organ();
  const Mat4 truth = someMotion(2);
  std::vector<Vec3> points = measure(body, {}, truth);
  std::vector<Vec3> twice = points;
  twice.insert(twice.end(), points.begin(), points.begin() + 100);
  const RigidRegistration out = registered(body, twice);
  CHECK(out.verdict == RegistrationVerdict::found);
  CHECK(warns(out, "100 of 600 measured points are at the position of another"));
  CHECK(out.after.distance_mm.size() == 600);

  points.resize(kFewestSurfacePoints);
  const RigidRegistration few = registered(body, points);
  CHECK((few.verdict == RegistrationVerdict::ambiguous || few.verdict == RegistrationVerdict::refused ||
         errorOf(body, few.measuredFromBody, truth) < 10.0));
}

TEST_CASE("Mirrored points are refused with the reason") {
  const TriangleMesh body = organ();
  for (const auto &[share, outliers] : {std::pair{1.0, 0.0}, {0.5, 0.0}, {0.5, 0.2}}) {
    INFO(share << " with outliers " << outliers);
    Measurement how;
    how.share = share;
    how.outliers = outliers;
    std::vector<Vec3> points = measure(body, how, someMotion(4));
    for (Vec3 &p : points) p[1] = -p[1];
    const RigidRegistration out = registered(body, points);
    CHECK((out.verdict == RegistrationVerdict::refused || outliers > 0.0));
    CHECK((warns(out, "mirrored") || outliers > 0.0));
    // Outliers may hide the reason, but such a motion is never found.
    CHECK((out.verdict == RegistrationVerdict::refused || out.verdict == RegistrationVerdict::ambiguous));
    CHECK_THAT(determinant(out.measuredFromBody), WithinAbs(1.0, 1e-9));
  }
}

TEST_CASE("Points of another body are never found") {
  const TriangleMesh body = organ();
  TriangleMesh dumbBell = ellipsoid({70, 70, 70});
  for (Vec3 &v : dumbBell.vertices) {
    const double thin = 0.35 + 0.65 * std::pow(std::abs(v[0]) / 70.0, 2.0);
    v = {1.6 * v[0], thin * v[1], thin * v[2]};
  }
  for (const double share : {1.0, 0.5, 0.25}) {
    INFO(share);
    Measurement how;
    how.share = share;
    const RigidRegistration out = registered(body, measure(dumbBell, how, someMotion(5)));
    CHECK((out.verdict == RegistrationVerdict::refused || out.verdict == RegistrationVerdict::ambiguous));
    CHECK_FALSE(out.warnings.empty());
    if (share == 1.0) CHECK(out.verdict == RegistrationVerdict::refused);
  }
}

TEST_CASE("A sphere, a symmetric body and a small flat part are ambiguous, with candidates") {
  const TriangleMesh sphere = ellipsoid({60, 60, 60});
  Measurement how;
  how.share = 1.0;
  const RigidRegistration round = registered(sphere, measure(sphere, how, someMotion(6)));
  CHECK(round.verdict == RegistrationVerdict::ambiguous);
  CHECK(round.candidates.size() > 3);
  CHECK(warns(round, "fit the points equally well"));

  // Three half turns leave an ellipsoid as it is.
  const TriangleMesh symmetric = ellipsoid({90, 60, 40});
  const Mat4 truth = someMotion(7);
  const RigidRegistration four = registered(symmetric, measure(symmetric, how, truth));
  CHECK(four.verdict == RegistrationVerdict::ambiguous);
  CHECK(four.candidates.size() == 4);
  double nearest = 1e9;
  for (const auto &candidate : four.candidates)
    nearest = std::min(nearest, errorOf(symmetric, candidate.measuredFromBody, truth));
  CHECK(nearest < 2.0);

  const TriangleMesh body = organ();
  how.share = 0.015;
  how.points = 100;
  const RigidRegistration flat = registered(body, measure(body, how, someMotion(8)));
  CHECK(flat.verdict == RegistrationVerdict::ambiguous);
  CHECK(flat.warnings.size() >= 1);
}

TEST_CASE("Landmarks decide between motions that fit equally well") {
  const TriangleMesh symmetric = ellipsoid({90, 60, 40});
  const Mat4 truth = someMotion(7);
  Measurement how;
  how.share = 1.0;
  MeasuredSurface measured;
  measured.points_mm = measure(symmetric, how, truth);
  for (const Vec3 &at : {Vec3{50, 20, 10}, Vec3{-30, 40, 5}}) measured.pairs.push_back({at, transformPoint(truth, at)});
  const RigidRegistration out = registered(symmetric, measured, {.pointsPerPair = 25.0});
  CHECK(out.verdict == RegistrationVerdict::found);
  CHECK(errorOf(symmetric, out.measuredFromBody, truth) < 2.0);
}

TEST_CASE("Normals of a measured surface are used, whatever their sign") {
  const TriangleMesh body = organ();
  const Mat4 truth = someMotion(9);
  const auto samples = registration::sampleSurface(body, 1000);
  MeasuredSurface measured;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    if (samples.points[i][2] < 150.0) continue;
    measured.points_mm.push_back(transformPoint(truth, samples.points[i]));
    const Vec3 n = transformPoint(truth, samples.points[i] + samples.normals[i]) - measured.points_mm.back();
    measured.normals.push_back((i % 2 == 0 ? 1.0 : -1.0) * n);
  }
  const RigidRegistration out = registered(body, measured);
  CHECK(out.verdict == RegistrationVerdict::found);
  // Samples and triangles of the same surface: without noise only the iteration remains.
  CHECK(errorOf(body, out.measuredFromBody, truth) < 0.3);
}

TEST_CASE("A body that has changed its shape is reported as unexplained") {
  const TriangleMesh body = organ();
  TriangleMesh bent = body;
  for (Vec3 &v : bent.vertices) v[2] += 12.0 * std::sin((v[0] - 10.0) / 45.0);
  const Mat4 truth = someMotion(10);
  Measurement how;
  how.share = 1.0;
  const RigidRegistration out = registered(body, measure(bent, how, truth));
  CHECK(out.verdict == RegistrationVerdict::unexplained);
  CHECK(warns(out, "times the noise of 1 mm"));
  CHECK(errorOf(body, out.measuredFromBody, truth) < 40.0);
}

TEST_CASE("An open body is accepted with a warning") {
  TriangleMesh body = organ();
  std::erase_if(body.triangles, [&](const Triangle &t) { return body.vertices[t[0]][2] < 120.0; });
  const Mat4 truth = someMotion(12);
  Measurement how;
  how.share = 0.4;
  how.towards = {0, 0, 1};
  const RigidRegistration out = registered(body, measure(body, how, truth));
  CHECK(out.verdict == RegistrationVerdict::found);
  CHECK(warns(out, "open"));
  CHECK(errorOf(body, out.measuredFromBody, truth) < 6.0);
}

TEST_CASE("A registration is the same for any number of threads") {
  const TriangleMesh body = organ(4);
  MeasuredSurface measured;
  Measurement how;
  how.outliers = 0.3;
  measured.points_mm = measure(body, how, someMotion(13));
  const auto one = registerRigid(body, measured, {});
  REQUIRE(one);
  for (const unsigned threads : {2u, 5u}) {
    ThreadPool pool(threads);
    const auto other = registerRigid(body, measured, {}, &pool);
    REQUIRE(other);
    CHECK(other->measuredFromBody == one->measuredFromBody);
    CHECK(other->after.distance_mm == one->after.distance_mm);
    CHECK(other->motionError_mm == one->motionError_mm);
    CHECK(other->candidates.size() == one->candidates.size());
  }
}

TEST_CASE("A registration reports its progress and can be cancelled") {
  const TriangleMesh body = organ(4);
  MeasuredSurface measured;
  measured.points_mm = measure(body, {}, kIdentity4);
  double last = -1.0;
  int calls = 0;
  REQUIRE(registerRigid(body, measured, {}, nullptr, [&](double fraction, const std::string &what) {
    CHECK(fraction >= last);
    CHECK_FALSE(what.empty());
    last = fraction;
    ++calls;
    return true;
  }));
  CHECK(calls >= 4);
  for (int stop = 1; stop <= calls; ++stop) {
    int call = 0;
    const auto out =
        registerRigid(body, measured, {}, nullptr, [&](double, const std::string &) { return ++call < stop; });
    REQUIRE_FALSE(out);
    CHECK(out.error().code == ErrorCode::cancelled);
  }
}

TEST_CASE("500 points on 20 000 triangles take about a second") {
  C3DE_DATA_OR_SKIP(path, "mesh/ssvtk_liver_patient/liver.vtk");
  const auto loaded = geometry::loadMesh(path, geometry::LengthUnit::millimetre);
  REQUIRE(loaded);
  ThreadPool pool(2);
  MeasuredSurface measured;
  const Mat4 truth = someMotion(14);
  measured.points_mm = measure(loaded->mesh, {}, truth);
  const auto begin = std::chrono::steady_clock::now();
  const auto out = registerRigid(loaded->mesh, measured, {}, &pool);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  REQUIRE(out);
  std::cout << loaded->mesh.triangles.size() << " triangles, 500 points, 2 threads: " << seconds << " s\n";
  CHECK(out->verdict == RegistrationVerdict::found);
  CHECK(errorOf(loaded->mesh, out->measuredFromBody, truth) < 4.0);
  // An idle machine needs 0.6 s; others may work on it.
  CHECK(seconds < 10.0);
}

TEST_CASE("Points of one organ are never found on another") {
  C3DE_DATA_OR_SKIP(folder, "mesh/openhelp");
  std::vector<TriangleMesh> organs;
  for (const char *file : {"Liver.stl", "Kidney_left.stl"}) {
    auto loaded = geometry::loadMesh(folder / file, geometry::LengthUnit::millimetre);
    REQUIRE(loaded);
    organs.push_back(std::move(loaded->mesh));
  }
  for (std::size_t body = 0; body < organs.size(); ++body)
    for (std::size_t other = 0; other < organs.size(); ++other)
      for (const double share : {1.0, 0.25}) {
        INFO("points of " << other << " on " << body << ", share " << share);
        Measurement how;
        how.share = share;
        const RigidRegistration out = registered(organs[body], measure(organs[other], how, someMotion(15)));
        CHECK((out.verdict == RegistrationVerdict::found) == (body == other));
        if (body != other) CHECK(out.verdict != RegistrationVerdict::unexplained);
      }
}

TEST_CASE("Residuals without a fit are those of the motion that is given") {
  const TriangleMesh sphere = ellipsoid({60, 60, 60});
  const auto out = registration::residualsOf(sphere, {{70, 0, 0}, {0, 57, 0}, {0, 0, -60}}, kIdentity4, 5.0);
  REQUIRE(out);
  CHECK_THAT(out->distance_mm[0], WithinAbs(10.0, 1e-6));
  CHECK_THAT(out->distance_mm[1], WithinAbs(3.0, 0.1));
  CHECK_THAT(out->rms_mm, WithinAbs(std::sqrt(4.5), 0.05));
  CHECK_THAT(out->inlierShare, WithinAbs(2.0 / 3.0, 1e-12));
  CHECK_THAT(registration::residualsOf(sphere, {}, kIdentity4, 5.0).error().message, Contains("no measured points"));
  std::vector<Vec3> metres = sphere.vertices;
  for (Vec3 &p : metres) p = 1e-3 * p;
  const auto inMetres = registration::residualsOf(sphere, metres, kIdentity4, 5.0);
  REQUIRE_FALSE(inMetres);
  CHECK_THAT(inMetres.error().message, Contains("if they are in metres, multiply them by 1000"));
}
