// SPDX-License-Identifier: Apache-2.0
// User actions with an organ in the window: open it, close it, export it, quit.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/catch.h"
#include "ui/program_command.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace fs = std::filesystem;

TEST_CASE("a mesh alone falls on a floor and stays in sight", "[organ_floor]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_floor");
  window.start({organMesh().string(), "--play"});
  C3DE_WAIT(window, "the organ is shown", !row(s, "Surfels").empty());
  window.screenshot("falling");
  // Free fall would have taken it 20 m down.
  C3DE_WAIT(window, "two seconds are simulated", s["transport"]["time_s"].get<double>() > 2.0);
  pause(window);
  window.screenshot("lying");
  CHECK(window.shareOfColour("lying", "r > 1.6*g && r > 0.25") > 0.03);
  const Json nodes = window.state()["nodes"];
  CHECK(std::any_of(nodes.begin(), nodes.end(),
                    [](const Json &node) { return node.dump().find("World box") != std::string::npos; }));
}

TEST_CASE("an organ is loaded through the plugin's panel, and a bad file leaves it", "[organ_load]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_load");
  startOrgan(window);
  const std::string before = row(window.state(), "Body");
  const fs::path copy = outputFile("second_organ.obj");
  fs::copy_file(organMesh(), copy, fs::copy_options::overwrite_existing);
  const auto choose = [&](const fs::path &file) {
    window.click(kPanel + "browse");
    window.enterFile(file);
    C3DE_WAIT(window, "the file is taken", fileOfProgram(row(s, "browse")) == fs::weakly_canonical(file));
    window.click(kPanel + "load");
  };
  choose(copy);
  C3DE_WAIT(window, "the new organ is there", row(s, "Body") == "second_organ" && s["jobs"].empty());
  CHECK(window.state()["notifications"].empty());
  window.screenshot("loaded");
  window.moveTo(window.inView(0.9, 0.1));
  window.key("ctrl+z");
  C3DE_WAIT(window, "the former organ is back", row(s, "Body") == before && s["jobs"].empty());
  window.key("ctrl+y");
  C3DE_WAIT(window, "the new organ is there again", row(s, "Body") == "second_organ" && s["jobs"].empty());

  const fs::path bad = outputFile("bad_organ.obj");
  std::ofstream(bad) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n";
  choose(bad);
  const Json refused = C3DE_WAIT(window, "it is refused",
                                 !s["notifications"].empty() && s["notifications"].back()["severity"] == "error");
  CHECK_THAT(refused["notifications"].back()["text"].get<std::string>(), Contains("bad_organ.obj"));
  CHECK(row(refused, "Body") == "second_organ");
  window.screenshot("refused");
}

TEST_CASE("a mesh that says its unit is opened in it", "[organ_unit]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path file = outputFile("in_metres.obj");
  std::ofstream(file)
      << "# SPACE=LPS UNITS=m\nv 0 0 0\nv .2 0 0\nv .2 .1 0\nv 0 .1 0\nv 0 0 .1\nv .2 0 .1\nv .2 .1 .1\n"
         "v 0 .1 .1\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const auto isTwoLitres = [](const Json &s) { return s["jobs"].empty() && row(s, "Volume") == "2000 ml"; };
  {
    WorkstationDriver window("organ_unit");
    window.start({file.string()});
    CHECK(window.waitUntil("it is of the file's unit", isTwoLitres)["notifications"].empty());
    // The dialog leaves the unit to the file, too.
    window.key("ctrl+m");
    C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("dialog/path"));
    CHECK(window.value("dialog/unit").empty());
    window.screenshot("dialog");
  }
  WorkstationDriver asked("organ_unit_asked");
  asked.start({"--unit", "cm", file.string()});
  const Json state = C3DE_WAIT(asked, "a unit that is asked for wins, and looks wrong",
                               s["jobs"].empty() && !s["notifications"].empty());
  CHECK(state["notifications"][0]["title"] == "Is the unit right?");
  CHECK_THAT(state["notifications"][0]["text"].get<std::string>(), Contains("cm, as requested"));
  // The panel of the plugin leaves it to the file.
  CHECK(row(state, "Volume") != "2000 ml");
  asked.click(kPanel + "browse");
  asked.enterFile(file);
  C3DE_WAIT(asked, "the file is taken", fileOfProgram(row(s, "browse")) == fs::weakly_canonical(file));
  asked.click(kPanel + "load");
  asked.waitUntil("it is of the file's unit", isTwoLitres);
}

TEST_CASE("a file that cannot be opened leaves the simulation that is open", "[organ_keeps]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_keeps");
  startOrgan(window);
  const fs::path bad = outputFile("bad_scene.toml");
  std::ofstream(bad) << "format = 1\n[world]\ngravty = [0.0, -9.81, 0.0]\n[[body]]\nname = \"organ\"\nmesh = \""
                     << organMesh().generic_string() << "\"\nmesh_unit = \"mm\"\n";
  window.key("space");
  window.key("ctrl+o");
  window.enterFile(bad);
  const Json state = C3DE_WAIT(window, "it is refused", s["notifications"].size() == 1);
  const std::string text = state["notifications"][0]["text"];
  CHECK_THAT(text, Contains("bad_scene.toml:3") && Contains("gravty") && Contains("gravity"));
  CHECK(state["transport"]["title"] == "Floating organ");
  const auto steps = state["transport"]["steps"].get<long long>();
  C3DE_WAIT(window, "it goes on", s["transport"]["steps"].get<long long>() > steps + 5);
  window.screenshot("kept");
}

TEST_CASE("a simulation that plays is closed by the menu, and another one is opened", "[organ_close]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_close");
  startOrgan(window);
  window.key("p");
  play(window);
  window.clickMenu("file.close_simulation");
  const Json closed = C3DE_WAIT(window, "it is closed", s["transport"]["exists"] == false);
  CHECK(closed["nodes"].empty());
  CHECK(row(window.state(), "Surfels").empty());
  window.screenshot("closed");
  window.key("ctrl+m");
  window.openFile(organMesh());
  C3DE_WAIT(window, "another one is there",
            s["transport"]["exists"].get<bool>() && s["jobs"].empty() && !row(s, "Surfels").empty());
}

TEST_CASE("surface and frame of the present state are exported through the menu", "[organ_export]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_export");
  startOrgan(window);
  const fs::path folder = outputFile("export");
  fs::remove_all(folder);
  fs::create_directories(folder);
  const auto save = [&](const std::string &entry, const fs::path &file) {
    window.click("menu/file");
    C3DE_WAIT(window, "the menu is open", s["widgets"].contains("menu/" + entry));
    window.click("menu/" + entry);
    window.enterFile(file);
  };
  save("file.export_surface", folder / "now.stl");
  C3DE_WAIT(window, "it is written", s["notifications"].size() == 1);
  CHECK(window.state()["notifications"][0]["title"] == "Exported");
  REQUIRE(fs::exists(folder / "now.stl"));
  CHECK(fs::file_size(folder / "now.stl") > 84 + 50 * 100);  // more than a hundred triangles
  save("file.export_frame", folder / "now.pvd");
  window.waitUntil("the frame is there", [&](const Json &) { return fs::exists(folder / "now.pvd"); });
  CHECK(fs::exists(folder / "now_frames" / "points_000000.vtu"));
  CHECK(fs::exists(folder / "now_frames" / "skin_000000.vtp"));
  // An existing file is replaced only after a second press.
  const auto before = fs::last_write_time(folder / "now.stl");
  save("file.export_surface", folder / "now.stl");
  const Json asked = C3DE_WAIT(window, "the dialog asks", s["values"].contains("dialog/error"));
  CHECK_THAT(asked["values"]["dialog/error"].get<std::string>(), Contains("now.stl") && Contains("replace"));
  window.screenshot("asks");
  CHECK(fs::last_write_time(folder / "now.stl") == before);
  window.click("dialog/open");
  window.waitUntil("it is replaced", [&](const Json &) { return fs::last_write_time(folder / "now.stl") != before; });
  CHECK(window.isRunning());
}

TEST_CASE("quitting asks once a simulation has run, Escape stays, a button quits", "[organ_quit]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_quit");
  startOrgan(window);
  play(window);
  pause(window);
  const auto isAsked = [](const Json &s) { return s["values"].contains("quit/text"); };
  window.key("ctrl+q");
  const Json asked = window.waitUntil("it asks", isAsked);
  CHECK_THAT(asked["values"]["quit/text"].get<std::string>(), Contains("has changes that are not saved"));
  window.screenshot("asked");
  window.key("Escape");
  C3DE_WAIT(window, "it goes on", !isAsked(s));
  CHECK(window.isRunning());
  CHECK(window.state()["transport"]["steps"] > 5);
  window.key("ctrl+q");
  window.waitUntil("it asks again", isAsked);
  window.clickToEnd("quit/quit");
  CHECK(window.waitForExit() == 0);
}

TEST_CASE("quitting asks nothing while nothing would be lost", "[organ_quit]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_quit_at_start");
  startOrgan(window);
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);
}

TEST_CASE("commands and tools are found by words and run by Enter", "[find_command]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("find_command");
  startOrgan(window);
  window.moveTo(window.inView(0.5, 0.9));
  const auto find = [&](const std::string &words, const std::string &id) {
    window.key("ctrl+k");
    C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("palette/words"));
    window.type(words);
    C3DE_WAIT(window, "it is found", s["values"].value("palette/chosen", std::string()) == id);
  };
  const auto isClosed = [](const Json &s) { return !s["widgets"].contains("palette/words"); };
  find("play pause", "simulation.play");
  window.screenshot("found");
  window.key("Return");
  C3DE_WAIT(window, "it plays", mode(s) == "playing" && isClosed(s));
  find("tool pinch", "tools.pointbased.pinch");
  window.key("Return");
  C3DE_WAIT(window, "the tool is active", s["tool"] == "pointbased.pinch" && isClosed(s));
  // The second match by the arrow, with the mouse, and what cannot be executed.
  window.key("ctrl+k");
  C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("palette/words"));
  window.type("open");
  const Json all =
      C3DE_WAIT(window, "several are found", std::stoi("0" + s["values"].value("palette/found", std::string())) > 5);
  window.key("Down");
  C3DE_WAIT(window, "the next one is chosen",
            s["values"]["palette/chosen"] != all["values"]["palette/chosen"] && s["values"]["palette/chosen"] != "");
  window.key("Escape");
  window.waitUntil("it is closed", isClosed);
  find("label statistics csv", "file.save_statistics");
  window.key("Escape");
  window.waitUntil("it is closed", isClosed);
}
