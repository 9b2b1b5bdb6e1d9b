// SPDX-License-Identifier: Apache-2.0
// VTK's XML files, version 1.0: the arrays follow the description in base64, so that the file is well-formed XML.
#include "c3de/geometry/vtk_writer.h"
#include "c3de/core/file_path.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "base64.h"
#include "c3de/core/output_file.h"
#include "c3de/core/text.h"
#include "check_written.h"
#include "file_text.h"
#include "frame_comment.h"
#include "little_endian.h"

namespace c3de::geometry {
namespace {

std::string xmlText(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out;
}

/// Comments must not contain two consecutive hyphens.
std::string commentText(std::string_view text) {
  std::string out = xmlText(text);
  for (char &c : out)
    if (c == '-') c = '_';
  return out;
}

/// A file being built: elements first, then numbers.
class VtkXml {
 public:
  VtkXml(const char *type, const std::string &title) : type_(type) {
    text_ = fmt::format(
        "<?xml version=\"1.0\"?>\n<!-- {}{}{} -->\n"
        "<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<{}>\n",
        kFrameText, title.empty() ? "" : "; ", commentText(title), type, type);
  }
  void line(const std::string &text) { text_ += text + "\n"; }
  /// @param bytes  the numbers, lowest byte first
  void array(const char *type, std::string_view name, std::size_t components, const std::string &bytes) {
    const std::string count = components == 1 ? "" : fmt::format(" NumberOfComponents=\"{}\"", components);
    text_ += fmt::format("<DataArray type=\"{}\" Name=\"{}\"{} format=\"appended\" offset=\"{}\"/>\n", type,
                         xmlText(name), count, appended_.size());
    std::string block;
    block.reserve(bytes.size() + 8);
    appendLittleEndian(block, static_cast<std::uint64_t>(bytes.size()));
    appended_ += toBase64(block += bytes);
  }
  void points(const std::vector<Vec3> &points) {
    std::string bytes;
    bytes.reserve(24 * points.size());
    for (const Vec3 &p : points)
      for (const double x : p) appendLittleEndian(bytes, x);
    line("<Points>");
    array("Float64", "Points", 3, bytes);
    line("</Points>");
  }
  void pointData(std::span<const PointArray> arrays) {
    line("<PointData>");
    for (const PointArray &a : arrays) {
      std::string bytes;
      bytes.reserve(4 * a.values.size());
      for (const double x : a.values) {
        if (a.type == PointArray::Type::whole)
          appendLittleEndian(bytes, static_cast<std::int32_t>(x));
        else
          appendLittleEndian(bytes, static_cast<float>(x));
      }
      array(a.type == PointArray::Type::whole ? "Int32" : "Float32", a.name, a.components, bytes);
    }
    line("</PointData>");
  }
  /// Cells of `corners` corners each. @param index  returns the point index of a corner of a cell
  template <class Index>
  void cells(const char *element, std::size_t cells, std::size_t corners, Index &&index, bool saysType) {
    std::string connectivity, offsets;
    for (std::size_t c = 0; c < cells; ++c) {
      for (std::size_t k = 0; k < corners; ++k)
        appendLittleEndian(connectivity, static_cast<std::int64_t>(index(c, k)));
      appendLittleEndian(offsets, static_cast<std::int64_t>((c + 1) * corners));
    }
    line(fmt::format("<{}>", element));
    array("Int64", "connectivity", 1, connectivity);
    array("Int64", "offsets", 1, offsets);
    constexpr char kVertex = 1;  // VTK_VERTEX
    if (saysType) array("UInt8", "types", 1, std::string(cells, kVertex));
    line(fmt::format("</{}>", element));
  }
  [[nodiscard]] std::string finished() const {
    return text_ + fmt::format("</{}>\n<AppendedData encoding=\"base64\">\n_", type_) + appended_ +
           "\n</AppendedData>\n</VTKFile>\n";
  }

 private:
  std::string type_, text_, appended_;
};

}  // namespace

Expected<void> writeVtu(const std::filesystem::path &path, const PointCloud &cloud, const std::string &title) {
  if (auto ok = checkRows(path, cloud.points, cloud.arrays); !ok) return ok;
  const std::size_t n = cloud.points.size();
  VtkXml xml("UnstructuredGrid", title);
  xml.line(fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", n, n));
  xml.pointData(cloud.arrays);
  xml.points(cloud.points);
  xml.cells(
      "Cells", n, 1, [](std::size_t cell, std::size_t) { return cell; }, true);
  xml.line("</Piece>");
  return writeWholeFile(path, xml.finished());
}

Expected<void> writeVtp(const std::filesystem::path &path, const TriangleMesh &mesh, std::span<const PointArray> arrays,
                        const std::string &title) {
  if (auto ok = checkRows(path, mesh.vertices, arrays); !ok) return ok;
  if (auto ok = checkTriangles(path, mesh); !ok) return ok;
  const std::size_t points = mesh.vertices.size(), triangles = mesh.triangles.size(),
                    verts = triangles == 0 ? points : 0;
  VtkXml xml("PolyData", title);
  xml.line(
      fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
                  "NumberOfPolys=\"{}\">",
                  points, verts, triangles));
  xml.pointData(arrays);
  xml.points(mesh.vertices);
  xml.cells(
      "Verts", verts, 1, [](std::size_t cell, std::size_t) { return cell; }, false);
  xml.cells(
      "Polys", triangles, 3, [&](std::size_t cell, std::size_t k) { return mesh.triangles[cell][k]; }, false);
  xml.line("</Piece>");
  return writeWholeFile(path, xml.finished());
}

Expected<void> writePvd(const std::filesystem::path &path, std::span<const PvdEntry> entries) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<!-- timestep: seconds; SPACE=LPS UNITS=mm -->\n"
      "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n";
  for (const PvdEntry &entry : entries) {
    text += fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"{}\" file=\"{}\"/>\n", formatNumber(entry.time_s),
                        entry.part, xmlText(genericPathText(entry.file)));
  }
  return writeWholeFile(path, text + "</Collection>\n</VTKFile>\n");
}

}  // namespace c3de::geometry
