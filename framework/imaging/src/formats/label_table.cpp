// SPDX-License-Identifier: Apache-2.0
#include "formats/label_table.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "c3de/core/input_file.h"
#include "c3de/imaging/label_names.h"

namespace c3de::imaging {
namespace {

/// Doubles represent all integers up to 2^53.
bool isLabel(double x) { return x >= 0.0 && x <= 9007199254740992.0 && x == std::floor(x); }

/// ITK-SNAP: number r g b alpha visible mesh "name".
bool parseItkSnapLine(const std::string &line, LabelTable &table) {
  const std::size_t from = line.find('"'), to = line.rfind('"');
  if (from == std::string::npos || to <= from) return false;
  const auto n = numbersIn(line.substr(0, from));
  if (n.size() != 7 || !isLabel(n[0])) return false;
  table[static_cast<std::uint64_t>(n[0])] = {line.substr(from + 1, to - from - 1),
                                             true,
                                             {linearOf(n[1] / 255.0), linearOf(n[2] / 255.0), linearOf(n[3] / 255.0)}};
  return true;
}

}  // namespace

float linearOf(double srgb) {
  const double x = std::clamp(srgb, 0.0, 1.0);
  return static_cast<float>(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

double srgbOf(float linear) {
  const double x = std::clamp(static_cast<double>(linear), 0.0, 1.0);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
}

LabelTable readLabelTable(const std::filesystem::path &path) {
  LabelTable table;
  auto file = openInputFile(path);
  std::string line;
  for (int lines = 0; file && lines < 100000 && std::getline(*file, line); ++lines) {
    line = trimmed(line);
    if (line.empty() || line.front() == '#' || line.size() > 1000 || parseItkSnapLine(line, table)) continue;
    std::istringstream words(line);
    double number = -1.0;
    std::string name;
    if (!(words >> number >> name) || !isLabel(number)) continue;
    LabelName entry{name, false, {}};
    // A name may have several words; numbers after it are a colour, or something else that is not part of the name.
    std::string rest;
    for (std::string word; words >> word;) {
      if (const auto n = numbersIn(word); !rest.empty() || (n.size() == 1 && std::isfinite(n[0])))
        rest += " " + word;
      else
        entry.name += " " + word;
    }
    if (const auto rgb = numbersIn(rest);
        (rgb.size() == 3 || rgb.size() == 4) &&
        std::all_of(rgb.begin(), rgb.end(), [](double x) { return x >= 0.0 && x <= 255.0; })) {
      entry.coloured = true;
      for (std::size_t c = 0; c < 3; ++c) entry.colour[c] = linearOf(rgb[c] / 255.0);
    }
    table[static_cast<std::uint64_t>(number)] = entry;
  }
  return table;
}

std::pair<LabelTable, std::filesystem::path> sidecarTable(const std::filesystem::path &image) {
  std::filesystem::path whole = image;
  if (lowerCase(whole.extension().string()) == ".gz") whole.replace_extension();
  std::filesystem::path stem = whole;
  stem.replace_extension();
  for (const auto &[base, ending] :
       {std::pair{whole, ".txt"}, {whole, ".label"}, {stem, ".label"}, {stem, ".txt"}, {stem, ".ctbl"}}) {
    std::filesystem::path candidate = base;
    candidate += ending;
    std::error_code code;
    if (!std::filesystem::is_regular_file(candidate, code)) continue;
    if (LabelTable table = readLabelTable(candidate); !table.empty()) return {std::move(table), candidate};
  }
  return {};
}

std::vector<LabelTable> segmentsOf(const std::vector<std::pair<std::string, std::string>> &keys, std::size_t layers) {
  struct Segment {
    double value = -1.0, layer = -1.0;
    LabelName entry;
  };
  std::map<std::size_t, Segment> segments;
  for (const auto &[key, value] : keys) {
    const std::size_t underscore = key.find('_');
    if (!key.starts_with("Segment") || underscore == std::string::npos || underscore < 8 || underscore > 13) continue;
    const std::string number = key.substr(7, underscore - 7);
    if (number.find_first_not_of("0123456789") != std::string::npos) continue;
    Segment &segment = segments[static_cast<std::size_t>(std::stoul(number))];
    const std::string what = key.substr(underscore + 1);
    const auto numbers = numbersIn(value);
    if (what == "LabelValue" && !numbers.empty()) segment.value = numbers[0];
    if (what == "Layer" && !numbers.empty()) segment.layer = numbers[0];
    if (what == "Name") segment.entry.name = trimmed(value);
    if (what == "Color" && numbers.size() == 3) {
      segment.entry.coloured = true;
      for (std::size_t c = 0; c < 3; ++c) segment.entry.colour[c] = linearOf(numbers[c]);
    }
  }
  std::vector<LabelTable> tables(layers);
  const bool isOld = layers > 1 && std::all_of(segments.begin(), segments.end(), [](const auto &one) {
                       return one.second.layer < 0.0 && one.second.value < 0.0;
                     });
  for (auto &[number, segment] : segments) {
    if (isOld) segment.value = 1.0, segment.layer = static_cast<double>(number);
    if (!isLabel(segment.value) || segment.entry.name.empty()) continue;
    const double layer = std::max(segment.layer, 0.0);
    if (layer < static_cast<double>(layers))
      tables[static_cast<std::size_t>(layer)][static_cast<std::uint64_t>(segment.value)] = segment.entry;
  }
  return tables;
}

LabelTable caretLabelsOf(const std::string &xml) {
  LabelTable table;
  const std::string open = "<Label ", close = "</Label>";
  for (std::size_t at = 0; (at = xml.find(open, at)) != std::string::npos;) {
    const std::size_t inside = xml.find('>', at), end = xml.find(close, at);
    if (inside == std::string::npos || end == std::string::npos || end < inside) break;
    const std::string tag = xml.substr(at, inside - at);
    const auto attribute = [&tag](const std::string &name) {
      const std::string key = " " + name + "=\"";
      const std::size_t from = tag.find(key);
      if (from == std::string::npos) return -1.0;
      const std::size_t value = from + key.size();
      const auto numbers = numbersIn(tag.substr(value, tag.find('"', value) - value));
      return numbers.size() == 1 ? numbers[0] : -1.0;
    };
    std::string name = trimmed(xml.substr(inside + 1, end - inside - 1));
    if (name.starts_with("<![CDATA[") && name.ends_with("]]>")) name = trimmed(name.substr(9, name.size() - 12));
    at = end + close.size();
    const double value = attribute("Key");
    if (!isLabel(value) || name.empty()) continue;
    LabelName &entry = table[static_cast<std::uint64_t>(value)];
    entry.name = name;
    const std::array<double, 3> rgb{attribute("Red"), attribute("Green"), attribute("Blue")};
    entry.coloured = std::all_of(rgb.begin(), rgb.end(), [](double x) { return x >= 0.0 && x <= 1.0; });
    for (std::size_t c = 0; c < 3; ++c) entry.colour[c] = linearOf(rgb[c]);
  }
  return table;
}

std::array<float, 3> distinctColour(std::size_t n) {
  // Hues by the golden ratio never repeat; three levels of brightness and two of saturation distinguish neighbouring
  // hues.
  const double hue = std::fmod(0.02 + 0.61803398875 * static_cast<double>(n), 1.0) * 6.0;
  const double value = n % 3 == 0 ? 0.95 : n % 3 == 1 ? 0.75 : 0.55, saturation = n % 2 == 0 ? 0.8 : 0.5;
  std::array<float, 3> out{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double k = std::fmod(5.0 - 2.0 * static_cast<double>(c) + hue, 6.0);
    out[c] = linearOf(value - value * saturation * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0));
  }
  return out;
}

}  // namespace c3de::imaging
