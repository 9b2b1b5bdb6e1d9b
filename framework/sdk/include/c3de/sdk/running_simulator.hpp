// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "c3de/sdk/host.hpp"
#include "c3de/sdk/object.hpp"
#include "c3de/sdk/text.hpp"
#include "c3de/sdk/view.hpp"

namespace c3de::sdk {

/// A simulation of whatever plugin, through c3de.iface.simulator/1: its bodies, their fields, probes, loads and holds.
/// Units are SI, in the frame of the simulation. Every function is [sim]: call it from Simulation::post() or from
/// stepped() of a watch. Errors have the simulator's text; C3DE_E_UNSUPPORTED where it does not serve that.
class RunningSimulator {
 public:
  /// Of an object that does not simulate, an empty one.
  explicit RunningSimulator(Ref<> object = {})
      : object_(std::move(object)), table_(object_ ? object_.query<c3de_simulator_v1>() : nullptr) {}
  explicit operator bool() const noexcept { return table_ != nullptr; }
  /// For slots that have no function here; null of an empty one.
  [[nodiscard]] const c3de_simulator_v1 *table() const noexcept { return table_; }
  [[nodiscard]] c3de_object *abi() const noexcept { return object_.get(); }

  [[nodiscard]] Result<c3de_sim_status> status() const { return get<c3de_sim_status>(&c3de_simulator_v1::status); }
  /// In the order they were added.
  [[nodiscard]] Result<std::vector<c3de_handle>> bodies() const {
    const auto now = status();
    if (!now) return now.failure();
    std::vector<c3de_handle> all(static_cast<std::size_t>(now->bodies));
    for (std::size_t i = 0; i < all.size(); ++i)
      if (auto got = call(&c3de_simulator_v1::body_at, static_cast<std::uint64_t>(i), &all[i]); !got)
        return got.failure();
    return all;
  }
  /// Its name is valid until the body is removed.
  [[nodiscard]] Result<c3de_sim_body_info> info(c3de_handle body) const {
    return get<c3de_sim_body_info>(&c3de_simulator_v1::body_info, body);
  }

  struct Field {
    std::uint32_t on = 0, comps = 0;  ///< C3DE_SIM_ON_*; 1, 3 or 9
    std::string name, unit;
  };
  [[nodiscard]] Result<std::vector<Field>> fields(c3de_handle body) const {
    std::vector<Field> all;
    const auto each = [](void *visitor, const c3de_sim_field *field) noexcept -> c3de_status {
      return guard([&] {
        static_cast<std::vector<Field> *>(visitor)->push_back(
            {field->on, field->comps, std::string(text(field->name)), std::string(text(field->unit))});
      });
    };
    if (auto done = call(&c3de_simulator_v1::enum_fields, body, static_cast<void *>(&all), +each); !done)
      return done.failure();
    return all;
  }
  /// A field with one component, a row per point.
  /// @param on  C3DE_SIM_ON_POINTS or C3DE_SIM_ON_SURFACE
  [[nodiscard]] Result<std::vector<double>> numbers(c3de_handle body, std::uint32_t on, std::string_view name) const {
    return read<double, 1>(body, on, name);
  }
  /// A field with three components.
  [[nodiscard]] Result<std::vector<Vec3>> vectors(c3de_handle body, std::uint32_t on, std::string_view name) const {
    return read<Vec3, 3>(body, on, name);
  }

  struct ProbeReading {
    std::string name;
    c3de_handle body{};
    Vec3 reference_m{}, position_m{}, velocity_m_s{};
  };
  [[nodiscard]] Result<std::vector<ProbeReading>> probes() const {
    std::vector<ProbeReading> all;
    const auto each = [](void *visitor, const c3de_sim_probe *probe) noexcept -> c3de_status {
      return guard([&] {
        const auto vec = [](const double *v) { return Vec3{v[0], v[1], v[2]}; };
        static_cast<std::vector<ProbeReading> *>(visitor)->push_back({std::string(text(probe->name)), probe->body,
                                                                      vec(probe->reference_m), vec(probe->position_m),
                                                                      vec(probe->velocity_m_s)});
      });
    };
    if (auto done = call(&c3de_simulator_v1::enum_probes, static_cast<void *>(&all), +each); !done)
      return done.failure();
    return all;
  }

  /// A load more, from the next step on.
  [[nodiscard]] Result<c3de_handle> addLoad(c3de_handle body, const c3de_sim_load &load) const {
    c3de_handle out{};
    if (auto added = call(&c3de_simulator_v1::add_load, body, &load, &out); !added) return added.failure();
    return out;
  }
  /// Takes hold of a part of a body; pull() moves it, remove() lets go.
  [[nodiscard]] Result<c3de_handle> hold(c3de_handle body, const c3de_sim_hold &hold) const {
    c3de_handle out{};
    if (auto held = call(&c3de_simulator_v1::hold, body, &hold, &out); !held) return held.failure();
    return out;
  }
  /// @param rotation  x, y, z, w: how far what is held is turned since then
  Result<void> pull(c3de_handle hold, const Vec3 &target_m,
                    const std::optional<std::array<double, 4>> &rotation = {}) const {
    return call(&c3de_simulator_v1::pull, hold, target_m.data(), rotation ? rotation->data() : nullptr);
  }
  [[nodiscard]] Result<c3de_sim_hold_state> holdState(c3de_handle hold) const {
    return get<c3de_sim_hold_state>(&c3de_simulator_v1::hold_state, hold);
  }
  /// A load or a hold of one's own.
  Result<void> remove(c3de_handle what) const { return call(&c3de_simulator_v1::remove, what); }

 private:
  template <class... Slot, class... Args>
  Result<void> call(c3de_status (C3DE_CALL *c3de_simulator_v1::*slot)(c3de_object *, Slot...), Args... args) const {
    if (!table_) return Failure{C3DE_E_STATE, "no simulator"};
    if (table_->*slot == nullptr) return Failure{C3DE_E_UNSUPPORTED, "the simulator does not serve this"};
    const c3de_status status = (table_->*slot)(object_.get(), args...);
    if (status < 0) return currentHost().failure(status);
    return {};
  }
  template <class Struct, class Slot, class... Args>
  Result<Struct> get(Slot slot, Args... args) const {
    Struct out{};
    out.size = sizeof out;
    if (auto got = call(slot, args..., &out); !got) return got.failure();
    return out;
  }
  template <class Row, std::size_t kComps>
  Result<std::vector<Row>> read(c3de_handle body, std::uint32_t on, std::string_view name) const {
    const auto of = info(body);
    if (!of) return of.failure();
    std::vector<Row> out(static_cast<std::size_t>(on == C3DE_SIM_ON_SURFACE ? of->surface_points : of->points));
    if (auto got =
            call(&c3de_simulator_v1::read_field, body, on, str(name), mutableRows<double, kComps>(std::span(out)));
        !got)
      return got.failure();
    return out;
  }

  Ref<> object_;
  const c3de_simulator_v1 *table_ = nullptr;
};

}  // namespace c3de::sdk
