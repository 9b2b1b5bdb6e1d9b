// SPDX-License-Identifier: Apache-2.0
#include "scene_text.h"

using namespace c3de;

namespace {

std::string loadError(const std::string &text) {
  const std::filesystem::path file = sceneFolder() / "materials-test.toml";
  std::ofstream(file) << text;
  const auto library = scene::MaterialLibrary::load(file);
  return library ? std::string() : library.error().message;
}

const std::string kGood = R"(density = 1000.0
youngs_modulus = 1e4
youngs_modulus_range = [1e3, 1e5]
poisson_ratio = 0.4
poisson_ratio_range = [0.3, 0.49]
)";

}  // namespace

TEST_CASE("The presets that come with the program are plausible and say their sources") {
  REQUIRE(presets().presets().size() >= 20);
  for (const scene::MaterialPreset &preset : presets().presets()) {
    INFO(preset.name);
    CHECK(preset.density > 100.0);
    CHECK(preset.density < 3000.0);
    CHECK(preset.youngsModulus >= preset.youngsModulusMin);
    CHECK(preset.youngsModulus <= preset.youngsModulusMax);
    CHECK_FALSE(preset.source.empty());
    CHECK_FALSE(preset.evidence.empty());
  }
  REQUIRE(presets().find("liver") != nullptr);
  CHECK(presets().find("liver")->youngsModulus == 6000.0);
  CHECK(presets().find("unobtainium") == nullptr);
}

TEST_CASE("A broken file of presets is refused with file and line") {
  CHECK(loadError("[a]\n" + kGood).empty());
  CHECK_THAT(loadError("[a]\ndensty = 1\n" + kGood),
             Contains("materials-test.toml:2: a: ") && Contains("did you mean 'density'?"));
  CHECK_THAT(loadError("[a]\ndensity = 1\n"), Contains(":1: a: needed are"));
  CHECK_THAT(loadError("a = 1\n"), Contains(":1: a: 'a' is a whole number"));
  CHECK_THAT(loadError("[a]\ndensity = 1\nyoungs_modulus = 5\nyoungs_modulus_range = [6, 7]\npoisson_ratio = 0.3\n"
                       "poisson_ratio_range = [0, 0.4]\n"),
             Contains("within its range"));
  CHECK_THAT(loadError("[a]\ndensity = 1\nyoungs_modulus = 5\nyoungs_modulus_range = [5, 7]\npoisson_ratio = 0.5\n"
                       "poisson_ratio_range = [0, 0.5]\n"),
             Contains("below 0.5"));
}
