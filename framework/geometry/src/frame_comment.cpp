// SPDX-License-Identifier: Apache-2.0
#include "frame_comment.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <vector>

#include "c3de/core/input_file.h"
#include "file_text.h"

namespace c3de::geometry {
namespace {

/// Comments are at the beginning; a file of a gigabyte is not searched completely.
constexpr std::size_t kSearchedBytes = 65536;

std::string lowerCase(std::string_view text) {
  std::string out(text);
  for (char &c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

/// The comments of the head, one per line.
std::string headComments(std::string_view text, std::string_view extension) {
  text = text.substr(0, kSearchedBytes);
  std::string out;
  if (extension == ".stl") {
    const std::size_t end = lowerCase(text.substr(0, 5)) == "solid" ? text.find('\n') : 80;
    return std::string(text.substr(0, std::min(end, std::size_t{256})));
  }
  if (extension == ".vtp" || extension == ".vtu") {
    for (std::size_t at = text.find("<!--"); at != std::string_view::npos; at = text.find("<!--", at + 4)) {
      const std::size_t end = text.find("-->", at);
      if (end == std::string_view::npos) break;
      out += std::string(text.substr(at + 4, end - at - 4)) + "\n";
    }
    return out;
  }
  for (std::size_t lineNumber = 0; !text.empty(); ++lineNumber) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (extension == ".vtk") {
      if (lineNumber == 1) return std::string(line);
    } else if (extension == ".ply") {
      if (line.starts_with("end_header")) break;
      if (line.starts_with("comment") || line.starts_with("obj_info")) out += std::string(line) + "\n";
    } else if (extension == ".obj" || extension == ".off") {
      if (line.starts_with("#")) out += std::string(line) + "\n";
    } else {
      break;
    }
  }
  return out;
}

bool isWord(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'; }

/// The words after `key` and one of the separators, where the key begins a word.
std::vector<std::string> wordsAfter(std::string_view text, std::string_view key, std::string_view separators) {
  std::vector<std::string> words;
  for (std::size_t at = text.find(key); at != std::string_view::npos; at = text.find(key, at + 1)) {
    if (at > 0 && isWord(text[at - 1])) continue;
    std::size_t begin = text.find_first_not_of(' ', at + key.size());
    if (begin == std::string_view::npos || separators.find(text[begin]) == std::string_view::npos) continue;
    begin = std::min(text.find_first_not_of(" \"'", begin + 1), text.size());
    std::size_t end = begin;
    while (end < text.size() && isWord(text[end])) ++end;
    const bool isPlain = end == text.size() || std::string_view("/^*").find(text[end]) == std::string_view::npos;
    if (end > begin && isPlain) words.emplace_back(text.substr(begin, end - begin));
  }
  return words;
}

std::optional<LengthUnit> unitNamed(std::string_view word) {
  for (const auto &[unit, names] :
       {std::pair{LengthUnit::metre, std::array{"m", "meter", "meters", "metre", "metres"}},
        {LengthUnit::millimetre, {"mm", "millimeter", "millimeters", "millimetre", "millimetres"}},
        {LengthUnit::centimetre, {"cm", "centimeter", "centimeters", "centimetre", "centimetres"}}})
    if (std::find(names.begin(), names.end(), word) != names.end()) return unit;
  return std::nullopt;
}

}  // namespace

FrameComment frameComment(std::string_view text, std::string_view extension) {
  const std::string comments = headComments(text, extension), lower = lowerCase(comments);
  FrameComment said;
  for (const std::string_view key : {"units", "unit"})
    for (std::string &word : wordsAfter(lower, key, "=:")) {
      if (!said.unit) said.unit = unitNamed(word);
      if (!said.unit && said.unknownUnit.empty()) said.unknownUnit = std::move(word);
    }
  if (said.unit) said.unknownUnit.clear();
  if (extension == ".glb" || extension == ".gltf") said.unit = LengthUnit::metre;  // by the standard, 3.4
  const auto spaces = wordsAfter(comments, "SPACE", "=");
  said.isRas = !spaces.empty() && spaces.front() == "RAS";
  return said;
}

FrameComment frameCommentOf(const std::filesystem::path &path) {
  auto in = openInputFile(path);
  if (!in) return frameComment({}, lowerExtension(path));
  std::string head(kSearchedBytes, '\0');
  in->read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(in->gcount(), 0)));
  return frameComment(head, lowerExtension(path));
}

}  // namespace c3de::geometry
