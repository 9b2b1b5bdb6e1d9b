// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/study_file.h"

#include "study_text.h"

using namespace c3de;
using namespace c3de::study;

TEST_CASE("A study is read with its defaults, and every grid of it belongs to every case") {
  const auto study = parseStudy(
      "title = \"T\"\n" + studyText() + "[[grid]]\nlabel = \"damped\"\n\"solver.damping\" = 1\nsolver.dt = 0.1\n",
      studyPlace());
  if (!study) FAIL(study.error().message);
  CHECK(study->title == "T");
  CHECK(study->repeat == 3);
  CHECK_FALSE(study->jobs);
  REQUIRE(study->cases.size() == 1);
  const Case &one = study->cases[0];
  CHECK(one.scene.filename() == "beam.toml");
  CHECK(one.quantity.kind == Quantity::Kind::probe);
  CHECK(one.quantity.component == 2);
  CHECK(one.reference.value == -0.5);
  REQUIRE(one.grids.size() == 2);
  CHECK(one.grids[0].parameters[0].values == std::vector<std::string>{"0.1", "0.05"});
  CHECK(one.grids[1].label == "damped");
  CHECK(one.grids[1].parameters[0].name == "solver.damping");
  CHECK(one.grids[1].parameters[1].name == "solver.dt");
}

TEST_CASE("Values of levers and settings are as the command line takes them, vectors and texts too") {
  const auto study = parseStudy(
      studyText("\"field\"", "file = \"truth.csv\"\nuncertainty = 0.001\nkind = \"measurement\"\nsource = \"a lab\"",
                "[[case.grid]]\nevaluation = [\"phyxels\", \"stress_points\"]\n\"world.gravity\" = [[0, 0, -1], [0, "
                "0.5, 0]]\n"),
      studyPlace());
  if (!study) FAIL(study.error().message);
  const Grid &grid = study->cases[0].grids.at(0);
  CHECK(grid.parameters[0].values == std::vector<std::string>{"\"phyxels\"", "\"stress_points\""});
  CHECK(grid.parameters[1].values == std::vector<std::string>{"[0,0,-1]", "[0,0.5,0]"});
  CHECK(study->cases[0].reference.source == Reference::Source::file);
}

TEST_CASE("What is wrong with a study is said with file, line and what is accepted") {
  const std::string good = "value = -0.5\nuncertainty = 0.01\nkind = \"formula\"\nsource = \"a book\"";
  const std::string quantity = "{ probe = \"tip\", component = \"z\" }";
  const auto withGrid = [&](const std::string &grid) { return studyText(quantity, good, grid); };
  const auto withReference = [&](const std::string &reference) { return studyText(quantity, reference); };
  const auto withQuantity = [&](const std::string &q) { return studyText(q, good); };
  const struct {
    std::string text, contains;
  } cases[] = {
      {"title = \"x\"\n", "study.toml:1: the study has no 'format'"},
      {"format = 2\n", "study.toml:1: format = 2 is not served"},
      {"format = 1\n", "the study has no case"},
      {"format = 1\ntitel = \"x\"\n", "study.toml:2: unknown key 'titel' in the study; did you mean 'title'?"},
      {"format = 1\n[run]\nrepeats = 3\n", "study.toml:3: unknown key 'repeats' in [run]; did you mean 'repeat'?"},
      {"format = 1\n[run]\nrepeat = 0\n", "study.toml:3: repeat = 0; accepted: a whole number from 1"},
      {"format = 1\n[run]\ntime_limit = 0\n", "accepted: a number above 0"},
      {"format = 1\n[run]\njobs = 1.5\n", "jobs = 1.5; accepted: a whole number"},
      {"format = 1\n[[case]]\nname = \"a\"\n", "study.toml:2: the case has no 'scene'"},
      {"format = 1\n[[case]]\nnam = \"a\"\n", "study.toml:3: unknown key 'nam' in [[case]]; did you mean 'name'?"},
      {withGrid(""), "nothing is varied in case 'beam'"},
      {withGrid("[[grid]]\nlabel = \"x\"\n"),
       "study.toml:11: the grid has no study parameter; accepted: spacing, count"},
      {withGrid("[[grid]]\nspacng = 0.1\n"),
       "study.toml:12: unknown study parameter 'spacng'; did you mean 'spacing'?"},
      {withGrid("[[grid]]\nspacing = []\n"), "study.toml:12: spacing is an empty list; accepted: a value, or a list"},
      {withGrid("[[grid]]\nspacing = [0.1, 0.1]\n"), "spacing has the value 0.1 twice"},
      {withGrid("[[grid]]\nspacing = 0.1\ncount = 10\n"),
       "study.toml:13: the grid has 'spacing' and 'count', which are equivalent"},
      {withGrid("[[grid]]\nsubsteps = 2\ndt = 0.1\n"), "'dt' and 'substeps', which are equivalent"},
      {withGrid("[[grid]]\nsubsteps = 0\n"), "substeps = 0; accepted: whole numbers from 1"},
      {withGrid("[[grid]]\nthreads = [1, 0]\n"), "accepted: whole numbers from 1 to 1024"},
      {withGrid("[[grid]]\nspacing = 2020-01-01\n"), "accepted: numbers, texts"},
      {withGrid("grid = 3\n"), "study.toml:11: unknown key 'grid' in [case.reference]"},
      {withQuantity("\"feild\""), "study.toml:5: quantity is \"feild\"; accepted: { probe = NAME"},
      {withQuantity("{ probe = \"tip\" }"), "quantity has no 'component'"},
      {withQuantity("{ probe = \"tip\", component = \"w\" }"), "accepted: x, y, z, magnitude"},
      {withQuantity("{ probe = \"tip\", energy = \"elastic\" }"), "exactly one quantity"},
      {withQuantity("{ energy = \"elastik\" }"), "did you mean \"elastic\"?"},
      {withQuantity("{ frequency = \"tip\", component = \"magnitude\" }"), "accepted: x, y, z"},
      {withQuantity("\"field\""), "a number is no reference for a field"},
      {withReference("uncertainty = 1\n"), "the reference has no source"},
      {withReference(good + "\nfile = \"truth.csv\""), "the reference has several sources"},
      {withReference("value = 1\nkind = \"formula\"\nsource = \"x\""), "the reference has no 'uncertainty'"},
      {withReference("value = 0\nuncertainty = 1\nkind = \"formula\"\nsource = \"x\""), "errors are shares of it"},
      {withReference("value = 1\nuncertainty = -1\nkind = \"formula\"\nsource = \"x\""),
       "uncertainty = -1; accepted: a number from 0"},
      {withReference("value = 1\nuncertainty = 1\nkind = \"guess\"\nsource = \"x\""),
       "accepted: formula, finite_elements, measurement"},
      {withReference("file = \"absent.csv\"\nuncertainty = 1\nkind = \"formula\"\nsource = \"x\""),
       "a file of displacements is a reference for"},
      {withReference("richardson = { lever = \"spacing\", values = [1, 2, 3] }"),
       "do not go from coarse to fine; accepted for 'spacing': numbers that fall"},
      {withReference("richardson = { lever = \"count\", values = [3, 2, 1] }"),
       "accepted for 'count': numbers that grow"},
      {withReference("richardson = { lever = \"spacing\", values = [2, 1] }"), "accepted: three numbers above 0"},
      {withReference("richardson = { lever = \"law\", values = [3, 2, 1] }"), "cannot be extrapolated"},
      {withReference("richardson = { lever = \"spacing\" }"), "richardson has no 'values'"},
      {withReference("richardson = { lever = \"spacing\", values = [3, 2, 1] }\nkind = \"formula\""),
       "richardson computes its own"},
  };
  for (const auto &one : cases) {
    const auto study = parseStudy(one.text, studyPlace());
    INFO(one.text);
    REQUIRE_FALSE(study);
    CHECK(study.error().code == ErrorCode::input);
    CHECK_THAT(study.error().message, Contains(one.contains) && Contains("study.toml:"));
  }
}

TEST_CASE("Names that no file can have, twice the same name, and scenes that are not there are refused") {
  const auto place = studyPlace();
  std::string text = studyText();
  text.replace(text.find("\"beam\""), 6, "\"a/b\"");
  CHECK_THAT(parseStudy(text, place).error().message, Contains("accepted: a name that a file can have"));
  text = studyText();
  text.replace(text.find("beam.toml"), 9, "absent.toml");
  CHECK_THAT(parseStudy(text, place).error().message, Contains("study.toml:4: scene: ") && Contains("no such file"));
  const std::string two =
      studyText("\"surface\"", "file = \"truth.csv\"\nuncertainty = 0\nkind = \"formula\"\nsource = \"x\"", "");
  CHECK_THAT(parseStudy(two + two.substr(two.find("[[case]]")), place).error().message,
             Contains("a second case is named 'beam'"));
  CHECK_THAT(loadStudy(place.parent_path() / "none.toml").error().message, Contains("no such file"));
}
