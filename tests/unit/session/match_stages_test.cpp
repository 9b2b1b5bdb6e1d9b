// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/match_stages.h"

#include "box_mesh.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using c3de::test::cubeBody;
using c3de::test::RecordingSimulator;

namespace {

Mat4 shift(const Vec3 &by) {
  Mat4 out = kIdentity4;
  for (std::size_t a = 0; a < 3; ++a) out[12 + a] = by[a];
  return out;
}

/// Points 5 and 40 mm outside of a face of the box, moved by 10 mm along x.
MatchTargets shiftedTargets() {
  MatchTargets targets;
  targets.file = "points.csv";
  targets.surface.points_mm = {{115, 50, 50}, {150, 50, 50}};
  return targets;
}

/// Two candidates: that motion, and one that moves the box by 15 mm.
RigidMatch twoCandidates() {
  RigidMatch match;
  match.rigid.verdict = registration::RegistrationVerdict::ambiguous;
  match.rigid.measuredFromBody = shift({10, 0, 0});
  match.rigid.candidates = {{shift({10, 0, 0}), 5.0, 0.5}, {shift({15, 0, 0}), 0.0, 0.5}};
  match.rigid.after.limit_mm = 6.0;
  match.rigid.before.distance_mm = {15.0, 50.0};
  match.rigid.after.distance_mm = {5.0, 40.0};
  match.landmarks = {{"corner", false, {0, 0, 0}, {10, 0, 0}, {15, 0, 0}}};
  return match;
}

}  // namespace

TEST_CASE("The skin at rest is the present one without its displacement") {
  RecordingSimulator simulator;
  simulator.bodies = {cubeBody(0.1, {0, 0, 0}, {1, 0, 0})};
  simulator.bodies[0].name = "liver";
  CHECK(simulatedBodies(simulator.object()) == std::vector<std::string>{"liver"});
  const auto skins = skinsOf(simulator.object(), "liver", {});
  REQUIRE(skins);
  CHECK(norm(skins->present.vertices.back() - Vec3{1100, 100, 100}) < 1e-9);
  CHECK(norm(skins->rest.vertices.back() - Vec3{100, 100, 100}) < 1e-9);
  CHECK(skins->rest.triangles == skins->present.triangles);
  const auto missing = skinsOf(simulator.object(), "spleen", {});
  REQUIRE_FALSE(missing);
  CHECK_THAT(missing.error().message, Contains("'spleen'"));
}

TEST_CASE("Measured points are placed in the space of the body, and outliers are marked") {
  const auto box = session::test::boxMesh({0, 0, 0}, {100, 100, 100});
  const RigidMatch rigid = twoCandidates();
  const auto points = matchedPoints(box, shiftedTargets(), rigid, {}, rigid.rigid.measuredFromBody);
  REQUIRE(points);
  REQUIRE(points->size() == 2);
  CHECK(norm((*points)[0].measured_mm - Vec3{105, 50, 50}) < 1e-9);
  CHECK(norm((*points)[0].surface_mm - Vec3{100, 50, 50}) < 1e-9);
  CHECK_THAT((*points)[0].distance_mm(), WithinAbs(5.0, 1e-9));
  CHECK((*points)[0].isUsed);
  CHECK_FALSE((*points)[1].isUsed);
  // After a deformation its weights decide.
  ElasticMatch elastic;
  elastic.body.emplace();
  elastic.body->weights = {0.1, 0.9};
  const auto deformed = matchedPoints(box, shiftedTargets(), rigid, elastic, rigid.rigid.measuredFromBody);
  REQUIRE(deformed);
  CHECK_FALSE((*deformed)[0].isUsed);
  CHECK((*deformed)[1].isUsed);
}

TEST_CASE("Another candidate replaces the motion and what depends on it, and the verdict stays") {
  const auto box = session::test::boxMesh({0, 0, 0}, {100, 100, 100});
  const auto chosen = withCandidate(twoCandidates(), 1, box, shiftedTargets(), nullptr);
  REQUIRE(chosen);
  CHECK(chosen->rigid.measuredFromBody == shift({15, 0, 0}));
  CHECK_THAT(chosen->rigid.after.distance_mm[0], WithinAbs(0.0, 1e-9));
  CHECK(verdictOf(*chosen) == "ambiguous");
  CHECK(chosen->landmarks[0].errorRigid_mm() < 1e-9);
  REQUIRE(chosen->after);
  CHECK(chosen->after->max_mm < 1e-9);
  const auto missing = withCandidate(twoCandidates(), 2, box, shiftedTargets(), nullptr);
  REQUIRE_FALSE(missing);
  CHECK_THAT(missing.error().message, Contains("candidate 3") && Contains("1 … 2"));
}

TEST_CASE("The label of a match is a number or a name") {
  scene::SceneMatch match;
  REQUIRE(setMatchLabel("7", match));
  CHECK(match.labels.label == std::uint16_t{7});
  REQUIRE(setMatchLabel("7th segment", match));
  CHECK_FALSE(match.labels.label);
  CHECK(match.labels.labelName == "7th segment");
  CHECK_FALSE(setMatchLabel("70000", match));
}

TEST_CASE("The expected error of a deformation is a lower bound where points hardly determine the body") {
  ElasticMatch elastic;
  elastic.body.emplace().error.emplace(BodyMatch::ExpectedError{2.3, 4.0, 0.1});
  const auto lineOf = [&elastic] {
    std::string out;
    for (const std::string &line : matchLines({}, elastic))
      if (line.find("expected error of the deformation") != std::string::npos) out = line;
    return out;
  };
  CHECK_THAT(lineOf(), Contains("deformation: 2.3 mm"));
  elastic.body->error->unknownPart = 0.3;
  CHECK_THAT(lineOf(), Contains("deformation: at least 2.3 mm"));
}

TEST_CASE("Distances above the noise, few points used and an unknown error are warnings of the deformation") {
  ElasticMatch elastic;
  BodyMatch &body = elastic.body.emplace();
  body.hasConverged = true;
  body.usedPart = 1.0;
  body.noise_mm = 0.5;
  body.error.emplace(BodyMatch::ExpectedError{2.3, 4.0, 0.1});
  body.after_mm = 0.6;
  CHECK(warningsOf(elastic).empty());
  body.after_mm = 4.0;
  REQUIRE(warningsOf(elastic).size() == 1);
  CHECK_THAT(warningsOf(elastic).front(), Contains("distances of 4 mm") && Contains("a noise of 0.5 mm"));
  body.after_mm = 0.6;
  body.usedPart = 0.5;
  REQUIRE(warningsOf(elastic).size() == 1);
  CHECK_THAT(warningsOf(elastic).front(), Contains("the deformation uses 50 % of the points"));
  body.usedPart = 1.0;
  body.error.reset();
  REQUIRE(warningsOf(elastic).size() == 1);
  CHECK_THAT(warningsOf(elastic).front(), Contains("the error of the deformation is not known"));
}
