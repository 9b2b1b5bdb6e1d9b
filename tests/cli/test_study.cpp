// SPDX-License-Identifier: Apache-2.0
// `c3de study` from outside: a small study to its end, killed and resumed, and every invalid input.
#include <chrono>
#include <regex>
#include <sstream>
#include <thread>

#include "c3de/core/csv.h"
#include "program.h"
#include "support/environment.h"
#include "support/folders.h"

namespace fs = std::filesystem;

namespace {

/// A soft box that hangs from one end: a scene that is solved in milliseconds.
fs::path writeHangingBox(const fs::path &folder) {
  writeFile(folder / "box.obj", boxObj());
  return writeFile(folder / "box.toml", R"(format = 1
title = "Hanging box"
[world]
gravity = [1.0, 0.0, 0.0]
[solver]
integrator = "quasistatic"
load_steps = 1
[[body]]
name = "box"
mesh = "box.obj"
mesh_unit = "m"
material = { law = "stvk", youngs_modulus = 1e5, poisson_ratio = 0.3, density = 1000.0 }
sampling = { spacing = 0.1 }
[[fix]]
name = "end"
region = { box = { min = [-0.001, -1, -1], max = [0.001, 1, 1] } }
[[probe]]
name = "tip"
at = [0.9, 0.1, 0.1]
)");
}

// A bar that hangs has rho g x (L - x/2) / E, minus the contraction that the held end prevents.
const std::string kTip = R"(
[[case]]
name = "tip"
scene = "box.toml"
quantity = { probe = "tip", component = "x" }
[case.reference]
value = 0.00495
uncertainty = 0.00005
kind = "formula"
source = "a bar under its own weight"
)";
const std::string kField = R"(
[[case]]
name = "field"
scene = "box.toml"
quantity = "field"
[case.reference]
richardson = { lever = "spacing", values = [0.1, 0.05, 0.034], share = 10 }
)";
const std::string kGrid = "[[grid]]\nspacing = [0.1, 0.0667]\nevaluation = [\"stress_points\", \"phyxels\"]\n";

fs::path writeStudy(const fs::path &folder, const std::string &text) {
  writeHangingBox(folder);
  return writeFile(folder / "study.toml", "format = 1\n[run]\nrepeat = 2\nsamples = 50\ntime_limit = 60\n" + text);
}

c3de::ProcessResult study(const fs::path &file, const fs::path &out, const std::vector<std::string> &more = {}) {
  std::vector<std::string> arguments{"study", file.string(), "--out", out.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return runC3de(arguments);
}

/// The table up to where times begin.
std::vector<std::vector<std::string>> errorsIn(const fs::path &out) {
  std::istringstream in(readFile(out / "study.csv"));
  std::vector<std::vector<std::string>> rows;
  std::size_t columns = 0;
  for (std::string row; std::getline(in, row);) {
    rows.push_back(c3de::splitCsvRow(row).value());
    if (columns == 0)
      columns = static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), "cost_ms") - rows[0].begin());
    REQUIRE(rows.back().size() > columns);
    rows.back().resize(columns);
  }
  return rows;
}

std::size_t pointsIn(const fs::path &out) {
  std::error_code code;
  std::size_t count = 0;
  for (const auto &entry : fs::directory_iterator(out / "points", code))
    if (entry.path().extension() == ".json" && !entry.path().filename().string().starts_with("samples")) ++count;
  return count;
}

}  // namespace

TEST_CASE("A study leaves tables, a report and a diagram of each case, with the same errors each time") {
  const auto folder = freshFolder("study");
  const auto file = writeStudy(folder, kTip + kField + kGrid);
  const auto first = study(file, folder / "one");
  INFO(first.errorOutput);
  REQUIRE(first.exitCode == 0);
  CHECK_THAT(first.output, Contains("tip: 4 points") && Contains("field: 4 points") && Contains("report.html"));
  for (const char *name : {"study.csv", "study.json", "report.html", "tip.svg", "field.svg"})
    CHECK(fs::exists(folder / "one" / name));
  const auto json = readJson(folder / "one" / "study.json");
  REQUIRE(json["cases"].size() == 2);
  CHECK(json["cases"][0]["points"].size() == 4);
  CHECK(json["cases"][1]["points"].size() == 7);  // three of the reference
  CHECK(json["cases"][1]["reference"]["order"] > 0.1);
  CHECK(json["machine"]["processors"] >= 1);
  CHECK(json["cases"][0]["cost_unit"] == "ms per solution");
  for (const auto &point : json["cases"][0]["points"]) {
    CHECK(point["error"].get<double>() < 0.05);
    CHECK(point["cost_ms"] > 0.0);
    CHECK(point["cost_least_ms"] <= point["cost_most_ms"]);
  }
  // The field of the two samplings of one method: the finer one is closer.
  const auto &points = json["cases"][1]["points"];
  CHECK(points[5]["field_l2"] < points[3]["field_l2"]);
  CHECK(points[3]["surface_max_mm"] >= points[3]["surface_95_mm"]);

  const auto again = study(file, folder / "two");
  REQUIRE(again.exitCode == 0);
  CHECK(errorsIn(folder / "one") == errorsIn(folder / "two"));
  // No temporary files remain.
  CHECK(pointsIn(folder / "one") == 11);
  for (const auto &entry : fs::directory_iterator(folder / "one" / "work")) CHECK(entry.path().extension() == ".csv");

  // The results of an earlier run are listed next to it; a case that was never run is refused before anything runs.
  const auto compared = study(file, folder / "two", {"--resume", "--compare", (folder / "one").string()});
  CHECK(compared.exitCode == 0);
  CHECK_THAT(compared.output, Contains(" times the cost of before (median)"));
  CHECK(errorsIn(folder / "one") == errorsIn(folder / "two"));
  CHECK_THAT(readFile(folder / "two" / "overview.svg"), Contains("before: "));
  const auto nowhere = study(file, folder / "three", {"--compare", (folder / "none").string()});
  CHECK(nowhere.exitCode == 3);
  CHECK_THAT(nowhere.errorOutput, Contains("study.json") && Contains("is not there"));
  CHECK_FALSE(fs::exists(folder / "three"));

  // A repetition has nothing to do; a study that differs is another one.
  const auto resumed = study(file, folder / "one", {"--resume"});
  CHECK(resumed.exitCode == 0);
  const auto refused = study(file, folder / "one");
  CHECK(refused.exitCode == 2);
  CHECK_THAT(refused.errorOutput, Contains("use --resume to continue it"));
  writeStudy(folder, kTip + kField + kGrid + "[[grid]]\nspacing = 0.2\n");
  const auto other = study(file, folder / "one", {"--resume"});
  CHECK(other.exitCode == 2);
  CHECK_THAT(other.errorOutput, Contains("holds another study: 'case tip:  spacing 200 mm' is new"));
  writeStudy(folder, kTip + kField + kGrid);
  writeFile(folder / "box.toml", readFile(folder / "box.toml") + "# touched\n");
  CHECK_THAT(study(file, folder / "one", {"--resume"}).errorOutput, Contains("'case tip: scene' has changed"));
}

#if !defined(_WIN32)
TEST_CASE("A study that is killed goes on where it was, and ends as one that was not") {
  const auto folder = freshFolder("study-killed");
  const auto file = writeStudy(folder, kTip + kField + kGrid);
  REQUIRE(study(file, folder / "whole").exitCode == 0);
  {
    // The shell is replaced by the program, so that its process id is known.
    auto child =
        c3de::ChildProcess::start({"sh", "-c", "echo $$ > \"$0\"; exec \"$@\"", (folder / "pid").string(), C3DE_PROGRAM,
                                   "study", file.string(), "--out", (folder / "out").string(), "-q"},
                                  folder / "log.txt");
    REQUIRE(child);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (pointsIn(folder / "out") < 2 && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const auto second = study(file, folder / "out", {"--resume"});
    CHECK(second.exitCode == 2);
    CHECK_THAT(second.errorOutput, Contains("is in use by process "));
    const auto killed = c3de::runProcess({"sh", "-c", "kill -9 $(cat \"$0\")", (folder / "pid").string()}, 10.0);
    REQUIRE(killed);
    CHECK(child->wait(10.0).value() == 128 + 9);
  }
  const std::size_t done = pointsIn(folder / "out");
  CHECK(done >= 2);
  CHECK(done < 11);
  CHECK_FALSE(fs::exists(folder / "out" / "study.csv"));
  std::map<std::string, fs::file_time_type> before;
  for (const auto &entry : fs::directory_iterator(folder / "out" / "points"))
    before[entry.path().filename().string()] = fs::last_write_time(entry.path());
  const auto resumed = study(file, folder / "out", {"--resume"});
  INFO(resumed.errorOutput);
  REQUIRE(resumed.exitCode == 0);
  for (const auto &[name, time] : before) CHECK(fs::last_write_time(folder / "out" / "points" / name) == time);
  CHECK(errorsIn(folder / "out") == errorsIn(folder / "whole"));
}

TEST_CASE("Ctrl-C ends a study soon with 130, and what is done is kept") {
  const auto folder = freshFolder("study-interrupted");
  const auto file = writeStudy(folder, kTip + "[[grid]]\nspacing = [0.1, 0.008]\n");
  auto child =
      c3de::ChildProcess::start({"sh", "-c", "echo $$ > \"$0\"; exec \"$@\"", (folder / "pid").string(), C3DE_PROGRAM,
                                 "study", file.string(), "--out", (folder / "out").string(), "-q"},
                                folder / "log.txt");
  REQUIRE(child);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (pointsIn(folder / "out") < 1 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const auto told = std::chrono::steady_clock::now();
  REQUIRE(c3de::runProcess({"sh", "-c", "kill -INT $(cat \"$0\")", (folder / "pid").string()}, 10.0));
  CHECK(child->wait(30.0).value() == 130);
  CHECK(std::chrono::steady_clock::now() - told < std::chrono::seconds(10));
  CHECK_THAT(readFile(folder / "log.txt"), Contains("1 of 2 points are done and kept") && Contains("--resume goes on"));
  CHECK(pointsIn(folder / "out") == 1);
}

TEST_CASE("A run that crashes is a failure with its reason, and the study ends well") {
  const auto folder = freshFolder("study-crash");
  const auto file = writeStudy(folder, kTip + "[[grid]]\nspacing = [0.1, 0.0667]\n");
  const ScopedEnvironment home("C3DE_HOME", (folder / "home").string()), dies("C3DE_TEST_DIES", "step");
  const auto result = study(file, folder / "out", {"--plugin", C3DE_DYING_PLUGIN});
  INFO(result.errorOutput);
  CHECK(result.exitCode == 0);
  CHECK_THAT(result.output, Contains("2 failed"));
  CHECK_THAT(readFile(folder / "out" / "study.csv"), Contains(",crashed,it ended by signal 11"));
  CHECK_THAT(readFile(folder / "out" / "report.html"), Contains("crashed: it ended by signal 11"));
}
#endif

TEST_CASE("Under mpirun several processes run one study, and its errors are those of one process") {
#if defined(C3DE_MPIRUN)
  const auto folder = freshFolder("study-mpi");
  const auto file = writeStudy(folder, kTip + kField + kGrid);
  REQUIRE(study(file, folder / "one").exitCode == 0);
  // For test machines with few processors, and running as root.
  const ScopedEnvironment root("OMPI_ALLOW_RUN_AS_ROOT", "1"), sure("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
      more("OMPI_MCA_rmaps_base_oversubscribe", "1");
  const auto result = c3de::runProcess(
      {C3DE_MPIRUN, "-n", "3", C3DE_PROGRAM, "study", file.string(), "--out", (folder / "three").string()}, 100.0);
  REQUIRE(result);
  INFO(result->errorOutput);
  CHECK(result->exitCode == 0);
  // Only one process prints.
  CHECK(result->output.find("tip: 4 points") == result->output.rfind("tip: 4 points"));
  CHECK(errorsIn(folder / "one") == errorsIn(folder / "three"));
  const auto refused = c3de::runProcess(
      {C3DE_MPIRUN, "-n", "2", C3DE_PROGRAM, "study", file.string(), "--out", (folder / "three").string()}, 100.0);
  REQUIRE(refused);
  CHECK(refused->exitCode == 2);
#else
  C3DE_SKIP("this build has no MPI");
#endif
}

TEST_CASE("Under mpirun a build without MPI says so, rather than run the study as often as there are processes") {
  const auto folder = freshFolder("study-no-mpi");
  const auto file = writeStudy(folder, kTip + kGrid);
  const fs::path alone = folder / fs::path(C3DE_PROGRAM).filename();
  fs::copy_file(C3DE_PROGRAM, alone);
  const ScopedEnvironment started("OMPI_COMM_WORLD_SIZE", "2");
  const auto result =
      c3de::runProcess({alone.string(), "study", file.string(), "--out", (folder / "out").string()}, 30.0);
  REQUIRE(result);
  CHECK(result->exitCode == 2);
  CHECK_THAT(result->errorOutput, Contains("this build has no MPI; accepted: c3de study without mpirun"));
  CHECK_FALSE(fs::exists(folder / "out"));
}

TEST_CASE("Time limits and references that fail are told, and the other cases go on") {
  const auto folder = freshFolder("study-failures");
  const std::string growing =
      "[[case]]\nname = \"growing\"\nscene = \"box.toml\"\nquantity = { probe = \"tip\", component = \"x\" }\n"
      "[case.reference]\nrichardson = { lever = \"solver.damping\", values = [3, 2, 1], "
      "set = { \"world.gravity\" = [1, 0, 0] }, share = 1e-12 }\n";
  const auto file = writeStudy(folder, kField + kTip + growing + "[[grid]]\nspacing = 0.1\n");
  std::string text = readFile(file);
  text.replace(text.find("values = [0.1, 0.05, 0.034]"), 27, "values = [0.1, 0.09, 0.004]");
  text.replace(text.find("time_limit = 60"), 15, "time_limit = 1");
  writeFile(file, text);
  const auto result = study(file, folder / "out");
  INFO(result.errorOutput);
  CHECK(result.exitCode == 1);
  CHECK_THAT(result.errorOutput, Contains("study.toml:11: case 'field': the run of the reference with spacing 4 mm ") &&
                                     Contains("time limit"));
  CHECK_THAT(result.output, Contains("tip: 1 points, 1 on the front"));
  // A static case is not damped: three runs that agree.
  CHECK(readJson(folder / "out" / "study.json")["cases"][2]["reference"]["uncertainty"] == 0.0);
  CHECK(readJson(folder / "out" / "study.json")["cases"][0]["failure"].is_string());
}

namespace {

/// Named cases of the shipped study of five classes of methods, each with the first of its spacings, run once.
std::string cutOfShippedStudy(const std::vector<std::string> &names) {
  const fs::path resources = testResourcesFolder();
  const std::string all = readFile(resources / "studies" / "eight.toml"), begin = "\n# Case: ";
  std::string text = all.substr(0, all.find(begin));
  for (const std::string &name : names) {
    const std::size_t at = all.find(begin + name + "\n");
    REQUIRE(at != std::string::npos);
    text += all.substr(at, all.find(begin, at + 1) - at);
  }
  text = std::regex_replace(text, std::regex("spacing = \\[([0-9.]+)[^\\]]*\\]"), "spacing = $1");
  text = std::regex_replace(text, std::regex("repeat = [0-9]+"), "repeat = 1");
  text =
      std::regex_replace(text, std::regex("\"eight/"), "\"" + (resources / "studies" / "eight").generic_string() + "/");
  return std::regex_replace(text, std::regex("\"\\.\\./scenes/"), "\"" + (resources / "scenes").generic_string() + "/");
}

}  // namespace

TEST_CASE("A cut of the shipped study: five classes of methods in one picture, the same errors each time", "[slow]") {
  const auto folder = freshFolder("study-eight");
  const auto file =
      writeFile(folder / "study.toml", cutOfShippedStudy({"patch", "cantilever", "free cube", "truth cube"}));
  const auto first = study(file, folder / "one");
  INFO(first.errorOutput);
  REQUIRE(first.exitCode == 0);
  REQUIRE(study(file, folder / "two").exitCode == 0);
  CHECK(errorsIn(folder / "one") == errorsIn(folder / "two"));
  const std::string overview = readFile(folder / "one" / "overview.svg");
  for (const char *text :
       {"C3DE, stress points", "C3DE, phyxels", "linear tetrahedra", "mass springs", "shape matching",
        "thesis as printed", "reference: formula", "reference: finite elements", "reference: measurement"})
    CHECK_THAT(overview, Contains(text));
  CHECK_THAT(readFile(folder / "one" / "report.html"), Contains(overview));

  std::map<std::string, double> errors;
  const auto json = readJson(folder / "one" / "study.json");
  for (const auto &one : json["cases"])
    for (const auto &point : one["points"])
      if (point.contains("error"))
        errors.try_emplace(one["name"].get<std::string>() + ": " + point["label"].get<std::string>(), point["error"]);
  // Fields that a method can represent are exact to the last digits; for others it has its characteristic error.
  CHECK(errors.at("patch: C3DE, stress points") < 1e-9);
  CHECK(errors.at("patch: linear tetrahedra") < 1e-6);
  CHECK(errors.at("patch: shape matching") < 1e-6);
  CHECK(errors.at("patch: mass springs") > 0.01);
  CHECK(errors.at("patch: thesis as printed") > 0.1);
  CHECK(errors.at("cantilever: C3DE, stress points") < 0.01);
  for (const char *of : {"linear tetrahedra", "mass springs", "shape matching"}) {
    CHECK(errors.at(std::string("cantilever: ") + of) > 0.1);
    CHECK(errors.at(std::string("cantilever: ") + of) < 0.5);
  }
  // Beads in gel: closer with some friction under the plate than with free sliding, for every method.
  CHECK(errors.at("truth cube: C3DE, friction of the plate") < 0.06);
  CHECK(errors.at("truth cube: C3DE, stress points") < 0.12);
  for (const char *of : {"linear tetrahedra", "mass springs", "shape matching", "thesis as printed"})
    CHECK(errors.at(std::string("truth cube: ") + of) > 0.15);
  // Forward Euler, as printed, gains energy until the state is destroyed.
  CHECK_FALSE(errors.contains("free cube: thesis as printed"));
  CHECK_THAT(readFile(folder / "one" / "study.csv"), Contains(",diverged,"));
}

TEST_CASE("What a method of the baselines cannot do is refused by name") {
  const auto folder = freshFolder("study-baselines");
  const std::string head = "[run]\nplugins = [\"baselines\"]\n";
  const struct {
    std::string grid, contains;
  } cases[] = {
      {"simulator = \"c3de.baselines.MassSpring/0\"\nlaw = \"neo_hookean\"", "accepted: springs"},
      {"simulator = \"c3de.baselines.MassSpring/0\"\nlaw = \"springs\"\npoisson_ratio = 0.3", "0.25"},
      {"simulator = \"c3de.baselines.ShapeMatching/0\"\nlaw = \"shape_matching\"\npoisson_ratio = 0.3",
       "poisson_ratio"},
      {"simulator = \"c3de.baselines.Thesis/0\"\nlaw = \"neo_hookean\"", "accepted: stvk"},
      {"simulator = \"c3de.baselines.Tetrahedra/0\"\nevaluation = \"phyxels\"", "evaluation"},
      {"simulator = \"c3de.baselines.Tetrahedra/0\"\nintegrator = \"implicit\"", "accepted: explicit | quasistatic"},
      {"simulator = \"c3de.baselines.FiniteVolumes/0\"", "no loaded plugin offers the simulator class"},
  };
  for (const auto &one : cases) {
    writeHangingBox(folder);
    writeFile(folder / "box.toml",
              readFile(folder / "box.toml") + "[simulator]\nclass = \"c3de.pointbased.WorldSimulator/1\"\n");
    const auto file =
        writeFile(folder / "study.toml", "format = 1\n" + head + kTip + "[[grid]]\nspacing = 0.1\n" + one.grid + "\n");
    const auto result = study(file, folder / "out");
    INFO(one.grid << "\n" << result.errorOutput);
    CHECK(result.exitCode == 3);
    CHECK_THAT(result.errorOutput, Contains(one.contains) && Contains("study.toml:"));
  }
  for (const char *plugins : {"\"baselines\"", "[\"basalines\"]", "[3]", "[\"./absent.so\"]"}) {
    const auto file =
        writeFile(folder / "study.toml", "format = 1\n[run]\nplugins = " + std::string(plugins) + "\n" + kTip + kGrid);
    const auto result = study(file, folder / "out");
    INFO(plugins << "\n" << result.errorOutput);
    CHECK(result.exitCode == 3);
    CHECK_THAT(result.errorOutput, Contains("study.toml:3: plugins"));
  }
  CHECK_FALSE(fs::exists(folder / "out"));
}

TEST_CASE("What is wrong with a study is refused with its line before anything runs") {
  const auto folder = freshFolder("study-refused");
  const auto grid = [](const std::string &lever) { return "[[grid]]\n" + lever + "\n"; };
  const struct {
    std::string text;
    int exitCode;
    std::string contains;
  } cases[] = {
      {kTip + grid("spacng = 0.1"), 3, "study.toml:17: unknown study parameter 'spacng'; did you mean 'spacing'?"},
      {kTip + grid("spacing = 0"), 3, "study.toml:17: --set body.box.sampling.spacing: "},
      {kTip + grid("law = \"stkv\""), 3, "study.toml:17: --set body.box.material.law: "},
      {kTip + grid("\"body.bax.sampling.spacing\" = 0.1"), 3,
       "study.toml:17: --set body.bax.sampling.spacing: there is no body 'bax'; did you mean 'box'?"},
      {kTip + grid("\"solver.dampin\" = 1"), 3, "study.toml:17: --set solver.dampin: "},
      {kTip + grid("simulator = \"none\""), 3, "study.toml:17: no loaded plugin offers the simulator class 'none'"},
      {kTip + grid("spacing = 0.1\ncount = 100"), 3, "study.toml:18: the grid has 'spacing' and 'count'"},
      {kTip + grid("spacing = []"), 3, "study.toml:17: spacing is an empty list"},
      {"[[case]]\nname = \"t\"\nscene = \"box.toml\"\nquantity = { probe = \"tpi\", component = \"x\" "
       "}\n[case.reference]\nvalue = 1\nuncertainty = "
       "0\nkind = \"formula\"\nsource = \"x\"\n" +
           grid("spacing = 0.1"),
       3,
       "study.toml:9: " + (folder / "box.toml").make_preferred().string() + " has no probe 'tpi'; did you mean 'tip'?"},
      {"[[case]]\nname = \"t\"\nscene = \"box.toml\"\nquantity = { reaction = 1, component = \"x\" "
       "}\n[case.reference]\nvalue = 1\nuncertainty = "
       "0\nkind = \"formula\"\nsource = \"x\"\n" +
           grid("spacing = 0.1"),
       3, "has no support 1; its fixes are numbered from 0, and it has 1"},
      {"[[case]]\nname = \"t\"\nscene = \"box.toml\"\nquantity = \"field\"\n[case.set]\n\"body.box.material.density\" "
       "= -1\n[case.reference]\n"
       "richardson = { lever = \"spacing\", values = [0.3, 0.2, 0.1] }\n" +
           grid("spacing = 0.1"),
       3, "study.toml:11: --set body.box.material.density: "},
  };
  for (const auto &one : cases) {
    const auto result = study(writeStudy(folder, one.text), folder / "out");
    INFO(one.text << "\n" << result.errorOutput);
    CHECK(result.exitCode == one.exitCode);
    CHECK_THAT(result.errorOutput, Contains("c3de: error: ") && Contains(one.contains));
  }
  CHECK_FALSE(fs::exists(folder / "out"));
  CHECK(study(folder / "absent.toml", folder / "out").exitCode == 3);
  const auto good = writeStudy(folder, kTip + kGrid);
  writeFile(folder / "file", "x");
  const auto unwritable = study(good, folder / "file");
  CHECK(unwritable.exitCode == 7);
  const auto below = study(good, folder / "file" / "out");
  CHECK(below.exitCode == 7);
}
