// SPDX-License-Identifier: Apache-2.0
// Landmarks, distances and angles: their files, and where they are after a known motion.
#include <cmath>
#include <numbers>

#include "program.h"

namespace fs = std::filesystem;

namespace {

/// The landmarks that `c3de info` reads from a file; the test fails if it reads none.
nlohmann::json landmarksIn(const fs::path &file) {
  const auto result = runC3de({"info", file.string(), "--json"});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  return nlohmann::json::parse(result.output)["landmarks"];
}

void checkAt(const nlohmann::json &at, double x, double y, double z, double tolerance = 1e-12) {
  INFO(at.dump());
  CHECK_THAT(at[0].get<double>(), WithinAbs(x, tolerance));
  CHECK_THAT(at[1].get<double>(), WithinAbs(y, tolerance));
  CHECK_THAT(at[2].get<double>(), WithinAbs(z, tolerance));
}

const std::string kFcsvColumns = "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n";

std::string markups(const std::string &system, const std::string &points) {
  return R"({"markups": [{"type": "Fiducial", "coordinateSystem": ")" + system + R"(", "controlPoints": [)" + points +
         "]}]}";
}

/// [position], mm, of a landmark at [reference], mm, after the motion of the test.
using Motion = std::array<double, 3> (*)(const nlohmann::json &);

void checkMoved(const nlohmann::json &landmark, Motion motion, double tolerance_mm) {
  CHECK(landmark["body"] == "box");
  const auto at = motion(landmark["reference_mm"]);
  INFO(landmark.dump());
  checkAt(landmark["position_mm"], at[0], at[1], at[2], tolerance_mm);
}

}  // namespace

TEST_CASE("Landmark files are read, those of 3D Slicer in RAS or LPS") {
  const auto folder = freshFolder("landmark-files");
  const auto csv = landmarksIn(writeFile(
      folder / "a.csv", "\xef\xbb\xbfz_mm,what,name,x_mm,y_mm\r\n3,skin, apex ,-1.5,2e1\r\n\r\n0,,\"a, b\",0,0\r\n"));
  REQUIRE(csv.size() == 2);
  CHECK(csv[0]["name"] == "apex");
  checkAt(csv[0]["at_mm"], -1.5, 20, 3);
  CHECK(csv[1]["name"] == "a, b");
  for (const char *system : {"RAS", "0", "LPS", "1"}) {
    const double sign = *system == 'R' || *system == '0' ? -1.0 : 1.0;
    const auto fcsv = landmarksIn(writeFile(folder / "a.fcsv", std::string("# Markups fiducial file version = 4.11\n") +
                                                                   "# CoordinateSystem = " + system + "\n" +
                                                                   kFcsvColumns + "1,10,20,30,0,0,0,1,1,1,0,F-1,,\n"));
    INFO(system);
    REQUIRE(fcsv.size() == 1);
    CHECK(fcsv[0]["name"] == "F-1");
    checkAt(fcsv[0]["at_mm"], sign * 10, sign * 20, 30);
  }
  for (const char *system : {"RAS", "LPS"}) {
    const double sign = *system == 'R' ? -1.0 : 1.0;
    const auto json = landmarksIn(writeFile(
        folder / "a.mrk.json", markups(system, R"({"label": "F-1", "position": [1, 2, 3], "positionStatus": "defined"},
          {"label": "F-2", "position": [0, 0, 0], "positionStatus": "undefined"})")));
    REQUIRE(json.size() == 1);  // F-2 has not been placed
    checkAt(json[0]["at_mm"], sign * 1, sign * 2, 3);
  }
}

TEST_CASE("What is wrong with a landmark file is said with its place and what is accepted") {
  const auto folder = freshFolder("landmark-errors");
  const std::string lps = "# CoordinateSystem = LPS\n";
  const struct {
    const char *name;
    std::string text, contains;
  } cases[] = {
      {"a.csv", "", "a.csv:1: the column 'name' is missing in ''; accepted: name,x_mm,y_mm,z_mm"},
      {"a.csv", "name,x_mm,y_mm\n", "a.csv:1: the column 'z_mm' is missing"},
      {"a.csv", "name,x_mm,y_mm,z_mm\n", "has no landmark; accepted: one at least"},
      {"a.csv", "name,x_mm,y_mm,z_mm\na,0,1mm,0\n", "a.csv:2: y_mm is '1mm'; accepted: a number in mm"},
      {"a.csv", "name,x_mm,y_mm,z_mm\na,0,nan,0\n", "y_mm is 'nan'"},
      {"a.csv", "name,x_mm,y_mm,z_mm\na,0,0,1e7\n", "z_mm is '1e7'; accepted: a number in mm, from -1e6 to 1e6"},
      {"a.csv", "name,x_mm,y_mm,z_mm\na,0,0\n", "a.csv:2: the row has 3 cells; accepted: 4"},
      {"a.csv", "name,x_mm,y_mm,z_mm\n\"a,0,0,0\n", "a.csv:2: a quotation mark is not closed"},
      {"a.csv", "name,x_mm,y_mm,z_mm\n ,0,0,0\n", "a.csv:2: the landmark has no name"},
      {"a.csv", "name,x_mm,y_mm,z_mm\na,0,0,0\na,1,0,0\n", "a.csv:3: a second landmark is named 'a'"},
      {"a.fcsv", kFcsvColumns + "1,10,20,30,0,0,0,1,1,1,0,F-1,,\n",
       "a.fcsv:2: no line before it states the coordinate"},
      {"a.fcsv", "# CoordinateSystem = IJK\n", "a.fcsv:1: CoordinateSystem is 'IJK'; accepted: RAS or 0, LPS or 1"},
      {"a.fcsv", lps + "# columns = id,x,y,label\n", "a.fcsv:2: the column 'z' is missing"},
      {"a.fcsv", lps + "1,10,here,30,0,0,0,1,1,1,0,F-1,,\n", "a.fcsv:2: y is 'here'"},
      {"a.mrk.json", "{\n\"markups\": [\n", "a.mrk.json:3: is not JSON"},
      {"a.mrk.json", "{}", "has no list \"markups\""},
      {"a.mrk.json", markups("IJK", ""), "markup 1: coordinateSystem is 'IJK'; accepted: LPS, RAS"},
      {"a.mrk.json", R"({"markups": [{"type": "ROI"}]})", "markup 1: type is 'ROI'; accepted: Fiducial"},
      {"a.mrk.json", markups("LPS", R"({"label": "a", "position": [0, "1", 0]})"),
       "markup 1, control point 1: position is [0,\"1\",0]; accepted: three numbers"},
      {"a.mrk.json", markups("LPS", R"({"label": "a"})"), "position is missing"},
      {"a.mrk.json", markups("LPS", R"({"position": [0, 0, 0]})"), "control point 1: the landmark has no name"},
  };
  for (const auto &one : cases) {
    const auto result = runC3de({"info", writeFile(folder / one.name, one.text).string()});
    INFO(one.text << "\n" << result.errorOutput);
    CHECK(result.exitCode == 3);
    CHECK_THAT(result.errorOutput, Contains(one.contains));
  }
}

TEST_CASE("Landmarks follow a body that is turned, to 1e-6 of the imposed motion, and what lies in no body stays") {
  const auto folder = freshFolder("landmarks-moved");
  const std::string more = R"([[fix]]
region = { everywhere = true }
displacement = [0.01, 0.02, -0.03]
rotation_deg = [0, 0, 30]
centre = [0, 0, 0]
[[landmark]]
name = "inside"
at = [0.513, 0.071, 0.123]
target = [0.5, 0.3, 0.1]
[[landmark]]
name = "skin"
on = "box"
at = [1, 0.2, 0.2]
[[landmark]]
name = "far"
at = [5, 5, 5]
[[distance]]
name = "in the body"
between = ["inside", "skin"]
[[distance]]
name = "to the room"
between = ["skin", "far"]
[[angle]]
at = ["inside", "skin", "far"]
)";
  const auto scene = writeBoxScene(folder, more);
  const auto file = writeFile(folder / "more.csv", "name,x_mm,y_mm,z_mm\nfrom file,250,100,50\n").string();
  const auto targets =
      writeFile(folder / "targets.fcsv", "# CoordinateSystem = RAS\n1,-400,-300,100,0,0,0,1,1,1,0,from file,,\n")
          .string();
  const auto out = folder / "out.csv";
  const auto result = runC3de({"run", scene.string(), "--steps", "20", "--landmarks", file, "--target-landmarks",
                               targets, "--export-landmarks", out.string(), "--report", (folder / "r.json").string()});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  const auto report = readJson(folder / "r.json");
  INFO(report["landmarks"].dump(1));
  REQUIRE(report["landmarks"].size() == 4);
  const Motion turned = [](const nlohmann::json &at) {
    const double x = at[0], y = at[1], z = at[2], c = std::cos(std::numbers::pi / 6),
                 s = std::sin(std::numbers::pi / 6);
    return std::array<double, 3>{c * x - s * y + 10, s * x + c * y + 20, z - 30};
  };
  for (const std::size_t i : {0, 1, 3}) checkMoved(report["landmarks"][i], turned, 1e-6);
  const auto &far = report["landmarks"][2];
  CHECK(far["body"].is_null());
  CHECK(far["position_mm"] == far["reference_mm"]);
  checkAt(far["displacement_mm"], 0, 0, 0);
  CHECK(report["landmarks"][3]["name"] == "from file");
  checkAt(report["landmarks"][3]["target_mm"], 400, 300, 100);
  const auto &rigid = report["distances"][0];
  CHECK_THAT(rigid["reference_mm"].get<double>(), WithinRel(std::hypot(487.0, 129.0, 77.0), 1e-9));
  CHECK_THAT(rigid["now_mm"].get<double>(), WithinRel(rigid["reference_mm"].get<double>(), 1e-6));
  CHECK(report["distances"][1]["now_mm"] != report["distances"][1]["reference_mm"]);
  CHECK(report["angles"][0]["name"] == "angle-1");
  CHECK(report["angles"][0]["now_deg"] != report["angles"][0]["reference_deg"]);

  const auto &errors = report["landmark_error_mm"];
  const auto &first = report["landmarks"][0]["error_mm"], &second = report["landmarks"][3]["error_mm"];
  for (const char *when : {"before", "after"}) {
    const double a = first[when], b = second[when];
    CHECK_THAT(errors[when]["mean"].get<double>(), WithinRel((a + b) / 2, 1e-12));
    CHECK_THAT(errors[when]["sd"].get<double>(), WithinRel(std::abs(a - b) / std::sqrt(2.0), 1e-9));
    CHECK(errors[when]["max"].get<double>() == std::max(a, b));
  }
  CHECK_THAT(first["before"].get<double>(), WithinRel(std::hypot(13.0, 229.0, 23.0), 1e-9));
  for (const char *text : {"landmark 'far': it lies in no body and does not move", "landmark error: mean ",
                           "distance 'in the body': ", "angle 'angle-1': "})
    CHECK_THAT(result.output, Contains(text));

  // The table has both positions and is read as the landmarks at rest.
  const auto again = landmarksIn(out);
  REQUIRE(again.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(again[i]["name"] == report["landmarks"][i]["name"]);
    CHECK(again[i]["at_mm"] == report["landmarks"][i]["reference_mm"]);
  }
  CHECK_THAT(readFile(out), Contains("name,x_mm,y_mm,z_mm,x_now_mm,y_now_mm,z_now_mm\n"));
}

TEST_CASE("Landmarks in a bar that is stretched are where the stretch puts them, to 1e-6 mm") {
  const auto folder = freshFolder("landmarks-stretched");
  // Without lateral contraction, on cells that end with the bar, the solution is exact: 1 m becomes 1.02 m.
  const auto scene = writeBoxScene(folder, R"([[fix]]
region = { box = { min = [-0.001, -1, -1], max = [0, 1, 1] } }
[[fix]]
region = { box = { min = [1, -1, -1], max = [1.001, 1, 1] } }
displacement = [0.02, 0, 0]
[[landmark]]
name = "a"
at = [0.313, 0.071, 0.123]
[[landmark]]
name = "b"
at = [0.777, 0.051, 0.153]
[[landmark]]
name = "c"
at = [0.5, 0.2, 0.1]
[[distance]]
name = "length"
between = ["a", "b"]
)");
  const auto report =
      runToReport(scene, {"--set", "world.gravity=[0,0,0]", "--set", "solver.integrator=quasistatic", "--set",
                          "body.box.material.law=linear", "--set", "body.box.material.poisson_ratio=0", "--set",
                          "body.box.sampling.spacing=0.05"});
  const Motion stretched = [](const nlohmann::json &at) {
    return std::array<double, 3>{1.02 * at[0].get<double>(), at[1], at[2]};
  };
  for (const auto &landmark : report["landmarks"]) checkMoved(landmark, stretched, 1e-6);
  CHECK_THAT(report["distances"][0]["now_mm"].get<double>(), WithinAbs(std::hypot(1.02 * 464.0, 20.0, 30.0), 1e-6));
  CHECK_THAT(report["distances"][0]["reference_mm"].get<double>(), WithinRel(std::hypot(464.0, 20.0, 30.0), 1e-9));
}

TEST_CASE("Landmarks of a run are written in each format, and come back as they were") {
  const auto folder = freshFolder("landmarks-written");
  const auto scene = writeBoxScene(folder).string();
  const auto file = writeFile(folder / "in.csv", "name,x_mm,y_mm,z_mm\n\"a, b\",250.125,100,50\nc,-500,1,2\n").string();
  nlohmann::json report;
  for (const char *name : {"out.fcsv", "out.mrk.json"}) {
    const auto out = folder / name;
    report = runToReport(scene, {"--steps", "10", "--landmarks", file, "--export-landmarks", out.string()});
    const auto again = landmarksIn(out);
    INFO(name);
    REQUIRE(again.size() == 2);
    CHECK(again[0]["name"] == "a, b");
    for (std::size_t i = 0; i < 2; ++i) CHECK(again[i]["at_mm"] == report["landmarks"][i]["position_mm"]);
  }
  CHECK(report["landmarks"][0]["displacement_mm"][1] < 0.0);  // it falls
  CHECK(report["landmarks"][1]["body"].is_null());
  CHECK_FALSE(report.contains("landmark_error_mm"));
}

TEST_CASE("Landmarks do not change a run") {
  const auto folder = freshFolder("landmarks-unchanged");
  const auto scene = writeBoxScene(folder);
  const auto before = runToReport(scene, {"--steps", "10"});
  const auto more = writeFile(folder / "in.csv", "name,x_mm,y_mm,z_mm\na,250,100,50\n").string();
  const auto after = runToReport(scene, {"--steps", "10", "--landmarks", more});
  CHECK(before["state_hash"] == after["state_hash"]);
  CHECK(before["probes"] == after["probes"]);
  CHECK(before["landmarks"].empty());
}

TEST_CASE("Landmarks that cannot be used end the run before its first step") {
  const auto folder = freshFolder("landmarks-refused");
  const auto scene = writeBoxScene(folder, "[[landmark]]\nname = \"apex\"\nat = [0.5, 0.1, 0.1]\n").string();
  const auto far = freshFolder("landmarks-refused-far");
  const auto farScene = writeBoxScene(far, "[[landmark]]\nname = \"off\"\non = \"box\"\nat = [0, 0, 5]\n").string();
  const auto same = writeFile(folder / "same.csv", "name,x_mm,y_mm,z_mm\napex,0,0,0\n").string();
  const auto other = writeFile(folder / "other.csv", "name,x_mm,y_mm,z_mm\nabex,0,0,0\n").string();
  const struct {
    std::vector<std::string> arguments;
    int exitCode;
    const char *contains;
  } cases[] = {
      {{scene, "--landmarks", same}, 3, "same.csv:2: a second landmark is named 'apex', the first is in "},
      {{scene, "--target-landmarks", other}, 3, "other.csv:2: there is no landmark 'abex'; did you mean 'apex'?"},
      {{scene, "--landmarks", (folder / "box.obj").string()}, 3, "accepted: .csv, .fcsv, .mrk.json"},
      {{scene, "--landmarks", (folder / "absent.csv").string()}, 3, "absent.csv: no such file"},
      {{scene, "--export-landmarks", (folder / "out.json").string()}, 2, "accepted: .csv, .fcsv, .mrk.json"},
      {{scene, "--landmarks", other, "--export-landmarks", other}, 2, "other.csv"},
      {{(folder / "box.obj").string(), "--export-landmarks", (folder / "out.csv").string()}, 2, "needs landmarks"},
      {{farScene}, 3, "box.toml:18: landmark 'off': "},
  };
  for (const auto &one : cases) {
    std::vector<std::string> arguments{"run", "--until", "1e6"};
    arguments.insert(arguments.end(), one.arguments.begin(), one.arguments.end());
    const auto result = runC3de(arguments);
    INFO(result.errorOutput);
    CHECK(result.exitCode == one.exitCode);
    CHECK_THAT(result.errorOutput, Contains(one.contains));
  }
  CHECK_FALSE(std::filesystem::exists(folder / "out.csv"));
}

TEST_CASE("The landmarks of a scene are listed") {
  const auto scene = writeBoxScene(freshFolder("landmarks-listed"), R"([[landmark]]
name = "apex"
at = [0.5, 0.1, 0.1]
target = [0.5, 0.1, 0.2]
[[landmark]]
name = "base"
on = "box"
at = [0, 0.1, 0.1]
[[distance]]
between = ["apex", "base"]
)");
  const auto result = runC3de({"info", "--quick", scene.string()});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  for (const char *text :
       {"landmark \"apex\" at 500, 100, 100 mm, target 500, 100, 200 mm",
        "landmark \"base\" of body \"box\" at 0, 100, 100 mm", "distance \"distance-1\" between \"apex\" and \"base\""})
    CHECK_THAT(result.output, Contains(text));
}
