// SPDX-License-Identifier: Apache-2.0
// Forces of one plugin on the bodies of another's simulation, through the C tables from end to end.
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "c3de/geometry/mesh_io.h"
#include "simulator_session.h"
#include "support/catch.h"
#include "support/folders.h"

using namespace c3de;
using test::SimulatorSession;

namespace {

geometry::LoadedMesh organ() {
  auto mesh = geometry::loadMesh(std::filesystem::path(testResourcesFolder()) / "meshes/organ.obj",
                                 geometry::LengthUnit::millimetre);
  REQUIRE(mesh);
  return *mesh;
}

Vec3 momentumOf(SimulatorSession &session, c3de_handle body) {
  const std::vector<Vec3> velocities = session.phyxels(body, C3DE_SIM_FIELD_VELOCITY);
  const std::vector<double> masses = session.phyxelMasses(body);
  Vec3 sum{};
  for (std::size_t i = 0; i < masses.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) sum[c] += masses[i] * velocities[i][c];
  return sum;
}

/// The same force as the plugin in plugins/magnet.
void pull(const c3de_force_call &call) {
  constexpr std::array<double, 3> kPole{0.1, 0.4, 0.0};
  for (std::uint64_t i = 0; i < call.count; ++i) {
    std::array<double, 3> d{};
    double squared = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      d[c] = kPole[c] - call.positions_m[3 * i + c];
      squared += d[c] * d[c];
    }
    const double r = std::sqrt(squared), s = 1.0 + r / 0.1;
    for (std::size_t c = 0; c < 3; ++c) call.forces_N[3 * i + c] += 20.0 * call.masses_kg[i] / (s * s) * d[c] / r;
  }
}

}  // namespace

TEST_CASE("the momentum of a free organ under a plugin's forces is their impulse, to 1e-9") {
  SimulatorSession session(2);
  session.setWorld({SimulatorSession::vector("world.gravity", {0.0, 0.0, 0.0})});
  const c3de_handle body = session.addBody(organ(), {}, {SimulatorSession::number("sampling.count", 1000.0)});
  Vec3 impulse{}, force{};
  session.addForce([&](const c3de_force_call &call) {
    pull(call);
    force = {};
    for (std::uint64_t i = 0; i < 3 * call.count; ++i) force[i % 3] += call.forces_N[i];
  });
  for (int step = 0; step < 300; ++step) {
    const double before = session.status().time_s;
    session.step();
    for (std::size_t c = 0; c < 3; ++c) impulse[c] += (session.status().time_s - before) * force[c];
  }
  const Vec3 momentum = momentumOf(session, body);
  double size = 0.0, off = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    size += impulse[c] * impulse[c];
    off += (momentum[c] - impulse[c]) * (momentum[c] - impulse[c]);
  }
  REQUIRE(size > 0.0);
  CHECK(std::sqrt(off) <= 1e-9 * std::sqrt(size));
}

// The cost of the calls through the tables, beyond the field's own arithmetic: a command that prints, not a test.
TEST_CASE("what a field that does nothing adds to a step", "[.cost]") {
  SimulatorSession plain(1), pulled(1);
  pulled.addForce([](const c3de_force_call &call) { call.forces_N[0] = 1e-12; });
  for (SimulatorSession *session : {&plain, &pulled}) {
    // Awake, so that both do the same computations.
    const c3de_param_value awake{sizeof(c3de_param_value), C3DE_PARAM_BOOL, {"solver.sleep", 12}, 0.0, {}, {}};
    session->setWorld({SimulatorSession::vector("world.gravity", {0.0, -1.0, 0.0}), awake});
    (void)session->addBody(organ(), {}, {SimulatorSession::number("sampling.count", 3000.0)});
  }
  double spent[2] = {0.0, 0.0};
  for (int turn = 0; turn < 40; ++turn)
    for (int which = 0; which < 2; ++which) {
      SimulatorSession &session = which == 0 ? plain : pulled;
      const auto begin = std::chrono::steady_clock::now();
      for (int step = 0; step < 100; ++step) session.step();
      if (turn > 0) spent[which] += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
  std::printf("a step of 3 000 phyxels: %.1f us, with a field %.1f us, ratio %.3f\n", spent[0] / 3900 * 1e6,
              spent[1] / 3900 * 1e6, spent[1] / spent[0]);
}
