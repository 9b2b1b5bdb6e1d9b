// SPDX-License-Identifier: Apache-2.0
#include "report.h"

#include <cmath>
#include <set>

namespace peers {

namespace {

/// The cheapest of the stable ones that fulfil a condition; null: none.
template <class Condition>
const Row *cheapest(std::span<const Row> rows, const Condition &condition) {
  const Row *best = nullptr;
  for (const Row &row : rows)
    if (row.cost.stable && condition(row) && (!best || row.cost.perSecondMs < best->cost.perSecondMs)) best = &row;
  return best;
}

bool isFem(const Row &row) { return row.kind == Kind::fem; }
bool isEngine(const Row &row) { return row.kind == Kind::engine; }

}  // namespace

void beginRows(bench::Report &report, const std::string &scene) {
  report.table(scene,
               "engine; model; nodes; step_ms=step ms:4; processor_ms_per_step=CPU/step:4; "
               "processor_ms_per_simulated_s=CPU ms per s:1; at_rest_mm=at rest mm:4; error_percent=error %:2");
}

void addRow(bench::Report &report, const Row &row) {
  const auto cost = [&](double value) { return row.cost.stable ? bench::Report::Cell(value) : bench::Report::Cell(); };
  report.row({isEngine(row) ? "C3DE" : "Bullet", row.model, row.nodes, cost(1e3 * row.cost.dt), cost(row.cost.stepMs),
              cost(row.cost.perSecondMs), 1e3 * row.settled, 100.0 * row.error});
}

void addRatios(bench::Report &report, const std::string &scene, std::span<const Row> rows) {
  report.table("Bullet's cost over this engine's, " + scene + " (above 1: this engine is faster)",
               "comparison; nodes; ratio:2; bullet=Bullet; bullet_nodes=nodes; bullet_error_percent=error %:2; "
               "engine=C3DE; engine_nodes=nodes; engine_error_percent=error %:2");
  const auto compare = [&](const char *what, std::size_t size, const Row *bullet, const Row *engine) {
    if (bullet && engine)
      report.row({what, size > 0 ? bench::Report::Cell(size) : bench::Report::Cell("all"),
                  bullet->cost.perSecondMs / engine->cost.perSecondMs, bullet->model, bullet->nodes,
                  100.0 * bullet->error, engine->model, engine->nodes, 100.0 * engine->error});
    else
      report.row({what, size});
  };
  std::set<std::size_t> sizes;
  for (const Row &row : rows)
    if (!isEngine(row)) sizes.insert(row.wanted);
  for (const std::size_t size : sizes) {
    const auto here = [&](const Row &row) { return row.wanted == size; };
    const Row *engine = cheapest(rows, [&](const Row &r) { return isEngine(r) && here(r); });
    const Row *fem = cheapest(rows, [&](const Row &r) { return isFem(r) && here(r); });
    compare("equal nodes, cheapest FEM", size, fem, engine);
    compare(
        "equal nodes, cheapest implicit FEM", size,
        cheapest(rows,
                 [&](const Row &r) { return isFem(r) && here(r) && r.model.find("implicit") != std::string::npos; }),
        engine);
    compare("equal nodes, mass-spring", size,
            cheapest(rows, [&](const Row &r) { return r.kind == Kind::massSpring && here(r); }), engine);
    if (fem && std::isfinite(fem->error))
      compare("equal or smaller error, cheapest FEM", size, fem,
              cheapest(rows, [&](const Row &r) { return isEngine(r) && std::abs(r.error) <= std::abs(fem->error); }));
  }
  double least = INFINITY;
  for (const Row &row : rows)
    if (isFem(row) && row.cost.stable && std::abs(row.error) < least) least = std::abs(row.error);
  if (!std::isfinite(least)) return;
  constexpr double kTie = 1e-3;  // forces of one mesh differ by less than this
  compare("equal or smaller error, FEM at its best", 0,
          cheapest(rows, [&](const Row &r) { return isFem(r) && std::abs(r.error) <= least + kTie; }),
          cheapest(rows, [&](const Row &r) { return isEngine(r) && std::abs(r.error) <= least; }));
}

}  // namespace peers
