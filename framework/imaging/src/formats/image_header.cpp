// SPDX-License-Identifier: Apache-2.0
#include "formats/image_header.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "c3de/core/text.h"

namespace c3de::imaging {

std::size_t bytesOf(Scalar scalar) {
  switch (scalar) {
    case Scalar::i8:
    case Scalar::u8: return 1;
    case Scalar::i16:
    case Scalar::u16: return 2;
    case Scalar::i32:
    case Scalar::u32:
    case Scalar::f32: return 4;
    case Scalar::i64:
    case Scalar::u64:
    case Scalar::f64: break;
  }
  return 8;
}

double bytesOfVolume(const ImageHeader &header) {
  return static_cast<double>(header.geometry.voxelCount()) *
         static_cast<double>(header.channels * bytesOf(header.scalar));
}
double bytesOfAll(const ImageHeader &header) { return bytesOfVolume(header) * static_cast<double>(header.volumes); }

tl::unexpected<Error> refuse(const std::filesystem::path &path, const std::string &what) {
  return fail(ErrorCode::input, path.string() + ": " + what);
}

Expected<void> setSize(ImageHeader &header, const std::vector<double> &sizes) {
  double voxels = 1.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double n = a < sizes.size() ? sizes[a] : 1.0;
    if (!(n >= 1.0 && n <= 1e6) || n != std::floor(n))
      return refuse(header.path, "the header says " + formatNumber(n) + " voxels along axis " + std::to_string(a + 1) +
                                     "; accepted is 1 to 1000000");
    header.geometry.size[a] = static_cast<std::size_t>(n);
    voxels *= n;
  }
  if (voxels > 1e12)
    return refuse(header.path, "the header says " + formatNumber(voxels) + " voxels; accepted are up to 1e12");
  return {};
}

Expected<void> setAffine(ImageHeader &header, const Vec3 &i, const Vec3 &j, const Vec3 &k, const Vec3 &origin) {
  for (const Vec3 &v : {i, j, k, origin})
    for (const double x : v)
      if (!(std::abs(x) <= 1e6))
        return refuse(header.path,
                      "the header places voxels at " + formatNumber(x) + " mm; accepted are finite numbers up to 1e6");
  const double lengths = norm(i) * norm(j) * norm(k);
  if (!(norm(i) > 0.0 && norm(j) > 0.0 && norm(k) > 0.0) || !(std::abs(dot(i, cross(j, k))) > 1e-6 * lengths))
    return refuse(header.path, "the axes of the header span no volume (lengths " + formatNumber(norm(i)) + ", " +
                                   formatNumber(norm(j)) + ", " + formatNumber(norm(k)) + " mm)");
  header.geometry.indexToWorld = {i[0], i[1], i[2], 0, j[0],      j[1],      j[2],      0,
                                  k[0], k[1], k[2], 0, origin[0], origin[1], origin[2], 1};
  for (double &x : header.geometry.indexToWorld) x += 0.0;  // removes negative zeros, which would be printed
  return {};
}

namespace {

double plainNumber(const char *from, const char *to) {
  if (from != to && *from == '+') ++from;
  double value = 0.0;
  const auto [stop, error] = std::from_chars(from, to, value);
  return error == std::errc() && stop == to ? value : std::numeric_limits<double>::quiet_NaN();
}

bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// Position of the only comma of a word, between two digits and with no point in the word.
std::size_t decimalComma(const std::string &word) {
  const std::size_t comma = word.find(',');
  if (comma == std::string::npos || comma == 0 || comma + 1 == word.size() || word.rfind(',') != comma ||
      word.find('.') != std::string::npos || !isDigit(word[comma - 1]) || !isDigit(word[comma + 1]))
    return std::string::npos;
  return comma;
}

/// Calls visit(word, isBracketed) for words between blanks and brackets, within brackets also between commas.
template <class Visit>
void forEachWord(const std::string &text, Visit &&visit) {
  bool isBracketed = false;
  std::string word;
  for (const char c : text + " ") {
    if (std::isspace(static_cast<unsigned char>(c)) != 0 || c == '(' || c == ')' || (isBracketed && c == ',')) {
      if (!word.empty()) visit(word, isBracketed);
      word.clear();
      if (c == '(' || c == ')') isBracketed = c == '(';
    } else {
      word += c;
    }
  }
}

}  // namespace

double numberFrom(const std::string &word) {
  std::string number = word;
  if (const std::size_t comma = decimalComma(word); comma != std::string::npos) number[comma] = '.';
  return plainNumber(number.data(), number.data() + number.size());
}

std::vector<double> numbersIn(const std::string &text) {
  std::vector<double> all;
  forEachWord(text, [&](const std::string &word, bool) {
    if (decimalComma(word) != std::string::npos) {
      all.push_back(numberFrom(word));
      return;
    }
    for (std::size_t at = 0; at < word.size();) {
      const std::size_t end = std::min(word.find(',', at), word.size());
      if (end > at) all.push_back(plainNumber(word.data() + at, word.data() + end));
      at = end + 1;
    }
  });
  return all;
}

bool hasDecimalComma(const std::string &text) {
  bool found = false;
  forEachWord(text, [&](const std::string &word, bool isBracketed) {
    found = found || (!isBracketed && decimalComma(word) != std::string::npos);
  });
  return found;
}

std::optional<double> millimetresOf(const std::string &unit) {
  struct Named {
    double millimetres;
    std::vector<const char *> names;
  };
  static const std::vector<Named> kUnits{
      {1.0, {"mm", "millimeter", "millimeters", "millimetre", "millimetres"}},
      {1000.0, {"m", "meter", "meters", "metre", "metres"}},
      {100.0, {"dm", "decimeter", "decimeters", "decimetre", "decimetres"}},
      {10.0, {"cm", "centimeter", "centimeters", "centimetre", "centimetres"}},
      {1e-3,
       {"um", "\xc2\xb5m", "\xce\xbcm", "micron", "microns", "micrometer", "micrometers", "micrometre", "micrometres"}},
      {1e-6, {"nm", "nanometer", "nanometers", "nanometre", "nanometres"}},
      {25.4, {"in", "inch", "inches"}}};
  const std::string lower = lowerCase(unit);
  for (const Named &one : kUnits)
    if (std::any_of(one.names.begin(), one.names.end(), [&](const char *name) { return lower == name; }))
      return one.millimetres;
  return std::nullopt;
}

std::vector<std::string> numberedNames(const std::string &pattern, const std::vector<double> &range) {
  std::vector<std::string> names;
  const std::size_t percent = pattern.find('%'), d = pattern.find('d', percent);
  if (percent == std::string::npos || d == std::string::npos || range.size() < 2) return names;
  // Only %d and %03d: a format string from a file is not passed to printf.
  const std::string width = pattern.substr(percent + 1, d - percent - 1);
  if (width.size() > 3 || width.find_first_not_of("0123456789") != std::string::npos) return names;
  const auto digits = static_cast<std::size_t>(std::atoi(width.c_str()));
  const double step = range.size() > 2 ? range[2] : 1.0;
  if (!(std::abs(step) >= 1.0) || !(std::abs(range[1] - range[0]) / std::abs(step) < 1e5) ||
      !(std::abs(range[0]) < 1e9))
    return names;
  for (double at = range[0]; step > 0.0 ? at <= range[1] : at >= range[1]; at += step) {
    std::string number = std::to_string(static_cast<long long>(at));
    if (number.size() < digits) number.insert(0, digits - number.size(), width.front() == '0' ? '0' : ' ');
    names.push_back(pattern.substr(0, percent) + number + pattern.substr(d + 1));
  }
  return names;
}

std::string trimmed(const std::string &text) {
  const char *blanks = " \t\r\n\f\v";
  const std::size_t from = text.find_first_not_of(blanks);
  if (from == std::string::npos) return {};
  std::string out = text.substr(from, text.find_last_not_of(blanks) - from + 1);
  while (!out.empty() && out.back() == '\0') out.pop_back();  // DICOM pads with zeros
  return out;
}

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool isSystemArtefact(const std::filesystem::path &path) {
  const std::string name = lowerCase(path.filename().string());
  return name.starts_with('.') || name == "thumbs.db" || name == "desktop.ini" || name == "__macosx";
}

std::string imageExtension(const std::filesystem::path &path) {
  const std::string last = lowerCase(path.extension().string());
  if (last != ".gz") return last;
  const std::string before = lowerCase(path.stem().extension().string());
  return before == ".nii" || before == ".img" || before == ".hdr" ? before + ".gz" : last;
}

}  // namespace c3de::imaging
