// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/warp.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>

#include "c3de/core/thread_pool.h"
#include "images.h"
#include "phantoms.h"

using namespace images;
using phantoms::Dice;

namespace {

template <class T>
Volume noise(const VolumeGeometry &g, std::uint64_t seed = 5) {
  Volume volume;
  volume.geometry = g;
  volume.slope = 0.5;
  volume.intercept = -3.0;
  volume.unit = "HU";
  Dice dice(seed);
  auto &all = volume.voxels.emplace<std::vector<T>>(g.voxelCount());
  for (T &v : all)
    if constexpr (std::is_floating_point_v<T>)
      v = static_cast<T>(1e-3 * dice(1u << 20) - 300.0);
    else
      v = static_cast<T>(dice(1u << 31) - (1u << 30));
  return volume;
}

/// u = A (x - c) + b about the centre of the grid.
DisplacementGrid affine(const VolumeGeometry &g, const Vec3 &about, const std::array<Vec3, 3> &rows, const Vec3 &b) {
  DisplacementGrid u{g, {}, {}, {}};
  for (std::size_t k = 0; k < g.size[2]; ++k)
    for (std::size_t j = 0; j < g.size[1]; ++j)
      for (std::size_t i = 0; i < g.size[0]; ++i) {
        const Vec3 x = g.worldAt({double(i), double(j), double(k)}) - about;
        for (std::size_t a = 0; a < 3; ++a) u.xyz_mm.push_back(static_cast<float>(dot(rows[a], x) + b[a]));
      }
  return u;
}
DisplacementGrid constant(const VolumeGeometry &g, const Vec3 &b) { return affine(g, {}, {}, b); }

/// Oblique, and around the whole displaced region.
VolumeGeometry gridAround(const VolumeGeometry &image, std::array<std::size_t, 3> size, double spacing) {
  VolumeGeometry g = phantoms::oblique(size, {spacing, spacing, spacing});
  const Vec3 shift = phantoms::centreOf(image) - phantoms::centreOf(g);
  for (std::size_t a = 0; a < 3; ++a) g.indexToWorld[12 + a] += shift[a];
  return g;
}

constexpr std::array<Vec3, 3> kGentle{{{0.04, -0.03, 0.02}, {0.02, 0.05, -0.04}, {-0.03, 0.01, -0.02}}};

/// Plain linear sampling by eight weights; halves are rounded away from zero for integer types.
double expectedAt(const Volume &reference, const Vec3 &world) {
  Vec3 at = transformPoint(affineInverse(reference.geometry.indexToWorld), world);
  double sum = 0.0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::array<std::size_t, 3> voxel{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto n = static_cast<double>(reference.geometry.size[a]);
      const double p = std::min(std::max(at[a], 0.0), n - 1.0), low = std::floor(p);
      const bool upper = (corner >> a & 1u) != 0;
      weight *= upper ? p - low : 1.0 - (p - low);
      voxel[a] = static_cast<std::size_t>(std::min(low + (upper ? 1.0 : 0.0), n - 1.0));
    }
    sum += weight * (reference.value(voxel[0], voxel[1], voxel[2]) - reference.intercept) / reference.slope;
  }
  return sum;
}

template <class T>
const std::vector<T> &voxelsOf(const Volume &volume) {
  return std::get<std::vector<T>>(volume.voxels);
}

template <class T>
void checkAgainstPlainSampling() {
  const VolumeGeometry g = awkwardGeometry(true);
  const Volume reference = noise<T>(g);
  const DisplacementGrid u = affine(gridAround(g, {9, 8, 11}, 2.0), phantoms::centreOf(g), kGentle, {0.4, -0.9, 0.6});
  const auto found = warped(reference, u);
  REQUIRE(found);
  CHECK(found->slope == reference.slope);
  CHECK(found->intercept == reference.intercept);
  CHECK(found->unit == "HU");
  CHECK(sameGrid(found->geometry, g, 0.0));
  const auto &voxels = voxelsOf<T>(*found);
  std::size_t at = 0;
  bool right = true;
  for (std::size_t k = 0; k < g.size[2]; ++k)
    for (std::size_t j = 0; j < g.size[1]; ++j)
      for (std::size_t i = 0; i < g.size[0]; ++i, ++at) {
        const Vec3 x = g.worldAt({double(i), double(j), double(k)});
        const double expected = expectedAt(reference, x - u.at(x));
        // Rounding to the type; the plain sum loses a few of the last bits of numbers of 1e9.
        const double slack = (std::is_floating_point_v<T> ? std::numeric_limits<T>::epsilon() * 1e3 : 0.5) + 1e-5;
        right = right && std::abs(static_cast<double>(voxels[at]) - expected) <= slack;
      }
  CHECK(right);
  CHECK(voxels != voxelsOf<T>(reference));
}

}  // namespace

TEST_CASE("Without displacement every bit of a warped image stays", "[imaging][warp]") {
  const VolumeGeometry g = phantoms::oblique({9, 7, 5}, {0.7, 1.1, 2.0}, true);
  const DisplacementGrid zero = constant(gridAround(g, {4, 5, 3}, 1.5), {});  // the grid covers a part
  const auto check = [&](const Volume &reference) {
    const auto found = warped(reference, zero);
    REQUIRE(found);
    REQUIRE(found->bytes() == reference.bytes());
    CHECK(std::visit(
        [&](const auto &all) {
          using T = typename std::decay_t<decltype(all)>::value_type;
          return std::memcmp(all.data(), voxelsOf<T>(*found).data(), reference.bytes()) == 0;
        },
        reference.voxels));
  };
  check(noise<std::int8_t>(g));
  check(noise<std::uint8_t>(g));
  check(noise<std::int16_t>(g));
  check(noise<std::uint16_t>(g));
  check(noise<std::int32_t>(g));
  check(noise<std::uint32_t>(g));
  check(noise<double>(g));
  Volume odd = noise<float>(g);
  auto &floats = std::get<std::vector<float>>(odd.voxels);
  floats[20] = std::numeric_limits<float>::quiet_NaN();
  floats[30] = -0.0f;
  floats[100] = std::numeric_limits<float>::infinity();
  check(odd);
}

TEST_CASE("A warped image is the reference sampled linearly where the material was, in every type", "[imaging][warp]") {
  checkAgainstPlainSampling<std::int8_t>();
  checkAgainstPlainSampling<std::uint8_t>();
  checkAgainstPlainSampling<std::int16_t>();
  checkAgainstPlainSampling<std::uint16_t>();
  checkAgainstPlainSampling<std::int32_t>();
  checkAgainstPlainSampling<std::uint32_t>();
  checkAgainstPlainSampling<float>();
  checkAgainstPlainSampling<double>();
}

TEST_CASE("What is displaced by whole voxels arrives there, and the border goes on behind it", "[imaging][warp]") {
  const VolumeGeometry g = phantoms::oblique({12, 10, 8}, {0.7, 1.1, 2.0}, true);
  const Volume reference = noise<std::int16_t>(g);
  const Vec3 u = g.worldAt({3, -2, 1}) - g.worldAt({0, 0, 0});
  const auto found = warped(reference, constant(gridAround(g, {9, 9, 9}, 4.0), u));
  REQUIRE(found);
  bool right = true;
  for (std::size_t k = 0; k < 8; ++k)
    for (std::size_t j = 0; j < 10; ++j)
      for (std::size_t i = 0; i < 12; ++i)
        right = right && found->value(i, j, k) ==
                             reference.value(i > 3 ? i - 3 : 0, std::min<std::size_t>(j + 2, 9), k > 1 ? k - 1 : 0);
  CHECK(right);
}

TEST_CASE("Outside of the grid of displacements the image stays", "[imaging][warp]") {
  const VolumeGeometry g = phantoms::grid({20, 4, 3});
  const Volume reference = noise<float>(g);
  VolumeGeometry part = phantoms::grid({5, 4, 3});
  part.indexToWorld[12] = 8.0;  // i = 8 … 12
  const auto found = warped(reference, constant(part, {2.0, 0.0, 0.0}));
  REQUIRE(found);
  for (std::size_t i = 0; i < 20; ++i) {
    CAPTURE(i);
    CHECK(found->value(i, 2, 1) == reference.value(i >= 8 && i <= 12 ? i - 2 : i, 2, 1));
  }
}

TEST_CASE("Warped labels are the nearest ones, and the list keeps those that are left", "[imaging][warp]") {
  LabelMap labels;
  labels.geometry = phantoms::grid({10, 3, 3}, {2.0, 2.0, 2.0});
  labels.voxels.assign(90, 4);
  for (std::size_t row = 0; row < 9; ++row) {
    labels.voxels[10 * row + 9] = 7;
    labels.voxels[10 * row + 2] = 300;
  }
  labels.labels = {{4, "liver", {}}, {7, "border", {}}, {300, "spleen", {}}};
  const VolumeGeometry around = gridAround(labels.geometry, {12, 12, 12}, 3.0);
  const auto found = warped(labels, constant(around, {2.9, 0.0, 0.0}));  // 1.45 voxels: the nearest is one away
  REQUIRE(found);
  for (std::size_t i = 0; i < 10; ++i) CHECK(found->voxels[40 + i] == (i == 3 ? 300 : 4));
  REQUIRE(found->labels.size() == 2);
  CHECK(found->labels[0].name == "liver");
  CHECK(found->labels[1].name == "spleen");
  const auto same = warped(labels, constant(around, {}));
  REQUIRE(same);
  CHECK(same->voxels == labels.voxels);
}

TEST_CASE("An image of label numbers is warped without numbers between them", "[imaging][warp]") {
  // Labels 1 and 200: their mean is 100, another organ.
  Volume labels;
  labels.geometry = phantoms::grid({12, 4, 4}, {2.0, 2.0, 2.0});
  std::vector<std::uint8_t> voxels(12 * 4 * 4, 0);
  for (std::size_t row = 0; row < 16; ++row)
    for (std::size_t i = 3; i < 9; ++i) voxels[12 * row + i] = i < 6 ? 1 : 200;
  labels.voxels = voxels;
  const DisplacementGrid u = constant(gridAround(labels.geometry, {8, 8, 8}, 3.0), {1.1, 0.0, 0.0});
  const auto mixed = warped(labels, u), nearest = warped(labels, u, {}, nullptr, WarpSampling::nearest);
  REQUIRE((mixed && nearest));
  const auto &found = std::get<std::vector<std::uint8_t>>(nearest->voxels);
  for (std::size_t i = 0; i < 12; ++i) CHECK(found[i] == (i < 4 ? 0 : i < 7 ? 1 : i < 10 ? 200 : 0));
  const auto &between = std::get<std::vector<std::uint8_t>>(mixed->voxels);
  CHECK(std::count_if(between.begin(), between.end(), [](int v) { return v != 0 && v != 1 && v != 200; }) > 0);
}

TEST_CASE("Labels that move by whole voxels are as many as before, also on the finer grid of an image",
          "[imaging][warp]") {
  LabelMap labels;
  labels.geometry = phantoms::oblique({20, 18, 16}, {3.0, 2.0, 1.5}, true);
  labels.voxels.assign(labels.geometry.voxelCount(), 0);
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) {
    const std::size_t i = v % 20, j = v / 20 % 18, k = v / 360;
    if (i > 3 && i < 14 && j > 3 && j < 12 && k > 3 && k < 11) labels.voxels[v] = (i + j + k) % 3 == 0 ? 7 : 40;
  }
  labels.labels = {{7, "spleen", {}}, {40, "liver", {}}};
  const auto counts = [](const LabelMap &map) {
    return std::array{std::count(map.voxels.begin(), map.voxels.end(), 7),
                      std::count(map.voxels.begin(), map.voxels.end(), 40)};
  };
  const Vec3 step = labels.geometry.worldAt({3, -2, 1}) - labels.geometry.worldAt({0, 0, 0});
  const DisplacementGrid u = constant(gridAround(labels.geometry, {12, 12, 12}, 8.0), step);
  const auto moved = warped(labels, u);
  REQUIRE(moved);
  CHECK(counts(*moved) == counts(labels));

  // Each voxel of the labels is eight of the image, whose grid is larger.
  VolumeGeometry image = labels.geometry;
  for (std::size_t a = 0; a < 3; ++a) {
    image.size[a] = 2 * labels.geometry.size[a] + 6;
    for (std::size_t r = 0; r < 3; ++r) image.indexToWorld[4 * a + r] *= 0.5;
  }
  const Vec3 first = labels.geometry.worldAt({-1.75, -1.75, -1.75});
  for (std::size_t r = 0; r < 3; ++r) image.indexToWorld[12 + r] = first[r];
  const auto still = warped(labels, constant(u.geometry, {}), image), finer = warped(labels, u, image);
  REQUIRE((still && finer));
  CHECK(sameGrid(finer->geometry, image));
  for (const auto &map : {*still, *finer}) {
    CHECK(counts(map)[0] == 8 * counts(labels)[0]);
    CHECK(counts(map)[1] == 8 * counts(labels)[1]);
    CHECK(map.labels.size() == 2);
  }
  CHECK(still->voxels != finer->voxels);
}

TEST_CASE("The field and its length on the grid of an image are those at its voxels", "[imaging][warp]") {
  const VolumeGeometry g = awkwardGeometry(true);
  const DisplacementGrid u = affine(gridAround(g, {6, 5, 3}, 2.0), phantoms::centreOf(g), kGentle, {0.4, -0.9, 0.6});
  const auto field = resampled(u, g);
  const auto length = magnitudeOf(u, g);
  REQUIRE((field && length));
  CHECK(length->unit == "mm");
  CHECK(field->xyz_mm.size() == 3 * g.voxelCount());
  std::size_t zeros = 0, at = 0;
  for (std::size_t k = 0; k < g.size[2]; ++k)
    for (std::size_t j = 0; j < g.size[1]; ++j)
      for (std::size_t i = 0; i < g.size[0]; ++i, ++at) {
        const Vec3 d = u.at(g.worldAt({double(i), double(j), double(k)}));
        zeros += norm(d) == 0.0;
        for (std::size_t a = 0; a < 3; ++a) CHECK_THAT(field->xyz_mm[3 * at + a], WithinAbs(d[a], 1e-6));  // float
        CHECK_THAT(length->value(i, j, k), WithinAbs(norm(d), 1e-6));
      }
  CHECK(zeros > 0);
  CHECK(zeros < g.voxelCount());
}

TEST_CASE("A field on the grid of the image warps up to its outermost voxels", "[imaging][warp]") {
  const VolumeGeometry g = phantoms::oblique({31, 17, 9}, {0.7, 1.1, 2.0}, true);
  const Volume reference = noise<double>(g);
  const DisplacementGrid u = affine(gridAround(g, {20, 20, 20}, 2.0), phantoms::centreOf(g), kGentle, {0.4, -0.9, 0.6});
  const auto onImage = resampled(u, g);
  REQUIRE(onImage);
  const auto once = warped(reference, u), again = warped(reference, *onImage);
  REQUIRE((once && again));
  double most = 0.0;
  for (std::size_t v = 0; v < g.voxelCount(); ++v)
    most = std::max(most, std::abs(voxelsOf<double>(*once)[v] - voxelsOf<double>(*again)[v]));
  CHECK(most < 2e-2);  // displacements as floats are right to 1e-6 mm; neighbours differ by up to 1000
}

TEST_CASE("What is no number does not spread to voxels displaced beside it", "[imaging][warp]") {
  const VolumeGeometry g = phantoms::grid({8, 1, 1});
  Volume reference = noise<float>(g);
  std::get<std::vector<float>>(reference.voxels)[4] = std::numeric_limits<float>::quiet_NaN();
  VolumeGeometry wide = phantoms::grid({2, 2, 2}, {20, 20, 20});
  for (std::size_t a = 0; a < 3; ++a) wide.indexToWorld[12 + a] = -10.0;
  const auto found = warped(reference, constant(wide, {1.0, 0.0, 0.0}));
  REQUIRE(found);
  for (std::size_t i = 0; i < 8; ++i) CHECK(std::isnan(found->value(i, 0, 0)) == (i == 5));
}

TEST_CASE("Any number of threads warps to the same bits", "[imaging][warp]") {
  const VolumeGeometry g = phantoms::oblique({40, 30, 20}, {0.7, 1.1, 2.0});
  const Volume reference = noise<float>(g);
  const DisplacementGrid u = affine(gridAround(g, {9, 9, 9}, 5.0), phantoms::centreOf(g), kGentle, {0.4, -0.9, 0.6});
  ThreadPool one(1), three(3);
  const auto a = warped(reference, u, {}, &one), b = warped(reference, u, {}, &three);
  const auto c = warped(reference, u, [](double, const std::string &) { return true; });
  REQUIRE((a && b && c));
  CHECK(voxelsOf<float>(*a) == voxelsOf<float>(*b));
  CHECK(voxelsOf<float>(*a) == voxelsOf<float>(*c));
}

TEST_CASE("Warping says what is wrong with a field, and stops when it is told to", "[imaging][warp]") {
  const VolumeGeometry g = phantoms::grid({40, 40, 40});
  const Volume reference = noise<std::int16_t>(g);
  const auto message = [&](const DisplacementGrid &u) {
    const auto found = warped(reference, u);
    REQUIRE_FALSE(found);
    CHECK(found.error().code == ErrorCode::usage);
    CHECK_FALSE(magnitudeOf(u, g));
    CHECK_FALSE(resampled(u, g));
    return found.error().message;
  };
  DisplacementGrid u = constant(phantoms::grid({4, 3, 2}), {1.0, 0.0, 0.0});
  u.xyz_mm[3 * (1 + 4 * (2 + 3 * 1)) + 2] = std::numeric_limits<float>::infinity();
  CHECK_THAT(message(u), Contains("point 1 2 1 is inf"));
  u.xyz_mm.pop_back();
  CHECK_THAT(message(u), Contains("71 values") && Contains("24 points need 72"));
  CHECK_THAT(message({}), Contains("0 x 0 x 0"));
  u = constant(phantoms::grid({4, 3, 2}), {});
  u.geometry.indexToWorld[10] = 0.0;
  CHECK_THAT(message(u), Contains("0 mm³"));
  CHECK(norm(DisplacementGrid{}.at({1, 2, 3})) == 0.0);

  Volume cut = reference;
  std::get<std::vector<std::int16_t>>(cut.voxels).pop_back();
  const DisplacementGrid good = constant(phantoms::grid({4, 3, 2}), {1.0, 0.0, 0.0});
  CHECK(warped(cut, good).error().code == ErrorCode::internal);
  double reached = 0.0;
  const auto stopped =
      warped(reference, good, [&](double fraction, const std::string &) { return (reached = fraction) < 0.3; });
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::cancelled);
  CHECK(reached < 0.4);
}

// Not a test: the cost of a large image. 512 x 512 x 200 of int16, grid of 40 x 40 x 30 around all of it.
TEST_CASE("Time of a large warp", "[.][warp-time]") {
  const VolumeGeometry g = phantoms::grid({512, 512, 200}, {0.7, 0.7, 1.5});
  const Volume reference = noise<std::int16_t>(g);
  const DisplacementGrid u = affine(gridAround(g, {90, 90, 90}, 8.0), phantoms::centreOf(g), kGentle, {3.0, -2.0, 5.0});
  const auto timed = [](const char *what, const auto &work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    std::printf("%s: %.2f s\n", what, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  };
  timed("image", [&] { REQUIRE(warped(reference, u)); });
  ThreadPool one(1);
  timed("image, one thread", [&] { REQUIRE(warped(reference, u, {}, &one)); });
  timed("length", [&] { REQUIRE(magnitudeOf(u, g)); });
  timed("field", [&] { REQUIRE(resampled(u, g)); });
  timed("image, field of zeros", [&] { REQUIRE(warped(reference, constant(u.geometry, {}))); });
}

TEST_CASE("what a body has left is empty, wherever the rim leads, and what it has reached is full", "[imaging][warp]") {
  // A bright ball that has moved 30 mm along x; around it nothing is displaced (no rim).
  const VolumeGeometry g{{60, 30, 30}, {1.5, 0, 0, 0, 0, 1.5, 0, 0, 0, 0, 1.5, 0, -30, -22, -22, 1}};
  const double radius = 9.0, way = 30.0;
  Volume reference;
  reference.geometry = g;
  auto bodies = std::make_shared<Mask>(Mask{g, std::vector<std::uint8_t>(g.voxelCount(), 0)});
  LabelMap labels;
  labels.geometry = g;
  labels.labels = {{3, "ball", {}}};
  std::vector<std::int16_t> voxels;
  const auto forVoxels = [&](const auto &visit) {
    for (std::size_t k = 0; k < g.size[2]; ++k)
      for (std::size_t j = 0; j < g.size[1]; ++j)
        for (std::size_t i = 0; i < g.size[0]; ++i)
          visit(i + g.size[0] * (j + g.size[1] * k), g.worldAt({double(i), double(j), double(k)}));
  };
  forVoxels([&](std::size_t v, const Vec3 &x) {
    const bool inside = norm(x) < radius;
    voxels.push_back(inside ? 900 : static_cast<std::int16_t>(100 + v % 7));
    labels.voxels.push_back(inside ? 3 : 0);
    bodies->voxels[v] = inside ? 1 : 0;
  });
  voxels[5] = -50;  // the lowest
  reference.voxels = voxels;
  DisplacementGrid u{g, {}, {}, bodies};
  forVoxels([&](std::size_t, const Vec3 &x) {
    const bool isThere = norm(x - Vec3{way, 0, 0}) < radius + 2.0;
    u.xyz_mm.insert(u.xyz_mm.end(), {isThere ? float(way) : 0.0f, 0.0f, 0.0f});
    u.gap_mm.push_back(!isThere && norm(x) < radius + 2.0 ? float(way) : 0.0f);
  });
  // A grid around the ball's current position gives the same: outside of it everything in `bodies` has moved away.
  const std::size_t cut = GENERATE(0, 32);
  DisplacementGrid part = u;
  part.geometry.size[0] -= cut;
  part.geometry.indexToWorld[12] += 1.5 * static_cast<double>(cut);
  part.xyz_mm.clear(), part.gap_mm.clear();
  for (std::size_t v = 0; v < g.voxelCount(); ++v)
    if (v % g.size[0] >= cut) {
      part.xyz_mm.insert(part.xyz_mm.end(), &u.xyz_mm[3 * v], &u.xyz_mm[3 * v] + 3);
      part.gap_mm.push_back(u.gap_mm[v]);
    }
  const auto out = warped(reference, part);
  const auto moved = warped(labels, part);
  REQUIRE(out);
  REQUIRE(moved);
  const auto &now = std::get<std::vector<std::int16_t>>(out->voxels);
  std::size_t empty = 0, full = 0;
  forVoxels([&](std::size_t v, const Vec3 &x) {
    if (norm(x) < radius) {
      REQUIRE(now[v] == -50);
      REQUIRE(moved->voxels[v] == 0);
      REQUIRE(part.isEmptied(x));
      ++empty;
    } else {
      REQUIRE_FALSE(part.isEmptied(x));
    }
    if (norm(x - Vec3{way, 0, 0}) < radius - 2.0) {
      REQUIRE(now[v] == 900);
      REQUIRE(moved->voxels[v] == 3);
      ++full;
    }
  });
  CHECK(empty > 500);
  CHECK(full > 300);
  // Without information about bodies the reference remains where nothing is displaced.
  part.bodies = nullptr;
  const auto kept = warped(reference, part);
  REQUIRE(kept);
  forVoxels([&](std::size_t v, const Vec3 &x) {
    if (norm(x) < radius) REQUIRE(std::get<std::vector<std::int16_t>>(kept->voxels)[v] == 900);
  });
}
