// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/label_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include "formats/image_header.h"

namespace c3de::imaging {
namespace {

std::vector<std::string> wordsOf(std::string_view text, std::string_view separators) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (separators.find(c) == std::string_view::npos)
      words.back() += c;
    else if (!words.back().empty())
      words.emplace_back();
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

std::string joined(const std::vector<std::string> &words) {
  std::string text;
  for (const std::string &word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// "T12", "C1", "L5", "S1"
bool isLevel(const std::string &word) {
  return word.size() >= 2 && word.size() <= 3 && std::string_view("CTLSctls").find(word[0]) != std::string_view::npos &&
         std::all_of(word.begin() + 1, word.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

// '*' stands for any text.
bool matches(std::string_view pattern, std::string_view text) {
  if (pattern.empty()) return text.empty();
  if (pattern.front() == '*') {
    for (std::size_t n = 0; n <= text.size(); ++n)
      if (matches(pattern.substr(1), text.substr(n))) return true;
    return false;
  }
  return !text.empty() && pattern.front() == text.front() && matches(pattern.substr(1), text.substr(1));
}

}  // namespace

std::string readableName(std::string_view name) {
  std::vector<std::string> words = wordsOf(name, "_ ");
  for (std::size_t w = 0; w + 1 < words.size(); ++w)
    if (lowerCase(words[w]) == "vertebrae" && isLevel(words[w + 1])) words[w].pop_back();
  return joined(words);
}

std::string nameFromFile(const std::filesystem::path &file) {
  const std::u8string utf8 = file.filename().u8string();
  std::string name(utf8.begin(), utf8.end());
  for (const std::string_view ending :
       {".gz", ".nii", ".nrrd", ".nhdr", ".mha", ".mhd", ".img", ".hdr", ".seg", ".dcm"})
    if (name.size() > ending.size() && lowerCase(name).ends_with(ending)) name.resize(name.size() - ending.size());
  std::vector<std::string> words = wordsOf(name, "_ -.");
  std::erase_if(words, [](const std::string &word) {
    static constexpr std::array kWords{"label",        "labels",  "labelmap", "mask", "seg",
                                       "segmentation", "segment", "binary",   "roi"};
    const std::string lower = lowerCase(word);
    return std::any_of(kWords.begin(), kWords.end(), [&](const char *one) { return lower == one; });
  });
  if (std::all_of(words.begin(), words.end(), [](const std::string &word) {
        return std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
      }))
    return {};
  return readableName(joined(words));
}

bool matchesLabel(std::string_view wanted, const LabelMap::Label &label) {
  return wanted == std::to_string(label.value) || matches(wanted, label.name);
}

}  // namespace c3de::imaging
