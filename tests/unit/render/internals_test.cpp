// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <random>

#include "c3de/core/platform.h"
#include "depth_order.h"
#include "font_atlas.h"
#include "mesh_normals.h"
#include "support/catch.h"
#include "view_math.h"

using namespace c3de;
using namespace c3de::render;

TEST_CASE("Depth keys put far things first, also behind the eye") {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> depth(-100.0f, 1000.0f);
  std::vector<DepthItem> items, scratch;
  std::vector<float> depths;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    depths.push_back(depth(random));
    items.push_back({farFirstKey(depths.back()), i});
  }
  sortByKey(items, scratch);
  REQUIRE(items.size() == depths.size());
  CHECK(std::is_sorted(items.begin(), items.end(), [&](const DepthItem &a, const DepthItem &b) {
    return depths[a.primitive] > depths[b.primitive];
  }));
}

TEST_CASE("Sorting keeps the order of equal keys and loses nothing") {
  std::mt19937 random(5);
  std::vector<DepthItem> items, scratch;
  for (std::uint32_t i = 0; i < 4000; ++i) items.push_back({static_cast<std::uint32_t>(random() % 97) * 44739242u, i});
  auto expected = items;
  std::stable_sort(expected.begin(), expected.end(),
                   [](const DepthItem &a, const DepthItem &b) { return a.key < b.key; });
  sortByKey(items, scratch);
  REQUIRE(items.size() == expected.size());
  CHECK(std::equal(items.begin(), items.end(), expected.begin(), [](const DepthItem &a, const DepthItem &b) {
    return a.key == b.key && a.primitive == b.primitive;
  }));
}

TEST_CASE("Vertex normals are weighted by area, and a vertex without triangles has none") {
  // A large triangle in the plane z = 0 and a small one in the plane x = 0 share the edge from 0 to 1.
  const std::vector<Vec3f> positions{{0, 0, 0}, {0, 1, 0}, {-8, 0, 0}, {0, 0, -1}, {5, 5, 5}};
  const std::vector<Triangle> triangles{{0, 1, 2}, {1, 0, 3}};
  std::vector<Vec3f> normals;
  computeVertexNormals(positions, triangles, normals);
  REQUIRE(normals.size() == positions.size());
  CHECK(normals[2] == Vec3f{0, 0, 1});
  CHECK(normals[3] == Vec3f{1, 0, 0});
  // Doubled areas 8 and 1.
  CHECK_THAT(normals[0][2] / normals[0][0], WithinRel(8.0f, 1e-5f));
  CHECK(normals[4] == Vec3f{0, 0, 0});
}

TEST_CASE("Normals stay outward and perpendicular under mirroring and uneven scale") {
  // Mirrors x, scales y by 3.
  const Mat4 m{-1, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1};
  // The plane x + y = 0 with the normal (1, 1, 0) becomes -x + y/3 = 0.
  const Vec3f n = transformNormal(normalMatrix(m), {1, 1, 0});
  CHECK(n[0] < 0.0f);
  CHECK_THAT(n[1] / n[0], WithinRel(-1.0f / 3.0f, 1e-6f));
  CHECK(n[2] == 0.0f);
  CHECK_THAT(lengthScale(m), WithinRel(std::cbrt(3.0f), 1e-6f));
}

TEST_CASE("UTF-8 is decoded, and malformed bytes become replacement characters") {
  CHECK(decodeUtf8("a°²µ×") == U"a\u00B0\u00B2\u00B5\u00D7");
  CHECK(decodeUtf8("\xE2\x89\xA5\xF0\x9F\x98\x80") == U"\u2265\U0001F600");
  CHECK(decodeUtf8("a\xFFz") == U"a\uFFFDz");
  CHECK(decodeUtf8("\xC2") == U"\uFFFD");
  CHECK(decodeUtf8("\xE2\x89z") == U"\uFFFD\uFFFDz");
}

TEST_CASE("The built-in font has the characters of measurements") {
  const FontAtlas atlas = buildFontAtlas({}, 18.0f);
  CHECK(atlas.font == "built-in");
  for (const char32_t c : U"Az09.-/%°²³µ×") {
    if (c == 0) continue;
    INFO("character " << static_cast<unsigned>(c));
    REQUIRE(atlas.glyphs.contains(c));
    const Glyph &g = atlas.glyph(c);
    CHECK(g.advance > 0.0f);
    CHECK(g.x + g.width <= atlas.width);
    CHECK(g.y + g.height <= atlas.height);
    int covered = 0;
    for (int y = g.y; y < g.y + g.height; ++y)
      for (int x = g.x; x < g.x + g.width; ++x)
        covered += atlas.pixels[static_cast<std::size_t>(2 * (y * atlas.width + x))] > 128;
    CHECK(covered > 0);
  }
}

TEST_CASE("A system font has the characters of measurements") {
  const auto directories = fontDirectories();
  const FontAtlas atlas = buildFontAtlas(directories, 18.0f);
  if (atlas.font == "built-in") C3DE_SKIP("no known font on this machine");
  for (const char32_t c : {U'A', U'°', U'²', U'³', U'µ', U'×', U'α', U'–'}) {
    INFO("character " << static_cast<unsigned>(c));
    CHECK(atlas.glyphs.contains(c));
  }
  CHECK(atlas.glyph(0x4E2D).width == atlas.glyph(U'?').width);
}
