// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/coverage.h"

#include "box_mesh.h"
#include "c3de/imaging/masks.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::session;
using session::test::boxMesh;

namespace {

/// 10 x 10 x 10 voxels of 1 mm, centres from 0 to 9, all in the mask.
imaging::Mask wholeMask() {
  imaging::Mask mask;
  mask.geometry.size = {10, 10, 10};
  mask.voxels.assign(1000, 1);
  return mask;
}

Coverage coverage(double requested_mm3, double missing_mm3, std::size_t specks) {
  Coverage out;
  out.body = "aorta";
  out.requested_mm3 = requested_mm3;
  out.missing_mm3 = missing_mm3;
  out.specks = specks;
  return out;
}

}  // namespace

TEST_CASE("What a skin leaves of a mask outside is told by volume and place") {
  // Centres 0 … 4 are inside, 5 is adjacent to one: 6 … 9 are missing.
  const Coverage half = coverageOf(wholeMask(), boxMesh({-0.4, -0.4, -0.4}, {4.4, 9.4, 9.4}), 3);
  CHECK(half.requested_mm3 == 1000.0);
  CHECK(half.missing_mm3 == 400.0);
  CHECK(half.specks == 3);
  CHECK_THAT(half.part(), WithinAbs(0.6, 1e-12));
  REQUIRE(half.missing);
  CHECK(imaging::voxelCount(*half.missing) == 400);
  CHECK(half.missing->voxels[5] == 0);
  CHECK(half.missing->voxels[6] == 1);
  const Coverage all = coverageOf(wholeMask(), boxMesh({-0.4, -0.4, -0.4}, {9.4, 9.4, 9.4}), 0);
  CHECK(all.missing_mm3 == 0.0);
  CHECK_FALSE(all.missing);
  CHECK(all.part() == 1.0);
  CHECK(Coverage{}.part() == 1.0);
}

TEST_CASE("What is missing is a sentence from a thousandth on, with what would help") {
  CHECK(sentenceOf(coverage(1000.0, 1.0, 0)).empty());
  CHECK(sentenceOf(coverage(1000.0, 1.1, 0)) ==
        "0.0011 ml (0.11 %) of the volume requested as 'aorta' belongs to no body; shorter edges of the skin "
        "(edge_length) "
        "keep thin parts");
  CHECK(sentenceOf(coverage(200000.0, 12340.0, 1)) ==
        "12.3 ml (6.2 %) of the volume requested as 'aorta' belongs to no body; 1 loose island of a few voxels is "
        "omitted; "
        "shorter edges of the skin (edge_length) keep thin parts");
  CHECK_THAT(sentenceOf(coverage(1000.0, 400.0, 2)), Contains("; 2 loose islands of a few voxels are omitted; "));
  CHECK(sentenceOf(coverage(0.0, 0.0, 0)).empty());
}

TEST_CASE("What is missing of several bodies lies on one grid, wherever their masks have theirs") {
  imaging::VolumeGeometry grid;
  grid.size = {10, 10, 10};
  const auto missing = [](const imaging::VolumeGeometry &on, std::size_t voxel) {
    auto mask = std::make_shared<imaging::Mask>();
    mask->geometry = on;
    mask->voxels.assign(on.voxelCount(), 0);
    mask->voxels[voxel] = 1;
    Coverage out;
    out.missing = mask;
    return out;
  };
  // Voxels of 2 mm: the first covers two of 1 mm along each axis, except for those before the start of the grid.
  const imaging::VolumeGeometry coarse{{5, 5, 5}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0.5, 0.5, 0.5, 1}};
  const imaging::Mask all = missingOn(grid, {missing(grid, 999), Coverage{}, missing(coarse, 0)});
  REQUIRE(all.voxels.size() == 1000);
  CHECK(imaging::voxelCount(all) == 9);
  CHECK(all.voxels[999] == 1);
  CHECK(all.voxels[0] == 1);
  CHECK(all.voxels[1 + 10 * (1 + 10 * 1)] == 1);
  CHECK(missingOn(grid, {}).voxels.empty());
  CHECK(missingOn(grid, {Coverage{}}).voxels.empty());
  const imaging::VolumeGeometry far{{5, 5, 5}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 500, 0, 0, 1}};
  CHECK(missingOn(grid, {missing(far, 0)}).voxels.empty());
}
