// SPDX-License-Identifier: Apache-2.0
// A body matched to points of its deformed surface: the state, its forces, and what is refused.
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "c3de/abi/iface/matching.h"
#include "changed_simulation.h"

using namespace change_tests;

namespace {

using Json = nlohmann::json;

/// Points of two sides of the cube at rest, m, 25 of each, and of the bottom.
std::vector<Vec3> sidePoints() {
  std::vector<Vec3> out;
  for (const double sign : {-1.0, 1.0})
    for (int i = -2; i <= 2; ++i)
      for (int k = -2; k <= 2; ++k) {
        out.emplace_back(0.02 * i, 0.02 * k, sign * 0.05);
        if (sign > 0.0) out.emplace_back(0.05, 0.02 * i, 0.02 * k);
      }
  return out;
}

/// A simulation without gravity whose second cube is removed, so that points belong to one body.
class Cube : public Simulation {
 public:
  explicit Cube(Host &host, const char *integrator = "quasistatic") : Simulation(host), host_(host) {
    const std::array world{sdk::vec3Value("world.gravity", {0.0, 0.0, 0.0}),
                           sdk::choiceValue("solver.integrator", integrator)};
    check(sim->set_world(self, world.data(), world.size(), sizeof world[0]));
    check(sim->remove(self, plate));
    check(sim->remove(self, bodies[1]));
    int number = 0;
    for (const Vec3 &point : sidePoints()) {
      const std::string name = "side " + std::to_string(++number);
      c3de_handle probe{};
      check(sim->add_probe(self, sdk::str(name), bodies[0], point.data(), &probe));
    }
    matching = table<c3de_matching_v0>(C3DE_IFACE_MATCHING_ID);
    record.clear();
  }
  /// Present positions of sidePoints(), m.
  [[nodiscard]] std::vector<Vec3> sides() const {
    std::vector<Vec3> out;
    const auto each = [](void *to, const c3de_sim_probe *probe) -> c3de_status {
      static_cast<std::vector<Vec3> *>(to)->emplace_back(probe->position_m);
      return C3DE_OK;
    };
    check(sim->enum_probes(self, &out, each));
    return out;
  }
  c3de_status match(const std::vector<Vec3> &points, double noise_m, c3de_match_result &out, Json *details = nullptr,
                    const std::vector<c3de_match_landmark> &landmarks = {}, double support_Pa_m = 1e5,
                    std::uint32_t flags = 0, const c3de_progress *progress = nullptr) {
    c3de_match_request request{};
    request.size = sizeof request;
    request.flags = C3DE_MATCH_MOTION_KNOWN | flags;
    request.body = bodies[0];
    request.points_m = points.empty() ? nullptr : points.front().data();
    request.points_n = points.size();
    request.landmarks = landmarks.data();
    request.landmarks_n = landmarks.size();
    request.landmarks_stride = sizeof(c3de_match_landmark);
    for (int a = 0; a < 3; ++a) request.motion.rotation[4 * a] = 1.0;
    request.noise_m = noise_m;
    request.support_Pa_m = support_Pa_m;
    out = {};
    out.size = sizeof out;
    std::string text;
    const auto put = [](void *to, const void *bytes, std::uint64_t n) -> c3de_status {
      static_cast<std::string *>(to)->append(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
      return C3DE_OK;
    };
    const c3de_status status = matching->match(self, &request, progress, &out, {&text, put});
    error = host_.host->takeError();
    if (details && status >= 0) *details = Json::parse(text);
    return status;
  }

  const c3de_matching_v0 *matching = nullptr;

 private:
  Host &host_;
};

/// The sides of a cube that a force has bent, m.
std::vector<Vec3> bentSides(Host &host) {
  Cube truth(host);
  SurfaceCondition held, force;
  held.name = "held";
  held.body = force.body = {"cube", 1};
  const MeshData mesh = boxMesh(Vec3::Constant(-50.0), Vec3::Constant(50.0));
  for (const Vec3 &x : mesh.positions_mm) {
    held.patch.positions.push_back(1e-3 * x);
    force.patch.positions.push_back(1e-3 * x);
  }
  for (const auto &t : mesh.triangles) {
    const auto isOn = [&](double z) {
      return std::all_of(t.begin(), t.end(), [&](std::uint32_t c) { return mesh.positions_mm[c][2] == z; });
    };
    if (isOn(-50.0)) held.patch.triangles.push_back(t);
    if (isOn(50.0)) force.patch.triangles.push_back(t);
  }
  held.kind = ConditionKind::fix;
  force.kind = ConditionKind::force;
  force.name = "force";
  force.vector = Vec3(0.0, 2.0, 6.0);
  truth.make(SetSurfaceCondition{1, held});
  truth.make(SetSurfaceCondition{2, force});
  truth.step(30);
  return truth.sides();
}

double rootMeanSquare(const std::vector<Vec3> &a, const std::vector<Vec3> &b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace

TEST_CASE("A body matched to points of its deformed surface meets them and stays there", "[matching]") {
  Host host;
  const std::vector<Vec3> target = bentSides(host);
  const double bent = rootMeanSquare(target, sidePoints());
  REQUIRE(bent > 2e-3);
  const char *integrator = GENERATE("quasistatic", "implicit");
  Cube cube(host, integrator);
  c3de_match_result result{};
  Json details;
  // Plane sides do not show what slides along them: every fifth point is a landmark as well.
  std::vector<c3de_match_landmark> landmarks;
  for (std::size_t i = 0; i < target.size(); i += 5) {
    c3de_match_landmark &one = landmarks.emplace_back();
    one.size = sizeof one;
    for (int a = 0; a < 3; ++a) {
      one.reference_m[a] = sidePoints()[i][a];
      one.measured_m[a] = target[i][a];
    }
  }
  const c3de_status status = cube.match(target, 2e-4, result, &details, landmarks);
  INFO(cube.error);
  REQUIRE(status == C3DE_OK);
  INFO("distances, mm: " << 1e3 * result.before_m << ", rigid " << 1e3 * result.rigid_m << ", after "
                         << 1e3 * result.after_m);
  CHECK((result.flags & C3DE_MATCH_CONVERGED) != 0);
  CHECK(result.after_m < 0.25 * result.rigid_m);
  CHECK(result.force_N > 1.0);
  CHECK(details["points"].size() == target.size());
  CHECK(details["landmarks"].size() == landmarks.size());
  INFO(details["landmarks"].dump());
  // Nothing held the cube: it is given surroundings.
  REQUIRE(cube.record.size() == 3);
  CHECK(cube.record[0].id == "body.parameter");
  CHECK(cube.record[2].id == "match.set");
  // It continues in equilibrium with the forces that were found.
  const std::vector<Vec3> matched = cube.sides();
  // Half of it: on the side that moves by twenty standard deviations some points between landmarks count as false.
  CHECK(rootMeanSquare(matched, target) < 0.55 * bent);
  cube.step(40);
  const double drift = rootMeanSquare(cube.sides(), matched);
  INFO("drift " << 1e3 * drift << " mm");
  CHECK(drift < 2e-4);

  // Saved and loaded with the forces; a reset removes them.
  const std::string state = cube.save();
  Cube second(host, integrator);
  for (const Recorded &change : std::vector(cube.record))
    if (change.isLasting()) CHECK(second.tryApply(change.id, change.bytes) == C3DE_OK);
  second.check(second.sim->load_state(second.self, state.data(), state.size()));
  CHECK(second.hash() == cube.hash());
  cube.step(3);
  second.step(3);
  CHECK(second.hash() == cube.hash());
  cube.reset();
  cube.step(20);
  CHECK(rootMeanSquare(cube.sides(), sidePoints()) < 1e-6);
}

namespace {

/// Observes the shape of a cube while it is matched.
struct Observer {
  const Cube &cube;
  std::vector<Vec3> before;
  double largestChange_m = 0.0;  ///< of the sides, root mean square
  double cancelledAt_m = 1.0;    ///< change from which the match is cancelled
  bool isSaved = false;          ///< the state is saved at a change, and its hash is read at another one
  std::uint64_t hash = 0;
  std::string saved;
  std::string loaded;  ///< state that is loaded at the first change, which cancels the match
  c3de_progress progress{sizeof progress, 0, this, &update};

  static c3de_status update(void *self, double, c3de_str) {
    auto &of = *static_cast<Observer *>(self);
    const double change = rootMeanSquare(of.cube.sides(), of.before);
    of.largestChange_m = std::max(of.largestChange_m, change);
    if (change > 1e-3 && !of.loaded.empty()) {
      of.cube.check(of.cube.sim->load_state(of.cube.self, of.loaded.data(), of.loaded.size()));
      of.loaded.clear();
      return C3DE_E_CANCELLED;
    }
    // Each of them hides the shape until the next iteration.
    if (of.isSaved && change > 1e-3) {
      if (of.saved.empty())
        of.saved = of.cube.save();
      else if (of.hash == 0)
        of.hash = of.cube.hash();
    }
    return change > of.cancelledAt_m ? C3DE_E_CANCELLED : C3DE_OK;
  }
};

}  // namespace

TEST_CASE("The iterations of a match are shown, and its state is restored", "[matching]") {
  Host host;
  const std::vector<Vec3> target = bentSides(host);
  Cube control(host, "explicit"), cube(host, "explicit");
  for (Cube *one : {&control, &cube}) one->step(5);
  const std::uint64_t before = cube.hash();
  REQUIRE(before == control.hash());
  c3de_match_result result{};
  const auto match = [&](Observer &observer, std::uint32_t flags) {
    return cube.match(target, 2e-4, result, nullptr, {}, 1e5, flags, &observer.progress);
  };
  Observer hidden{cube, cube.sides()};
  hidden.cancelledAt_m = 0.0;
  SECTION("cancelled") {
    Observer shown{cube, cube.sides()};
    shown.cancelledAt_m = 1e-3;
    CHECK(match(shown, C3DE_MATCH_SHOW) == C3DE_E_CANCELLED);
    CHECK(shown.largestChange_m > 1e-3);
    CHECK(rootMeanSquare(cube.sides(), shown.before) == 0.0);
    CHECK(cube.hash() == before);
    for (Cube *one : {&control, &cube}) one->step(5);
    CHECK(cube.hash() == control.hash());
  }
  SECTION("saved meanwhile") {
    Observer shown{cube, cube.sides()};
    shown.isSaved = true;
    REQUIRE(match(shown, C3DE_MATCH_SHOW) == C3DE_OK);
    CHECK(shown.hash == before);
    CHECK(shown.saved == control.save());
    CHECK(rootMeanSquare(cube.sides(), shown.before) > 1e-3);
  }
  SECTION("another state is loaded meanwhile") {
    const std::array gravity{sdk::vec3Value("world.gravity", {0.0, 0.0, -1.0})};
    for (Cube *one : {&control, &cube})
      one->check(one->sim->set_world(one->self, gravity.data(), 1, sizeof gravity[0]));
    control.step(20);  // it has fallen a little
    Observer shown{cube, cube.sides()};
    shown.loaded = control.save();
    CHECK(match(shown, C3DE_MATCH_SHOW) == C3DE_E_CANCELLED);
    CHECK(shown.loaded.empty());
    CHECK(rootMeanSquare(cube.sides(), shown.before) > 0.0);
    CHECK(cube.hash() == control.hash());
  }
  SECTION("not requested") {
    REQUIRE(match(hidden, 0) == C3DE_OK);
    CHECK(hidden.largestChange_m == 0.0);
  }
}

TEST_CASE("A matched state is repeated with the same bits", "[matching][changes]") {
  Host host;
  Cube first(host, "implicit");
  first.step(2);
  c3de_match_result result{};
  REQUIRE(first.match(bentSides(host), 2e-4, result) == C3DE_OK);
  Cube second(host, "implicit");
  second.step(2);
  for (const Recorded &change : std::vector(first.record)) CHECK(second.tryApply(change.id, change.bytes) == C3DE_OK);
  CHECK(second.hash() == first.hash());
  first.step(5);
  second.step(5);
  CHECK(second.hash() == first.hash());
}

TEST_CASE("Matches that are not possible are refused with the reason, and nothing changes", "[matching]") {
  Host host;
  Cube cube(host);
  const std::uint64_t before = cube.hash();
  c3de_match_result result{};
  CHECK(cube.match({}, 1e-3, result) < 0);
  CHECK(cube.error != "");
  std::vector<Vec3> points = sidePoints();
  CHECK(cube.match(points, 0.0, result) < 0);
  CHECK(cube.error != "");
  CHECK(cube.match(points, 1e-3, result, nullptr, {}, 0.0) == C3DE_E_STATE);
  CHECK_THAT(cube.error, Catch::Matchers::Contains("nothing holds the body"));
  points[3][1] = std::numeric_limits<double>::quiet_NaN();
  CHECK(cube.match(points, 1e-3, result) < 0);
  CHECK(cube.error != "");
  cube.check(cube.sim->remove(cube.self, cube.bodies[0]));
  CHECK(cube.match(sidePoints(), 1e-3, result) == C3DE_E_STALE);
  CHECK(cube.hash() != before);  // the body is gone
}
