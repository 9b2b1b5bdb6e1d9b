// SPDX-License-Identifier: Apache-2.0
// Measures the cost per phyxel in small and large bodies, and its memory in bytes.
//
// Balls of 56 to 200 000 phyxels, on a lattice (stress points, in double and single precision) and as clouds (phyxels),
// neo-Hookean with stabilisation; without contact.
//
//   bench_scaling building   processor time from a closed mesh, a box and a liver by a formula, each held at one end,
//                            to a body ready for its first step, the least of three; and the longest time without a
//                            check for a stop request
//   bench_scaling cost       one evaluation of the internal forces, and one explicit step of Simulator: forces,
//                            integration and the guard; in turns, medians. A small ball has more surface, so fewer
//                            cells per phyxel: costs per evaluation point are also listed.
//   bench_scaling materials  the evaluation of 3 000 phyxels over a step of 1 ms with a material that flows or relaxes,
//                            relative to that of the elastic one
//   bench_scaling memory     the bytes allocated by operator new for the rest state and for the body, by counting; "of
//                            these" the vectors that are accessible from outside, by their sizes; and the additional
//                            memory of a rest state with surfels
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "bench/bodies.h"
#include "bench/heap.h"
#include "bench/report.h"
#include "bench/timing.h"
#include "mesh_body.h"

namespace {

using namespace pointbased;
using bench::Options;
using bench::Report;
using bench::Timing;

constexpr std::size_t kSizes[] = {56, 200, 1000, 3000, 10000, 30000, 100000, 200000};
constexpr std::size_t kSpreadFrom = 900;  // phyxels: lattices match the requested number only approximately

std::pair<std::size_t, std::size_t> sizesOf(const Options &options) {
  return {options.count("--least", 0), options.count("--most", 200000)};
}

template <class T>
double bytes(const std::vector<T> &v) {
  return static_cast<double>(v.size() * sizeof(T));
}
double bytes(const Csr &csr) { return bytes(csr.offsets) + bytes(csr.indices); }
double bytes(const Interpolation &binding) {
  return bytes(binding.positions) + bytes(binding.phyxels) + bytes(binding.weights) + bytes(binding.gradients) +
         bytes(binding.rank) + bytes(binding.frames) + bytes(binding.frameOf) + bytes(binding.offsets);
}
double bytes(const StencilSet &s) {
  return bytes(s.phyxels) + bytes(s.gradients) + bytes(s.shapes) + bytes(s.rowsOf) + bytes(s.weights) + bytes(s.modes) +
         bytes(s.variances) + bytes(s.materials) + bytes(s.volumes) + bytes(s.reference) + bytes(s.referenceInverse) +
         bytes(s.rank) + bytes(s.frames) + bytes(s.frameOf) + bytes(s.entriesOfPhyxel);
}

struct Built {
  std::shared_ptr<const RestState> rest;
  std::unique_ptr<Body> body;
  double restBytes = 0.0, bodyBytes = 0.0;
};

struct Kind {
  bool lattice = true;
  Precision precision = Precision::doublePrecision;
};
constexpr Kind kKinds[] = {
    {true, Precision::doublePrecision}, {true, Precision::singlePrecision}, {false, Precision::doublePrecision}};

Built build(const Kind &kind, std::size_t phyxels, std::size_t surfels, const ParallelFor &parallelFor) {
  Built out;
  const std::size_t before = bench::heapBytes();
  out.rest = kind.lattice ? bench::latticeBall(phyxels, surfels, parallelFor)
                          : bench::cloudBall(phyxels, surfels, parallelFor);
  const std::size_t between = bench::heapBytes();
  out.body = std::make_unique<Body>("ball", out.rest, bench::constitutionFor(*out.rest), parallelFor);
  out.body->setPrecision(kind.precision);
  bench::evaluateForces(*out.body, parallelFor);  // memory allocated by the first evaluation counts
  out.restBytes = static_cast<double>(between - before);
  out.bodyBytes = static_cast<double>(bench::heapBytes() - between);
  return out;
}

void memoryRow(Report &report, const Built &built) {
  const RestState &rest = *built.rest;
  const Body &body = *built.body;
  const auto n = static_cast<double>(rest.phyxelCount());
  const double state = bytes(body.state().displacements) + bytes(body.state().velocities) +
                       static_cast<double>(body.masses().size_bytes() + body.weights().size_bytes() +
                                           body.inverseMasses().size_bytes() + body.forces().size_bytes());
  report.row({bench::evaluationName(body), rest.phyxelCount(), rest.pointCount(),
              (built.restBytes + built.bodyBytes) / n, built.restBytes / n, bytes(rest.stencils) / n,
              bytes(rest.neighbors) / n,
              (bytes(rest.contact.binding) + bytes(rest.contact.normals) + bytes(rest.contact.areas)) / n,
              built.bodyBytes / n, state / n});
}

void surfelMemory(Report &report, std::size_t surfels, const ParallelFor &parallelFor) {
  report.table("bytes per surfel",
               "evaluation; surfels; phyxels; bytes_per_surfel=surfel:1; binding_bytes_per_surfel=binding:1; "
               "update_ns=update ns:1");
  constexpr std::size_t kPhyxels = 10000;
  for (const bool lattice : {true, false}) {
    const Built built = build({lattice}, kPhyxels, surfels, parallelFor);
    const RestState &rest = *built.rest;
    // Contact points belong to the surface too, but not to the surfels.
    const auto count = static_cast<double>(surfels);
    const double counted = static_cast<double>(rest.surfels.bytes()) + bytes(rest.surfelNormals) + bytes(rest.skin);
    const Timing t = bench::measureSurfelUpdate(0.3, *built.body, parallelFor);
    report.row({bench::evaluationName(*built.body), surfels, rest.phyxelCount(), counted / count,
                static_cast<double>(rest.surfels.bytes()) / count, 1e6 * t.median_ms / count});
  }
}

// The cost of a step of a material with history.
void measureMaterials(const Options &options, Report &report) {
  c3de::ThreadPool pool(options.threads);
  const ParallelFor parallelFor = bench::parallelForOf(pool);
  constexpr std::size_t kPhyxels = 3000;
  constexpr double kStep = 1e-3;  // s
  report.table("materials with a memory",
               "evaluation; material; phyxels; points; forces_median_ms=forces ms:4; forces_ns_per_point=ns/point:1; "
               "over_elastic=over elastic:2");
  const char *const names[] = {"elastic", "below yield", "flows everywhere", "one Prony term", "two Prony terms"};
  for (const Kind &kind : kKinds) {
    const auto rest =
        kind.lattice ? bench::latticeBall(kPhyxels, 0, parallelFor) : bench::cloudBall(kPhyxels, 0, parallelFor);
    std::vector<Body> bodies;
    for (std::size_t k = 0; k < std::size(names); ++k) {
      Constitution constitution = bench::constitutionFor(*rest);
      Material &material = constitution.materials.front();
      if (k == 1 || k == 2) {
        material.plastic.yield = k == 1 ? 1.0 : 0.01;
        material.plastic.creep = 0.5;
      }
      if (k >= 3) material.prony[0] = {0.3, 0.1};
      if (k == 4) material.prony[1] = {0.2, 1.0};
      Body &body = bodies.emplace_back("ball", rest, std::move(constitution), parallelFor);
      body.setPrecision(kind.precision);
      bench::deform(body);
    }
    std::vector<std::function<void()>> evaluations;
    for (Body &body : bodies) evaluations.emplace_back([&] { body.evaluate(0.0, kStep, parallelFor); });
    const std::vector<Timing> times = bench::measureInTurns(options.seconds, evaluations);
    for (std::size_t k = 0; k < bodies.size(); ++k)
      report.row({bench::evaluationName(bodies[k]), names[k], rest->phyxelCount(), rest->pointCount(),
                  times[k].median_ms, 1e6 * times[k].median_ms / static_cast<double>(rest->pointCount()),
                  times[k].median_ms / times[0].median_ms});
  }
}

/// Never raised; measures the processor time without a check, ms.
class Listening final : public StopRequest {
 public:
  [[nodiscard]] bool isRaised() const noexcept override {
    if (std::this_thread::get_id() != listener_) return false;
    const double now = bench::processor_ms();
    longest_ms_ = std::max(longest_ms_, now - last_ms_);
    last_ms_ = now;
    return false;
  }
  [[nodiscard]] double longest_ms() const {
    (void)isRaised();
    return longest_ms_;
  }

 private:
  const std::thread::id listener_ = std::this_thread::get_id();
  mutable double last_ms_ = bench::processor_ms(), longest_ms_ = 0.0;
};

void measureBuilding(const Options &options, Report &report) {
  c3de::ThreadPool pool(options.threads);
  const auto [least, most] = sizesOf(options);
  report.table("building",
               "body; evaluation; phyxels; surfels; rest_us_per_phyxel=rest state us/phyxel:1; "
               "body_us_per_phyxel=body us/phyxel:1; us_per_phyxel=all us/phyxel:1; longest_unasked_ms=unasked ms:1");
  for (const std::string name : {"box", "liver"}) {
    const Surface mesh = bench::surfaceNamed(name, 100, 150);
    const BodyShape shape = validation::meshShape(mesh);
    for (const Evaluation evaluation : {Evaluation::stressPoints, Evaluation::phyxels})
      for (const std::size_t size : {1000u, 10000u, 100000u}) {
        if (size < least || size > most) continue;
        BodyRecipe recipe;
        recipe.evaluation = evaluation;
        recipe.sampling.spacing = std::cbrt(shape.volume / static_cast<double>(size));
        recipe.fixes = {bench::heldIn(
            HalfSpaceRegion{shape.min + 0.125 * (shape.max - shape.min)[0] * Vec3::UnitX(), Vec3::UnitX()})};
        double rest_ms = 1e300, body_ms = 1e300, unasked_ms = 1e300;
        std::size_t phyxels = 0;
        StoppableLoops loops(bench::parallelForOf(pool));
        for (int run = 0; run < 3; ++run) {
          const Listening listening;
          const StoppableLoops::Watch watch(loops, &listening);
          const double begin_ms = bench::processor_ms();
          const auto rest = bench::valueOf(buildRestState(shape, recipe, {}, loops.parallelFor()));
          const double between_ms = bench::processor_ms();
          const Body body("body", rest, bench::constitutionFor(*rest), loops.parallelFor());
          rest_ms = std::min(rest_ms, between_ms - begin_ms);
          body_ms = std::min(body_ms, bench::processor_ms() - between_ms);
          unasked_ms = std::min(unasked_ms, listening.longest_ms());
          phyxels = rest->phyxelCount();
        }
        const double perPhyxel = 1e3 / static_cast<double>(phyxels);
        report.row({name, evaluation == Evaluation::stressPoints ? "stress points" : "phyxels", phyxels,
                    mesh.positions.size(), perPhyxel * rest_ms, perPhyxel * body_ms, perPhyxel * (rest_ms + body_ms),
                    unasked_ms});
      }
  }
}

struct Spread {
  double least = 1e300, most = 0.0;
  void add(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
};

void measureCost(const Options &options, Report &report) {
  c3de::ThreadPool pool(options.threads);
  const ParallelFor parallelFor = bench::parallelForOf(pool);
  const auto [least, most] = sizesOf(options);
  std::map<std::string, std::map<std::string, Spread>> spreads;
  for (const Kind &kind : kKinds) {
    const std::string evaluation = bench::evaluationName(*build(kind, kSizes[0], 0, parallelFor).body);
    report.table("cost, " + evaluation,
                 "evaluation=; phyxels; points; forces_median_ms=forces ms:4; forces_p99_ms=99 % ms:4; "
                 "forces_ns_per_phyxel=ns/phyxel:1; forces_ns_per_point=ns/point:1; substep_median_ms=substep ms:4; "
                 "substep_p99_ms=99 % ms:4; substep_ns_per_phyxel=ns/phyxel:1; substep_ns_per_point=ns/point:1");
    for (const std::size_t size : kSizes) {
      if (size < least || size > most) continue;
      const Built built = build(kind, size, 0, parallelFor);
      bench::deform(*built.body);
      const auto world = bench::fallingBall(built.rest, kind.precision, parallelFor);
      const std::vector<Timing> times = bench::measureInTurns(
          options.seconds, {[&] { bench::evaluateForces(*built.body, parallelFor); }, [&] { world->step(); }});
      if (world->simulator.stepper().stoppedBodies() > 0)
        throw std::runtime_error("a step of " + std::to_string(size) + " phyxels failed");
      const auto n = static_cast<double>(built.rest->phyxelCount()),
                 points = static_cast<double>(built.rest->pointCount());
      const double forces_ns = 1e6 * times[0].median_ms, substep_ns = 1e6 * times[1].median_ms;
      report.row({evaluation, built.rest->phyxelCount(), built.rest->pointCount(), times[0].median_ms, times[0].p99_ms,
                  forces_ns / n, forces_ns / points, times[1].median_ms, times[1].p99_ms, substep_ns / n,
                  substep_ns / points});
      if (built.rest->phyxelCount() < kSpreadFrom) continue;
      auto &of = spreads[evaluation];
      of["forces_per_phyxel"].add(forces_ns / n);
      of["forces_per_point"].add(forces_ns / points);
      of["substep_per_phyxel"].add(substep_ns / n);
      of["substep_per_point"].add(substep_ns / points);
    }
  }
  report.table("spread: largest cost over least, from 1 000 phyxels on", "evaluation; quantity; spread:2");
  for (const auto &[evaluation, of] : spreads)
    for (const auto &[quantity, spread] : of) {
      report.row({evaluation, quantity, spread.most / spread.least});
      report.fact("spread_" + quantity + ", " + evaluation, spread.most / spread.least);
    }
}

void measureMemory(const Options &options, Report &report) {
  c3de::ThreadPool pool(options.threads);
  const ParallelFor parallelFor = bench::parallelForOf(pool);
  report.table("bytes per phyxel",
               "evaluation; phyxels; points; bytes_per_phyxel=all:0; rest_bytes_per_phyxel=rest state:0; "
               "stencil_bytes_per_phyxel=stencils:0; neighbour_bytes_per_phyxel=neighbours:0; "
               "contact_bytes_per_phyxel=contact:0; body_bytes_per_phyxel=body:0; state_bytes_per_phyxel=state:0");
  for (const Kind &kind : kKinds)
    for (const std::size_t size : {3000u, 30000u})
      if (size <= sizesOf(options).second) memoryRow(report, build(kind, size, 0, parallelFor));
  surfelMemory(report, options.count("--surfels", 50000), parallelFor);
}

}  // namespace

int main(int argc, char **argv) {
  const std::string sizes = "[--least PHYXELS] [--most PHYXELS]";
  return bench::run("bench_scaling",
                    {{"building", sizes, measureBuilding},
                     {"cost", sizes, measureCost},
                     {"materials", "", measureMaterials},
                     {"memory", "[--most PHYXELS] [--surfels N]", measureMemory}},
                    argc, argv);
}
