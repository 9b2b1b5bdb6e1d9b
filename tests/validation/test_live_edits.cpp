// SPDX-License-Identifier: Apache-2.0
// External edits of a running simulation: loads, holds, probes, fields; through the C tables from end to end.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "c3de/geometry/mesh_io.h"
#include "c3de/scene/text_sink.h"
#include "simulator_session.h"
#include "support/catch.h"
#include "support/folders.h"

using namespace c3de;
using Catch::Matchers::Contains;
using test::SimulatorSession;

namespace {

geometry::LoadedMesh organ() {
  auto mesh = geometry::loadMesh(std::filesystem::path(testResourcesFolder()) / "meshes/organ.obj",
                                 geometry::LengthUnit::millimetre);
  REQUIRE(mesh);
  return *mesh;
}

struct FreeOrgan {
  SimulatorSession session{2};
  c3de_handle body{};
  const c3de_simulator_v1 *table = session.table();
  c3de_object *self = session.object();

  explicit FreeOrgan(const SimulatorSession::Placement &placement = {}, std::vector<c3de_param_value> values = {}) {
    session.setWorld({SimulatorSession::vector("world.gravity", {0.0, 0.0, 0.0})});
    values.push_back(SimulatorSession::number("sampling.count", 500.0));
    body = session.addBody(organ(), placement, values);
  }
  Vec3 momentum() {
    const std::vector<Vec3> velocities = session.phyxels(body, C3DE_SIM_FIELD_VELOCITY);
    const std::vector<double> masses = session.phyxelMasses(body);
    Vec3 sum{};
    for (std::size_t i = 0; i < masses.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) sum[c] += masses[i] * velocities[i][c];
    return sum;
  }
  c3de_handle addLoad(const Vec3 &force_N, double ramp_s) {
    c3de_sim_region everywhere{};
    everywhere.size = sizeof everywhere;
    everywhere.kind = C3DE_SIM_REGION_EVERYWHERE;
    c3de_sim_load load{};
    load.size = sizeof load;
    load.region = &everywhere;
    load.ramp_s = ramp_s;
    for (std::size_t c = 0; c < 3; ++c) load.force_N[c] = force_N[c];
    c3de_handle added{};
    REQUIRE(table->add_load(self, body, &load, &added) == C3DE_OK);
    REQUIRE(added.v != 0);
    return added;
  }
  Vec3 extreme(double sign) {
    const std::vector<Vec3> surface = session.surfels(body, C3DE_SIM_FIELD_POSITION);
    return *std::max_element(surface.begin(), surface.end(),
                             [sign](const Vec3 &a, const Vec3 &b) { return sign * a[1] < sign * b[1]; });
  }
  Vec3 topmost() { return extreme(1.0); }
  Vec3 lowest() { return extreme(-1.0); }
  c3de_handle hold(const Vec3 &at, double radius_m) {
    c3de_sim_hold asked{};
    asked.size = sizeof asked;
    std::copy(at.begin(), at.end(), asked.at_m);
    asked.radius_m = radius_m;
    c3de_handle out{};
    REQUIRE(table->hold(self, body, &asked, &out) == C3DE_OK);
    return out;
  }
  c3de_sim_hold_state holdState(c3de_handle hold) {
    c3de_sim_hold_state state{};
    state.size = sizeof state;
    REQUIRE(table->hold_state(self, hold, &state) == C3DE_OK);
    CHECK(state.body.v == body.v);
    return state;
  }
};

Vec3 vectorOf(const double *v) { return {v[0], v[1], v[2]}; }
Vec3 between(const Vec3 &from, const Vec3 &to) { return {to[0] - from[0], to[1] - from[1], to[2] - from[2]}; }

}  // namespace

TEST_CASE("a load that comes while an organ moves gives it its impulse, until it is removed or the simulation reset") {
  FreeOrgan f;
  const Vec3 force{0.3, -0.2, 0.1};
  f.session.step();
  const Vec3 before = f.momentum();
  const c3de_handle load = f.addLoad(force, 0.0);
  double begin_s = f.session.status().time_s;
  for (int i = 0; i < 40; ++i) f.session.step();
  const double seconds = f.session.status().time_s - begin_s;
  Vec3 gained = f.momentum();
  for (std::size_t c = 0; c < 3; ++c) gained[c] -= before[c];
  // Sums of some hundred products in double precision.
  for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(gained[c] - force[c] * seconds) < 1e-9 * norm(force) * seconds);
  REQUIRE(f.table->remove(f.self, load) == C3DE_OK);
  CHECK(f.table->remove(f.self, load) < 0);
  const Vec3 then = f.momentum();
  for (int i = 0; i < 10; ++i) f.session.step();
  for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(f.momentum()[c] - then[c]) < 1e-9 * norm(then));
  // A ramp begins when the load is added; a reset removes the load.
  (void)f.addLoad(force, 1e6);
  for (int i = 0; i < 5; ++i) f.session.step();
  CHECK(std::abs(f.momentum()[0] - then[0]) < 1e-4 * norm(then));
  (void)f.addLoad(force, 0.0);
  f.session.reset();
  for (int i = 0; i < 5; ++i) f.session.step();
  CHECK(norm(f.momentum()) < 1e-15);
}

TEST_CASE("another's tool takes hold of an organ, pulls it and lets it go") {
  FreeOrgan f;
  const Vec3 top = f.topmost();
  const Vec3 target{top[0], top[1] + 0.03, top[2]};
  CHECK(f.table->pull(f.self, {77}, target.data(), nullptr) == C3DE_E_STALE);
  CHECK_THAT(f.session.takeError(), Contains("no such hold"));
  c3de_sim_hold asked{};
  asked.size = sizeof asked;
  std::copy(top.begin(), top.end(), asked.at_m);
  c3de_handle hold{};
  CHECK(f.table->hold(f.self, f.body, &asked, &hold) == C3DE_E_ARG);
  CHECK_THAT(f.session.takeError(), Contains("radius above 0 m"));
  asked.radius_m = 0.02;
  asked.flags = 1u << 30;
  CHECK(f.table->hold(f.self, f.body, &asked, &hold) == C3DE_E_UNSUPPORTED);
  asked.flags = 0;
  REQUIRE(f.table->hold(f.self, f.body, &asked, &hold) == C3DE_OK);
  f.session.step();
  // No pull yet: the target is the point itself.
  CHECK(norm(vectorOf(f.holdState(hold).force_N)) < 1e-12);
  CHECK(norm(between(top, vectorOf(f.holdState(hold).point_m))) < 1e-12);
  REQUIRE(f.table->pull(f.self, hold, target.data(), nullptr) == C3DE_OK);
  double gained = 0.0, begin_s = f.session.status().time_s;
  for (int i = 0; i < 20; ++i) {
    f.session.step();
    CHECK(f.holdState(hold).force_N[1] > 0.0);
  }
  gained = f.momentum()[1];
  CHECK(gained > 0.0);
  CHECK(f.session.status().time_s > begin_s);
  REQUIRE(f.table->remove(f.self, hold) == C3DE_OK);
  for (int i = 0; i < 10; ++i) f.session.step();
  CHECK(std::abs(f.momentum()[1] - gained) < 0.2 * gained);  // the step in which it was released still pulled
  c3de_sim_hold_state state{};
  state.size = sizeof state;
  CHECK(f.table->hold_state(f.self, hold, &state) == C3DE_E_STALE);
  CHECK(f.table->remove(f.self, hold) < 0);
}

TEST_CASE("several hold one organ: between two hands that pull apart it stretches and goes nowhere") {
  FreeOrgan f;
  const Vec3 up = f.topmost(), down = f.lowest();
  const c3de_handle upper = f.hold(up, 0.015), lower = f.hold(down, 0.015);
  const Vec3 above{up[0], up[1] + 0.02, up[2]}, below{down[0], down[1] - 0.02, down[2]};
  REQUIRE(f.table->pull(f.self, upper, above.data(), nullptr) == C3DE_OK);
  REQUIRE(f.table->pull(f.self, lower, below.data(), nullptr) == C3DE_OK);
  for (int i = 0; i < 400; ++i) f.session.step();
  CHECK(f.holdState(upper).force_N[1] > 0.0);
  CHECK(f.holdState(lower).force_N[1] < 0.0);
  CHECK(f.holdState(upper).point_m[1] - up[1] > 0.002);
  CHECK(down[1] - f.holdState(lower).point_m[1] > 0.002);
  // One releases: the other holds it.
  REQUIRE(f.table->remove(f.self, lower) == C3DE_OK);
  const double before = f.momentum()[1];
  for (int i = 0; i < 20; ++i) f.session.step();
  CHECK(f.momentum()[1] > before);
  // A reset releases.
  f.session.reset();
  c3de_sim_hold_state state{};
  state.size = sizeof state;
  CHECK(f.table->hold_state(f.self, upper, &state) == C3DE_E_STALE);
}

TEST_CASE("a clamp keeps the shape of what it holds and turns it") {
  FreeOrgan f;
  const Vec3 up = f.topmost();
  c3de_sim_hold asked{};
  asked.size = sizeof asked;
  asked.flags = C3DE_SIM_HOLD_SHAPE;
  std::copy(up.begin(), up.end(), asked.at_m);
  asked.radius_m = 0.03;
  asked.max_force_N = 1e3;
  c3de_handle hold{};
  REQUIRE(f.table->hold(f.self, f.body, &asked, &hold) == C3DE_OK);
  const std::array<double, 4> bent{0.0, 0.0, 0.5, 0.5};
  CHECK(f.table->pull(f.self, hold, up.data(), bent.data()) == C3DE_E_ARG);
  CHECK_THAT(f.session.takeError(), Contains("unit length"));
  const double half = 0.25;  // rad, of a rotation by 0.5 about y
  const std::array<double, 4> turn{0.0, std::sin(half), 0.0, std::cos(half)};
  REQUIRE(f.table->pull(f.self, hold, up.data(), turn.data()) == C3DE_OK);
  f.session.step();
  CHECK(f.holdState(hold).torque_Nm[1] > 0.0);
  CHECK(f.holdState(hold).mass_kg > 0.0);
  const std::vector<Vec3> at = f.session.surfels(f.body, C3DE_SIM_FIELD_REFERENCE_POSITION);
  for (int i = 0; i < 12000; ++i) f.session.step();
  // The held part has rotated about y by half a radian.
  const std::vector<Vec3> now = f.session.surfels(f.body, C3DE_SIM_FIELD_POSITION);
  double sine = 0.0, cosine = 0.0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (norm(between(up, at[i])) > 0.01) continue;
    const Vec3 from = between(up, at[i]), to = between(up, now[i]);
    sine += from[2] * to[0] - from[0] * to[2];
    cosine += from[0] * to[0] + from[2] * to[2];
  }
  INFO(std::atan2(sine, cosine) << " rad");
  CHECK(std::abs(std::atan2(sine, cosine) - 2.0 * half) < 0.05);
}

TEST_CASE("a saved state goes on bit for bit as the simulation that saved it, with every integrator and material") {
  using Values = std::vector<c3de_param_value>;
  const auto number = SimulatorSession::number;
  const auto text = [](const char *id, const char *value) {
    c3de_param_value out{};
    out.size = sizeof out;
    out.type = C3DE_PARAM_CHOICE;
    out.id = {id, std::strlen(id)};
    out.text = {value, std::strlen(value)};
    return out;
  };
  struct Case {
    const char *integrator;
    Values material;
  };
  for (const Case &one :
       {Case{"explicit", {}}, Case{"implicit", {}}, Case{"midpoint", {number("material.viscosity", 5.0)}},
        Case{"backward_euler", {}}, Case{"quasistatic", {number("surroundings.stiffness", 1e6)}},
        Case{"explicit",
             {number("surroundings.stiffness", 1e5), number("material.plastic.yield", 0.01),
              number("material.plastic.creep", 0.5)}},
        Case{"implicit",
             {number("surroundings.stiffness", 1e5), number("material.plastic.yield", 0.01),
              number("material.plastic.creep", 0.5)}}}) {
    INFO(one.integrator << ' ' << one.material.size());
    const auto make = [&](FreeOrgan &f) {
      Values world{text("solver.integrator", one.integrator),
                   SimulatorSession::vector("world.gravity", {0.0, -200.0, 0.0})};
      if (std::strcmp(one.integrator, "explicit") != 0 && std::strcmp(one.integrator, "quasistatic") != 0)
        world.push_back(number("solver.dt", 0.01));
      f.session.setWorld(world);
    };
    FreeOrgan first({}, one.material), second({}, one.material);
    make(first);
    make(second);
    for (int i = 0; i < 12; ++i) first.session.step();
    const bool flows = one.material.size() > 2;
    CHECK(flows == !Contains("\"max_plastic_strain\":0.0").match(first.session.report()));
    std::string bytes;
    INFO(first.session.takeError());
    REQUIRE(first.table->save_state(first.self, scene::sinkInto(bytes)) == C3DE_OK);
    const c3de_status gone = second.table->load_state(second.self, bytes.data(), bytes.size());
    INFO(second.session.takeError());
    REQUIRE(gone == C3DE_OK);
    CHECK(second.session.stateHash() == first.session.stateHash());
    const std::uint64_t saved = first.session.stateHash();
    for (int i = 0; i < 5; ++i) {
      first.session.step();
      second.session.step();
    }
    CHECK(second.session.stateHash() == first.session.stateHash());
    CHECK((first.session.stateHash() != saved || first.session.status().finished != 0));
    CHECK(second.session.status().time_s == first.session.status().time_s);
  }
}

TEST_CASE("probes come, are read where they are now, and go") {
  FreeOrgan f;
  const Vec3 at = f.session.surfels(f.body, C3DE_SIM_FIELD_REFERENCE_POSITION)[100];
  c3de_handle probe{};
  REQUIRE(f.table->add_probe(f.self, {"tip", 3}, f.body, at.data(), &probe) == C3DE_OK);
  CHECK(f.table->add_probe(f.self, {"tip", 3}, f.body, at.data(), nullptr) == C3DE_E_EXISTS);
  (void)f.addLoad({0.0, 1.0, 0.0}, 0.0);
  for (int i = 0; i < 30; ++i) f.session.step();
  struct Seen {
    int count = 0;
    c3de_sim_probe last{};
    std::string name;
  } seen;
  const auto each = [](void *visitor, const c3de_sim_probe *told) -> c3de_status {
    auto &to = *static_cast<Seen *>(visitor);
    ++to.count;
    to.last = *told;
    to.name.assign(told->name.ptr, told->name.len);
    return C3DE_OK;
  };
  REQUIRE(f.table->enum_probes(f.self, &seen, each) == C3DE_OK);
  CHECK(seen.count == 1);
  CHECK(seen.name == "tip");
  CHECK(seen.last.body.v == f.body.v);
  CHECK(seen.last.reference_m[0] == at[0]);
  CHECK(seen.last.position_m[1] > at[1]);
  CHECK(seen.last.velocity_m_s[1] > 0.0);
  REQUIRE(f.table->remove(f.self, probe) == C3DE_OK);
  seen = {};
  REQUIRE(f.table->enum_probes(f.self, &seen, each) == C3DE_OK);
  CHECK(seen.count == 0);
}

TEST_CASE("every field that a body names can be read, with as many rows as it has points") {
  FreeOrgan f;
  const c3de_sim_body_info info = f.session.info(f.body);
  REQUIRE(info.points > 100);
  REQUIRE(info.surface_points > 100);
  struct Visit {
    FreeOrgan &f;
    c3de_sim_body_info info;
    std::vector<std::string> names;
  } visit{f, info, {}};
  const auto each = [](void *visitor, const c3de_sim_field *field) -> c3de_status {
    auto &to = *static_cast<Visit *>(visitor);
    const std::uint64_t rows = field->on == C3DE_SIM_ON_POINTS ? to.info.points : to.info.surface_points;
    std::vector<double> numbers(rows * field->comps, -12345.0);
    const c3de_mview view{numbers.data(), rows, field->comps, C3DE_F64, 0};
    if (const c3de_status read = to.f.table->read_field(to.f.self, to.f.body, field->on, field->name, view); read < 0)
      return read;
    for (const double x : numbers)
      if (!std::isfinite(x) || x == -12345.0) return C3DE_E_DIVERGED;
    to.names.emplace_back(field->name.ptr, field->name.len);
    return C3DE_OK;
  };
  REQUIRE(f.table->enum_fields(f.self, f.body, &visit, each) == C3DE_OK);
  CHECK(visit.names.size() == 14);
  for (const char *name : {"position", "velocity", "mass", "volume", "stress_vm", "normal", "contact_pressure"})
    CHECK(std::count(visit.names.begin(), visit.names.end(), name) >= 1);
  double number = 0.0;
  const c3de_mview one{&number, 1, 1, C3DE_F64, 0};
  CHECK(f.table->read_field(f.self, f.body, C3DE_SIM_ON_POINTS, {"colour", 6}, one) == C3DE_E_NOT_FOUND);
  CHECK_THAT(f.session.takeError(), Contains("'colour'") && Contains("stress_vm"));
  CHECK(f.table->read_field(f.self, f.body, C3DE_SIM_ON_POINTS, {"mass", 4}, one) == C3DE_E_ARG);
  CHECK(f.table->read_field(f.self, f.body, 7, {"mass", 4}, one) == C3DE_E_ARG);
  c3de_view triangles{};
  REQUIRE(f.table->triangles(f.self, f.body, &triangles) == C3DE_OK);
  CHECK(triangles.count > 100);
  CHECK(triangles.comps == 3);
}

TEST_CASE("a body that a matrix places is that of the same angles, and a matrix that is no rotation is refused") {
  const double c = std::cos(0.5), s = std::sin(0.5), k = 1.5, degrees = 0.5 * 180.0 / 3.14159265358979323846;
  FreeOrgan byAngles({{0.1, 0.2, 0.3}, k, {0, 0, degrees}, {}});
  std::array<double, 16> matrix{k * c, k * s, 0, 0, -k * s, k * c, 0, 0, 0, 0, k, 0, 0.1, 0.2, 0.3, 1};
  FreeOrgan byMatrix({{}, 1.0, {}, matrix});
  const auto a = byAngles.session.surfels(byAngles.body, C3DE_SIM_FIELD_POSITION),
             b = byMatrix.session.surfels(byMatrix.body, C3DE_SIM_FIELD_POSITION);
  REQUIRE(a.size() == b.size());
  // Round-off of placements of tenths of a metre.
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(norm(a[i] - b[i]) < 1e-13);
  matrix[0] *= 1.1;  // sheared
  CHECK_THROWS_WITH(FreeOrgan({{}, 1.0, {}, matrix}), Contains("matrix: not a rotation times one scale above 0"));
}

TEST_CASE("a rigid body is set free while it runs, falls, is pulled, and is refused where nothing moves") {
  const auto flag = [](const char *id, bool value) {
    c3de_param_value out = SimulatorSession::number(id, value ? 1.0 : 0.0);
    out.type = C3DE_PARAM_BOOL;
    return out;
  };
  const auto word = [](const char *id, const char *text) {
    c3de_param_value out{};
    out.size = sizeof out;
    out.id = {id, std::strlen(id)};
    out.type = C3DE_PARAM_CHOICE;
    out.text = {text, std::strlen(text)};
    return out;
  };
  FreeOrgan organ({}, {flag("rigid", true)});
  organ.session.setWorld({SimulatorSession::vector("world.gravity", {0.0, -9.81, 0.0})});
  const auto set = [&](const c3de_param_value &value) {
    return organ.table->set_body_param(organ.self, organ.body, &value);
  };
  organ.session.step();
  CHECK(organ.momentum() == Vec3{});
  REQUIRE(set(flag("free", true)) == C3DE_OK);
  for (int k = 0; k < 3; ++k) organ.session.step();
  CHECK(organ.momentum()[1] < 0.0);
  organ.session.setWorld({SimulatorSession::vector("world.gravity", {0.0, 0.0, 0.0})});
  organ.session.reset();
  (void)organ.addLoad({2.0, 0.0, 0.0}, 0.0);
  for (int k = 0; k < 3; ++k) organ.session.step();
  CHECK(organ.momentum()[0] > 0.0);
  CHECK_THROWS_WITH(organ.session.setWorld({word("solver.integrator", "quasistatic")}),
                    Contains("rigid and free") && Contains("moves no rigid body"));
  REQUIRE(set(flag("free", false)) == C3DE_OK);
  CHECK(organ.momentum() == Vec3{});
  organ.session.setWorld({word("solver.integrator", "quasistatic")});
  CHECK(set(flag("free", true)) == C3DE_E_UNSUPPORTED);
}
