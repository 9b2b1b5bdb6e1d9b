// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/measured_points.h"

#include <fstream>

#include "c3de/core/vec.h"
#include "c3de/scene/scene_file.h"
#include "support/catch.h"

using namespace c3de;
using session::MeasuredPoints;
using session::readMeasuredPoints;

namespace {

std::filesystem::path written(const std::string &name, const std::string &text) {
  const auto file = testOutputFolder() / name;
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

MeasuredPoints read(const std::string &text, std::optional<geometry::LengthUnit> unit = {}) {
  const auto out = readMeasuredPoints(written("a.csv", text), unit);
  if (!out) FAIL(out.error().message);
  return *out;
}

std::string refusal(const std::string &text, const std::string &name = "a.csv") {
  const auto out = readMeasuredPoints(written(name, text), {});
  if (out) return "";
  CHECK(out.error().code == ErrorCode::input);
  return out.error().message;
}

}  // namespace

TEST_CASE("Tables of points are read with and without names, with normals, in any unit") {
  CHECK(read("1,2,3\n4,5,-6e0\n").points_mm == std::vector<Vec3>{{1, 2, 3}, {4, 5, -6}});
  CHECK(read("\xef\xbb\xbf# measured\r\nz, what ,x_mm,y\r\n3,a,1,2\r\n\r\n").points_mm == std::vector<Vec3>{{1, 2, 3}});
  CHECK(read("0.001,0.002,0.003\n", geometry::LengthUnit::metre).points_mm == std::vector<Vec3>{{1, 2, 3}});
  const MeasuredPoints normals = read("x,y,z,nx,ny,nz\n1,2,3,0,0,-2\n");
  CHECK(normals.normals == std::vector<Vec3>{{0, 0, -1}});
  const std::vector<Vec3> unit = read("1,2,3,0,3,4\n").normals;
  REQUIRE(unit.size() == 1);
  CHECK(norm(unit[0] - Vec3{0, 0.6, 0.8}) < 1e-15);
  CHECK(read("1,2,3\n").normals.empty());
}

TEST_CASE("Rows with a name in the column landmark are not points of the surface") {
  const MeasuredPoints out = read("x,y,z,nx,ny,nz,landmark\n1,2,3,0,0,1,\n4,5,6,,,,rim\n", geometry::LengthUnit::metre);
  CHECK(out.points_mm == std::vector<Vec3>{{1000, 2000, 3000}});
  CHECK(out.normals.size() == 1);
  REQUIRE(out.landmarks.size() == 1);
  CHECK(out.landmarks[0].name == "rim");
  CHECK(out.landmarks[0].lps_mm == Vec3{4000, 5000, 6000});
  CHECK_THAT(session::checkNoLandmarks(out).error().message,
             Contains("a.csv:3: the row is the position of landmark 'rim'"));
  CHECK(session::checkNoLandmarks(read("x,y,z,landmark\n1,2,3,\n")));
  CHECK_THAT(refusal("x,y,z,landmark\n1,2,3,a\n1,2,3,a\n"), Contains("a.csv:3: landmark 'a' has another position in"));
}

TEST_CASE("Wrong tables of points are refused with line and value") {
  CHECK_THAT(refusal("1,2,3\n1,inf,3\n"), Contains("a.csv:2: y is 'inf'; accepted: a number from -1e6 to 1e6"));
  CHECK_THAT(refusal("x,y,z\n1,2\n"), Contains("a.csv:2: the row has 2 cells; accepted: 3"));
  CHECK_THAT(refusal("1,2,3,4\n"), Contains("a.csv:1: the row has 4 numbers"));
  CHECK_THAT(refusal("x,y\n"), Contains("column 'z' is missing"));
  CHECK_THAT(refusal("x,y,z,nx\n"), Contains("only some of the columns nx, ny, nz"));
  CHECK_THAT(refusal("x,y,z,nx,ny,nz\n1,2,3,0,0,0\n"), Contains("a.csv:2: the normal is (0, 0, 0)"));
  CHECK_THAT(refusal("1,\"2,3\n"), Contains("a.csv:1: a quotation mark is not closed"));
  CHECK_THAT(refusal(""), Contains("has no point"));
  CHECK_THAT(refusal("1 2 3\n", "a.xyz"), Contains("is not named like points"));
  CHECK_THAT(readMeasuredPoints(testOutputFolder() / "none.csv", {}).error().message, Contains("none.csv"));
}

TEST_CASE("The table of a match is read, written and read again as the same") {
  const std::string text =
      "format = 1\n[[body]]\nname = \"b\"\nmesh = \"b.stl\"\nmesh_unit = \"mm\"\n[match]\nlabels = \"f.nii\"\n"
      "label = \"liver\"\ntime = 2\nlandmarks = \"t.csv\"\nuse = \"fit\"\nweight = 4.0\nnoise_mm = 0.5\n";
  const auto scene = scene::parseScene(text, "/nowhere/s.toml", nullptr, false);
  if (!scene) FAIL(scene.error().message);
  REQUIRE(scene->match);
  const auto again = scene::sceneText(*scene, "/nowhere");
  if (!again) FAIL(again.error().message);
  const auto second = scene::parseScene(*again, "/nowhere/s.toml", nullptr, false);
  if (!second) FAIL(second.error().message);
  for (const auto &match : {*scene->match, *second->match}) {
    CHECK(match.body == "b");
    CHECK(match.labels.file == std::filesystem::path("/nowhere/f.nii"));
    CHECK(match.labels.labelName == "liver");
    CHECK(match.labels.time == 2);
    CHECK(match.landmarks == std::filesystem::path("/nowhere/t.csv"));
    CHECK(match.fitsLandmarks);
    CHECK(match.landmarkWeight == 4.0);
    CHECK(match.noise_mm == 0.5);
    CHECK(match.isRigidFirst);
  }
}

TEST_CASE("An override sets what was measured, and a source replaces another") {
  auto scene = scene::parseScene(
      "format = 1\n[[body]]\nname = \"b\"\nmesh = \"b.stl\"\nmesh_unit = \"mm\"\n[match]\npoints = \"p.csv\"\n",
      "/nowhere/s.toml", nullptr, false);
  REQUIRE(scene);
  REQUIRE(scene::applyOverride(*scene, "match.noise_mm=2", nullptr));
  CHECK(scene->match->noise_mm == 2.0);
  const auto wrong = scene::applyOverride(*scene, "match.noise_mm=0", nullptr);
  REQUIRE_FALSE(wrong);
  CHECK_THAT(wrong.error().message, Contains("--set match.noise_mm") && Contains("above 0"));
}
