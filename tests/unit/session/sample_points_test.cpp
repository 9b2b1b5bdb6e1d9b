// SPDX-License-Identifier: Apache-2.0
// Points as files; the simulators' results for them are tested through the program (test_sampled.cpp).
#include "c3de/session/sample_points.h"

#include <fstream>

#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
namespace fs = std::filesystem;

namespace {

fs::path write(const std::string &text) {
  const fs::path file = testOutputFolder() / "points.csv";
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

}  // namespace

TEST_CASE("Points are read in any order of columns, others are left alone, and come back as they were written") {
  const auto read =
      readSamplePoints(write("z [m],what,body,x [m],y [m]\n3,a,\"left, upper\",1e-3,0.1\n\n-1,b,beam,0,0\n"));
  REQUIRE(read);
  REQUIRE(read->size() == 2);
  CHECK(read->front().body == "left, upper");
  CHECK(read->front().at_m == Vec3{1e-3, 0.1, 3.0});
  CHECK(read->front().line == 2);
  CHECK(read->back().line == 4);
  const fs::path again = testOutputFolder() / "again.csv";
  REQUIRE(writeSamplePoints(again, *read));
  const auto back = readSamplePoints(again);
  REQUIRE(back);
  CHECK(back->front().body == "left, upper");
  CHECK(back->front().at_m == read->front().at_m);
  const fs::path sampled = testOutputFolder() / "sampled.csv";
  REQUIRE(writeSampled(sampled, *read, {{0.1, 0.2, 1.0 / 3.0}, {4, 5, 6}}));
  const auto positions = readSampled(sampled);
  REQUIRE(positions);
  CHECK(positions->front() == Vec3{0.1, 0.2, 1.0 / 3.0});
}

TEST_CASE("What is wrong with a table of points is said with file and line") {
  const struct {
    const char *text, *contains;
  } cases[] = {
      {"", "is empty"},
      {"body,x [m],y [m]\nb,0,0\n", "points.csv:1: the column 'z [m]' is missing"},
      {"body,x [m],y [m],z [m]\n", "no point after the heading"},
      {"body,x [m],y [m],z [m]\nb,0,0,0\nb,0,1mm,0\n", "points.csv:3: '1mm' is not a number"},
      {"body,x [m],y [m],z [m]\nb,0,nan,0\n", "'nan' is not a number"},
      {"body,x [m],y [m],z [m]\nb,0,0\n", "points.csv:2: the row has not the 4 cells"},
      {"body,x [m],y [m],z [m]\n\"b,0,0,0\n", "points.csv:2: the row has not the 4 cells"},
  };
  for (const auto &one : cases) {
    const auto read = readSamplePoints(write(one.text));
    INFO(one.text);
    REQUIRE_FALSE(read);
    CHECK(read.error().code == ErrorCode::input);
    CHECK_THAT(read.error().message, Contains(one.contains));
  }
  CHECK_THAT(readSamplePoints(testOutputFolder() / "absent.csv").error().message, Contains("no such file"));
}

TEST_CASE("Points of a body that is not there name the nearest, and a simulator that adds no probe is told") {
  c3de::test::RecordingSimulator simulator;
  simulator.bodies = {c3de::test::cubeBody(0.1, {}, {})};
  const auto absent = positionsOf(simulator.object(), {{"bdy", {}, 3}}, "p.csv", {});
  REQUIRE_FALSE(absent);
  CHECK(absent.error().message == "p.csv:3: there is no body 'bdy'; did you mean 'body'?");
  simulator.fail("add_probe", C3DE_E_ARG);
  const auto refused = positionsOf(simulator.object(), {{"body", {}, 2}}, "p.csv", {});
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("p.csv:2: the point cannot be followed"));
  simulator.failNowhere();
  CHECK_THAT(positionsOf(simulator.object(), {{"body", {}, 2}}, "p.csv", {}).error().message,
             Contains("0 probes where 1 were added"));
}
