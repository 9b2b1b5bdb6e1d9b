// SPDX-License-Identifier: Apache-2.0
// The outputs of a run: report, probes, written files, time spent.
#include "c3de/session/report.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "c3de/session/probe_table.h"
#include "c3de/session/written_outputs.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::session;
using Json = nlohmann::json;

namespace {

Json reportOf(const RunFacts &facts, const std::string &simulator) {
  const auto text = reportJson(facts, simulator);
  if (!text) FAIL(text.error().message);
  return Json::parse(*text);
}

}  // namespace

TEST_CASE("A report has the run's facts, and what the simulator says stays as it is") {
  RunFacts facts;
  facts.scene = "A fall";
  facts.source = "fall.toml";
  facts.outcome = "diverged";
  facts.failure = "step 3 failed";
  facts.threads = 4;
  facts.steps = 10;
  facts.time_s = 2.0;
  facts.wall_s = 0.5;
  facts.dt_s = 0.2;
  facts.simulator = {"org.example.Sim/1", "Sim", "org.example", "1.2.3"};
  facts.stateHash = 0xabcdu;
  facts.seed = 7;
  facts.prepared.took.reading_s = 0.25;
  facts.firstStep_s = 0.125;
  Json report = reportOf(facts, R"({"bodies": [{"name": "b", "odd": [1, null]}], "stages": {"forces": 3},
                                    "reactions": [1], "notices": ["look"], "load_factor": 0.5})");
  CHECK(report["format"] == 1);
  CHECK(report["scene"] == "A fall");
  CHECK(report["source"] == "fall.toml");
  CHECK(report["outcome"] == "diverged");
  CHECK(report["failure"] == "step 3 failed");
  CHECK(report["machine"]["threads"] == 4);
  CHECK(report["steps"] == 10);
  CHECK(report["real_time_factor"] == 4.0);
  CHECK(report["dt_s"] == 0.2);
  CHECK(report["simulator"]["class"] == "org.example.Sim/1");
  CHECK(report["simulator"]["plugin"] == "org.example");
  CHECK(report["simulator"]["version"] == "1.2.3");
  CHECK(report["seed"] == 7);
  CHECK(report["preparation"]["reading_s"] == 0.25);
  CHECK(report["preparation"]["first_step_s"] == 0.125);
  CHECK(report["state_hash"] == "000000000000abcd");
  CHECK(report["bodies"] == Json::parse(R"([{"name": "b", "odd": [1, null]}])"));
  CHECK(report["stages"]["forces"] == 3);
  CHECK(report["reactions"] == Json::array({1}));
  CHECK(report["notices"] == Json::array({"look"}));
  CHECK(report["load_factor"] == 0.5);

  // Missing data are empty rather than absent.
  report = reportOf({}, R"({"integrator": "implicit"})");
  CHECK(report["integrator"] == "implicit");
  CHECK(report["probes"] == Json::array());
  CHECK(report["events"] == Json::array());
  CHECK(report["stages"] == Json::object());
  CHECK(report["real_time_factor"] == 0.0);
  for (const char *absent : {"failure", "seed", "notices", "load_factor"}) CHECK_FALSE(report.contains(absent));
}

TEST_CASE("What of a mask is in no body lessens the part that its body stands for, and is an event") {
  RunFacts facts;
  Coverage liver;
  liver.body = "liver";
  liver.requested_mm3 = 1000.0;
  liver.missing_mm3 = 250.0;
  facts.prepared.coverage = {liver};
  const Json report = reportOf(
      facts, R"({"bodies": [{"name": "spleen", "represented_part": 0.5}, {"name": "liver", "represented_part": 0.5}],
                 "events": [{"kind": "first"}]})");
  CHECK(report["bodies"][0]["represented_part"] == 0.5);
  CHECK_FALSE(report["bodies"][0].contains("not_represented_ml"));
  CHECK(report["bodies"][1]["represented_part"] == 0.375);
  CHECK(report["bodies"][1]["not_represented_ml"] == 0.25);
  REQUIRE(report["events"].size() == 2);
  CHECK(report["events"][1]["kind"] == "not_represented");
  CHECK(report["events"][1]["text"] == sentenceOf(liver));
  // A body without a reported part represents all of its input.
  CHECK(reportOf(facts, R"({"bodies": [{"name": "liver"}]})")["bodies"][0]["represented_part"] == 0.75);
}

TEST_CASE("A simulator's report that is no JSON object is of no use, and its beginning is quoted") {
  for (const std::string text : {"", "[1, 2]", "{\"bodies\": [", "a sentence that goes on"}) {
    INFO(text);
    const auto report = reportJson({}, text);
    const auto notices = noticesOf(text);
    REQUIRE_FALSE(report);
    REQUIRE_FALSE(notices);
    CHECK(report.error().code == ErrorCode::plugin);
    CHECK(report.error().message == "the simulator's report is not a JSON object; it begins with: " + text);
    CHECK(notices.error().message == report.error().message);
  }
  const auto longOne = noticesOf(std::string(1000, 'x'));
  REQUIRE_FALSE(longOne);
  CHECK_THAT(longOne.error().message, Contains(std::string(60, 'x')) && !Contains(std::string(61, 'x')));
}

TEST_CASE("Notices are the texts of the report") {
  CHECK(noticesOf("{}").value().empty());
  CHECK(noticesOf(R"({"notices": 3})").value().empty());
  CHECK(noticesOf(R"({"notices": ["a", 1, "b"]})").value() == std::vector<std::string>{"a", "b"});
}

TEST_CASE("Probes over time are a table whose names are quoted where they must be") {
  const std::filesystem::path file = testOutputFolder() / "probes.csv";
  std::vector<ProbeSample> samples{{"tip", {1, 2, 3}, {4, 5, 6}}, {"a,\"b\"", {0.1, 0, 0}, {}}};
  auto table = ProbeTable::create(file, samples);
  REQUIRE(table);
  REQUIRE(table->add(0.0, samples));
  samples[0].position_m[0] = 1.5;
  REQUIRE(table->add(0.25, samples));
  REQUIRE(table->close());
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  CHECK(
      text.str() ==
      "time [s],tip.x [m],tip.y [m],tip.z [m],tip.vx [m/s],tip.vy [m/s],tip.vz [m/s],\"a,\"\"b\"\".x [m]\","
      "\"a,\"\"b\"\".y [m]\",\"a,\"\"b\"\".z [m]\",\"a,\"\"b\"\".vx [m/s]\",\"a,\"\"b\"\".vy [m/s]\",\"a,\"\"b\"\".vz "
      "[m/s]\"\n0,1,2,3,4,5,6,0.1,0,0,0,0,0\n0.25,1.5,2,3,4,5,6,0.1,0,0,0,0,0\n");
  const auto refused = ProbeTable::create(testOutputFolder() / "nowhere" / "probes.csv", samples);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::output);
}

TEST_CASE("Probe tools stand behind the probes of a table, with the force on them") {
  const std::filesystem::path file = testOutputFolder() / "tools.csv";
  const std::vector<ProbeSample> probes{{"tip", {1, 2, 3}, {4, 5, 6}}};
  std::vector<ProbeToolSample> tools{{"finger", {0.1, 0.2, 0.3}, {}}};
  auto table = ProbeTable::create(file, probes, tools);
  REQUIRE(table);
  REQUIRE(table->add(0.0, probes, tools));
  tools[0].force_N = {0, 2.5, -1};
  REQUIRE(table->add(0.5, probes, tools));
  REQUIRE(table->close());
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  CHECK(text.str() ==
        "time [s],tip.x [m],tip.y [m],tip.z [m],tip.vx [m/s],tip.vy [m/s],tip.vz [m/s],finger.x [m],finger.y [m],"
        "finger.z [m],finger.Fx [N],finger.Fy [N],finger.Fz [N]\n"
        "0,1,2,3,4,5,6,0.1,0.2,0.3,0,0,0\n0.5,1,2,3,4,5,6,0.1,0.2,0.3,0,2.5,-1\n");
}

TEST_CASE("Of what was not written the first reason counts, and both lists are told") {
  WrittenOutputs outputs;
  CHECK(outputs.areComplete());
  CHECK(outputs.written().empty());
  outputs.note("a.json", {});
  CHECK(outputs.areComplete());
  outputs.note("b.csv", fail(ErrorCode::state, "b.csv: nothing to write"));
  outputs.addFailure("c.png", {ErrorCode::output, "c.png: No space left on device"});
  outputs.add("d.pvd");
  CHECK_FALSE(outputs.areComplete());
  CHECK(outputs.written() == "a.json, d.pvd");
  CHECK(outputs.error().code == ErrorCode::state);
  CHECK(outputs.error().message == "not completely written: b.csv, c.png; written: a.json, d.pvd");
  WrittenOutputs nothing;
  nothing.addFailure("c.png", {ErrorCode::output, "c.png: No space left on device"});
  CHECK(nothing.error().code == ErrorCode::output);
  CHECK(nothing.error().message == "not completely written: c.png; written: nothing");
}

TEST_CASE("Time spent is added, stage by stage") {
  double seconds = 1.0;
  {
    const ScopedTimer spent(seconds);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  CHECK(seconds >= 1.005);
  Preparation all{1, 2, 3, 4, 5};
  all += {0.5, 0.25, 0.125, 0.0625, 0.03125};
  CHECK(all.reading_s == 1.5);
  CHECK(all.masks_s == 2.25);
  CHECK(all.surfaces_s == 3.125);
  CHECK(all.fills_s == 4.0625);
  CHECK(all.bodies_s == 5.03125);
}
