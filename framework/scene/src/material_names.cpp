// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/material_names.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
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
// Tissues without their own preset: the nearest preset, and why.
constexpr Tissue kTumour{"tumour", "breast_idc_high", "taken for breast cancer: an order of magnitude"},
    kBrainTumour{"brain tumour", "brain_white", "taken for white matter"},
    kKidneyCyst{"kidney cyst", "kidney_cortex", "water under tension, taken for the kidney around it"},
    kVein{"vein", "muscle_skeletal_rest", "wall and blood together, taken for muscle at rest"},
    kBowel{"bowel", "stomach", "taken for the stomach; what fills it is not in it"},
    kOesophagus{"oesophagus", "stomach", "taken for the stomach"},
    kBladder{"urinary bladder", "stomach", "taken for the stomach; what fills it is not in it"},
    kAdrenalGland{"adrenal gland", "pancreas", "taken for the pancreas, a gland too"},
    kDisc{"intervertebral disc", "cartilage", "taken for cartilage"}, kMarrow{"bone marrow", "fat", "taken for fat"},
    kSalivaryGland{"salivary gland", "pancreas", "taken for the pancreas, a gland too"},
    kUterus{"uterus", "muscle_skeletal_rest", "smooth muscle, taken for muscle at rest"},
    kBrain{"brain", "brain_grey", "all of it taken for grey matter"},
    kBrainStem{"brain stem", "brain_white", "taken for white matter"},
    kSpinalCord{"spinal cord", "brain_white", "taken for white matter"},
    kChoroidPlexus{"choroid plexus", "brain_grey", "taken for grey matter"},
    kFluid{"cerebrospinal fluid", "brain_grey", "no solid: taken for grey matter, the softest there is"};
// Airway labels mark the lumen. The wall is thinner than most voxels and is where the image shows tissue.
constexpr Tissue kAir{"air", "", "no tissue: the wall is what an image shows there"};

/// All words of a row must occur, in the form of wordsOf(). The first matching row whose preset exists is used.
struct Row {
  std::array<std::string_view, 2> words;
  const Tissue &tissue;
};

constexpr Row kRows[] = {
    // Structures in or next to organs, before the organs.
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
    {{"artery", "lumen"}, kArtery},
    {{"artery", ""}, kArtery},
    {{"aorta", "lumen"}, kArtery},
    {{"aorta", ""}, kArtery},
    {{"brachiocephalic", "trunk"}, kArtery},
    {{"coeliac", "trunk"}, kArtery},
    {{"celiac", "trunk"}, kArtery},
    {{"brachiocephalicus", "truncus"}, kArtery},
    {{"pulmonary", "trunk"}, kArtery},
    {{"vein", "lumen"}, kVein},
    {{"vena", "lumen"}, kVein},
    {{"vein", ""}, kVein},
    {{"vena", ""}, kVein},
    {{"ivc", ""}, kVein},
    {{"svc", ""}, kVein},
    {{"postcava", ""}, kVein},
    {{"venous", "sinus"}, kVein},
    {{"blood", "vessel"}, kVein},
    {{"vessel", ""}, kVein},
    {{"optic", "nerve"}, kWhiteMatter},
    {{"optic", "disc"}, kWhiteMatter},
    {{"cerebrospinal", "fluid"}, kFluid},
    {{"csf", ""}, kFluid},
    {{"subarachnoid", "space"}, kFluid},
    {{"trachea", "lumen"}, kAir},
    {{"bronchus", "lumen"}, kAir},
    {{"airway", "lumen"}, kAir},
    {{"trachea", ""}, kAir},
    {{"bronchus", ""}, kAir},
    {{"bronchia", ""}, kAir},
    {{"airway", ""}, kAir},
    {{"air", ""}, kAir},
    {{"gas", ""}, kAir},
    // Structures that surround organs and are named after them, before the organs.
    {{"fat", ""}, kFat},
    {{"adipose", ""}, kFat},
    {{"marrow", ""}, kMarrow},
    {{"intervertebral", "disc"}, kDisc},
    {{"disc", ""}, kDisc},
    {{"cartilage", ""}, kCartilage},
    {{"sterno", "thyroid"}, kMuscle},
    // Trunk.
    {{"liver", "cirrhosis"}, kDiseasedLiver},
    {{"liver", "fibrosis"}, kDiseasedLiver},
    {{"liver", "diseased"}, kDiseasedLiver},
    {{"gallbladder", ""}, kGallbladder},
    {{"gall", "bladder"}, kGallbladder},
    {{"vesica", "fellea"}, kGallbladder},
    {{"vesica", "biliaris"}, kGallbladder},
    {{"liver", ""}, kLiver},
    {{"adrenal", ""}, kAdrenalGland},
    {{"suprarenal", ""}, kAdrenalGland},
    {{"kidney", ""}, kKidney},
    {{"renal", ""}, kKidney},
    {{"spleen", ""}, kSpleen},
    {{"pancreas", ""}, kPancreas},
    {{"ventricle", "horn"}, kFluid},
    {{"ventricle", "trigone"}, kFluid},
    {{"ventricle", "body"}, kFluid},
    {{"heart", ""}, kHeart},
    {{"cardiac", ""}, kHeart},
    {{"myocardium", ""}, kHeart},
    {{"atrium", ""}, kHeart},
    {{"atrial", "appendage"}, kHeart},
    {{"lung", ""}, kLung},
    {{"pulmonary", ""}, kLung},
    {{"stomach", ""}, kStomach},
    {{"gastric", ""}, kStomach},
    {{"oesophagus", ""}, kOesophagus},
    {{"esophagus", ""}, kOesophagus},
    {{"bowel", ""}, kBowel},
    {{"intestine", ""}, kBowel},
    {{"duodenum", ""}, kBowel},
    {{"zwoelffingerdarm", ""}, kBowel},
    {{"jejunum", ""}, kBowel},
    {{"ileum", ""}, kBowel},
    {{"colon", ""}, kBowel},
    {{"caecum", ""}, kBowel},
    {{"cecum", ""}, kBowel},
    {{"sigmoid", ""}, kBowel},
    {{"rectum", ""}, kBowel},
    {{"bladder", ""}, kBladder},
    {{"vesica", ""}, kBladder},
    {{"thyroid", ""}, kThyroid},
    {{"parotid", ""}, kSalivaryGland},
    {{"submandibular", ""}, kSalivaryGland},
    {{"salivary", ""}, kSalivaryGland},
    {{"prostate", ""}, kProstate},
    {{"uterus", ""}, kUterus},
    {{"breast", ""}, kBreast},
    // Brain.
    {{"spinal", "cord"}, kSpinalCord},
    {{"spinalcord", ""}, kSpinalCord},
    {{"medulla", "spinalis"}, kSpinalCord},
    {{"rueckenmark", ""}, kSpinalCord},
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
    // Tissues that occur everywhere.
    {{"muscle", ""}, kMuscle},
    {{"gluteus", ""}, kMuscle},
    {{"iliopsoas", ""}, kMuscle},
    {{"psoas", ""}, kMuscle},
    {{"autochthon", ""}, kMuscle},
    {{"diaphragm", ""}, kMuscle},
    {{"quadriceps", ""}, kMuscle},
    {{"sartorius", ""}, kMuscle},
    {{"adductor", ""}, kMuscle},
    {{"biceps", ""}, kMuscle},
    {{"constrictor", ""}, kMuscle},
    {{"coracobrachial", ""}, kMuscle},
    {{"coracobrachialis", ""}, kMuscle},
    {{"deltoid", ""}, kMuscle},
    {{"deltoideus", ""}, kMuscle},
    {{"erector", ""}, kMuscle},
    {{"gastrocnemius", ""}, kMuscle},
    {{"gracilis", ""}, kMuscle},
    {{"hamstring", ""}, kMuscle},
    {{"iliacus", ""}, kMuscle},
    {{"infraspinatus", ""}, kMuscle},
    {{"latissimus", ""}, kMuscle},
    {{"levator", ""}, kMuscle},
    {{"masseter", ""}, kMuscle},
    {{"multifidus", ""}, kMuscle},
    {{"oblique", ""}, kMuscle},
    {{"obturator", ""}, kMuscle},
    {{"pectoralis", ""}, kMuscle},
    {{"piriformis", ""}, kMuscle},
    {{"platysma", ""}, kMuscle},
    {{"prevertebral", ""}, kMuscle},
    {{"pterygoid", ""}, kMuscle},
    {{"quadratus", ""}, kMuscle},
    {{"rectus", ""}, kMuscle},
    {{"scalene", ""}, kMuscle},
    {{"semimembranosus", ""}, kMuscle},
    {{"semitendinosus", ""}, kMuscle},
    {{"serratus", ""}, kMuscle},
    {{"soleus", ""}, kMuscle},
    {{"sternocleidomastoid", ""}, kMuscle},
    {{"subscapularis", ""}, kMuscle},
    {{"supraspinatus", ""}, kMuscle},
    {{"temporalis", ""}, kMuscle},
    {{"tibialis", ""}, kMuscle},
    {{"teres", ""}, kMuscle},
    {{"thyrohyoid", ""}, kMuscle},
    {{"transversospinalis", ""}, kMuscle},
    {{"trapezius", ""}, kMuscle},
    {{"triceps", ""}, kMuscle},
    {{"thigh", "compartment"}, kMuscle},
    {{"skin", ""}, kSkin},
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
    {{"hard", "palate"}, kBone},
    {{"calcaneus", ""}, kBone},
    {{"coccyx", ""}, kBone},
    {{"costa", ""}, kBone},
    {{"femoral", ""}, kBone},
    {{"humeral", ""}, kBone},
    {{"hyoid", ""}, kBone},
    {{"ilium", ""}, kBone},
    {{"ischium", ""}, kBone},
    {{"jaw", ""}, kBone},
    {{"jawbone", ""}, kBone},
    {{"manubrium", ""}, kBone},
    {{"maxilla", ""}, kBone},
    {{"pubis", ""}, kBone},
    {{"ribcage", ""}, kBone},
    {{"styloid", ""}, kBone},
    {{"talus", ""}, kBone},
    {{"vertebral", ""}, kBone},
    {{"zygomatic", ""}, kBone},
};

/// Words that denote something in or next to the organ: only a row with one of them matches.
constexpr std::string_view kBesides[] = {"tumour", "vessel", "vein", "vena", "artery",
                                         "nerve",  "fluid",  "csf",  "space"};
/// Same, but the row must contain all such words of the name.
constexpr std::string_view kOthers[] = {
    "lesion",   "nodule",  "cyst",     "duct",     "cavity",        "canal",      "lumen",       "stone",
    "stent",    "implant", "thrombus", "plaque",   "calcification", "haematoma",  "haemorrhage", "bleed",
    "blood",    "abscess", "oedema",   "effusion", "content",       "screw",      "catheter",    "electrode",
    "needle",   "clip",    "coil",     "wire",     "tube",          "prosthesis", "pacemaker",   "marker",
    "ligament", "tendon",  "valve",    "node",     "gtv",           "ctv",        "ptv"};

/// Synonyms, mapped to the words of the rows: spellings, and the German and Latin names of organs.
constexpr std::array<std::pair<std::string_view, std::string_view>, 103> kSynonyms{{{"tumor", "tumour"},
                                                                                    {"cancer", "tumour"},
                                                                                    {"carcinoma", "tumour"},
                                                                                    {"metastasis", "tumour"},
                                                                                    {"metastases", "tumour"},
                                                                                    {"neoplasm", "tumour"},
                                                                                    {"gray", "grey"},
                                                                                    {"disk", "disc"},
                                                                                    {"hematoma", "haematoma"},
                                                                                    {"hemorrhage", "haemorrhage"},
                                                                                    {"bleeding", "bleed"},
                                                                                    {"edema", "oedema"},
                                                                                    {"thrombosed", "thrombus"},
                                                                                    {"calcified", "calcification"},
                                                                                    {"aortic", "aorta"},
                                                                                    {"aortae", "aorta"},
                                                                                    {"arota", "aorta"},
                                                                                    {"hauptschlagader", "aorta"},
                                                                                    {"arteria", "artery"},
                                                                                    {"arterie", "artery"},
                                                                                    {"venacava", "vena"},
                                                                                    {"vene", "vein"},
                                                                                    {"vv", "vein"},
                                                                                    {"hohlvene", "vena"},
                                                                                    {"pfortader", "vein"},
                                                                                    {"gefaess", "vessel"},
                                                                                    {"gefaesse", "vessel"},
                                                                                    {"vas", "vessel"},
                                                                                    {"vasculature", "vessel"},
                                                                                    {"links", "left"},
                                                                                    {"linke", "left"},
                                                                                    {"linker", "left"},
                                                                                    {"linkes", "left"},
                                                                                    {"sinister", "left"},
                                                                                    {"sinistra", "left"},
                                                                                    {"sinistrum", "left"},
                                                                                    {"sin", "left"},
                                                                                    {"lt", "left"},
                                                                                    {"rechts", "right"},
                                                                                    {"rechte", "right"},
                                                                                    {"rechter", "right"},
                                                                                    {"rechtes", "right"},
                                                                                    {"dexter", "right"},
                                                                                    {"dextra", "right"},
                                                                                    {"dextrum", "right"},
                                                                                    {"dex", "right"},
                                                                                    {"rt", "right"},
                                                                                    {"leber", "liver"},
                                                                                    {"hepar", "liver"},
                                                                                    {"niere", "kidney"},
                                                                                    {"nebenniere", "adrenal"},
                                                                                    {"suprarenalis", "adrenal"},
                                                                                    {"milz", "spleen"},
                                                                                    {"lien", "spleen"},
                                                                                    {"magen", "stomach"},
                                                                                    {"gaster", "stomach"},
                                                                                    {"pankreas", "pancreas"},
                                                                                    {"bauchspeicheldruese", "pancreas"},
                                                                                    {"gallenblase", "gallbladder"},
                                                                                    {"harnblase", "bladder"},
                                                                                    {"blase", "bladder"},
                                                                                    {"herz", "heart"},
                                                                                    {"herzmuskel", "heart"},
                                                                                    {"lunge", "lung"},
                                                                                    {"pulmo", "lung"},
                                                                                    {"pulmones", "lung"},
                                                                                    {"speiseroehre", "oesophagus"},
                                                                                    {"luftroehre", "trachea"},
                                                                                    {"luft", "air"},
                                                                                    {"darm", "bowel"},
                                                                                    {"duenndarm", "bowel"},
                                                                                    {"dickdarm", "bowel"},
                                                                                    {"schilddruese", "thyroid"},
                                                                                    {"prostata", "prostate"},
                                                                                    {"gebaermutter", "uterus"},
                                                                                    {"gehirn", "brain"},
                                                                                    {"hirn", "brain"},
                                                                                    {"grosshirn", "cerebrum"},
                                                                                    {"kleinhirn", "cerebellum"},
                                                                                    {"hirnstamm", "brainstem"},
                                                                                    {"muskel", "muscle"},
                                                                                    {"muskulatur", "muscle"},
                                                                                    {"musculus", "muscle"},
                                                                                    {"haut", "skin"},
                                                                                    {"fett", "fat"},
                                                                                    {"knorpel", "cartilage"},
                                                                                    {"bandscheibe", "disc"},
                                                                                    {"knochen", "bone"},
                                                                                    {"knochenmark", "marrow"},
                                                                                    {"skelett", "skeleton"},
                                                                                    {"schaedel", "skull"},
                                                                                    {"unterkiefer", "mandible"},
                                                                                    {"oberkiefer", "maxilla"},
                                                                                    {"wirbel", "vertebra"},
                                                                                    {"wirbelkoerper", "vertebra"},
                                                                                    {"wirbelsaeule", "spine"},
                                                                                    {"rippe", "rib"},
                                                                                    {"brustbein", "sternum"},
                                                                                    {"kreuzbein", "sacrum"},
                                                                                    {"becken", "pelvis"},
                                                                                    {"oberschenkelknochen", "femur"},
                                                                                    {"schulterblatt", "scapula"},
                                                                                    {"schluesselbein", "clavicle"}}};

/// Whether a word equals another, or its English, German or Latin plural.
bool isForm(std::string_view word, std::string_view of) {
  if (word.substr(0, of.size()) == of) {
    const std::string_view ending = word.substr(of.size());
    if (ending.empty() || ending == "s" || ending == "es" || ending == "n") return true;
    if (ending == "e" && of.ends_with('a')) return true;
  }
  const auto becomes = [&](std::string_view ending, std::string_view plural) {
    return of.ends_with(ending) && word.size() == of.size() - ending.size() + plural.size() && word.ends_with(plural) &&
           word.substr(0, of.size() - ending.size()) == of.substr(0, of.size() - ending.size());
  };
  return becomes("y", "ies") || becomes("us", "i") || becomes("um", "a") || becomes("is", "es");
}

std::string_view usual(std::string_view word) {
  for (const auto &[from, to] : kSynonyms)
    if (isForm(word, from)) return to;
  return word;
}

/// Replaces umlauts and accents of UTF-8 by ASCII; other letters beyond ASCII separate words.
std::string withoutAccents(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kLetters{{{"ä", "ae"},
                                                                                   {"Ä", "Ae"},
                                                                                   {"ö", "oe"},
                                                                                   {"Ö", "Oe"},
                                                                                   {"ü", "ue"},
                                                                                   {"Ü", "Ue"},
                                                                                   {"ß", "ss"},
                                                                                   {"é", "e"},
                                                                                   {"œ", "oe"}}};
  std::string out;
  while (!text.empty()) {
    const auto letter =
        std::find_if(kLetters.begin(), kLetters.end(), [&](const auto &one) { return text.starts_with(one.first); });
    out += letter != kLetters.end() ? letter->second : text.substr(0, 1);
    text.remove_prefix(letter != kLetters.end() ? letter->first.size() : 1);
  }
  return out;
}

/// "leftkidney" -> "left", "kidney"; other words are not split.
void addWord(std::vector<std::string> &words, std::string_view word) {
  constexpr std::size_t kShortest = 3;  // of the remainder, which excludes "cleft", "bright"
  for (const std::string_view side : {"left", "right"}) {
    if (word.size() < side.size() + kShortest || !(word.starts_with(side) || word.ends_with(side))) continue;
    const std::string_view rest =
        word.starts_with(side) ? word.substr(side.size()) : word.substr(0, word.size() - side.size());
    words.emplace_back(side);
    words.emplace_back(usual(rest));
    return;
  }
  if (!word.empty()) words.emplace_back(usual(word));
}

/// The words of a name in lower case, without digits, in the form of the rows: "LeftKidney", "kidney_L", "Niere links
/// 1".
std::vector<std::string> wordsOf(std::string_view label) {
  const std::string text = withoutAccents(label);
  const auto isUpper = [&](std::size_t i) { return i < text.size() && text[i] >= 'A' && text[i] <= 'Z'; };
  const auto isLower = [&](std::size_t i) { return i < text.size() && text[i] >= 'a' && text[i] <= 'z'; };
  std::vector<std::string> words;
  std::string word;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    const bool isLetter = isUpper(i) || isLower(i);
    // A capital begins a word after a lower-case letter, and before one: "MRLiver".
    const bool begins = isUpper(i) && i > 0 && (isLower(i - 1) || (isUpper(i - 1) && isLower(i + 1)));
    if (!isLetter || begins) {
      addWord(words, word);
      word.clear();
    }
    if (isLetter) word += isUpper(i) ? static_cast<char>(text[i] - 'A' + 'a') : text[i];
  }
  return words;
}

bool has(const std::vector<std::string> &words, std::string_view wanted) {
  return std::any_of(words.begin(), words.end(), [&](const std::string &word) { return isForm(word, wanted); });
}

/// Whether a row may match a name with words for something other than an organ.
class Meant {
 public:
  explicit Meant(const std::vector<std::string> &words) {
    for (const std::string_view word : kOthers)
      if (has(words, word)) others_.push_back(word);
    isBeside_ =
        std::any_of(std::begin(kBesides), std::end(kBesides), [&](std::string_view word) { return has(words, word); });
  }
  [[nodiscard]] bool operator()(const Row &row) const {
    const auto isIn = [&](std::string_view word) { return row.words[0] == word || row.words[1] == word; };
    const bool isOfRow = std::any_of(std::begin(kBesides), std::end(kBesides), isIn) ||
                         std::any_of(std::begin(kOthers), std::end(kOthers), isIn);
    if (isBeside_ && !isOfRow) return false;
    return isIn("tumour") || std::all_of(others_.begin(), others_.end(), isIn);
  }

 private:
  std::vector<std::string_view> others_;
  bool isBeside_ = false;
};

}  // namespace

std::optional<NamedTissue> tissueOf(const MaterialLibrary &materials, std::string_view label) {
  if (const MaterialPreset *same = materials.find(label)) {
    for (const Row &row : kRows)
      if (row.tissue.preset == label && row.tissue.remark.empty()) return NamedTissue{row.tissue.name, same};
    return NamedTissue{same->name, same};
  }
  const std::vector<std::string> words = wordsOf(label);
  const Meant isMeant(words);
  for (const Row &row : kRows) {
    const bool fits = has(words, row.words[0]) && (row.words[1].empty() || has(words, row.words[1]));
    if (!fits || !isMeant(row)) continue;
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
