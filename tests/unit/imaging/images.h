// SPDX-License-Identifier: Apache-2.0
// Images, files and comparisons that several cases share.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "c3de/imaging/reading.h"
#include "support/catch.h"

namespace images {

using namespace c3de;
using namespace c3de::imaging;

inline std::string bytesOf(const std::filesystem::path &file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
inline std::filesystem::path write(const std::filesystem::path &file, const std::string &bytes) {
  std::filesystem::create_directories(file.parent_path());
  std::filesystem::remove(file);  // ext4 waits for the disk when a file is truncated and rewritten
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file;
}
/// The present case's folder, emptied.
inline std::filesystem::path emptyFolder(const std::string &name) {
  const auto folder = testOutputFolder() / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}
inline std::vector<std::filesystem::path> filesOf(const std::filesystem::path &folder) {
  std::vector<std::filesystem::path> all;
  for (const auto &entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  return all;
}
/// A copy that can be changed and removed, whatever the permissions of the file.
inline void copyFile(const std::filesystem::path &from, const std::filesystem::path &to) {
  std::filesystem::copy_file(from, to);
  std::filesystem::permissions(to, std::filesystem::perms::owner_write, std::filesystem::perm_options::add);
}
/// The bytes with one text replaced by another of the same length; the case fails where it does not occur.
inline std::string patched(std::string bytes, const std::string &from, const std::string &to) {
  REQUIRE(from.size() == to.size());
  REQUIRE(bytes.find(from) != std::string::npos);
  for (std::size_t at = 0; (at = bytes.find(from, at)) != std::string::npos; at += to.size())
    bytes.replace(at, from.size(), to);
  return bytes;
}

inline bool says(const std::vector<std::string> &notices, const std::string &text) {
  return std::any_of(notices.begin(), notices.end(),
                     [&](const std::string &notice) { return notice.find(text) != std::string::npos; });
}

inline Vec3 last(const VolumeGeometry &g) {
  return {static_cast<double>(g.size[0] - 1), static_cast<double>(g.size[1] - 1), static_cast<double>(g.size[2] - 1)};
}
/// Within 1e-3 mm, the project's requirement for every reader.
inline void checkAt(const Vec3 &found, const Vec3 &expected) {
  CAPTURE(found[0], found[1], found[2], expected[0], expected[1], expected[2]);
  CHECK(norm(found - expected) < 1e-3);
}
inline std::pair<double, double> rangeOf(const Volume &volume) {
  double lo = 1e300, hi = -1e300;
  std::visit(
      [&](const auto &all) {
        for (const auto v : all) lo = std::min(lo, static_cast<double>(v)), hi = std::max(hi, static_cast<double>(v));
      },
      volume.voxels);
  return {volume.slope * lo + volume.intercept, volume.slope * hi + volume.intercept};
}

/// Oblique in all three axes, sheared, left-handed, uneven spacing, far from the origin.
inline VolumeGeometry awkwardGeometry(bool sheared) {
  VolumeGeometry g;
  g.size = {5, 4, 3};
  const Vec3 i{0.36, 0.48, -0.8}, j{-0.8, 0.6, 0.0}, k = -1.0 * cross(i, j);
  const Vec3 a = 0.7 * i, b = 1.3 * j, c = 2.5 * k + (sheared ? 0.4 : 0.0) * j;
  g.indexToWorld = {a[0], a[1], a[2], 0, b[0], b[1], b[2], 0, c[0], c[1], c[2], 0, -123.456, 78.9, -1011.25, 1};
  return g;
}

}  // namespace images
