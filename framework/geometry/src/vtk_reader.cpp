// SPDX-License-Identifier: Apache-2.0
// Legacy VTK (.vtk), surfaces and the outer surface of unstructured grids; ASCII and binary, both the classic cell
// layout and the one of version 5.1.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "cell_surface.h"
#include "file_text.h"
#include "raw_mesh.h"

namespace c3de::geometry {
namespace {

/// Size in bytes of a number type by its name in the file; 0: unknown type.
std::size_t typeSize(std::string_view type) {
  for (std::string_view t : {"double", "long", "unsigned_long", "vtktypeint64", "vtktypeuint64", "vtkidtype_64"})
    if (type == t) return 8;
  for (std::string_view t : {"float", "int", "unsigned_int", "vtkidtype", "vtktypeint32", "vtktypeuint32"})
    if (type == t) return 4;
  return 0;
}

class VtkParser {
 public:
  VtkParser(std::string fileName, std::string_view text) : fileName_(std::move(fileName)), text_(text) {}
  Expected<RawMesh> run();

 private:
  [[nodiscard]] tl::unexpected<Error> refuse(const std::string &what) const {
    const auto line = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(tokenBegin_), '\n') + 1;
    return fail(ErrorCode::input, binary_ ? fmt::format("{}: {} (at byte {})", fileName_, what, tokenBegin_)
                                          : fmt::format("{}:{}: {}", fileName_, line, what));
  }
  std::string_view line();
  std::string_view token();
  std::string lowerToken();
  Expected<std::size_t> count(const char *what);
  /// Moves past the end of the keyword's line, where binary values begin.
  void endLine();
  Expected<void> reals(std::size_t n, const std::string &type, std::vector<double> &out);
  Expected<void> integers(std::size_t n, const std::string &type, std::vector<long long> &out);
  [[nodiscard]] const unsigned char *bytes(std::size_t n);
  Expected<void> points(RawMesh &raw);
  struct Cells {
    std::string section;
    std::vector<std::size_t> begin;  ///< of each cell in `corners`, one entry more than cells
    std::vector<long long> corners;
    [[nodiscard]] std::size_t count() const { return begin.size() - 1; }
  };
  Expected<Cells> cells(const std::string &section);
  /// The corners of one cell, all in range.
  Expected<std::vector<unsigned>> cornersOf(const Cells &cells, std::size_t cell, const RawMesh &raw) const;
  Expected<void> addCells(const Cells &cells, RawMesh &raw) const;
  Expected<RawMesh> polydata();
  Expected<RawMesh> grid();
  void skipMetadata();

  std::string fileName_;
  std::string_view text_;
  std::size_t at_ = 0, tokenBegin_ = 0;
  bool binary_ = false;
};

std::string_view VtkParser::line() {
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string_view taken = text_.substr(at_, end - at_);
  tokenBegin_ = at_;
  at_ = std::min(end + 1, text_.size());
  while (!taken.empty() && (taken.back() == '\r' || taken.back() == ' ')) taken.remove_suffix(1);
  return taken;
}

std::string_view VtkParser::token() {
  constexpr std::string_view kSpace = " \t\r\n";
  at_ = std::min(text_.find_first_not_of(kSpace, at_), text_.size());
  tokenBegin_ = at_;
  at_ = std::min(text_.find_first_of(kSpace, at_), text_.size());
  return text_.substr(tokenBegin_, at_ - tokenBegin_);
}

std::string VtkParser::lowerToken() {
  std::string lower(token());
  for (char &c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

Expected<std::size_t> VtkParser::count(const char *what) {
  const std::string_view t = token();
  long long value = 0;
  if (!parseInteger(t, value) || value < 0)
    return refuse(fmt::format("number of {} expected, found {}", what, quotedText(t)));
  // A count that the file cannot contain (at least one byte per number) must not cause an allocation.
  if (static_cast<unsigned long long>(value) > text_.size())
    return refuse(fmt::format("{} {} announced in a file of {} bytes", value, what, text_.size()));
  return static_cast<std::size_t>(value);
}

void VtkParser::endLine() {
  const std::size_t end = text_.find('\n', at_);
  at_ = end == std::string_view::npos ? text_.size() : end + 1;
}

const unsigned char *VtkParser::bytes(std::size_t n) {
  tokenBegin_ = at_;
  if (n > text_.size() - at_) return nullptr;
  const auto *p = reinterpret_cast<const unsigned char *>(text_.data() + at_);
  at_ += n;
  return p;
}

std::uint64_t bigEndian(const unsigned char *p, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | p[i];
  return value;
}

Expected<void> VtkParser::reals(std::size_t n, const std::string &type, std::vector<double> &out) {
  out.resize(n);
  if (!binary_) {
    for (std::size_t i = 0; i < n; ++i) {
      const std::string_view t = token();
      if (t.empty()) return refuse(fmt::format("the file ends after {} of {} coordinates", i, n));
      switch (parseNumber(t, out[i])) {
        case NumberState::notANumber:
          return refuse(fmt::format("coordinate {} is not a number (a decimal point is expected)", quotedText(t)));
        case NumberState::notFinite: return refuse(fmt::format("coordinate {} is not finite", quotedText(t)));
        case NumberState::ok: break;
      }
    }
    return {};
  }
  if (type != "float" && type != "double")
    return refuse(fmt::format("points of type {}; float and double are accepted in binary files", quotedText(type)));
  const std::size_t size = typeSize(type);
  endLine();
  const unsigned char *p = bytes(n * size);
  if (!p) return refuse(fmt::format("the file ends before its {} coordinates of type {}", n, type));
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint64_t bits = bigEndian(p + i * size, size);
    out[i] = size == 4 ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)))
                       : std::bit_cast<double>(bits);
  }
  return {};
}

Expected<void> VtkParser::integers(std::size_t n, const std::string &type, std::vector<long long> &out) {
  out.resize(n);
  if (!binary_) {
    for (std::size_t i = 0; i < n; ++i) {
      const std::string_view t = token();
      if (t.empty()) return refuse(fmt::format("the file ends after {} of {} indices", i, n));
      if (!parseInteger(t, out[i])) return refuse(fmt::format("index {} is not a whole number", quotedText(t)));
    }
    return {};
  }
  const std::size_t size = typeSize(type);
  if (size == 0) return refuse(fmt::format("indices of type {}; int and vtktypeint64 are accepted", quotedText(type)));
  endLine();
  const unsigned char *p = bytes(n * size);
  if (!p) return refuse(fmt::format("the file ends before its {} indices", n));
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint64_t bits = bigEndian(p + i * size, size);
    out[i] = size == 4 ? static_cast<long long>(static_cast<std::int32_t>(static_cast<std::uint32_t>(bits)))
                       : static_cast<long long>(bits);
  }
  return {};
}

Expected<void> VtkParser::points(RawMesh &raw) {
  auto n = count("points");
  if (!n) return tl::unexpected(n.error());
  const std::string type = lowerToken();
  std::vector<double> values;
  if (auto ok = reals(3 * *n, type, values); !ok) return ok;
  raw.vertices.resize(*n);
  for (std::size_t i = 0; i < *n; ++i) raw.vertices[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return {};
}

Expected<VtkParser::Cells> VtkParser::cells(const std::string &section) {
  Cells out{section, {0}, {}};
  auto &[name, begin, corners] = out;
  auto first = count("cells");
  if (!first) return tl::unexpected(first.error());
  auto second = count("indices");
  if (!second) return tl::unexpected(second.error());

  // Version 5.1 has OFFSETS on the next line; the classic layout continues with numbers.
  const std::size_t here = at_;
  endLine();
  if (text_.substr(at_, 7) == "OFFSETS") {
    token();
    const std::string offsetType = lowerToken();
    std::vector<long long> offsets;
    if (auto ok = integers(*first, offsetType, offsets); !ok) return tl::unexpected(ok.error());
    if (const std::string_view t = token(); t != "CONNECTIVITY")
      return refuse("CONNECTIVITY expected, found " + quotedText(t));
    const std::string connectivityType = lowerToken();
    if (auto ok = integers(*second, connectivityType, corners); !ok) return tl::unexpected(ok.error());
    begin.clear();
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      if (offsets[i] < (i ? offsets[i - 1] : 0) || offsets[i] > static_cast<long long>(corners.size()) ||
          (i == 0 && offsets[i] != 0))
        return refuse(fmt::format("offset {} of cell {} in {} is out of order; 0 to {} ascending is accepted",
                                  offsets[i], i, section, corners.size()));
      begin.push_back(static_cast<std::size_t>(offsets[i]));
    }
    if (begin.empty()) begin.push_back(0);
    return out;
  }

  at_ = here;
  std::vector<long long> list;
  if (auto ok = integers(*second, "int", list); !ok) return tl::unexpected(ok.error());
  std::size_t i = 0;
  for (std::size_t cell = 0; cell < *first; ++cell) {
    const long long n = i < list.size() ? list[i] : -1;
    if (n < 0 || static_cast<unsigned long long>(n) > list.size() - i - 1)
      return refuse(
          fmt::format("{} {} has {} corners, more than its list of {} numbers holds", section, cell, n, list.size()));
    corners.insert(corners.end(), list.begin() + static_cast<std::ptrdiff_t>(i + 1),
                   list.begin() + static_cast<std::ptrdiff_t>(i + 1) + static_cast<std::ptrdiff_t>(n));
    begin.push_back(corners.size());
    i += static_cast<std::size_t>(n) + 1;
  }
  return out;
}

Expected<std::vector<unsigned>> VtkParser::cornersOf(const Cells &cells, std::size_t cell, const RawMesh &raw) const {
  std::vector<unsigned> corners;
  for (std::size_t i = cells.begin[cell]; i < cells.begin[cell + 1]; ++i) {
    if (cells.corners[i] < 0 || cells.corners[i] >= static_cast<long long>(raw.vertices.size()))
      return fail(ErrorCode::input,
                  fmt::format("{}: {} {}: point index {} is out of range; the file has {} points, 0 to {} are accepted",
                              fileName_, cells.section, cell, cells.corners[i], raw.vertices.size(),
                              static_cast<long long>(raw.vertices.size()) - 1));
    corners.push_back(static_cast<unsigned>(cells.corners[i]));
  }
  return corners;
}

Expected<void> VtkParser::addCells(const Cells &cells, RawMesh &raw) const {
  for (std::size_t c = 0; c < cells.count(); ++c) {
    const auto face = cornersOf(cells, c, raw);
    if (!face) return tl::unexpected(face.error());
    if (cells.section == "TRIANGLE_STRIPS") {
      if (face->size() < 3) ++raw.facesDropped;
      for (std::size_t i = 0; i + 2 < face->size(); ++i)
        raw.triangles.push_back(i % 2 == 0 ? Triangle{(*face)[i], (*face)[i + 1], (*face)[i + 2]}
                                           : Triangle{(*face)[i + 1], (*face)[i], (*face)[i + 2]});
      continue;
    }
    if (face->size() > kMaxFaceCorners || !addFace(raw, *face))
      return fail(ErrorCode::input,
                  fmt::format("{}: {} {} has {} corners; up to {} are accepted, up to 4096 if it is concave", fileName_,
                              cells.section, c, face->size(), kMaxFaceCorners));
  }
  return {};
}

void VtkParser::skipMetadata() {
  endLine();
  while (at_ < text_.size() && !line().empty()) {
  }
}

Expected<RawMesh> VtkParser::run() {
  if (!line().starts_with("# vtk DataFile"))
    return refuse(
        "the first line is not '# vtk DataFile Version ...'; legacy VTK files are accepted (XML has the extension "
        ".vtp)");
  line();  // title, free text
  const std::string coding = lowerToken();
  if (coding != "ascii" && coding != "binary") return refuse("ASCII or BINARY expected, found " + quotedText(coding));
  const bool binary = coding == "binary";
  if (const std::string word = lowerToken(); word != "dataset")
    return refuse("DATASET expected, found " + quotedText(word));
  binary_ = binary;
  const std::string_view kind = token();
  if (kind == "POLYDATA") return polydata();
  if (kind == "UNSTRUCTURED_GRID") return grid();
  binary_ = false;
  return refuse("dataset " + quotedText(kind) + "; POLYDATA (a surface) and UNSTRUCTURED_GRID (cells) are accepted");
}

Expected<RawMesh> VtkParser::polydata() {
  RawMesh raw;
  std::vector<Cells> surfaces;
  std::size_t ignored = 0;
  while (true) {
    const std::string keyword(token());
    if (keyword.empty() || keyword == "POINT_DATA" || keyword == "CELL_DATA") break;
    if (keyword == "POINTS") {
      if (auto ok = points(raw); !ok) return tl::unexpected(ok.error());
    } else if (keyword == "POLYGONS" || keyword == "TRIANGLE_STRIPS" || keyword == "LINES" || keyword == "VERTICES") {
      auto read = cells(keyword);
      if (!read) return tl::unexpected(read.error());
      if (keyword == "LINES" || keyword == "VERTICES")
        ignored += read->count();
      else
        surfaces.push_back(std::move(*read));
    } else if (keyword == "METADATA") {
      skipMetadata();
    } else if (keyword == "FIELD") {
      return refuse("a FIELD block before the surface; POINTS, POLYGONS and TRIANGLE_STRIPS are accepted");
    } else {
      return refuse("section " + quotedText(keyword) +
                    " is not known; POINTS, POLYGONS and TRIANGLE_STRIPS are accepted");
    }
  }
  if (raw.vertices.empty()) return fail(ErrorCode::input, fileName_ + ": no POINTS; a surface is expected");
  for (const Cells &c : surfaces)
    if (auto ok = addCells(c, raw); !ok) return tl::unexpected(ok.error());
  if (raw.triangles.empty())
    return fail(ErrorCode::input,
                fmt::format("{}: {} points but no faces (POLYGONS or TRIANGLE_STRIPS); a surface is expected",
                            fileName_, raw.vertices.size()));
  if (ignored) raw.notes.push_back(fmt::format("{} lines and single points of the file were left out", ignored));
  return raw;
}

Expected<RawMesh> VtkParser::grid() {
  RawMesh raw;
  Cells all{"CELLS", {0}, {}};
  std::vector<long long> types;
  while (true) {
    const std::string keyword(token());
    if (keyword.empty() || keyword == "POINT_DATA" || keyword == "CELL_DATA") break;
    if (keyword == "POINTS") {
      if (auto ok = points(raw); !ok) return tl::unexpected(ok.error());
    } else if (keyword == "CELLS") {
      auto read = cells(keyword);
      if (!read) return tl::unexpected(read.error());
      all = std::move(*read);
    } else if (keyword == "CELL_TYPES") {
      const auto n = count("types of cells");
      if (!n) return tl::unexpected(n.error());
      if (auto ok = integers(*n, "int", types); !ok) return tl::unexpected(ok.error());
    } else if (keyword == "METADATA") {
      skipMetadata();
    } else {
      return refuse("section " + quotedText(keyword) + " is not known; POINTS, CELLS and CELL_TYPES are accepted");
    }
  }
  if (types.size() != all.count())
    return fail(ErrorCode::input, fmt::format("{}: {} CELLS with {} CELL_TYPES; one type for each cell is accepted",
                                              fileName_, all.count(), types.size()));
  CellSurface surface;
  const auto named = [&](const Error &error) { return fail(error.code, fileName_ + ": " + error.message); };
  for (std::size_t c = 0; c < all.count(); ++c) {
    const auto corners = cornersOf(all, c, raw);
    if (!corners) return tl::unexpected(corners.error());
    if (auto added = surface.add(types[c], *corners); !added) return named(added.error());
  }
  if (auto done = surface.finish(raw); !done) return named(done.error());
  if (raw.triangles.empty())
    return fail(ErrorCode::input,
                fmt::format("{}: {} points but no cells with a surface", fileName_, raw.vertices.size()));
  return raw;
}

}  // namespace

Expected<RawMesh> readVtk(const std::filesystem::path &path) {
  auto text = readWholeFile(path);
  if (!text) return tl::unexpected(text.error());
  return VtkParser(displayPath(path), *text).run();
}

}  // namespace c3de::geometry
