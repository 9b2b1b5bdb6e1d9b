// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "bench/report.h"
#include "measure.h"

namespace peers {

enum class Kind { engine, fem, massSpring };

/// One method for one scene at one size.
struct Row {
  std::string model;
  Kind kind = Kind::engine;
  std::size_t wanted = 0, nodes = 0;
  Cost cost;             ///< of the soft body
  double settled = 0.0;  ///< m, vertical, of the stiff body; NaN: none
  double error = 0.0;    ///< relative error of `settled`; NaN: none
};

void beginRows(bench::Report &report, const std::string &scene);
void addRow(bench::Report &report, const Row &row);
/// Bullet's cost over this engine's: at equal nodes, and at equal or smaller error.
void addRatios(bench::Report &report, const std::string &scene, std::span<const Row> rows);

}  // namespace peers
