// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <sstream>
#include <string_view>

#include "file_text.h"
#include "raw_mesh.h"

namespace c3de::geometry {
namespace {

std::string_view nextToken(std::string_view &line) {
  const std::size_t begin = line.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return line = {};
  const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
  const std::string_view token = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return token;
}

/// Checks for errors that tinyobjloader accepts: text instead of a number (read as 0), non-finite numbers, indices out
/// of range, faces with two corners (omitted), endless faces. Joins continued lines, which it does not support.
class ObjScan {
 public:
  ObjScan(std::string fileName, double millimetresPerUnit)
      : fileName_(std::move(fileName)), limit_(kMaxCoordinate_mm / millimetresPerUnit) {}

  Expected<void> run(std::string_view text);
  [[nodiscard]] const std::string &statements() const { return statements_; }
  /// Faces with fewer than three corners, which are omitted.
  [[nodiscard]] std::size_t shortFaces() const { return shortFaces_; }

 private:
  [[nodiscard]] tl::unexpected<Error> refuse(std::size_t line, const std::string &what) const {
    return fail(ErrorCode::input, fmt::format("{}:{}: {}", fileName_, line, what));
  }
  Expected<void> checkVertex(std::string_view rest, std::size_t line);
  /// Whether the face has at least three corners.
  Expected<bool> checkFace(std::string_view rest, std::size_t line);

  struct IndexRecord {
    long long value;
    std::size_t line;
  };
  std::string fileName_, statements_;
  double limit_;
  std::size_t vertices_ = 0, faces_ = 0, shortFaces_ = 0;
  std::vector<IndexRecord> largest_;  ///< increasing: a vertex may come after the face that names it
};

Expected<void> ObjScan::checkVertex(std::string_view rest, std::size_t line) {
  for (const char *axis : {"x", "y", "z"}) {
    const std::string_view token = nextToken(rest);
    if (token.empty())
      return refuse(line, fmt::format("a vertex without its {} coordinate; three numbers are expected", axis));
    double value = 0.0;
    switch (parseNumber(token, value)) {
      case NumberState::notANumber:
        return refuse(line, fmt::format("{} coordinate {} of vertex {} is not a number (a decimal point is expected)",
                                        axis, quotedText(token), vertices_ + 1));
      case NumberState::notFinite:
        return refuse(
            line, fmt::format("{} coordinate {} of vertex {} is not finite", axis, quotedText(token), vertices_ + 1));
      case NumberState::ok: break;
    }
    if (std::abs(value) > limit_)
      return refuse(
          line, fmt::format("{} coordinate {} of vertex {} is beyond 1e9 mm; {:g} in the unit of this file is accepted",
                            axis, quotedText(token), vertices_ + 1, limit_));
  }
  ++vertices_;
  return {};
}

Expected<bool> ObjScan::checkFace(std::string_view rest, std::size_t line) {
  std::size_t corners = 0;
  for (std::string_view token = nextToken(rest); !token.empty(); token = nextToken(rest)) {
    if (++corners > kMaxFaceCorners)
      return refuse(
          line, fmt::format("a face with more than {} corners, which is the most that is accepted", kMaxFaceCorners));
    long long index = 0;
    if (!parseInteger(token.substr(0, token.find('/')), index))
      return refuse(line, fmt::format("face corner {} is not a vertex index", quotedText(token)));
    if (index == 0) return refuse(line, "face corner 0: vertex indices count from 1");
    if (index < 0 && -index > static_cast<long long>(vertices_))
      return refuse(line,
                    fmt::format("face corner {} counts back beyond the {} vertices above this line", index, vertices_));
    if (index > static_cast<long long>(vertices_) && (largest_.empty() || index > largest_.back().value))
      largest_.push_back({index, line});
  }
  ++(corners < 3 ? shortFaces_ : faces_);
  return corners >= 3;
}

Expected<void> ObjScan::run(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::string joined;
  std::size_t lineNumber = 0;
  while (!text.empty()) {
    const std::size_t firstLine = ++lineNumber;
    const auto takeLine = [&text] {
      const std::size_t end = text.find('\n');
      std::string_view taken = text.substr(0, end);
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      while (!taken.empty() && taken.back() == '\r') taken.remove_suffix(1);
      return taken;
    };
    std::string_view line = takeLine();
    if (line.ends_with('\\')) {
      joined.clear();
      while (line.ends_with('\\')) {
        joined.append(line.substr(0, line.size() - 1)).push_back(' ');
        line = text.empty() ? std::string_view() : takeLine();
        ++lineNumber;
      }
      joined.append(line);
      line = joined;
    }
    std::string_view rest = line.substr(0, line.find('#'));
    const std::string_view keyword = nextToken(rest);
    if (keyword == "v") {
      if (auto ok = checkVertex(rest, firstLine); !ok) return ok;
      statements_.append("v ").append(rest).push_back('\n');
    } else if (keyword == "f") {
      const auto isFace = checkFace(rest, firstLine);
      if (!isFace) return tl::unexpected(isFace.error());
      if (*isFace) statements_.append("f ").append(rest).push_back('\n');
    }
  }
  if (vertices_ == 0)
    return fail(ErrorCode::input, fileName_ + ": no vertices ('v x y z' lines); is this an OBJ file?");
  if (faces_ == 0)
    return fail(ErrorCode::input,
                fmt::format("{}: {} vertices but no faces ('f' lines); a surface is expected", fileName_, vertices_));
  for (const IndexRecord &record : largest_)
    if (record.value > static_cast<long long>(vertices_))
      return refuse(record.line,
                    fmt::format("face corner {} is out of range; the file has {} vertices, 1 to {} are accepted",
                                record.value, vertices_, vertices_));
  return {};
}

/// Faces as tinyobjloader reports them, before vertices that come later are known.
struct ObjContent {
  std::vector<Vec3> vertices;
  std::vector<unsigned> corners;
  std::vector<std::size_t> faceBegin{0};
};

}  // namespace

Expected<RawMesh> readObj(const std::filesystem::path &path, double millimetresPerUnit) {
  auto text = readWholeFile(path);
  if (!text) return tl::unexpected(text.error());
  const std::string name = displayPath(path);
  ObjScan scan(name, millimetresPerUnit);
  if (auto ok = scan.run(*text); !ok) return tl::unexpected(ok.error());

  ObjContent content;
  tinyobj::callback_t callbacks;
  callbacks.vertex_cb = [](void *user, tinyobj::real_t x, tinyobj::real_t y, tinyobj::real_t z, tinyobj::real_t) {
    static_cast<ObjContent *>(user)->vertices.push_back({x, y, z});
  };
  callbacks.index_cb = [](void *user, tinyobj::index_t *indices, int count) {
    auto &out = *static_cast<ObjContent *>(user);
    for (int i = 0; i < count; ++i) {
      const int index = indices[i].vertex_index;
      out.corners.push_back(index > 0 ? static_cast<unsigned>(index - 1)
                                      : static_cast<unsigned>(static_cast<int>(out.vertices.size()) + index));
    }
    out.faceBegin.push_back(out.corners.size());
  };
  std::string warning, error;
  try {
    std::istringstream stream(scan.statements());
    if (!tinyobj::LoadObjWithCallback(stream, callbacks, &content, nullptr, &warning, &error))
      return fail(ErrorCode::input, name + ": " + (error.empty() ? "cannot be read as OBJ" : error));
  } catch (const std::exception &exception) {
    return fail(ErrorCode::input, name + ": cannot be read as OBJ: " + exception.what());
  }

  RawMesh raw;
  raw.vertices = std::move(content.vertices);
  raw.facesDropped = scan.shortFaces();
  for (std::size_t f = 0; f + 1 < content.faceBegin.size(); ++f) {
    const std::span<const unsigned> corners(content.corners.data() + content.faceBegin[f],
                                            content.faceBegin[f + 1] - content.faceBegin[f]);
    if (!addFace(raw, corners))
      return fail(ErrorCode::input,
                  fmt::format("{}: face {} is a concave polygon with {} corners; up to 4096 are accepted", name, f + 1,
                              corners.size()));
  }
  return raw;
}

}  // namespace c3de::geometry
