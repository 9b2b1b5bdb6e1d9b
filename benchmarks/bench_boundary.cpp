// SPDX-License-Identifier: Apache-2.0
// Measures the cost of the plugin boundary. The members of each pair run in turns, so that a busy machine slows both.
//
//   bench_boundary fields  a step of a body of 3 000 and 10 000 points with and without a force field that does nothing
//   bench_boundary views   a sum over 10 000 points through a view that the boundary lends, and over a C++ vector
//   bench_boundary rays    10 000 rays into a tree through c3de.collision/1, and into the same tree in C++
#include <fmt/format.h>

#include <cmath>

#include "bench/bodies.h"
#include "bench/report.h"
#include "c3de/collision/aabb_tree.h"
#include "c3de/geometry/mesh_io.h"
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

using bench::Options;
using bench::Report;
using bench::valueOf;

void check(bool good, const std::string &failure) {
  if (!good) throw std::runtime_error(failure);
}

/// A free organ of about this number of points, in its own session, stepped by this benchmark.
class FreeOrgan {
 public:
  FreeOrgan(std::size_t points, unsigned threads) {
    session::SessionOptions options;
    options.searchPlugins = false;
    options.pluginFiles = {C3DE_POINTBASED};
    options.threads = threads;
    session_ = valueOf(session::Session::create(options));
    const std::string text = fmt::format(
        "format = 1\n[world]\ngravity = [0.0, 0.0, 0.0]\n[[body]]\nname = \"organ\"\nmesh = \"{}\"\nmesh_unit = "
        "\"mm\"\nangular_velocity = [0.0, 30.0, 10.0]\n"
        "[body.sampling]\ncount = {}\n",
        C3DE_ORGAN, points);
    const auto scene = valueOf(scene::parseScene(text, "bench.toml", &session_->materials()));
    simulator_ = valueOf(session_->createSimulator());
    session::BodySources sources;
    valueOf(session::buildScene(*session_, simulator_, scene, sources, {}));
    valueOf(session_->adoptForRun(simulator_, "organ"));
    table_ = session_->simulation()->table();
  }

  void step() {
    valueOf(session_->simulation()->beginStep());
    check(table_->step(simulator_) >= 0, "a step failed");
    session_->simulation()->endStep();
  }
  [[nodiscard]] std::size_t points() {
    c3de_handle body{};
    c3de_sim_body_info info{};
    info.size = sizeof info;
    check(table_->body_at(simulator_, 0, &body) >= 0 && table_->body_info(simulator_, body, &info) >= 0, "no body");
    return info.points;
  }
  [[nodiscard]] scene::ForceFields &forces() { return session_->forces(); }

 private:
  std::unique_ptr<session::Session> session_;
  c3de_object *simulator_ = nullptr;  ///< released by the session
  const c3de_simulator_v1 *table_ = nullptr;
};

void measureFields(const Options &options, Report &report) {
  report.table("force field that does nothing", "points; plain_us=step µs:2; field_us=with field µs:2; ratio");
  for (const std::size_t wanted : {3000u, 10000u}) {
    FreeOrgan plain(wanted, options.threads), other(wanted, options.threads);
    other.forces().add({"nothing", "bench", {}, [](const c3de_force_call &) { return C3DE_OK; }, {}});
    const auto times = bench::measureInTurns(options.seconds, {[&] { plain.step(); }, [&] { other.step(); }});
    report.row(
        {plain.points(), 1e3 * times[0].median_ms, 1e3 * times[1].median_ms, times[1].median_ms / times[0].median_ms});
  }
}

void measureViews(const Options &options, Report &report) {
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
    if (!rows) throw std::runtime_error(rows.failure().message);
    for (std::size_t i = 0; i < rows->size(); ++i) {
      const auto &p = (*rows)[i];
      sum += p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    }
    bench::keep(sum);
  };
  const auto times = bench::measureInTurns(options.seconds, {direct, through});
  report.table("reading 10 000 points", "direct_us=vector µs; view_us=view µs; ratio");
  report.row({1e3 * times[0].median_ms, 1e3 * times[1].median_ms, times[1].median_ms / times[0].median_ms});
}

void measureRays(const Options &options, Report &report) {
  constexpr std::size_t kRays = 10000;
  const geometry::TriangleMesh organ = valueOf(geometry::loadMesh(C3DE_ORGAN, geometry::LengthUnit::millimetre)).mesh;
  std::vector<Vec3> origins(kRays), directions(kRays);
  for (std::size_t i = 0; i < kRays; ++i) {
    const double t = static_cast<double>(i);
    origins[i] = {300.0 * std::sin(0.7 * t), 300.0 * std::cos(0.31 * t), 300.0 * std::sin(0.13 * t + 1.0)};
    for (std::size_t c = 0; c < 3; ++c) directions[i][c] = -origins[i][c] + 40.0 * std::sin(t + static_cast<double>(c));
  }
  const auto tree = valueOf(collision::AabbTree::build(organ.vertices, organ.triangles));

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
  check(table.create(table.ctx, viewOf(organ.vertices, C3DE_F64), viewOf(organ.triangles, C3DE_U32), &handle) >= 0,
        "no tree");
  std::vector<c3de_ray_hit> hits(kRays);
  std::vector<collision::RayHit> found(kRays);
  const auto direct = [&] {
    pool.parallelFor(kRays, 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) found[i] = tree.ray(origins[i], directions[i]);
    });
  };
  const auto through = [&] {
    check(table.rays(table.ctx, handle, viewOf(origins, C3DE_F64), viewOf(directions, C3DE_F64), HUGE_VAL,
                     hits.data()) >= 0,
          "no rays");
  };
  const auto times = bench::measureInTurns(options.seconds, {direct, through});
  std::size_t same = 0;
  for (std::size_t i = 0; i < kRays; ++i) same += hits[i].triangle == found[i].triangle ? 1u : 0u;
  check(same == kRays, fmt::format("{} of {} rays hit something else", kRays - same, kRays));
  report.table("10 000 rays", "direct_ms=C++ ms; service_ms=service ms; ratio");
  report.row({times[0].median_ms, times[1].median_ms, times[1].median_ms / times[0].median_ms});
  context.revokeAll();
}

}  // namespace

int main(int argc, char **argv) {
  return bench::run("bench_boundary",
                    {{"fields", "", measureFields}, {"views", "", measureViews}, {"rays", "", measureRays}}, argc,
                    argv);
}
