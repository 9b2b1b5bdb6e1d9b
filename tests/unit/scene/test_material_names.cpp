// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/material_names.h"

#include <string>
#include <utility>

#include "support/catch.h"

using namespace c3de;
using namespace c3de::scene;

namespace {

MaterialLibrary shipped() {
  auto loaded = MaterialLibrary::load(std::filesystem::path(testResourcesFolder()) / "materials.toml");
  if (!loaded) FAIL(loaded.error().message);
  return std::move(*loaded);
}

std::string presetOf(const MaterialLibrary &materials, const char *organ) {
  const MaterialPreset *preset = presetForOrgan(materials, organ);
  return preset ? preset->name : "";
}

}  // namespace

TEST_CASE("Organs of label maps get the preset of their tissue", "[material_names]") {
  const MaterialLibrary materials = shipped();
  for (const auto &[organ, preset] :
       std::initializer_list<std::pair<const char *, const char *>>{{"liver", "liver"},
                                                                    {"Liver", "liver"},
                                                                    {"kidney_left", "kidney_cortex"},
                                                                    {"Right Kidney", "kidney_cortex"},
                                                                    {"kidneys", "kidney_cortex"},
                                                                    {"spleen", "spleen"},
                                                                    {"brain", "brain_grey"},
                                                                    {"brain white matter", "brain_white"},
                                                                    {"brain_white", "brain_white"},
                                                                    {"lung_upper_lobe_left", "lung_inflated"},
                                                                    {"vertebrae_L1", "bone_cortical"},
                                                                    {"rib_left_7", "bone_cortical"},
                                                                    {"gallbladder", "gallbladder"},
                                                                    {"liver_tumour", "liver_hcc"},
                                                                    {"hepatic artery", "hepatic_artery"},
                                                                    {"gluteus_maximus_left", "muscle_skeletal_rest"},
                                                                    {"heart_atrium_left", "heart_passive"},
                                                                    {"common bile duct", "bile_duct"}}) {
    CAPTURE(organ);
    CHECK(presetOf(materials, organ) == preset);
  }
}

TEST_CASE("What is no organ of its own does not get the organ's tissue", "[material_names]") {
  const MaterialLibrary materials = shipped();
  for (const char *organ : {"kidney_cyst_left", "liver vessels", "pulmonary_vein", "spleen lesion", "urinary_bladder",
                            "label 7", "", "ship", "aorta"}) {
    CAPTURE(organ);
    CHECK(presetForOrgan(materials, organ) == nullptr);
  }
  CHECK(presetForOrgan(MaterialLibrary(), "liver") == nullptr);
}
