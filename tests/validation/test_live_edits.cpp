// SPDX-License-Identifier: Apache-2.0
// What others do to a simulation that runs: loads, holds, probes, fields; through the C tables from end to end.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "c3de/geometry/mesh_io.h"
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

  explicit FreeOrgan(const SimulatorSession::Placement &placement = {}) {
    session.setWorld({SimulatorSession::vector("world.gravity", {0.0, 0.0, 0.0})});
    body = session.addBody(organ(), placement, {SimulatorSession::number("sampling.count", 500.0)});
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
};

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
  // A ramp begins when the load comes; a reset takes the load away.
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
  const std::vector<Vec3> surface = f.session.surfels(f.body, C3DE_SIM_FIELD_POSITION);
  const Vec3 top =
      *std::max_element(surface.begin(), surface.end(), [](const Vec3 &a, const Vec3 &b) { return a[1] < b[1]; });
  const Vec3 target{top[0], top[1] + 0.03, top[2]};
  CHECK(f.table->pull(f.self, f.body, target.data()) == C3DE_E_STATE);
  CHECK_THAT(f.session.takeError(), Contains("nobody holds"));
  CHECK(f.table->hold(f.self, f.body, top.data(), 0.0) == C3DE_E_ARG);
  REQUIRE(f.table->hold(f.self, f.body, top.data(), 0.02) == C3DE_OK);
  f.session.step();
  Vec3 force{};
  REQUIRE(f.table->hold_force(f.self, f.body, force.data()) == C3DE_OK);
  // Nobody has pulled yet: the target is the point itself.
  CHECK(norm(force) < 1e-12);
  REQUIRE(f.table->pull(f.self, f.body, target.data()) == C3DE_OK);
  double gained = 0.0, begin_s = f.session.status().time_s;
  for (int i = 0; i < 20; ++i) {
    f.session.step();
    REQUIRE(f.table->hold_force(f.self, f.body, force.data()) == C3DE_OK);
    CHECK(force[1] > 0.0);
  }
  gained = f.momentum()[1];
  CHECK(gained > 0.0);
  CHECK(f.session.status().time_s > begin_s);
  REQUIRE(f.table->let_go(f.self, f.body) == C3DE_OK);
  for (int i = 0; i < 10; ++i) f.session.step();
  CHECK(std::abs(f.momentum()[1] - gained) < 0.2 * gained);  // the step in which it was let go still pulled
  REQUIRE(f.table->hold_force(f.self, f.body, force.data()) == C3DE_OK);
  CHECK(norm(force) == 0.0);
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
  CHECK(visit.names.size() == 12);
  for (const char *name : {"position", "velocity", "mass", "volume", "stress_vm", "normal"})
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
