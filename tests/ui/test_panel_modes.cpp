// SPDX-License-Identifier: Apache-2.0
// The two modes of the panel of a simulation, and the search of its rows.
#include <filesystem>
#include <string>

#include "support/catch.h"
#include "support/environment.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

std::string firstLight() { return (fs::path(testResourcesFolder()) / "scenes" / "first_light.toml").string(); }

/// A widget of the panel, also one that is scrolled out of it.
bool hasWidget(const Json &s, const std::string &id) {
  return s["widgets"].contains(kPanel + id) || s["scrolled_out"].contains(kPanel + id);
}

std::size_t widgetCount(const Json &s) {
  std::size_t count = 0;
  for (const char *where : {"widgets", "scrolled_out"})
    for (const auto &[key, rect] : s[where].items()) count += key.starts_with(kPanel) ? 1 : 0;
  return count;
}

bool isSimple(const Json &s) { return hasWidget(s, "hold"); }
bool isAll(const Json &s) { return hasWidget(s, "solver.integrator") && !hasWidget(s, "hold"); }

void openAsNewUser(WorkstationDriver &window) {
  window.asNewUser();
  window.start({firstLight()});
  C3DE_WAIT(window, "the organ is shown",
            s["transport"]["exists"].get<bool>() && s["jobs"].empty() && !row(s, "Displacement").empty());
}

void search(WorkstationDriver &window, const std::string &words) {
  window.click(kPanel + "rows.search");
  window.key("ctrl+a");
  window.type(words);
  C3DE_WAIT(window, "'" + words + "' is searched", row(s, "rows.search") == words && !row(s, "rows.found").empty());
}

}  // namespace

TEST_CASE("a new user chooses a tissue and a stiffness in kPa, plays, and sees the result", "[panel_simple]") {
  C3DE_ORGAN_OR_SKIP();
  const ScopedEnvironment user("C3DE_HOME", freshHome("panel_simple").string());
  WorkstationDriver window("panel_simple");
  openAsNewUser(window);
  const Json first = window.state();
  CHECK(isSimple(first));
  CHECK(widgetCount(first) < 30);
  CHECK_FALSE(hasWidget(first, "solver.dt"));
  CHECK_FALSE(hasWidget(first, "rows.search"));
  CHECK(row(first, "Neighbours").empty());
  CHECK(row(first, "material.youngs_modulus") == "6 kPa");
  CHECK(row(first, "tissue") == "custom");
  CHECK_THAT(row(first, "world.gravity"), Contains("m/s²"));
  CHECK(row(first, "accuracy.error_mm") == "auto");
  CHECK_THAT(first.dump(), Contains("Stress and strain") && Contains("Singular regions"));
  window.screenshotAtRest("start");

  window.choose(kPanel + "tissue", "spleen");
  C3DE_WAIT(window, "it is spleen", row(s, "tissue") == "spleen" && row(s, "material.youngs_modulus") == "3 kPa");
  window.enterNumber(kPanel + "material.youngs_modulus", "4.5");
  C3DE_WAIT(window, "it has a stiffness of its own",
            row(s, "material.youngs_modulus") == "4.5 kPa" && row(s, "tissue") == "custom");
  window.moveTo(window.inView(0.5, 0.5));
  window.key("ctrl+z");
  C3DE_WAIT(window, "the stiffness is undone", row(s, "tissue") == "spleen");
  window.key("ctrl+z");
  C3DE_WAIT(window, "the tissue is undone",
            row(s, "tissue") == "custom" && row(s, "material.youngs_modulus") == "6 kPa");
  window.key("ctrl+y");
  window.key("ctrl+y");
  window.waitForValue(kPanel + "material.youngs_modulus", "4.5 kPa");

  window.click(kPanel + "play");
  C3DE_WAIT(window, "it lands on the block",
            !row(s, "Contact with block").empty() && s["transport"]["time_s"].get<double>() > 0.5);
  window.choose(kPanel + "view.colour", "displacement");
  C3DE_WAIT(window, "the displacement is shown", row(s, "Colours").ends_with("mm"));
  window.click(kPanel + "pause");
  C3DE_WAIT(window, "it is paused", mode(s) == "paused");
  window.moveTo(window.inView(0.9, 0.1));
  window.screenshotAtRest("played");

  window.click(kPanel + "reset");
  C3DE_WAIT(window, "it is at its start", s["transport"]["steps"] == 0);
  CHECK(row(window.state(), "material.youngs_modulus") == "4.5 kPa");
  window.click(kPanel + "hold");
  C3DE_WAIT(window, "the tool for supports is active", s["tool"] == "pointbased.load" && hasWidget(s, "load_mode"));
  window.screenshotAtRest("hold");
}

TEST_CASE("the mode of the panel is remembered, and warnings are in both", "[panel_modes]") {
  C3DE_ORGAN_OR_SKIP();
  const ScopedEnvironment user("C3DE_HOME", freshHome("panel_modes").string());
  {
    WorkstationDriver window("panel_modes");
    openAsNewUser(window);
    CHECK(isSimple(window.state()));
    const std::string hash = window.state()["transport"].dump();
    window.click(kPanel + "view.mode.all");
    const Json all = C3DE_WAIT(window, "all rows are shown", isAll(s) && hasWidget(s, "rows.search"));
    CHECK(widgetCount(all) > 60);
    for (const char *line : {"Displacement", "Stress and strain", "Singular regions"})
      CHECK_FALSE(row(all, line).empty());
    CHECK(all["transport"].dump() == hash);
    window.screenshotAtRest("all");
    window.key("ctrl+q");
    CHECK(window.waitForExit() == 0);
  }
  {
    WorkstationDriver window("panel_modes_again");
    openAsNewUser(window);
    CHECK(isAll(window.state()));
    window.click(kPanel + "view.mode.simple");
    C3DE_WAIT(window, "it is simple", isSimple(s));
    window.key("ctrl+q");
    CHECK(window.waitForExit() == 0);
  }
  WorkstationDriver window("panel_modes_simple");
  openAsNewUser(window);
  CHECK(isSimple(window.state()));
}

TEST_CASE("rows of a panel are searched by label, id and tooltip, and Esc ends it", "[panel_search]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("panel_search");
  startOrgan(window);
  const Json before = window.state();
  REQUIRE(isAll(before));
  CHECK_FALSE(hasWidget(before, "material.volume_stiffness"));  // folded

  window.moveTo(window.inView(0.5, 0.5));
  window.key("ctrl+f");
  C3DE_WAIT(window, "the search field is in sight", s["widgets"].contains(kPanel + "rows.search"));
  window.type("VOLUME stiffness");
  const Json found = C3DE_WAIT(window, "the folded row is found", hasWidget(s, "material.volume_stiffness"));
  CHECK(found["widgets"].contains(kPanel + "material.volume_stiffness"));
  CHECK_FALSE(hasWidget(found, "solver.dt"));
  CHECK_FALSE(hasWidget(found, "pinch"));
  CHECK(found["tool"] == "orbit");
  CHECK(hasWidget(found, "view.mode.simple"));
  window.screenshot("found");  // the text cursor blinks

  window.key("Escape");
  C3DE_WAIT(window, "all rows are back", hasWidget(s, "solver.dt") && row(s, "rows.search").empty());
  CHECK_FALSE(hasWidget(window.state(), "material.volume_stiffness"));

  search(window, "solver.precond");  // an id
  CHECK(hasWidget(window.state(), "solver.preconditioner"));
  search(window, "carries mass moves");  // a tooltip
  CHECK(hasWidget(window.state(), "view.points"));
  CHECK(row(window.state(), "rows.found") == "1 row matches.");
  search(window, "xyzzy");
  C3DE_WAIT(window, "it says that there is none", row(s, "rows.found") == "No row matches 'xyzzy'.");
  CHECK_FALSE(hasWidget(window.state(), "solver.dt"));
  window.screenshot("none");
  window.click(kPanel + "rows.clear");
  C3DE_WAIT(window, "all rows are there again", hasWidget(s, "solver.dt") && row(s, "rows.found").empty());

  // A folded panel is opened.
  window.click(kPanel + "header");
  C3DE_WAIT(window, "it is folded", !hasWidget(s, "rows.search"));
  window.moveTo(window.inView(0.5, 0.5));
  window.key("ctrl+f");
  C3DE_WAIT(window, "it is open", hasWidget(s, "rows.search"));
  window.type("density");
  C3DE_WAIT(window, "it is searched", row(s, "rows.search") == "density" && !hasWidget(s, "solver.dt"));
  window.key("Escape");
  C3DE_WAIT(window, "it shows all rows", hasWidget(s, "solver.dt"));

  // What is edited while it is filtered is the same as without.
  search(window, "poisson");
  window.enterNumber(kPanel + "material.poisson_ratio", "0.31");
  window.waitForValue(kPanel + "material.poisson_ratio", "0.31");
  window.click(kPanel + "rows.clear");
  C3DE_WAIT(window, "all rows are there", hasWidget(s, "solver.dt"));
  CHECK(row(window.state(), "material.poisson_ratio") == "0.31");
}

TEST_CASE("every panel of a plugin can be searched, and a short one shows the field only meanwhile",
          "[panel_search_any]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("panel_search_any");
  window.start({"--plugin", C3DE_GALLERY_PLUGIN, "--plugin", examplePlugin("hello")});
  const std::string gallery = "test.gallery/", hello = "org.c3de.hello.panel/";
  const auto found = [&](const Json &s, const std::string &panel) { return textOf(s, panel + "rows.found"); };
  C3DE_WAIT(window, "both panels are shown",
            s["widgets"].contains(gallery + "press") &&
                (s["widgets"].contains(hello + "hello") || s["scrolled_out"].contains(hello + "hello")));
  window.moveTo(window.locate(gallery + "press"));
  window.key("ctrl+f");
  C3DE_WAIT(window, "its rows are searched", s["widgets"].contains(gallery + "rows.search"));
  window.type("poisson");
  C3DE_WAIT(window, "one row is left",
            found(s, gallery) == "1 row matches." && !s["widgets"].contains(gallery + "press") &&
                s["widgets"].contains(gallery + "poisson"));
  window.key("Escape");
  C3DE_WAIT(window, "all are back", s["widgets"].contains(gallery + "press"));

  window.moveTo(window.locate(hello + "hello"));
  CHECK_FALSE(window.has(hello + "rows.search"));
  window.key("ctrl+f");
  C3DE_WAIT(window, "the short panel has a field", s["widgets"].contains(hello + "rows.search"));
  window.type("xyzzy");
  C3DE_WAIT(window, "it says that there is none", found(s, hello) == "No row matches 'xyzzy'.");
  window.key("Escape");
  C3DE_WAIT(window, "the field is gone",
            s["widgets"].contains(hello + "hello") && !s["widgets"].contains(hello + "rows.search"));
}
