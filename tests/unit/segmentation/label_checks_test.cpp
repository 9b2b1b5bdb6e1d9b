// SPDX-License-Identifier: Apache-2.0
// Contradictions between image and labels of a body, before it is created: each check on both sides of its threshold.
#include "c3de/segmentation/label_checks.h"

#include <functional>

#include "support/catch.h"

using namespace c3de;
using namespace c3de::segmentation;
using Catch::Matchers::Contains;
using Kind = LabelFinding::Kind;

namespace {

constexpr std::size_t kSize = 40;  // voxels of 3 mm along each axis

imaging::VolumeGeometry grid(std::size_t slices = kSize, double first_mm = 0.0) {
  return {{kSize, kSize, slices}, {3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 0, 0, first_mm, 1}};
}

bool isWithin(std::size_t i, std::size_t j, std::size_t k, std::size_t middle, std::size_t radius) {
  const auto apart = [&](std::size_t x) { return x > middle ? x - middle : middle - x; };
  return std::max({apart(i), apart(j), apart(k)}) <= radius;
}

/// A trunk of fat in air with a liver, a bone and a vessel; the tests modify it.
struct Scan {
  imaging::Volume image;
  imaging::LabelMap labels;
  std::vector<LabelRole> roles{LabelRole::soft, LabelRole::rigid, LabelRole::soft};

  explicit Scan(std::int16_t boneMedian = 220, std::int16_t vessel = 45, std::size_t slices = kSize) {
    image.geometry = grid();
    image.unit = "HU";
    labels.geometry = grid(slices);
    labels.voxels.assign(labels.geometry.voxelCount(), 0);
    labels.labels = {{1, "liver", {}}, {2, "vertebrae_L1", {}}, {3, "aorta", {}}};
    std::vector<std::int16_t> values(image.geometry.voxelCount(), -1000);
    each([&](std::size_t i, std::size_t j, std::size_t k, std::size_t v) {
      if (!isWithin(i, j, k, 20, 17)) return;
      values[v] = -90;
      std::uint16_t label = 0;
      if (i >= 5 && i < 15 && j >= 5 && j < 15) values[v] = 60, label = 1;
      if (i >= 18 && i < 26 && j >= 24 && j < 32) values[v] = boneMedian, label = 2;
      if (i >= 24 && i < 28 && j >= 10 && j < 14) values[v] = vessel, label = 3;
      if (k < slices) labels.voxels[v] = label;
    });
    image.voxels = std::move(values);
  }
  static void each(const std::function<void(std::size_t, std::size_t, std::size_t, std::size_t)> &call) {
    std::size_t v = 0;
    for (std::size_t k = 0; k < kSize; ++k)
      for (std::size_t j = 0; j < kSize; ++j)
        for (std::size_t i = 0; i < kSize; ++i, ++v) call(i, j, k, v);
  }
  [[nodiscard]] std::int16_t &value(std::size_t v) { return std::get<std::vector<std::int16_t>>(image.voxels)[v]; }

  [[nodiscard]] LabelCheck check() const {
    LabelCheck out;
    out.layers = {&labels};
    out.roles = {roles};
    out.image = &image;
    out.background = {-150.0, 250.0, "fat"};
    return out;
  }
  [[nodiscard]] std::vector<LabelFinding> findings() const {
    auto found = checkLabels(check());
    if (!found) FAIL(found.error().message);
    return *found;
  }
};

const LabelFinding *findOf(const std::vector<LabelFinding> &all, Kind kind) {
  for (const LabelFinding &one : all)
    if (one.kind == kind) return &one;
  return nullptr;
}

}  // namespace

TEST_CASE("A scan whose labels fit its image has nothing to be said of it", "[label_checks]") {
  const Scan scan;
  for (const LabelFinding &finding : scan.findings()) {
    INFO(finding.text);
    CHECK(false);
  }
}

TEST_CASE("A label map that ends within the image is reported with its share and where it ends", "[label_checks]") {
  const Scan part(220, 45, 11);
  const auto findings = part.findings();
  const LabelFinding *coverage = findOf(findings, Kind::coverage);
  REQUIRE(coverage != nullptr);
  CHECK_THAT(coverage->text, Contains("covers 28 % of the image: along z from -2 to 32 mm of -2 to 118 mm"));
  CHECK_THAT(coverage->advice, Contains("whole image") && Contains("region"));
  // Many programs omit a border of a voxel or two: 37 of 40 slices are 92 %, 35 are 88 %.
  CHECK(findOf(Scan(220, 45, 37).findings(), Kind::coverage) == nullptr);
  CHECK(findOf(Scan(220, 45, 35).findings(), Kind::coverage) != nullptr);
  // An explicit region makes the coverage check unnecessary.
  imaging::Mask region{part.labels.geometry, std::vector<std::uint8_t>(part.labels.voxels.size(), 1)};
  LabelCheck check = part.check();
  check.region = &region;
  const auto within = checkLabels(check);
  REQUIRE(within);
  CHECK(findOf(*within, Kind::coverage) == nullptr);
}

TEST_CASE("A coarser map that is turned covers the image as well", "[label_checks]") {
  Scan scan;
  imaging::LabelMap turned;
  turned.geometry = {{20, 20, 20}, {-6, 0, 0, 0, 0, 0, 6, 0, 0, 6, 0, 0, 115.5, 1.5, 1.5, 1}};
  turned.voxels.assign(8000, 0);
  turned.voxels[5] = 1;
  turned.labels = {{1, "liver", {}}};
  scan.labels = turned;
  scan.roles = {LabelRole::soft};
  CHECK(findOf(scan.findings(), Kind::coverage) == nullptr);
  scan.labels.geometry.indexToWorld[13] += 30.0;
  CHECK(findOf(scan.findings(), Kind::coverage) != nullptr);
}

TEST_CASE("Rigid labels whose grey values are no bone are named with their median", "[label_checks]") {
  for (const auto &[median, isBone] : {std::pair{-90, false}, {40, false}, {90, false}, {110, true}, {250, true}}) {
    CAPTURE(median);
    const auto findings = Scan(static_cast<std::int16_t>(median)).findings();
    const LabelFinding *rigid = findOf(findings, Kind::rigid);
    CHECK((rigid == nullptr) == isBone);
    if (rigid == nullptr) continue;
    CHECK_THAT(rigid->text, Contains("1 of 1 rigid labels has grey values below those of bone") &&
                                Contains("vertebrae_L1 (" + std::to_string(median + 5)));  // the middle of its 10 HU
    CHECK_THAT(rigid->advice, Contains("numbers and names") && Contains("material"));
  }
  // The cortex around fatty marrow makes a bone: a fifth of it is above 200 HU.
  Scan fatty(60);
  Scan::each([&](std::size_t i, std::size_t, std::size_t, std::size_t v) {
    if (fatty.labels.voxels[v] == 2 && (i == 18 || i == 25)) fatty.value(v) = 350;
  });
  CHECK(findOf(fatty.findings(), Kind::rigid) == nullptr);
  // A label that is no longer rigid is soft tissue.
  Scan soft(40);
  soft.roles[1] = LabelRole::soft;
  CHECK(findOf(soft.findings(), Kind::rigid) == nullptr);
}

TEST_CASE("Contrast agent beside a labelled vessel that the background leaves out is reported with a limit",
          "[label_checks]") {
  Scan scan(220, 500);
  // The label is too narrow by two voxels on each side, and a branch has none.
  Scan::each([&](std::size_t i, std::size_t j, std::size_t k, std::size_t v) {
    if (!isWithin(i, j, k, 20, 17) || scan.labels.voxels[v] != 0) return;
    if (i >= 22 && i < 30 && j >= 8 && j < 16) scan.value(v) = static_cast<std::int16_t>(460 + 5 * (i + j) % 90);
  });
  const auto findings = scan.findings();
  const LabelFinding *contrast = findOf(findings, Kind::contrast);
  REQUIRE(contrast != nullptr);
  CHECK_THAT(contrast->text,
             Contains("contrast agent") && Contains("aorta (50") && Contains("limit of 250 HU") && Contains("holes"));
  REQUIRE(contrast->to);
  CHECK(*contrast->to >= 540.0);
  CHECK(*contrast->to <= 580.0);
  CHECK(findOf(findings, Kind::bone) == nullptr);
  // With that limit nothing is omitted.
  LabelCheck check = scan.check();
  check.background->to = *contrast->to;
  const auto raised = checkLabels(check);
  REQUIRE(raised);
  CHECK(raised->empty());
  // A vessel with a complete label leaves nothing.
  CHECK(findOf(Scan(220, 500).findings(), Kind::contrast) == nullptr);
  // Without contrast agent in a label there is none to follow.
  CHECK(findOf(Scan(220, 150).findings(), Kind::contrast) == nullptr);
}

TEST_CASE("Bone without a label is reported as holes and as background", "[label_checks]") {
  Scan scan;
  const auto add = [&](std::int16_t hu, std::size_t from, std::size_t size) {
    Scan::each([&](std::size_t i, std::size_t j, std::size_t k, std::size_t v) {
      if (i >= from && i < from + size && j >= 26 && j < 26 + size && k >= 10 && k < 10 + size) scan.value(v) = hu;
    });
  };
  add(200, 5, 8);  // spongy: 8³ voxels of 27 mm³
  auto findings = scan.findings();
  const LabelFinding *bone = findOf(findings, Kind::bone);
  REQUIRE(bone != nullptr);
  CHECK_THAT(bone->text, Contains("13.8 ml without a label look like bone") && Contains("13.8 ml would be fat") &&
                             !Contains("holes"));
  CHECK_THAT(bone->advice, Contains("threshold = [150, 3000], rigid = true"));
  CHECK_FALSE(bone->to);
  add(900, 29, 5);  // cortical: 3.4 ml
  findings = scan.findings();
  bone = findOf(findings, Kind::bone);
  REQUIRE(bone != nullptr);
  CHECK_THAT(bone->text, Contains("13.8 ml would be fat, 3.3") && Contains(" ml would be holes"));
  CHECK_FALSE(bone->to);
  // A vessel full of contrast agent without a label.
  add(480, 29, 5);
  findings = scan.findings();
  bone = findOf(findings, Kind::bone);
  REQUIRE(bone != nullptr);
  CHECK_THAT(bone->text, Contains("bone or contrast agent"));
  CHECK_THAT(bone->advice, Contains("let the background reach to 500 HU"));
  CHECK(bone->to == 500.0);
  // 140 HU is enhanced soft tissue; a layer of one voxel around a labelled bone is partial volume; 1.7 ml are a calcification.
  Scan less;
  Scan::each([&](std::size_t i, std::size_t j, std::size_t k, std::size_t v) {
    if (!isWithin(i, j, k, 20, 17) || less.labels.voxels[v] != 0) return;
    if (i >= 17 && i < 27 && j >= 23 && j < 33) less.value(v) = 180;
    if (i >= 5 && i < 13 && j >= 26) less.value(v) = 140;
    if (i >= 30 && i < 34 && j >= 30 && j < 34 && k >= 10 && k < 14) less.value(v) = 300;
  });
  CHECK(findOf(less.findings(), Kind::bone) == nullptr);
}

TEST_CASE("Grey values that are not in HU are not compared", "[label_checks]") {
  // Magnetic resonance: no air at -1000, and no unit.
  Scan scan(40, 500);
  scan.image.unit.clear();
  Scan::each([&](std::size_t, std::size_t, std::size_t, std::size_t v) {
    scan.value(v) = static_cast<std::int16_t>(std::max(0, scan.value(v) + 100));
  });
  CHECK(scan.findings().empty());
  // The position of the grids does not need them.
  Scan part(40, 500, 11);
  part.image = scan.image;
  const auto findings = part.findings();
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].kind == Kind::coverage);
}

TEST_CASE("Without a background nothing is said of what has no label", "[label_checks]") {
  Scan scan;
  Scan::each([&](std::size_t i, std::size_t j, std::size_t, std::size_t v) {
    if (i >= 5 && i < 13 && j >= 26 && j < 34) scan.value(v) = 400;
  });
  CHECK(findOf(scan.findings(), Kind::bone) != nullptr);
  LabelCheck check = scan.check();
  check.background.reset();
  const auto found = checkLabels(check);
  REQUIRE(found);
  CHECK(found->empty());
}
