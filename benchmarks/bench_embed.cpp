// SPDX-License-Identifier: Apache-2.0
// Measures what simulating through libc3de costs beyond the program's own loop.
//
//   bench_embed calls  calls of c3de/embed.h that make no step, and the first view of a field after a step
//   bench_embed steps  a step through the library against a step of the loop of `c3de run`, of the same organ in the
//                      same process. Steps of all take turns, so that a busy machine slows all of them; `control` is a
//                      second simulation of the program's loop: what differs between two equal ones is noise.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <vector>

#include "bench/report.h"
#include "bench/timing.h"
#include "c3de/embed.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/build_scene.h"
#include "c3de/session/session.h"
#include "c3de/session/simulation_step.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/step_times.h"

namespace {

using namespace c3de;

using bench::Options;
using bench::Report;
using bench::valueOf;

/// A free organ of about this number of points, which turns.
std::string sceneText(std::size_t points) {
  return fmt::format(
      "format = 1\n[world]\ngravity = [0.0, 0.0, 0.0]\n[[body]]\nname = \"organ\"\nmesh = \"{}\"\nmesh_unit = "
      "\"mm\"\nangular_velocity = [0.0, 30.0, 10.0]\n[body.sampling]\ncount = {}\n",
      C3DE_ORGAN, points);
}

void check(c3de_status status) {
  if (status < 0) throw std::runtime_error(c3de_embed_last_error());
}

/// Through the library.
class EmbeddedOrgan {
 public:
  EmbeddedOrgan(std::size_t points, unsigned threads) {
    const std::string text = sceneText(points);
    const char *plugins[] = {C3DE_POINTBASED};
    c3de_embed_options options{};
    options.size = sizeof options;
    options.flags = C3DE_EMBED_NO_PLUGIN_SEARCH;
    options.file = "bench.toml";
    options.text = text.c_str();
    options.plugin_files = plugins;
    options.plugin_files_n = 1;
    options.threads = threads;
    check(c3de_embed_open(&options, &sim_));
  }
  ~EmbeddedOrgan() { (void)c3de_embed_close(sim_); }
  EmbeddedOrgan(const EmbeddedOrgan &) = delete;
  EmbeddedOrgan &operator=(const EmbeddedOrgan &) = delete;

  void step() { check(c3de_embed_step(sim_, 1, nullptr)); }
  [[nodiscard]] c3de_sim sim() const { return sim_; }
  [[nodiscard]] std::uint64_t hash() const {
    std::uint64_t hash = 0;
    check(c3de_embed_state_hash(sim_, &hash));
    return hash;
  }
  [[nodiscard]] std::uint64_t points() const {
    c3de_embed_body body{};
    body.size = sizeof body;
    check(c3de_embed_body_at(sim_, 0, &body));
    return body.points;
  }

 private:
  c3de_sim sim_ = 0;
};

/// Through the loop of c3de run (HeadlessRun::stepToEnd), without its outputs.
class ProgramOrgan {
 public:
  ProgramOrgan(std::size_t points, unsigned threads) {
    session::SessionOptions options;
    options.searchPlugins = false;
    options.pluginFiles = {C3DE_POINTBASED};
    options.threads = threads;
    session_ = valueOf(session::Session::create(options));
    const auto scene = valueOf(scene::parseScene(sceneText(points), "bench.toml", &session_->materials()));
    simulator_ = valueOf(session_->createSimulator());
    session::BodySources sources;
    valueOf(session::buildScene(*session_, simulator_, scene, sources, {}));
    valueOf(session_->adoptForRun(simulator_, "organ"));
    table_ = session_->simulation()->table();
    owner_ = session_->plugins().ownerOf(simulator_);
  }
  ~ProgramOrgan() {
    session_->closeSimulation();
    simulator_->vt->release(simulator_);
  }
  ProgramOrgan(const ProgramOrgan &) = delete;
  ProgramOrgan &operator=(const ProgramOrgan &) = delete;

  void step() {
    const auto begin = std::chrono::steady_clock::now();
    if (valueOf(session::makeStep(*session_->simulation(), owner_)) < 0) throw std::runtime_error("a step failed");
    times_.add(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    session_->simulation()->endStep();
    bench::keep(valueOf(session::simulatorStatus(table_, simulator_)).time_s);
  }
  [[nodiscard]] std::uint64_t hash() const { return valueOf(session::stateHash(table_, simulator_)); }

 private:
  std::unique_ptr<session::Session> session_;
  c3de_object *simulator_ = nullptr;
  const c3de_simulator_v1 *table_ = nullptr;
  const char *owner_ = "";
  session::StepTimes times_;
};

/// @param part  0.5: the median
double quantileOf(std::vector<double> values, double part) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Of one loop, per step.
struct Times {
  std::vector<double> wall_ms, processor_ms;
};

void measureSteps(const Options &options, Report &report) {
  report.table("steps",
               "points; loop=step of:; wall_ms=wall ms:4; processor_ms=processor ms:4; fast_ms=fastest tenth ms:4; "
               "beyond_us=beyond µs:2; ratio=ratio:4; ratio_of_pairs=ratio (pairs):4");
  const std::size_t wanted = options.count("--points", 3000);
  ProgramOrgan program(wanted, options.threads), control(wanted, options.threads);
  EmbeddedOrgan embedded(wanted, options.threads);
  const std::array<std::function<void()>, 3> steps{[&] { program.step(); }, [&] { control.step(); },
                                                   [&] { embedded.step(); }};
  constexpr std::array<const char *, 3> kNames{"c3de run", "control", "libc3de"};
  std::array<Times, 3> times;
  const double end = bench::wall_ms() + 1e3 * 3.0 * options.seconds;
  constexpr std::size_t kWarmUp = 20;
  std::size_t made = 0;
  for (; made < kWarmUp + 101 || bench::wall_ms() < end; ++made)
    for (std::size_t turn = 0; turn < 3; ++turn) {
      // The order alternates, so that no loop always follows the same one.
      const std::size_t one = made % 2 == 0 ? (turn + made / 2) % 3 : 2 - (turn + made / 2) % 3;
      const double wall = bench::wall_ms(), processor = bench::processor_ms();
      steps[one]();
      const double took = bench::processor_ms() - processor;
      if (made < kWarmUp) continue;
      times[one].wall_ms.push_back(bench::wall_ms() - wall);
      times[one].processor_ms.push_back(took);
    }
  if (program.hash() != embedded.hash() || program.hash() != control.hash())
    throw std::runtime_error("the simulations differ");
  // The fastest tenth: steps that nothing else on the machine has slowed.
  constexpr double kFast = 0.1;
  const double base = quantileOf(times[0].processor_ms, kFast);
  for (std::size_t one = 0; one < 3; ++one) {
    const Times &own = times[one];
    std::vector<double> ratios;
    for (std::size_t i = 0; i < own.processor_ms.size(); ++i)
      ratios.push_back(own.processor_ms[i] / times[0].processor_ms[i]);
    const double fast = quantileOf(own.processor_ms, kFast);
    report.row({embedded.points(), kNames[one], quantileOf(own.wall_ms, 0.5), quantileOf(own.processor_ms, 0.5), fast,
                1e3 * (fast - base), fast / base, quantileOf(ratios, 0.5)});
  }
  report.note(fmt::format("{} steps of each, all with the same state hash", made));
}

void measureCalls(const Options &options, Report &report) {
  report.table("calls", "points; call; median_us=µs:3; p99_us=99 % µs:3");
  EmbeddedOrgan organ(options.count("--points", 3000), options.threads);
  const c3de_sim sim = organ.sim();
  organ.step();
  c3de_embed_status status{};
  status.size = sizeof status;
  c3de_embed_array view{};
  view.size = sizeof view;
  c3de_embed_value value{};
  value.size = sizeof value;
  c3de_embed_body body{};
  body.size = sizeof body;
  std::uint64_t index = 0;
  const auto position = [&] { check(c3de_embed_view_field(sim, 0, C3DE_EMBED_ON_POINTS, "position", &view)); };
  std::vector<double> memory(3 * organ.points());
  const std::vector<std::pair<const char *, std::function<void()>>> calls{
      {"c3de_embed_get_status", [&] { check(c3de_embed_get_status(sim, &status)); }},
      {"c3de_embed_body_at", [&] { check(c3de_embed_body_at(sim, 0, &body)); }},
      {"c3de_embed_find_body", [&] { check(c3de_embed_find_body(sim, "organ", &index)); }},
      {"c3de_embed_get", [&] { check(c3de_embed_get(sim, "body.organ.youngs_modulus", &value)); }},
      {"c3de_embed_view_field again", position},
      {"c3de_embed_read_field",
       [&] {
         check(c3de_embed_read_field(sim, 0, C3DE_EMBED_ON_POINTS, "position", memory.data(), 8 * memory.size()));
       }},
  };
  constexpr int kEach = 100;  // calls between two readings of the clock
  for (const auto &[name, call] : calls) {
    const auto timing = bench::measure(options.seconds, [&call = call] {
      for (int i = 0; i < kEach; ++i) call();
    });
    report.row({organ.points(), name, 1e3 * timing.median_ms / kEach, 1e3 * timing.p99_ms / kEach});
  }
  std::vector<double> first;
  const double end = bench::wall_ms() + 1e3 * options.seconds;
  while (first.size() < 101 || bench::wall_ms() < end) {
    organ.step();
    const double begin = bench::wall_ms();
    position();
    first.push_back(bench::wall_ms() - begin);
  }
  const auto timing = bench::summaryOf(first);
  report.row(
      {organ.points(), "c3de_embed_view_field, first after a step", 1e3 * timing.median_ms, 1e3 * timing.p99_ms});
}

}  // namespace

int main(int argc, char **argv) {
  return bench::run("bench_embed", {{"calls", "[--points N]", measureCalls}, {"steps", "[--points N]", measureSteps}},
                    argc, argv);
}
