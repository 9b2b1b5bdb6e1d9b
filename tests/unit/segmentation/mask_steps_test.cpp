// SPDX-License-Identifier: Apache-2.0
#include "c3de/segmentation/mask_steps.h"

#include <algorithm>

#include "c3de/imaging/masks.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::segmentation;

namespace {

using Kind = MaskStep::Kind;

/// 12 x 10 x 8 voxels of 2 x 3 x 4 mm; value 1000 in a box, 500 in a separate one.
MaskSources twoBoxes() {
  auto image = std::make_shared<scene::StoredImage>();
  image->volume.geometry = {{12, 10, 8}, {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0, -10, 20, 30, 1}};
  std::vector<std::int16_t> voxels(12 * 10 * 8, 0);
  for (std::size_t k = 2; k < 5; ++k)
    for (std::size_t j = 3; j < 7; ++j) {
      for (std::size_t i = 1; i < 4; ++i) voxels[i + 12 * (j + 10 * k)] = 1000;
      for (std::size_t i = 6; i < 11; ++i) voxels[i + 12 * (j + 10 * k)] = 500;
    }
  image->volume.voxels = voxels;
  return {image, nullptr};
}

MaskStep step(Kind kind) {
  MaskStep s;
  s.kind = kind;
  return s;
}

imaging::Mask thresholded(const MaskSources &sources, double low) {
  MaskStep s = step(Kind::threshold);
  s.low = low;
  s.high = 2000;
  auto mask = carriedOut(s, sources, nullptr);
  REQUIRE(mask);
  return std::move(*mask);
}

}  // namespace

TEST_CASE("A click keeps the part it lies in, and says so when it lies in none", "[mask_steps]") {
  const MaskSources sources = twoBoxes();
  const imaging::Mask both = thresholded(sources, 400);
  REQUIRE(imaging::voxelCount(both) == 3 * 4 * 3 + 5 * 4 * 3);
  MaskStep click = step(Kind::component);
  click.world = {-10 + 2 * 2.4, 20 + 3 * 4.0, 30 + 4 * 3.0};  // nearest to voxel 2, 4, 3
  const auto small = carriedOut(click, sources, &both);
  REQUIRE(small);
  CHECK(imaging::voxelCount(*small) == 3 * 4 * 3);
  click.world = {-10 + 2 * 5.0, 20 + 3 * 4.0, 30 + 4 * 3.0};  // between the boxes
  const auto between = carriedOut(click, sources, &both);
  REQUIRE_FALSE(between);
  CHECK_THAT(between.error().message, Contains("outside of the mask") && Contains("0.0, 32.0, 42.0 mm"));
  click.world = {500, 0, 0};
  CHECK_FALSE(carriedOut(click, sources, &both));
}

TEST_CASE("Steps that need a mask say so when there is none", "[mask_steps]") {
  for (const Kind kind : {Kind::component, Kind::largest, Kind::fillHoles, Kind::close, Kind::open}) {
    const auto done = carriedOut(step(kind), twoBoxes(), nullptr);
    REQUIRE_FALSE(done);
    CHECK_THAT(done.error().message, Contains("nothing is picked yet"));
  }
  CHECK_THAT(carriedOut(step(Kind::label), twoBoxes(), nullptr).error().message, Contains("no label map"));
  CHECK_THAT(carriedOut(step(Kind::threshold), {}, nullptr).error().message, Contains("none is open"));
}

TEST_CASE("A preview covers exactly what is inside, at its place", "[mask_steps]") {
  const imaging::Mask mask = thresholded(twoBoxes(), 800);
  const MaskPreview preview = previewOf(mask, 1000);
  CHECK(preview.stride == 1);
  CHECK(preview.geometry.size == std::array<std::size_t, 3>{3, 4, 3});
  CHECK(norm(preview.geometry.worldAt({0, 0, 0}) - mask.geometry.worldAt({1, 3, 2})) < 1e-12);
  CHECK(norm(preview.geometry.worldAt({2, 3, 2}) - mask.geometry.worldAt({3, 6, 4})) < 1e-12);
  CHECK(std::all_of(preview.voxels.begin(), preview.voxels.end(), [](std::uint16_t v) { return v == 1; }));
  CHECK(previewOf(thresholded(twoBoxes(), 1500), 1000).voxels.empty());
}

TEST_CASE("A preview that would be too large shows every second voxel", "[mask_steps]") {
  const imaging::Mask mask = thresholded(twoBoxes(), 400);  // its box: 10 x 4 x 3
  const MaskPreview preview = previewOf(mask, 100);
  CHECK(preview.stride == 2);
  REQUIRE(preview.geometry.size == std::array<std::size_t, 3>{5, 2, 2});
  REQUIRE(preview.voxels.size() == 20);
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(preview.voxels[i] == mask.voxels[1 + 2 * i + 12 * (3 + 10 * 2)]);
    CHECK(norm(preview.geometry.worldAt({static_cast<double>(i), 1, 1}) -
               mask.geometry.worldAt({1.0 + 2.0 * static_cast<double>(i), 5, 4})) < 1e-12);
  }
}

TEST_CASE("A packed mask is the mask again", "[mask_steps]") {
  imaging::Mask mask{{{5, 3, 3}, kIdentity4}, std::vector<std::uint8_t>(45)};
  for (std::size_t v = 0; v < 45; ++v) mask.voxels[v] = v * v % 7 < 3 ? 1 : 0;
  const imaging::Mask again = PackedMask(mask).mask();
  CHECK(again.voxels == mask.voxels);
  CHECK(again.geometry.size == mask.geometry.size);
}

TEST_CASE("Masks in the history are those that were stored, and small where they are compact", "[mask_steps]") {
  imaging::Mask mask = thresholded(twoBoxes(), 400);
  for (const bool isNoise : {false, true}) {
    if (isNoise)
      for (std::size_t v = 0; v < mask.voxels.size(); ++v) mask.voxels[v] = static_cast<std::uint8_t>(v * 7 % 3 == 0);
    const PackedMask packed(mask);
    CHECK(packed.mask().voxels == mask.voxels);
    CHECK(packed.bytes() < sizeof(PackedMask) + mask.voxels.size() / 8 + 1);
  }
  imaging::Mask large{{{100, 100, 100}, kIdentity4}, std::vector<std::uint8_t>(1000000)};
  std::fill(large.voxels.begin() + 400000, large.voxels.begin() + 600000, std::uint8_t{1});
  CHECK(PackedMask(large).bytes() < 1000);
  CHECK(PackedMask(large).mask().voxels == large.voxels);
}
