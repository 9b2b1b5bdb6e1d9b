// SPDX-License-Identifier: Apache-2.0
// Simulators of a plugin, with a small body.
#pragma once

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"
#include "trial.h"

namespace c3de::validate {

inline constexpr std::uint64_t kMaxBodies = 16;

/// A simulator of a class with the scene loaded.
class Simulated {
 public:
  Simulated(const Trial &trial, const std::string &classId) : refusal(build(trial, classId)) {}

  [[nodiscard]] c3de_object *object() const { return object_.get(); }
  [[nodiscard]] std::string errorText() const { return session_->plugins().takeError(); }
  /// The visible state: positions of the surfaces.
  [[nodiscard]] std::vector<Vec3> surface() const {
    std::vector<Vec3> all;
    c3de_handle body{};
    for (std::uint64_t i = 0; i < kMaxBodies && table->body_at(object(), i, &body) >= 0; ++i) {
      const auto part = session::surfacePositions(object(), body);
      all.insert(all.end(), part.begin(), part.end());
    }
    return all;
  }
  /// Hash of everything that determines the next steps.
  [[nodiscard]] std::uint64_t hash() const {
    std::uint64_t value = 0;
    return table->state_hash(object(), &value) < 0 ? 0 : value;
  }
  [[nodiscard]] std::string step(int n) const {
    for (int i = 0; i < n; ++i)
      if (const c3de_status status = table->step(object()); status < 0)
        return fmt::format("step {} answers {}: {}", i + 1, status, errorText());
    return {};
  }

 private:
  /// Why it cannot be built; empty if it was.
  [[nodiscard]] std::string build(const Trial &trial, const std::string &classId);

  std::unique_ptr<session::Session> session_;
  session::ObjectRef object_;  // destroyed first

 public:
  const c3de_simulator_v1 *table = nullptr;
  bool hasGravity = false;
  const std::string refusal;  ///< empty: it was built
};

/// Ids of the classes of the plugin that simulate.
[[nodiscard]] std::vector<std::string> simulatorClasses(const Trial &trial);

}  // namespace c3de::validate
