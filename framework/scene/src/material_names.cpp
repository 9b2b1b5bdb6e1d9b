// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/material_names.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace c3de::scene {
namespace {

/// All words of a row must occur; the first row that fits and whose preset exists is taken.
struct Row {
  std::array<std::string_view, 2> words;
  std::string_view preset;
};

constexpr Row kRows[] = {
    {{"hcc", ""}, "liver_hcc"},
    {{"hepatocellular", "carcinoma"}, "liver_hcc"},
    {{"liver", "tumor"}, "liver_hcc"},
    {{"liver", "tumour"}, "liver_hcc"},
    {{"prostate", "tumor"}, "prostate_cancer"},
    {{"prostate", "tumour"}, "prostate_cancer"},
    {{"prostate", "cancer"}, "prostate_cancer"},
    {{"hepatic", "artery"}, "hepatic_artery"},
    {{"aorta", ""}, "aorta"},
    {{"carotid", "artery"}, "aorta"},
    {{"subclavian", "artery"}, "aorta"},
    {{"iliac", "artery"}, "aorta"},
    {{"brachiocephalic", "trunk"}, "aorta"},
    {{"bile", "duct"}, "bile_duct"},
    {{"liver", "cirrhosis"}, "liver_diseased"},
    {{"liver", "fibrosis"}, "liver_diseased"},
    {{"white", "matter"}, "brain_white"},
    {{"grey", "matter"}, "brain_grey"},
    {{"gray", "matter"}, "brain_grey"},
    {{"gallbladder", ""}, "gallbladder"},
    {{"gall", "bladder"}, "gallbladder"},
    {{"liver", ""}, "liver"},
    {{"kidney", ""}, "kidney_cortex"},
    {{"spleen", ""}, "spleen"},
    {{"pancreas", ""}, "pancreas"},
    {{"brain", ""}, "brain_grey"},
    {{"cerebrum", ""}, "brain_grey"},
    {{"cerebellum", ""}, "brain_grey"},
    {{"hippocampus", ""}, "brain_grey"},
    {{"thalamus", ""}, "brain_grey"},
    {{"heart", ""}, "heart_passive"},
    {{"myocardium", ""}, "heart_passive"},
    {{"atrium", ""}, "heart_passive"},
    {{"atrial", "appendage"}, "heart_passive"},
    {{"lung", ""}, "lung_inflated"},
    {{"stomach", ""}, "stomach"},
    {{"thyroid", ""}, "thyroid"},
    {{"prostate", ""}, "prostate"},
    {{"breast", ""}, "breast_gland"},
    {{"muscle", ""}, "muscle_skeletal_rest"},
    {{"gluteus", ""}, "muscle_skeletal_rest"},
    {{"iliopsoas", ""}, "muscle_skeletal_rest"},
    {{"autochthon", ""}, "muscle_skeletal_rest"},
    {{"skin", ""}, "skin"},
    {{"fat", ""}, "fat"},
    {{"adipose", ""}, "fat"},
    {{"cartilage", ""}, "cartilage"},
    {{"bone", ""}, "bone_cortical"},
    {{"skull", ""}, "bone_cortical"},
    {{"vertebra", ""}, "bone_cortical"},
    {{"vertebrae", ""}, "bone_cortical"},
    {{"rib", ""}, "bone_cortical"},
    {{"sternum", ""}, "bone_cortical"},
    {{"sacrum", ""}, "bone_cortical"},
    {{"hip", ""}, "bone_cortical"},
    {{"femur", ""}, "bone_cortical"},
    {{"humerus", ""}, "bone_cortical"},
    {{"scapula", ""}, "bone_cortical"},
    {{"clavicula", ""}, "bone_cortical"},
};

/// In a name, these say that it is something in the organ or beside it.
constexpr std::string_view kOthers[] = {"tumor", "tumour", "cancer", "carcinoma", "lesion", "metastasis",
                                        "cyst",  "vessel", "vein",   "vena",      "artery", "duct",
                                        "nerve", "fluid",  "csf",    "cavity",    "implant"};

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

const MaterialPreset *presetForOrgan(const MaterialLibrary &materials, std::string_view organ) {
  if (const MaterialPreset *same = materials.find(organ)) return same;
  const std::vector<std::string> words = wordsOf(organ);
  for (const Row &row : kRows) {
    const bool fits = has(words, row.words[0]) && (row.words[1].empty() || has(words, row.words[1]));
    if (!fits) continue;
    const bool isLeftOut = std::any_of(std::begin(kOthers), std::end(kOthers), [&](std::string_view other) {
      return has(words, other) && row.words[0] != other && row.words[1] != other;
    });
    if (isLeftOut && !(isOther(row.words[0]) || isOther(row.words[1]))) continue;
    if (const MaterialPreset *preset = materials.find(row.preset)) return preset;
  }
  return nullptr;
}

}  // namespace c3de::scene
