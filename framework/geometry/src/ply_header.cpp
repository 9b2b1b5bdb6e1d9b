// SPDX-License-Identifier: Apache-2.0
#include "ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "file_text.h"

namespace c3de::geometry {
namespace {

std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> out;
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return out;
    const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    out.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

bool isType(std::string_view word) {
  for (std::string_view type : {"char", "uchar", "short", "ushort", "int", "uint", "float", "double", "int8", "uint8",
                                "int16", "uint16", "int32", "uint32", "float32", "float64"})
    if (word == type) return true;
  return false;
}

bool isPropertyLine(const std::vector<std::string_view> &w) {
  if (w.size() == 3) return isType(w[1]);
  return w.size() == 5 && w[1] == "list" && isType(w[2]) && isType(w[3]);
}

}  // namespace

Expected<void> checkPlyHeader(const std::string &fileName, std::string_view text) {
  const std::size_t fileSize = text.size();
  long long elements = 0;
  bool hasFormat = false, hasVertices = false, hasFaces = false, hasIndices = false;
  std::string_view element;
  std::size_t axes = 0;
  for (std::size_t lineNumber = 1; !text.empty(); ++lineNumber) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    const auto refuse = [&](const std::string &what) {
      return fail(ErrorCode::input, fmt::format("{}:{}: {}", fileName, lineNumber, what));
    };
    const auto w = words(line);
    const std::string_view keyword = w.empty() ? std::string_view() : w[0];
    if (lineNumber == 1) {
      if (keyword != "ply" || w.size() != 1) return refuse("the first line is not 'ply'");
    } else if (keyword == "comment" || keyword == "obj_info") {
      continue;
    } else if (keyword == "format") {
      if (w.size() != 3 || (w[1] != "ascii" && w[1] != "binary_little_endian" && w[1] != "binary_big_endian"))
        return refuse("format line " + quotedText(line) +
                      "; ascii, binary_little_endian and binary_big_endian are accepted");
      hasFormat = true;
    } else if (keyword == "element") {
      long long count = 0;
      if (w.size() != 3 || !parseInteger(w[2], count) || count < 0)
        return refuse("element line " + quotedText(line) + "; a name and a number are expected");
      elements += count;
      if (elements > static_cast<long long>(fileSize))
        return refuse(fmt::format("{} elements announced in a file of {} bytes", elements, fileSize));
      element = w[1];
      hasVertices |= element == "vertex" && count > 0;
      hasFaces |= element == "face" && count > 0;
    } else if (keyword == "property") {
      if (element.empty() || !isPropertyLine(w))
        return refuse("property line " + quotedText(line) + "; a type, or list and two types, and a name are expected");
      axes += element == "vertex" && (w.back() == "x" || w.back() == "y" || w.back() == "z");
      hasIndices |= element == "face" && w.size() == 5 && (w.back() == "vertex_indices" || w.back() == "vertex_index");
    } else if (keyword == "end_header") {
      if (!hasFormat) return refuse("no format line above the end of the header");
      if (!hasVertices || axes != 3) return refuse("no vertices with x, y and z are announced");
      if (!hasFaces || !hasIndices)
        return refuse("no faces with a list of vertex_indices are announced; a surface is expected");
      return {};
    } else {
      return refuse("header line " + quotedText(line) +
                    "; format, comment, element, property and end_header are accepted");
    }
  }
  return fail(ErrorCode::input, fileName + ": the file ends before 'end_header'");
}

}  // namespace c3de::geometry
