// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "measure.h"

namespace peers {

enum class Kind { engine, fem, massSpring };

/// One method for one scene at one size.
struct Row {
  std::string scene, model;
  Kind kind = Kind::engine;
  std::size_t wanted = 0, nodes = 0;
  Cost cost;             ///< of the soft body
  double settled = 0.0;  ///< m, vertical, of the stiff body; NaN: none
  double error = 0.0;    ///< relative error of `settled`; NaN: none
};

void printHead(const std::string &scene, const std::string &what);
void printRow(const Row &row);
/// Bullet's cost over this engine's: at equal nodes, and at equal or smaller error.
void printRatios(std::span<const Row> rows, nlohmann::ordered_json &out);
[[nodiscard]] nlohmann::ordered_json toJson(const Row &row);

}  // namespace peers
