// SPDX-License-Identifier: Apache-2.0
// VTP with arrays packed by vtkZLibDataCompressor. The files are generated here by VTK's description of the format.
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "c3de/geometry/mesh_io.h"
#include "shapes.h"
#include "support/catch.h"
#include "test_files.h"

using namespace c3de;
using namespace c3de::geometry;

namespace {

constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
std::string base64(const std::string &bytes) {
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kDigits[bits >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

struct Style {
  bool isAppended = false, isBase64 = true;
  std::size_t wordBytes = 4;
  std::size_t blockBytes = 32768;
};

template <class T>
std::string bytesOf(const std::vector<T> &all) {
  return {reinterpret_cast<const char *>(all.data()), all.size() * sizeof(T)};
}

std::string words(const std::vector<std::uint64_t> &numbers, std::size_t wordBytes) {
  std::string out;
  for (const std::uint64_t n : numbers)
    for (std::size_t b = 0; b < wordBytes; ++b) out += static_cast<char>(n >> (8 * b) & 255u);
  return out;
}

/// Header and blocks of an array.
std::string packed(const std::string &bytes, const Style &style) {
  std::vector<std::uint64_t> head{0, style.blockBytes, bytes.size() % style.blockBytes};
  std::string blocks;
  for (std::size_t at = 0; at < bytes.size(); at += style.blockBytes, ++head[0]) {
    const std::string block = bytes.substr(at, style.blockBytes);
    std::string out(compressBound(static_cast<uLong>(block.size())), '\0');
    uLongf length = static_cast<uLongf>(out.size());
    REQUIRE(compress(reinterpret_cast<Bytef *>(out.data()), &length, reinterpret_cast<const Bytef *>(block.data()),
                     static_cast<uLong>(block.size())) == Z_OK);
    head.push_back(length);
    blocks += out.substr(0, length);
  }
  const std::string header = words(head, style.wordBytes);
  return style.isBase64 ? base64(header) + base64(blocks) : header + blocks;
}

/// A ball as VTK writes it with its default compressor.
std::string fileOf(const TriangleMesh &mesh, const Style &style) {
  std::vector<float> points;
  for (const Vec3 &p : mesh.vertices)
    for (const double x : p) points.push_back(static_cast<float>(x));
  std::vector<std::int64_t> corners, ends;
  for (const Triangle &t : mesh.triangles) {
    for (const auto v : t) corners.push_back(v);
    ends.push_back(static_cast<std::int64_t>(corners.size()));
  }
  std::string appended;
  const auto array = [&](const char *type, const char *name, int components, const std::string &bytes) {
    std::string tag = std::string("<DataArray type=\"") + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                      std::to_string(components) + "\" format=\"";
    if (!style.isAppended) return tag + "binary\">\n          " + packed(bytes, style) + "\n        </DataArray>\n";
    tag += "appended\" offset=\"" + std::to_string(appended.size()) + "\"/>\n";
    appended += packed(bytes, style);
    return tag;
  };
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"" +
      std::string(style.wordBytes == 8 ? "UInt64" : "UInt32") +
      "\" compressor=\"vtkZLibDataCompressor\">\n<PolyData>\n<Piece NumberOfPoints=\"" +
      std::to_string(mesh.vertices.size()) +
      "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
      std::to_string(mesh.triangles.size()) + "\">\n<Points>\n" + array("Float32", "Points", 3, bytesOf(points)) +
      "</Points>\n<Verts>\n" + array("Int64", "connectivity", 1, "") + array("Int64", "offsets", 1, "") +
      "</Verts>\n<Polys>\n" + array("Int64", "connectivity", 1, bytesOf(corners)) +
      array("Int64", "offsets", 1, bytesOf(ends)) + "</Polys>\n</Piece>\n</PolyData>\n";
  if (style.isAppended)
    text += std::string("<AppendedData encoding=\"") + (style.isBase64 ? "base64" : "raw") + "\">\n_" + appended +
            "\n</AppendedData>\n";
  return text + "</VTKFile>\n";
}

const std::vector<Style> kStyles{{false, true, 4, 32768},
                                 {false, true, 8, 100},
                                 {true, true, 4, 1000},
                                 {true, false, 4, 32768},
                                 {true, false, 8, 96}};

}  // namespace

TEST_CASE("VTP files packed with zlib are read, in place and appended, in one block and in many", "[vtp]") {
  const TriangleMesh ball = shapes::sphere({1, 2, 3}, 10.0, 2);
  for (const Style &style : kStyles) {
    CAPTURE(style.isAppended, style.isBase64, style.wordBytes, style.blockBytes);
    const auto loaded = loadMesh(test_files::write("packed.vtp", fileOf(ball, style)), std::nullopt);
    if (!loaded) FAIL(loaded.error().message);
    REQUIRE(loaded->mesh.vertices.size() == ball.vertices.size());
    REQUIRE(loaded->mesh.triangles.size() == ball.triangles.size());
    CHECK(loaded->report.closed);
    double most = 0.0;
    for (std::size_t v = 0; v < ball.vertices.size(); ++v)
      most = std::max(most, norm(loaded->mesh.vertices[v] - ball.vertices[v]));
    CHECK(most < 1e-5);  // single precision
  }
}

TEST_CASE("Packed VTP files that are cut, changed or hostile are refused, and take no memory for what they claim",
          "[vtp]") {
  const TriangleMesh ball = shapes::sphere({1, 2, 3}, 10.0, 1);
  const auto refusal = [](const std::string &text) -> std::string {
    const auto loaded = loadMesh(test_files::write("bad.vtp", text), std::nullopt);
    if (loaded) return "was accepted";
    CHECK(loaded.error().code == ErrorCode::input);
    CHECK_THAT(loaded.error().message, Contains("bad.vtp"));
    return loaded.error().message;
  };
  std::mt19937 random(17);
  for (const Style &style : kStyles) {
    const std::string whole = fileOf(ball, style);
    const std::size_t end = style.isAppended ? whole.size() - 40 : whole.rfind("</DataArray>") - 12;
    for (std::size_t length = whole.size() / 2; length < end; length += 1 + whole.size() / 60) {
      CAPTURE(length, whole.size());
      CHECK_THAT(refusal(whole.substr(0, length)), !Contains("was accepted"));
    }
    for (int n = 0; n < 200; ++n) {
      std::string hurt = whole;
      for (int changes = 0; changes < 3; ++changes)
        hurt[std::uniform_int_distribution<std::size_t>(300, hurt.size() - 1)(random)] = static_cast<char>(random());
      const auto loaded = loadMesh(test_files::write("bad.vtp", hurt), std::nullopt);
      CHECK((loaded || !loaded.error().message.empty()));
    }
  }
  const auto with = [&](const std::vector<std::uint64_t> &head, std::size_t wordBytes, bool isBase64) {
    const std::string header = words(head, wordBytes), data = isBase64 ? base64(header) : header;
    return "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\" header_type=\"" +
           std::string(wordBytes == 8 ? "UInt64" : "UInt32") +
           "\" compressor=\"vtkZLibDataCompressor\"><PolyData><Piece NumberOfPoints=\"4\"><Points><DataArray "
           "type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/>"
           "</Points></Piece></PolyData><AppendedData encoding=\"" +
           (isBase64 ? "base64" : "raw") + "\">_" + data + "</AppendedData></VTKFile>";
  };
  const std::uint64_t huge = ~std::uint64_t{0};
  for (const bool isBase64 : {false, true}) {
    CHECK_THAT(refusal(with({huge, 1, 1, 1}, 8, isBase64)), Contains("blocks, more than the file holds"));
    CHECK_THAT(refusal(with({huge / 8, 1, 1, 1}, 8, isBase64)), Contains("blocks, more than the file holds"));
    CHECK_THAT(refusal(with({0xffffffffu, 1, 1, 1}, 4, isBase64)), Contains("blocks, more than the file holds"));
    CHECK_THAT(refusal(with({1, huge, 0, 8}, 8, isBase64)), Contains("which the file cannot hold"));
    CHECK_THAT(refusal(with({1, huge, huge, huge}, 8, isBase64)), Contains("which the file cannot hold"));
    CHECK_THAT(refusal(with({2, 0xfffffff0u, 8, 20, 20}, 4, isBase64)), Contains("which the file cannot hold"));
    CHECK_THAT(refusal(with({3, 48}, 4, isBase64)), Contains("packed array Points cannot be read"));
    CHECK_THAT(refusal(with({1, 48, 0, 40}, 4, isBase64)), Contains("ends too early") || Contains("damaged"));
  }
  const std::string whole = fileOf(ball, kStyles[0]);
  std::string other = whole;
  other.replace(other.find("vtkZLibDataCompressor"), 21, "vtkLZ4DataCompressor");
  CHECK_THAT(refusal(other), Contains("'vtkLZ4DataCompressor'") && Contains("vtkZLibDataCompressor and none"));
}
