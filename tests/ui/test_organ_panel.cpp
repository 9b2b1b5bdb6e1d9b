// SPDX-License-Identifier: Apache-2.0
// The panel of the simulator: what is shown of an organ, its accuracy, and its parameters.
#include <filesystem>
#include <fstream>
#include <string>

#include "support/catch.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

/// Chooses an item of a list in the panel and checks the picture once it is drawn.
void chooseItem(WorkstationDriver &window, const std::string &parameter, const std::string &item) {
  window.choose(kPanel + parameter, item);
  C3DE_WAIT(window, parameter + " is " + item, row(s, parameter) == item);
  window.moveTo(window.inView(0.95, 0.95));
  window.waitFrames(1);
}

}  // namespace

TEST_CASE("three lines say how accurate an organ is, estimated and then verified, until it moves on",
          "[organ_verify]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_verify");
  const fs::path scene = outputFile("verified.toml");
  std::ofstream(scene) << "format = 1\ntitle = \"Hanging organ\"\n[world]\ngravity = [0.0, 0.0, "
                          "-9.81]\n[solver]\ndamping = 20.0\n[view]\n"
                          "colour = \"verified\"\n[[body]]\nname = \"organ\"\nmesh = \""
                       << organMesh().generic_string()
                       << "\"\nmesh_unit = \"mm\"\nmaterial = { youngs_modulus = 6e3, poisson_ratio = 0.4 }\n"
                          "sampling = { count = 400 }\n[[fix]]\nregion = { half_space = { point = [-0.06, 0, 0], "
                          "normal = [1, 0, 0] } }\n";
  window.start({scene.string(), "--play"});
  C3DE_WAIT(window, "a part of a second is simulated",
            !row(s, "Surfels").empty() && s["transport"]["time_s"].get<double>() > 0.3);
  pause(window);
  const std::string hash = row(window.state(), "State hash");
  CHECK(row(window.state(), "Colours").empty());
  const auto isOnBasis = [](const char *basis) {
    return [basis](const Json &s) {
      const std::string line = row(s, "Displacement");
      return line.starts_with("± ") && line.find(basis) != std::string::npos;
    };
  };
  const Json estimated = window.waitUntil("the error is estimated", isOnBasis("estimated by two coarser solutions"));
  CHECK_THAT(row(estimated, "Stress and strain"), Contains("± ") && Contains("outside singular regions"));
  CHECK_THAT(row(estimated, "Singular regions"), Contains("edge of support"));
  window.locate(kPanel + "finer");
  window.screenshotAtRest("estimated");
  window.click(kPanel + "verify");
  const Json verified = window.waitUntil("the error is measured", isOnBasis("verified with"));
  // One statement: no other row of the panel is an error.
  for (const char *old : {"Error estimate", "Error expected", "Estimated now", "At most", "Shadow"})
    CHECK(row(verified, old).empty());
  CHECK(row(verified, "State hash") == hash);
  C3DE_WAIT(window, "the colours are those of the verification", row(s, "Colours").starts_with("Error, verified, 0"));
  window.screenshot("verified");
  window.click(kPanel + "step");
  C3DE_WAIT(window, "the state has moved on", row(s, "Colours").empty());
  window.screenshot("moved_on");
  window.key("ctrl+shift+v");
  C3DE_WAIT(window, "the keys have verified it, too", row(s, "Colours").starts_with("Error, verified, 0"));
}

TEST_CASE("the surface can be made transparent, with evaluation points or phyxels inside", "[organ_surface]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_surface");
  startOrgan(window);
  chooseItem(window, "view.surface", "opaque");
  window.screenshot("opaque");
  chooseItem(window, "view.surface", "transparent");
  window.screenshot("transparent");
  CHECK(window.value(kPanel + "view.points") == "evaluation_points");
  CHECK(window.differsFrom("opaque", "transparent", 10000));
  chooseItem(window, "view.points", "phyxels");
  window.screenshot("phyxels");
  CHECK(window.differsFrom("transparent", "phyxels", 3000));
  chooseItem(window, "view.surface", "hidden");
  window.screenshot("points_only");
  CHECK(window.differsFrom("phyxels", "points_only", 10000));
  chooseItem(window, "view.surface", "opaque");
  window.screenshot("again");
  CHECK(window.differingPixels("opaque", "again") < 500);
}

TEST_CASE("an organ is coloured by its stress and its error with a legend, and plain again", "[organ_colours]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_colours");
  startOrgan(window);
  window.key("p");
  window.click("toolbar/play");
  C3DE_WAIT(window, "it plays", mode(s) == "playing" && s["transport"]["steps"] > 5);
  holdSurfel(window, window.inView(0.5, 0.5));
  for (int i = 1; i <= 6; ++i) window.moveTo(window.inView(0.5 + 0.02 * i, 0.5 - 0.02 * i));
  C3DE_WAIT(window, "the hand pulls", numberOf(s, kPanel + "Pinch force") > 0.2);
  const Json paused = pause(window);
  window.release();
  C3DE_WAIT(window, "it is let go", row(s, "Pinch force") == "–");
  const std::string hash = row(window.state(), "State hash");
  chooseItem(window, "view.colour", "material");
  window.screenshot("plain");
  CHECK(row(window.state(), "Colours").empty());

  chooseItem(window, "view.colour", "von_mises");
  const Json stressed = C3DE_WAIT(window, "the legend says kPa", row(s, "Colours").find("kPa") != std::string::npos);
  CHECK_THAT(row(stressed, "Colours"), Contains("von Mises") && Contains("0 … "));
  CHECK_THAT(row(stressed, "Shown"), Contains("largest"));
  window.screenshot("von_mises");
  CHECK(window.differsFrom("plain", "von_mises", 20000));

  chooseItem(window, "view.colour", "error");
  C3DE_WAIT(
      window, "the legend says %",
      row(s, "Colours").find("error") != std::string::npos && row(s, "Shown").find("whole body") != std::string::npos);
  window.screenshot("error");
  CHECK(window.differsFrom("von_mises", "error", 5000));

  // A fixed range: the legend ends at the specified value.
  window.click(kPanel + "view.range.auto");
  C3DE_WAIT(window, "a number stands there", row(s, "view.range") != "auto");
  window.enterNumber(kPanel + "view.range", "7");
  C3DE_WAIT(window, "the range is fixed", row(s, "Colours").find("0 … 7 %") != std::string::npos);
  window.screenshot("error_fixed");

  window.moveTo(window.inView(0.5, 0.9));
  window.key("ctrl+z");
  window.key("ctrl+z");
  C3DE_WAIT(window, "the range is as before", row(s, "view.range") == "auto");
  chooseItem(window, "view.colour", "material");
  C3DE_WAIT(window, "there is no legend", row(s, "Colours").empty());
  window.screenshot("again");
  CHECK(window.differingPixels("plain", "again") < 500);
  // Changing the view changes no state.
  CHECK(row(window.state(), "State hash") == hash);
  CHECK(window.state()["transport"]["steps"] == paused["transport"]["steps"]);
}

TEST_CASE("a change of the material is undone and redone, and the solver follows", "[organ_undo]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_undo");
  startOrgan(window);
  const std::string modulus = kPanel + "material.youngs_modulus";
  const std::string before = window.value(modulus);
  const double stepBefore = window.number(kPanel + "Step size");
  const Point at = window.locate(modulus);
  window.drag(at, {at.x + 40, at.y}, 4);
  const Json dragged = C3DE_WAIT(window, "the drag has changed it", row(s, "material.youngs_modulus") != before);
  const std::string after = row(dragged, "material.youngs_modulus");
  C3DE_WAIT(window, "the step follows", std::stod(row(s, "Step size")) < 0.9 * stepBefore);

  window.click("menu/edit");
  window.screenshot("menu");
  window.key("Escape");
  C3DE_WAIT(window, "the menu is closed", !s["widgets"].contains("menu/edit.undo"));
  window.moveTo(window.inView(0.5, 0.9));
  window.key("ctrl+z");
  window.waitForValue(modulus, before);
  C3DE_WAIT(window, "the step is as before", std::stod(row(s, "Step size")) == stepBefore);
  window.key("ctrl+y");
  window.waitForValue(modulus, after);
}

TEST_CASE("an organ from a scene can be filled again with another count", "[organ_rebuild]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_rebuild");
  startOrgan(window);
  CHECK_THAT(window.number(kPanel + "Phyxels"), WithinRel(400.0, 0.1));
  window.moveTo(window.inView(0.9, 0.1));
  window.key("space");
  C3DE_WAIT(window, "it falls", s["transport"]["steps"] > 5);
  pause(window);
  const Json before = window.state();
  window.enterNumber(kPanel + "sampling.count", "200");
  window.waitForValue(kPanel + "sampling.count", "200");
  window.click(kPanel + "rebuild");
  const Json state =
      C3DE_WAIT(window, "it is filled again or refused",
                !s["notifications"].empty() || (std::stod(row(s, "Phyxels")) < 300.0 && s["jobs"].empty()));
  CHECK(state["notifications"].empty());
  CHECK_THAT(window.number(kPanel + "Phyxels"), WithinRel(200.0, 0.1));
  const std::string rebuilt = row(window.state(), "State hash");

  const auto isBack = [&](const Json &s) {
    return row(s, "State hash") == row(before, "State hash") &&
           s["transport"]["steps"] == before["transport"]["steps"] && row(s, "Phyxels") == row(before, "Phyxels");
  };
  window.moveTo(window.inView(0.9, 0.1));
  window.key("ctrl+z");
  window.waitUntil("it is filled, and has fallen, as before", isBack);
  window.screenshot("undone");
  window.key("ctrl+y");
  C3DE_WAIT(window, "it is filled again", row(s, "State hash") == rebuilt && s["jobs"].empty());
  window.key("ctrl+z");
  window.waitUntil("it is as before once more", isBack);
}

TEST_CASE("a wish for accuracy samples the organ anew and shows what to expect", "[organ_accuracy]") {
  C3DE_ORGAN_OR_SKIP();
  constexpr const char *kPercent = "accuracy.error_percent", *kBudget = "accuracy.budget_ms";
  const fs::path scene = outputFile("wished.toml");
  std::ofstream(scene) << "format = 1\n[world]\ngravity = [0.0, -9.81, 0.0]\n[[body]]\nname = \"organ\"\nmesh = \""
                       << organMesh().generic_string() << "\"\nmesh_unit = \"mm\"\nmaterial = \"liver\"\n"
                       << "[[fix]]\nregion = { half_space = { point = [-0.05, 0, 0], normal = [1, 0, 0] } }\n";
  WorkstationDriver window("organ_accuracy");
  window.start({scene.string()});
  C3DE_WAIT(window, "the organ is shown", s["jobs"].empty() && row(s, "Displacement").find("±") != std::string::npos);
  window.moveTo(window.inView(0.5, 0.5));
  window.key("f");
  CHECK(row(window.state(), "Tissue stiffness") == "1 … 15 kPa");
  const double before = window.number(kPanel + "Phyxels");

  const auto wish = [&](const char *parameter, const std::string &value) {
    if (row(window.state(), parameter) == "auto") window.click(kPanel + parameter + ".auto");
    C3DE_WAIT(window, "a number can be given", row(s, parameter) != "auto");
    window.enterNumber(kPanel + parameter, value);
    C3DE_WAIT(window, "the number is taken", std::stod("0" + row(s, parameter)) == std::stod(value));
    const std::string hash = row(window.state(), "Phyxels");
    window.click(kPanel + "apply_wish");
    return C3DE_WAIT(window, "the organ is sampled anew",
                     s["jobs"].empty() && !row(s, "Phyxels").empty() && row(s, "Phyxels") != hash);
  };
  const Json accurate = wish(kPercent, "0.4");
  CHECK(std::stod(row(accurate, "Phyxels")) > 2.0 * before);
  window.locate(kPanel + "rebuild");  // below the bars
  window.screenshotAtRest("error");
  // Another accuracy target replaces the first one.
  const Json quick = wish(kBudget, "0.5");
  CHECK(std::stod(row(quick, "Phyxels")) < std::stod(row(accurate, "Phyxels")));
  CHECK(row(quick, kPercent) == "auto");
  window.key("space");
  C3DE_WAIT(window, "it plays within its budget", row(s, "Frame time").find("now") != std::string::npos);
  window.screenshot("budget");
  CHECK(window.state()["messages"].empty());
}

TEST_CASE("inertia that explicit steps ask for is told, and goes with them", "[organ_inertia]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path scene = outputFile("inertia.toml");
  std::ofstream(scene)
      << "format = 1\n[world]\ngravity = [0.0, -9.81, 0.0]\n[solver]\nintegrator = \"explicit\"\n[[body]]\nname = "
         "\"organ\"\nmesh = \""
      << organMesh().generic_string()
      << "\"\nmesh_unit = \"mm\"\nmaterial = \"liver\"\nsampling = { count = 1500, adaptive = \"on\" }\n"
         "parts = [ { region = { sphere = { centre = [-0.048, 0, 0], radius = 0.004 } }, material = { youngs_modulus "
         "= 1e8 } } ]\n"
         "[[fix]]\nregion = { half_space = { point = [-0.05, 0, 0], normal = [1, 0, 0] } }\n";
  WorkstationDriver window("organ_inertia");
  window.start({scene.string()});
  const auto isTold = [](const Json &s) {
    return row(s, "Added inertia").find(" % of what can move, to ") != std::string::npos;
  };
  const Json made = C3DE_WAIT(window, "the organ is shown", s["jobs"].empty() && !row(s, "Halved cells").empty());
  CHECK(isTold(made));
  const std::string mass = row(made, "Mass");
  window.locate(kPanel + "view.surface");  // below it
  window.screenshotAtRest("told");
  const auto choose = [&](const std::string &integrator) { window.choose(kPanel + "solver.integrator", integrator); };
  choose("implicit");
  const Json implicit = C3DE_WAIT(window, "it is gone", !isTold(s));
  CHECK(row(implicit, "Mass") == mass);
  choose("explicit");
  window.waitUntil("it is there again", isTold);
}
