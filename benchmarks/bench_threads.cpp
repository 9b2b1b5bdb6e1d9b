// SPDX-License-Identifier: Apache-2.0
// Measures the cost of a fork-join and the speed-up of a step of 3 000 phyxels on two threads.
//
//   bench_threads [--only fork-join|steps] [--phyxels N] [--threads N] [--seconds S] [--csv FILE] [--json FILE]
//
// fork-join  loops of 0, 10, 50 and 200 µs of work (arithmetic without memory), one after the other and with 30 µs of
//            work of the caller alone in between (subtracted), serial, by c3de::ThreadPool, and by oneTBB's
//            parallel_for (static and automatic partitioner) if it was present at build time
// steps      forces and explicit substeps of balls, 1 thread against --threads (2 by default)
//
// All in turns. "median" is the time at the present load of the machine; "1 %" is the first percentile, the time
// without other load: under other load a second thread is not available half of the time. speed-up: serial over
// parallel, each of both.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#ifdef C3DE_BENCH_TBB
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

#include "bench/bodies.h"
#include "bench/report.h"
#include "bench/timing.h"
#include "limit_kernels.h"
#include "pointbased/simulator.h"

namespace {

using namespace pointbased;
using bench::Timing;

constexpr std::size_t kItems = 4096, kGrain = 64;
constexpr double kGap_us = 30.0;

// Dependent multiplications: the time does not depend on the contents of the caches.
double work(std::size_t rounds, double x = 1.0) {
  for (std::size_t i = 0; i < rounds; ++i) x = x * 0.999999 + 1e-9;
  return x;
}

/// Rounds of work() in a microsecond.
double roundsPerMicrosecond() {
  constexpr std::size_t kRounds = 100000;
  const Timing t = bench::measure(0.2, [] { bench::keep(work(kRounds)); });
  return static_cast<double>(kRounds) / (1e3 * t.least_ms);
}

using Loop =
    std::function<void(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)> &)>;
struct Way {
  std::string name;
  Loop loop;
};

#ifdef C3DE_BENCH_TBB
template <class Partitioner>
Way tbbWay(const char *name, tbb::task_arena &arena) {
  return {name, [&arena](std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)> &body) {
            arena.execute([&] {
              tbb::parallel_for(
                  tbb::blocked_range<std::size_t>(0, n, grain),
                  [&](const tbb::blocked_range<std::size_t> &r) { body(r.begin(), r.end()); }, Partitioner());
            });
          }};
}
#endif

void forkJoin(bench::Report &report, const std::vector<Way> &ways, unsigned threads, double seconds) {
  report.table("fork-join", {{"way", "way             "},
                             {"work_us", "work us", 0},
                             {"gap_us", "gap us", 0},
                             {"median_us", "median us", 2},
                             {"p01_us", "1 % us", 2},
                             {"p99_us", "99 % us", 2},
                             {"speedup_median", "speed-up", 2},
                             {"speedup_p01", "1 %", 2},
                             {"overhead_p01_us", "over ideal us", 2}});
  const double rounds = roundsPerMicrosecond();
  for (const double gap : {0.0, kGap_us})
    for (const double size : {0.0, 10.0, 50.0, 200.0}) {
      const auto perItem = static_cast<std::size_t>(std::lround(size * rounds / kItems));
      const auto between = static_cast<std::size_t>(gap * rounds);
      std::vector<double> sums(kItems);
      const std::function<void(std::size_t, std::size_t)> body = [&](std::size_t begin, std::size_t end) {
        if (perItem > 0)
          for (std::size_t i = begin; i < end; ++i) sums[i] = work(perItem, i > begin ? sums[i - 1] : 1.0);
      };
      std::vector<std::function<void()>> functions;
      for (const Way &way : ways)
        functions.push_back([&way, &body, between] {
          if (between > 0) bench::keep(work(between));
          way.loop(kItems, kGrain, body);
        });
      std::vector<Timing> times = bench::measureInTurns(seconds, functions);
      const double gap_ms = 1e-3 * static_cast<double>(between) / rounds;
      for (std::size_t i = 0; i < ways.size(); ++i) {
        const auto us = [gap_ms](double ms) { return 1e3 * std::max(0.0, ms - gap_ms); };
        const double ideal = us(times[0].p01_ms) / threads;
        const bool hasWork = size > 0.0 && i > 0;
        report.row(
            {ways[i].name, size, gap, us(times[i].median_ms), us(times[i].p01_ms), us(times[i].p99_ms),
             hasWork ? bench::Report::Cell(us(times[0].median_ms) / us(times[i].median_ms)) : bench::Report::Cell(),
             hasWork ? bench::Report::Cell(us(times[0].p01_ms) / us(times[i].p01_ms)) : bench::Report::Cell(),
             i == 0 ? bench::Report::Cell() : bench::Report::Cell(us(times[i].p01_ms) - ideal)});
      }
    }
}

struct Stepping {
  Stepping(const std::shared_ptr<const RestState> &rest, Precision precision, const ParallelFor &loops)
      : parallelFor(loops), simulator(loops) {
    const Constitution constitution = bench::constitutionFor(*rest);
    forces = std::make_unique<Body>("ball", rest, constitution, parallelFor);
    forces->setPrecision(precision);
    bench::deform(*forces);
    WorldSettings world;
    world.gravity = Vec3(0, -9.81, 0);
    world.dt = 0.5 * forces->stableStepAtRest();
    simulator.setWorld(world);
    Body &body = *simulator.body(simulator.addBody(std::make_unique<Body>("ball", rest, constitution, parallelFor)));
    body.setPrecision(precision);
    bench::deform(body);
  }
  ParallelFor parallelFor;
  std::unique_ptr<Body> forces;
  Simulator simulator;
  bool failed = false;
};

bool steps(bench::Report &report, std::size_t phyxels, c3de::ThreadPool &pool, double seconds) {
  report.table("steps", {{"evaluation", "evaluation          "},
                         {"phyxels", "phyxels"},
                         {"what", "what   "},
                         {"serial_median_us", "1 thread us", 1},
                         {"parallel_median_us", "parallel us", 1},
                         {"serial_p01_us", "1 thread 1 %", 1},
                         {"parallel_p01_us", "parallel 1 %", 1},
                         {"speedup_median", "speed-up", 2},
                         {"speedup_p01", "1 %", 2}});
  const auto single = Precision::singlePrecision, twofold = Precision::doublePrecision;
  for (const auto &[lattice, precision] :
       {std::pair{true, twofold}, std::pair{true, single}, std::pair{false, twofold}}) {
    const auto rest = lattice ? bench::latticeBall(phyxels, 0, serialFor()) : bench::cloudBall(phyxels, 0, serialFor());
    Stepping serial(rest, precision, serialFor()), parallel(rest, precision, bench::parallelForOf(pool));
    const auto step = [](Stepping &s) { s.failed = s.failed || !s.simulator.step().has_value(); };
    const std::vector<Timing> times =
        bench::measureInTurns(seconds, {[&] { bench::evaluateForces(*serial.forces, serial.parallelFor); },
                                        [&] { bench::evaluateForces(*parallel.forces, parallel.parallelFor); },
                                        [&] { step(serial); }, [&] { step(parallel); }});
    if (serial.failed || parallel.failed) return false;
    for (const std::size_t i : {0u, 2u}) {
      const Timing &one = times[i], &many = times[i + 1];
      report.row({bench::evaluationName(*serial.forces), rest->phyxelCount(), i == 0 ? "forces" : "substep",
                  1e3 * one.median_ms, 1e3 * many.median_ms, 1e3 * one.p01_ms, 1e3 * many.p01_ms,
                  one.median_ms / many.median_ms, one.p01_ms / many.p01_ms});
      report.fact(
          std::string("speedup_p01_") + (i == 0 ? "forces, " : "substep, ") + bench::evaluationName(*serial.forces),
          one.p01_ms / many.p01_ms);
    }
  }
  return true;
}

// The throughput of the processors when all of them multiply and add only in registers. Processors that share the units
// of one core have together the throughput of one, and no program of this kind can gain from the second.
void processors(bench::Report &report, c3de::ThreadPool &pool, unsigned threads, double seconds) {
  report.table("processors", {{"what", "what                "},
                              {"one_gflops", "1 thread GFLOP/s", 1},
                              {"all_gflops", "all GFLOP/s", 1},
                              {"speedup", "speed-up", 2}});
  constexpr std::size_t kRounds = 200000;
  double operations = 0.0;
  const auto chain = [&] {
    float out{};
    operations = limits::multiplyAdds(0.5f, kRounds, out);
    bench::keep(static_cast<double>(out));
  };
  const std::vector<bench::Timing> t = bench::measureInTurns(
      seconds, {chain, [&] {
                  pool.parallelFor(threads, 1, [](std::size_t begin, std::size_t end) {
                    for (std::size_t i = begin; i < end; ++i) {
                      float out{};
                      bench::keep(limits::multiplyAdds(0.5f, kRounds, out) + static_cast<double>(out));
                    }
                  });
                }});
  const double one = operations / t[0].median_ms, all = threads * operations / t[1].median_ms;
  report.row({"multiply-add, float", 1e-6 * one, 1e-6 * all, all / one});
  report.fact("speedup_of_multiply_add", all / one);
}

}  // namespace

int main(int argc, char **argv) {
  std::size_t phyxels = 3000;
  bench::CommandLine line("bench_threads");
  line.defaults.threads = 2;
  line.add("--phyxels", "N", [&](const std::string &text) { phyxels = std::strtoul(text.c_str(), nullptr, 10); });
  std::string only;
  line.add("--only", "fork-join|steps", [&](const std::string &text) { only = text; });
  if (const auto exit = line.parse(argc, argv)) return *exit;
  const bench::Options &options = line.options();
  bench::Report report(line.name(), options);
  c3de::ThreadPool pool(options.threads);
  std::vector<Way> ways = {
      {"serial", serialFor()},
      {"c3de::ThreadPool", bench::parallelForOf(pool)},
  };
#ifdef C3DE_BENCH_TBB
  tbb::global_control control(tbb::global_control::max_allowed_parallelism, options.threads);
  tbb::task_arena arena(static_cast<int>(options.threads));
  ways.push_back(tbbWay<tbb::static_partitioner>("oneTBB static", arena));
  ways.push_back(tbbWay<tbb::auto_partitioner>("oneTBB auto", arena));
#else
  report.note("built without oneTBB: no comparison");
#endif
  processors(report, pool, options.threads, options.seconds);
  if (only != "steps") forkJoin(report, ways, options.threads, options.seconds);
  if (only != "fork-join" && !steps(report, phyxels, pool, options.seconds)) {
    std::fprintf(stderr, "bench_threads: a step failed\n");
    return 1;
  }
  return report.write();
}
