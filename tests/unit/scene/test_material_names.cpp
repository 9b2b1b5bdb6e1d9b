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

TEST_CASE("Sides, numbers, suffixes and spellings do not hide a tissue", "[material_names]") {
  const MaterialLibrary materials = shipped();
  const std::vector<std::pair<std::string, std::vector<const char *>>> expected{
      {"artery",
       {"aorta_true_lumen", "aorta_false_lumen", "Aorta_TrueLumen", "aortic_arch", "AortaWall", "aorta_seg_1",
        "left_renal_artery", "coronary_arteries", "A. hepatica sin., Arteria", "aorta_2_mask", "arota",
        "internal_carotid_artery_right", "common_iliac_artery_L", "Aortic aneurysm"}},
      {"vein",
       {"iliac_vena_left", "VenaCavaInferior", "IVC_1", "liver_vessels", "lung_vessels", "portal_vein_wall",
        "Vena cava inferior", "internal_jugular_vein_left", "renal_veins", "postcava", "vein_lumen", "blood vessels",
        "Pfortader", "venous_sinuses"}},
      {"kidney",
       {"LeftKidney", "KidneyLeft", "kidney_l", "kidney-right-seg", "Kidney (L)", "kidneyleft", "right_kidney_2",
        "Niere links", "nieren", "kidney.sin", "Lt_Kidney", "KIDNEYS", "renal cortex left"}},
      {"liver",
       {"liver_segment_1", "liver_segment_8", "LiverSegment4a", "Liver_mask", "leber", "hepar", "liver left lobe",
        "liver-ROI", "CTLiver", "livers", "liver_1", "Leber_Segment"}},
      {"lung",
       {"lung_upper_lobe_left", "LungUpperLobeLeft", "LUNG_LEFT", "lungs", "Lunge rechts", "right lower lobe lung",
        "lung_r", "pulmo dexter", "lung-seg-2", "pulmonary_lobe", "RightLung", "leftlung"}},
      {"heart",
       {"heart_myocardium", "heart_atrium_left", "heart_ventricle_right", "HeartAtriumRight", "left ventricle",
        "ventricle_left", "myocardium_seg", "Herz", "atrial_appendage_left", "cardiac chambers", "atria", "heart 1"}},
      {"bone",
       {"rib_left_4",
        "RibLeft4",
        "rib_R_12",
        "vertebrae_L1",
        "VertebraT12",
        "vertebra_body",
        "sacrum",
        "hip_left",
        "femoral_head_L",
        "clavicula_right",
        "zygomatic_arch_left",
        "hyoid",
        "lower_jawbone",
        "teeth_upper",
        "phalanges_hand",
        "metatarsal",
        "scapulae",
        "Rippe 4 links",
        "Schädel",
        "Wirbelkörper_L3",
        "Knochen"}},
      {"gallbladder",
       {"gallbladder", "GallBladder", "gall-bladder", "Gallenblase", "vesica fellea", "gallbladder_wall",
        "gallbladders", "gall_bladder_1", "GALLBLADDER seg", "Vesica biliaris"}},
      {"urinary bladder",
       {"urinary_bladder", "UrinaryBladder", "bladder", "bladder_wall", "Harnblase", "Blase", "Vesica urinaria",
        "bladder_mask", "Bladder 2", "bladder-seg"}},
      {"adrenal gland",
       {"adrenal_gland_left", "AdrenalGlandRight", "Nebenniere rechts", "adrenals", "adrenal_l", "suprarenal gland",
        "Glandula suprarenalis", "left adrenal", "adrenal.seg", "adrenal_gland_1"}},
      {"muscle",
       {"gluteus_maximus_left", "autochthon_right", "iliopsoas_left", "trapezius", "pectoralis_major_left",
        "erector_spinae", "rectus_abdominis", "levator_scapulae", "quadriceps_femoris_left", "sterno_thyroid_left",
        "thigh_medial_compartment", "skeletal_muscle", "hip_muscles", "Muskulatur", "tibialis anterior"}},
      {"cartilage",
       {"costal_cartilages", "thyroid_cartilage", "cricoid_cartilage", "rib cartilage", "CartilageKnee", "Knorpel",
        "femoral_cartilage", "cartilage_1", "tibia cartilage left", "patellar-cartilage"}},
      {"intervertebral disc",
       {"intervertebral_discs", "disc_L4_L5", "vertebral disk", "Bandscheibe", "spine_disc", "IntervertebralDisc",
        "discs", "disk 3", "Bandscheiben", "disc_seg"}},
      {"fat",
       {"subcutaneous_fat", "torso_fat", "intermuscular_fat", "epicardial fat", "heart_fat", "muscle_fat", "Fett",
        "adipose_tissue", "VisceralFat", "perirenal_fat"}},
      {"cerebrospinal fluid",
       {"ventricle_frontal_horn_left", "ventricle_body_right", "ventricle_trigone_left", "third_ventricle",
        "LateralVentricle", "subarachnoid_space", "csf_1", "4thVentricle", "fourth_ventricle",
        "ventricle_temporal_horn_right"}},
      {"air",
       {"trachea_lumen", "larynx_air", "bronchi_left", "LungTracheaBronchia", "bowel_gas", "Luftröhre", "airways",
        "main bronchus right", "airway_1", "air_bubble"}},
      {"spinal cord",
       {"spinal_cord", "SpinalCord", "spinalcord", "Rückenmark", "Rueckenmark", "medulla spinalis", "spinal-cord_seg",
        "Spinal Cord 1", "SPINAL_CORD", "cervical spinal cord"}},
      {"brain stem",
       {"brain_stem", "brainstem", "BrainStem", "Brain-Stem", "Hirnstamm", "midbrain", "pons", "brainstem_1",
        "BRAINSTEM", "brain stem seg"}},
      {"kidney cyst",
       {"kidney_cyst_left", "kidney_cyst_right", "KidneyCyst", "renal cyst 2", "kidney_cysts", "cyst_kidney_left",
        "left kidney cyst", "kidney_left_cyst", "Niere links cyst", "renal_cysts"}},
      {"tumour",
       {"kidney_tumor", "tumour", "lung cancer", "kidney_left_tumor_2", "Metastases", "bile duct carcinoma", "Tumor_1",
        "pancreas tumour", "colon_cancer_primaries", "neoplasm"}},
      {"bone marrow", {"bone_marrow", "vertebra marrow", "BoneMarrow", "Knochenmark"}},
      {"salivary gland", {"parotid_gland_left", "submandibular_gland_right", "SalivaryGland", "parotids"}}};
  for (const auto &[tissue, labels] : expected)
    for (const char *label : labels) {
      CAPTURE(label);
      const auto known = tissueOf(materials, label);
      REQUIRE(known);
      CHECK(known->name == tissue);
    }
}

TEST_CASE("What lies in an organ or was put there is not taken for the organ", "[material_names]") {
  const MaterialLibrary materials = shipped();
  for (const char *label : {"aorta_thrombus",
                            "aorta_false_lumen_thrombosed",
                            "aortic_valve",
                            "aorta_calcification",
                            "aortic stent",
                            "liver_abscess",
                            "cerebral_bleed",
                            "intracerebral_hemorrhage",
                            "pleural_effusion",
                            "pericardial effusion",
                            "hip_prosthesis",
                            "skin_marker",
                            "breast implant",
                            "stomach_contents",
                            "colon content",
                            "bladder_stone",
                            "kidney_stones",
                            "pancreatic_duct",
                            "heart_valve",
                            "lymph_node",
                            "liver ligament",
                            "patellar_tendon",
                            "GTV_liver",
                            "PTV1",
                            "nasal_cavity_left",
                            "auditory_canal_left",
                            "spinal_canal",
                            "lung_nodules",
                            "spleenlet",
                            "bright",
                            "cleft",
                            "sinus_frontal",
                            "head",
                            "body_trunc"}) {
    CAPTURE(label);
    CHECK_FALSE(tissueOf(materials, label));
  }
}

TEST_CASE("A name that is not known is told with the nearest that is", "[material_names]") {
  CHECK_THAT(unknownTissue("Left kidny"), Contains("'Left kidny'") && Contains("did you mean 'kidney'?"));
  CHECK_THAT(unknownTissue("galbladder"), Contains("did you mean 'gallbladder'?"));
  CHECK_THAT(unknownTissue("label 7"), !Contains("did you mean") && Contains("accepted: a name such as liver"));
}
