// SPDX-License-Identifier: Apache-2.0
// VTK's XML files of surfaces (.vtp) and of cells (.vtu, of which the outer surface is used): text, base64 and raw
// arrays, inline or appended, uncompressed or compressed with zlib.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>

#include "base64.h"
#include "cell_surface.h"
#include "file_text.h"
#include "raw_mesh.h"
#include "vtk_blocks.h"
#include "xml_scan.h"

namespace c3de::geometry {
namespace {

struct Array {
  std::string type, format, text;
  std::size_t components = 1, offset = 0;
};

struct Piece {
  std::size_t pointCount = 0;
  std::map<std::string, std::map<std::string, Array>> arrays;  ///< by section ("Points", "Polys", …), then by name
};

bool isSection(const std::string &name) {
  return name == "Points" || name == "Polys" || name == "Strips" || name == "Cells";
}

std::size_t bytesOf(const std::string &type) {
  if (type == "Int8" || type == "UInt8") return 1;
  if (type == "Int16" || type == "UInt16") return 2;
  if (type == "Int32" || type == "UInt32" || type == "Float32") return 4;
  if (type == "Int64" || type == "UInt64" || type == "Float64") return 8;
  return 0;
}

class VtpParser {
 public:
  VtpParser(std::string fileName, std::string_view text) : fileName_(std::move(fileName)), text_(text) {}
  Expected<RawMesh> run();

 private:
  [[nodiscard]] tl::unexpected<Error> refuse(const std::string &what) const {
    return fail(ErrorCode::input, fileName_ + ": " + what);
  }
  Expected<void> scan();
  Expected<std::string> bytes(const Array &array, const std::string &what) const;
  Expected<std::vector<double>> numbers(const Array &array, const std::string &what) const;
  /// Adds the faces of a section to the mesh, or its cells to a cell surface.
  Expected<void> addFaces(const Piece &piece, const std::string &section, std::size_t first, RawMesh &raw,
                          CellSurface &surface) const;
  [[nodiscard]] std::uint64_t word(const unsigned char *p, std::size_t size) const;

  std::string fileName_;
  std::string_view text_, appended_;
  std::vector<Piece> pieces_;
  std::size_t headerBytes_ = 4;
  bool isBigEndian_ = false, isAppendedRaw_ = false, isPacked_ = false;
};

Expected<void> VtpParser::scan() {
  XmlScan xml(text_);
  std::string section;
  bool isOpen = false;
  while (true) {
    const XmlScan::Tag tag = xml.next();
    if (tag.kind == XmlScan::Kind::broken) return refuse(fmt::format("not XML any more at byte {}", xml.position()));
    if (tag.kind == XmlScan::Kind::end)
      return isOpen ? Expected<void>{} : refuse("no <VTKFile> in it; is this a VTP or VTU file?");
    if (tag.name == "VTKFile" && tag.kind == XmlScan::Kind::open) {
      if (tag.get("type") != "PolyData" && tag.get("type") != "UnstructuredGrid")
        return refuse("dataset " + quotedText(tag.get("type")) +
                      "; PolyData (a surface) and UnstructuredGrid (cells) are accepted");
      isPacked_ = !tag.get("compressor").empty();
      if (isPacked_ && tag.get("compressor") != "vtkZLibDataCompressor")
        return refuse("the arrays are compressed by " + quotedText(tag.get("compressor")) +
                      "; vtkZLibDataCompressor and none are accepted");
      if (const std::string type = tag.get("header_type", "UInt32"); type != "UInt32" && type != "UInt64")
        return refuse("header_type " + quotedText(type) + "; UInt32 and UInt64 are accepted");
      isBigEndian_ = tag.get("byte_order") == "BigEndian";
      headerBytes_ = tag.get("header_type") == "UInt64" ? 8 : 4;
      isOpen = true;
    } else if (tag.name == "Piece" && tag.kind == XmlScan::Kind::open) {
      long long points = 0;
      if (!parseInteger(tag.get("NumberOfPoints"), points) || points < 0)
        return refuse("NumberOfPoints " + quotedText(tag.get("NumberOfPoints")) + " is not a number");
      pieces_.push_back({static_cast<std::size_t>(points), {}});
    } else if (tag.name == "AppendedData" && tag.kind == XmlScan::Kind::open) {
      isAppendedRaw_ = tag.get("encoding") == "raw";
      const std::string_view rest = xml.rest();
      const std::size_t begin = rest.find('_');
      if (begin == std::string_view::npos) return refuse("<AppendedData> without the '_' before its data");
      appended_ = rest.substr(begin + 1);
      return {};
    } else if (isSection(tag.name)) {
      section = tag.kind == XmlScan::Kind::open ? tag.name : "";
    } else if (tag.name == "DataArray" && !section.empty() && tag.kind != XmlScan::Kind::close && !pieces_.empty()) {
      Array array{tag.get("type"), tag.get("format", "ascii"), {}, 1, 0};
      long long components = 1, offset = 0;
      if (!parseInteger(tag.get("NumberOfComponents", "1"), components) || components < 1 || components > 1000 ||
          !parseInteger(tag.get("offset", "0"), offset) || offset < 0)
        return refuse("an array of <" + section + "> whose components or offset is not a number");
      array.components = static_cast<std::size_t>(components);
      array.offset = static_cast<std::size_t>(offset);
      if (tag.kind == XmlScan::Kind::open) array.text = std::string(xml.textHere());
      pieces_.back().arrays[section][section == "Points" ? "Points" : tag.get("Name")] = std::move(array);
    }
  }
}

std::uint64_t VtpParser::word(const unsigned char *p, std::size_t size) const {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value |= std::uint64_t{p[isBigEndian_ ? size - 1 - i : i]} << (8 * i);
  return value;
}

/// The bytes after the header that states their number.
Expected<std::string> VtpParser::bytes(const Array &array, const std::string &what) const {
  const auto cut = [&] { return refuse("the file ends before the array " + what + " does"); };
  std::string_view source = array.text;
  if (array.format == "appended") {
    if (array.offset > appended_.size()) return cut();
    source = appended_.substr(array.offset);
  } else if (array.format != "binary") {
    return refuse("format " + quotedText(array.format) + " of the array " + what +
                  "; ascii, binary and appended are accepted");
  }
  const bool isRaw = array.format == "appended" && isAppendedRaw_;
  const auto lengthIn = [&](std::string_view head) {
    return word(reinterpret_cast<const unsigned char *>(head.data()), headerBytes_);
  };
  if (array.format == "binary") source.remove_prefix(std::min(source.find_first_not_of(" \t\r\n"), source.size()));
  if (isPacked_) {
    auto all = unpacked({source, !isRaw, headerBytes_, isBigEndian_});
    if (!all) return refuse("the packed array " + what + " cannot be read: " + all.error().message);
    return all;
  }
  if (isRaw) {
    if (source.size() < headerBytes_) return cut();
    const std::uint64_t length = lengthIn(source);
    if (length > source.size() - headerBytes_) return cut();
    return std::string(source.substr(headerBytes_, static_cast<std::size_t>(length)));
  }
  // Header and data are one block, or two with padding between them.
  const std::size_t headDigits = (headerBytes_ + 2) / 3 * 4;
  const auto head = fromBase64(source.substr(0, headDigits));
  if (!head || head->size() < headerBytes_) return cut();
  const std::uint64_t length = lengthIn(*head);
  if (length > source.size()) return cut();
  const bool areTwo = source.substr(0, headDigits).ends_with('=');
  const std::size_t digits = areTwo ? headDigits + (static_cast<std::size_t>(length) + 2) / 3 * 4
                                    : (headerBytes_ + static_cast<std::size_t>(length) + 2) / 3 * 4;
  const auto all = fromBase64(source.substr(0, digits));
  if (!all || all->size() < headerBytes_ + length) return cut();
  return all->substr(headerBytes_, static_cast<std::size_t>(length));
}

Expected<std::vector<double>> VtpParser::numbers(const Array &array, const std::string &what) const {
  std::vector<double> out;
  if (array.format == "ascii") {
    std::string_view rest = array.text;
    while (true) {
      const std::size_t begin = rest.find_first_not_of(" \t\r\n");
      if (begin == std::string_view::npos) return out;
      const std::size_t end = std::min(rest.find_first_of(" \t\r\n", begin), rest.size());
      double value = 0.0;
      if (parseNumber(rest.substr(begin, end - begin), value) != NumberState::ok)
        return refuse(quotedText(rest.substr(begin, end - begin)) + " in the array " + what +
                      " is not a finite number");
      out.push_back(value);
      rest.remove_prefix(end);
    }
  }
  const std::size_t size = bytesOf(array.type);
  if (size == 0)
    return refuse("type " + quotedText(array.type) + " of the array " + what +
                  "; Float32, Float64 and whole numbers are accepted");
  const auto data = bytes(array, what);
  if (!data) return tl::unexpected(data.error());
  out.reserve(data->size() / size);
  for (std::size_t at = 0; at + size <= data->size(); at += size) {
    const std::uint64_t bits = word(reinterpret_cast<const unsigned char *>(data->data()) + at, size);
    if (array.type == "Float32")
      out.push_back(static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits))));
    else if (array.type == "Float64")
      out.push_back(std::bit_cast<double>(bits));
    else if (array.type[0] == 'U')
      out.push_back(static_cast<double>(bits));
    else {
      const std::size_t shift = 64 - 8 * size;
      out.push_back(static_cast<double>(static_cast<std::int64_t>(bits << shift) >> shift));
    }
  }
  return out;
}

Expected<void> VtpParser::addFaces(const Piece &piece, const std::string &section, std::size_t first, RawMesh &raw,
                                   CellSurface &surface) const {
  const auto found = piece.arrays.find(section);
  if (found == piece.arrays.end()) return {};
  const auto connectivityAt = found->second.find("connectivity"), offsetsAt = found->second.find("offsets");
  if (connectivityAt == found->second.end() || offsetsAt == found->second.end()) return {};
  const auto corners = numbers(connectivityAt->second, "connectivity of " + section);
  if (!corners) return tl::unexpected(corners.error());
  const auto ends = numbers(offsetsAt->second, "offsets of " + section);
  if (!ends) return tl::unexpected(ends.error());
  std::vector<double> types;
  if (section == "Cells") {
    const auto typesAt = found->second.find("types");
    if (typesAt == found->second.end()) return refuse("<Cells> without the array types");
    auto read = numbers(typesAt->second, "types of Cells");
    if (!read) return tl::unexpected(read.error());
    types = std::move(*read);
    if (types.size() != ends->size())
      return refuse(
          fmt::format("{} cells with {} types; one type for each cell is accepted", ends->size(), types.size()));
  }
  double begin = 0.0;
  std::vector<unsigned> face;
  for (std::size_t c = 0; c < ends->size(); ++c) {
    const double end = (*ends)[c];
    if (!(end >= begin) || end > static_cast<double>(corners->size()))
      return refuse(fmt::format("offset {} of cell {} in {} is out of order; up to {} ascending is accepted", end, c,
                                section, corners->size()));
    face.clear();
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const double index = (*corners)[i];
      if (!(index >= 0.0) || index >= static_cast<double>(piece.pointCount))
        return refuse(fmt::format("{} {}: point index {} is out of range; there are {} points", section, c, index,
                                  piece.pointCount));
      face.push_back(static_cast<unsigned>(first + static_cast<std::size_t>(index)));
    }
    begin = end;
    if (section == "Cells") {
      if (auto added = surface.add(types[c] < 256.0 ? static_cast<long long>(types[c]) : -1, face); !added)
        return refuse(added.error().message);
      continue;
    }
    if (section == "Strips") {
      if (face.size() < 3) ++raw.facesDropped;
      for (std::size_t i = 0; i + 2 < face.size(); ++i)
        raw.triangles.push_back(i % 2 ? Triangle{face[i + 1], face[i], face[i + 2]}
                                      : Triangle{face[i], face[i + 1], face[i + 2]});
      continue;
    }
    if (face.size() > kMaxFaceCorners || !addFace(raw, face))
      return refuse(fmt::format("{} {} has {} corners; up to {} are accepted, up to 4096 if it is concave", section, c,
                                face.size(), kMaxFaceCorners));
  }
  return {};
}

Expected<RawMesh> VtpParser::run() {
  if (auto ok = scan(); !ok) return tl::unexpected(ok.error());
  RawMesh raw;
  CellSurface surface;
  for (const Piece &piece : pieces_) {
    const auto points = piece.arrays.find("Points");
    if (piece.pointCount == 0 || points == piece.arrays.end()) continue;
    const Array &array = points->second.at("Points");
    if (array.components != 3)
      return refuse(fmt::format("points with {} components; 3 are expected", array.components));
    const auto values = numbers(array, "Points");
    if (!values) return tl::unexpected(values.error());
    if (values->size() / 3 != piece.pointCount || values->size() % 3 != 0)
      return refuse(fmt::format("{} coordinates for {} points", values->size(), piece.pointCount));
    const std::size_t first = raw.vertices.size();
    if (first + piece.pointCount > 0xfffffffeu) return refuse("more than 4294967294 points");
    for (std::size_t i = 0; i < piece.pointCount; ++i) {
      const Vec3 p{(*values)[3 * i], (*values)[3 * i + 1], (*values)[3 * i + 2]};
      for (std::size_t k = 0; k < 3; ++k)
        if (!std::isfinite(p[k]))
          return refuse(fmt::format("{} coordinate {} of point {} is not finite", "xyz"[k], p[k], i));
      raw.vertices.push_back(p);
    }
    for (const char *section : {"Polys", "Strips", "Cells"})
      if (auto ok = addFaces(piece, section, first, raw, surface); !ok) return tl::unexpected(ok.error());
  }
  if (auto done = surface.finish(raw); !done) return refuse(done.error().message);
  if (raw.triangles.empty())
    return refuse(
        fmt::format("{} points but no faces (Polys, Strips or Cells); a surface is expected", raw.vertices.size()));
  return raw;
}

}  // namespace

Expected<RawMesh> readVtp(const std::filesystem::path &path) {
  auto text = readWholeFile(path);
  if (!text) return tl::unexpected(text.error());
  return VtpParser(displayPath(path), *text).run();
}

}  // namespace c3de::geometry
