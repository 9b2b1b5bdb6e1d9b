// SPDX-License-Identifier: Apache-2.0
// Measures the cost per phyxel in small and large bodies, and its memory in bytes.
//
//   bench_scaling [--least PHYXELS] [--most PHYXELS] [--surfels N] [--only building] [--threads N] [--seconds S]
//                 [--csv FILE] [--json FILE]
//
// Balls of 56 to 200 000 phyxels, on a lattice (stress points, in double and single precision) and as clouds (phyxels),
// neo-Hookean with stabilisation:
//   forces   one evaluation of the internal forces
//   substep  one explicit step of Simulator: forces, integration and the guard, without contact
// in turns, medians. A small ball has more surface, so fewer cells per phyxel: costs per evaluation point are also
// listed.
//
// Building: processor time from a closed mesh, a box and a liver by a formula, each held at one end, to a body ready
// for its first step, the least of three; and the longest time without a check for a stop request. --only building:
// this alone.
//
// Memory of materials: the same evaluation of 3 000 phyxels over a step of 1 ms with a material that flows or relaxes,
// relative to that of the elastic one.
//
// Memory: the bytes allocated by operator new for the rest state and for the body, by counting; "of these" the vectors
// that are accessible from outside, by their sizes. Surfels: the additional memory of a rest state with them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <map>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "bench/bodies.h"
#include "bench/heap.h"
#include "bench/report.h"
#include "bench/timing.h"
#include "mesh_body.h"
#include "pointbased/simulator.h"
#include "surfaces.h"
#include "thin_shapes.h"

namespace {

using namespace pointbased;
using bench::Timing;

constexpr std::size_t kSizes[] = {56, 200, 1000, 3000, 10000, 30000, 100000, 200000};
constexpr std::size_t kSpreadFrom = 900;  // phyxels: lattices match the requested number only approximately

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

void memoryRow(bench::Report &report, const Built &built) {
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

void surfelMemory(bench::Report &report, std::size_t surfels, const ParallelFor &parallelFor) {
  report.table("bytes per surfel", {{"evaluation", "evaluation"},
                                    {"surfels", "surfels"},
                                    {"phyxels", "phyxels"},
                                    {"bytes_per_surfel", "surfel", 1},
                                    {"binding_bytes_per_surfel", "binding", 1},
                                    {"update_ns", "update ns", 1}});
  constexpr std::size_t kPhyxels = 10000;
  for (const bool lattice : {true, false}) {
    const Built built = build({lattice}, kPhyxels, surfels, parallelFor);
    const RestState &rest = *built.rest;
    // Contact points belong to the surface too, but not to the surfels.
    const auto count = static_cast<double>(surfels);
    const double counted = static_cast<double>(rest.surfels.bytes()) + bytes(rest.surfelNormals) + bytes(rest.skin);
    std::vector<Vec3f> x(surfels), normals(surfels);
    ScreenPhyxels scratch;
    const Timing t = bench::measure(0.3, [&] {
      updateSurfels(rest.surfels, rest.surfelNormals, rest.origin, rest.positions, built.body->state().displacements,
                    scratch, x, normals, parallelFor);
    });
    report.row({lattice ? "stress points" : "phyxels", surfels, rest.phyxelCount(), counted / count,
                static_cast<double>(rest.surfels.bytes()) / count, 1e6 * t.median_ms / count});
  }
}

// The cost of a step of a material with history.
void historyTable(bench::Report &report, double seconds, const ParallelFor &parallelFor) {
  constexpr std::size_t kPhyxels = 3000;
  constexpr double kStep = 1e-3;  // s
  report.table("materials with a memory", {{"evaluation", "evaluation          "},
                                           {"material", "material            "},
                                           {"phyxels", "phyxels"},
                                           {"points", "points"},
                                           {"forces_median_ms", "forces ms", 4},
                                           {"forces_ns_per_point", "ns/point", 1},
                                           {"over_elastic", "over elastic", 2}});
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
    const std::vector<Timing> times = bench::measureInTurns(seconds, evaluations);
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

Surface meshOf(bool box) {
  if (box) return shapes::boxSurface(Vec3::Zero(), Vec3(0.2, 0.04, 0.04));
  constexpr int kRings = 100;
  return validation::latheSurface(kRings, 150, [](int ring, double phi) {
    const double theta = std::numbers::pi * ring / kRings;
    const Vec3 n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), -std::cos(theta));
    return Vec3(0.11 * n[0], (0.045 + 0.03 * n[0]) * n[1] + 0.02 * n[0] * n[0], (0.07 - 0.03 * n[0] * n[0]) * n[2]);
  });
}

void buildingTable(bench::Report &report, std::size_t least, std::size_t most, const ParallelFor &inner) {
  report.table("building", {{"body", "body "},
                            {"evaluation", "evaluation   "},
                            {"phyxels", "phyxels"},
                            {"surfels", "surfels"},
                            {"rest_us_per_phyxel", "rest state us/phyxel", 1},
                            {"body_us_per_phyxel", "body us/phyxel", 1},
                            {"us_per_phyxel", "all us/phyxel", 1},
                            {"longest_unasked_ms", "unasked ms", 1}});
  for (const bool box : {true, false}) {
    const Surface mesh = meshOf(box);
    const BodyShape shape = validation::meshShape(mesh);
    for (const Evaluation evaluation : {Evaluation::stressPoints, Evaluation::phyxels})
      for (const std::size_t size : {1000u, 10000u, 100000u}) {
        if (size < least || size > most) continue;
        BodyRecipe recipe;
        recipe.evaluation = evaluation;
        recipe.sampling.spacing = std::cbrt(shape.volume / static_cast<double>(size));
        Fix fix;
        fix.region = HalfSpaceRegion{shape.min + 0.125 * (shape.max - shape.min)[0] * Vec3::UnitX(), Vec3::UnitX()};
        recipe.fixes = {fix};
        double rest_ms = 1e300, body_ms = 1e300, unasked_ms = 1e300;
        std::size_t phyxels = 0;
        StoppableLoops loops(inner);
        for (int run = 0; run < 3; ++run) {
          const Listening listening;
          const StoppableLoops::Watch watch(loops, &listening);
          const double begin_ms = bench::processor_ms();
          const auto rest = buildRestState(shape, recipe, {}, loops.parallelFor());
          if (!rest) {
            std::fprintf(stderr, "bench_scaling: %s\n", rest.error().c_str());
            std::exit(1);
          }
          const double between_ms = bench::processor_ms();
          Body body("body", *rest, bench::constitutionFor(**rest), loops.parallelFor());
          rest_ms = std::min(rest_ms, between_ms - begin_ms);
          body_ms = std::min(body_ms, bench::processor_ms() - between_ms);
          unasked_ms = std::min(unasked_ms, listening.longest_ms());
          phyxels = (*rest)->phyxelCount();
        }
        const double perPhyxel = 1e3 / static_cast<double>(phyxels);
        report.row({box ? "box" : "liver", evaluation == Evaluation::stressPoints ? "stress points" : "phyxels",
                    phyxels, mesh.positions.size(), perPhyxel * rest_ms, perPhyxel * body_ms,
                    perPhyxel * (rest_ms + body_ms), unasked_ms});
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

}  // namespace

int main(int argc, char **argv) {
  std::size_t least = 0, most = 200000, surfels = 50000;
  bool buildingAlone = false;
  bench::CommandLine line("bench_scaling");
  const auto count = [](std::size_t &into) {
    return [&into](const std::string &text) { into = std::strtoul(text.c_str(), nullptr, 10); };
  };
  line.add("--least", "PHYXELS", count(least));
  line.add("--most", "PHYXELS", count(most));
  line.add("--surfels", "N", count(surfels));
  line.add("--only", "building", [&](const std::string &text) { buildingAlone = text == "building"; });
  if (const auto exit = line.parse(argc, argv)) return *exit;
  const bench::Options &options = line.options();
  c3de::ThreadPool pool(options.threads);
  const ParallelFor parallelFor = bench::parallelForOf(pool);
  bench::Report report(line.name(), options);
  buildingTable(report, least, most, parallelFor);
  if (buildingAlone) return report.write();

  std::map<std::string, std::map<std::string, Spread>> spreads;
  for (const Kind &kind : kKinds) {
    std::string evaluation = bench::evaluationName(*build(kind, kSizes[0], 0, parallelFor).body);
    report.table("cost, " + evaluation, {{"evaluation", ""},
                                         {"phyxels", "phyxels"},
                                         {"points", "points"},
                                         {"forces_median_ms", "forces ms", 4},
                                         {"forces_p99_ms", "99 % ms", 4},
                                         {"forces_ns_per_phyxel", "ns/phyxel", 1},
                                         {"forces_ns_per_point", "ns/point", 1},
                                         {"substep_median_ms", "substep ms", 4},
                                         {"substep_p99_ms", "99 % ms", 4},
                                         {"substep_ns_per_phyxel", "ns/phyxel", 1},
                                         {"substep_ns_per_point", "ns/point", 1}});
    for (const std::size_t size : kSizes) {
      if (size < least || size > most) continue;
      Built built = build(kind, size, 0, parallelFor);
      bench::deform(*built.body);
      Simulator simulator(parallelFor);
      WorldSettings world;
      world.gravity = Vec3(0, -9.81, 0);
      world.dt = 0.5 * built.body->stableStepAtRest();  // one substep, also where the body is strained
      simulator.setWorld(world);
      const std::size_t id = simulator.addBody(
          std::make_unique<Body>("ball", built.rest, bench::constitutionFor(*built.rest), parallelFor));
      simulator.body(id)->setPrecision(kind.precision);
      bench::deform(*simulator.body(id));
      bool failed = false;
      const std::vector<Timing> times =
          bench::measureInTurns(options.seconds, {[&] { bench::evaluateForces(*built.body, parallelFor); },
                                                  [&] { failed = failed || !simulator.step().has_value(); }});
      if (failed || simulator.stepper().stoppedBodies() > 0) {
        std::fprintf(stderr, "bench_scaling: a step of %zu phyxels failed\n", size);
        return 1;
      }
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
  report.note("\nspread: largest cost over least, from 1 000 phyxels on");
  for (const auto &[evaluation, of] : spreads)
    for (const auto &[quantity, spread] : of) {
      char text[160];
      std::snprintf(text, sizeof text, "  %-20s  %-18s  %.2f", evaluation.c_str(), quantity.c_str(),
                    spread.most / spread.least);
      report.note(text);
      report.fact("spread_" + quantity + ", " + evaluation, spread.most / spread.least);
    }

  historyTable(report, options.seconds, parallelFor);

  report.table("bytes per phyxel", {{"evaluation", "evaluation          "},
                                    {"phyxels", "phyxels"},
                                    {"points", "points"},
                                    {"bytes_per_phyxel", "all", 0},
                                    {"rest_bytes_per_phyxel", "rest state", 0},
                                    {"stencil_bytes_per_phyxel", "stencils", 0},
                                    {"neighbour_bytes_per_phyxel", "neighbours", 0},
                                    {"contact_bytes_per_phyxel", "contact", 0},
                                    {"body_bytes_per_phyxel", "body", 0},
                                    {"state_bytes_per_phyxel", "state", 0}});
  for (const Kind &kind : kKinds)
    for (const std::size_t size : {3000u, 30000u})
      if (size <= most) memoryRow(report, build(kind, size, 0, parallelFor));
  surfelMemory(report, surfels, parallelFor);
  return report.write();
}
