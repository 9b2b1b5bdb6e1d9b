// SPDX-License-Identifier: Apache-2.0
// STL files with a wrong triangle count, or with unusual text.
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>

#include "c3de/geometry/mesh_io.h"
#include "support/catch.h"
#include "test_files.h"

using namespace c3de;
using namespace c3de::geometry;

namespace {

/// A tetrahedron of 10 mm.
/// @param count  stated in the header
std::string binary(std::uint32_t count, const std::string &title = "made") {
  static constexpr float kCorners[4][3] = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 10}};
  static constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::string out = title;
  out.resize(80, '\0');
  for (unsigned shift = 0; shift < 32; shift += 8) out += static_cast<char>(count >> shift & 255u);
  for (const auto &face : kFaces) {
    out.append(12, '\0');
    for (const int corner : face)
      for (const float x : kCorners[corner]) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &x, 4);
        for (unsigned shift = 0; shift < 32; shift += 8) out += static_cast<char>(bits >> shift & 255u);
      }
    out.append(2, '\0');
  }
  return out;
}

const std::string kText =
    "solid t\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 10 0\nvertex 1e1 0 0\nendloop\nendfacet\n"
    "facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 10 0 0\nvertex 0 0 10\nendloop\nendfacet\n"
    "facet normal -1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 10\nvertex 0 10 0\nendloop\nendfacet\n"
    "facet normal 1 1 1\nouter loop\nvertex 10 0 0\nvertex 0 10 0\nvertex 0 0 10\nendloop\nendfacet\nendsolid t\n";

std::string capitals(std::string text) {
  for (char &c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}
std::string replaced(std::string text, const std::string &from, const std::string &to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

}  // namespace

TEST_CASE("An STL is read whatever its count says, and however its text is written") {
  const std::string secondSolid =
      replaced(kText, "\nfacet normal 1 1 1", "\nendsolid t\nsolid lid\nfacet normal 1 1 1");
  const struct {
    const char *name;
    std::string bytes;
    const char *note;  ///< nullptr: none expected
  } cases[] = {
      {"plain.stl", binary(4), nullptr},
      {"zero.stl", binary(0), "the header says 0 triangles, the size of the file 4: all 4 were read"},
      {"few.stl", binary(1), "the header says 1 triangle, the size of the file 4"},
      {"many.stl", binary(9),
       "the header says 9 triangles, the size of the file 4: all 4 were read; the file may be truncated"},
      {"unknown.stl", binary(0xffffffffu), "the size of the file 4"},
      {"trailing.stl", binary(4) + "made by a program", "17 bytes after the last of 4 triangles were left out"},
      {"zero-trailing.stl", binary(0) + "x", "1 byte after the last of 4 triangles was left out"},
      {"solid.stl", binary(4, "solid of a program that writes so"), nullptr},
      {"solid-zero.stl", binary(0, "solid of a program that writes so"), "the size of the file 4"},
      {"CAPITALS.STL", capitals(kText), nullptr},
      {"mixed.stl", replaced(replaced(kText, "facet", "Facet"), "solid t", "Solid a name of words, with vertex"),
       nullptr},
      {"windows.stl", replaced(kText, "\n", "\r\n"), nullptr},
      {"old-mac.stl", replaced(kText, "\n", "\r"), nullptr},
      {"indented.stl", " \n\t" + replaced(kText, "\n", "\n\t "), nullptr},
      {"marked.stl", "\xef\xbb\xbf" + kText, nullptr},
      {"umlaut.stl", replaced(kText, "solid t", "solid Herz\xe4\xc3\xa4"), nullptr},
      {"two.stl", secondSolid, nullptr},
      {"open-end.stl", replaced(kText, "endsolid t\n", ""), "ends without 'endsolid'"},
      {"nan-normal.stl", replaced(kText, "normal 1 1 1", "normal nan nan nan"), nullptr},
  };
  for (const auto &one : cases) {
    INFO(one.name);
    const auto loaded = loadMesh(test_files::write(one.name, one.bytes), std::nullopt);
    if (!loaded) {
      FAIL_CHECK(loaded.error().message);
      continue;
    }
    CHECK(loaded->report.vertices == 4);
    CHECK(loaded->report.triangles == 4);
    CHECK(loaded->report.closed);
    CHECK_THAT(loaded->report.volume_mm3, WithinRel(1000.0 / 6.0, 1e-6));
    INFO(loaded->report.text());
    if (one.note != nullptr) CHECK(test_files::contains(loaded->report.repairs, one.note));
    CHECK(test_files::contains(loaded->report.repairs, "the size of the file") ==
          (one.note != nullptr && std::string(one.note).find("the size of the file") != std::string::npos));
  }
}

TEST_CASE("An STL that is cut or garbled is refused with what is wrong") {
  const struct {
    const char *name;
    std::string bytes;
    const char *said;
  } cases[] = {
      {"cut.stl", binary(4).substr(0, 260), "the header says 4 triangles (284 bytes), the file has 260 bytes"},
      {"head.stl", binary(4).substr(0, 100), "100 bytes"},
      {"text-cut.stl", kText.substr(0, kText.find("vertex 10 0 0")), "ends within a facet"},
      {"comma.stl", replaced(kText, "vertex 1e1 0 0", "vertex 1,5 0 0"),
       "comma.stl:6: coordinate '1,5' is not a number"},
      {"infinite.stl", replaced(kText, "vertex 1e1 0 0", "vertex inf 0 0"), "'inf' is not finite"},
      {"empty.stl", "solid nothing\nendsolid nothing\n", "no facets"},
  };
  for (const auto &one : cases) {
    INFO(one.name);
    const auto loaded = loadMesh(test_files::write(one.name, one.bytes), std::nullopt);
    REQUIRE_FALSE(loaded);
    CHECK(loaded.error().code == ErrorCode::input);
    CHECK_THAT(loaded.error().message, Contains(one.name) && Contains(one.said));
  }
}
