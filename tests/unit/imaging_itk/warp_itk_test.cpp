// SPDX-License-Identifier: Apache-2.0
// Warping by an affine displacement, against ITK's resampling with that affine map. Voxels whose material comes from
// outside of the image count too: both use the nearest point of the border there.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "c3de/imaging/reading.h"
#include "c3de/imaging/warp.h"
#include "itk_resampling.h"
#include "support/catch.h"
#include "unit/imaging/phantoms.h"

using namespace c3de;
using namespace c3de::imaging;
using itk_truth::Sampling;

namespace {

/// u = gradient (x - centre) + shift, mm. Rotates by 6 degrees, stretches, shears.
struct Map {
  Vec3 centre, shift{4.3, -6.1, 2.7};
  std::array<Vec3, 3> gradient{{{0.05, -0.10, 0.02}, {0.11, -0.06, 0.03}, {-0.02, 0.04, 0.08}}};

  [[nodiscard]] Vec3 u(const Vec3 &x) const {
    const Vec3 d = x - centre;
    return Vec3{dot(gradient[0], d), dot(gradient[1], d), dot(gradient[2], d)} + shift;
  }
  /// x - u(x) as a matrix.
  [[nodiscard]] Mat4 sourceOf() const {
    Mat4 m = kIdentity4;
    const Vec3 origin = u({0, 0, 0});
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) m[4 * c + r] -= gradient[r][c];
      m[12 + r] = -origin[r];
    }
    return m;
  }
};

/// The map at the points of an oblique grid around the image.
DisplacementGrid displacementOf(const Map &map, const VolumeGeometry &image) {
  double radius = 0.0;
  for (std::size_t a = 0; a < 3; ++a) radius += 0.5 * image.spacing()[a] * static_cast<double>(image.size[a]);
  constexpr std::size_t kPoints = 24;
  const double spacing = 2.0 * radius / (kPoints - 2);
  VolumeGeometry g = phantoms::oblique({kPoints, kPoints, kPoints}, {spacing, spacing, spacing});
  const Vec3 shift = phantoms::centreOf(image) - phantoms::centreOf(g);
  for (std::size_t a = 0; a < 3; ++a) g.indexToWorld[12 + a] += shift[a];
  DisplacementGrid u{g, {}};
  for (std::size_t k = 0; k < kPoints; ++k)
    for (std::size_t j = 0; j < kPoints; ++j)
      for (std::size_t i = 0; i < kPoints; ++i)
        for (const double component : map.u(g.worldAt({double(i), double(j), double(k)})))
          u.xyz_mm.push_back(static_cast<float>(component));
  return u;
}

/// Balls, shells and noise in 8 bits: flat parts, sharp edges, and everything in between.
Volume pattern(const VolumeGeometry &g) {
  Volume volume;
  volume.geometry = g;
  auto &all = volume.voxels.emplace<std::vector<std::uint8_t>>();
  phantoms::Dice dice(11);
  const Vec3 centre = phantoms::centreOf(g);
  for (std::size_t k = 0; k < g.size[2]; ++k)
    for (std::size_t j = 0; j < g.size[1]; ++j)
      for (std::size_t i = 0; i < g.size[0]; ++i) {
        const Vec3 x = g.worldAt({double(i), double(j), double(k)}) - centre;
        const double shells = std::sin(0.7 * norm(x)), wave = std::sin(0.3 * x[0]) * std::sin(0.2 * x[1] + 0.4 * x[2]);
        const double value = x[0] > 8.0 ? (shells > 0.0 ? 255.0 : 0.0) : 128.0 + 90.0 * wave + dice(30);
        all.push_back(static_cast<std::uint8_t>(value));
      }
  return volume;
}

struct Difference {
  double mean = 0.0, most = 0.0;
  std::size_t moved = 0, outside = 0, notANumber = 0;
};

/// Of all voxels, those from outside of the reference included; ours minus ITK's.
Difference difference(const Volume &reference, const Map &map) {
  const auto found = warped(reference, displacementOf(map, reference.geometry));
  if (!found) throw std::runtime_error(found.error().message);
  const VolumeGeometry &g = reference.geometry;
  const auto truth = itk_truth::resampled(reference, map.sourceOf(), Sampling::linear, 40);
  const Mat4 source = multiply(affineInverse(g.indexToWorld), multiply(map.sourceOf(), g.indexToWorld));
  Difference d;
  std::visit(
      [&](const auto &all) {
        using T = typename std::decay_t<decltype(all)>::value_type;
        const auto &before = std::get<std::vector<T>>(reference.voxels);
        for (std::size_t v = 0; v < all.size(); ++v) {
          const double off = std::abs(static_cast<double>(all[v]) - static_cast<double>(truth[v]));
          d.notANumber += std::isnan(off);
          d.mean += off / static_cast<double>(all.size());
          d.most = std::max(d.most, off);
          d.moved += all[v] != before[v];
          const std::size_t row = v / g.size[0];
          const Vec3 to{double(v % g.size[0]), double(row % g.size[1]), double(row / g.size[1])};
          const Vec3 from = transformPoint(source, to);
          bool inside = true;
          for (std::size_t a = 0; a < 3; ++a) inside = inside && from[a] >= 0.0 && from[a] <= double(g.size[a] - 1);
          d.outside += !inside;
        }
      },
      found->voxels);
  std::printf("%s, %zu voxels, %zu changed, %zu from outside: |ours - ITK's| %.3g on average, %.3g at most\n",
              reference.scalarTypeName(), g.voxelCount(), d.moved, d.outside, d.mean, d.most);
  return d;
}

void checkSame(const Volume &reference, double rounding) {
  Map map;
  map.centre = phantoms::centreOf(reference.geometry);
  const Difference d = difference(reference, map);
  CHECK(d.notANumber == 0);
  CHECK(d.mean < 1.0);
  // ITK's value is not rounded. Displacements as floats are right to 2e-6 mm here: some 1e-3 of a grey level at edges.
  CHECK(d.most <= rounding + 0.01);
  CHECK(d.moved > reference.geometry.voxelCount() / 3);
  CHECK(d.outside > 0);
  CHECK(d.outside < reference.geometry.voxelCount() / 2);
}

}  // namespace

TEST_CASE("A known affine map warps an image as ITK resamples it, border included", "[imaging][itk]") {
  checkSame(pattern(phantoms::grid({60, 50, 40}, {1.0, 1.2, 1.5})), 0.5);
  checkSame(pattern(phantoms::oblique({60, 50, 40}, {1.0, 1.2, 1.5})), 0.5);
  checkSame(pattern(phantoms::oblique({60, 50, 40}, {0.8, 0.9, 2.5}, true)), 0.5);
  Volume floats = pattern(phantoms::oblique({60, 50, 40}, {0.8, 0.9, 2.5}, true));
  const auto bytes = std::get<std::vector<std::uint8_t>>(floats.voxels);
  floats.voxels.emplace<std::vector<float>>(bytes.begin(), bytes.end());
  checkSame(floats, 0.0);
}

TEST_CASE("A real scan in 8 bits warps as ITK resamples it", "[imaging][itk]") {
  C3DE_DATA_OR_SKIP(file, "volume/totalseg/example_ct.nii.gz");
  const auto loaded = readVolume(file);
  REQUIRE(loaded);
  Volume scan;
  scan.geometry = loaded->volume.geometry;
  auto &grey = scan.voxels.emplace<std::vector<std::uint8_t>>();
  std::visit(
      [&](const auto &all) {
        for (const auto v : all) {
          const double share = std::clamp((static_cast<double>(v) + 160.0) / 400.0, 0.0, 1.0);  // level 40, window 400
          grey.push_back(static_cast<std::uint8_t>(std::lround(255.0 * share)));
        }
      },
      loaded->volume.voxels);
  checkSame(scan, 0.5);
}

TEST_CASE("Labels warp as ITK's nearest voxels", "[imaging][itk]") {
  Volume values = pattern(phantoms::oblique({60, 50, 40}, {0.8, 0.9, 2.5}, true));
  LabelMap labels;
  labels.geometry = values.geometry;
  const auto &bytes = std::get<std::vector<std::uint8_t>>(values.voxels);
  labels.voxels.assign(bytes.begin(), bytes.end());
  Map map;
  map.centre = phantoms::centreOf(labels.geometry);
  const auto found = warped(labels, displacementOf(map, labels.geometry));
  REQUIRE(found);
  const auto truth = itk_truth::resampled(values, map.sourceOf(), Sampling::nearest, 40);
  std::size_t different = 0;
  for (std::size_t v = 0; v < truth.size(); ++v) different += static_cast<float>(found->voxels[v]) != truth[v];
  std::printf("labels: %zu of %zu differ from ITK's\n", different, truth.size());
  // Halfway between two voxels (within the 2e-6 mm of the displacements) either is right: one in about 1e5.
  CHECK(different <= 5);
}

TEST_CASE("Without displacement both leave an image as it is, to the bit", "[imaging][itk]") {
  const Volume reference = pattern(phantoms::oblique({60, 50, 40}, {0.8, 0.9, 2.5}, true));
  const auto &before = std::get<std::vector<std::uint8_t>>(reference.voxels);
  Map still;
  still.gradient = {};
  still.shift = {};
  const auto found = warped(reference, displacementOf(still, reference.geometry));
  REQUIRE(found);
  CHECK(std::get<std::vector<std::uint8_t>>(found->voxels) == before);
  const auto truth = itk_truth::resampled(reference, kIdentity4, Sampling::linear, 1);
  double most = 0.0;
  for (std::size_t v = 0; v < truth.size(); ++v) most = std::max(most, std::abs(double(truth[v]) - before[v]));
  CHECK(most < 1e-3);  // the reference value is one: ITK returns to its voxels through matrices
}
