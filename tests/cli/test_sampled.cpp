// SPDX-License-Identifier: Apache-2.0
// Tracked material points, and report values for comparisons: times of steps, the start, volumes.
#include <algorithm>
#include <sstream>

#include "c3de/core/csv.h"
#include "program.h"

namespace {

std::vector<std::vector<std::string>> rowsOf(const std::filesystem::path &file) {
  std::istringstream in(readFile(file));
  std::vector<std::vector<std::string>> rows;
  for (std::string row; std::getline(in, row);) rows.push_back(c3de::splitCsvRow(row).value());
  return rows;
}

}  // namespace

TEST_CASE("Points are where probes at the same places are, and nothing else of the run changes") {
  const auto folder = freshFolder("sampled");
  const auto scene =
      writeBoxScene(folder, "[[fix]]\nregion = { box = { min = [0, 0, 0], max = [0.1, 1, 1] } }\n").string();
  const auto points =
      writeFile(folder / "points.csv", "body,x [m],y [m],z [m]\nbox,0.9,0.1,0.1\nbox,0.05,0.1,0.1\nbox,1,0.2,0.2\n");
  const auto plain = runC3de({"run", scene, "--steps", "40", "--report", (folder / "plain.json").string()});
  REQUIRE(plain.exitCode == 0);
  const auto result = runC3de({"run", scene, "--steps", "40", "--report", (folder / "r.json").string(),
                               "--sample-points", points.string(), "--sampled", (folder / "out.csv").string()});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  const auto report = readJson(folder / "r.json"), before = readJson(folder / "plain.json");
  CHECK(report["state_hash"] == before["state_hash"]);
  CHECK(report["probes"] == before["probes"]);
  const auto rows = rowsOf(folder / "out.csv");
  REQUIRE(rows.size() == 4);
  CHECK(rows[0] == std::vector<std::string>{"body", "x [m]", "y [m]", "z [m]", "x at the end [m]", "y at the end [m]",
                                            "z at the end [m]"});
  for (std::size_t a = 0; a < 3; ++a)
    CHECK(std::stod(rows[1][4 + a]) == report["probes"][0]["position_m"][a].get<double>());
  CHECK(std::stod(rows[1][5]) < 0.0);                   // it bends
  CHECK(std::abs(std::stod(rows[2][5]) - 0.1) < 0.05);  // almost none where it is held
}

TEST_CASE("Points that cannot be followed are refused before the first step, with their line") {
  const auto folder = freshFolder("sampled-refused");
  const auto scene = writeBoxScene(folder).string();
  const auto out = (folder / "out.csv").string();
  const struct {
    const char *row, *contains;
  } cases[] = {{"box,5,0,0", "points.csv:2: "},
               {"bax,0,0,0", "points.csv:2: there is no body 'bax'; did you mean 'box'?"}};
  for (const auto &one : cases) {
    const auto points =
        writeFile(folder / "points.csv", std::string("body,x [m],y [m],z [m]\n") + one.row + "\n").string();
    const auto result = runC3de({"run", scene, "--until", "1e6", "--sample-points", points, "--sampled", out});
    INFO(result.errorOutput);
    CHECK(result.exitCode == 3);
    CHECK_THAT(result.errorOutput, Contains(one.contains));
  }
  CHECK_FALSE(std::filesystem::exists(out));
  CHECK(runC3de({"run", scene, "--sampled", out}).exitCode == 2);
  const auto points = (folder / "points.csv").string();
  CHECK(runC3de({"run", scene, "--sample-points", points, "--sampled", points}).exitCode == 2);
}

TEST_CASE("A report has the times of steps, what is conserved at the start, and the volume of skins") {
  const auto folder = freshFolder("report-start");
  const auto scene = writeBoxScene(folder, "").string();
  REQUIRE(runC3de({"run", scene, "--steps", "30", "--set", "body.box.velocity=[1,0,0]", "--report",
                   (folder / "r.json").string()})
              .exitCode == 0);
  const auto report = readJson(folder / "r.json");
  const auto &times = report["step_ms"];
  CHECK(times["median"] > 0.0);
  CHECK(times["median"] <= times["p99"]);
  CHECK(times["p99"] <= times["max"]);
  CHECK(times["max"].get<double>() <= 1e3 * report["wall_s"].get<double>() * 1.001);
#if defined(_WIN32)
  CHECK(report["cpu_s"] >= 0.0);  // counted in ticks of 10 to 16 ms
#else
  CHECK(report["cpu_s"] > 0.0);
#endif
  const double mass = report["bodies"][0]["mass_kg"];
  CHECK(report["start"][0]["name"] == "box");
  CHECK_THAT(report["start"][0]["momentum"][0].get<double>(), WithinRel(mass, 1e-9));
  CHECK_THAT(report["start"][0]["energy_J"]["kinetic"].get<double>(), WithinRel(0.5 * mass, 1e-9));
  CHECK(report["start"][0]["momentum"][1] == 0.0);
  CHECK(report["bodies"][0]["momentum"][1] < 0.0);  // it falls
  CHECK_THAT(report["bodies"][0]["skin_volume_m3"]["reference"].get<double>(), WithinRel(0.04, 1e-9));
  CHECK_THAT(report["bodies"][0]["skin_volume_m3"]["end"].get<double>(), WithinRel(0.04, 1e-3));
}

TEST_CASE("The energies over time add up for a box that falls freely") {
  const auto folder = freshFolder("energies");
  const auto scene = writeBoxScene(folder).string();
  REQUIRE(runC3de({"run", scene, "--steps", "600", "--energies", (folder / "e.csv").string(), "--report",
                   (folder / "r.json").string()})
              .exitCode == 0);
  const auto rows = rowsOf(folder / "e.csv");
  CHECK(rows.size() > 150);
  CHECK(rows.size() < 250);
  const auto at = [&](const char *name) {
    return static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin());
  };
  REQUIRE(at("gravity [J]") < rows[0].size());
  REQUIRE(at("kinetic [J]") < rows[0].size());
  for (std::size_t i = 2; i < rows.size(); ++i) {
    CHECK(std::stod(rows[i][0]) > std::stod(rows[i - 1][0]));
    CHECK_THAT(std::stod(rows[i][at("kinetic [J]")]), WithinRel(-std::stod(rows[i][at("gravity [J]")]), 1e-6));
  }
  CHECK(std::stod(rows.back()[at("kinetic [J]")]) ==
        readJson(folder / "r.json")["bodies"][0]["energy_J"]["kinetic"].get<double>());
}
