// SPDX-License-Identifier: Apache-2.0
#define CATCH_CONFIG_EXTERNAL_INTERFACES
#include "extreme_cases.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "support/catch.h"

namespace extremes {

void row(const std::string &what, const std::string &result) {
  const char *file = std::getenv("C3DE_EXTREMES_TABLE");
  if (!file) return;
  const bool fresh = !std::filesystem::exists(file);
  std::ofstream out(file, std::ios::app | std::ios::binary);
  if (fresh)
    out << "# Extremes\n\n"
           "What happens at the edges of material, geometry, time and numbers. Every line is a test of "
           "`test_extremes`, which\n"
           "asserts what is expected and writes this table when `C3DE_EXTREMES_TABLE` names a file. Files of meshes "
           "with\n"
           "numbers that are none, and open surfaces, are refused or repaired by name: `test_geometry`.\n\n"
           "| case | result | test |\n|---|---|---|\n";
  out << "| " << what << " | " << result << " | " << Catch::getResultCapture().getCurrentTestName() << " |\n";
}

std::string text(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

Material rubber(double youngsModulus, double poissonRatio, MaterialLaw law) {
  return Material{.law = law, .youngsModulus = youngsModulus, .poissonRatio = poissonRatio, .restDensity = 1000.0};
}

std::unique_ptr<Body> cube(const Material &material, double spacing, double height) {
  return shapes::latticeBox(Vec3(0, height, 0), Vec3(kEdge, height + kEdge, kEdge), spacing, material, 4);
}

std::unique_ptr<Body> cloud(const std::vector<Vec3> &points, double spacing, const Material &material,
                            const NeighborChoice &choice) {
  return shapes::makeBody(shapes::restState(points, spacing, choice), {material}, "cloud");
}

std::vector<Vec3> gridPoints(int nx, int ny, int nz, double spacing) {
  std::vector<Vec3> points;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) points.push_back(spacing * Vec3(x, y, z));
  return points;
}

bool finite(const Body &body) {
  const State &state = body.state();
  const auto good = [](const Vec3 &v) { return v.allFinite(); };
  return std::all_of(state.displacements.begin(), state.displacements.end(), good) &&
         std::all_of(state.velocities.begin(), state.velocities.end(), good);
}

double invertedPart(Body &body) {
  body.computeGradients(serialFor());
  const auto count = std::count_if(body.gradients().begin(), body.gradients().end(),
                                   [](const Mat3 &F) { return !(F.determinant() > 0.0); });
  return static_cast<double>(count) / static_cast<double>(body.gradients().size());
}

VolumeError volumeError(Body &body) {
  body.computeGradients(serialFor());
  VolumeError error;
  double now = 0.0, rest = 0.0;
  for (std::size_t q = 0; q < body.rest().pointCount(); ++q) {
    const double J = body.gradients()[q].determinant(), v = body.rest().stencils.volumes[q];
    error.local = std::max(error.local, std::abs(J - 1.0));
    now += v * J;
    rest += v;
  }
  error.total = std::abs(now / rest - 1.0);
  return error;
}

double difference(std::span<const Vec3> a, std::span<const Vec3> b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double out = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, (a[i] - b[i]).norm());
  return out / largest(b);
}

void displace(Body &body, const Mat3 &A, const Vec3 &shift) {
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i)
    body.state().displacements[i] = A * body.rest().positions[i] - body.rest().positions[i] + shift;
  body.forcesCurrent = false;
}

bool told(const Simulator &simulator, const std::string &kind) { return shapes::countEvents(simulator, kind) > 0; }

std::size_t residentMemory() {
  // Linux; the file is absent on other systems.
  std::ifstream in("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  return in >> all >> resident ? 4096 * resident : 0;
}

}  // namespace extremes
