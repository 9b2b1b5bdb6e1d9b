// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/mesh_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "c3de/core/output_file.h"
#include "c3de/core/text.h"
#include "c3de/geometry/vtk_writer.h"
#include "check_written.h"
#include "file_text.h"
#include "frame_comment.h"
#include "little_endian.h"

namespace c3de::geometry {
namespace {

constexpr std::array<std::string_view, 4> kWritable{".obj", ".stl", ".ply", ".vtp"};

/// The frame and the title in one line.
std::string headLine(const std::string &title) {
  std::string line(kFrameText);
  if (!title.empty()) line += "; " + title;
  for (char &c : line)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return line;
}

std::string objText(const TriangleMesh &mesh, const std::string &title) {
  std::string text = "# " + headLine(title) + "\n";
  for (const Vec3 &v : mesh.vertices)
    text += "v " + formatNumber(v[0]) + " " + formatNumber(v[1]) + " " + formatNumber(v[2]) + "\n";
  for (const Triangle &t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

Expected<std::string> stlBytes(const std::filesystem::path &path, const TriangleMesh &mesh, const std::string &title) {
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max())
    return fail(ErrorCode::state, displayPath(path) + ": not written: STL counts no more than 4294967295 triangles");
  // The first word of a text STL is "solid"; this head does not begin with it.
  std::string out = headLine(title);
  out.resize(80, ' ');
  out.reserve(84 + 50 * mesh.triangles.size());
  appendLittleEndian(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle &t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vec3 area = cross(b - a, c - a);
    const double length = norm(area);
    const Vec3 normal = length > 0.0 ? (1.0 / length) * area : Vec3{};
    for (const Vec3 *v : {&normal, &a, &b, &c})
      for (const double x : *v) appendLittleEndian(out, static_cast<float>(x));
    appendLittleEndian(out, std::uint16_t{0});
  }
  return out;
}

/// "stress_vm [Pa]" as one word for PLY: "stress_vm_Pa".
std::string plyName(const std::string &name) {
  std::string out;
  for (const char c : name) {
    const bool isPlain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (isPlain)
      out.push_back(c);
    else if (!out.empty() && out.back() != '_')
      out.push_back('_');
  }
  while (!out.empty() && out.back() == '_') out.pop_back();
  return out;
}

std::string plyComponent(const PointArray &array, std::size_t k) {
  const std::string name = plyName(array.name);
  if (array.components == 1) return name;
  return array.components == 3 ? name + "_" + "xyz"[k] : name + "_" + std::to_string(k);
}

std::string plyBytes(const TriangleMesh &mesh, const MeshWriteOptions &options) {
  std::string out = "ply\nformat binary_little_endian 1.0\ncomment " + headLine(options.title) + "\n";
  out +=
      fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty double z\n", mesh.vertices.size());
  for (const PointArray &array : options.arrays)
    for (std::size_t k = 0; k < array.components; ++k)
      out += fmt::format("property {} {}\n", array.type == PointArray::Type::whole ? "int" : "float",
                         plyComponent(array, k));
  out += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.triangles.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (const double x : mesh.vertices[v]) appendLittleEndian(out, x);
    for (const PointArray &array : options.arrays)
      for (std::size_t k = 0; k < array.components; ++k) {
        const double x = array.values[v * array.components + k];
        if (array.type == PointArray::Type::whole)
          appendLittleEndian(out, static_cast<std::int32_t>(x));
        else
          appendLittleEndian(out, static_cast<float>(x));
      }
  }
  for (const Triangle &t : mesh.triangles) {
    out.push_back(3);
    for (const unsigned v : t) appendLittleEndian(out, static_cast<std::int32_t>(v));
  }
  return out;
}

}  // namespace

std::span<const std::string_view> writableMeshExtensions() { return kWritable; }

Expected<void> writeMesh(const std::filesystem::path &path, const TriangleMesh &mesh, const MeshWriteOptions &options) {
  const std::string extension = lowerExtension(path);
  if (std::find(kWritable.begin(), kWritable.end(), extension) == kWritable.end())
    return fail(ErrorCode::usage,
                fmt::format("{}: surfaces with the extension {} cannot be written; accepted: {}", displayPath(path),
                            extension.empty() ? "'' (none)" : quotedText(extension), fmt::join(kWritable, ", ")));
  if (mesh.triangles.empty())
    return fail(ErrorCode::state, displayPath(path) + ": not written: the surface has no triangles");
  if (auto ok = checkTriangles(path, mesh); !ok) return ok;
  if (auto ok = checkRows(path, mesh.vertices, options.arrays); !ok) return ok;
  if (extension == ".vtp") return writeVtp(path, mesh, options.arrays, options.title);
  if (extension == ".ply") return writeWholeFile(path, plyBytes(mesh, options));
  if (extension == ".obj") return writeWholeFile(path, objText(mesh, options.title));
  const auto stl = stlBytes(path, mesh, options.title);
  if (!stl) return tl::unexpected(stl.error());
  return writeWholeFile(path, *stl);
}

}  // namespace c3de::geometry
