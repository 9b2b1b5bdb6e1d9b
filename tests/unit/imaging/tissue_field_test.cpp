// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>

#include "c3de/imaging/displacement.h"
#include "images.h"
#include "phantoms.h"

using namespace images;

namespace {

/// A deformed block from 10 to 50, 40 and 30 mm: x = F X + b.
struct Deformed {
  std::array<Vec3, 3> rows;  ///< of F
  Vec3 b;

  [[nodiscard]] double det() const { return dot(rows[0], cross(rows[1], rows[2])); }
  [[nodiscard]] Vec3 now(const Vec3 &X) const { return Vec3{dot(rows[0], X), dot(rows[1], X), dot(rows[2], X)} + b; }
  [[nodiscard]] Vec3 before(const Vec3 &x) const {
    const Vec3 y = x - b;
    const double d = 1.0 / det();
    // Columns of the inverse are cross products of rows.
    const Vec3 c0 = d * cross(rows[1], rows[2]), c1 = d * cross(rows[2], rows[0]), c2 = d * cross(rows[0], rows[1]);
    return {c0[0] * y[0] + c1[0] * y[1] + c2[0] * y[2], c0[1] * y[0] + c1[1] * y[1] + c2[1] * y[2],
            c0[2] * y[0] + c1[2] * y[1] + c2[2] * y[2]};
  }
  static bool isBlock(const Vec3 &X) {
    return X[0] > 10 && X[0] < 50 && X[1] > 10 && X[1] < 40 && X[2] > 10 && X[2] < 30;
  }

  /// Points of 2.5 mm around it; outside it a displacement that is unrelated to it.
  [[nodiscard]] DisplacementGrid grid() const {
    auto bodies = std::make_shared<Mask>();
    bodies->geometry = phantoms::grid({64, 64, 48});
    for (std::size_t k = 0; k < 48; ++k)
      for (std::size_t j = 0; j < 64; ++j)
        for (std::size_t i = 0; i < 64; ++i)
          bodies->voxels.push_back(isBlock({double(i), double(j), double(k)}) ? kBodyVoxel : 0);
    DisplacementGrid u;
    u.geometry = phantoms::grid({33, 33, 27}, {2.5, 2.5, 2.5});
    for (std::size_t a = 0; a < 3; ++a) u.geometry.indexToWorld[12 + a] = -6.0;
    for (std::size_t k = 0; k < 27; ++k)
      for (std::size_t j = 0; j < 33; ++j)
        for (std::size_t i = 0; i < 33; ++i) {
          const Vec3 x = u.geometry.worldAt({double(i), double(j), double(k)}), X = before(x);
          const bool isIn = isBlock(X);
          for (std::size_t a = 0; a < 3; ++a)
            u.xyz_mm.push_back(isIn ? static_cast<float>(x[a] - X[a]) : 0.1f * float(i));
          u.gap_mm.push_back(isIn ? 0.0f : 20.0f);
        }
    u.bodies = bodies;
    return u;
  }
};

const Deformed kCompressed{{{{0.9, 0.05, 0.0}, {0.0, 0.95, 0.04}, {-0.03, 0.0, 1.02}}}, {3.0, -2.0, 1.5}};
/// Of single precision: some 1e-6 of displacements of 10 mm, over steps of 2.5 mm.
constexpr double kSingle = 1e-5;

}  // namespace

TEST_CASE("An affine deformation has its det F everywhere in tissue, also at its surface, and none beside it",
          "[tissue_field]") {
  for (const Deformed &how : {kCompressed, Deformed{{{{0, -1.1, 0}, {1.2, 0, 0}, {0, 0, 1}}}, {45.0, 0.0, 0.0}}}) {
    DisplacementGrid u = how.grid();
    u.fields.push_back({kVolumeRatio, "1", volumeRatios(u)});
    const TissueField *field = u.field(kVolumeRatio);
    REQUIRE(field);
    std::size_t asked = 0;
    double worst = 0.0;
    // 1.5 mm below the surface: the mask resolves it to a voxel, the grid within its points.
    for (double X = 12; X < 49; X += 3.7)
      for (double Y = 12; Y < 39; Y += 2.9)
        for (double Z = 12; Z < 29; Z += 2.3) {
          const Vec3 x = how.now({X, Y, Z});
          const auto value = u.valueOf(*field, x);
          if (!u.hasTissue(x)) continue;  // next to the last point of the grid in tissue, u does not lead there
          REQUIRE(value);
          worst = std::max(worst, std::abs(*value - how.det()));
          ++asked;
        }
    CHECK(asked > 600);
    CHECK(worst < kSingle);
    for (const Vec3 &X : {Vec3{5, 25, 20}, Vec3{55, 25, 20}, Vec3{30, 45, 20}, Vec3{30, 25, 5}}) {
      CHECK_FALSE(u.hasTissue(how.now(X)));
      CHECK_FALSE(u.valueOf(*field, how.now(X)));
    }
    CHECK_FALSE(u.valueOf(*field, {1000, 0, 0}));
  }
}

TEST_CASE("Where nobody knows which places are tissue there is no det F", "[tissue_field]") {
  DisplacementGrid u = kCompressed.grid();
  u.bodies.reset();
  for (const float value : volumeRatios(u)) REQUIRE(std::isnan(value));
  CHECK(u.hasTissue({20, 20, 20}));
  CHECK_FALSE(u.hasTissue({-20, 20, 20}));
  CHECK_FALSE(u.field("anything"));
  CHECK_FALSE(DisplacementGrid{}.hasTissue({0, 0, 0}));
}

TEST_CASE("What points have is spread as far as they reach, a uniform state exactly", "[tissue_field]") {
  MaterialPoints points;
  std::vector<double> values, places;
  for (double x = 0; x < 25; x += 5)
    for (double y = 0; y < 25; y += 5)
      for (double z = 0; z < 25; z += 5) {
        points.at_mm.push_back({x, y, z});
        points.reach_mm.push_back(7.5);
        values.push_back(1234.5);
        places.push_back(x);
      }
  VolumeGeometry grid = phantoms::grid({20, 20, 20}, {2, 2, 2});
  const std::vector<float> uniform = scatterToGrid(grid, points, values), sloping = scatterToGrid(grid, points, places);
  const auto at = [&](std::size_t i) { return i + 20 * (5 + 20 * 5); };
  for (std::size_t i = 0; i <= 13; ++i) CHECK(std::abs(uniform[at(i)] - 1234.5f) < 1e-3f);
  CHECK(std::isnan(uniform[at(14)]));  // 28 mm, 8 from the last points
  CHECK(std::isnan(uniform.back()));
  // Between points a mean of nearby ones.
  CHECK(std::abs(sloping[at(5)] - 10.0f) < 1e-4f);
  CHECK(std::abs(sloping[at(6)] - 12.0f) < 0.5f);
  // NaN belongs to no point.
  values.assign(values.size(), std::nan(""));
  values.front() = 3.0;
  const std::vector<float> one = scatterToGrid(grid, points, values);
  CHECK(one[0] == 3.0f);
  CHECK(std::isnan(one[at(5)]));
  // A point in tissue without a value, next to one, is not mixed in.
  DisplacementGrid u = kCompressed.grid();
  std::vector<float> half(u.geometry.voxelCount(), std::nanf(""));
  for (std::size_t p = 0; p < half.size(); p += 2) half[p] = 7.0f;
  const auto value = u.valueOf({"half", "1", half}, kCompressed.now({30, 25, 20}));
  REQUIRE(value);
  CHECK(*value == 7.0);
}
