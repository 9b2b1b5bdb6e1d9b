// SPDX-License-Identifier: Apache-2.0
#include "formats/image_formats.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "c3de/core/text.h"
#include "formats/packing.h"

namespace c3de::imaging {
namespace {

static_assert(std::endian::native == std::endian::little, "the writers write voxels in memory order");

Vec3 column(const VolumeGeometry &geometry, std::size_t c) {
  const Mat4 &m = geometry.indexToWorld;
  return {m[4 * c], m[4 * c + 1], m[4 * c + 2]};
}

std::string spaced(const std::vector<double> &numbers) {
  std::string text;
  for (const double x : numbers) text += (text.empty() ? "" : " ") + formatNumber(x);
  return text;
}
std::string bracketed(const Vec3 &v) {
  return "(" + formatNumber(v[0]) + "," + formatNumber(v[1]) + "," + formatNumber(v[2]) + ")";
}

const char *nrrdType(Scalar scalar) {
  static constexpr const char *kNames[] = {"int8",   "uint8", "int16",  "uint16", "int32",
                                           "uint32", "int64", "uint64", "float",  "double"};
  return kNames[static_cast<std::size_t>(scalar)];
}
const char *metaType(Scalar scalar) {
  static constexpr const char *kNames[] = {"MET_CHAR", "MET_UCHAR",     "MET_SHORT",      "MET_USHORT", "MET_INT",
                                           "MET_UINT", "MET_LONG_LONG", "MET_ULONG_LONG", "MET_FLOAT",  "MET_DOUBLE"};
  return kNames[static_cast<std::size_t>(scalar)];
}
std::int16_t niftiType(Scalar scalar) {
  static constexpr std::int16_t kCodes[] = {256, 2, 4, 512, 8, 768, 1024, 1280, 16, 64};
  return kCodes[static_cast<std::size_t>(scalar)];
}

/// Rotation as a quaternion b, c, d with the sign of the third axis; columns are perpendicular unit vectors.
std::array<double, 4> quaternionOf(Vec3 i, Vec3 j, Vec3 k) {
  const double turn = dot(i, cross(j, k)) < 0.0 ? -1.0 : 1.0;
  k = turn * k;
  const double r[3][3] = {{i[0], j[0], k[0]}, {i[1], j[1], k[1]}, {i[2], j[2], k[2]}};
  // Largest component first, to avoid division by a small number.
  const double squares[4] = {1 + r[0][0] + r[1][1] + r[2][2], 1 + r[0][0] - r[1][1] - r[2][2],
                             1 - r[0][0] + r[1][1] - r[2][2], 1 - r[0][0] - r[1][1] + r[2][2]};
  std::size_t most = 0;
  for (std::size_t q = 1; q < 4; ++q)
    if (squares[q] > squares[most]) most = q;
  const double s = 2.0 * std::sqrt(std::max(0.0, squares[most]));
  std::array<double, 4> q{};
  if (most == 0) q = {s / 4, (r[2][1] - r[1][2]) / s, (r[0][2] - r[2][0]) / s, (r[1][0] - r[0][1]) / s};
  if (most == 1) q = {(r[2][1] - r[1][2]) / s, s / 4, (r[0][1] + r[1][0]) / s, (r[0][2] + r[2][0]) / s};
  if (most == 2) q = {(r[0][2] - r[2][0]) / s, (r[0][1] + r[1][0]) / s, s / 4, (r[1][2] + r[2][1]) / s};
  if (most == 3) q = {(r[1][0] - r[0][1]) / s, (r[0][2] + r[2][0]) / s, (r[1][2] + r[2][1]) / s, s / 4};
  const double sign = q[0] < 0.0 ? -1.0 : 1.0;
  return {sign * q[1], sign * q[2], sign * q[3], turn};
}

template <class T>
void put(std::string &bytes, std::size_t at, double value) {
  const T number = static_cast<T>(value);
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

/// The header of NIfTI-1, or of NIfTI-2 for more than 32767 voxels along an axis: the same fields at other offsets,
/// some of them larger.
class NiftiHeader {
 public:
  explicit NiftiHeader(const ImageToWrite &image)
      : second_(std::max({image.geometry.size[0], image.geometry.size[1], image.geometry.size[2]}) > 32767),
        bytes_(second_ ? 544 : 352, '\0') {  // the last four bytes state that no extension follows
    put<std::int32_t>(bytes_, 0, second_ ? 540 : 348);
    std::memcpy(bytes_.data() + (second_ ? 4 : 344), second_ ? "n+2\0\r\n\032\n" : "n+1\0", second_ ? 8 : 4);
    writeVoxelType(image);
    writePlace(image.geometry);
  }

  [[nodiscard]] const std::string &bytes() const { return bytes_; }

 private:
  void writeVoxelType(const ImageToWrite &image) {
    const VolumeGeometry &g = image.geometry;
    const bool vector = image.components > 1;
    const double dims[8] = {vector ? 5.0 : 3.0,
                            static_cast<double>(g.size[0]),
                            static_cast<double>(g.size[1]),
                            static_cast<double>(g.size[2]),
                            1.0,
                            static_cast<double>(image.components),
                            1.0,
                            1.0};
    for (std::size_t d = 0; d < 8; ++d) whole(40 + 2 * d, 16 + 8 * d, dims[d]);
    field<std::int16_t, std::int16_t>(70, 12, niftiType(image.scalar));
    field<std::int16_t, std::int16_t>(72, 14, static_cast<double>(8 * bytesOf(image.scalar)));
    code(68, 504, vector ? 1007.0 : image.labels ? 1002.0 : 0.0);
    field<float, std::int64_t>(108, 168, static_cast<double>(bytes_.size()));
    real(112, 176, image.slope);
    real(116, 184, image.intercept);
    field<std::int8_t, std::int32_t>(123, 500, 2);  // millimetres
  }

  void writePlace(const VolumeGeometry &g) {
    std::array<Vec3, 4> c;
    for (std::size_t a = 0; a < 4; ++a) {
      const Vec3 lps = column(g, a);
      c[a] = {-lps[0] + 0.0, -lps[1] + 0.0, lps[2]};
    }
    const Vec3 spacing = g.spacing();
    real(76, 104, 1.0);
    for (std::size_t a = 0; a < 3; ++a) real(80 + 4 * a, 112 + 8 * a, spacing[a]);
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t a = 0; a < 4; ++a) real(280 + 16 * row + 4 * a, 400 + 32 * row + 8 * a, c[a][row]);
    code(254, 348, 1.0);
    if (!(g.shear() < 1e-5)) return;  // a qform can only store rotations
    const auto q = quaternionOf((1.0 / spacing[0]) * c[0], (1.0 / spacing[1]) * c[1], (1.0 / spacing[2]) * c[2]);
    real(76, 104, q[3]);
    for (std::size_t a = 0; a < 3; ++a) real(256 + 4 * a, 352 + 8 * a, q[a]);
    for (std::size_t a = 0; a < 3; ++a) real(268 + 4 * a, 376 + 8 * a, c[3][a]);
    code(252, 344, 1.0);
  }

  /// Writes a field at its offset in NIfTI-1 or in NIfTI-2.
  template <class First, class Second>
  void field(std::size_t first, std::size_t second, double value) {
    if (second_)
      put<Second>(bytes_, second, value);
    else
      put<First>(bytes_, first, value);
  }
  void whole(std::size_t first, std::size_t second, double value) {
    field<std::int16_t, std::int64_t>(first, second, value);
  }
  void real(std::size_t first, std::size_t second, double value) { field<float, double>(first, second, value); }
  void code(std::size_t first, std::size_t second, double value) {
    field<std::int16_t, std::int32_t>(first, second, value);
  }

  bool second_;
  std::string bytes_;
};

}  // namespace

Expected<std::string> nrrdFile(const ImageToWrite &image) {
  const VolumeGeometry &g = image.geometry;
  const bool vector = image.components > 1;
  std::string text =
      "NRRD0005\ntype: " + std::string(nrrdType(image.scalar)) + "\ndimension: " + (vector ? "4" : "3") +
      "\nspace: left-posterior-superior\nsizes: " + (vector ? std::to_string(image.components) + " " : "") +
      std::to_string(g.size[0]) + " " + std::to_string(g.size[1]) + " " + std::to_string(g.size[2]) +
      "\nspace directions: " + (vector ? "none " : "");
  text += bracketed(column(g, 0)) + " " + bracketed(column(g, 1)) + " " + bracketed(column(g, 2));
  text += "\nkinds: " + std::string(vector ? "vector " : "") +
          "domain domain domain\nendian: little\nencoding: gzip\nspace units: \"mm\" \"mm\" \"mm\"\nspace origin: " +
          bracketed(column(g, 3)) + "\n";
  for (const auto &[key, value] : image.keys) text += key + ":=" + value + "\n";
  return text + "\n" + packed(image.voxels, Packing::gzip);
}

Expected<std::string> metaFile(const ImageToWrite &image) {
  const VolumeGeometry &g = image.geometry;
  const Vec3 spacing = g.spacing();
  std::vector<double> matrix, origin;
  for (std::size_t a = 0; a < 3; ++a)
    for (const double x : column(g, a)) matrix.push_back(x / spacing[a]);
  for (const double x : column(g, 3)) origin.push_back(x);
  const std::string zipped = packed(image.voxels, Packing::zlib);
  std::string text =
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = "
      "True\nCompressedDataSize = " +
      std::to_string(zipped.size()) + "\nTransformMatrix = " + spaced(matrix) + "\nOffset = " + spaced(origin) +
      "\nCenterOfRotation = 0 0 0\nElementSpacing = " + spaced({spacing[0], spacing[1], spacing[2]}) +
      "\nDimSize = " + std::to_string(g.size[0]) + " " + std::to_string(g.size[1]) + " " + std::to_string(g.size[2]) +
      "\n";
  if (image.components > 1) text += "ElementNumberOfChannels = " + std::to_string(image.components) + "\n";
  return text + "ElementType = " + metaType(image.scalar) + "\nElementDataFile = LOCAL\n" + zipped;
}

Expected<std::string> niftiFile(const ImageToWrite &image) {
  std::string bytes = NiftiHeader(image).bytes();
  if (image.components < 2) return bytes + std::string(image.voxels);
  // The components of a NIfTI vector are stored as consecutive volumes.
  const std::size_t header = bytes.size(), each = bytesOf(image.scalar), n = image.geometry.voxelCount();
  bytes.resize(header + image.voxels.size());
  for (std::size_t a = 0; a < image.components; ++a)
    for (std::size_t v = 0; v < n; ++v)
      std::memcpy(bytes.data() + header + (a * n + v) * each, image.voxels.data() + (v * image.components + a) * each,
                  each);
  return bytes;
}

}  // namespace c3de::imaging
