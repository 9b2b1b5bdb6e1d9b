// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "c3de/sdk/panel.hpp"
#include "c3de/sdk/params.hpp"
#include "c3de/sdk/services.hpp"
#include "pointbased/types.h"

namespace pointbased {

namespace sdk = c3de::sdk;

/// The host services that the plugin uses. Scene, render, panels, tools and history may be absent.
struct Services {
  explicit Services(sdk::Host h)
      : host(h), log(h), registry(h), meshes(h), scene(h), render(h), collision(h), params(h), jobs(h), time(h),
        simulation(h), notifier(h), history(h) {}

  sdk::Host host;
  sdk::Log log;
  sdk::Registry registry;
  sdk::Mesh meshes;
  sdk::Scene scene;
  sdk::Render render;
  sdk::Collision collision;
  sdk::Params params;
  sdk::Jobs jobs;
  sdk::Time time;
  sdk::Simulation simulation;
  sdk::Notifier notifier;
  sdk::History history;

  [[nodiscard]] ParallelFor parallelFor() const {
    return [j = jobs](std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)> &body) {
      j.parallelFor(n, grain, body);
    };
  }
};

/// The mesh service uses millimetres, the simulation metres: the inverse of the simulation node's transform.
inline constexpr double kMetresPerMillimetre = 1e-3;

/// Eigen vectors as rows of three doubles.
[[nodiscard]] inline c3de_view viewOf(std::span<const Vec3> values) {
  return {values.data(), values.size(), 3, C3DE_F64, static_cast<std::int64_t>(sizeof(Vec3))};
}

[[nodiscard]] inline sdk::Vec3 toArray(const Vec3 &v) { return {v[0], v[1], v[2]}; }
[[nodiscard]] inline Vec3 vectorOf(const std::array<float, 3> &v) { return {v[0], v[1], v[2]}; }

/// Rows of three floats.
[[nodiscard]] inline c3de_view viewOf(std::span<const std::array<float, 3>> values) {
  return {values.data(), values.size(), 3, C3DE_F32, static_cast<std::int64_t>(sizeof(std::array<float, 3>))};
}

}  // namespace pointbased
