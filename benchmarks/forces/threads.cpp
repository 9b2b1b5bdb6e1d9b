// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#ifdef C3DE_BENCH_TBB
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

#include "bench/bodies.h"
#include "bench/timing.h"
#include "forces/limit_kernels.h"
#include "forces/questions.h"

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
struct NamedLoop {
  std::string name;
  Loop loop;
};

#ifdef C3DE_BENCH_TBB
template <class Partitioner>
NamedLoop tbbLoop(const char *name, tbb::task_arena &arena) {
  return {name, [&arena](std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)> &body) {
            arena.execute([&] {
              tbb::parallel_for(
                  tbb::blocked_range<std::size_t>(0, n, grain),
                  [&](const tbb::blocked_range<std::size_t> &r) { body(r.begin(), r.end()); }, Partitioner());
            });
          }};
}
#endif

void forkJoin(bench::Report &report, const std::vector<NamedLoop> &loops, unsigned threads, double seconds) {
  report.table("fork-join",
               "loop; work_us=work us:0; gap_us=gap us:0; median_us=median us:2; p01_us=1 % us:2; p99_us=99 % us:2; "
               "speedup_median=speed-up:2; speedup_p01=1 %:2; overhead_p01_us=over ideal us:2");
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
      for (const NamedLoop &named : loops)
        functions.push_back([&named, &body, between] {
          if (between > 0) bench::keep(work(between));
          named.loop(kItems, kGrain, body);
        });
      std::vector<Timing> times = bench::measureInTurns(seconds, functions);
      const double gap_ms = 1e-3 * static_cast<double>(between) / rounds;
      for (std::size_t i = 0; i < loops.size(); ++i) {
        const auto us = [gap_ms](double ms) { return 1e3 * std::max(0.0, ms - gap_ms); };
        const double ideal = us(times[0].p01_ms) / threads;
        const bool hasWork = size > 0.0 && i > 0;
        report.row(
            {loops[i].name, size, gap, us(times[i].median_ms), us(times[i].p01_ms), us(times[i].p99_ms),
             hasWork ? bench::Report::Cell(us(times[0].median_ms) / us(times[i].median_ms)) : bench::Report::Cell(),
             hasWork ? bench::Report::Cell(us(times[0].p01_ms) / us(times[i].p01_ms)) : bench::Report::Cell(),
             i == 0 ? bench::Report::Cell() : bench::Report::Cell(us(times[i].p01_ms) - ideal)});
      }
    }
}

void steps(bench::Report &report, std::size_t phyxels, c3de::ThreadPool &pool, double seconds) {
  report.table("steps",
               "evaluation; what; phyxels; serial_median_us=1 thread us:1; parallel_median_us=parallel us:1; "
               "serial_p01_us=1 thread 1 %:1; parallel_p01_us=parallel 1 %:1; speedup_median=speed-up:2; "
               "speedup_p01=1 %:2");
  const ParallelFor serial = serialFor(), parallel = bench::parallelForOf(pool);
  const auto single = Precision::singlePrecision, twofold = Precision::doublePrecision;
  for (const auto &[lattice, precision] :
       {std::pair{true, twofold}, std::pair{true, single}, std::pair{false, twofold}}) {
    const auto rest = lattice ? bench::latticeBall(phyxels, 0, serial) : bench::cloudBall(phyxels, 0, serial);
    const auto still = bench::fallingBall(rest, precision), moving = bench::fallingBall(rest, precision),
               movingInParallel = bench::fallingBall(rest, precision, parallel);
    const std::vector<Timing> times =
        bench::measureInTurns(seconds, {[&] { bench::evaluateForces(still->body(), serial); },
                                        [&] { bench::evaluateForces(still->body(), parallel); },
                                        [&] { moving->step(); }, [&] { movingInParallel->step(); }});
    for (const std::size_t i : {0u, 2u}) {
      const Timing &one = times[i], &many = times[i + 1];
      const std::string evaluation = bench::evaluationName(still->body()), what = i == 0 ? "forces" : "substep";
      report.row({evaluation, what, rest->phyxelCount(), 1e3 * one.median_ms, 1e3 * many.median_ms, 1e3 * one.p01_ms,
                  1e3 * many.p01_ms, one.median_ms / many.median_ms, one.p01_ms / many.p01_ms});
      report.fact("speedup_p01_" + what + ", " + evaluation, one.p01_ms / many.p01_ms);
    }
  }
}

// The throughput of the processors when all of them multiply and add only in registers. Processors that share the units
// of one core have together the throughput of one, and no program of this kind can gain from the second.
void processors(bench::Report &report, c3de::ThreadPool &pool, unsigned threads, double seconds) {
  report.table("processors", "what; one_gflops=1 thread GFLOP/s:1; all_gflops=all GFLOP/s:1; speedup=speed-up:2");
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

void bench::measureThreads(const Options &options, Report &report) {
  const auto threads = static_cast<unsigned>(options.count("--threads", 2));
  const std::string only = options.text("--only");
  c3de::ThreadPool pool(threads);
  std::vector<NamedLoop> loops = {{"serial", serialFor()}, {"c3de::ThreadPool", parallelForOf(pool)}};
#ifdef C3DE_BENCH_TBB
  tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
  tbb::task_arena arena(static_cast<int>(threads));
  loops.push_back(tbbLoop<tbb::static_partitioner>("oneTBB static", arena));
  loops.push_back(tbbLoop<tbb::auto_partitioner>("oneTBB auto", arena));
#else
  report.note("built without oneTBB: no comparison");
#endif
  report.fact("threads_of_pool", threads);
  processors(report, pool, threads, options.seconds);
  if (only != "steps") forkJoin(report, loops, threads, options.seconds);
  if (only != "fork-join") steps(report, options.count("--phyxels", 3000), pool, options.seconds);
}
