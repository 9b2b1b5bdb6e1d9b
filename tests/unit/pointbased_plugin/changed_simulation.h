// SPDX-License-Identifier: Apache-2.0
// The point-based plugin in a host without a window, with simulators whose changes are recorded and repeated.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "c3de/abi/iface/changes.h"
#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/abi/iface/simulator.h"
#include "c3de/core/platform.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/plugin_host/plugin_host.h"
#include "simulator/change_kinds.h"
#include "support/catch.h"
#include "support/folders.h"
#include "trial_host.h"

namespace change_tests {

using namespace pointbased;

/// A closed box, mm; each face has n x n squares.
inline MeshData boxMesh(const Vec3 &low, const Vec3 &high, std::uint32_t n = 2) {
  MeshData out;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> corners;
  const auto corner = [&](const std::array<std::uint32_t, 3> &at) {
    const auto [found, isNew] = corners.emplace(at, static_cast<std::uint32_t>(corners.size()));
    if (isNew) {
      const Vec3 s = Vec3(at[0], at[1], at[2]) / n;
      out.positions_mm.emplace_back(low + s.cwiseProduct(high - low));
    }
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true})
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
          const auto at = [&](std::uint32_t di, std::uint32_t dj) {
            std::array<std::uint32_t, 3> place{};
            place[axis] = upper ? n : 0;
            place[(axis + 1) % 3] = i + di;
            place[(axis + 2) % 3] = j + dj;
            return corner(place);
          };
          std::array<std::uint32_t, 4> square{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
          if (!upper) std::swap(square[1], square[3]);
          out.triangles.push_back({square[0], square[1], square[2]});
          out.triangles.push_back({square[0], square[2], square[3]});
        }
  return out;
}

struct Recorded {
  std::string id, key, text, bytes;
  std::uint32_t flags = 0;
  std::uint64_t steps = 0, hashAfter = 0;
  [[nodiscard]] bool isLasting() const { return (flags & C3DE_SIM_CHANGE_TRANSIENT) == 0; }
};

class Host : public c3de::validate::TrialHost {
 public:
  Host() : TrialHost(std::filesystem::path(testOutputRoot()) / "changes-settings", Serves::headless) {
    REQUIRE(refusalOf(std::filesystem::path(testPluginFolder()) /
                      ("pointbased" + std::string(c3de::pluginExtension()))) == "");
  }
  c3de_handle mesh(const MeshData &data) {
    c3de::geometry::TriangleMesh raw;
    for (const Vec3 &x : data.positions_mm) raw.vertices.push_back({x[0], x[1], x[2]});
    for (const auto &t : data.triangles) raw.triangles.push_back({t[0], t[1], t[2]});
    auto built = c3de::geometry::buildMesh(std::move(raw), c3de::geometry::LengthUnit::millimetre);
    REQUIRE(built);
    return {meshes.add(std::move(*built)).bits()};
  }
};

/// Two soft cubes of 100 mm of the same name, 300 mm apart along x, above a plate. Every change is recorded.
class Simulation {
  Host &host_;

 public:
  explicit Simulation(Host &host) : host_(host) {
    const auto made = host.host->createObject("c3de.pointbased.WorldSimulator/1");
    REQUIRE(made);
    self = *made;
    sim = table<c3de_simulator_v1>(C3DE_IFACE_SIMULATOR_ID);
    changes = table<c3de_changes_v1>(C3DE_IFACE_CHANGES_ID);
    const std::array world{sdk::vec3Value("world.gravity", {0.0, 0.0, -9.81}),
                           sdk::choiceValue("solver.integrator", "explicit")};
    check(sim->set_world(self, world.data(), world.size(), sizeof world[0]));
    const std::array values{sdk::numberValue(C3DE_PARAM_ID_YOUNGS_MODULUS, 2e4),
                            sdk::integerValue("sampling.count", 60)};
    c3de_sim_placement placement{};
    placement.size = sizeof placement;
    placement.scale = 1.0;
    c3de_sim_body body{};
    body.size = sizeof body;
    body.name = {"cube", 4};
    body.mesh = host.mesh(boxMesh(Vec3::Constant(-50.0), Vec3::Constant(50.0)));
    body.placement = &placement;
    body.params = values.data();
    body.params_n = values.size();
    body.params_stride = sizeof values[0];
    for (c3de_handle &added : bodies) {
      check(sim->add_body(self, &body, &added));
      placement.position_m[0] += 0.3;
    }
    c3de_sim_obstacle obstacle{};
    obstacle.size = sizeof obstacle;
    obstacle.name = {"plate", 5};
    obstacle.mesh = host.mesh(boxMesh(Vec3(-100, -100, -70), Vec3(500, 100, -52)));
    check(sim->add_obstacle(self, &obstacle, &plate));
    check(changes->observe(self, this, &Simulation::changed));
  }
  ~Simulation() {
    (void)changes->observe(self, nullptr, nullptr);
    self->vt->release(self);
  }
  Simulation(const Simulation &) = delete;
  Simulation &operator=(const Simulation &) = delete;

  void check(c3de_status status) const {
    INFO(host_.host->takeError());
    REQUIRE(status >= 0);
  }
  void step(int n = 1) {
    for (int i = 0; i < n; ++i) check(sim->step(self));
  }
  void reset() { check(sim->reset(self)); }
  [[nodiscard]] std::uint64_t hash() const {
    std::uint64_t out = 0;
    check(sim->state_hash(self, &out));
    return out;
  }
  [[nodiscard]] std::uint64_t steps() const {
    c3de_sim_status status{};
    status.size = sizeof status;
    check(sim->status(self, &status));
    return status.steps;
  }
  [[nodiscard]] std::string save() const {
    std::string out;
    const auto put = [](void *to, const void *bytes, std::uint64_t n) -> c3de_status {
      static_cast<std::string *>(to)->append(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
      return C3DE_OK;
    };
    check(sim->save_state(self, {&out, put}));
    return out;
  }
  c3de_status tryApply(std::string_view id, std::string_view bytes) {
    c3de_sim_change change{};
    change.size = sizeof change;
    change.id = {id.data(), id.size()};
    change.bytes = bytes.data();
    change.n = bytes.size();
    const c3de_status status = changes->apply(self, &change);
    error = host_.host->takeError();
    return status;
  }
  template <class Kind>
  const Recorded &make(Kind change) {
    const c3de_status status = tryApply(Kind::kId, bytesOf(change));
    INFO(error);
    REQUIRE(status == C3DE_OK);
    return done();
  }
  /// A call of another interface that is a change.
  const Recorded &call(c3de_status status) {
    check(status);
    return done();
  }
  /// An interface of the simulator.
  template <class Table>
  const Table *table(std::string_view id) {
    const void *found = nullptr;
    REQUIRE(self->vt->query(self, {id.data(), id.size()}, 1, &found) == C3DE_OK);
    return static_cast<const Table *>(found);
  }
  /// Repeats a change at its step.
  void repeat(const Recorded &change) {
    INFO(change.id << " at step " << change.steps);
    while (steps() < change.steps) step();
    REQUIRE(steps() == change.steps);
    const c3de_status status = tryApply(change.id, change.bytes);
    INFO(error);
    REQUIRE(status == C3DE_OK);
    CHECK(hash() == change.hashAfter);
    (void)done();
  }

  c3de_object *self = nullptr;
  const c3de_simulator_v1 *sim = nullptr;
  const c3de_changes_v1 *changes = nullptr;
  std::array<c3de_handle, 2> bodies{};
  c3de_handle plate{};
  std::vector<Recorded> record;
  std::string error;

 private:
  static void C3DE_CALL changed(void *observer, const c3de_sim_change *change) {
    static_cast<Simulation *>(observer)->record.push_back(
        {std::string(sdk::text(change->id)), std::string(sdk::text(change->key)), std::string(sdk::text(change->text)),
         std::string(static_cast<const char *>(change->bytes), static_cast<std::size_t>(change->n)), change->flags,
         change->steps});
  }
  const Recorded &done() {
    REQUIRE(!record.empty());
    record.back().hashAfter = hash();
    return record.back();
  }
};

}  // namespace change_tests
