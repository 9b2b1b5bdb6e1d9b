// SPDX-License-Identifier: Apache-2.0
// What tests read from the automation state.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "c3de/core/vec.h"

namespace c3de::test {

/// Begins the ids of the widgets and rows in the panel of the point-based plugin.
inline const std::string kPanel = "pointbased.controller/";

/// Of a value; empty: there is none.
[[nodiscard]] std::string textOf(const nlohmann::json &state, const std::string &key);
/// At the beginning of a value; NaN: there is none.
[[nodiscard]] double numberOf(const nlohmann::json &state, const std::string &key);
/// Three numbers at the beginning of a value; 0: they are missing.
[[nodiscard]] Vec3 vectorOf(const nlohmann::json &state, const std::string &key);

/// Of a row in the panel of the point-based plugin.
[[nodiscard]] std::string row(const nlohmann::json &state, const std::string &name);
/// Of an image and its views.
[[nodiscard]] std::string imageText(const nlohmann::json &state, const std::string &key);
[[nodiscard]] double imageNumber(const nlohmann::json &state, const std::string &key);
/// |u| in the read-out of a slice, mm; NaN: there is none.
[[nodiscard]] double displacement_mm(const nlohmann::json &state, const std::string &pane);
/// Of the simulation: "playing", "paused", "stopped", "failed".
[[nodiscard]] std::string mode(const nlohmann::json &state);

}  // namespace c3de::test
