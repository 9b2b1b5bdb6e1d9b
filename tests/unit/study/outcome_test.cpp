// SPDX-License-Identifier: Apache-2.0
// From results to errors, tables and diagrams.
#include "c3de/study/outcome.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "c3de/core/csv.h"
#include "c3de/study/report.h"
#include "c3de/study/study_run.h"
#include "study_text.h"

using namespace c3de;
using namespace c3de::study;
using Json = nlohmann::json;

namespace {

/// A study of one case, and the results of its runs.
struct Fixture {
  Study study;
  Plan plan;
  std::vector<Samples> samples{1};
  std::map<std::string, Result> results;

  explicit Fixture(const std::string &text) {
    auto parsed = parseStudy(text, studyPlace());
    if (!parsed) FAIL(parsed.error().message);
    study = std::move(*parsed);
    plan.cases.resize(1);
    plan.cases[0].bodies = {"b"};
    const Case &one = study.cases[0];
    if (one.reference.source == Reference::Source::richardson)
      for (const auto &parameters : combinations({one.reference.parameter})) add(parameters, true, 0);
    for (std::size_t g = 0; g < one.grids.size(); ++g)
      for (const auto &parameters : combinations(one.grids[g].parameters)) add(parameters, false, g);
  }
  void add(const std::vector<StudyParameterValue> &parameters, bool isReference, std::size_t grid) {
    Point point;
    point.isReference = isReference;
    point.grid = grid;
    point.parameters = parameters;
    point.id = "id" + std::to_string(plan.points.size());
    plan.points.push_back(point);
  }
  /// Of a run with these times for two simulated seconds.
  Result &result(std::size_t p, const std::vector<double> &wall_s, double tip) {
    Result result;
    result.id = plan.points[p].id;
    result.time_s = 2.0;
    result.steps = 20;
    result.dt_s = 0.1;
    result.stateHash = "ab";
    result.integrator = "explicit";
    result.probes_m["tip"] = {0, 0, tip};
    result.reactions[0] = {{0, 0, 10 * tip}, {}};
    result.bodies = {{"b", 0.0, 2.0, 1.0, 1.01, {{"elastic", tip * tip}, {"kinetic", 1.0}}, {0.0, 0.0, 1e-6}}};
    result.start = {{"b", 0.0, 0.0, 0.0, 0.0, {{"elastic", 0.0}, {"kinetic", 1.0}}, {}}};
    for (const double wall : wall_s) result.runs.push_back({wall, wall, 0.1, 1.0, 2.0, 3.0});
    return results[result.id] = result;
  }
  Outcome outcome() { return evaluate(study, plan, samples, results); }
};

std::vector<std::vector<std::string>> rowsOf(const std::string &table) {
  std::istringstream in(table);
  std::vector<std::vector<std::string>> rows;
  for (std::string row; std::getline(in, row);) rows.push_back(splitCsvRow(row).value());
  return rows;
}

}  // namespace

TEST_CASE("Errors are shares of the reference, costs ms per simulated second, and failures stay in the table") {
  Fixture f(studyText("{ probe = \"tip\", component = \"z\" }",
                      "value = -0.5\nuncertainty = 0.01\nkind = \"formula\"\nsource = \"a <book>\"",
                      "[[grid]]\nspacing = [0.1, 0.05, 0.025, 0.0125]\n"));
  f.result(0, {0.3, 0.2, 0.25}, -0.4);
  f.result(1, {1.0}, -0.501);
  f.results["id2"] = Result::failed("id2", "diverged", "it fell, \"far\"");
  const Outcome outcome = f.outcome();
  CHECK_THAT(*outcome.points[0].errors.quantity, WithinRel(0.2, 1e-12));
  CHECK_THAT(outcome.points[0].cost->median, WithinRel(125.0, 1e-12));
  CHECK_THAT(outcome.points[0].cost->cheapest, WithinRel(100.0, 1e-12));
  CHECK_THAT(outcome.points[0].cost->dearest, WithinRel(150.0, 1e-12));
  CHECK(outcome.points[0].isOnFront);
  CHECK(outcome.points[1].isBelowResolution);  // 0.002 of 0.02
  CHECK_THAT(*outcome.points[0].errors.volumeChange, WithinRel(0.01, 1e-9));
  CHECK_FALSE(outcome.points[0].errors.fieldL2);
  CHECK_FALSE(outcome.points[0].errors.energyDrift_1_s);  // the point does not specify that no energy is supplied
  CHECK(outcome.points[2].failure == "diverged");
  CHECK(outcome.points[3].failure == "missing");

  const auto rows = rowsOf(tableOf(f.study, f.plan, outcome));
  REQUIRE(rows.size() == 5);
  for (const auto &row : rows) CHECK(row.size() == rows[0].size());
  const auto column = [&](const char *name) {
    return static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin());
  };
  CHECK(rows[1][column("spacing")] == "0.1");
  CHECK(rows[1][column("outcome")] == "done");
  CHECK_THAT(std::stod(rows[1][column("error")]), WithinRel(0.2, 1e-12));
  CHECK(rows[3][column("outcome")] == "diverged");
  CHECK(rows[3][column("reason")] == "it fell, \"far\"");
  CHECK(rows[3][column("error")].empty());
  CHECK(column("on_front") == rows[0].size() - 1);

  const Json json = Json::parse(jsonOf(f.study, f.plan, {"c3de", "1", "b"}, outcome));
  CHECK(json["cases"][0]["points"].size() == 4);
  CHECK(json["cases"][0]["points"][2]["failure"]["kind"] == "diverged");
  CHECK(json["cases"][0]["reference"]["kind"] == "formula");
  CHECK(json["cases"][0]["points"][0]["below_bar"] == false);

  const std::string page = reportOf(f.study, f.plan, {"c3de", "1", "b"}, outcome);
  CHECK_THAT(page,
             Contains("a &lt;book&gt;") && Contains("diverged: it fell") && Contains("<svg") && Contains("seed 1"));
  CHECK(page.find("<script") == std::string::npos);
  CHECK(page.find("http://") == page.find("http://www.w3.org/2000/svg"));
  const std::string picture = diagramOf(f.study, f.plan, outcome, 0);
  CHECK_THAT(picture, Contains("uncertainty of the reference") && Contains(">failed<") && Contains("100 mm") &&
                          Contains("25 mm: diverged"));
  CHECK(picture.find("nan") == std::string::npos);
}

TEST_CASE("Without noise a cheaper point that is as accurate takes the place on the front") {
  Fixture f(studyText("{ reaction = 0, component = \"z\" }",
                      "value = -5\nuncertainty = 0\nkind = \"formula\"\nsource = \"x\"",
                      "[[grid]]\nspacing = [0.1, 0.05]\n"));
  f.result(0, {0.2, 0.21}, -0.49);
  f.result(1, {0.3, 0.4}, -0.48);
  CHECK(f.outcome().points[0].isOnFront);
  CHECK_FALSE(f.outcome().points[1].isOnFront);
  f.result(1, {0.205, 0.4}, -0.48);
  CHECK(f.outcome().points[1].isOnFront);
  CHECK_THAT(*f.outcome().points[0].errors.reaction, WithinRel(0.02, 1e-9));
}

TEST_CASE("What nothing feeds or acts on has its drift and round-off") {
  Fixture f(studyText());
  f.plan.points[0].conservesEnergy = f.plan.points[0].conservesMomentum = true;
  f.result(0, {0.1}, -0.1).peakEnergy_J = 4.0;
  const Errors errors = f.outcome().points[0].errors;
  // 0.01 J more within 2 s
  CHECK_THAT(errors.energyDrift_1_s.value(), WithinRel(0.01 / 4.0 / 2.0, 1e-9));
  CHECK_THAT(errors.momentumRoundOff.value(), WithinRel(1e-6 / 2.0, 1e-9));
}

TEST_CASE("Three refined runs are the reference of numbers and fields, and one that does not converge is told") {
  Fixture f(studyText("{ probe = \"tip\", component = \"z\" }",
                      "richardson = { lever = \"dt\", values = [0.4, 0.2, 0.1] }", "[[grid]]\ndt = [0.8, 1.6]\n"));
  Samples &samples = f.samples[0];
  samples.points = {{"b", {0, 0, 0}, 2}, {"b", {1, 0, 0}, 3}};
  samples.inside = samples.skinBegin = 1;
  samples.weights = {2.0, 1.0};
  const auto add = [&](std::size_t p, double dt) {
    f.result(p, {0.1}, -0.5 - 0.1 * dt * dt).positions_m = {{0, 0, 0.2 + dt * dt}, {1, 0, -0.1}};
  };
  for (std::size_t p = 0; p < 5; ++p) add(p, std::array{0.4, 0.2, 0.1, 0.8, 1.6}[p]);
  const Outcome outcome = f.outcome();
  INFO(outcome.cases[0].error);
  REQUIRE(outcome.cases[0].truth);
  CHECK(outcome.cases[0].error.empty());
  CHECK_THAT(*outcome.cases[0].truth->value, WithinAbs(-0.5, 1e-9));
  CHECK_THAT(*outcome.cases[0].truth->order, WithinAbs(2.0, 1e-6));
  CHECK_THAT(*outcome.points[3].errors.quantity, WithinRel(0.064 / 0.5, 1e-6));
  CHECK_THAT(*outcome.points[3].errors.fieldL2, WithinRel(0.64 / 0.2, 1e-6));
  CHECK_THAT(*outcome.points[3].errors.surfaceMax_mm, WithinAbs(0.0, 1e-6));
  CHECK(outcome.points[3].errors.energyNorm);
  CHECK(outcome.points[3].errors.reaction);

  f.study.cases[0].reference.share = 1e-6;
  CHECK_THAT(f.outcome().cases[0].error, Contains("too uncertain"));
  f.result(2, {0.1}, -0.9);
  CHECK_THAT(f.outcome().cases[0].error, Contains("does not converge"));
  CHECK_FALSE(f.outcome().cases[0].truth);
  CHECK_THAT(diagramOf(f.study, f.plan, f.outcome(), 0), Contains("no reference to compare with"));
  f.results["id1"] = Result::failed("id1", "crashed", "signal 11");
  CHECK_THAT(f.outcome().cases[0].error, Contains("dt 200 ms") && Contains("crashed: signal 11"));
}

TEST_CASE("A table of displacements is the reference of a field at its own points") {
  const auto place = studyPlace();
  std::ofstream(place.parent_path() / "truth.csv")
      << "body,x [m],y [m],z [m],ux [m],uy [m],uz [m]\nb,0,0,0,0.3,0,0\nb,1,0,0,0,0.4,0\n";
  const auto study = parseStudy(
      studyText("\"surface\"", "file = \"truth.csv\"\nuncertainty = 0.002\nkind = \"measurement\"\nsource = \"x\""),
      place);
  REQUIRE(study);
  Samples samples;
  const auto truth = statedReference(*study, study->cases[0], samples);
  REQUIRE(truth);
  CHECK(truth->bar == 2.0);  // mm
  REQUIRE(samples.points.size() == 2);
  Result result;
  result.positions_m = {{0.3, 0, 0}, {1, 0.41, 0}};
  const Errors errors = errorsOf(study->cases[0], Point{}, *truth, samples, result);
  CHECK_THAT(*errors.quantity, WithinRel(10.0, 1e-9));
  CHECK_THAT(*errors.fieldL2, WithinRel(0.01 / 0.5, 1e-9));
}

TEST_CASE("The folder of a study is one study's and one process's, and keeps what is done") {
  Fixture f(studyText());
  f.plan.identity = {{"repeat", "3"}};
  const auto folder = testOutputFolder() / "out";
  std::filesystem::remove_all(folder);
  {
    const auto open = StudyFolder::open(folder, f.study, f.plan, false);
    REQUIRE(open);
    const auto second = StudyFolder::open(folder, f.study, f.plan, true);
    REQUIRE_FALSE(second);
    CHECK(second.error().code == ErrorCode::usage);
    CHECK_THAT(second.error().message, Contains("is in use by process "));
    REQUIRE(open->keep(f.result(0, {0.1}, -0.1)));
  }
  CHECK_THAT(StudyFolder::open(folder, f.study, f.plan, false).error().message,
             Contains("use --resume to continue it"));
  const auto again = StudyFolder::open(folder, f.study, f.plan, true);
  REQUIRE(again);
  CHECK(again->results(f.plan).size() == 1);
  std::ofstream(folder / "points" / "id1.json") << "{\"id\": \"id1\", half";
  CHECK(again->results(f.plan).size() == 1);
}

TEST_CASE("A folder of another study, of other things, or that cannot be made is refused") {
  Fixture f(studyText());
  f.plan.identity = {{"repeat", "3"}};
  const auto folder = testOutputFolder() / "out";
  std::filesystem::remove_all(folder);
  REQUIRE(StudyFolder::open(folder, f.study, f.plan, true));
  f.plan.identity = {{"repeat", "5"}};
  const auto other = StudyFolder::open(folder, f.study, f.plan, true);
  REQUIRE_FALSE(other);
  CHECK_THAT(other.error().message, Contains("holds another study: 'repeat' is 5 and was 3"));
  const auto things = testOutputFolder() / "things";
  std::filesystem::create_directories(things);
  std::ofstream(things / "letter.txt") << "dear";
  CHECK_THAT(StudyFolder::open(things, f.study, f.plan, false).error().message,
             Contains("holds 'letter.txt' and no study"));
  CHECK(StudyFolder::open(things / "letter.txt" / "out", f.study, f.plan, false).error().code == ErrorCode::output);
}

TEST_CASE("A result comes back from its text as it was, and a damaged one is told") {
  Fixture f(studyText());
  Result result = f.result(0, {0.1, 1.0 / 3.0}, -0.1);
  result.positions_m = {{0.1, 0.2, 1.0 / 3.0}};
  result.frequency_Hz = 4.9973;
  result.peakEnergy_J = 0.25;
  const auto back = Result::fromText(result.text());
  REQUIRE(back);
  CHECK(back->text() == result.text());
  CHECK(back->positions_m == result.positions_m);
  CHECK(back->runs[1].wall_s == 1.0 / 3.0);
  CHECK(back->probes_m == result.probes_m);
  const auto failed = Result::fromText(Result::failed("a", "crashed", "why").text());
  REQUIRE(failed);
  CHECK(failed->reason == "why");
  for (const char *text : {"", "3", "{}", R"({"format": 1, "id": 3, "runs": [{}]})", R"({"format": 2, "id": "a"})",
                           R"({"format": 1, "id": "a", "runs": []})"}) {
    INFO(text);
    CHECK_FALSE(Result::fromText(text));
  }
}

TEST_CASE("A task comes back from its text as it was") {
  const Task task{"id", {"c3de", "run", "a b.toml"}, 3, 1.5, "work/id", "samples of x.csv", "tip", 2, true};
  const auto back = Task::fromText(task.text());
  REQUIRE(back);
  CHECK(back->text() == task.text());
  CHECK(back->component == 2);
  CHECK(back->needsEnergies);
  CHECK_FALSE(Task::fromText("{\"id\": 3}"));
  CHECK_FALSE(Task::fromText("half"));
}

TEST_CASE("A study that was run before is told beside, point by point") {
  Fixture f(studyText());
  f.result(0, {0.2}, -0.4);
  f.result(1, {0.4}, -0.49);
  const std::filesystem::path folder = testOutputFolder();
  const auto write = [&](const std::string &text) { std::ofstream(folder / "study.json") << text; };
  // The same study, a finer grid, times twice and four times as long.
  Fixture before(studyText("{ probe = \"tip\", component = \"z\" }",
                           "value = -0.5\nuncertainty = 0.01\nkind = \"formula\"\nsource = \"a book\"",
                           "[[grid]]\nspacing = [0.05, 0.1, 0.025]\n"));
  before.result(0, {1.6}, -0.45);
  before.result(1, {0.4}, -0.35);
  before.result(2, {3.2}, -0.499);
  write(jsonOf(before.study, before.plan, {"c3de", "0.8", "b"}, before.outcome()));

  Outcome outcome = f.outcome();
  CHECK_FALSE(costRatio(f.plan, outcome, 0));
  const std::string alone = diagramOf(f.study, f.plan, outcome, 0);
  const auto earlier = loadEarlierRun(folder, f.study, f.plan);
  REQUIRE(earlier);
  CHECK(earlier->version == "0.8");
  outcome.earlier = *earlier;
  CHECK_THAT(outcome.earlier->points[0]->error, WithinRel(0.3, 1e-12));
  CHECK_THAT(outcome.earlier->points[1]->cost_ms, WithinRel(800.0, 1e-12));
  CHECK_THAT(costRatio(f.plan, outcome, 0).value(), WithinRel(0.5 * (0.5 + 0.25), 1e-12));

  const auto rows = rowsOf(tableOf(f.study, f.plan, outcome));
  for (const auto &row : rows) REQUIRE(row.size() == rows[0].size());
  CHECK(rows[0][rows[0].size() - 2] == "earlier_error");
  CHECK_THAT(std::stod(rows[1].back()), WithinRel(200.0, 1e-12));
  CHECK(Json::parse(jsonOf(f.study, f.plan, {"c3de", "1", "b"}, outcome))["compared_with"]["version"] == "0.8");
  CHECK_THAT(reportOf(f.study, f.plan, {"c3de", "1", "b"}, outcome), Contains("Compared with") && Contains("30.0"));
  // Dashes between two positions within the frame, in every diagram.
  CHECK(alone.find("stroke-dasharray=\"3 3\"") == std::string::npos);
  for (const std::string &picture : {diagramOf(f.study, f.plan, outcome, 0), overviewOf(f.study, f.plan, outcome)}) {
    CHECK_THAT(picture, Contains("before: 0.8, "));
    CHECK(picture.find("r=\"2\"") != picture.rfind("r=\"2\""));
    CHECK(picture.find("nan") == std::string::npos);
  }

  // A failed result has no position; an invalid or different study is reported.
  before.results["id0"] = Result::failed("id0", "diverged", "far");
  write(jsonOf(before.study, before.plan, {"c3de", "0.8", "b"}, before.outcome()));
  CHECK_FALSE(loadEarlierRun(folder, f.study, f.plan).value().points[1]);
  before.study.cases[0].name = "other";
  write(jsonOf(before.study, before.plan, {"c3de", "0.8", "b"}, before.outcome()));
  CHECK(loadEarlierRun(folder, f.study, f.plan).error().code == ErrorCode::usage);
  for (const char *text : {"{", "[]", "{\"cases\": 3}", "{\"cases\": [3, {\"name\": \"beam\", \"points\": 3}]}"}) {
    write(text);
    INFO(text);
    CHECK_FALSE(loadEarlierRun(folder, f.study, f.plan));
  }
  CHECK_THAT(loadEarlierRun(folder / "nowhere", f.study, f.plan).error().message, Contains("is not there"));
}
