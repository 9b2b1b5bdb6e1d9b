// SPDX-License-Identifier: Apache-2.0
// `c3de match`: what was measured, and what it answers.
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "c3de/geometry/rigid_fit.h"
#include "json_schema.h"
#include "program.h"

namespace fs = std::filesystem;
using namespace c3de;  // Vec3 is a std::array: its operators are not found by its type
using nlohmann::json;

namespace {

fs::path resource(const char *name) { return fs::path(testResourcesFolder()) / name; }
std::string organScene() { return resource("scenes/first_light.toml").string(); }
std::string organPoints() { return resource("match/organ_points.csv").string(); }

/// The measured motion of resources/match.
c3de::Mat4 organMotion() {
  return c3de::geometry::matrixOf({.translation_mm = {120, -45, 80}, .rotation_deg = {25, -40, 70}, .centre_mm = {}});
}

c3de::Mat4 motionIn(const json &match) {
  c3de::Mat4 out{};
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = 0; c < 4; ++c) out[4 * c + r] = match["motion"]["matrix"][r][c].get<double>();
  return out;
}

struct Answer {
  c3de::ProcessResult result;
  json report;
};

Answer matched(const std::string &name, const std::string &scene, std::vector<std::string> options) {
  const fs::path report = freshFolder("match_report_" + name) / "report.json";
  std::vector<std::string> arguments{"match", scene, "--report", report.string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  Answer out{runC3de(arguments), {}};
  if (fs::exists(report)) out.report = readJson(report);
  return out;
}

std::string refusal(std::vector<std::string> options, int exitCode) {
  std::vector<std::string> arguments{"match", organScene()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const auto result = runC3de(arguments);
  INFO(result.errorOutput);
  CHECK(result.exitCode == exitCode);
  return result.errorOutput;
}

/// Rows of the points of resources/match, each changed.
template <class Change>
fs::path changedPoints(const fs::path &file, Change change) {
  std::istringstream in(readFile(organPoints()));
  std::ostringstream out;
  std::string row;
  while (std::getline(in, row)) {
    std::array<double, 3> p{};
    if (std::sscanf(row.c_str(), "%lf,%lf,%lf", &p[0], &p[1], &p[2]) != 3) continue;
    change(p);
    out << p[0] << ',' << p[1] << ',' << p[2] << '\n';
  }
  return writeFile(file, out.str());
}

}  // namespace

TEST_CASE("A body is brought to measured points, and the report fits the schema") {
  const fs::path folder = freshFolder("match_outputs");
  const Answer out =
      matched("points", organScene(),
              {"--points", organPoints(), "--residuals", (folder / "r.csv").string(), "--export-surface",
               (folder / "moved.stl").string(), "--landmarks", resource("match/organ_landmarks.csv").string(),
               "--target-landmarks", resource("match/organ_landmarks_measured.csv").string()});
  INFO(out.result.errorOutput << out.result.output);
  REQUIRE(out.result.exitCode == 0);
  CHECK_THAT(out.result.output, Contains("rigid motion found") && Contains("not for clinical use"));
  const json schema = readJson(resource("schemas/report.schema.json"));
  for (const std::string &departure : departuresFrom(schema, out.report)) FAIL_CHECK(departure);
  const json &match = out.report["match"];
  CHECK(match["verdict"] == "found");
  CHECK(match["converged"] == true);
  CHECK(match["candidates"].size() == 1);
  CHECK(match["points"] == 500);
  CHECK_THAT(match["surface_rms_mm"]["rigid"].get<double>(), WithinAbs(1.0, 0.25));
  CHECK(match["surface_rms_mm"]["before"].get<double>() > 20.0);
  CHECK_THAT(match["inlier_share"].get<double>(), WithinAbs(0.92, 0.05));
  CHECK_THAT(match["coverage"].get<double>(), WithinAbs(0.33, 0.1));
  const c3de::Mat4 motion = motionIn(match), truth = organMotion();
  // Corners of the box around the organ, of which a third was measured: the rotation is known to some degrees.
  for (const c3de::Vec3 &corner : {c3de::Vec3{-68, 110, -76}, c3de::Vec3{136, 210, 58}, c3de::Vec3{28, 160, 0}})
    CHECK(norm(transformPoint(motion, corner) - transformPoint(truth, corner)) < 9.0);
  // Landmarks judge: they are errors of the motion, from those 200 mm away.
  CHECK(match["landmark_error_mm"]["before"]["mean"].get<double>() > 100.0);
  CHECK(match["landmark_error_mm"]["rigid"]["max"].get<double>() < 6.0);
  CHECK(match["landmarks"][0]["use"] == "judge");
  CHECK(out.report["steps"] == 0);
  CHECK(fs::file_size(folder / "moved.stl") > 10000);
  std::istringstream rows(readFile(folder / "r.csv"));
  std::string row;
  std::size_t count = 0;
  while (std::getline(rows, row)) ++count;
  CHECK(count == 501);
}

TEST_CASE("A scene says what was measured, and options replace it") {
  const fs::path folder = freshFolder("match_scene");
  fs::copy_file(resource("meshes/organ.obj"), folder / "organ.obj");
  fs::copy_file(organPoints(), folder / "points.csv");
  const std::string body =
      "format = 1\n[[body]]\nname = \"organ\"\nmesh = \"organ.obj\"\nmesh_unit = \"mm\"\nposition = [0.028, 0.16, "
      "0.0]\n"
      "material = { law = \"linear\", youngs_modulus = 6e3, poisson_ratio = 0.45, density = 1060.0 }\n"
      "sampling = { count = 500 }\n[match]\n";
  const std::string scene = (folder / "scene.toml").string();
  writeFile(scene, body + "points = \"points.csv\"\nnoise_mm = 1.0\n");
  const Answer out = matched("of_scene", scene, {});
  INFO(out.result.errorOutput);
  CHECK(out.result.exitCode == 0);
  CHECK(out.report["match"]["body"] == "organ");
  // The surface itself, at rest, in place of the points.
  const Answer surface = matched("of_option", scene, {"--surface", (folder / "organ.obj").string(), "-q"});
  INFO(surface.result.errorOutput);
  CHECK(surface.result.exitCode == 0);
  CHECK(surface.result.output.empty());
  CHECK(surface.report["match"]["points"] == 1500);
  const c3de::Vec3 moved = transformPoint(motionIn(surface.report["match"]), {28, 160, 0});
  CHECK_THAT(norm(moved), WithinAbs(0.0, 1.5));

  const auto refused = [&](const std::string &keys) {
    writeFile(scene, body + keys);
    const auto result = runC3de({"match", scene});
    CHECK(result.exitCode == 3);
    return result.errorOutput;
  };
  CHECK_THAT(refused("noise_mm = 1.0\n"), Contains("scene.toml:9") && Contains("nothing that was measured"));
  CHECK_THAT(refused("points = \"points.csv\"\nsurface = \"organ.obj\"\n"), Contains("several sources"));
  CHECK_THAT(refused("points = \"points.csv\"\nnoise_mm = 0\n"), Contains("noise_mm is 0"));
  CHECK_THAT(refused("points = \"points.csv\"\nnoise = 1\n"), Contains("unknown key 'noise' in [match]"));
  CHECK_THAT(refused("points = \"nothing.csv\"\n"), Contains("nothing.csv' does not exist"));
  CHECK_THAT(refused("points = \"points.csv\"\nbody = \"organs\"\n"), Contains("did you mean 'organ'"));
  CHECK_THAT(refused("points = \"points.csv\"\nlabel = 1\n"), Contains("'label' and no 'labels'"));
  CHECK_THAT(refused("points = \"points.csv\"\nuse = \"fit\"\n"), Contains("no 'landmarks'"));
  CHECK_THAT(refused("points = \"points.csv\"\nrigid_first = false\ndeform = false\n"), Contains("nothing is found"));
}

TEST_CASE("Hostile points are refused with file, line and value") {
  const fs::path folder = freshFolder("match_hostile");
  const auto points = [&](const char *name, const std::string &text) {
    return writeFile(folder / name, text).string();
  };
  CHECK_THAT(refusal({}, 2), Contains("nothing that was measured") && Contains("--points"));
  CHECK_THAT(refusal({"--points", points("nan.csv", "x,y,z\n1,2,3\n1,nan,3\n")}, 3), Contains("nan.csv:3: y is 'nan'"));
  CHECK_THAT(refusal({"--points", points("four.csv", "1,2,3,4\n")}, 3), Contains("four.csv:1: the row has 4 numbers"));
  CHECK_THAT(refusal({"--points", points("column.csv", "x,y,w\n1,2,3\n")}, 3), Contains("column 'z' is missing"));
  CHECK_THAT(refusal({"--points", points("empty.csv", "x,y,z\n")}, 3), Contains("empty.csv: has no point"));
  CHECK_THAT(refusal({"--points", points("five.csv", "1,2,3\n4,5,6\n7,8,9\n1,5,9\n2,2,2\n")}, 3),
             Contains("five.csv: 5 measured points; accepted: at least 12"));
  CHECK_THAT(refusal({"--points", organPoints(), "--weight", "3"}, 2), Contains("--weight"));
  CHECK_THAT(refusal({"--points", organPoints(), "--body", "liver"}, 2), Contains("no body 'liver'"));

  const auto metres = changedPoints(folder / "metres.csv", [](auto &p) {
    for (double &x : p) x *= 1e-3;
  });
  CHECK_THAT(refusal({"--points", metres.string()}, 3), Contains("metres.csv") && Contains("multiply them by 1000"));
  CHECK(runC3de({"match", organScene(), "--points", metres.string(), "--measured-unit", "m"}).exitCode == 0);
}

TEST_CASE("Points that fit in several ways are ambiguous, with candidates") {
  // The end of a box: it fits at both ends, in eight ways.
  const fs::path folder = freshFolder("match_box");
  const fs::path scene = writeBoxScene(folder);
  std::string text;
  for (int i = 0; i < 20; ++i)
    for (int k = 0; k < 20; ++k) text += "0," + std::to_string(10 * i + 5) + "," + std::to_string(10 * k + 5) + "\n";
  const Answer out =
      matched("box", scene.string(), {"--points", writeFile(folder / "end.csv", text).string(), "--noise", "1"});
  INFO(out.result.errorOutput);
  CHECK(out.result.exitCode == 1);
  CHECK(out.report["match"]["verdict"] == "ambiguous");
  CHECK(out.report["match"]["candidates"].size() > 1);
  CHECK_THAT(out.result.output, Contains("candidate 2"));
}

TEST_CASE("A bent beam is matched to a part of its surface, and continues from there") {
  const fs::path folder = freshFolder("match_bent");
  writeFile(
      folder / "beam.obj",
      "v 0 0 0\nv 200 0 0\nv 200 40 0\nv 0 40 0\nv 0 0 40\nv 200 0 40\nv 200 40 40\nv 0 40 40\n"
      "f 1 4 3\nf 1 3 2\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 4 8 7\nf 4 7 3\nf 1 5 8\nf 1 8 4\nf 2 3 7\nf 2 7 6\n");
  const auto beam = [](const std::string &modulus) {
    return "format = 1\n[world]\ngravity = [0, 0, 0]\n[solver]\nintegrator = \"quasistatic\"\n"
           "[[body]]\nname = \"beam\"\nmesh = \"beam.obj\"\nmesh_unit = \"mm\"\n"
           "material = { law = \"neo_hookean\", youngs_modulus = " +
           modulus +
           ", poisson_ratio = 0.4, density = 1000.0 }\nsampling = { spacing = 0.01 }\n"
           "[[fix]]\nregion = { box = { min = [-1, -1, -1], max = [0.0001, 1, 1] } }\n"
           "[[landmark]]\nname = \"middle\"\nat = [0.1, 0.02, 0.02]\n"
           "[[landmark]]\nname = \"tip\"\nat = [0.19, 0.02, 0.02]\n";
  };
  writeFile(
      folder / "bent.toml",
      beam("1e4") + "[[load]]\nregion = { box = { min = [0.1999, -1, -1], max = [1, 1, 1] } }\nforce = [0, 0, -0.1]\n");
  const fs::path truth = folder / "truth.json", skin = folder / "bent.stl";
  REQUIRE(
      runC3de({"run", (folder / "bent.toml").string(), "--report", truth.string(), "--export-surface", skin.string()})
          .exitCode == 0);
  std::string targets = "name,x_mm,y_mm,z_mm\n";
  const json bent = readJson(truth);
  for (const json &one : bent["landmarks"]) {
    targets += one["name"].get<std::string>();
    for (std::size_t a = 0; a < 3; ++a) targets += "," + std::to_string(one["position_mm"][a].get<double>());
    targets += "\n";
  }
  writeFile(folder / "targets.csv", targets);
  // Twice as stiff as the beam that was measured; the position is given.
  writeFile(folder / "match.toml", beam("2e4") +
                                       "[match]\nsurface = \"bent.stl\"\nlandmarks = \"targets.csv\"\n"
                                       "rigid_first = false\nnoise_mm = 0.5\n");
  const fs::path session = folder / "matched.c3de";
  const Answer out = matched("bent", (folder / "match.toml").string(),
                             {"--save-session", session.string(), "--residuals", (folder / "r.csv").string()});
  INFO(out.result.errorOutput << out.result.output);
  REQUIRE(out.result.exitCode == 0);
  const json schema = readJson(resource("schemas/report.schema.json"));
  for (const std::string &departure : departuresFrom(schema, out.report)) FAIL_CHECK(departure);
  const json &match = out.report["match"];
  CHECK(match["stage"] == "elastic");
  CHECK(match["verdict"] == "given");
  const double before = match["landmark_error_mm"]["before"]["mean"],
               after = match["landmark_error_mm"]["after"]["mean"];
  INFO("landmarks " << before << " mm before, " << after << " mm after");
  CHECK(before > 5.0);
  // The surface is seen from all sides; its points are exact, the landmarks inside follow.
  CHECK(after < 0.06 * before);
  CHECK(match["surface_rms_mm"]["after"].get<double>() < 0.5);
  CHECK(match["forces"][0]["sum_N"].get<double>() > 0.05);
  // Rigid alone, with the same scene, finds no better position.
  const Answer rigid = matched("bent_rigid", (folder / "match.toml").string(),
                               {"--set", "match.rigid_first=true", "--rigid", "--noise", "5"});
  INFO(rigid.result.errorOutput);
  CHECK(rigid.report["match"]["stage"] == "rigid");
  CHECK(rigid.report["match"]["landmark_error_mm"]["rigid"]["mean"].get<double>() > after);

  // Noise that is stated far too small is found to be, and a plate that is not the beam has no small expected error.
  const Answer precise = matched("bent_noise", (folder / "match.toml").string(), {"--noise", "0.001"});
  CHECK(precise.report["match"]["surface_rms_mm"]["after"].get<double>() < 0.01);
  CHECK(precise.report["match"]["landmark_error_mm"]["after"]["mean"].get<double>() < 0.06 * before);
  writeFile(
      folder / "plate.obj",
      "v 0 0 0\nv 200 0 0\nv 200 2 0\nv 0 2 0\nv 0 0 40\nv 200 0 40\nv 200 2 40\nv 0 2 40\n"
      "f 1 4 3\nf 1 3 2\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 4 8 7\nf 4 7 3\nf 1 5 8\nf 1 8 4\nf 2 3 7\nf 2 7 6\n");
  const Answer plate = matched("bent_plate", (folder / "match.toml").string(),
                               {"--set", "body.beam.mesh=" + (folder / "plate.obj").string()});
  CHECK(plate.report["match"]["elastic"]["expected_error_mm"].get<double>() > 20.0);
  CHECK_THAT(plate.result.output, Contains("at least") && Contains("100 % of the body is hardly determined"));
  CHECK(plate.report["match"]["warnings"].size() >= 1);
  for (const std::string &departure : departuresFrom(schema, plate.report)) FAIL_CHECK(departure);

  const fs::path later = folder / "later.json";
  REQUIRE(runC3de({"run", session.string(), "--steps", "20", "--report", later.string()}).exitCode == 0);
  const json end = readJson(later), start = readJson(truth);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t a = 0; a < 3; ++a)
      CHECK_THAT(end["landmarks"][i]["position_mm"][a].get<double>(),
                 WithinAbs(start["landmarks"][i]["position_mm"][a].get<double>(), 0.2 * before));
}

TEST_CASE("Landmarks of another body take no part, and distances of the scene do not matter") {
  const fs::path folder = freshFolder("match_two_bodies");
  std::string scene = readFile(organScene());
  const std::string meshes = resource("meshes").generic_string();
  for (std::size_t at = 0; (at = scene.find("../meshes", at)) != std::string::npos;) scene.replace(at, 9, meshes);
  scene +=
      "\n[[body]]\nname = \"small\"\nmesh = \"" + meshes +
      "/organ.obj\"\nmesh_unit = \"mm\"\nscale = 0.3\nposition = [0.028, 0.26, 0.0]\nmaterial = { law = "
      "\"neo_hookean\", youngs_modulus = 6e3, poisson_ratio = 0.45, density = 1060.0 }\nsampling = { count = 200 }\n"
      "[[landmark]]\nname = \"rim\"\non = \"organ\"\nat = [0.12, 0.16, 0.0]\n"
      "[[landmark]]\nname = \"small\"\non = \"small\"\nat = [0.028, 0.26, 0.0]\n"
      "[[distance]]\nname = \"apart\"\nbetween = [\"rim\", \"small\"]\n";
  writeFile(folder / "two.toml", scene);
  const std::string targets =
      writeFile(folder / "targets.csv", "name,x_mm,y_mm,z_mm\nrim,0.31,50.13,208.93\nsmall,500,500,500\n").string();
  const std::vector<std::string> options{"--body", "organ", "--points", organPoints(), "--target-landmarks",
                                         targets,  "--use", "fit"};
  const Answer out = matched("two_bodies", (folder / "two.toml").string(), options);
  INFO(out.result.errorOutput << out.result.output);
  REQUIRE(out.result.exitCode == 0);
  const json &landmarks = out.report["match"]["landmarks"];
  REQUIRE(landmarks.size() == 1);
  CHECK(landmarks[0]["name"] == "rim");
  CHECK(landmarks[0]["error_mm"]["after"].get<double>() < 4.0);
  writeFile(folder / "targets.csv", "name,x_mm,y_mm,z_mm\nsmall,500,500,500\n");
  const Answer none = matched("two_bodies", (folder / "two.toml").string(), options);
  CHECK(none.result.exitCode == 2);
  CHECK_THAT(none.result.errorOutput, Contains("no landmark of body 'organ'"));
}

TEST_CASE("The lung: masks of two breathing states, and the landmark error after the rigid motion") {
  C3DE_DATA_OR_SKIP(data, "match/lung");
  const fs::path folder = freshFolder("match_lung");
  const auto landmarks = [&](const char *name, const c3de::Vec3 &offset) {
    std::istringstream in(readFile(data / (std::string(name) + "_points_index.txt")));
    std::string word;
    std::size_t count = 0;
    in >> word >> count;
    std::string table = "name,x_mm,y_mm,z_mm\n";
    for (std::size_t i = 0; i < count; ++i) {
      c3de::Vec3 index{};
      in >> index[0] >> index[1] >> index[2];
      // Spacing of both masks, from their headers.
      table += "p" + std::to_string(i) + "," + std::to_string(offset[0] + 1.366 * index[0]) + "," +
               std::to_string(offset[1] + 1.366 * index[1]) + "," + std::to_string(offset[2] + 2.5 * index[2]) + "\n";
    }
    return writeFile(folder / (std::string(name) + ".csv"), table).string();
  };
  const fs::path scene = folder / "lung.toml";
  writeFile(scene, "format = 1\n[[body]]\nname = \"lung\"\nvolume = \"" +
                       (data / "3DCT_lung_baseline_mask.mha").generic_string() +
                       "\"\nlabel = 1\nmaterial = { law = \"neo_hookean\", youngs_modulus = 5e3, poisson_ratio = 0.3, "
                       "density = 300.0 }\nsampling = { count = 1000 }\n");
  const Answer out = matched("lung", scene.string(),
                             {"--labels", (data / "3DCT_lung_followup_mask.mha").string(), "--label", "1", "--noise",
                              "10", "--landmarks", landmarks("baseline", {-153.827, -150.352, -1434.5}),
                              "--target-landmarks", landmarks("followup", {-161.831, -162.449, -1399.5})});
  INFO(out.result.errorOutput);
  REQUIRE(out.result.exitCode == 0);
  std::cout << out.result.output;
  const json &error = out.report["match"]["landmark_error_mm"];
  CHECK_THAT(error["before"]["mean"].get<double>(), WithinAbs(34.0, 2.0));
  // Measured: 6.5 mm from the masks alone. The best rigid motion of the landmarks themselves leaves about 4 mm.
  CHECK(error["rigid"]["mean"].get<double>() < 8.0);
  if (error.contains("after")) CHECK(error["after"]["mean"].get<double>() < 8.0);
}
