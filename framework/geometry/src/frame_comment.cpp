// SPDX-License-Identifier: Apache-2.0
#include "frame_comment.h"

#include <algorithm>
#include <fstream>
#include <string>

#include "file_text.h"

namespace c3de::geometry {
namespace {

/// Comments stand at the beginning; a file of a gigabyte is not searched.
constexpr std::size_t kSearchedBytes = 65536;

/// The comments of the head, each in a line of its own.
std::string headComments(std::string_view text, std::string_view extension) {
  text = text.substr(0, kSearchedBytes);
  std::string out;
  if (extension == ".stl") {
    const std::size_t end = text.starts_with("solid") ? text.find('\n') : 80;
    return std::string(text.substr(0, std::min(end, std::size_t{256})));
  }
  if (extension == ".vtp") {
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

/// The word after the first `key` that begins a word; empty: there is none.
std::string_view wordAfter(std::string_view text, std::string_view key) {
  for (std::size_t at = text.find(key); at != std::string_view::npos; at = text.find(key, at + 1)) {
    if (at > 0 && isWord(text[at - 1])) continue;
    std::size_t begin = at + key.size();
    while (begin < text.size() && text[begin] == ' ') ++begin;
    std::size_t end = begin;
    while (end < text.size() && isWord(text[end])) ++end;
    return text.substr(begin, end - begin);
  }
  return {};
}

}  // namespace

FrameComment frameComment(std::string_view text, std::string_view extension) {
  const std::string comments = headComments(text, extension);
  FrameComment said;
  for (const std::string_view key : {"UNITS=", "UNIT=", "unit:"}) {
    const std::string_view word = wordAfter(comments, key);
    for (const LengthUnit unit : {LengthUnit::metre, LengthUnit::millimetre, LengthUnit::centimetre})
      if (word == unitName(unit)) said.unit = unit;
    if (said.unit) break;
  }
  said.isRas = wordAfter(comments, "SPACE=") == "RAS";
  return said;
}

FrameComment frameCommentOf(const std::filesystem::path &path) {
  std::ifstream in(path, std::ios::binary);
  std::string head(kSearchedBytes, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  return frameComment(head, lowerExtension(path));
}

}  // namespace c3de::geometry
