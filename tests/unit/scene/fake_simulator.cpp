// SPDX-License-Identifier: Apache-2.0
#include "fake_simulator.h"

#include <algorithm>
#include <string_view>
#include <thread>

#include "c3de/core/text.h"

FakeSimulator::FakeSimulator() {
  shared_.object.vt = &vt_;
  shared_.owner = this;
}

c3de_object_vt FakeSimulator::makeVt() {
  c3de_object_vt vt{};
  vt.size = sizeof vt;
  vt.retain = [](c3de_object *self) -> std::uint32_t { return static_cast<std::uint32_t>(++of(self).references_); };
  vt.release = [](c3de_object *self) -> std::uint32_t { return static_cast<std::uint32_t>(--of(self).references_); };
  vt.query = [](c3de_object *self, c3de_str id, std::uint32_t, const void **table) -> c3de_status {
    FakeSimulator &fake = of(self);
    if (!fake.answersInterface || c3de::fromAbi(id) != std::string_view(C3DE_IFACE_SIMULATOR_ID))
      return C3DE_E_NOT_FOUND;
    fake.table_.size = fake.tableSize;
    if (!fake.endsSteps) fake.table_.interrupt = nullptr;
    if (!fake.takesForces) fake.table_.points = nullptr;
    *table = &fake.table_;
    return C3DE_OK;
  };
  return vt;
}

c3de_simulator_v1 FakeSimulator::makeTable() {
  c3de_simulator_v1 table{};
  table.size = sizeof table;
  table.rev = 1;
  table.attach = [](c3de_object *, c3de_handle) -> c3de_status { return C3DE_OK; };
  table.declarations = [](c3de_object *, std::uint32_t, const c3de_param_decl **, std::uint64_t *n,
                          std::uint64_t *) -> c3de_status {
    *n = 0;
    return C3DE_OK;
  };
  table.set_world = [](c3de_object *, const c3de_param_value *, std::uint64_t, std::uint64_t) -> c3de_status {
    return C3DE_OK;
  };
  table.add_body = [](c3de_object *, const c3de_sim_body *, c3de_handle *) -> c3de_status { return C3DE_E_STATE; };
  table.add_obstacle = [](c3de_object *, const c3de_sim_obstacle *, c3de_handle *) -> c3de_status {
    return C3DE_E_STATE;
  };
  table.add_probe = [](c3de_object *, c3de_str, c3de_handle, const double *, c3de_handle *) -> c3de_status {
    return C3DE_E_STATE;
  };
  table.set_body_param = [](c3de_object *, c3de_handle, const c3de_param_value *) -> c3de_status { return C3DE_OK; };
  table.get_body_param = [](c3de_object *, c3de_handle, c3de_str, c3de_param_value *) -> c3de_status {
    return C3DE_E_NOT_FOUND;
  };
  table.remove = [](c3de_object *, c3de_handle) -> c3de_status { return C3DE_E_NOT_FOUND; };
  table.clear = [](c3de_object *) -> c3de_status { return C3DE_OK; };
  table.state_hash = [](c3de_object *, std::uint64_t *out) -> c3de_status {
    *out = 1;
    return C3DE_OK;
  };
  table.report = [](c3de_object *, c3de_sink) -> c3de_status { return C3DE_OK; };
  table.body_info = [](c3de_object *, c3de_handle, c3de_sim_body_info *) -> c3de_status { return C3DE_OK; };
  table.enum_fields = [](c3de_object *, c3de_handle, void *,
                         c3de_status(C3DE_CALL *)(void *, const c3de_sim_field *)) -> c3de_status { return C3DE_OK; };
  table.read_field = [](c3de_object *, c3de_handle, std::uint32_t, c3de_str, c3de_mview) -> c3de_status {
    return C3DE_E_NOT_FOUND;
  };
  table.triangles = [](c3de_object *, c3de_handle, c3de_view *) -> c3de_status { return C3DE_E_NOT_FOUND; };
  table.enum_probes = [](c3de_object *, void *,
                         c3de_status(C3DE_CALL *)(void *, const c3de_sim_probe *)) -> c3de_status { return C3DE_OK; };
  table.step = [](c3de_object *self) -> c3de_status {
    FakeSimulator &fake = of(self);
    const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(fake.stepCost_us);
    for (;;) {
      if (fake.interrupted) {
        ++fake.endedSteps;
        return C3DE_E_CANCELLED;
      }
      const auto left = end - std::chrono::steady_clock::now();
      if (left <= left.zero()) break;
      std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(left, std::chrono::milliseconds(5)));
    }
    if (fake.steps + 1 == fake.failAtStep) return C3DE_E_DIVERGED;
    if (fake.steps + 1 == fake.givesUpStep) return C3DE_E_TIMEOUT;
    fake.acted = fake.forces;
    ++fake.totalSteps;
    const bool finished = fake.finishesAtStep > 0 && fake.steps >= fake.finishesAtStep;
    if (!fake.standsStill && !finished) ++fake.steps;
    return C3DE_OK;
  };
  table.reset = [](c3de_object *self) -> c3de_status {
    FakeSimulator &fake = of(self);
    if (fake.resetFails) return C3DE_E_INTERNAL;
    ++fake.resets;
    fake.steps = 0;
    return C3DE_OK;
  };
  table.publish = [](c3de_object *self) -> c3de_status {
    FakeSimulator &fake = of(self);
    ++fake.publishes;
    fake.publishedStep = fake.steps.load();
    return C3DE_OK;
  };
  table.status = [](c3de_object *self, c3de_sim_status *out) -> c3de_status {
    FakeSimulator &fake = of(self);
    out->steps = fake.steps;
    out->dt_s = fake.dt_s;
    out->time_s = static_cast<double>(out->steps) * out->dt_s;
    out->bodies = fake.forces.size();
    if (fake.finishesAtStep == 0) return C3DE_OK;
    out->dt_s = out->time_s = 0.0;
    out->finished = out->steps >= fake.finishesAtStep ? 1u : 0u;
    return C3DE_OK;
  };
  table.interrupt = [](c3de_object *self, std::uint32_t raised) -> c3de_status {
    of(self).interrupted = raised != 0;
    return C3DE_OK;
  };
  table.body_at = [](c3de_object *self, std::uint64_t index, c3de_handle *out) -> c3de_status {
    if (index >= of(self).forces.size()) return C3DE_E_ARG;
    out->v = index + 1;
    return C3DE_OK;
  };
  table.points = [](c3de_object *self, c3de_handle body, c3de_sim_points *out) -> c3de_status {
    static const std::vector<double> kNumbers(3 * kPoints, 2.0);
    std::vector<double> &forces = of(self).forces.at(body.v - 1);
    std::fill(forces.begin(), forces.end(), 0.0);
    out->name = c3de::toAbi(body.v == 1 ? "first" : "second");
    out->count = kPoints;
    out->positions_m = out->velocities_m_s = out->masses_kg = kNumbers.data();
    out->forces_N = forces.data();
    return C3DE_OK;
  };
  table.activity = [](c3de_object *self, c3de_sink text) -> c3de_status {
    (void)self;
    static constexpr std::string_view kLine = "a heavy body: less of it would help";
    return text.put(text.self, kLine.data(), kLine.size());
  };
  return table;
}
