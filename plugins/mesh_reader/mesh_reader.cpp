// SPDX-License-Identifier: Apache-2.0
// Brings a mesh format: text files of vertices and triangles with a unit (FORMAT.md), read and written. What the host does
// with every mesh after reading (weld, orient, report) it does with these as well. Walked through in docs/plugin/index.md.
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

constexpr std::string_view kHead = "trimesh 1";

/// What is wrong with the file, for the person: the host adds the names of file, reader and plugin.
[[noreturn]] void refuse(std::size_t line, const std::string &what) {
  throw sdk::Error(C3DE_E_FORMAT, "line " + std::to_string(line) + ": " + what);
}

/// Takes the next word off the front of a line.
std::string_view nextWord(std::string_view &line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
  const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

template <class Number>
std::array<Number, 3> threeOf(std::string_view rest, std::size_t line, const char *wanted) {
  std::array<Number, 3> out{};
  for (Number &number : out) {
    const std::string_view word = nextWord(rest);
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (word.empty() || code != std::errc() || end != word.data() + word.size())
      refuse(line, "'" + std::string(word.substr(0, 40)) + "' where " + wanted + " is expected");
  }
  if (const std::string_view more = nextWord(rest); !more.empty())
    refuse(line, "'" + std::string(more.substr(0, 40)) + "' after three numbers");
  return out;
}

std::uint32_t unitOf(std::string_view word, std::size_t line) {
  if (word == "mm") return C3DE_UNIT_MM;
  if (word == "cm") return C3DE_UNIT_CM;
  if (word == "m") return C3DE_UNIT_M;
  refuse(line, "unit '" + std::string(word.substr(0, 40)) + "'; accepted: mm, cm, m");
}

sdk::Result<void> readTrimesh(const sdk::MeshSource &source, sdk::Progress progress, const sdk::MeshSink &sink) {
  std::vector<sdk::Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::string_view rest = source.bytes;
  bool hasUnit = false, hasEnd = false;
  std::size_t number = 0;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (++number % 10000 == 0) {
      const double read = 1.0 - static_cast<double>(rest.size()) / static_cast<double>(source.bytes.size());
      if (!progress.update(read, "reading lines")) return sdk::Failure{C3DE_E_CANCELLED, "cancelled"};
    }
    if (number == 1) {
      if (line != kHead) refuse(1, "is not '" + std::string(kHead) + "'");
      continue;
    }
    const std::string_view word = nextWord(line);
    if (word.empty() || word.starts_with('#')) continue;
    if (hasEnd) refuse(number, "follows after 'end'");
    if (word == "unit") {
      if (hasUnit) refuse(number, "a second unit");
      sink.setUnit(unitOf(nextWord(line), number));
      hasUnit = true;
    } else if (word == "v") {
      if (!hasUnit) refuse(number, "a vertex before 'unit'");
      const sdk::Vec3 x = threeOf<double>(line, number, "a coordinate");
      for (const double value : x)
        if (!std::isfinite(value)) refuse(number, "a coordinate that is not finite");
      vertices.push_back(x);
    } else if (word == "t") {
      triangles.push_back(threeOf<std::uint32_t>(line, number, "the number of a vertex (0, 1, 2 …)"));
    } else if (word == "end") {
      hasEnd = true;
    } else {
      refuse(number, "'" + std::string(word.substr(0, 40)) + "'; accepted: unit, v, t, end and comments with #");
    }
  }
  if (!hasEnd) refuse(number, "the file ends without 'end': it was cut off");
  for (const auto &triangle : triangles)
    for (const std::uint32_t vertex : triangle)
      if (vertex >= vertices.size())
        return sdk::Failure{C3DE_E_FORMAT, "a triangle has vertex " + std::to_string(vertex) + ", there are " +
                                               std::to_string(vertices.size())};
  sink.addVertices(vertices);
  sink.addTriangles(triangles);
  return {};
}

/// Numbers as short as they can be read again without loss.
template <class Number>
void appendThree(std::string &text, char what, const std::array<Number, 3> &three) {
  text += what;
  for (const Number number : three) {
    std::array<char, 32> digits{};
    const auto [end, code] = std::to_chars(digits.data(), digits.data() + digits.size(), number);
    text.append(" ").append(digits.data(), end);
  }
  text += '\n';
}

sdk::Result<void> writeTrimesh(const sdk::MeshContents &mesh, sdk::Progress progress, c3de_sink bytes) {
  std::string text(kHead);
  text += "\nunit mm\n";
  const double rows = static_cast<double>(mesh.positions.size() + mesh.triangles.size());
  std::size_t done = 0;
  const auto goesOn = [&] {
    return ++done % 10000 != 0 || progress.update(static_cast<double>(done) / rows, "writing lines");
  };
  for (const sdk::Vec3 &x : mesh.positions) {
    appendThree(text, 'v', x);
    if (!goesOn()) return sdk::Failure{C3DE_E_CANCELLED, "cancelled"};
  }
  for (const auto &triangle : mesh.triangles) {
    appendThree(text, 't', triangle);
    if (!goesOn()) return sdk::Failure{C3DE_E_CANCELLED, "cancelled"};
  }
  text += "end\n";
  if (const c3de_status status = sdk::put(bytes, text); status < 0) return sdk::currentHost().failure(status);
  return {};
}

class MeshReaderPlugin {
 public:
  explicit MeshReaderPlugin(sdk::Host host) {
    sdk::MeshFormat format;
    format.id = "org.c3de.trimesh";
    format.label = "Points and triangles with a unit";
    format.extensions = {"tri"};
    format.magic = kHead;
    const sdk::Files files(host);
    reader_ = sdk::orThrow(files.addMeshReader(format, readTrimesh));
    writer_ = sdk::orThrow(files.addMeshWriter(format, writeTrimesh));
  }
  static constexpr sdk::PluginInfo info{"org.c3de.mesh_reader", "1.0.0", "Mesh reader", "C3DE", "Apache-2.0"};
  static constexpr std::array needs{sdk::required<c3de_files_v1>(2)};

 private:
  sdk::MeshReader reader_;
  sdk::MeshWriter writer_;
};

}  // namespace

C3DE_DEFINE_PLUGIN(MeshReaderPlugin)
