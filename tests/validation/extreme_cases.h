// SPDX-License-Identifier: Apache-2.0
// Shared by the tests of extreme cases: small bodies, invariants of every state, and a line of the table in the theory.
#pragma once

#include <memory>
#include <string>

#include "pointbased/simulator.h"
#include "unit/pointbased/contact_cases.h"
#include "unit/pointbased/shapes.h"
#include "unit/pointbased/surfaces.h"

namespace extremes {

using namespace pointbased;

/// Adds a line to the table: the extreme, the result, and the present test's name. It is appended to the file that the
/// environment variable C3DE_EXTREMES_TABLE names; without the variable nothing is written.
void row(const std::string &what, const std::string &result);
/// Four digits.
[[nodiscard]] std::string text(double value);

[[nodiscard]] Material rubber(double youngsModulus, double poissonRatio = 0.3,
                              MaterialLaw law = MaterialLaw::neoHookean);
/// A cube of 4 cm with a corner at (0, height, 0), on a lattice, with contact points.
inline constexpr double kEdge = 0.04;  // m
[[nodiscard]] std::unique_ptr<Body> cube(const Material &material, double spacing = 0.02, double height = 0.0);
/// An unchanged cloud of phyxels, volumes of spacing³.
[[nodiscard]] std::unique_ptr<Body> cloud(const std::vector<Vec3> &points, double spacing, const Material &material,
                                          const NeighborChoice &choice = {});
/// A cubic lattice of nx x ny x nz points.
[[nodiscard]] std::vector<Vec3> gridPoints(int nx, int ny, int nz, double spacing);

[[nodiscard]] bool finite(const Body &body);
/// Fraction of the evaluation points, by number, with det F <= 0.
[[nodiscard]] double invertedPart(Body &body);
/// Largest |det F - 1|, and of the whole volume.
struct VolumeError {
  double local = 0.0, total = 0.0;
};
[[nodiscard]] VolumeError volumeError(Body &body);
using shapes::largest, shapes::momenta, shapes::Momenta;
/// Largest |a - b| over largest |b|.
[[nodiscard]] double difference(std::span<const Vec3> a, std::span<const Vec3> b);
/// u = (A - 1) X + shift.
void displace(Body &body, const Mat3 &A, const Vec3 &shift = Vec3::Zero());
[[nodiscard]] bool told(const Simulator &simulator, const std::string &kind);

/// Bytes of memory in use by this process; 0 where the system does not report it.
[[nodiscard]] std::size_t residentMemory();

}  // namespace extremes
