// SPDX-License-Identifier: Apache-2.0
// Measures force evaluations.
//
//   bench_forces thesis   the six sizes of Bremm's thesis (UFSC 2012), next to its figures and to its loop
//   bench_forces limit    against the peak performance of a core
//   bench_forces threads  the cost of a fork-join, the speed-up of a second thread
//   bench_forces law      an external material law against the built-in law of the same formula
#include <cstdio>
#include <map>

#include "bench/bodies.h"
#include "bench/timing.h"
#include "forces/questions.h"
#include "reference/body.h"
#include "support/outside_law.h"

namespace {

using namespace pointbased;
using bench::Options;
using bench::Report;
using bench::Timing;

struct Size {
  std::size_t phyxels;
  double thesisForces_ms;
};
constexpr Size kSizes[] = {{56, 0.210}, {106, 0.334}, {498, 1.769}, {850, 3.045}, {1760, 6.809}, {2844, 9.417}};

struct SurfelSize {
  std::size_t surfels;
  double thesisUpdate_ms;  // of 7136: 2.17 to 2.49
};
constexpr SurfelSize kSurfelSizes[] = {{482, 0.136}, {7136, 2.17}};

// The thesis's body on the engine's points, volumes and neighbours.
reference::Body referenceBody(const RestState &rest, const NeighborChoice &choice, const Material &material,
                              const ParallelFor &parallelFor) {
  const Neighborhoods chosen = findNeighborhoods(rest.positions, choice, rest.spacing, parallelFor);
  reference::Neighborhoods out;
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    for (Index k = chosen.neighbors.offsets[i]; k < chosen.neighbors.offsets[i + 1]; ++k) {
      const Index j = chosen.neighbors.indices[k];
      const double h = std::max(chosen.supportRadii[i], chosen.supportRadii[j]);
      out.neighbors.push_back(j);
      out.weights.push_back(reference::poly6((rest.positions[j] - rest.positions[i]).norm(), h));
    }
    out.first.push_back(out.neighbors.size());
    out.selfWeights.push_back(reference::poly6(0.0, chosen.supportRadii[i]));
    out.supportRadii.push_back(chosen.supportRadii[i]);
    out.meanDistances.push_back(rest.spacing);
  }
  const reference::Material elastic{material.youngsModulus, material.poissonRatio, material.restDensity, 0.0, {}};
  return reference::buildBody(rest.positions, std::move(out), elastic, rest.volumes, rest.shapeVolume,
                              reference::Errata::literal());
}

std::string hashAfter(int steps, const Body &like, const ParallelFor &parallelFor) {
  bench::World world(std::make_unique<Body>("ball", like.sharedRest(), like.constitution(), parallelFor), {},
                     parallelFor);
  world.body().setPrecision(like.precision());
  bench::deform(world.body());
  for (int i = 0; i < steps; ++i)
    if (const auto done = world.simulator.step(); !done) return done.error().text;
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(world.simulator.stateHash()));
  return hash;
}

// ms, by evaluation, of the largest size.
using Frame = std::map<std::string, double>;

void thesisForces(Report &report, double seconds, const ParallelFor &parallelFor, Frame &frame) {
  report.table("forces",
               "evaluation; phyxels; points; neighbours_mean=neighb.:1; forces_median_ms=forces ms:4; forces_p95_ms=; "
               "forces_p99_ms=99 % ms:4; forces_per_phyxel_ns=ns/phyxel:1; reference_median_ms=plain ms:4; "
               "reference_over_engine=plain/ours:2; reference_over_alike=plain/alike:2; thesis_forces_ms=thesis ms; "
               "thesis_over_engine=thesis/ours:1; state_hash=");
  for (const Size &size : kSizes) {
    const auto cloudRest = bench::cloudBall(size.phyxels, 0, parallelFor);
    const auto latticeRest = bench::latticeBall(size.phyxels, 0, parallelFor);
    Body cloud("cloud", cloudRest, bench::constitutionFor(*cloudRest), parallelFor);
    Body lattice("lattice", latticeRest, bench::constitutionFor(*latticeRest), parallelFor);
    Constitution plainLaw = bench::constitutionFor(*cloudRest, MaterialLaw::stVenantKirchhoff);
    plainLaw.stabilisation = 0.0;
    Body single("lattice", latticeRest, bench::constitutionFor(*latticeRest), parallelFor);
    single.setPrecision(Precision::singlePrecision);
    Body alike("alike", cloudRest, plainLaw, parallelFor);
    for (Body *body : {&cloud, &lattice, &single, &alike}) bench::deform(*body);
    reference::Body plain = referenceBody(*cloudRest, bench::kNeighbours, cloud.material(), parallelFor);
    plain.u = cloud.state().displacements;
    const std::vector<Timing> times = bench::measureInTurns(
        seconds,
        {[&] { bench::evaluateForces(cloud, parallelFor); }, [&] { bench::evaluateForces(lattice, parallelFor); },
         [&] { reference::computeForces(plain); }, [&] { bench::evaluateForces(alike, parallelFor); },
         [&] { bench::evaluateForces(single, parallelFor); }});
    const double plain_ms = times[2].median_ms;
    const auto row = [&](const Body &body, const Timing &t, Report::Cell alikeRatio) {
      const auto n = static_cast<double>(body.rest().phyxelCount());
      const double share = n / static_cast<double>(size.phyxels);
      report.row({bench::evaluationName(body), body.rest().phyxelCount(), body.rest().pointCount(),
                  countNeighbours(body.rest()).mean, t.median_ms, t.p95_ms, t.p99_ms, 1e6 * t.median_ms / n,
                  share * plain_ms, share * plain_ms / t.median_ms, std::move(alikeRatio), size.thesisForces_ms,
                  share * size.thesisForces_ms / t.median_ms, hashAfter(20, body, parallelFor)});
      frame[bench::evaluationName(body)] = t.median_ms;
    };
    row(cloud, times[0], plain_ms / times[3].median_ms);
    row(lattice, times[1], nullptr);
    row(single, times[4], nullptr);
  }
}

void thesisSurfels(Report &report, double seconds, const ParallelFor &parallelFor, Frame &frame) {
  report.table("surfels",
               "evaluation; surfels; phyxels; update_median_ms=update ms:4; update_p95_ms=; update_p99_ms=99 % ms:4; "
               "update_per_surfel_ns=ns/surfel:1; thesis_update_ms=thesis ms; thesis_over_engine=thesis/ours:1");
  for (const SurfelSize &size : kSurfelSizes)
    for (const std::size_t phyxels : {498u, 2844u})
      for (const bool onLattice : {false, true}) {
        const auto rest = onLattice ? bench::latticeBall(phyxels, size.surfels, parallelFor)
                                    : bench::cloudBall(phyxels, size.surfels, parallelFor);
        Body body("ball", rest, bench::constitutionFor(*rest), parallelFor);
        bench::deform(body);
        const Timing t = bench::measureSurfelUpdate(seconds, body, parallelFor);
        report.row({bench::evaluationName(body), size.surfels, rest->phyxelCount(), t.median_ms, t.p95_ms, t.p99_ms,
                    1e6 * t.median_ms / static_cast<double>(size.surfels), size.thesisUpdate_ms,
                    size.thesisUpdate_ms / t.median_ms});
        frame[bench::evaluationName(body)] = t.median_ms;
      }
}

// "plain" is plugins/baselines/reference on one thread: St. Venant-Kirchhoff without stabilisation, built by the same
// compiler with the same flags. "plain/ours" divides medians of runs in turns: above 1 the engine is faster. The engine
// does more (another law, stabilisation, the bound of the tangent); "plain/alike" is the ratio with the plain loop's
// law and without stabilisation. A lattice has no loop of the thesis: its rows are compared, per phyxel, with the plain
// loop on the cloud of that size.
//
// Surfels are updated as for the screen, positions and normals in single precision. The clouds are the N lattice points
// nearest to a centre, the surfels a Fibonacci sphere around them, so the sizes are exact; lattices have about as many
// phyxels. The thesis used a 3.2 GHz quad core of 2012; here a phyxel chooses 26 neighbours, and ties and symmetry make
// it 31 to 35. Its figures are times of another method, machine and compiler.
void compareWithThesis(const Options &options, Report &report) {
  c3de::ThreadPool pool(options.threads);
  const ParallelFor parallelFor = bench::parallelForOf(pool);
  Frame forces, surfels;
  thesisForces(report, options.seconds, parallelFor, forces);
  thesisSurfels(report, options.seconds, parallelFor, surfels);
  surfels["stress points, float"] = surfels["stress points"];
  const double thesis_ms = std::rbegin(kSizes)->thesisForces_ms + std::rbegin(kSurfelSizes)->thesisUpdate_ms;
  report.table("forces + surfels of the largest size, the thesis's own " + std::to_string(thesis_ms) + " ms",
               "evaluation; frame_ms=ms; thesis_over_engine_frame=times faster:1");
  for (const auto &[evaluation, forces_ms] : forces) {
    const double frame_ms = forces_ms + surfels.at(evaluation);
    report.row({evaluation, frame_ms, thesis_ms / frame_ms});
    report.fact("thesis_over_engine_frame, " + evaluation, thesis_ms / frame_ms);
  }
}

// The same law from outside of the core, with or without its own bounds of the tangent.
std::unique_ptr<Body> bodyOfLaw(const std::shared_ptr<const RestState> &rest, bool outside, bool bounds) {
  Constitution constitution = bench::constitutionFor(*rest);
  Material &m = constitution.materials.front();
  if (outside)
    setLaw(m, bench::valueOf(checked(std::make_shared<support::OutsideNeoHookean>(m.lambda(), m.mu(), bounds))));
  auto body = std::make_unique<Body>("ball", rest, std::move(constitution), serialFor());
  bench::deform(*body);
  return body;
}

// Forces of a deformed ball, one thread, in turns: the built-in neo-Hookean law by vector kernels and by the scalar
// engine, the same law as an external law. External laws run in the scalar engine.
void compareLaws(const Options &options, Report &report) {
  constexpr std::size_t kPhyxels = 2000;
  const ParallelFor serial = serialFor();
  report.table("law", "evaluation; law; ns_per_point=ns/point:0; over_kernel=kernel:2; over_scalar=scalar:2");
  for (const bool lattice : {true, false}) {
    const auto rest = lattice ? bench::latticeBall(kPhyxels, 0, serial) : bench::cloudBall(kPhyxels, 0, serial);
    const auto own = bodyOfLaw(rest, false, false), with = bodyOfLaw(rest, true, true),
               without = bodyOfLaw(rest, true, false);
    const auto stages = [&](Body &body) {
      body.computeGradients(serial);
      body.computeStresses(0.0, serial);
      body.computeForces(0.0, serial);
    };
    const std::vector<Timing> times = bench::measureInTurns(
        4.0 * options.seconds, {[&] { bench::evaluateForces(*own, serial); }, [&] { stages(*own); },
                                [&] { stages(*with); }, [&] { stages(*without); }});
    const char *names[] = {"built-in, vector kernels", "built-in, scalar engine", "from outside, with bounds",
                           "from outside, bounds derived"};
    for (std::size_t i = 0; i < times.size(); ++i)
      report.row({bench::evaluationName(*own), names[i],
                  1e6 * times[i].median_ms / static_cast<double>(rest->stencils.pointCount()),
                  times[i].median_ms / times[0].median_ms, times[i].median_ms / times[1].median_ms});
  }
}

}  // namespace

int main(int argc, char **argv) {
  return bench::run("bench_forces",
                    {{"thesis", "", compareWithThesis},
                     {"limit", "[--target AVX3|AVX2|SSE4|SSSE3]", bench::compareWithLimit},
                     {"threads", "[--only fork-join|steps] [--phyxels N]", bench::measureThreads},
                     {"law", "", compareLaws}},
                    argc, argv);
}
