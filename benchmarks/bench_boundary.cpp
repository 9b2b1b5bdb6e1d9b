// SPDX-License-Identifier: Apache-2.0
// Measures the cost of the plugin boundary. The members of each pair run in turns, so that a busy machine slows both.
//
//   a step of a body of 3 000 and 10 000 points with and without a force field that does nothing
//   a sum over 10 000 points through a view that the boundary lends, and over a C++ vector
//   10 000 rays into a tree through c3de.collision/1, and into the same tree in C++
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "bench/bodies.h"
#include "bench/command_line.h"
#include "bench/report.h"
#include "bench/timing.h"
#include "c3de/abi/c3de.h"
#include "c3de/collision/aabb_tree.h"
#include "c3de/core/platform.h"
#include "c3de/scene/force_fields.h"
#include "c3de/scene/simulation.h"
#include "c3de/sdk/view.hpp"
#include "c3de/session/body_sources.h"
#include "c3de/session/build_scene.h"
#include "c3de/session/session.h"
#include "host_state.h"
#include "plugin_context.h"

namespace {

using namespace c3de;

[[noreturn]] void giveUp(const std::string &why) {
  std::fprintf(stderr, "bench_boundary: %s\n", why.c_str());
  std::exit(1);
}

template <class T>
T orGiveUp(Expected<T> value) {
  if (!value) giveUp(value.error().message);
  return std::move(*value);
}

/// A free organ of about this number of points, in its own session, stepped by this benchmark.
class FreeOrgan {
 public:
  FreeOrgan(std::size_t points, unsigned threads) {
    session::SessionOptions options;
    options.searchPlugins = false;
    options.pluginFiles = {C3DE_POINTBASED};
    options.threads = threads;
    session_ = orGiveUp(session::Session::create(options));
    const std::string text = fmt::format(
        "format = 1\n[world]\ngravity = [0.0, 0.0, 0.0]\n[[body]]\nname = \"organ\"\nmesh = \"{}\"\nmesh_unit = "
        "\"mm\"\nangular_velocity = [0.0, 30.0, 10.0]\n"
        "[body.sampling]\ncount = {}\n",
        C3DE_ORGAN, points);
    const auto scene = orGiveUp(scene::parseScene(text, "bench.toml", &session_->materials()));
    simulator_ = orGiveUp(session_->createSimulator());
    session::BodySources sources;
    if (const auto built = session::buildScene(*session_, simulator_, scene, sources, {}); !built)
      giveUp(built.error().message);
    if (const auto adopted = session_->adoptForRun(simulator_, "organ"); !adopted) giveUp(adopted.error().message);
    table_ = session_->simulation()->table();
  }

  void step() {
    if (const auto begun = session_->simulation()->beginStep(); !begun) giveUp(begun.error().message);
    if (table_->step(simulator_) < 0) giveUp("a step failed");
    session_->simulation()->endStep();
  }
  [[nodiscard]] std::size_t points() {
    c3de_handle body{};
    c3de_sim_body_info info{};
    info.size = sizeof info;
    if (table_->body_at(simulator_, 0, &body) < 0 || table_->body_info(simulator_, body, &info) < 0) giveUp("no body");
    return info.points;
  }
  [[nodiscard]] scene::ForceFields &forces() { return session_->forces(); }

 private:
  std::unique_ptr<session::Session> session_;
  c3de_object *simulator_ = nullptr;  ///< released by the session
  const c3de_simulator_v1 *table_ = nullptr;
};

void fields(bench::Report &report, const bench::Options &options) {
  report.table(
      "force field that does nothing",
      {{"points", "points", 0}, {"plain_us", "step µs", 2}, {"field_us", "with field µs", 2}, {"ratio", "ratio", 3}});
  for (const std::size_t wanted : {3000u, 10000u}) {
    FreeOrgan plain(wanted, options.threads), other(wanted, options.threads);
    other.forces().add({"nothing", "bench", {}, [](const c3de_force_call &) { return C3DE_OK; }, {}});
    const auto times = bench::measureInTurns(options.seconds, {[&] { plain.step(); }, [&] { other.step(); }});
    report.row(
        {plain.points(), 1e3 * times[0].median_ms, 1e3 * times[1].median_ms, times[1].median_ms / times[0].median_ms});
  }
}

void views(bench::Report &report, const bench::Options &options) {
  constexpr std::size_t kPoints = 10000;
  std::vector<Vec3> points(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i)
    for (std::size_t c = 0; c < 3; ++c) points[i][c] = std::sin(static_cast<double>(3 * i + c));
  const c3de_view view{points.data(), points.size(), 3, C3DE_F64, sizeof(Vec3)};
  const auto direct = [&] {
    double sum = 0.0;
    for (const Vec3 &p : points) sum += p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    bench::keep(sum);
  };
  const auto through = [&] {
    double sum = 0.0;
    const auto rows = sdk::asRows<double, 3>(view, "points");
    if (!rows) giveUp(rows.failure().message);
    for (std::size_t i = 0; i < rows->size(); ++i) {
      const auto &p = (*rows)[i];
      sum += p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    }
    bench::keep(sum);
  };
  const auto times = bench::measureInTurns(options.seconds, {direct, through});
  report.table("reading 10 000 points",
               {{"direct_us", "vector µs", 3}, {"view_us", "view µs", 3}, {"ratio", "ratio", 3}});
  report.row({1e3 * times[0].median_ms, 1e3 * times[1].median_ms, times[1].median_ms / times[0].median_ms});
}

void rays(bench::Report &report, const bench::Options &options) {
  constexpr std::size_t kRays = 10000;
  // A bumpy sphere.
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  constexpr std::uint32_t kRings = 80, kSectors = 160;
  for (std::uint32_t i = 0; i <= kRings; ++i)
    for (std::uint32_t j = 0; j < kSectors; ++j) {
      const double theta = 3.14159265358979 * i / kRings, phi = 6.28318530717959 * j / kSectors;
      const double r = 100.0 + 5.0 * std::sin(9.0 * phi) * std::sin(7.0 * theta);
      vertices.push_back(
          {r * std::sin(theta) * std::cos(phi), r * std::cos(theta), r * std::sin(theta) * std::sin(phi)});
    }
  for (std::uint32_t i = 0; i < kRings; ++i)
    for (std::uint32_t j = 0; j < kSectors; ++j) {
      const std::uint32_t a = i * kSectors + j, b = i * kSectors + (j + 1) % kSectors;
      triangles.push_back({a, b, a + kSectors});
      triangles.push_back({b, b + kSectors, a + kSectors});
    }
  std::vector<Vec3> origins(kRays), directions(kRays);
  for (std::size_t i = 0; i < kRays; ++i) {
    const double t = static_cast<double>(i);
    origins[i] = {300.0 * std::sin(0.7 * t), 300.0 * std::cos(0.31 * t), 300.0 * std::sin(0.13 * t + 1.0)};
    for (std::size_t c = 0; c < 3; ++c) directions[i][c] = -origins[i][c] + 40.0 * std::sin(t + static_cast<double>(c));
  }
  const auto tree = orGiveUp(collision::AabbTree::build(vertices, triangles));

  ThreadPool pool(options.threads);
  plugin_host::Services services;
  services.pool = &pool;
  plugin_host::HostState state(services);
  plugin_host::PluginContext context(state, "bench");
  const c3de_collision_v1 &table = context.tables().collision;
  const auto viewOf = [](const auto &rows, std::uint32_t type) {
    return c3de_view{rows.data(), rows.size(), 3, type, sizeof rows[0]};
  };
  c3de_handle handle{};
  if (table.create(table.ctx, viewOf(vertices, C3DE_F64), viewOf(triangles, C3DE_U32), &handle) < 0) giveUp("no tree");
  std::vector<c3de_ray_hit> hits(kRays);
  std::vector<collision::RayHit> found(kRays);
  const auto direct = [&] {
    pool.parallelFor(kRays, 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) found[i] = tree.ray(origins[i], directions[i]);
    });
  };
  const auto through = [&] {
    if (table.rays(table.ctx, handle, viewOf(origins, C3DE_F64), viewOf(directions, C3DE_F64), HUGE_VAL, hits.data()) <
        0)
      giveUp("no rays");
  };
  const auto times = bench::measureInTurns(options.seconds, {direct, through});
  std::size_t same = 0;
  for (std::size_t i = 0; i < kRays; ++i) same += hits[i].triangle == found[i].triangle ? 1u : 0u;
  if (same != kRays) giveUp(fmt::format("{} of {} rays hit something else", kRays - same, kRays));
  report.table("10 000 rays", {{"direct_ms", "C++ ms", 3}, {"service_ms", "service ms", 3}, {"ratio", "ratio", 3}});
  report.row({times[0].median_ms, times[1].median_ms, times[1].median_ms / times[0].median_ms});
  context.revokeAll();
}

}  // namespace

int main(int argc, char **argv) {
  bench::CommandLine line("bench_boundary");
  if (const auto exit = line.parse(argc, argv)) return *exit;
  bench::Report report("bench_boundary", line.options());
  fields(report, line.options());
  views(report, line.options());
  rays(report, line.options());
  return report.write();
}
