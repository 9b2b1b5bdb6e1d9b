// SPDX-License-Identifier: Apache-2.0
#include "logic/tissue_choice.h"

#include <algorithm>
#include <filesystem>

#include "c3de/abi/iface/parameter_ids.h"
#include "support/catch.h"
#include "support/folders.h"

using namespace c3de;
using namespace c3de::ui;

namespace {

struct Fixture {
  scene::MaterialLibrary materials;
  registry::ParameterRegistry registry;
  Handle body;

  explicit Fixture(std::vector<const char *> ids) {
    auto read = scene::MaterialLibrary::load(std::filesystem::path(testResourcesFolder()) / "materials.toml");
    REQUIRE(read);
    materials = std::move(*read);
    registry::ParameterSet set;
    for (const char *id : ids) {
      ParameterDecl decl;
      decl.id = id;
      decl.max = 1e12;
      decl.fallback = 1.0;
      set.decls.push_back(decl);
    }
    body = registry.declare(std::move(set));
  }
  const registry::ParameterSet &set() { return *registry.find(body); }
  std::string chosen() {
    const TissueChoice choice = tissueChoiceOf(set(), materials);
    return choice.names.at(choice.index);
  }
  void choose(const char *name) { REQUIRE(registry.edit(body, "Tissue", tissueValues(set(), *materials.find(name)))); }
  double value(const char *id) {
    for (const ParameterValue &value : set().values)
      if (value.id == id) return value.num;
    return -1.0;
  }
};

const std::vector<const char *> kMaterial{C3DE_PARAM_ID_DENSITY, C3DE_PARAM_ID_YOUNGS_MODULUS,
                                          C3DE_PARAM_ID_YOUNGS_MODULUS_LOW, C3DE_PARAM_ID_YOUNGS_MODULUS_HIGH,
                                          C3DE_PARAM_ID_POISSON_RATIO};

}  // namespace

TEST_CASE("a tissue sets its values in one step of undo, and is recognised by them") {
  Fixture f(kMaterial);
  CHECK(f.chosen() == "custom");
  for (const scene::MaterialPreset &preset : f.materials.presets()) {
    f.choose(preset.name.c_str());
    CHECK(f.value(C3DE_PARAM_ID_YOUNGS_MODULUS) == preset.youngsModulus);
    CHECK(f.value(C3DE_PARAM_ID_YOUNGS_MODULUS_LOW) == preset.youngsModulusMin);
    CHECK(f.value(C3DE_PARAM_ID_DENSITY) == preset.density);
    CHECK(f.value(C3DE_PARAM_ID_POISSON_RATIO) == preset.poissonRatio);
  }
  f.choose("liver");
  CHECK(f.chosen() == "liver");
  const std::string tooltip = tissueChoiceOf(f.set(), f.materials).tooltip;
  CHECK(tooltip.find("1 … 15 kPa") != std::string::npos);
  CHECK(tooltip.find(f.materials.find("liver")->evidence) != std::string::npos);
}

TEST_CASE("a tissue is undone and redone with all of its values") {
  Fixture f(kMaterial);
  f.choose("liver");
  f.choose("spleen");
  CHECK(f.registry.history().undoLabel() == "Tissue");
  f.registry.history().undo(f.registry);
  CHECK(f.chosen() == "liver");
  f.registry.history().undo(f.registry);
  for (const char *id : kMaterial) CHECK(f.value(id) == 1.0);
  CHECK_FALSE(f.registry.history().canUndo());
  f.registry.history().redo(f.registry);
  CHECK(f.chosen() == "liver");
  f.registry.history().redo(f.registry);
  CHECK(f.chosen() == "spleen");
  CHECK_FALSE(f.registry.history().canRedo());
}

TEST_CASE("after another stiffness the body has values of its own") {
  Fixture f(kMaterial);
  f.choose("liver");
  ParameterValue stiffer;
  stiffer.id = C3DE_PARAM_ID_YOUNGS_MODULUS;
  stiffer.num = 8000.0;
  REQUIRE(f.registry.edit(f.body, stiffer));
  CHECK(f.chosen() == "custom");
  f.registry.history().undo(f.registry);
  CHECK(f.chosen() == "liver");
}

TEST_CASE("a simulator with a part of the values receives those that it has") {
  Fixture f({C3DE_PARAM_ID_YOUNGS_MODULUS});
  f.choose("liver");
  CHECK(f.value(C3DE_PARAM_ID_YOUNGS_MODULUS) == 6000.0);
}
