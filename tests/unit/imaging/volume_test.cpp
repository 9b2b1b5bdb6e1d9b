// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/volume.h"

#include "support/catch.h"

using namespace c3de;
using imaging::VolumeGeometry;

namespace {

// Oblique, sheared, left-handed, with uneven spacing.
VolumeGeometry awkward() {
  VolumeGeometry g;
  g.size = {5, 7, 3};
  g.indexToWorld = {0.6, 0.8, 0.0, 0.0, 0.8, -0.6, 0.1, 0.0, 0.3, 0.0, 2.5, 0.0, -10.0, 20.0, 30.0, 1.0};
  return g;
}

}  // namespace

TEST_CASE("the inverse of an oblique geometry leads back to the index", "[imaging]") {
  const VolumeGeometry g = awkward();
  const Mat4 back = imaging::affineInverse(g.indexToWorld);
  for (const Vec3 &index : {Vec3{0, 0, 0}, Vec3{4, 6, 2}, Vec3{2.25, -1.5, 7.0}}) {
    const Vec3 again = transformPoint(back, g.worldAt(index));
    for (std::size_t a = 0; a < 3; ++a) CHECK_THAT(again[a], WithinAbs(index[a], 1e-12));
  }
}

TEST_CASE("spacing, volume and shear are read off the matrix", "[imaging]") {
  const VolumeGeometry g = awkward();
  CHECK_THAT(g.spacing()[0], WithinAbs(1.0, 1e-15));
  CHECK_THAT(g.spacing()[2], WithinAbs(std::sqrt(0.09 + 6.25), 1e-15));
  CHECK(g.handedness() < 0.0);
  CHECK_THAT(g.voxelVolume(), WithinAbs(-g.handedness(), 0.0));
  CHECK(g.shear() > 0.05);
  CHECK_THAT(VolumeGeometry{}.shear(), WithinAbs(0.0, 0.0));
}

TEST_CASE("grids are the same when sizes and corners are", "[imaging]") {
  VolumeGeometry a = awkward(), b = a;
  CHECK(imaging::sameGrid(a, b));
  b.indexToWorld[12] += 2e-3;
  CHECK_FALSE(imaging::sameGrid(a, b));
  CHECK(imaging::sameGrid(a, b, 0.01));
  b = a;
  b.size[2] = 4;
  CHECK_FALSE(imaging::sameGrid(a, b, 100.0));
}

TEST_CASE("values are rescaled voxels of the stored type", "[imaging]") {
  imaging::Volume volume;
  volume.geometry.size = {2, 2, 1};
  volume.voxels = std::vector<std::int16_t>{0, 1, -1000, 3};
  volume.slope = 0.5;
  volume.intercept = 10.0;
  CHECK(volume.value(0, 1, 0) == -490.0);
  CHECK(volume.bytes() == 8);
  CHECK(std::string(volume.scalarTypeName()) == "int16");
}
