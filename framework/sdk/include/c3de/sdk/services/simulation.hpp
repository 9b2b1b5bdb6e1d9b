// SPDX-License-Identifier: Apache-2.0
// Running simulations: found, watched, controlled, and forces on their bodies.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "c3de/sdk/guard.hpp"
#include "c3de/sdk/object.hpp"
#include "c3de/sdk/owned.hpp"
#include "c3de/sdk/services/service.hpp"

namespace c3de::sdk {

class SimulationWatch {
 public:
  SimulationWatch() noexcept = default;
  SimulationWatch(SimulationWatch &&) noexcept = default;
  SimulationWatch &operator=(SimulationWatch &&other) noexcept {
    if (this == &other) return *this;
    owned_.reset();  // before its functions go, which the simulation's thread may be calling
    functions_ = std::move(other.functions_);
    owned_ = std::move(other.owned_);
    return *this;
  }
  ~SimulationWatch() = default;
  explicit operator bool() const noexcept { return static_cast<bool>(owned_); }

 private:
  friend class Simulation;
  struct Functions {
    std::function<void(c3de_handle)> added, removed;
    std::function<void(c3de_handle, std::uint64_t, double)> stepped;
  };
  std::unique_ptr<Functions> functions_;
  Owned<c3de_simulation_v1, &c3de_simulation_v1::unwatch> owned_;  // goes first
};

/// Simulations that run. From revision 2 of the service they can be found and watched.
class Simulation : public Service<c3de_simulation_v1> {
 public:
  using Service::Service;
  struct Running {
    c3de_handle node{};
    std::string title;
    Ref<> object;  ///< answers iface.simulator
  };
  /// Those that there are. Any thread.
  [[nodiscard]] Result<std::vector<Running>> all() const {
    if (!isOfRevision2()) return Failure{C3DE_E_VERSION, "the host does not list simulations (revision 1)"};
    std::vector<Running> found;
    const auto each = [](void *visitor, const c3de_simulation_info *info) noexcept -> c3de_status {
      return guard([&] {
        static_cast<std::vector<Running> *>(visitor)->push_back(
            {info->node, std::string(text(info->title)), Ref<>::share(info->object)});
      });
    };
    if (auto done = call<&c3de_simulation_v1::enum_simulations>(static_cast<void *>(&found), +each); !done)
      return done.failure();
    return found;
  }
  /// That of a node: RunningSimulator(*simulations.find(node)). C3DE_E_NOT_FOUND: there is none. Any thread.
  [[nodiscard]] Result<Ref<>> find(c3de_handle node) const {
    auto running = all();
    if (!running) return running.failure();
    for (Running &one : *running)
      if (one.node.v == node.v) return std::move(one.object);
    return Failure{C3DE_E_NOT_FOUND, "there is no simulation of this node"};
  }
  /// Empty functions are not called. added() is called for those that there are, too. Main thread.
  /// @param stepped  after every step, on the simulation's thread: node, steps, time in s
  [[nodiscard]] Result<SimulationWatch> watch(std::function<void(c3de_handle)> added,
                                              std::function<void(c3de_handle)> removed,
                                              std::function<void(c3de_handle, std::uint64_t, double)> stepped) const {
    if (!isOfRevision2()) return Failure{C3DE_E_VERSION, "the host does not tell of simulations (revision 1)"};
    using Functions = SimulationWatch::Functions;
    SimulationWatch out;
    out.functions_ = std::make_unique<Functions>(Functions{std::move(added), std::move(removed), std::move(stepped)});
    const c3de_simulation_watch abi{
        sizeof(c3de_simulation_watch), 0, out.functions_.get(),
        [](void *self, c3de_handle node) noexcept {
          guardQuietly("added", [&] {
            if (const auto &f = static_cast<Functions *>(self)->added) f(node);
          });
        },
        [](void *self, c3de_handle node) noexcept {
          guardQuietly("removed", [&] {
            if (const auto &f = static_cast<Functions *>(self)->removed) f(node);
          });
        },
        out.functions_->stepped ? +[](void *self, c3de_handle node, std::uint64_t steps, double time_s) noexcept {
          guardQuietly("stepped", [&] { static_cast<Functions *>(self)->stepped(node, steps, time_s); });
        } : nullptr};
    auto owned = own<&c3de_simulation_v1::watch, Owned<c3de_simulation_v1, &c3de_simulation_v1::unwatch>>(&abi);
    if (!owned) return owned.failure();
    out.owned_ = std::move(*owned);
    return out;
  }
  /// @param action  C3DE_TRANSPORT_*
  Result<void> transport(c3de_handle node, std::uint32_t action) const {
    return call<&c3de_simulation_v1::transport>(node, action);
  }
  Result<void> setTargetRate(c3de_handle node, double rate) const {
    return call<&c3de_simulation_v1::set_target_rate>(node, rate);
  }
  Result<c3de_sim_transport> state(c3de_handle node) const {
    c3de_sim_transport out{};
    out.size = sizeof out;
    if (auto done = call<&c3de_simulation_v1::state>(node, &out); !done) return done.failure();
    return out;
  }
  /// Runs on the simulation's thread between two steps, soon, also while paused. Any thread.
  Result<void> post(c3de_handle node, std::function<void()> fn) const {
    auto box = std::make_unique<std::function<void()>>(std::move(fn));
    const auto run = [](void *self) noexcept {
      const std::unique_ptr<std::function<void()>> owned(static_cast<std::function<void()> *>(self));
      guardQuietly("command to the simulation", [&] { (*owned)(); });
    };
    if (auto posted = call<&c3de_simulation_v1::post>(node, static_cast<void *>(box.get()), +run); !posted)
      return posted.failure();
    (void)box.release();
    return {};
  }

 private:
  [[nodiscard]] bool isOfRevision2() const noexcept { return table() != nullptr && table()->rev >= 2; }
};

/// A field that acts until it is destroyed or removed.
class ForceField {
 public:
  ForceField() noexcept = default;
  ForceField(ForceField &&) noexcept = default;
  ForceField &operator=(ForceField &&other) noexcept {
    if (this == &other) return *this;
    remove();  // before its function goes, which the simulation's thread may be calling
    apply_ = std::move(other.apply_);
    owned_ = std::move(other.owned_);
    return *this;
  }
  ~ForceField() = default;
  [[nodiscard]] c3de_handle handle() const noexcept { return owned_.handle(); }
  explicit operator bool() const noexcept { return static_cast<bool>(owned_); }
  /// When this returns, the function is not running and will not be called again. Not from the function itself.
  void remove() noexcept {
    owned_.reset();
    apply_.reset();
  }

 private:
  friend class Forces;
  using Apply = std::function<Result<void>(const c3de_force_call &)>;
  std::unique_ptr<Apply> apply_;
  Owned<c3de_forces_v1, &c3de_forces_v1::remove> owned_;  // goes first
};

/// Forces on the bodies of running simulations. Any thread.
class Forces : public Service<c3de_forces_v1> {
 public:
  using Service::Service;
  /// @param apply       adds forces to the points of a body before each step, on the simulation's thread; may throw
  /// @param simulation  its scene node, or 0: all
  Result<ForceField> add(std::string_view name, std::function<Result<void>(const c3de_force_call &)> apply,
                         c3de_handle simulation = {}) const {
    ForceField out;
    out.apply_ = std::make_unique<ForceField::Apply>(std::move(apply));
    const auto run = [](void *self, const c3de_force_call *call) noexcept -> c3de_status {
      return guard([&] { return (*static_cast<ForceField::Apply *>(self))(*call); });
    };
    const c3de_force_field field{sizeof(c3de_force_field), 0, str(name), out.apply_.get(), +run};
    auto owned = own<&c3de_forces_v1::add, Owned<c3de_forces_v1, &c3de_forces_v1::remove>>(simulation, &field);
    if (!owned) return owned.failure();
    out.owned_ = std::move(*owned);
    return out;
  }
};

}  // namespace c3de::sdk
