// SPDX-License-Identifier: Apache-2.0
#include <hwy/targets.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bench/bodies.h"
#include "bench/timing.h"
#include "forces/force_counts.h"
#include "forces/kernels/aligned_vector.h"
#include "forces/kernels/cell_kernel.h"
#include "forces/kernels/cell_layout.h"
#include "forces/limit_kernels.h"
#include "forces/questions.h"

namespace {

using namespace pointbased;
using bench::Timing;

constexpr std::size_t kRounds = 20000;
// Elements of each of the three arrays.
constexpr std::size_t kCacheTriad = 1 << 15, kLastCacheTriad = 1 << 20, kMemoryTriad = 1 << 23;

template <class T>
std::function<void()> chains(double &operations) {
  return [&operations] {
    T out{};
    operations = limits::multiplyAdds(T(0.5), kRounds, out);
    bench::keep(static_cast<double>(out));
  };
}

double perSecond(double count, const Timing &t) { return count / (1e-3 * t.median_ms); }

struct Limits {
  double single = 0.0, twofold = 0.0;                 // flop/s
  double cache = 0.0, lastCache = 0.0, memory = 0.0;  // bytes/s
};

Limits machine(bench::Report &report, double seconds) {
  report.table("machine", "what; size_MB=MB:2; gflops=GFLOP/s:1; gbytes=GB/s:1");
  Limits out;
  double singles = 0.0, doubles = 0.0;
  const std::vector<Timing> t = bench::measureInTurns(seconds, {chains<float>(singles), chains<double>(doubles)});
  out.single = perSecond(singles, t[0]);
  out.twofold = perSecond(doubles, t[1]);
  report.row({"multiply-add, float", nullptr, 1e-9 * out.single, nullptr});
  report.row({"multiply-add, double", nullptr, 1e-9 * out.twofold, nullptr});
  for (const std::size_t n : {kCacheTriad, kLastCacheTriad, kMemoryTriad}) {
    kernels::AlignedVector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
    const Timing time = bench::measure(seconds, [&] { limits::triad(a.data(), b.data(), c.data(), 0.5, n); });
    const double rate = perSecond(24.0 * static_cast<double>(n), time);
    (n == kCacheTriad ? out.cache : n == kLastCacheTriad ? out.lastCache : out.memory) = rate;
    report.row({"triad, double", 24e-6 * static_cast<double>(n), nullptr, 1e-9 * rate});
  }
  return out;
}

// No cell of these bodies is so far from rest that the scalar law would be called.
double noStress(const void *, std::size_t, const double *, double *) { return 1.0; }

// The kernel alone, as an evaluation calls it.
template <class T>
class CellKernel {
 public:
  explicit CellKernel(const Body &body) {
    const RestState &rest = body.rest();
    const std::uint8_t suits = 1;
    const kernels::CellPlan plan = kernels::planCells(rest.stencils, kernels::kLanes<T>, {&suits, 1});
    slices_ = kernels::sliceCells<T>(rest.stencils, plan);
    law_ = kernels::lawNumbers<T>(body.material(), body.constitution().stabilisation);
    for (const std::size_t used : plan.used) cells_ += used;
    displacements_ = body.state().displacements;
    partials_.resize(4 * slices_.phyxels.size());
  }
  void run() {
    kernels::CellJob<T> job;
    job.cells = &slices_;
    job.laws = {&law_, 1};
    job.hourglass = true;
    job.displacements = {displacements_.front().data(), displacements_.size()};
    job.partials = partials_.data();
    kernels::ScalarLaw scalar;
    scalar.stress = &noStress;
    kernels::cellForces(job, scalar, 0, slices_.chunks());
  }
  [[nodiscard]] std::size_t cells() const { return cells_; }
  /// Phyxels of all chunks: those shared by two chunks count in both.
  [[nodiscard]] std::size_t locals() const { return slices_.phyxels.size(); }
  [[nodiscard]] std::size_t numbers() const { return slices_.numbers.size(); }
  /// With the padding lanes: the cost of slices that are not full.
  [[nodiscard]] std::size_t lanes() const { return slices_.count() * kernels::kLanes<T>; }

 private:
  kernels::CellSlices<T> slices_;
  kernels::LawNumbers<T> law_;
  std::vector<Vec3> displacements_;
  kernels::AlignedVector<T> partials_;
  std::size_t cells_ = 0;
};

template <class T>
void forces(bench::Report &report, const Limits &limit, double seconds, std::size_t phyxels) {
  constexpr bool kSingle = sizeof(T) == 4;
  const auto rest = bench::latticeBall(phyxels, 0, serialFor());
  Body body("ball", rest, bench::constitutionFor(*rest), serialFor());
  body.setPrecision(kSingle ? Precision::singlePrecision : Precision::doublePrecision);
  bench::deform(body);
  CellKernel<T> kernel(body);
  double peakOperations = 0.0;
  const std::vector<Timing> t = bench::measureInTurns(
      seconds, {[&] { kernel.run(); }, [&] { bench::evaluateForces(body, serialFor()); }, chains<T>(peakOperations)});
  const double peak = perSecond(peakOperations, t[2]);
  const auto cells = static_cast<double>(kernel.cells()), n = static_cast<double>(rest->phyxelCount());
  const auto locals = static_cast<double>(kernel.locals());
  const double kernelBytes = cells * counts::kCellBytes + sizeof(T) * static_cast<double>(kernel.numbers()) +
                             locals * counts::localBytes(sizeof(T)) + n * counts::kFieldBytes;
  const double allBytes = kernelBytes + locals * counts::collectBytes(sizeof(T)) + n * counts::kForceBytes;
  const auto row = [&](const char *what, const Timing &time, double operations, double bytes) {
    // Chosen by the cache level in which the streamed data stays between evaluations.
    const double triad = bytes < 2e6 ? limit.cache : bytes < 24.0 * kLastCacheTriad ? limit.lastCache : limit.memory;
    report.row({what, kSingle ? "float" : "double", rest->phyxelCount(), kernel.cells(),
                100.0 * cells / static_cast<double>(kernel.lanes()), 1e3 * time.median_ms, 1e6 * time.median_ms / cells,
                operations / cells, 1e-9 * perSecond(operations, time), 100.0 * perSecond(operations, time) / peak,
                bytes / cells, 1e-9 * perSecond(bytes, time), 100.0 * perSecond(bytes, time) / triad});
  };
  row("kernel of cells", t[0], cells * counts::kCellOperations, kernelBytes);
  row("evaluation", t[1], cells * counts::kCellOperations + locals * counts::kCollectOperations, allBytes);
  report.fact(
      "percent_of_peak, " + std::string(kSingle ? "float" : "double") + ", " + std::to_string(rest->phyxelCount()),
      100.0 * perSecond(cells * counts::kCellOperations, t[0]) / peak);
}

}  // namespace

void bench::compareWithLimit(const Options &options, Report &report) {
  if (const std::string wanted = options.text("--target"); !wanted.empty()) {
    for (const auto target : {HWY_SSSE3, HWY_SSE4, HWY_AVX2, HWY_AVX3})
      if (hwy::TargetName(target) == wanted) hwy::SetSupportedTargetsForTest(static_cast<std::uint32_t>(target));
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    if (limits::target() != wanted)
      throw std::invalid_argument("'" + wanted + "' is not an instruction set of this machine and build");
  }
  report.note(std::string("instruction set ") + limits::target() + ", kernels of forces " + kernels::kernelTarget());
  report.fact("target", kernels::kernelTarget());
  const Limits limit = machine(report, options.seconds);
  report.table("forces",
               "what; precision; phyxels; cells; lanes_used_percent=lanes %:1; median_us=us:1; per_cell_ns=ns/cell:1; "
               "operations_per_cell=flop/cell:0; gflops=GFLOP/s:1; percent_of_peak=% of peak:1; "
               "bytes_per_cell=B/cell:0; gbytes=GB/s:1; percent_of_triad=% of triad:1");
  for (const std::size_t phyxels : {3000u, 30000u, 200000u}) {
    forces<float>(report, limit, options.seconds, phyxels);
    forces<double>(report, limit, options.seconds, phyxels);
  }
}
