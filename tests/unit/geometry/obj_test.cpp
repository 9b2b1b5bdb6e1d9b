// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <clocale>

#include "c3de/geometry/mesh_io.h"
#include "c3de/geometry/mesh_writer.h"
#include "support/catch.h"
#include "test_files.h"
#include "unit/geometry/shapes.h"

using namespace c3de;
using namespace c3de::geometry;

namespace {

/// The message with which a file of this content is refused.
std::string refusal(std::string_view content, const std::string &name = "bad.obj",
                    LengthUnit unit = LengthUnit::millimetre) {
  const auto loaded = loadMesh(test_files::write(name, content), unit);
  if (loaded) return "was accepted";
  CHECK(loaded.error().code == ErrorCode::input);
  CHECK_THAT(loaded.error().message, Contains(name));
  return loaded.error().message;
}

LoadedMesh accepted(std::string_view content, const std::string &name = "good.obj",
                    LengthUnit unit = LengthUnit::millimetre) {
  auto loaded = loadMesh(test_files::write(name, content), unit);
  if (!loaded) FAIL(loaded.error().message);
  return *loaded;
}

std::string tetrahedronWith(std::string_view extraLines) {
  return std::string(test_files::kTetrahedronObj) + std::string(extraLines);
}

}  // namespace

TEST_CASE("An OBJ keeps the order and the full precision of its vertices") {
  const auto loaded =
      accepted("v 0.12345678901234 0 0\nv 10 .2 0\nv -.5 1e1 0\nv 0 0 +10.\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  REQUIRE(loaded.mesh.vertices.size() == 4);
  CHECK_THAT(loaded.mesh.vertices[0][0], WithinAbs(0.12345678901234, 1e-14));
  CHECK(loaded.mesh.vertices[1] == Vec3{10.0, 0.2, 0.0});  // a number that begins with the decimal point
  CHECK(loaded.mesh.vertices[2] == Vec3{-0.5, 10.0, 0.0});
  CHECK(loaded.mesh.vertices[3] == Vec3{0.0, 0.0, 10.0});
  CHECK(loaded.report.repairs.empty());
}

TEST_CASE("Numbers are read and written with a point in every locale") {
  const char *set = std::setlocale(LC_NUMERIC, "de_DE.UTF-8");
  const auto loaded = accepted("v 0.5 0 0\nv 10.5 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const auto path = test_files::write("locale.obj", "");
  REQUIRE(writeMesh(path, loaded.mesh));
  const auto again = loadMesh(path, LengthUnit::millimetre);
  std::setlocale(LC_NUMERIC, "C");
  INFO((set ? "with de_DE" : "without de_DE: not installed"));
  CHECK(loaded.mesh.vertices[1][0] == 10.5);
  REQUIRE(again);
  CHECK_THAT(again->mesh.vertices[1][0], WithinAbs(10.5, 1e-12));
}

TEST_CASE("The unit of the file scales vertices, box and volume") {
  const auto inMetres = accepted(test_files::kTetrahedronObj, "unit.obj", LengthUnit::metre);
  const auto inCentimetres = accepted(test_files::kTetrahedronObj, "unit.obj", LengthUnit::centimetre);
  CHECK(inMetres.report.box.max[0] == 10000.0);
  CHECK(inCentimetres.report.box.max[0] == 100.0);
  CHECK_THAT(inCentimetres.report.volume_mm3, WithinRel(1e6 / 6.0, 1e-12));
}

TEST_CASE("Relative indices, texture indices, continued lines, Windows line ends and groups are understood") {
  const auto loaded = accepted(
      "\xEF\xBB\xBF# comment\r\nmtllib none.mtl\r\no part\r\nv 0 0 0 # origin\r\nv 10 0 0\r\nv 0 10 0\r\nv 0 0 "
      "10\r\nvt 0 0\r\nvn 0 0 1\r\n"
      "usemtl red\r\nf -4/1/1 -2/1/1 \\\r\n -3/1/1\r\ng other\r\nf 1//1 2//1 4//1\r\nf 1/1 4/1 3/1\r\ns off\r\nf 2 3 "
      "4");
  CHECK(loaded.mesh.triangles.size() == 4);
  CHECK(loaded.report.closed);
}

TEST_CASE("Polygons become triangles, concave ones too") {
  // A prism over an L: two concave hexagons and six quadrilaterals.
  const auto loaded = accepted(
      "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\n"
      "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n");
  CHECK(loaded.mesh.triangles.size() == 20);
  CHECK_THAT(loaded.report.volume_mm3, WithinAbs(3.0, 1e-12));
  CHECK_THAT(loaded.report.area_mm2, WithinAbs(14.0, 1e-12));  // overlapping triangles would have more
  CHECK(test_files::contains(loaded.report.repairs, "8 polygons were split"));
}

TEST_CASE("A face with thousands of corners is triangulated without delay") {
  std::string text;
  constexpr int kCorners = 20000;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 6.283185307179586 * i / kCorners;
    text += fmt::format("v {} {} 0\n", 100.0 * std::cos(angle), 100.0 * std::sin(angle));
  }
  text += "v 0 0 50\nf";
  for (int i = kCorners; i > 0; --i) text += fmt::format(" {}", i);
  for (int i = 1; i <= kCorners; ++i) text += fmt::format("\nf {} {} {}", i, i % kCorners + 1, kCorners + 1);
  const auto loaded = accepted(text + "\n", "cone.obj");
  CHECK(loaded.report.closed);
  CHECK_THAT(loaded.report.volume_mm3, WithinRel(3.14159265 * 100 * 100 * 50 / 3, 1e-4));
}

TEST_CASE("Missing, empty and foreign files are refused") {
  const auto missing = loadMesh("nowhere/liver.obj", LengthUnit::millimetre);
  REQUIRE_FALSE(missing);
  CHECK_THAT(missing.error().message, Contains("nowhere") && Contains("no such file"));
  CHECK_THAT(refusal(""), Contains("empty"));
  CHECK_THAT(refusal("", "bad.stl"), Contains("empty"));
  CHECK_THAT(refusal("", "bad.vtk"), Contains("empty"));
  CHECK_THAT(refusal(std::string(1000, '\x7f')), Contains("no vertices"));
  const std::string foreign = refusal("text", "liver.docx");
  CHECK_THAT(foreign, Contains("'.docx'") && Contains(".obj, .stl, .ply, .vtk"));
  CHECK_THAT(refusal("text", "noextension"), Contains("none"));
  const auto folder = loadMesh(std::filesystem::path(testOutputRoot()), LengthUnit::millimetre);
  CHECK_FALSE(folder);
}

TEST_CASE("An OBJ without faces is refused with the number of its vertices") {
  CHECK_THAT(refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\n"), Contains("3 vertices but no faces"));
  CHECK_THAT(refusal("f 1 2 3\n"), Contains("no vertices"));
}

TEST_CASE("Indices out of range are refused with line, value and what is accepted") {
  CHECK_THAT(refusal(tetrahedronWith("f 1 2 9\n")), Contains("bad.obj:9") && Contains("9") && Contains("1 to 4"));
  CHECK_THAT(refusal(tetrahedronWith("f 1 2 99999999999\n")), Contains("bad.obj:9") && Contains("99999999999"));
  CHECK_THAT(refusal(tetrahedronWith("f 1 2 999999999999999999999999\n")),
             Contains("bad.obj:9") && Contains("not a vertex index"));
  CHECK_THAT(refusal(tetrahedronWith("f 0 1 2\n")), Contains("bad.obj:9") && Contains("count from 1"));
  CHECK_THAT(refusal(tetrahedronWith("f -5 1 2\n")), Contains("bad.obj:9") && Contains("-5"));
  CHECK_THAT(refusal(tetrahedronWith("f 1 two 3\n")), Contains("bad.obj:9") && Contains("'two'"));
  // A face may come before its vertices.
  CHECK(accepted("f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nv 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\n").report.closed);
}

TEST_CASE("Coordinates that are no finite lengths are refused with line and value") {
  CHECK_THAT(refusal(tetrahedronWith("v nan 0 0\n")),
             Contains("bad.obj:9") && Contains("'nan'") && Contains("not finite"));
  CHECK_THAT(refusal(tetrahedronWith("v 0 inf 0\n")), Contains("y coordinate") && Contains("not finite"));
  CHECK_THAT(refusal(tetrahedronWith("v 0 0 1e999\n")), Contains("z coordinate") && Contains("not finite"));
  CHECK_THAT(refusal(tetrahedronWith("v 1e300 0 0\n")),
             Contains("bad.obj:9") && Contains("'1e300'") && Contains("1e9 mm"));
  CHECK_THAT(refusal(tetrahedronWith("v 2e6 0 0\n"), "bad.obj", LengthUnit::metre), Contains("1e9 mm"));
  CHECK_THAT(refusal(tetrahedronWith("v 0,5 0 0\n")), Contains("'0,5'") && Contains("decimal point"));
  CHECK_THAT(refusal(tetrahedronWith("v 0 0 abc\n")), Contains("'abc'"));
  CHECK_THAT(refusal(tetrahedronWith("v 0 0\n")), Contains("without its z coordinate"));
  CHECK(accepted(tetrahedronWith("v 0 0 1e-999\n")).mesh.vertices.size() == 4);
}

TEST_CASE("A face with more corners than accepted is refused") {
  std::string face = "f";
  for (int i = 0; i < 40000; ++i) face += " 1";
  CHECK_THAT(refusal(tetrahedronWith(face + "\n")), Contains("bad.obj:9") && Contains("32767"));
}

TEST_CASE("Loading can be cancelled and reports its progress") {
  const auto path = test_files::write("cancel.obj", test_files::kTetrahedronObj);
  double last = -1.0;
  REQUIRE(loadMesh(path, LengthUnit::millimetre, [&](double fraction, const std::string &) {
    CHECK(fraction >= last);
    last = fraction;
    return true;
  }));
  CHECK(last == 1.0);
  const auto cancelled =
      loadMesh(path, LengthUnit::millimetre, [](double fraction, const std::string &) { return fraction < 0.6; });
  REQUIRE_FALSE(cancelled);
  CHECK(cancelled.error().code == ErrorCode::cancelled);
}
