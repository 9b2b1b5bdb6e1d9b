// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/fixed_region_rule.h"

#include "support/catch.h"

using namespace c3de;
using namespace c3de::session;

namespace {

imaging::Volume volume(const std::string &unit, std::int16_t lowest) {
  imaging::Volume image;
  image.geometry.size = {2, 2, 1};
  image.voxels = std::vector<std::int16_t>{lowest, 0, 40, 1200};
  image.unit = unit;
  return image;
}

imaging::LabelMap labelMap() {
  imaging::LabelMap map;
  map.geometry.size = {2, 2, 1};
  map.voxels = {1, 2, 7, 9};
  map.labels = {{1, "liver", {}}, {2, "rib_left_1", {}}, {7, "rib_right_1", {}}, {9, "vertebrae_L1", {}}};
  return map;
}

scene::MaterialLibrary materials() {
  auto loaded = scene::MaterialLibrary::load(std::filesystem::path(testResourcesFolder()) / "materials.toml");
  if (!loaded) FAIL(loaded.error().message);
  return std::move(*loaded);
}

}  // namespace

TEST_CASE("By itself bone and air of a computed tomography stay, and of other images nothing") {
  const auto ruleOf = [](const imaging::Volume &image) { return fixedRegionRuleOf({}, image, nullptr, {}).value(); };
  imaging::FixedRegionRule rule = ruleOf(volume("HU", 0));
  CHECK(rule.above == 200.0);
  CHECK(rule.below == -400.0);
  // No unit, but the air of a scanner.
  rule = ruleOf(volume("", -1000));
  CHECK(rule.above == 200.0);
  CHECK(rule.below == -400.0);
  CHECK(ruleOf(volume("", -800)).isEmpty());
  CHECK(ruleOf(volume("mm", -1000)).isEmpty());
}

TEST_CASE("By itself labels of what is proposed as rigid stay as well") {
  const imaging::LabelMap labels = labelMap();
  const auto rule = fixedRegionRuleOf({}, volume("", 0), &labels, materials());
  REQUIRE(rule);
  CHECK(rule->labels == std::vector<std::uint16_t>{2, 7, 9});
  CHECK_FALSE(rule->above);
  // Without presets no material is known to be rigid.
  const auto unknown = fixedRegionRuleOf({}, volume("", 0), &labels, {});
  REQUIRE(unknown);
  CHECK(unknown->isEmpty());
}

TEST_CASE("What a person says takes the place of what is automatic") {
  scene::SceneFixedRegions wanted;
  wanted.isAutomatic = false;
  wanted.above = 300.0;
  wanted.labels = {"liver", "9"};
  const imaging::LabelMap labels = labelMap();
  auto rule = fixedRegionRuleOf(wanted, volume("HU", -1000), &labels, materials());
  REQUIRE(rule);
  CHECK(rule->above == 300.0);
  CHECK_FALSE(rule->below);
  CHECK(rule->labels == std::vector<std::uint16_t>{1, 9});

  wanted.outside = true;
  rule = fixedRegionRuleOf(wanted, volume("HU", -1000), &labels, materials());
  REQUIRE(rule);
  CHECK(rule->outside);
  CHECK_FALSE(rule->above);
  CHECK(rule->labels.empty());
}

TEST_CASE("A star in the name of a label stands for any text") {
  const imaging::LabelMap labels = labelMap();
  const auto valuesOf = [&](const std::string &name) {
    scene::SceneFixedRegions wanted;
    wanted.isAutomatic = false;
    wanted.labels = {name};
    return fixedRegionRuleOf(wanted, volume("", 0), &labels, {}).value().labels;
  };
  CHECK(valuesOf("rib_*") == std::vector<std::uint16_t>{2, 7});
  CHECK(valuesOf("*_1") == std::vector<std::uint16_t>{2, 7});
  CHECK(valuesOf("r*b*l*1") == std::vector<std::uint16_t>{2});
  CHECK(valuesOf("liver*") == std::vector<std::uint16_t>{1});
  CHECK(valuesOf("*") == std::vector<std::uint16_t>{1, 2, 7, 9});
}

TEST_CASE("A label that is not there is named with the nearest one and with those there are") {
  scene::SceneFixedRegions wanted;
  wanted.labels = {"livr"};
  imaging::LabelMap labels = labelMap();
  auto rule = fixedRegionRuleOf(wanted, volume("", 0), &labels, {});
  REQUIRE_FALSE(rule);
  CHECK(rule.error().code == ErrorCode::usage);
  CHECK(rule.error().message ==
        "still: there is no label 'livr'; did you mean 'liver'? there are: liver, rib_left_1, "
        "rib_right_1, vertebrae_L1");
  wanted.labels = {"stomach_*"};
  rule = fixedRegionRuleOf(wanted, volume("", 0), &labels, {});
  REQUIRE_FALSE(rule);
  CHECK_THAT(rule.error().message, Contains("'stomach_*'") && !Contains("did you mean"));
  labels.labels.clear();
  CHECK_THAT(fixedRegionRuleOf(wanted, volume("", 0), &labels, {}).error().message, Contains("there are: none"));
  // Without a label map there is no query.
  CHECK(fixedRegionRuleOf(wanted, volume("", 0), nullptr, {}));
}
