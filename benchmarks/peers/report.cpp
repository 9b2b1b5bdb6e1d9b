// SPDX-License-Identifier: Apache-2.0
#include "report.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
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

void tell(const char *what, const Row *bullet, const Row *engine, nlohmann::ordered_json &out) {
  if (!bullet || !engine) {
    std::printf("  %-44s none\n", what);
    return;
  }
  const double ratio = bullet->cost.perSecondMs / engine->cost.perSecondMs;
  const auto side = [](const Row &row) {
    char text[96];
    std::snprintf(text, sizeof text, "%s, %zu nodes", row.model.c_str(), row.nodes);
    if (!std::isfinite(row.error)) return std::string(text);
    char error[32];
    std::snprintf(error, sizeof error, ", %.2f %%", 100.0 * row.error);
    return text + std::string(error);
  };
  std::printf("  %-44s %8.2fx   Bullet %s  /  C3DE %s\n", what, ratio, side(*bullet).c_str(), side(*engine).c_str());
  out.push_back({{"comparison", what},
                 {"ratio", ratio},
                 {"bullet", bullet->model},
                 {"bullet_nodes", bullet->nodes},
                 {"bullet_error", bullet->error},
                 {"engine", engine->model},
                 {"engine_nodes", engine->nodes},
                 {"engine_error", engine->error}});
}

bool isFem(const Row &row) { return row.kind == Kind::fem; }
bool isEngine(const Row &row) { return row.kind == Kind::engine; }

}  // namespace

void printHead(const std::string &scene, const std::string &what) {
  std::printf("\n%s\n%s\n%-12s %-32s %7s %10s %10s %12s %12s %9s\n", scene.c_str(), what.c_str(), "engine", "model",
              "nodes", "step ms", "CPU/step", "CPU ms per s", "at rest mm", "error %");
}

void printRow(const Row &row) {
  std::printf("%-12s %-32s %7zu ", isEngine(row) ? "C3DE" : "Bullet", row.model.c_str(), row.nodes);
  if (row.cost.stable) {
    std::printf("%10.4f %10.4f %12.1f ", 1e3 * row.cost.dt, row.cost.stepMs, row.cost.perSecondMs);
  } else {
    std::printf("%34s ", "no stable step");
  }
  if (std::isfinite(row.settled)) {
    std::printf("%12.4f ", 1e3 * row.settled);
    if (std::isfinite(row.error)) std::printf("%9.2f", 100.0 * row.error);
  } else {
    std::printf("%22s", "not at rest");
  }
  std::printf("\n");
  std::fflush(stdout);
}

void printRatios(std::span<const Row> rows, nlohmann::ordered_json &out) {
  std::set<std::size_t> sizes;
  for (const Row &row : rows)
    if (!isEngine(row)) sizes.insert(row.wanted);
  std::printf(
      "\nBullet's cost over this engine's (above 1: this engine is faster), and who is compared, with its error at "
      "rest\n");
  for (const std::size_t size : sizes) {
    const auto here = [&](const Row &row) { return row.wanted == size; };
    const Row *engine = cheapest(rows, [&](const Row &r) { return isEngine(r) && here(r); });
    const Row *fem = cheapest(rows, [&](const Row &r) { return isFem(r) && here(r); });
    std::printf("%zu nodes\n", size);
    tell("equal nodes, cheapest FEM", fem, engine, out);
    tell("equal nodes, cheapest implicit FEM",
         cheapest(rows,
                  [&](const Row &r) { return isFem(r) && here(r) && r.model.find("implicit") != std::string::npos; }),
         engine, out);
    tell("equal nodes, mass-spring",
         cheapest(rows, [&](const Row &r) { return r.kind == Kind::massSpring && here(r); }), engine, out);
    if (fem && std::isfinite(fem->error))
      tell("equal or smaller error, cheapest FEM", fem,
           cheapest(rows, [&](const Row &r) { return isEngine(r) && std::abs(r.error) <= std::abs(fem->error); }), out);
  }
  double least = INFINITY;
  for (const Row &row : rows)
    if (isFem(row) && row.cost.stable && std::abs(row.error) < least) least = std::abs(row.error);
  if (!std::isfinite(least)) return;
  constexpr double kTie = 1e-3;  // forces of one mesh differ by less than this
  std::printf("of all sizes\n");
  tell("equal or smaller error, FEM at its best",
       cheapest(rows, [&](const Row &r) { return isFem(r) && std::abs(r.error) <= least + kTie; }),
       cheapest(rows, [&](const Row &r) { return isEngine(r) && std::abs(r.error) <= least; }), out);
}

nlohmann::ordered_json toJson(const Row &row) {
  nlohmann::ordered_json json = {{"scene", row.scene},
                                 {"engine", isEngine(row) ? "c3de" : "bullet"},
                                 {"model", row.model},
                                 {"nodes", row.nodes},
                                 {"stable", row.cost.stable}};
  if (row.cost.stable) {
    json["step_s"] = row.cost.dt;
    json["processor_ms_per_step"] = row.cost.stepMs;
    json["processor_ms_per_simulated_s"] = row.cost.perSecondMs;
    json["timed_simulated_s"] = row.cost.simulated;
  }
  if (std::isfinite(row.settled)) json["at_rest_m"] = row.settled;
  if (std::isfinite(row.error)) json["error"] = row.error;
  return json;
}

}  // namespace peers
