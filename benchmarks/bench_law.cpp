// SPDX-License-Identifier: Apache-2.0
// Measures the cost of an external material law against the built-in law of the same formula.
//
//   bench_law
//
// Forces of a deformed ball, one thread, in turns: the built-in neo-Hookean law by vector kernels and by the scalar
// engine, the same law as an external law with and without its own bounds. External laws run in the scalar engine.
#include <cstdio>

#include "bench/bodies.h"
#include "bench/timing.h"
#include "support/outside_law.h"

using namespace pointbased;

namespace {

std::unique_ptr<Body> makeBody(const std::shared_ptr<const RestState> &rest, bool outside, bool bounds) {
  Constitution constitution = bench::constitutionFor(*rest, MaterialLaw::neoHookean);
  Material &m = constitution.materials.front();
  if (outside) {
    auto law = checked(std::make_shared<support::OutsideNeoHookean>(m.lambda(), m.mu(), bounds));
    if (!law) return nullptr;
    setLaw(m, *law);
  }
  auto body = std::make_unique<Body>("ball", rest, std::move(constitution), serialFor());
  bench::deform(*body);
  return body;
}

}  // namespace

int main() {
  constexpr std::size_t kPhyxels = 2000;
  const ParallelFor serial = serialFor();
  std::printf("%-8s %-36s %12s %8s %8s\n", "points", "law", "ns a point", "kernel", "scalar");
  for (const bool lattice : {true, false}) {
    const auto rest = lattice ? bench::latticeBall(kPhyxels, 0, serial) : bench::cloudBall(kPhyxels, 0, serial);
    const auto own = makeBody(rest, false, false), with = makeBody(rest, true, true),
               without = makeBody(rest, true, false);
    if (!with || !without) return 1;
    const auto stages = [&](Body &body) {
      body.computeGradients(serial);
      body.computeStresses(0.0, serial);
      body.computeForces(0.0, serial);
    };
    const auto times = bench::measureInTurns(2.0, {[&] { bench::evaluateForces(*own, serial); }, [&] { stages(*own); },
                                                   [&] { stages(*with); }, [&] { stages(*without); }});
    const char *names[] = {"built-in, vector kernels", "built-in, scalar engine", "from outside, with bounds",
                           "from outside, bounds derived"};
    const auto points = static_cast<double>(rest->stencils.pointCount());
    for (std::size_t i = 0; i < times.size(); ++i)
      std::printf("%-8s %-36s %12.0f %8.2f %8.2f\n", lattice ? "lattice" : "cloud", names[i],
                  1e6 * times[i].median_ms / points, times[i].median_ms / times[0].median_ms,
                  times[i].median_ms / times[1].median_ms);
  }
  return 0;
}
