// SPDX-License-Identifier: Apache-2.0
// Changes of a simulation as data: reported, repeated with the same bits, and refused when malformed.
#include <cmath>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

#include "changed_simulation.h"

using namespace change_tests;

namespace {

const ObjectName kFirst{"cube", 1}, kSecond{"cube", 2}, kPlate{"plate", 1};

Grab smallGrab(const Vec3 &target) {
  Grab grab;
  grab.phyxels = {3, 4, 5};
  grab.weights = {0.5, 0.25, 0.25};
  grab.target = target;
  grab.maxForce = 5.0;
  return grab;
}

/// On the upper side of the first cube.
BeginGrasp smallGrasp() {
  const MeshData mesh = boxMesh(Vec3::Constant(-50.0), Vec3::Constant(50.0));
  Surface skin;
  for (const Vec3 &x : mesh.positions_mm) skin.positions.push_back(1e-3 * x);
  for (const auto &t : mesh.triangles) skin.triangles.push_back({t[0], t[1], t[2]});
  GraspSettings settings;
  settings.jaw = 0.02;
  settings.opening = 0.06;
  settings.closed = 0.05;
  const auto places = findJaws(skin, Vec3(0.002, 0.003, 0.05), Vec3::UnitZ(), Vec3::UnitX(), settings);
  REQUIRE(places);
  return {kFirst, *places, settings};
}

AddObstacle implant(const std::string &name, const Vec3 &at = Vec3(0.0, 0.0, 0.2)) {
  AddObstacle out;
  out.name = name;
  out.mesh = boxMesh(Vec3::Constant(-10.0), Vec3::Constant(10.0), 1);
  out.placement.position = at;
  out.placement.rotation = Eigen::AngleAxisd(0.3, Vec3::UnitY()).toRotationMatrix();
  out.friction = 0.2;
  return out;
}

RigidMotion motion(const Vec3 &displacement, double angle = 0.0) {
  return {Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix(), Vec3(0.0, 0.0, 0.2), displacement};
}

RebuildBody rebuilt(const ObjectName &body, std::int64_t count, const char *adaptive = "auto") {
  return {body,
          {ParameterEntry(sdk::numberValue(C3DE_PARAM_ID_YOUNGS_MODULUS, 1.5e4)),
           ParameterEntry(sdk::integerValue("sampling.count", count)),
           ParameterEntry(sdk::choiceValue("sampling.adaptive", adaptive))}};
}

LoadBody loaded(const std::string &name, const Vec3 &at, std::optional<ObjectName> replaced) {
  LoadBody out;
  out.name = name;
  out.mesh = boxMesh(Vec3::Constant(-30.0), Vec3::Constant(30.0));
  out.placement.position = at;
  out.values = {ParameterEntry(sdk::integerValue("sampling.count", 40))};
  out.replaced = std::move(replaced);
  return out;
}

SetWorldParameters world(const c3de_param_value &value) { return {{ParameterEntry(value)}}; }
SetBodyParameter material(const ObjectName &body, double youngsModulus) {
  return {body, ParameterEntry(sdk::numberValue(C3DE_PARAM_ID_YOUNGS_MODULUS, youngsModulus))};
}
RemoveObject removed(RemoveObject::What what, const ObjectName &name, std::uint64_t number = 0) {
  return {what, name, number};
}

/// Repeats everything that was recorded, and some steps after it.
void checkRepeated(Host &host, Simulation &first) {
  Simulation second(host);
  const std::vector<Recorded> all = first.record;
  for (const Recorded &change : all) second.repeat(change);
  CHECK(second.record.size() == all.size());
  for (std::size_t i = 0; i < all.size() && i < second.record.size(); ++i) {
    INFO(all[i].id);
    CHECK(second.record[i].bytes == all[i].bytes);
    CHECK(second.record[i].key == all[i].key);
    CHECK(second.record[i].flags == all[i].flags);
  }
  while (second.steps() < first.steps()) second.step();
  for (int i = 0; i < 5; ++i) {
    first.step();
    second.step();
    CHECK(first.hash() == second.hash());
  }
}

/// The lasting ones, without those that are superfluous.
std::vector<Recorded> lastingOf(const std::vector<Recorded> &all) {
  std::vector<Recorded> out;
  for (const Recorded &change : all) {
    if (!change.isLasting()) continue;
    if (!change.key.empty())
      std::erase_if(out, [&](const Recorded &other) { return other.id == change.id && other.key == change.key; });
    out.push_back(change);
  }
  return out;
}

void checkLasting(Host &host, Simulation &first) {
  const std::string state = first.save();
  Simulation second(host);
  for (const Recorded &change : lastingOf(first.record)) {
    INFO(change.id << ": " << change.text);
    CHECK(second.tryApply(change.id, change.bytes) == C3DE_OK);
    CHECK(second.error == "");
  }
  second.check(second.sim->load_state(second.self, state.data(), state.size()));
  CHECK(second.hash() == first.hash());
  for (int i = 0; i < 5; ++i) {
    first.step();
    second.step();
    CHECK(first.hash() == second.hash());
  }
}

std::size_t phyxelsOfCube() {
  Host host;
  Simulation simulation(host);
  c3de_sim_points points{};
  points.size = sizeof points;
  simulation.check(simulation.sim->points(simulation.self, simulation.bodies[0], &points));
  return static_cast<std::size_t>(points.count);
}

/// One valid change of each kind, in an order in which they can be applied.
std::vector<std::pair<std::string, std::string>> oneOfEach() {
  std::vector<std::pair<std::string, std::string>> all;
  const auto add = [&all](auto change) { all.emplace_back(decltype(change)::kId, bytesOf(change)); };
  add(StoreState());
  add(world(sdk::vec3Value("world.gravity", {0.0, 0.0, -5.0})));
  add(material(kFirst, 1e4));
  add(implant("plug"));
  add(MoveObstacle{{"plug", 1}, motion(Vec3(0.01, 0.0, 0.0))});
  add(removed(RemoveObject::What::obstacle, {"plug", 1}));
  add(RestoreObstacle{{"plug", 1}});
  add(PlaceInstrument{0.01, 0.05, 0.3, Vec3(0.0, 0.0, 0.15), Vec3::UnitZ()});
  add(MoveInstrument{Vec3(0.0, 0.0, 0.14)});
  add(RemoveInstrument());
  add(smallGrasp());
  add(MoveGrasp{Vec3(0.0, 0.0, 0.06)});
  add(ReleaseGrasp());
  add(BeginPinch{kFirst, smallGrab(Vec3(0.0, 0.0, 0.07)), 1.0});
  add(MovePinch{kFirst, Vec3(0.0, 0.0, 0.08)});
  add(ReleasePinch{kFirst});
  AddLoad load{kFirst, {}, 1};
  load.load.region = BoxRegion{Vec3(-1, -1, 0.03), Vec3(1, 1, 1)};
  load.load.force = Vec3(0.0, 0.1, 0.0);
  add(load);
  add(BeginHold{kFirst, Vec3(0.0, 0.0, 0.05), 0.03, 0.0, 0.0, 0.0, C3DE_SIM_HOLD_SHAPE, 1});
  add(PullHold{1, Vec3(0.0, 0.0, 0.07), std::array<double, 4>{0.0, 0.0, 0.0, 1.0}});
  SurfaceCondition condition;
  condition.name = "force";
  condition.body = kFirst;
  condition.patch.positions = {Vec3(0.05, 0.0, 0.0), Vec3(0.05, 0.05, 0.0), Vec3(0.05, 0.0, 0.05)};
  condition.patch.triangles = {{0, 1, 2}};
  condition.kind = ConditionKind::force;
  condition.vector = Vec3(0.0, 0.1, 0.0);
  add(SetSurfaceCondition{1, condition});
  static const std::size_t phyxels = phyxelsOfCube();
  add(SetMatchedState{kFirst, std::vector<Vec3>(phyxels, Vec3(0.0, 0.0, 1e-3)),
                      std::vector<Vec3>(phyxels, Vec3::Zero())});
  add(StoreCheckpoint{1});
  add(ExchangeCheckpoint{1});
  add(DropCheckpoint{1});
  add(rebuilt(kSecond, 50));
  add(loaded("ball", Vec3(-0.3, 0.0, 0.0), kSecond));
  add(ClearWorld());
  return all;
}

}  // namespace

TEST_CASE("Changes of parameters are repeated with the same bits, and have keys", "[changes]") {
  Host host;
  Simulation first(host);
  first.step(3);
  const Recorded gravity = first.make(world(sdk::vec3Value("world.gravity", {0.0, 2.0, -9.81})));
  CHECK(gravity.id == "world.parameter");
  CHECK_THAT(gravity.key, Catch::Matchers::StartsWith("world.gravity"));
  CHECK(gravity.text == "set Gravity");
  CHECK(gravity.flags == 0);
  CHECK(gravity.steps == 3);
  first.step(2);
  const std::array both{sdk::numberValue("solver.damping", 2.0), sdk::boolValue("solver.sleep", false)};
  CHECK_THAT(first.call(first.sim->set_world(first.self, both.data(), 2, sizeof both[0])).key,
             Catch::Matchers::StartsWith("solver.damping, solver.sleep"));
  first.step(2);
  const c3de_param_value modulus = sdk::numberValue(C3DE_PARAM_ID_YOUNGS_MODULUS, 3e4);
  const Recorded stiff = first.call(first.sim->set_body_param(first.self, first.bodies[1], &modulus));
  CHECK(stiff.id == "body.parameter");
  CHECK_THAT(stiff.key, Catch::Matchers::StartsWith(std::string("cube\n2\n") + C3DE_PARAM_ID_YOUNGS_MODULUS));
  CHECK(stiff.text == "set Young's modulus of cube (2)");
  first.step(2);
  CHECK(first.make(world(sdk::choiceValue("view.surface", "hidden"))).key == "view.surface");
  // What others depend on is never superfluous, and separates what comes before it from what comes after it.
  CHECK(first.make(world(sdk::choiceValue("solver.integrator", "implicit"))).key.empty());
  CHECK(first.make(world(sdk::vec3Value("world.gravity", {0.0, 0.0, -9.81}))).key != gravity.key);
  CHECK(first.make(world(sdk::choiceValue("view.surface", "opaque"))).key == "view.surface");
  first.step(2);
  checkRepeated(host, first);
}

TEST_CASE("Changes of bodies are repeated with the same bits", "[changes]") {
  Host host;
  Simulation first(host);
  first.step(4);
  const Recorded again = first.make(rebuilt(kSecond, 90));
  CHECK(again.flags == C3DE_SIM_CHANGE_RESETS);
  CHECK(again.text == "rebuild cube (2)");
  first.step(4);
  CHECK((first.make(loaded("ball", Vec3(0.0, 0.0, 0.0), kFirst)).flags & C3DE_SIM_CHANGE_RESETS) != 0);
  first.step(3);
  first.make(material({"ball", 1}, 8e3));
  first.step(3);
  c3de_handle left{};
  first.check(first.sim->body_at(first.self, 0, &left));
  const Recorded gone = first.call(first.sim->remove(first.self, left));
  CHECK(gone.id == "object.remove");
  CHECK(gone.text == "remove cube (2)");
  checkRepeated(host, first);
}

TEST_CASE("A body is rebuilt for earlier pulls, also where they did not happen", "[changes]") {
  Host host;
  Simulation first(host);
  const auto prepare = [](Simulation &simulation) {
    simulation.make(world(sdk::vec3Value("world.gravity", {0.0, 0.0, 0.0})));
    simulation.make(rebuilt(kFirst, 500));
  };
  prepare(first);
  first.make(BeginPinch{kFirst, smallGrab(Vec3(0.03, 0.0, 0.1)), 0.0});
  first.step(20);
  first.make(MovePinch{kFirst, Vec3(0.03, 0.0, 0.2)});
  first.step(20);
  first.make(ReleasePinch{kFirst});
  RebuildBody refined = rebuilt(kFirst, 800, "on");
  refined.values.emplace_back(sdk::numberValue("surroundings.stiffness", 1e5));
  first.make(refined);
  first.step(4);
  checkLasting(host, first);
  // Without the pulls its sampling is another one.
  Simulation other(host);
  prepare(other);
  other.make(refined);
  const std::string state = first.save();
  CHECK(other.sim->load_state(other.self, state.data(), state.size()) < 0);
}

TEST_CASE("Changes of obstacles are repeated with the same bits", "[changes]") {
  Host host;
  Simulation first(host);
  const Recorded added = first.make(implant("plug"));
  CHECK(added.text == "add plug");
  CHECK(added.key.empty());
  const Recorded placed = first.make(MoveObstacle{{"plug", 1}, motion(Vec3(0.01, 0.0, 0.02), 0.2)});
  CHECK(placed.flags == 0);
  CHECK_FALSE(placed.key.empty());
  first.step(5);
  first.make(implant("plug", Vec3(0.1, 0.0, 0.2)));
  // A reset returns it: later than the first step it is moved for now only.
  const Recorded guided = first.make(MoveObstacle{{"plug", 1}, motion(Vec3(0.0, 0.0, -0.14), 0.4)});
  CHECK(guided.flags == C3DE_SIM_CHANGE_TRANSIENT);
  CHECK(guided.key.empty());
  first.step(5);
  first.make(removed(RemoveObject::What::obstacle, {"plug", 1}));
  first.step(5);
  first.make(RestoreObstacle{{"plug", 1}});
  first.step(5);
  first.call(first.sim->remove(first.self, first.plate));
  first.step(5);
  first.make(RestoreObstacle{kPlate});
  first.make(removed(RemoveObject::What::obstacle, {"plug", 2}));
  first.step(5);
  // Where tissue is, it restarts the simulation.
  CHECK(first.make(implant("nail", Vec3(0.0, 0.0, 0.04))).flags == C3DE_SIM_CHANGE_RESETS);
  first.step(5);
  checkRepeated(host, first);
}

TEST_CASE("Interactive tools are repeated with the same bits", "[changes]") {
  Host host;
  Simulation first(host);
  const auto isTransient = [](const Recorded &change) {
    INFO(change.id);
    CHECK(change.flags == C3DE_SIM_CHANGE_TRANSIENT);
    CHECK(change.key.empty());
    CHECK_FALSE(change.text.empty());
  };
  first.step(3);
  isTransient(first.make(StoreCheckpoint()));
  isTransient(first.make(PlaceInstrument{0.01, 0.05, 0.3, Vec3(0.0, 0.0, 0.09), Vec3::UnitZ()}));
  first.step(3);
  isTransient(first.make(MoveInstrument{Vec3(0.0, 0.0, 0.07)}));
  first.step(5);
  isTransient(first.make(ExchangeCheckpoint{1}));
  first.step(4);
  isTransient(first.make(ExchangeCheckpoint{1}));
  first.step(4);
  isTransient(first.make(RemoveInstrument()));
  isTransient(first.make(DropCheckpoint{1}));
  isTransient(first.make(smallGrasp()));
  first.step(4);
  isTransient(first.make(StoreCheckpoint()));
  isTransient(first.make(MoveGrasp{Vec3(0.0, 0.0, 0.07), Eigen::AngleAxisd(0.2, Vec3::UnitZ()).toRotationMatrix()}));
  first.step(4);
  isTransient(first.make(ExchangeCheckpoint{2}));
  first.step(4);
  isTransient(first.make(ReleaseGrasp()));
  first.step(2);
  isTransient(first.make(BeginPinch{kSecond, smallGrab(Vec3(0.3, 0.0, 0.08)), 0.0}));
  first.step(3);
  isTransient(first.make(MovePinch{kSecond, Vec3(0.3, 0.0, 0.1)}));
  first.step(3);
  isTransient(first.make(ReleasePinch{kSecond}));
  first.step(3);
  checkRepeated(host, first);
}

TEST_CASE("What other plugins do is repeated with the same bits", "[changes]") {
  Host host;
  Simulation first(host);
  first.step(2);
  c3de_sim_region region{};
  region.size = sizeof region;
  region.kind = C3DE_SIM_REGION_HALF_SPACE;
  region.b[2] = -1.0;
  c3de_sim_load load{};
  load.size = sizeof load;
  load.region = &region;
  load.force_N[1] = 0.2;
  load.ramp_s = 0.01;
  c3de_handle loads[2]{}, hold{};
  for (c3de_handle &one : loads)
    CHECK(first.call(first.sim->add_load(first.self, first.bodies[1], &load, &one)).id == "load.add");
  first.step(4);
  CHECK(first.call(first.sim->remove(first.self, loads[0])).flags == C3DE_SIM_CHANGE_TRANSIENT);
  c3de_sim_hold part{};
  part.size = sizeof part;
  part.at_m[2] = 0.05;
  part.radius_m = 0.03;
  part.flags = C3DE_SIM_HOLD_SHAPE;
  first.call(first.sim->hold(first.self, first.bodies[0], &part, &hold));
  first.step(3);
  const std::array<double, 3> target{0.0, 0.01, 0.07};
  const std::array<double, 4> turned{0.0, 0.0, std::sin(0.1), std::cos(0.1)};
  CHECK(first.call(first.sim->pull(first.self, hold, target.data(), turned.data())).id == "hold.pull");
  first.step(3);
  first.call(first.sim->remove(first.self, hold));
  const std::array<double, 3> at{0.3, 0.0, 0.05};
  c3de_handle probe{};
  first.check(first.sim->add_probe(first.self, {"top", 3}, first.bodies[1], at.data(), &probe));
  first.step(2);
  Simulation second(host);
  for (const Recorded &change : std::vector(first.record)) second.repeat(change);
  second.check(second.sim->add_probe(second.self, {"top", 3}, second.bodies[1], at.data(), &probe));
  while (second.steps() < first.steps()) second.step();
  CHECK(second.hash() == first.hash());
  CHECK(first.call(first.sim->remove(first.self, probe)).text == "remove top");
  second.repeat(first.record.back());
  CHECK((first.call(first.sim->clear(first.self)).flags & C3DE_SIM_CHANGE_RESETS) != 0);
  second.repeat(first.record.back());
  CHECK(first.record.back().id == "world.clear");
}

TEST_CASE("Lasting changes alone lead to the simulation to which a saved state belongs", "[changes]") {
  Host host;
  Simulation first(host);
  first.make(implant("plug"));
  for (int i = 1; i <= 3; ++i) first.make(MoveObstacle{{"plug", 1}, motion(Vec3(0.0, 0.0, -0.02 * i), 0.1 * i)});
  first.step(5);
  for (const double gravity : {-1.0, -3.0, -8.0})
    first.make(world(sdk::vec3Value("world.gravity", {0.0, 0.0, gravity})));
  first.make(material(kFirst, 1e4));
  first.make(PlaceInstrument{0.01, 0.05, 0.3, Vec3(0.0, 0.0, 0.09), Vec3::UnitZ()});
  first.make(MoveObstacle{{"plug", 1}, motion(Vec3(0.0, 0.0, -0.1), 0.2)});
  first.step(3);
  first.make(removed(RemoveObject::What::obstacle, {"plug", 1}));
  first.make(RestoreObstacle{{"plug", 1}});
  first.step(3);
  first.make(rebuilt(kSecond, 80));
  first.make(world(sdk::vec3Value("world.gravity", {0.0, 0.0, -9.0})));
  first.make(material(kFirst, 1.2e4));
  first.make(material(kFirst, 1.4e4));
  // A wall is moved to where the other one had to make room first.
  first.make(world(sdk::vec3Value("world.box.max", {9.0, 9.0, 9.0})));
  first.make(world(sdk::vec3Value("world.box.min", {2.0, 2.0, 2.0})));
  first.make(world(sdk::vec3Value("world.box.max", {8.0, 8.0, 8.0})));
  first.make(world(sdk::vec3Value("world.box.min", {-1.0, -1.0, -1.0})));
  first.step(6);
  CHECK(lastingOf(first.record).size() < first.record.size() - 4);
  checkLasting(host, first);
}

namespace {

/// What acts on the bodies when a state is stored.
enum class Acting : std::uint8_t { instrument, movedImplant, jaws, pinch, load, hold };
using ActingSet = std::set<Acting>;

/// Begins these on a simulation, over a few steps.
void begin(Simulation &first, const ActingSet &acting) {
  const auto has = [&](Acting one) { return acting.contains(one); };
  if (has(Acting::movedImplant)) first.make(implant("plug"));
  first.step(2);
  if (has(Acting::instrument)) {
    first.make(PlaceInstrument{0.01, 0.05, 0.3, Vec3(0.0, 0.0, 0.09), Vec3::UnitZ()});
    first.make(implant("pin", Vec3(0.0, 0.3, 0.2)));  // among the obstacles after the instrument
    first.make(MoveInstrument{Vec3(0.0, 0.0, 0.08)});
  }
  if (has(Acting::movedImplant)) first.make(MoveObstacle{{"plug", 1}, motion(Vec3(0.0, 0.1, -0.1), 0.2)});
  if (has(Acting::jaws)) first.make(smallGrasp());
  first.step(2);
  if (has(Acting::jaws))
    first.make(MoveGrasp{Vec3(0.0, 0.0, 0.07), Eigen::AngleAxisd(0.2, Vec3::UnitZ()).toRotationMatrix()});
  if (has(Acting::pinch)) first.make(BeginPinch{kSecond, smallGrab(Vec3(0.3, 0.0, 0.08)), 0.0});
  if (has(Acting::load)) {
    AddLoad load{kSecond, {}};
    load.load.region = BoxRegion{Vec3(-1, -1, 0.03), Vec3(1, 1, 1)};
    load.load.force = Vec3(0.0, 0.1, 0.0);
    load.load.ramp = 0.5;
    first.make(load);
  }
  if (has(Acting::hold)) {
    first.make(BeginHold{kSecond, Vec3(0.3, 0.0, -0.05), 0.03, 0.0, 0.0, 0.0, C3DE_SIM_HOLD_SHAPE});
    first.make(PullHold{1, Vec3(0.3, 0.0, -0.07), std::array<double, 4>{0.0, 0.0, std::sin(0.1), std::cos(0.1)}});
  }
  first.step(3);
}

void moveOn(Simulation &first, const ActingSet &acting) {
  const auto has = [&](Acting one) { return acting.contains(one); };
  if (has(Acting::instrument)) first.make(MoveInstrument{Vec3(0.0, 0.0, 0.07)});
  if (has(Acting::jaws)) first.make(MoveGrasp{Vec3(0.0, 0.0, 0.08)});
  if (has(Acting::pinch)) first.make(MovePinch{kSecond, Vec3(0.3, 0.0, 0.1)});
  if (has(Acting::hold)) first.make(PullHold{1, Vec3(0.3, 0.0, -0.08)});
  if (has(Acting::load)) first.make(removed(RemoveObject::What::load, {}, 1));
}

void end(Simulation &first, const ActingSet &acting) {
  const auto has = [&](Acting one) { return acting.contains(one); };
  if (has(Acting::instrument)) first.make(RemoveInstrument());
  if (has(Acting::jaws)) first.make(ReleaseGrasp());
  if (has(Acting::pinch)) first.make(ReleasePinch{kSecond});
  if (has(Acting::hold)) first.make(removed(RemoveObject::What::hold, {}, 1));
}

}  // namespace

TEST_CASE("A state is stored while tools hold the bodies, and every step from there has the same bits", "[changes]") {
  const bool isImplicit = GENERATE(false, true);
  const ActingSet acting = GENERATE(
      ActingSet{Acting::instrument}, ActingSet{Acting::movedImplant}, ActingSet{Acting::jaws}, ActingSet{Acting::pinch},
      ActingSet{Acting::load}, ActingSet{Acting::hold},
      ActingSet{Acting::instrument, Acting::movedImplant, Acting::jaws, Acting::pinch, Acting::load, Acting::hold});
  CAPTURE(isImplicit, acting.size(), static_cast<int>(*acting.begin()));
  Host host;
  Simulation first(host), second(host);
  first.make(world(sdk::choiceValue("solver.integrator", isImplicit ? "implicit" : "explicit")));
  begin(first, acting);
  const std::string state = first.save();
  // Other interactions than those of the state, and other ids.
  second.make(PlaceInstrument{0.02, 0.0, 0.1, Vec3(0.0, 0.0, 0.2), Vec3::UnitX()});
  second.make(BeginHold{kFirst, Vec3(0.0, 0.0, 0.05), 0.03, 0.0, 0.0, 0.0, 0});
  for (const Recorded &change : lastingOf(first.record)) CHECK(second.tryApply(change.id, change.bytes) == C3DE_OK);
  second.check(second.sim->load_state(second.self, state.data(), state.size()));
  CHECK((second.save() == first.save()));
  const auto stepBoth = [&](int steps) {
    for (int i = 0; i < steps; ++i) {
      first.step();
      second.step();
      REQUIRE(first.hash() == second.hash());
    }
  };
  const auto repeatFrom = [&](std::size_t change) {
    for (std::size_t i = change; i < first.record.size(); ++i) second.repeat(first.record[i]);
  };
  stepBoth(20);
  std::size_t before = first.record.size();
  moveOn(first, acting);
  repeatFrom(before);
  stepBoth(10);
  before = first.record.size();
  end(first, acting);
  repeatFrom(before);
  stepBoth(10);
  first.reset();
  second.reset();
  stepBoth(5);
}

TEST_CASE("Loads and holds of other plugins keep their handles when a state with them is loaded", "[changes]") {
  Host host;
  Simulation simulation(host);
  c3de_sim_region region{};
  region.size = sizeof region;
  region.kind = C3DE_SIM_REGION_HALF_SPACE;
  region.b[2] = -1.0;
  c3de_sim_load load{};
  load.size = sizeof load;
  load.region = &region;
  load.force_N[1] = 0.2;
  c3de_sim_hold part{};
  part.size = sizeof part;
  part.at_m[2] = 0.05;
  part.radius_m = 0.03;
  c3de_handle added{}, hold{}, later{};
  simulation.check(simulation.sim->add_load(simulation.self, simulation.bodies[1], &load, &added));
  simulation.check(simulation.sim->hold(simulation.self, simulation.bodies[0], &part, &hold));
  simulation.step(3);
  const std::string state = simulation.save();
  part.at_m[0] = 0.02;
  simulation.check(simulation.sim->hold(simulation.self, simulation.bodies[0], &part, &later));
  simulation.step(3);
  simulation.check(simulation.sim->load_state(simulation.self, state.data(), state.size()));
  const std::array<double, 3> target{0.0, 0.0, 0.06};
  simulation.check(simulation.sim->pull(simulation.self, hold, target.data(), nullptr));
  c3de_sim_hold_state held{};
  held.size = sizeof held;
  simulation.check(simulation.sim->hold_state(simulation.self, hold, &held));
  // One that the state does not contain is stale.
  CHECK(simulation.sim->pull(simulation.self, later, target.data(), nullptr) < 0);
  simulation.check(simulation.sim->remove(simulation.self, added));
  simulation.check(simulation.sim->remove(simulation.self, hold));
  CHECK(simulation.sim->remove(simulation.self, added) < 0);
  simulation.step(3);
}

TEST_CASE("Damaged states are refused, and nothing has changed", "[changes]") {
  Host host;
  Simulation simulation(host);
  simulation.make(PlaceInstrument{0.01, 0.05, 0.3, Vec3(0.0, 0.0, 0.09), Vec3::UnitZ()});
  simulation.make(smallGrasp());
  simulation.make(BeginPinch{kSecond, smallGrab(Vec3(0.3, 0.0, 0.08)), 0.0});
  simulation.step(3);
  const std::string state = simulation.save();
  std::mt19937 random(7);
  int refused = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::string damaged = state;
    if (trial % 3 == 0) damaged.resize(random() % damaged.size());
    if (trial % 3 != 0) damaged[random() % damaged.size()] ^= static_cast<char>(1 + random() % 255);
    const std::uint64_t hash = simulation.hash();
    if (simulation.sim->load_state(simulation.self, damaged.data(), damaged.size()) < 0) {
      ++refused;
      CHECK_FALSE(host.host->takeError().empty());
      CHECK(simulation.hash() == hash);
    } else {  // a number that may have another value
      simulation.check(simulation.sim->load_state(simulation.self, state.data(), state.size()));
    }
    if (trial % 50 == 0) simulation.step();
  }
  CHECK(refused >= kTrials / 3);  // all that are cut
}

TEST_CASE("Malformed changes are refused, and nothing has changed", "[changes]") {
  Host host;
  const auto all = oneOfEach();
  std::set<std::string> kinds;
  for (const auto &[id, bytes] : all) kinds.insert(id);
  CHECK(kinds.size() == std::variant_size_v<AnyChange>);
  Simulation simulation(host);
  simulation.step(2);
  for (const auto &[id, bytes] : all) {
    const std::uint64_t before = simulation.hash();
    const std::size_t reported = simulation.record.size();
    for (std::size_t n = 0; n < bytes.size(); ++n) {
      INFO(id << ", " << n << " of " << bytes.size() << " bytes");
      CHECK(simulation.tryApply(id, std::string_view(bytes).substr(0, n)) == C3DE_E_FORMAT);
    }
    CHECK(simulation.tryApply(id, bytes + '\0') == C3DE_E_FORMAT);
    CHECK(simulation.hash() == before);
    CHECK(simulation.record.size() == reported);
    INFO(id);
    CHECK(simulation.tryApply(id, bytes) == C3DE_OK);
    CHECK(simulation.error == "");
    CHECK(simulation.record.size() == reported + 1);
    if (id != "world.clear") simulation.step();
  }
}

TEST_CASE("Changes with damaged bytes are refused or applied, without a crash", "[changes]") {
  Host host;
  auto simulation = std::make_unique<Simulation>(host);
  for (const auto &[id, bytes] : oneOfEach()) {
    INFO(id);
    // Filling a body takes long, and a matched state has many numbers: few of their bytes.
    const std::size_t every = id == "body.rebuild" || id == "body.load" || id == "match.set" ? 41 : 1;
    for (std::size_t i = 0; i < bytes.size(); i += every)
      for (const unsigned char flipped : {0x01, 0x80, 0xff}) {
        std::string damaged = bytes;
        damaged[i] = static_cast<char>(static_cast<unsigned char>(damaged[i]) ^ flipped);
        const std::uint64_t before = simulation->hash();
        const std::size_t reported = simulation->record.size();
        const c3de_status status = simulation->tryApply(id, damaged);
        if (status >= 0) continue;
        INFO("byte " << i);
        CHECK(simulation->hash() == before);
        CHECK(simulation->record.size() == reported);
      }
    (void)simulation->tryApply(id, bytes);
    (void)simulation->sim->step(simulation->self);
  }
}

TEST_CASE("Unknown kinds and missing objects are named", "[changes]") {
  Host host;
  Simulation simulation(host);
  simulation.step(2);
  const std::uint64_t before = simulation.hash();
  const auto refused = [&](auto change, c3de_status expected) {
    CHECK(simulation.tryApply(decltype(change)::kId, bytesOf(change)) == expected);
    return simulation.error;
  };
  CHECK(simulation.tryApply("no.such", "") == C3DE_E_FORMAT);
  CHECK_THAT(simulation.error, Contains("no.such"));
  const ObjectName liver{"liver", 2};
  CHECK_THAT(refused(material(liver, 1e4), C3DE_E_NOT_FOUND), Contains("body 'liver (2)'"));
  CHECK_THAT(refused(rebuilt(liver, 50), C3DE_E_NOT_FOUND), Contains("body 'liver (2)'"));
  CHECK_THAT(refused(loaded("ball", Vec3::Zero(), liver), C3DE_E_NOT_FOUND), Contains("body 'liver (2)'"));
  CHECK_THAT(refused(BeginPinch{liver, smallGrab(Vec3::Zero()), 0.0}, C3DE_E_NOT_FOUND), Contains("liver"));
  CHECK_THAT(refused(MovePinch{liver, Vec3::Zero()}, C3DE_E_NOT_FOUND), Contains("liver"));
  CHECK_THAT(refused(MoveObstacle{liver, motion(Vec3::Zero())}, C3DE_E_NOT_FOUND), Contains("obstacle 'liver (2)'"));
  CHECK_THAT(refused(RestoreObstacle{kPlate}, C3DE_E_NOT_FOUND), Contains("'plate'"));
  CHECK_THAT(refused(removed(RemoveObject::What::probe, {"tip", 1}), C3DE_E_NOT_FOUND), Contains("'tip'"));
  CHECK_THAT(refused(removed(RemoveObject::What::hold, {}, 7), C3DE_E_NOT_FOUND), Contains("7"));
  CHECK_THAT(refused(PullHold{3, Vec3::Zero()}, C3DE_E_NOT_FOUND), Contains("hold 3"));
  CHECK_THAT(refused(ExchangeCheckpoint{4}, C3DE_E_NOT_FOUND), Contains("checkpoint 4"));
  CHECK_THAT(refused(world(sdk::numberValue("no.such", 1.0)), C3DE_E_NOT_FOUND), Contains("no.such"));
  CHECK(simulation.hash() == before);
  CHECK(simulation.record.empty());
}

TEST_CASE("Panels and tools change a simulation by changes only", "[changes]") {
  // The functions of the parts that change something need a ChangeAccess; the physics behind them does not.
  for (const char *folder : {"tools", "panels", "view"})
    for (const auto &file : std::filesystem::directory_iterator(std::filesystem::path(C3DE_PLUGIN_SOURCES) / folder)) {
      std::ostringstream text;
      text << std::ifstream(file.path()).rdbuf();
      INFO(file.path().filename().string());
      CHECK(text.str().find("parts().world") == std::string::npos);
    }
}
