// SPDX-License-Identifier: Apache-2.0
// The corrected reference and the engine, written independently, on the same neighbours, weights and volumes.
#include <algorithm>

#include "clouds.h"
#include "pointbased/engine.h"
#include "pointbased/neighborhood.h"
#include "support/catch.h"

using namespace clouds;

namespace {

constexpr double kSpacing = 0.01;  // m

// The engine's neighbours, with poly6 over the larger support of a pair, without its norm, as the engine weights them.
reference::Neighborhoods asReference(const pointbased::Neighborhoods &engine, const std::vector<Vec3> &points) {
  reference::Neighborhoods out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (auto k = engine.neighbors.offsets[i]; k < engine.neighbors.offsets[i + 1]; ++k) {
      const std::size_t j = engine.neighbors.indices[k];
      const double h = std::max(engine.supportRadii[i], engine.supportRadii[j]);
      out.neighbors.push_back(j);
      out.weights.push_back(reference::poly6((points[j] - points[i]).norm(), h) / reference::poly6(0.0, h));
    }
    out.first.push_back(out.neighbors.size());
    out.selfWeights.push_back(1.0);
    out.supportRadii.push_back(engine.supportRadii[i]);
    out.meanDistances.push_back(kSpacing);
  }
  return out;
}

// Largest difference of the forces, relative to the largest.
double engineAgainstReference(const std::vector<Vec3> &points, double amplitude) {
  const pointbased::ParallelFor serial = pointbased::serialFor();
  const pointbased::Material material{pointbased::MaterialLaw::stVenantKirchhoff, 6000.0, 0.4, 1060.0, 0.0};
  Random random(8);
  std::vector<double> volumes;
  const double cell = kSpacing * kSpacing * kSpacing;
  for (std::size_t i = 0; i < points.size(); ++i) volumes.push_back((1.0 + 0.4 * random()) * cell);
  const pointbased::Neighborhoods chosen = pointbased::findNeighborhoods(points, {26, 1.8}, kSpacing, serial);

  Body body = reference::buildBody(points, asReference(chosen, points), {6000.0, 0.4, 1060.0, 0.0, {}}, volumes,
                                   total(volumes), Errata::corrected());
  for (Vec3 &u : body.u) u = amplitude * kSpacing * random.vector();
  for (const int rank : body.rank) CHECK(rank == 3);
  reference::computeForces(body);

  const pointbased::StencilSet stencils =
      pointbased::buildPhyxelStencils(points, chosen.neighbors, chosen.supportRadii, volumes, serial);
  std::vector<Mat3> F(points.size()), vP(points.size());
  std::vector<double> ratios(points.size());
  std::vector<Vec3> entryForces(stencils.phyxels.indices.size()), forces(points.size());
  pointbased::deformationGradients(stencils, body.u, F, serial);
  const pointbased::Constitution constitution{{material}, 0.0};
  pointbased::pointStresses(constitution, stencils, F, {}, {}, 0.0, nullptr, vP, ratios, serial);
  pointbased::internalForces(constitution, stencils, points, body.u, F, vP, entryForces, forces, serial);
  for (std::size_t i = 0; i < points.size(); ++i) CHECK((F[i] - body.J[i]).norm() < 1e-11);

  const double energy = pointbased::elasticEnergy(constitution, stencils, points, body.u, F, {}).strain;
  CHECK_THAT(reference::elasticEnergy(body), WithinRel(energy, 1e-11));
  return difference(forces, body.force);
}

}  // namespace

TEST_CASE("the corrected reference gives the forces of the engine: St. Venant-Kirchhoff, no stabilisation") {
  // Inverses by singular values and by eigenvalues differ by rounding times the condition of A, below 100.
  CHECK(engineAgainstReference(block(6, 5, 4, kSpacing), 0.01) < 1e-10);
  CHECK(engineAgainstReference(block(6, 5, 4, kSpacing), 0.3) < 1e-10);
  CHECK(engineAgainstReference(block(6, 5, 4, kSpacing, 0.2), 0.3) < 1e-10);
}
