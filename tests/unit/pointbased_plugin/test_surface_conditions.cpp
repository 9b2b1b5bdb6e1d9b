// SPDX-License-Identifier: Apache-2.0
// Supports and loads on parts of surfaces: equal to those of a scene, undone, saved and repeated with the same bits.
#include <nlohmann/json.hpp>

#include "changed_simulation.h"

using namespace change_tests;

namespace {

const ObjectName kCube{"cube", 1};

/// The side of a box at the end of an axis; m.
SurfacePatch sideOf(const MeshData &mesh, int axis, double at_mm) {
  SurfacePatch out;
  for (const Vec3 &x : mesh.positions_mm) out.positions.push_back(1e-3 * x);
  for (const auto &t : mesh.triangles) {
    bool isThere = true;
    for (const std::uint32_t corner : t) isThere = isThere && std::abs(mesh.positions_mm[corner][axis] - at_mm) < 1e-6;
    if (isThere) out.triangles.push_back(t);
  }
  return out;
}

SurfaceCondition conditionOf(ConditionKind kind, const SurfacePatch &patch, const ObjectName &body = kCube) {
  SurfaceCondition out;
  out.name = std::string(nameOf(kind));
  out.body = body;
  out.kind = kind;
  out.patch = patch;
  return out;
}

const MeshData &cube() {
  static const MeshData mesh = boxMesh(Vec3::Constant(-50.0), Vec3::Constant(50.0));
  return mesh;
}

nlohmann::json reportOf(const c3de_simulator_v1 &sim, c3de_object *self) {
  std::string text;
  const auto put = [](void *to, const void *bytes, std::uint64_t n) -> c3de_status {
    static_cast<std::string *>(to)->append(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
    return C3DE_OK;
  };
  REQUIRE(sim.report(self, {&text, put}) == C3DE_OK);
  return nlohmann::json::parse(text);
}

Vec3 vectorOf(const nlohmann::json &numbers) {
  return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
}

/// A beam of 100 x 20 x 20 mm without gravity, with a probe at its tip.
class Beam {
 public:
  Beam(Host &host, const char *integrator, const std::vector<c3de_sim_fix> &fixes,
       const std::vector<c3de_sim_load> &loads)
      : host_(host), mesh(boxMesh(Vec3(0, 0, 0), Vec3(100, 20, 20), 5)) {
    const auto made = host.host->createObject("c3de.pointbased.WorldSimulator/1");
    REQUIRE(made);
    self = *made;
    sim = table<c3de_simulator_v1>(C3DE_IFACE_SIMULATOR_ID);
    changes = table<c3de_changes_v1>(C3DE_IFACE_CHANGES_ID);
    const std::array world{sdk::vec3Value("world.gravity", {0.0, 0.0, 0.0}), sdk::numberValue("solver.damping", 40.0),
                           sdk::choiceValue("solver.integrator", integrator)};
    check(sim->set_world(self, world.data(), world.size(), sizeof world[0]));
    const std::array values{sdk::numberValue(C3DE_PARAM_ID_YOUNGS_MODULUS, 5e4),
                            sdk::integerValue("sampling.count", 600)};
    c3de_sim_placement placement{};
    placement.size = sizeof placement;
    placement.scale = 1.0;
    c3de_sim_body body{};
    body.size = sizeof body;
    body.name = {"beam", 4};
    body.mesh = host.mesh(mesh);
    body.placement = &placement;
    body.params = values.data();
    body.params_n = values.size();
    body.params_stride = sizeof values[0];
    body.fixes = fixes.data();
    body.fixes_n = fixes.size();
    body.fixes_stride = sizeof(c3de_sim_fix);
    body.loads = loads.data();
    body.loads_n = loads.size();
    body.loads_stride = sizeof(c3de_sim_load);
    c3de_handle added{}, probe{};
    check(sim->add_body(self, &body, &added));
    const std::array<double, 3> tip{0.1, 0.01, 0.01};
    check(sim->add_probe(self, {"tip", 3}, added, tip.data(), &probe));
  }
  ~Beam() { self->vt->release(self); }
  Beam(const Beam &) = delete;
  Beam &operator=(const Beam &) = delete;

  void check(c3de_status status) const {
    INFO(host_.host->takeError());
    REQUIRE(status >= 0);
  }
  void set(std::uint64_t number, const std::optional<SurfaceCondition> &condition) const {
    SetSurfaceCondition made{number, condition};
    const std::string bytes = bytesOf(made);
    const c3de_sim_change change{sizeof change, 0,           sdk::str(SetSurfaceCondition::kId), {}, {}, 0,
                                 bytes.data(),  bytes.size()};
    check(changes->apply(self, &change));
  }
  void step(int n) const {
    for (int i = 0; i < n; ++i) check(sim->step(self));
  }
  [[nodiscard]] Vec3 tip() const {
    const nlohmann::json report = reportOf(*sim, self);
    return vectorOf(report["probes"][0]["position_m"]) - vectorOf(report["probes"][0]["reference_m"]);
  }
  [[nodiscard]] SurfaceCondition condition(ConditionKind kind, int axis, double at_mm) const {
    return conditionOf(kind, sideOf(mesh, axis, at_mm), {"beam", 1});
  }

 private:
  template <class Table>
  const Table *table(std::string_view id) {
    const void *found = nullptr;
    REQUIRE(self->vt->query(self, {id.data(), id.size()}, 1, &found) == C3DE_OK);
    return static_cast<const Table *>(found);
  }
  Host &host_;

 public:
  MeshData mesh;
  c3de_object *self = nullptr;
  const c3de_simulator_v1 *sim = nullptr;
  const c3de_changes_v1 *changes = nullptr;
};

constexpr double kPressure = 60.0;  // Pa, on the upper side: the tip moves by several mm

c3de_sim_region halfSpace(const Vec3 &point, const Vec3 &normal) {
  c3de_sim_region region{};
  region.size = sizeof region;
  region.kind = C3DE_SIM_REGION_HALF_SPACE;
  for (int k = 0; k < 3; ++k) {
    region.a[k] = point[k];
    region.b[k] = normal[k];
  }
  return region;
}

/// Displacement of the tip with support and pressure of a scene, and with those set on the surface.
std::pair<Vec3, Vec3> tipsOf(Host &host, const char *integrator, int steps) {
  const c3de_sim_region end = halfSpace(Vec3(1e-6, 0, 0), Vec3(1, 0, 0)),
                        top = halfSpace(Vec3(0, 0, 0.02 - 1e-6), Vec3(0, 0, -1));
  c3de_sim_fix fix{};
  fix.size = sizeof fix;
  fix.region = &end;
  c3de_sim_load load{};
  load.size = sizeof load;
  load.flags = C3DE_SIM_LOAD_PRESSURE;
  load.region = &top;
  load.pressure_Pa = kPressure;
  const Beam scene(host, integrator, {fix}, {load});
  scene.step(steps);
  const Beam hand(host, integrator, {}, {});
  hand.set(1, hand.condition(ConditionKind::fix, 0, 0.0));
  SurfaceCondition pressure = hand.condition(ConditionKind::pressure, 2, 20.0);
  pressure.pressure = kPressure;
  hand.set(2, pressure);
  hand.step(steps);
  return {scene.tip(), hand.tip()};
}

}  // namespace

TEST_CASE("A cantilever fixed and pressed on its surface bends as one of a scene", "[conditions]") {
  Host host;
  const auto [integrator, steps] = GENERATE(std::pair{"quasistatic", 30}, std::pair{"implicit", 250});
  const auto [scene, hand] = tipsOf(host, integrator, steps);
  INFO(integrator << ": scene " << scene.transpose() << ", surface " << hand.transpose());
  CHECK(scene[2] < -1e-3);
  // The scene holds phyxels of the end themselves, the surface holds the means of its patches, which yield a little.
  CHECK((hand - scene).norm() < 0.03 * scene.norm());
}

TEST_CASE("Forces on a surface have the sum that was set, and supports balance them", "[conditions]") {
  Host host;
  const Beam beam(host, "implicit", {}, {});
  beam.set(1, beam.condition(ConditionKind::fix, 0, 0.0));
  SurfaceCondition force = beam.condition(ConditionKind::force, 0, 100.0);
  force.vector = Vec3(0.01, -0.02, -0.005);
  beam.set(2, force);
  beam.step(300);
  const nlohmann::json rows = reportOf(*beam.sim, beam.self)["conditions"];
  REQUIRE(rows.size() == 2);
  CHECK(rows[0]["kind"] == "fix");
  CHECK((vectorOf(rows[1]["force_N"]) - force.vector).norm() < 1e-12);
  CHECK(std::abs(rows[1]["area_m2"].get<double>() - 4e-4) < 1e-12);
  // At rest after 300 steps; what still moves is below a hundredth.
  CHECK((vectorOf(rows[0]["force_N"]) + force.vector).norm() < 0.01 * force.vector.norm());
}

TEST_CASE("A following pressure of a quasi-static solution is that of the final shape", "[conditions]") {
  Host host;
  const Beam beam(host, "quasistatic", {}, {});
  beam.set(1, beam.condition(ConditionKind::fix, 0, 0.0));
  SurfaceCondition pressure = beam.condition(ConditionKind::pressure, 0, 100.0);
  pressure.pressure = -5e3;  // Pa, a tenth of Young's modulus: the loaded side shrinks by several per cent
  beam.set(2, pressure);
  beam.step(40);
  const nlohmann::json rows = reportOf(*beam.sim, beam.self)["conditions"];
  REQUIRE(rows.size() == 2);
  const double load_N = vectorOf(rows[1]["force_N"])[0], nominal_N = 5e3 * 4e-4;
  INFO("load " << load_N << " N, support " << rows[0]["force_N"]);
  CHECK(load_N < 0.96 * nominal_N);
  // The difference that ends the repetitions, and the tolerance of the solution.
  CHECK(std::abs(vectorOf(rows[0]["force_N"])[0] + load_N) < 3e-4 * load_N);
}

TEST_CASE("A surface is displaced over its time, and a support holds it where it then is", "[conditions]") {
  Host host;
  const Beam beam(host, "implicit", {}, {});
  beam.set(1, beam.condition(ConditionKind::fix, 0, 0.0));
  SurfaceCondition moved = beam.condition(ConditionKind::displace, 0, 100.0);
  moved.vector = Vec3(0.002, 0.0, 0.0);
  moved.ramp = 0.05;
  beam.set(2, moved);
  beam.step(1);
  CHECK(beam.tip().norm() < 0.001);  // not a jump
  beam.step(250);
  // Patches yield by a fraction of a spacing under the stress of the stretched beam.
  CHECK((beam.tip() - moved.vector).norm() < 0.05 * moved.vector.norm());
  const Vec3 before = beam.tip();
  beam.set(2, std::nullopt);
  beam.set(2, beam.condition(ConditionKind::fix, 0, 100.0));
  beam.step(100);
  CHECK((beam.tip() - before).norm() < 0.1 * before.norm());
  beam.set(2, std::nullopt);
  beam.step(300);
  CHECK(beam.tip().norm() < 0.05 * before.norm());
  // A reset keeps conditions: the body is held in its initial state.
  SurfaceCondition force = beam.condition(ConditionKind::force, 0, 100.0);
  force.vector = Vec3(0.0, 0.0, -0.01);
  beam.set(3, force);
  beam.check(beam.sim->reset(beam.self));
  CHECK(beam.tip().norm() == 0.0);
  beam.step(100);
  CHECK(beam.tip()[2] < -1e-4);
}

TEST_CASE("Supports and loads on surfaces are repeated, saved and undone with the same bits", "[conditions][changes]") {
  Host host;
  Simulation first(host);
  first.step(3);
  const Recorded fixed = first.make(SetSurfaceCondition{0, conditionOf(ConditionKind::fix, sideOf(cube(), 2, 50.0))});
  CHECK(fixed.flags == 0);
  CHECK(fixed.text == "set fix");
  CHECK_THAT(fixed.key, Catch::Matchers::StartsWith("1\n"));
  first.step(3);
  SurfaceCondition force = conditionOf(ConditionKind::force, sideOf(cube(), 0, 50.0));
  force.vector = Vec3(0.3, 0.0, 0.0);
  force.ramp = 0.01;
  first.make(SetSurfaceCondition{2, force});
  first.step(3);
  force.vector *= -2.0;
  first.make(SetSurfaceCondition{2, force});
  SurfaceCondition moved = conditionOf(ConditionKind::displace, sideOf(cube(), 1, 50.0));
  moved.vector = Vec3(0.0, 0.004, 0.0);
  moved.ramp = 0.02;
  first.make(SetSurfaceCondition{3, moved});
  first.step(4);
  // What is undone leaves no trace in the list of what is saved.
  SurfaceCondition pressure = conditionOf(ConditionKind::pressure, sideOf(cube(), 0, -50.0));
  pressure.pressure = 100.0;
  first.make(SetSurfaceCondition{4, pressure});
  CHECK(first.make(SetSurfaceCondition{4, std::nullopt}).text == "remove support or load 4");
  first.step(3);

  const std::string state = first.save();
  first.record.back().hashAfter = first.hash();
  Simulation second(host);
  for (const Recorded &change : std::vector(first.record)) second.repeat(change);
  while (second.steps() < first.steps()) second.step();
  CHECK(second.hash() == first.hash());

  Simulation third(host);
  std::map<std::string, Recorded> last;
  for (const Recorded &change : first.record)
    if (change.isLasting()) last.insert_or_assign(change.key, change);
  for (const auto &[key, change] : last) CHECK(third.tryApply(change.id, change.bytes) == C3DE_OK);
  third.check(third.sim->load_state(third.self, state.data(), state.size()));
  CHECK(third.hash() == first.hash());
  for (int i = 0; i < 5; ++i) {
    first.step();
    third.step();
    CHECK(third.hash() == first.hash());
  }
}

TEST_CASE("Supports and loads that are not possible are refused with the reason", "[conditions]") {
  Host host;
  Simulation simulation(host);
  const std::uint64_t before = simulation.hash();
  const auto refused = [&](const SurfaceCondition &condition, const std::string &reason) {
    SetSurfaceCondition change{0, condition};
    CHECK(simulation.tryApply(SetSurfaceCondition::kId, bytesOf(change)) < 0);
    CHECK_THAT(simulation.error, Catch::Matchers::Contains(reason));
  };
  refused(conditionOf(ConditionKind::fix, {}), "the selection is empty");
  SurfaceCondition force = conditionOf(ConditionKind::force, sideOf(cube(), 0, 50.0));
  force.vector = Vec3(2e5, 0.0, 0.0);
  refused(force, "accepted: up to");
  force.vector[0] = std::numeric_limits<double>::quiet_NaN();
  refused(force, "not a number");
  SurfaceCondition away = conditionOf(ConditionKind::fix, sideOf(cube(), 0, 50.0));
  for (Vec3 &x : away.patch.positions) x[0] += 0.1;
  refused(away, "is not on body 'cube'");
  away.body.name = "sphere";
  refused(away, "sphere");
  SurfaceCondition late = conditionOf(ConditionKind::displace, sideOf(cube(), 0, 50.0));
  late.ramp = -1.0;
  refused(late, "the time is -1 s");
  CHECK(simulation.record.empty());
  CHECK(simulation.hash() == before);
  simulation.make(SetSurfaceCondition{0, conditionOf(ConditionKind::fix, sideOf(cube(), 0, 50.0))});
  late.ramp = 1.0;
  refused(late, "accepted: supports without common surface");
}

TEST_CASE("A load wakes a body that sleeps, and a body without it returns", "[conditions]") {
  Host host;
  const Beam beam(host, "implicit", {}, {});
  beam.set(1, beam.condition(ConditionKind::fix, 0, 0.0));
  const auto isAsleep = [&] { return reportOf(*beam.sim, beam.self)["bodies"][0]["asleep"].get<bool>(); };
  for (int i = 0; i < 50 && !isAsleep(); ++i) beam.step(20);
  REQUIRE(isAsleep());
  SurfaceCondition force = beam.condition(ConditionKind::force, 0, 100.0);
  force.vector = Vec3(0.0, 0.0, -0.01);
  beam.set(2, force);
  beam.step(200);
  const double bent = beam.tip()[2];
  CHECK(bent < -1e-4);
  beam.set(2, std::nullopt);
  beam.step(300);
  CHECK(std::abs(beam.tip()[2]) < 0.05 * std::abs(bent));
}
