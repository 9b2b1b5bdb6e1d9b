// SPDX-License-Identifier: Apache-2.0
// `c3de match --frames`: a sequence of points.
#include <array>
#include <sstream>

#include "json_schema.h"
#include "program.h"

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

fs::path resource(const char *name) { return fs::path(testResourcesFolder()) / name; }
std::string organScene() { return resource("scenes/first_light.toml").string(); }

/// The points of resources/match, moved by x mm.
std::vector<std::array<double, 3>> pointsAt(double x_mm) {
  std::istringstream in(readFile(resource("match/organ_points.csv")));
  std::vector<std::array<double, 3>> out;
  std::string row;
  while (std::getline(in, row)) {
    std::array<double, 3> p{};
    if (std::sscanf(row.c_str(), "%lf,%lf,%lf", &p[0], &p[1], &p[2]) != 3) continue;
    p[0] += x_mm;
    out.push_back(p);
  }
  return out;
}

/// A table of frames 2 mm apart.
std::string table(int frames) {
  std::ostringstream out;
  out << "time_s,x,y,z\n";
  for (int k = 0; k < frames; ++k)
    for (const auto &p : pointsAt(2.0 * k)) out << 0.5 * k << ',' << p[0] << ',' << p[1] << ',' << p[2] << '\n';
  return out.str();
}

std::string refusal(const fs::path &frames, int exitCode, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments{"match", organScene(), "--frames", frames.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const auto result = runC3de(arguments);
  INFO(result.errorOutput);
  CHECK(result.exitCode == exitCode);
  return result.errorOutput;
}

}  // namespace

TEST_CASE("Frames of a table are matched one after the other, with table, report and timeline") {
  const fs::path folder = freshFolder("match_frames");
  const fs::path frames = writeFile(folder / "frames.csv", table(3));
  const auto result =
      runC3de({"match", organScene(), "--frames", frames.string(), "--report", (folder / "report.json").string(),
               "--frame-table", (folder / "table.csv").string(), "--timeline", (folder / "out.pvd").string(),
               "--save-session", (folder / "last.c3de").string()});
  INFO(result.errorOutput << result.output);
  REQUIRE(result.exitCode == 0);
  CHECK_THAT(result.output, Contains("3 of 3 frames") && Contains("not for clinical use"));
  const json report = readJson(folder / "report.json");
  const json schema = readJson(resource("schemas/report.schema.json"));
  for (const std::string &departure : departuresFrom(schema, report)) FAIL_CHECK(departure);
  const json &rows = report["match"]["frames"];
  REQUIRE(rows.size() == 3);
  CHECK(rows[0]["verdict"] == "found");
  double first = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    CAPTURE(k);
    CHECK(rows[k]["time_s"] == 0.5 * static_cast<double>(k));
    CHECK(rows[k]["converged"] == true);
    CHECK(rows[k]["surface_rms_mm"]["after"].get<double>() < 1.3);
    // The measurement moves as a whole. A third of the surface determines the motion to some millimetres.
    const double x = rows[k]["motion"]["translation_mm"][0];
    if (k == 0) first = x;
    CHECK_THAT(x - first, WithinAbs(2.0 * static_cast<double>(k), 3.0));
  }
  CHECK(rows[1]["verdict"] == "given");
  CHECK(rows[1]["iterations"].get<int>() <= rows[0]["iterations"].get<int>());
  std::istringstream lines(readFile(folder / "table.csv"));
  std::string row;
  std::size_t count = 0;
  while (std::getline(lines, row)) ++count;
  CHECK(count == 4);
  CHECK_THAT(readFile(folder / "out.pvd"), Contains("timestep=\"0.5\"") && Contains("skin_000002.vtp"));
  CHECK(runC3de({"run", (folder / "last.c3de").string(), "--steps", "1", "-q"}).exitCode == 0);
}

TEST_CASE("Files of a folder are frames in the order of the numbers in their names") {
  const fs::path folder = freshFolder("match_frames_folder"), points = freshFolder("match_frames_points");
  for (const int k : {2, 10}) {
    std::ostringstream out;
    for (const auto &p : pointsAt(k)) out << p[0] << ',' << p[1] << ',' << p[2] << '\n';
    writeFile(points / ("frame" + std::to_string(k) + ".csv"), out.str());
  }
  writeFile(points / "notes.txt", "no frame");
  const auto result = runC3de({"match", organScene(), "--rigid", "--frames", points.string(), "--report",
                               (folder / "report.json").string(), "-q"});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  const json rows = readJson(folder / "report.json")["match"]["frames"];
  REQUIRE(rows.size() == 2);
  CHECK(rows[0]["frame"] == "frame2.csv");
  CHECK(rows[1]["frame"] == "frame10.csv");
  CHECK(rows[1]["time_s"].is_null());
}

TEST_CASE("Landmarks measured in some frames evaluate the result, or are fitted") {
  // Two landmarks in the first frame, one in the second, none in the third.
  const fs::path folder = freshFolder("match_frames_landmarks");
  const std::string landmarks = resource("match/organ_landmarks.csv").string();
  const std::array<const char *, 3> measured{"rim,0.31,50.13,208.93\ntop,-71.16,-13.35,166.03\n",
                                             "rim,2.31,50.13,208.93\n", ""};
  std::ostringstream text;
  text << "landmark,x,y,z,frame\n";
  for (std::size_t k = 0; k < measured.size(); ++k) {
    std::istringstream rows(measured[k]);
    for (std::string row; std::getline(rows, row);) text << row << ',' << k << '\n';
    for (const auto &p : pointsAt(2.0 * static_cast<double>(k)))
      text << ',' << p[0] << ',' << p[1] << ',' << p[2] << ',' << k << '\n';
  }
  const fs::path frames = writeFile(folder / "frames.csv", text.str());
  const auto matched = [&](const std::vector<std::string> &more) {
    std::vector<std::string> arguments{"match",         organScene(),
                                       "--frames",      frames.string(),
                                       "--landmarks",   landmarks,
                                       "--report",      (folder / "report.json").string(),
                                       "--frame-table", (folder / "table.csv").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = runC3de(arguments);
    INFO(result.errorOutput << result.output);
    REQUIRE(result.exitCode == 0);
    CHECK_THAT(result.output, Contains("  landmarks (2): ") && Contains("  landmarks (1): "));
    const json report = readJson(folder / "report.json");
    for (const std::string &departure : departuresFrom(readJson(resource("schemas/report.schema.json")), report))
      FAIL_CHECK(departure);
    return report["match"]["frames"];
  };
  const json judged = matched({});
  REQUIRE(judged.size() == 3);
  REQUIRE(judged[0]["landmarks"].size() == 2);
  CHECK(judged[0]["landmarks"][0]["name"] == "rim");
  CHECK(judged[0]["landmarks"][0]["use"] == "judge");
  CHECK(judged[1]["landmarks"].size() == 1);
  CHECK_FALSE(judged[2].contains("landmarks"));
  CHECK(judged[0]["landmark_error_mm"]["before"]["mean"].get<double>() > 100.0);
  for (const std::size_t k : {0u, 1u}) CHECK(judged[k]["landmark_error_mm"]["after"]["mean"].get<double>() < 8.0);
  CHECK(judged[0]["points"] == pointsAt(0.0).size());
  CHECK_THAT(readFile(folder / "table.csv"), Contains(",landmarks,landmark_mean_rigid_mm,landmark_mean_after_mm,"));
  const json fitted = matched({"--use", "fit", "--weight", "100"});
  CHECK(fitted[0]["landmarks"][0]["use"] == "fit");
  CHECK(fitted[0]["landmark_error_mm"]["after"]["mean"].get<double>() <
        0.5 * judged[0]["landmark_error_mm"]["after"]["mean"].get<double>());
  CHECK_THAT(refusal(frames, 3), Contains("frames.csv:2: there is no landmark 'rim'"));
  CHECK_THAT(refusal(frames, 2, {"--landmarks", landmarks, "--use", "judge", "--weight", "5"}),
             Contains("--weight is for landmarks that are fitted"));
}

TEST_CASE("Sequences that cannot be matched are refused with line and value") {
  const fs::path folder = freshFolder("match_frames_refused");
  const auto file = [&](const std::string &text) { return writeFile(folder / "frames.csv", text); };
  CHECK_THAT(refusal(file("x,y,z\n1,2,3\n"), 3), Contains("frames.csv:1: neither 'frame' nor 'time_s'"));
  CHECK_THAT(refusal(file("frame,x,y\n1,2,3\n"), 3), Contains("the column 'z' is missing"));
  CHECK_THAT(refusal(file("frame,x,y,z\n1,2,3,nan\n"), 3), Contains("frames.csv:2: z is 'nan'"));
  CHECK_THAT(refusal(file("time_s,x,y,z\n1,2,3,4\n0.5,2,3,4\n"), 3), Contains("times that increase"));
  CHECK_THAT(refusal(file("frame,x,y,z\na,2,3,4\nb,2,3,4\na,2,3,4\n"), 3), Contains("frame 'a' has rows above"));
  CHECK_THAT(refusal(file("frame,x,y,z\n"), 3), Contains("has no frame"));
  CHECK_THAT(refusal(file("frame,x,y,z\n1,2,3,4\n"), 3), Contains("frame 1 (1 of 1)"));
  CHECK_THAT(refusal(folder / "none", 3), Contains("none"));
  CHECK_THAT(refusal(freshFolder("match_frames_empty"), 3), Contains("has no file of points"));
  CHECK_THAT(refusal(file("frame,x,y,z\n1,2,3,4\n"), 2, {"--use", "fit"}), Contains("no landmark was measured"));
  CHECK_THAT(refusal(file("frame,x,y,z\n1,2,3,4\n"), 2, {"--surface", "a.obj"}), Contains("--frames"));
  CHECK_THAT(refusal(file("frame,x,y,z,landmark\n1,2,3,4,a\n1,2,3,4,a\n"), 3),
             Contains("frames.csv:3: landmark 'a' has another position in"));
  const auto alone = runC3de({"match", organScene(), "--frame-table", "-"});
  CHECK(alone.exitCode == 2);
}
