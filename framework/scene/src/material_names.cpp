// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/material_names.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "c3de/core/text.h"

namespace c3de::scene {
namespace {

struct Tissue {
  std::string_view name, preset, remark{};
};

constexpr Tissue kLiver{"liver", "liver"}, kLiverTumour{"liver tumour", "liver_hcc"},
    kDiseasedLiver{"diseased liver", "liver_diseased"}, kProstate{"prostate", "prostate"},
    kProstateCancer{"prostate cancer", "prostate_cancer"}, kBreast{"breast", "breast_gland"},
    kBreastCancer{"breast cancer", "breast_idc_high"}, kKidney{"kidney", "kidney_cortex"}, kSpleen{"spleen", "spleen"},
    kPancreas{"pancreas", "pancreas"}, kThyroid{"thyroid", "thyroid"}, kStomach{"stomach", "stomach"},
    kGallbladder{"gallbladder", "gallbladder"}, kBileDuct{"bile duct", "bile_duct"},
    kHepaticArtery{"hepatic artery", "hepatic_artery"}, kArtery{"artery", "aorta"}, kHeart{"heart", "heart_passive"},
    kLung{"lung", "lung_inflated"}, kMuscle{"muscle", "muscle_skeletal_rest"}, kSkin{"skin", "skin"},
    kFat{"fat", "fat"}, kCartilage{"cartilage", "cartilage"}, kBone{"bone", "bone_cortical"},
    kGreyMatter{"grey matter", "brain_grey"}, kWhiteMatter{"white matter", "brain_white"};
// No preset of their own: the nearest one, and why.
constexpr Tissue kTumour{"tumour", "breast_idc_high", "taken for breast cancer: an order of magnitude"},
    kBrainTumour{"brain tumour", "brain_white", "taken for white matter"},
    kKidneyCyst{"kidney cyst", "kidney_cortex", "water under tension, taken for the kidney around it"},
    kVein{"vein", "muscle_skeletal_rest", "wall and blood together, taken for muscle at rest"},
    kBowel{"bowel", "stomach", "taken for the stomach; what fills it is not in it"},
    kOesophagus{"oesophagus", "stomach", "taken for the stomach"},
    kBladder{"urinary bladder", "stomach", "taken for the stomach; what fills it is not in it"},
    kAdrenalGland{"adrenal gland", "pancreas", "taken for the pancreas, a gland too"},
    kDisc{"intervertebral disc", "cartilage", "taken for cartilage"},
    kBrain{"brain", "brain_grey", "all of it taken for grey matter"},
    kBrainStem{"brain stem", "brain_white", "taken for white matter"},
    kSpinalCord{"spinal cord", "brain_white", "taken for white matter"},
    kChoroidPlexus{"choroid plexus", "brain_grey", "taken for grey matter"},
    kFluid{"cerebrospinal fluid", "brain_grey", "no solid: taken for grey matter, the softest there is"};
// Labels of airways show what fills them. Their wall, thinner than most voxels, is where the image shows tissue.
constexpr Tissue kAir{"air", "", "no tissue: the wall is what an image shows there"};

/// All words of a row must occur; the first row that fits and whose preset exists is taken.
struct Row {
  std::array<std::string_view, 2> words;
  const Tissue &tissue;
};

constexpr Row kRows[] = {
    // What is in organs or beside them, before the organs.
    {{"hcc", ""}, kLiverTumour},
    {{"hepatocellular", "tumour"}, kLiverTumour},
    {{"liver", "tumour"}, kLiverTumour},
    {{"hepatic", "tumour"}, kLiverTumour},
    {{"prostate", "tumour"}, kProstateCancer},
    {{"breast", "tumour"}, kBreastCancer},
    {{"brain", "tumour"}, kBrainTumour},
    {{"glioma", ""}, kBrainTumour},
    {{"glioblastoma", ""}, kBrainTumour},
    {{"tumour", ""}, kTumour},
    {{"kidney", "cyst"}, kKidneyCyst},
    {{"renal", "cyst"}, kKidneyCyst},
    {{"bile", "duct"}, kBileDuct},
    {{"hepatic", "artery"}, kHepaticArtery},
    {{"artery", ""}, kArtery},
    {{"aorta", ""}, kArtery},
    {{"brachiocephalic", "trunk"}, kArtery},
    {{"coeliac", "trunk"}, kArtery},
    {{"celiac", "trunk"}, kArtery},
    {{"pulmonary", "trunk"}, kArtery},
    {{"vein", ""}, kVein},
    {{"vena", ""}, kVein},
    {{"ivc", ""}, kVein},
    {{"svc", ""}, kVein},
    {{"venous", "sinus"}, kVein},
    {{"venous", "sinuse"}, kVein},
    {{"vessel", ""}, kVein},
    {{"optic", "nerve"}, kWhiteMatter},
    {{"cerebrospinal", "fluid"}, kFluid},
    {{"csf", ""}, kFluid},
    {{"subarachnoid", "space"}, kFluid},
    {{"trachea", ""}, kAir},
    {{"bronchus", ""}, kAir},
    {{"bronchi", ""}, kAir},
    {{"bronchia", ""}, kAir},
    {{"airway", ""}, kAir},
    {{"air", ""}, kAir},
    // Trunk.
    {{"liver", "cirrhosis"}, kDiseasedLiver},
    {{"liver", "fibrosis"}, kDiseasedLiver},
    {{"liver", "diseased"}, kDiseasedLiver},
    {{"gallbladder", ""}, kGallbladder},
    {{"gall", "bladder"}, kGallbladder},
    {{"liver", ""}, kLiver},
    {{"adrenal", ""}, kAdrenalGland},
    {{"suprarenal", ""}, kAdrenalGland},
    {{"kidney", ""}, kKidney},
    {{"renal", ""}, kKidney},
    {{"spleen", ""}, kSpleen},
    {{"pancreas", ""}, kPancreas},
    {{"heart", ""}, kHeart},
    {{"myocardium", ""}, kHeart},
    {{"atrium", ""}, kHeart},
    {{"atrial", "appendage"}, kHeart},
    {{"lung", ""}, kLung},
    {{"stomach", ""}, kStomach},
    {{"oesophagus", ""}, kOesophagus},
    {{"esophagus", ""}, kOesophagus},
    {{"bowel", ""}, kBowel},
    {{"intestine", ""}, kBowel},
    {{"duodenum", ""}, kBowel},
    {{"jejunum", ""}, kBowel},
    {{"ileum", ""}, kBowel},
    {{"colon", ""}, kBowel},
    {{"caecum", ""}, kBowel},
    {{"cecum", ""}, kBowel},
    {{"sigmoid", ""}, kBowel},
    {{"rectum", ""}, kBowel},
    {{"bladder", ""}, kBladder},
    {{"thyroid", ""}, kThyroid},
    {{"prostate", ""}, kProstate},
    {{"breast", ""}, kBreast},
    // Brain.
    {{"spinal", "cord"}, kSpinalCord},
    {{"choroid", "plexus"}, kChoroidPlexus},
    {{"white", "matter"}, kWhiteMatter},
    {{"wm", ""}, kWhiteMatter},
    {{"corpus", "callosum"}, kWhiteMatter},
    {{"cc", ""}, kWhiteMatter},
    {{"fornix", ""}, kWhiteMatter},
    {{"internal", "capsule"}, kWhiteMatter},
    {{"septum", "pellucidum"}, kWhiteMatter},
    {{"optic", "chiasm"}, kWhiteMatter},
    {{"optic", "tract"}, kWhiteMatter},
    {{"grey", "matter"}, kGreyMatter},
    {{"gm", ""}, kGreyMatter},
    {{"ctx", ""}, kGreyMatter},
    {{"cortex", ""}, kGreyMatter},
    {{"cerebellum", ""}, kGreyMatter},
    {{"hippocampus", ""}, kGreyMatter},
    {{"amygdala", ""}, kGreyMatter},
    {{"thalamus", ""}, kGreyMatter},
    {{"caudate", ""}, kGreyMatter},
    {{"putamen", ""}, kGreyMatter},
    {{"pallidum", ""}, kGreyMatter},
    {{"accumbens", ""}, kGreyMatter},
    {{"lentiform", ""}, kGreyMatter},
    {{"basal", "ganglia"}, kGreyMatter},
    {{"ventraldc", ""}, kGreyMatter},
    {{"ventral", "dc"}, kGreyMatter},
    {{"frontal", "lobe"}, kGreyMatter},
    {{"parietal", "lobe"}, kGreyMatter},
    {{"temporal", "lobe"}, kGreyMatter},
    {{"occipital", "lobe"}, kGreyMatter},
    {{"brain", "stem"}, kBrainStem},
    {{"brainstem", ""}, kBrainStem},
    {{"midbrain", ""}, kBrainStem},
    {{"pons", ""}, kBrainStem},
    {{"lateral", "ventricle"}, kFluid},
    {{"lat", "vent"}, kFluid},
    {{"left", "ventricle"}, kHeart},
    {{"right", "ventricle"}, kHeart},
    {{"ventricle", ""}, kFluid},
    {{"brain", ""}, kBrain},
    {{"cerebrum", ""}, kBrain},
    // What there is everywhere.
    {{"intervertebral", "disc"}, kDisc},
    {{"cartilage", ""}, kCartilage},
    {{"muscle", ""}, kMuscle},
    {{"gluteus", ""}, kMuscle},
    {{"iliopsoas", ""}, kMuscle},
    {{"psoas", ""}, kMuscle},
    {{"autochthon", ""}, kMuscle},
    {{"diaphragm", ""}, kMuscle},
    {{"quadriceps", ""}, kMuscle},
    {{"sartorius", ""}, kMuscle},
    {{"skin", ""}, kSkin},
    {{"fat", ""}, kFat},
    {{"adipose", ""}, kFat},
    {{"bone", ""}, kBone},
    {{"skeleton", ""}, kBone},
    {{"skull", ""}, kBone},
    {{"cranium", ""}, kBone},
    {{"mandible", ""}, kBone},
    {{"tooth", ""}, kBone},
    {{"teeth", ""}, kBone},
    {{"vertebra", ""}, kBone},
    {{"vertebrae", ""}, kBone},
    {{"spine", ""}, kBone},
    {{"rib", ""}, kBone},
    {{"sternum", ""}, kBone},
    {{"sacrum", ""}, kBone},
    {{"pelvis", ""}, kBone},
    {{"hip", ""}, kBone},
    {{"femur", ""}, kBone},
    {{"patella", ""}, kBone},
    {{"tibia", ""}, kBone},
    {{"fibula", ""}, kBone},
    {{"tarsal", ""}, kBone},
    {{"metatarsal", ""}, kBone},
    {{"phalange", ""}, kBone},
    {{"humerus", ""}, kBone},
    {{"radius", ""}, kBone},
    {{"ulna", ""}, kBone},
    {{"carpal", ""}, kBone},
    {{"metacarpal", ""}, kBone},
    {{"scapula", ""}, kBone},
    {{"clavicula", ""}, kBone},
    {{"clavicle", ""}, kBone},
};

/// In a name, these say that it is something in the organ or beside it.
constexpr std::string_view kOthers[] = {"tumour", "lesion", "nodule", "cyst",  "vessel", "vein",  "vena",
                                        "artery", "duct",   "nerve",  "fluid", "csf",    "space", "cavity",
                                        "canal",  "lumen",  "stone",  "stent", "implant"};

/// Words for the same, as they are in the rows.
std::string_view usual(std::string_view word) {
  for (const std::string_view tumour :
       {"tumor", "tumors", "tumours", "cancer", "carcinoma", "metastasis", "metastases", "neoplasm"})
    if (word == tumour) return "tumour";
  return word == "gray" ? std::string_view("grey") : word;
}

/// In lower case, without digits and separators.
std::vector<std::string> wordsOf(std::string_view text) {
  std::vector<std::string> words{""};
  for (const char c : text) {
    const bool isUpper = c >= 'A' && c <= 'Z', isLower = c >= 'a' && c <= 'z';
    if (isUpper || isLower)
      words.back() += isUpper ? static_cast<char>(c - 'A' + 'a') : c;
    else if (!words.back().empty())
      words.emplace_back();
  }
  for (std::string &word : words) word = usual(word);
  return words;
}

bool has(const std::vector<std::string> &words, std::string_view wanted) {
  return std::any_of(words.begin(), words.end(), [&](const std::string &word) {
    return word == wanted || (word.size() == wanted.size() + 1 && word.back() == 's' && word.starts_with(wanted));
  });
}

bool isOther(std::string_view word) {
  return std::find(std::begin(kOthers), std::end(kOthers), word) != std::end(kOthers);
}

}  // namespace

std::optional<NamedTissue> tissueOf(const MaterialLibrary &materials, std::string_view label) {
  if (const MaterialPreset *same = materials.find(label)) {
    for (const Row &row : kRows)
      if (row.tissue.preset == label && row.tissue.remark.empty()) return NamedTissue{row.tissue.name, same};
    return NamedTissue{same->name, same};
  }
  const std::vector<std::string> words = wordsOf(label);
  const bool isOrgan =
      std::none_of(std::begin(kOthers), std::end(kOthers), [&](std::string_view other) { return has(words, other); });
  for (const Row &row : kRows) {
    const bool fits = has(words, row.words[0]) && (row.words[1].empty() || has(words, row.words[1]));
    if (!fits || !(isOrgan || isOther(row.words[0]) || isOther(row.words[1]))) continue;
    const MaterialPreset *preset = materials.find(row.tissue.preset);
    if (preset != nullptr || row.tissue.preset.empty()) return NamedTissue{row.tissue.name, preset, row.tissue.remark};
  }
  return std::nullopt;
}

const MaterialPreset *presetForOrgan(const MaterialLibrary &materials, std::string_view organ) {
  const auto tissue = tissueOf(materials, organ);
  return tissue ? tissue->preset : nullptr;
}

std::string unknownTissue(std::string_view label) {
  std::vector<std::string> known;
  for (const Row &row : kRows)
    known.push_back(std::string(row.words[0]) + (row.words[1].empty() ? "" : " ") + std::string(row.words[1]));
  std::string name;
  for (const std::string &word : wordsOf(label))
    if (!word.empty() && word != "left" && word != "right") name += (name.empty() ? "" : " ") + word;
  const std::string nearest = nearestName(name, known);
  return "no tissue is known by the name '" + std::string(label) + "'; " +
         (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
         "accepted: a name such as liver, kidney_left, vertebrae_L1, white matter, or beside it a material = \"…\", or "
         "rigid = true";
}

}  // namespace c3de::scene
