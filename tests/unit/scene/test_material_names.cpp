// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/material_names.h"

#include <string>
#include <utility>
#include <vector>

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
                            "label 7", "", "ship", "iliac_vena_left"}) {
    CAPTURE(organ);
    CHECK(presetForOrgan(materials, organ) == nullptr);
  }
  CHECK(presetForOrgan(MaterialLibrary(), "liver") == nullptr);
}

TEST_CASE("Every class of TotalSegmentator has a preset of its tissue, or none where none is known",
          "[material_names]") {
  const MaterialLibrary materials = shipped();
  const auto both = [](std::vector<std::string> names, const std::string &organ) {
    names.push_back(organ + "_left");
    names.push_back(organ + "_right");
    return names;
  };
  std::vector<std::string> bones{"sacrum", "skull", "sternum"}, muscles, arteries{"aorta", "brachiocephalic_trunk"};
  std::vector<std::string> without{"esophagus",
                                   "trachea",
                                   "small_bowel",
                                   "duodenum",
                                   "colon",
                                   "urinary_bladder",
                                   "pulmonary_vein",
                                   "pulmonary_artery",
                                   "superior_vena_cava",
                                   "inferior_vena_cava",
                                   "portal_vein_and_splenic_vein",
                                   "spinal_cord",
                                   "face"};
  for (const char *bone : {"humerus", "scapula", "clavicula", "femur", "hip"}) bones = both(bones, bone);
  for (int n = 1; n <= 12; ++n)
    bones.push_back("rib_left_" + std::to_string(n)), bones.push_back("rib_right_" + std::to_string(n));
  for (const auto &[letter, count] : {std::pair{"C", 7}, {"T", 12}, {"L", 5}, {"S", 1}})
    for (int n = 1; n <= count; ++n) {
      bones.push_back(std::string("vertebrae_") + letter + std::to_string(n));
      bones.push_back(std::string("vertebra ") + letter + std::to_string(n));
    }
  for (const char *muscle : {"gluteus_maximus", "gluteus_medius", "gluteus_minimus", "autochthon", "iliopsoas"})
    muscles = both(muscles, muscle);
  for (const char *artery : {"subclavian_artery", "common_carotid_artery", "iliac_artery"})
    arteries = both(arteries, artery);
  for (const char *other : {"adrenal_gland", "kidney_cyst", "brachiocephalic_vein", "iliac_vena"})
    without = both(without, other);
  const std::vector<std::pair<std::string, std::vector<std::string>>> expected{
      {"bone_cortical", bones},
      {"muscle_skeletal_rest", muscles},
      {"aorta", arteries},
      {"", without},
      {"spleen", {"spleen"}},
      {"kidney_cortex", {"kidney_left", "kidney_right"}},
      {"gallbladder", {"gallbladder"}},
      {"liver", {"liver"}},
      {"stomach", {"stomach"}},
      {"pancreas", {"pancreas"}},
      {"lung_inflated",
       {"lung_upper_lobe_left", "lung_lower_lobe_left", "lung_upper_lobe_right", "lung_middle_lobe_right",
        "lung_lower_lobe_right"}},
      {"thyroid", {"thyroid_gland"}},
      {"prostate", {"prostate"}},
      {"heart_passive",
       {"heart", "heart_myocardium", "heart_atrium_left", "heart_ventricle_left", "heart_atrium_right",
        "heart_ventricle_right", "atrial_appendage_left"}},
      {"brain_grey", {"brain"}},
      {"cartilage", {"costal_cartilages"}}};
  std::size_t classes = 0;
  for (const auto &[preset, organs] : expected)
    for (const std::string &organ : organs) {
      CAPTURE(organ);
      CHECK(presetOf(materials, organ.c_str()) == preset);
      ++classes;
    }
  CHECK(classes >= 117 + 25);  // vertebrae under two names
}
