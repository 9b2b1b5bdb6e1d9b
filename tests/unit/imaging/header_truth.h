// SPDX-License-Identifier: Apache-2.0
// A second reading of image headers, which shares no code with the readers under test: the expected voxel positions.
#pragma once

#include <zlib.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "c3de/core/vec.h"

namespace header_truth {

struct ReferenceSolution {
  std::array<std::size_t, 3> size{1, 1, 1};
  // Rows of x, y, z in LPS: three factors of the index and the origin.
  double m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  [[nodiscard]] c3de::Vec3 at(double i, double j, double k) const {
    c3de::Vec3 p;
    for (std::size_t r = 0; r < 3; ++r) p[r] = m[r][0] * i + m[r][1] * j + m[r][2] * k + m[r][3];
    return p;
  }
};

/// The first bytes, whether the file is compressed or not.
inline std::vector<unsigned char> head(const std::filesystem::path &file, unsigned bytes) {
  std::vector<unsigned char> all(bytes);
  gzFile in = gzopen(file.string().c_str(), "rb");
  const int got = in ? gzread(in, all.data(), bytes) : 0;
  if (in) gzclose(in);
  all.resize(static_cast<std::size_t>(got > 0 ? got : 0));
  return all;
}

template <class T>
double number(const std::vector<unsigned char> &bytes, std::size_t at, bool turned) {
  unsigned char raw[sizeof(T)];
  for (std::size_t b = 0; b < sizeof(T); ++b) raw[b] = bytes.at(at + (turned ? sizeof(T) - 1 - b : b));
  T value;
  std::memcpy(&value, raw, sizeof value);
  return static_cast<double>(value);
}

/// Eq. numbers of nifti1.h, "METHOD 3" (sform) before "METHOD 2" (qform); RAS to LPS by changing two signs.
inline ReferenceSolution nifti(const std::filesystem::path &file) {
  const auto b = head(file, 540);
  ReferenceSolution t;
  const double plain = number<std::int32_t>(b, 0, false);
  const bool turned = plain != 348 && plain != 540;
  const bool two = number<std::int32_t>(b, 0, turned) == 540;
  const auto real = [&](std::size_t one, std::size_t second) {
    return two ? number<double>(b, second, turned) : number<float>(b, one, turned);
  };
  const auto code = [&](std::size_t one, std::size_t second) {
    return two ? number<std::int32_t>(b, second, turned) : number<std::int16_t>(b, one, turned);
  };
  for (std::size_t a = 0; a < 3; ++a)
    t.size[a] = static_cast<std::size_t>(two ? number<std::int64_t>(b, 24 + 8 * a, turned)
                                             : number<std::int16_t>(b, 42 + 2 * a, turned));
  if (code(254, 348) > 0) {
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 4; ++c) t.m[r][c] = real(280 + 16 * r + 4 * c, 400 + 32 * r + 8 * c);
  } else {
    const double qb = real(256, 352), qc = real(260, 360), qd = real(264, 368),
                 qa = std::sqrt(std::max(0.0, 1 - qb * qb - qc * qc - qd * qd));
    const double turn = real(76, 104) < 0 ? -1 : 1;
    const double r[3][3] = {
        {qa * qa + qb * qb - qc * qc - qd * qd, 2 * qb * qc - 2 * qa * qd, 2 * qb * qd + 2 * qa * qc},
        {2 * qb * qc + 2 * qa * qd, qa * qa + qc * qc - qb * qb - qd * qd, 2 * qc * qd - 2 * qa * qb},
        {2 * qb * qd - 2 * qa * qc, 2 * qc * qd + 2 * qa * qb, qa * qa + qd * qd - qc * qc - qb * qb}};
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t c = 0; c < 3; ++c) t.m[row][c] = r[row][c] * real(80 + 4 * c, 112 + 8 * c) * (c == 2 ? turn : 1);
      t.m[row][3] = real(268 + 4 * row, 376 + 8 * row);
    }
  }
  for (std::size_t r = 0; r < 2; ++r)
    for (double &x : t.m[r]) x = -x;
  return t;
}

/// Every number of a text, whatever the separators.
inline std::vector<double> numbers(std::string text) {
  for (char &c : text)
    if (c == '(' || c == ')' || c == ',') c = ' ';
  std::istringstream in(text);
  std::vector<double> all;
  for (std::string word; in >> word;) all.push_back(std::stod(word));
  return all;
}

inline std::map<std::string, std::string> lines(const std::filesystem::path &file, char separator) {
  std::map<std::string, std::string> all;
  std::ifstream in(file, std::ios::binary);
  for (std::string line; std::getline(in, line) && !line.empty() && line != "\r";) {
    const std::size_t at = line.find(separator);
    if (at == std::string::npos) continue;
    std::string key = line.substr(0, at);
    while (!key.empty() && key.back() == ' ') key.pop_back();
    all[key] = line.substr(at + 1);
    if (key == "ElementDataFile") break;
  }
  return all;
}

/// Space directions are the columns of the matrix; all files of the data are LPS or do not specify it.
inline ReferenceSolution nrrd(const std::filesystem::path &file) {
  auto fields = lines(file, ':');
  ReferenceSolution t;
  const auto sizes = numbers(fields["sizes"]), directions = numbers(fields["space directions"]),
             origin = numbers(fields["space origin"]);
  const std::size_t n = sizes.size();
  for (std::size_t a = 0; a < n; ++a) {
    t.size[a] = static_cast<std::size_t>(sizes[a]);
    for (std::size_t r = 0; r < n; ++r) t.m[r][a] = directions.at(a * n + r);
    t.m[a][3] = origin.at(a);
  }
  return t;
}

inline ReferenceSolution meta(const std::filesystem::path &file) {
  auto keys = lines(file, '=');
  ReferenceSolution t;
  const auto sizes = numbers(keys["DimSize"]), spacing = numbers(keys["ElementSpacing"]);
  auto matrix = numbers(keys["TransformMatrix"]), origin = numbers(keys["Offset"]);
  const std::size_t n = sizes.size();
  for (std::size_t a = 0; a < n; ++a) {
    t.size[a] = static_cast<std::size_t>(sizes[a]);
    for (std::size_t r = 0; r < n; ++r)
      t.m[r][a] = (matrix.empty() ? (a == r ? 1.0 : 0.0) : matrix.at(a * n + r)) * spacing.at(a);
    t.m[a][3] = origin.empty() ? 0.0 : origin.at(a);
  }
  return t;
}

}  // namespace header_truth
