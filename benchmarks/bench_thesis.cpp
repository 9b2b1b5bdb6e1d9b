// SPDX-License-Identifier: Apache-2.0
// How long do forces and the surfel update take for the six sizes of Bremm's thesis (UFSC 2012), beside its own figures?
//
//   bench_thesis [--threads N] [--seconds S] [--csv FILE]
//
// The clouds are the N lattice points nearest to a centre, the surfels a Fibonacci sphere around them, so the sizes are
// exact. The thesis used a 3.2 GHz quad core of 2012; here a phyxel chooses 26 neighbours, and ties and symmetry make it
// 31 to 35. Its figures are times of another method, machine and compiler: there to be read, not to be divided by.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "c3de/core/platform.h"
#include "c3de/core/thread_pool.h"
#include "pointbased/body.h"
#include "pointbased/simulator.h"

namespace {

using namespace pointbased;

struct Size {
  std::size_t phyxels;
  double thesisForces_ms;
};
constexpr Size kSizes[] = {{56, 0.210}, {106, 0.334}, {498, 1.769}, {850, 3.045}, {1760, 6.809}, {2844, 9.417}};

struct SurfelSize {
  std::size_t surfels;
  const char *thesisUpdate_ms;
};
constexpr SurfelSize kSurfelSizes[] = {{482, "0.136"}, {7136, "2.17-2.49"}};

constexpr double kSpacing = 0.01;  // m

PhyxelCloud latticeBall(std::size_t count) {
  const int half = static_cast<int>(std::ceil(std::cbrt(static_cast<double>(count)))) + 1;
  std::vector<Vec3> points;
  // Off the lattice's own centre, so that no two shells tie at the cut.
  const Vec3 centre(0.13, 0.29, 0.37);
  for (int z = -half; z <= half; ++z)
    for (int y = -half; y <= half; ++y)
      for (int x = -half; x <= half; ++x) points.emplace_back(x, y, z);
  std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count), points.end(),
                   [&](const Vec3 &a, const Vec3 &b) { return (a - centre).squaredNorm() < (b - centre).squaredNorm(); });
  points.resize(count);
  std::sort(points.begin(), points.end(), [](const Vec3 &a, const Vec3 &b) {
    return std::array{a[2], a[1], a[0]} < std::array{b[2], b[1], b[0]};
  });
  PhyxelCloud cloud;
  cloud.spacing = kSpacing;
  for (const Vec3 &p : points) cloud.positions.push_back(kSpacing * p);
  cloud.volumes.assign(count, kSpacing * kSpacing * kSpacing);
  cloud.contactRadii.assign(count, 0.5 * kSpacing);
  return cloud;
}

std::vector<Vec3> fibonacciSphere(std::size_t count, double radius) {
  std::vector<Vec3> points;
  const double golden = EIGEN_PI * (3.0 - std::sqrt(5.0));
  for (std::size_t i = 0; i < count; ++i) {
    const double y = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double r = std::sqrt(1.0 - y * y);
    const double phi = golden * static_cast<double>(i);
    points.emplace_back(radius * r * std::cos(phi), radius * y, radius * r * std::sin(phi));
  }
  return points;
}

struct Timing {
  double median_ms, p95_ms;
  std::size_t runs;
};

Timing measure(double seconds, const std::function<void()> &f) {
  using Clock = std::chrono::steady_clock;
  const auto once = [&] {
    const auto begin = Clock::now();
    f();
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  };
  for (int i = 0; i < 10; ++i) (void)once();  // warm up
  std::vector<double> samples;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end || samples.size() < 21) samples.push_back(once());
  std::sort(samples.begin(), samples.end());
  return {samples[samples.size() / 2], samples[samples.size() * 95 / 100], samples.size()};
}

}  // namespace

int main(int argc, char **argv) {
  unsigned threads = 1;
  double seconds = 0.5;
  std::string csvPath;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (i + 1 < argc && option == "--threads") {
      threads = static_cast<unsigned>(std::strtoul(argv[++i], nullptr, 10));
    } else if (i + 1 < argc && option == "--seconds") {
      seconds = std::strtod(argv[++i], nullptr);
    } else if (i + 1 < argc && option == "--csv") {
      csvPath = argv[++i];
    } else {
      std::fprintf(stderr, "usage: bench_thesis [--threads N] [--seconds S] [--csv FILE]\n");
      return 2;
    }
  }

  c3de::ThreadPool pool(threads);
  const ParallelFor parallelFor = [&pool](std::size_t n, std::size_t grain,
                                          const std::function<void(std::size_t, std::size_t)> &body) {
    pool.parallelFor(n, grain, body);
  };
  std::string csv = "phyxels,neighbours_mean,forces_median_ms,forces_p95_ms,thesis_forces_ms,threads,state_hash\n";

  std::printf("CPU: %s, %u thread%s, double precision, neo-Hookean, stabilised\n\n", c3de::cpuName().c_str(), threads,
              threads == 1 ? "" : "s");
  std::printf("%8s %11s %12s %12s %14s %12s\n", "phyxels", "neighbours", "forces ms", "95 % ms", "thesis ms", "ns per pair");
  const Material material{MaterialLaw::neoHookean, 6000.0, 0.45, 1060.0, 0.0};
  for (const Size &size : kSizes) {
    const PhyxelCloud cloud = latticeBall(size.phyxels);
    const double volume = std::accumulate(cloud.volumes.begin(), cloud.volumes.end(), 0.0);
    auto rest = buildRestState(cloud, {26, 1.8}, volume, {}, {}, parallelFor);
    Simulator simulator(parallelFor);
    const std::size_t id = simulator.addBody(std::make_unique<Body>("ball", rest, material, kDefaultStabilisation, parallelFor));
    Body &body = *simulator.body(id);
    for (std::size_t i = 0; i < rest->phyxelCount(); ++i)
      body.state().displacements[i] = 0.05 * rest->positions[i].cwiseProduct(Vec3(1, -0.5, 0.3));
    const Timing t = measure(seconds, [&] {
      body.computeGradients(parallelFor);
      body.computeStresses(parallelFor);
      body.computeForces(parallelFor);
    });
    for (int i = 0; i < 20; ++i)
      if (!simulator.step()) return 1;
    const double neighbours = countNeighbours(*rest).mean;
    const double pairs = neighbours * static_cast<double>(size.phyxels);
    std::printf("%8zu %11.1f %12.4f %12.4f %14.3f %12.1f\n", size.phyxels, neighbours, t.median_ms, t.p95_ms,
                size.thesisForces_ms, 1e6 * t.median_ms / pairs);
    char row[200];
    std::snprintf(row, sizeof row, "%zu,%.2f,%.5f,%.5f,%.3f,%u,%016llx\n", size.phyxels, neighbours, t.median_ms, t.p95_ms,
                  size.thesisForces_ms, threads, static_cast<unsigned long long>(simulator.stateHash()));
    csv += row;
  }

  std::printf("\n%8s %11s %12s %12s %14s\n", "surfels", "phyxels", "update ms", "95 % ms", "thesis ms");
  csv += "surfels,phyxels,update_median_ms,update_p95_ms,thesis_update_ms,threads\n";
  for (const SurfelSize &size : kSurfelSizes)
    for (const std::size_t phyxels : {498u, 2844u}) {
      const PhyxelCloud cloud = latticeBall(phyxels);
      const double radius = kSpacing * std::cbrt(0.75 / EIGEN_PI * static_cast<double>(phyxels));
      const std::vector<Vec3> points = fibonacciSphere(size.surfels, radius);
      std::vector<Vec3> normals;
      for (const Vec3 &p : points) normals.push_back(p.normalized());
      auto rest = buildRestState(cloud, {26, 1.8}, 1.0, points, normals, parallelFor);
      Body body("ball", rest, material, kDefaultStabilisation, parallelFor);
      std::vector<Vec3> x(points.size()), n(points.size());
      const Timing t = measure(seconds, [&] {
        updateSurfels(rest->surfels, rest->positions, body.state().displacements, body.gradients(), x, n, parallelFor);
      });
      std::printf("%8zu %11zu %12.4f %12.4f %14s\n", size.surfels, phyxels, t.median_ms, t.p95_ms, size.thesisUpdate_ms);
      char row[200];
      std::snprintf(row, sizeof row, "%zu,%zu,%.5f,%.5f,%s,%u\n", size.surfels, phyxels, t.median_ms, t.p95_ms,
                    size.thesisUpdate_ms, threads);
      csv += row;
    }
  if (!csvPath.empty()) {
    std::ofstream file(csvPath);
    file << csv;
    if (!file) {
      std::fprintf(stderr, "bench_thesis: cannot write %s\n", csvPath.c_str());
      return 7;
    }
  }
  return 0;
}
