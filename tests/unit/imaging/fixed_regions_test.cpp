// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/fixed_regions.h"

#include "c3de/imaging/warp.h"
#include "phantoms.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::imaging;

namespace {

// A soft ball in a bony shell, with air around it; the ball moves five voxels along x, and its surroundings with it (a
// wide rim).
struct Head {
  VolumeGeometry g = phantoms::grid({48, 40, 40}, {1.5, 1.5, 1.5});
  Vec3 centre = phantoms::centreOf(g);
  Volume image;
  std::shared_ptr<Mask> places = std::make_shared<Mask>(phantoms::ball(g, 12.0));
  static constexpr double kWay = 7.5, kBody = 12.0, kInner = 16.0, kOuter = 20.0;

  Head() {
    image.geometry = g;
    image.slope = 2.0;
    image.intercept = -1000.0;
    std::vector<std::int16_t> voxels;
    forVoxels([&](std::size_t, double r) {
      const double value = r < kBody ? 40.0 : r < kInner ? 10.0 : r < kOuter ? 900.0 : -1000.0;
      voxels.push_back(static_cast<std::int16_t>((value + 1000.0) / 2.0));
    });
    image.voxels = voxels;
  }
  template <class Visit>
  void forVoxels(const Visit &visit) const {
    std::size_t v = 0;
    for (std::size_t k = 0; k < g.size[2]; ++k)
      for (std::size_t j = 0; j < g.size[1]; ++j)
        for (std::size_t i = 0; i < g.size[0]; ++i, ++v) visit(v, norm(at(v) - centre));
  }
  [[nodiscard]] Vec3 at(std::size_t v) const {
    return g.worldAt({double(v % g.size[0]), double(v / g.size[0] % g.size[1]), double(v / g.size[0] / g.size[1])});
  }
  [[nodiscard]] DisplacementGrid moved(const FixedRegionRule &rule, const LabelMap *labels = nullptr) const {
    const auto marked = std::make_shared<Mask>(*places);
    REQUIRE(markFixedRegions(rule, image, labels, *marked));
    DisplacementGrid u{g, {}, std::vector<float>(g.voxelCount(), 0.0f), marked, !rule.isEmpty()};
    for (std::size_t v = 0; v < g.voxelCount(); ++v) u.xyz_mm.insert(u.xyz_mm.end(), {float(kWay), 0.0f, 0.0f});
    return u;
  }
};

FixedRegionRule boneAndAir() { return {200.0, -400.0, {}, false}; }

}  // namespace

TEST_CASE("Bone and air stay where they are while a body and what is soft move", "[imaging][still]") {
  const Head head;
  const DisplacementGrid u = head.moved(boneAndAir()), all = head.moved({});
  const auto out = warped(head.image, u);
  const auto size = magnitudeOf(u, head.g), without = magnitudeOf(all, head.g);
  const auto field = resampled(u, head.g);
  REQUIRE((out && size && without && field));
  const auto &lengths = std::get<std::vector<float>>(size->voxels);
  std::size_t bone = 0, air = 0, gap = 0, tissue = 0, soft = 0;
  head.forVoxels([&](std::size_t v, double r) {
    const Vec3 x = head.at(v);
    const double from = norm(x - Vec3{Head::kWay, 0, 0} - head.centre);  // of the material that would be there
    const double value = out->slope * std::get<std::vector<std::int16_t>>(out->voxels)[v] + out->intercept;
    REQUIRE(std::get<std::vector<float>>(without->voxels)[v] == Approx(Head::kWay));
    if (from < Head::kBody) {
      // The body covers everything.
      REQUIRE(lengths[v] == Approx(Head::kWay));
      REQUIRE_FALSE(u.isEmptied(x));
      if (from < Head::kBody - 1.5) REQUIRE(value == 40.0);
      ++tissue;
    } else if (r >= Head::kInner) {
      REQUIRE(u.at(x) == Vec3{});
      REQUIRE(lengths[v] == 0.0f);
      REQUIRE(field->xyz_mm[3 * v] == 0.0f);
      REQUIRE_FALSE(u.isEmptied(x));
      REQUIRE(value == (r < Head::kOuter ? 900.0 : -1000.0));
      ++(r < Head::kOuter ? bone : air);
    } else if (from >= Head::kInner) {
      // The former content has left the bone: a gap.
      REQUIRE(u.isEmptied(x));
      REQUIRE(value == -1000.0);
      ++gap;
    } else {
      REQUIRE(lengths[v] == Approx(Head::kWay));
      REQUIRE_FALSE(u.isEmptied(x));
      ++soft;
    }
  });
  CHECK((bone > 2000 && air > 10000 && gap > 500 && tissue > 1500 && soft > 500));
  // Without a rule the bone deforms with the ball.
  CHECK(all.at(head.centre + Vec3{0, 18, 0}) == Vec3{Head::kWay, 0, 0});
}

TEST_CASE("What moves by less than is seen beside bone opens no gap", "[imaging][still]") {
  const Head head;
  DisplacementGrid u = head.moved(boneAndAir());
  for (std::size_t p = 0; p < u.xyz_mm.size(); p += 3) u.xyz_mm[p] = 0.1f;
  head.forVoxels([&](std::size_t v, double r) {
    if (r > Head::kBody) REQUIRE_FALSE(u.isEmptied(head.at(v)));
  });
}

TEST_CASE("Labels stay, on a grid of their own, and all outside of bodies does", "[imaging][still]") {
  const Head head;
  LabelMap labels;
  labels.geometry = phantoms::grid({25, 21, 21}, {3.0, 3.0, 3.0});
  labels.labels = {{4, "left", {}}, {9, "right", {}}};
  const auto right = [](double x) { return x > 36.0; };
  for (std::size_t v = 0; v < labels.geometry.voxelCount(); ++v)
    labels.voxels.push_back(right(3.0 * double(v % 25)) ? 9 : 4);
  const DisplacementGrid u = head.moved({{}, {}, {9}, false}, &labels), outside = head.moved({{}, {}, {}, true});
  head.forVoxels([&](std::size_t v, double) {
    const Vec3 x = head.at(v);
    const bool comesFromBody = norm(x - Vec3{Head::kWay, 0, 0} - head.centre) < Head::kBody;
    if (comesFromBody) {
      REQUIRE(u.at(x) == Vec3{Head::kWay, 0, 0});
      REQUIRE(outside.at(x) == Vec3{Head::kWay, 0, 0});
      return;
    }
    if (right(x[0] + 1.5) && right(x[0] - 1.5)) REQUIRE(u.at(x) == Vec3{});
    if (!right(x[0] + 1.5) && !right(x[0] - 1.5)) REQUIRE(u.at(x) == Vec3{Head::kWay, 0, 0});
    // The former region of the body is empty: u leads out of it, and there is a gap.
    if (norm(x - head.centre) >= Head::kBody)
      REQUIRE(outside.at(x) == Vec3{});
    else
      REQUIRE(outside.isEmptied(x));
  });
}

TEST_CASE("Voxels of bodies do not stay, whatever their value, and another grid is refused", "[imaging][still]") {
  const Head head;
  Mask marked = *head.places;
  REQUIRE(markFixedRegions({-2000.0, {}, {}, false}, head.image, nullptr, marked));
  head.forVoxels(
      [&](std::size_t v, double r) { REQUIRE(marked.voxels[v] == (r < Head::kBody ? kBodyVoxel : kFixedVoxel)); });
  Mask other = phantoms::ball(phantoms::grid({10, 10, 10}), 3.0);
  CHECK_FALSE(markFixedRegions(boneAndAir(), head.image, nullptr, other));
}

TEST_CASE("Beside rigid tissue nothing bends it, and a gap is where the simulator has one", "[imaging][still]") {
  // Rigid on the left of 30 mm, tissue on its right; points of the displacement 8 mm apart, one of them at 28 mm.
  const VolumeGeometry g = phantoms::grid({60, 12, 12});
  const auto bodies = std::make_shared<Mask>(Mask{g, std::vector<std::uint8_t>(g.voxelCount(), 0)});
  LabelMap tissues{phantoms::grid({20, 4, 4}, {3.0, 3.0, 3.0}), {}, {}};
  for (std::size_t v = 0; v < 320; ++v) tissues.voxels.push_back(v % 20 < 5 ? 2 : 1);
  Mat4 placement = kIdentity4;  // the map is offset by 16 mm from the position of its body
  placement[12] = 16.0;
  const std::vector<std::uint16_t> rigid{2}, none{7};
  markTissues(tissues, placement, none, *bodies);
  CHECK_FALSE(hasFixedVoxels(*bodies));
  markTissues(tissues, placement, rigid, *bodies);
  CHECK(hasFixedVoxels(*bodies));
  const double border = 16.0 + 3.0 * 5.0 - 1.5;  // 29.5: from half a voxel before the first centre
  for (std::size_t i = 15; i < 60; ++i) REQUIRE(bodies->voxels[i] == (double(i) < border ? kRigidVoxel : kBodyVoxel));
  DisplacementGrid u;
  u.geometry = phantoms::grid({9, 3, 3}, {8.0, 8.0, 8.0});
  u.geometry.indexToWorld[12] = -4.0;
  u.bodies = bodies;
  u.hasFixedRegions = true;
  u.gap_mm.assign(81, 0.0f);
  // Stretched away from the border fivefold, as attached tissue is: between points this bends the rigid part.
  for (std::size_t p = 0; p < 81; ++p) {
    const double x = -4.0 + 8.0 * double(p % 9);
    u.xyz_mm.insert(u.xyz_mm.end(), {float(std::max(0.0, 0.8 * (x - border))), 0.0f, 0.0f});
  }
  REQUIRE(u.continuousAt({29.0, 4, 4})[0] > 0.2);
  for (double x = 16.0; x < 55.0; x += 0.125) {
    CAPTURE(x);
    const double told = u.continuousAt({x, 4, 4})[0];
    if (x == border || x - told == border) continue;
    REQUIRE_FALSE(u.isEmptied({x, 4, 4}));
    REQUIRE(u.at({x, 4, 4})[0] == (x < border || x - told < border ? 0.0 : told));
    REQUIRE(u.hasTissue({x, 4, 4}) == (x > border && x - told > border));
  }
  // Torn off by 8 mm: a gap of that width.
  for (std::size_t p = 0; p < 81; ++p) {
    const double x = -4.0 + 8.0 * double(p % 9);
    u.xyz_mm[3 * p] = x < border ? 0.0f : 8.0f;
    u.gap_mm[p] = x > border && x < border + 8.0 ? 8.0f : 0.0f;
  }
  CHECK(u.isEmptied({border + 3.0, 4, 4}));
  CHECK_FALSE(u.isEmptied({border - 2.0, 4, 4}));
  CHECK_FALSE(u.isEmptied({border + 16.0, 4, 4}));
  CHECK(u.at({border - 2.0, 4, 4}) == Vec3{});
}
