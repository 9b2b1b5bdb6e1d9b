// SPDX-License-Identifier: Apache-2.0
// The default scene for very many steps, through the plugin: memory and step time are constant, energy does not grow.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>

#include "extreme_cases.h"
#include "simulator_session.h"
#include "support/catch.h"

using c3de::test::SimulatorSession;

namespace {

c3de_param_value flag(const char *id) {
  c3de_param_value value = SimulatorSession::number(id, 1.0);
  value.type = C3DE_PARAM_BOOL;
  return value;
}

// The settings of resources/scenes/first_light.toml.
c3de_handle openFirstLight(SimulatorSession &session) {
  const auto mesh = [](const char *name) {
    auto loaded = c3de::geometry::loadMesh(std::filesystem::path(testResourcesFolder()) / "meshes" / name,
                                           c3de::geometry::LengthUnit::millimetre);
    REQUIRE(loaded);
    return *loaded;
  };
  const auto number = SimulatorSession::number;
  const auto vector = SimulatorSession::vector;
  session.setWorld({vector("world.gravity", {0.0, -9.81, 0.0}), flag("world.box.enabled"),
                    vector("world.box.min", {-0.18, -0.03, -0.14}), vector("world.box.max", {0.24, 0.3, 0.14}),
                    number("solver.damping", 1.0)});
  session.addObstacle(mesh("obstacle_block.obj"), {}, 0.4);
  return session.addBody(
      mesh("organ.obj"), {{0.05, 0.16, 0.0}, 1.0},
      {number("material.youngs_modulus", 6e3), number("material.poisson_ratio", 0.45),
       number("material.density", 1060.0), number("material.viscosity", 5.0), number("sampling.count", 1000.0)});
}

struct Part {
  double median = 0.0, p99 = 0.0;      // µs of processor time, a step
  double energy = 0.0, kinetic = 0.0;  // J, means
  std::size_t memory = 0;              // bytes at its end
};

void run(std::uint64_t steps) {
  SimulatorSession session(1);
  (void)openFirstLight(session);
  double mass = 0.0;
  const auto energies = [&] {
    const nlohmann::json body = nlohmann::json::parse(session.report())["bodies"][0];
    mass = body["mass_kg"].get<double>();
    const nlohmann::json &e = body["energy_J"];
    const double kinetic = e["kinetic"].get<double>();
    return std::pair(
        kinetic, kinetic + e["elastic"].get<double>() + e["stabilisation"].get<double>() + e["gravity"].get<double>());
  };
  const double before = energies().second;
  constexpr std::uint64_t kParts = 10;
  const std::uint64_t tenth = steps / kParts, between = std::max<std::uint64_t>(1, tenth / 100);
  double most = before;
  std::vector<Part> parts;
  std::vector<float> times;
  times.reserve(100000);
  for (std::uint64_t k = 0; k < kParts; ++k) {
    Part part;
    times.clear();
    int looks = 0;
    for (std::uint64_t i = 0; i < tenth; ++i) {
      const std::clock_t start = std::clock();
      session.step();
      const std::clock_t end = std::clock();
      if (times.size() < times.capacity())
        times.push_back(static_cast<float>(1e6 * static_cast<double>(end - start) / CLOCKS_PER_SEC));
      if (i % between != 0) continue;
      const auto [kinetic, total] = energies();
      REQUIRE(std::isfinite(total));
      most = std::max(most, total);
      part.kinetic += kinetic;
      part.energy += total;
      ++looks;
    }
    part.kinetic /= looks;
    part.energy /= looks;
    std::sort(times.begin(), times.end());
    part.median = static_cast<double>(times[times.size() / 2]);
    part.p99 = static_cast<double>(times[times.size() * 99 / 100]);
    part.memory = extremes::residentMemory();
    parts.push_back(part);
    std::cout << (k + 1) * tenth << " steps, " << session.status().time_s << " s: median " << part.median << " µs, p99 "
              << part.p99 << " µs, memory " << part.memory / 1024 << " KiB, energy " << part.energy << " J, kinetic "
              << part.kinetic << " J" << std::endl;
  }
  CHECK(session.status().stopped == 0);
  // The organ falls 0.16 m or so.
  const double scale = mass * 9.81 * 0.16;
  CHECK(most <= before + 1e-3 * scale);
  for (std::size_t k = 1; k < parts.size(); ++k) CHECK(parts[k].energy <= parts[k - 1].energy + 1e-3 * scale);
  // In the first part it falls and meets the block in substeps; from the second on nothing changes. Memory: a page now
  // and then; a leak of a byte at every step would be ten million.
  const Part &early = parts[1], &late = parts.back();
  CHECK(late.memory <= early.memory + (1u << 20));
  CHECK(late.median <= 1.5 * early.median + 20.0);
  CHECK(late.p99 <= 2.0 * early.p99 + 100.0);
  const auto kib = [](std::size_t bytes) { return std::to_string(bytes / 1024); };
  extremes::row("default scene, " + extremes::text(static_cast<double>(steps)) + " steps",
                "energy at most " + extremes::text((most - before) / scale) +
                    " of m g h above the first, kinetic in the end " + extremes::text(late.kinetic) + " J; memory " +
                    kib(early.memory) + " → " + kib(late.memory) + " KiB; step " + extremes::text(early.median) +
                    " → " + extremes::text(late.median) + " µs, 99 %: " + extremes::text(early.p99) + " → " +
                    extremes::text(late.p99) + " µs");
}

}  // namespace

TEST_CASE("the default scene for 3000 steps: no energy from nowhere, memory and time flat") { run(3000); }
// C3DE_LONG_STEPS makes fewer, or more.
TEST_CASE("the default scene for 10 000 000 steps: no energy from nowhere, memory and time flat", "[.long]") {
  const char *fewer = std::getenv("C3DE_LONG_STEPS");
  run(fewer ? std::strtoull(fewer, nullptr, 10) : 10'000'000);
}
