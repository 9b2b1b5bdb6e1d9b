// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/material_names.h"

#include <string>
#include <utility>
#include <vector>

#include "support/catch.h"

using namespace c3de;
using namespace c3de::scene;
using Catch::Matchers::Contains;

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
  for (const char *organ : {"spleen lesion", "lung_nodule", "pancreatic cyst", "hip_implant", "kidney stone", "label 7",
                            "7", "", "ship", "Left-undetermined", "hair", "face"}) {
    CAPTURE(organ);
    CHECK_FALSE(tissueOf(materials, organ));
    CHECK(presetForOrgan(materials, organ) == nullptr);
  }
  CHECK_FALSE(tissueOf(MaterialLibrary(), "liver"));
}

TEST_CASE("Names of two known words are what they say together", "[material_names]") {
  const MaterialLibrary materials = shipped();
  for (const auto &[label, tissue] :
       std::initializer_list<std::pair<const char *, const char *>>{{"liver tumor", "liver tumour"},
                                                                    {"Liver metastases", "liver tumour"},
                                                                    {"brain_tumour", "brain tumour"},
                                                                    {"kidney_tumor", "tumour"},
                                                                    {"tumour", "tumour"},
                                                                    {"kidney_cyst_left", "kidney cyst"},
                                                                    {"portal_vein_and_splenic_vein", "vein"},
                                                                    {"liver vessels", "vein"},
                                                                    {"renal artery", "artery"},
                                                                    {"PULMONARY VEIN", "vein"},
                                                                    {"heart_ventricle_left", "heart"},
                                                                    {"left ventricle", "heart"},
                                                                    {"lung_trachea_bronchia", "air"},
                                                                    {"kidney cortex", "kidney"},
                                                                    {"adrenal cortex", "adrenal gland"},
                                                                    {"gall bladder", "gallbladder"},
                                                                    {"rib cartilage", "cartilage"}}) {
    CAPTURE(label);
    const auto known = tissueOf(materials, label);
    REQUIRE(known);
    CHECK(known->name == tissue);
  }
}

TEST_CASE("Every class of TotalSegmentator is known, and what has no preset of its own says what it is taken for",
          "[material_names]") {
  const MaterialLibrary materials = shipped();
  const auto both = [](std::vector<std::string> names, const std::string &organ) {
    names.push_back(organ + "_left");
    names.push_back(organ + "_right");
    return names;
  };
  std::vector<std::string> bones{"sacrum", "skull", "sternum"}, muscles,
      veins{"pulmonary_vein", "superior_vena_cava", "inferior_vena_cava", "portal_vein_and_splenic_vein"},
      arteries{"aorta", "brachiocephalic_trunk"};
  for (const char *bone : {"humerus", "scapula", "clavicula", "femur", "hip"}) bones = both(bones, bone);
  for (int n = 1; n <= 12; ++n)
    bones.push_back("rib_left_" + std::to_string(n)), bones.push_back("rib_right_" + std::to_string(n));
  for (const auto &[letter, count] : {std::pair{"C", 7}, {"T", 12}, {"L", 5}, {"S", 1}})
    for (int n = 1; n <= count; ++n) bones.push_back(std::string("vertebrae_") + letter + std::to_string(n));
  for (const char *muscle : {"gluteus_maximus", "gluteus_medius", "gluteus_minimus", "autochthon", "iliopsoas"})
    muscles = both(muscles, muscle);
  for (const char *artery : {"subclavian_artery", "common_carotid_artery", "iliac_artery"})
    arteries = both(arteries, artery);
  for (const char *vein : {"brachiocephalic_vein", "iliac_vena"}) veins = both(veins, vein);
  struct Expected {
    std::string tissue, preset;
    bool isTakenFor;
    std::vector<std::string> labels;
  };
  const std::vector<Expected> expected{
      {"bone", "bone_cortical", false, bones},
      {"muscle", "muscle_skeletal_rest", false, muscles},
      {"artery", "aorta", false, arteries},
      {"vein", "muscle_skeletal_rest", true, veins},
      {"air", "", true, {"trachea"}},
      {"spleen", "spleen", false, {"spleen"}},
      {"kidney", "kidney_cortex", false, {"kidney_left", "kidney_right"}},
      {"kidney cyst", "kidney_cortex", true, {"kidney_cyst_left", "kidney_cyst_right"}},
      {"gallbladder", "gallbladder", false, {"gallbladder"}},
      {"liver", "liver", false, {"liver"}},
      {"stomach", "stomach", false, {"stomach"}},
      {"oesophagus", "stomach", true, {"esophagus"}},
      {"bowel", "stomach", true, {"small_bowel", "duodenum", "colon"}},
      {"urinary bladder", "stomach", true, {"urinary_bladder"}},
      {"pancreas", "pancreas", false, {"pancreas"}},
      {"adrenal gland", "pancreas", true, {"adrenal_gland_left", "adrenal_gland_right"}},
      {"lung",
       "lung_inflated",
       false,
       {"lung_upper_lobe_left", "lung_lower_lobe_left", "lung_upper_lobe_right", "lung_middle_lobe_right",
        "lung_lower_lobe_right"}},
      {"thyroid", "thyroid", false, {"thyroid_gland"}},
      {"prostate", "prostate", false, {"prostate"}},
      {"heart", "heart_passive", false, {"heart", "atrial_appendage_left"}},
      {"brain", "brain_grey", true, {"brain"}},
      {"spinal cord", "brain_white", true, {"spinal_cord"}},
      {"cartilage", "cartilage", false, {"costal_cartilages"}}};
  std::size_t classes = 0;
  for (const Expected &one : expected)
    for (const std::string &label : one.labels) {
      CAPTURE(label);
      ++classes;
      const auto known = tissueOf(materials, label);
      REQUIRE(known);
      CHECK(known->name == one.tissue);
      CHECK(presetOf(materials, label.c_str()) == one.preset);
      CHECK(known->isRigid() == (one.tissue == "bone"));
      CHECK(known->isEmpty() == one.preset.empty());
      CHECK(known->remark.empty() != one.isTakenFor);
    }
  CHECK(classes == 117);
}

TEST_CASE("Names of brain parcellations are grey and white matter and fluid", "[material_names]") {
  const MaterialLibrary materials = shipped();
  const std::vector<std::pair<std::string, std::vector<const char *>>> expected{
      {"white matter",
       {"Left-Cerebral-White-Matter", "Right-Cerebellum-White-Matter", "WM-hypointensities", "Optic-Chiasm",
        "CC_Mid_Posterior", "left cerebral white matter", "wm", "WM", "wm-lh-superiorfrontal", "white matter"}},
      {"grey matter",
       {"Left-Cerebral-Cortex", "Left-Thalamus-Proper", "Left-Thalamus", "Left-Caudate", "Left-Putamen",
        "Left-Pallidum", "Left-Hippocampus", "Left-Amygdala", "Left-Accumbens-area", "Left-VentralDC",
        "left ventral DC", "Left-Cerebellum-Cortex", "right cerebellum cortex", "ctx-lh-bankssts", "gm", "GM",
        "gray matter"}},
      {"cerebrospinal fluid",
       {"Left-Lateral-Ventricle", "Left-Inf-Lat-Vent", "left inferior lateral ventricle", "3rd-Ventricle",
        "4th ventricle", "5th-Ventricle", "CSF", "csf", "ventricles"}},
      {"brain stem", {"Brain-Stem", "brain-stem", "brainstem"}},
      {"choroid plexus", {"Left-choroid-plexus"}},
      {"vein", {"Left-vessel"}}};
  for (const auto &[tissue, labels] : expected)
    for (const char *label : labels) {
      CAPTURE(label);
      const auto known = tissueOf(materials, label);
      REQUIRE(known);
      CHECK(known->name == tissue);
      CHECK_FALSE(known->isRigid());
      CHECK_FALSE(known->isEmpty());
    }
}

TEST_CASE("A name that is not known is told with the nearest that is", "[material_names]") {
  CHECK_THAT(unknownTissue("Left kidny"), Contains("'Left kidny'") && Contains("did you mean 'kidney'?"));
  CHECK_THAT(unknownTissue("galbladder"), Contains("did you mean 'gallbladder'?"));
  CHECK_THAT(unknownTissue("label 7"), !Contains("did you mean") && Contains("accepted: a name such as liver"));
}
