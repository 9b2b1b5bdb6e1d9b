// SPDX-License-Identifier: Apache-2.0
// The window without any simulator: menus, dialogs, camera, widgets, tools, jobs.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

#include "support/catch.h"
#include "ui/program_command.h"
#include "ui/workstation_driver.h"

using c3de::test::fileOfProgram;
using c3de::test::Json;
using c3de::test::Point;
using c3de::test::WorkstationDriver;

namespace {

/// Starts with the gallery plugin and a file that is not a mesh, so that no simulation starts whatever other plugins
/// are installed; the message about the file is closed.
void startGallery(WorkstationDriver &window) {
  const std::filesystem::path noMesh = c3de::test::outputFile("no_mesh.obj");
  std::ofstream(noMesh) << "this is no mesh\n";
  window.start({noMesh.string(), "--plugin", C3DE_GALLERY_PLUGIN});
  C3DE_WAIT(window, "the file is refused", s["notifications"].size() == 1);
  window.click("notification/close.0");
  C3DE_WAIT(window, "the message is closed", s["notifications"].empty());
}

double cameraValue(const WorkstationDriver &window, const char *name) { return window.state()["camera"][name]; }

}  // namespace

TEST_CASE("the window opens with its menus and closes by Ctrl+Q", "[start]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("start");
  startGallery(window);
  const Json state = window.state();
  for (const char *menu : {"file", "view", "simulation", "tools", "help"})
    CHECK(state["widgets"].contains(std::string("menu/") + menu));
  CHECK(state["view"]["w"] > 600);
  CHECK_FALSE(state["transport"]["exists"].get<bool>());
  window.screenshot("window");
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);
  CHECK(window.state()["closing"] == true);
}

TEST_CASE("with --play and no file the window plays the head of many tissues, and no message", "[default_scene]") {
  C3DE_WINDOW_OR_SKIP();
  if (!std::filesystem::exists("/usr/share/mricron/templates/ch2.nii.gz"))
    C3DE_SKIP("the scan of the default scene is not installed (Debian package mricron-data)");
  WorkstationDriver window("default_scene");
  window.start({"--play"});
  const Json state = C3DE_WAIT(window, "a scene is open",
                               s["transport"]["exists"].get<bool>() && s["jobs"].empty() && s["panes"].size() == 4);
  window.screenshot("head");
  // On a busy machine a job may pause for seconds.
  for (const Json &message : state["notifications"]) CHECK(message["title"] == "A job is slow to respond");
  CHECK(window.value("image/name") == "ch2.nii.gz");
}

TEST_CASE("menus open, and About names versions, graphics and plugins", "[menu]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("menu");
  startGallery(window);
  window.click("menu/file");
  C3DE_WAIT(window, "the menu is open", s["widgets"].contains("menu/file.open_mesh"));
  window.screenshot("file");
  window.click("menu/file");
  window.click("menu/simulation");
  const Json open = C3DE_WAIT(window, "the menu is open", s["widgets"].contains("menu/simulation.play"));
  CHECK(std::count(open["disabled"].begin(), open["disabled"].end(), "menu/simulation.play") == 1);
  window.click("menu/simulation");
  window.clickMenu("help.about");
  C3DE_WAIT(window, "About is open", s["values"].contains("about/version"));
  CHECK_THAT(window.value("about/version"), Contains("C3DE"));
  CHECK_THAT(window.value("about/graphics"), Contains("OpenGL") || Contains("GL"));
  window.screenshot("about");
  window.click("dialog/close");
  window.key("h");
  C3DE_WAIT(window, "the shortcuts are open", s["widgets"].contains("dialog/close"));
  window.screenshot("shortcuts");
  window.key("Escape");
  C3DE_WAIT(window, "they are closed", !s["widgets"].contains("dialog/close"));
}

TEST_CASE("a file that is no mesh leads to a message that says why, and the window goes on", "[bad_file]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("bad_file");
  startGallery(window);
  window.key("ctrl+m");
  C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("dialog/path"));
  window.screenshot("dialog");
  window.choose("dialog/unit", "m");
  window.waitForValue("dialog/unit", "m");
  window.click("dialog/path");
  window.type("/nowhere/liver.obj");
  window.key("Return");
  const Json refused = C3DE_WAIT(window, "the dialog says why", s["values"].contains("dialog/error"));
  CHECK_THAT(refused["values"]["dialog/error"].get<std::string>(), Contains("/nowhere/liver.obj"));
  window.click("dialog/path");
  window.key("ctrl+a");
  window.type(c3de::test::outputFile("no_mesh.obj").string());
  window.click("dialog/open");
  const Json state = C3DE_WAIT(window, "the file is refused", s["notifications"].size() == 1);
  CHECK(state["notifications"][0]["severity"] == "error");
  CHECK_THAT(state["notifications"][0]["title"].get<std::string>(), Contains("no_mesh.obj"));
  CHECK_FALSE(state["notifications"][0]["text"].get<std::string>().empty());
  CHECK_THAT(window.logText(), Contains("c3de: error:"));
  CHECK(state["nodes"].size() >= 2);  // the gallery's box is still there
  window.screenshot("refused");
  CHECK(window.isRunning());
}

TEST_CASE("what is in the file list opens by a double click, and by Enter once it is marked", "[file_list]") {
  C3DE_WINDOW_OR_SKIP();
  // A folder of its own: other tests fill that of the screenshots until its list scrolls.
  const std::filesystem::path folder = c3de::test::outputFile("file_list_folder");
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "no_mesh.obj") << "v 0 0 0\n";
  WorkstationDriver window("file_list");
  startGallery(window);
  for (const bool isDouble : {true, false}) {
    window.key("ctrl+m");
    C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("dialog/path"));
    window.click("dialog/path");
    window.key("ctrl+a");
    window.type(folder.string());
    window.key("Return");
    C3DE_WAIT(window, "the folder is listed", s["widgets"].contains("dialog/entry.no_mesh.obj"));
    if (isDouble) {
      window.doubleClickAt(window.locate("dialog/entry.no_mesh.obj"));
    } else {
      window.click("dialog/entry.no_mesh.obj");
      window.waitForValue("dialog/path", "no_mesh.obj");
      window.key("Return");
    }
    const Json state = C3DE_WAIT(window, "the file is opened, and refused", s["notifications"].size() == 1);
    CHECK_THAT(state["notifications"][0]["title"].get<std::string>(), Contains("no_mesh.obj"));
    CHECK_FALSE(state["widgets"].contains("dialog/path"));
    window.click("notification/close.0");
    C3DE_WAIT(window, "the message is closed", s["notifications"].empty());
  }
}

TEST_CASE("a window is never larger than the screen, also where a unit is two pixels", "[screen_size]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("screen_size");
  const std::filesystem::path noMesh = c3de::test::outputFile("no_mesh.obj");
  std::ofstream(noMesh) << "this is no mesh\n";
  // The virtual screen loses its settings when the last program disconnects.
  auto keeper = c3de::ChildProcess::start({"xprop", "-root", "-spy"}, c3de::test::outputFile("xprop.log"));
  if (!keeper) C3DE_SKIP("xprop is not there to set the density of the display");
  std::this_thread::sleep_for(std::chrono::seconds(1));
  // The desktop setting for a display with twice the usual density.
  const auto set = c3de::runProcess(
      {"xprop", "-root", "-f", "RESOURCE_MANAGER", "8s", "-set", "RESOURCE_MANAGER", "Xft.dpi: 192"}, 10.0);
  if (!set || set->exitCode != 0) C3DE_SKIP("xprop is not there to set the density of the display");
  const auto screen = c3de::runProcess({"xdotool", "getdisplaygeometry"}, 10.0);
  REQUIRE(screen.has_value());
  int width = 0, height = 0;
  REQUIRE(std::sscanf(screen->output.c_str(), "%d %d", &width, &height) == 2);
  window.start({noMesh.string(), "--plugin", C3DE_GALLERY_PLUGIN, "--size", "1280x800"});
  const Json state = window.state();
  const Json &size = state["window"];
  CHECK(size[0].get<int>() <= width);
  CHECK(size[1].get<int>() <= height);
  CHECK(size[0].get<int>() > width / 2);
}

TEST_CASE("no character that is typed into a dialog is lost, however fast they come", "[typing]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("typing");
  startGallery(window);
  window.key("ctrl+m");
  C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("dialog/path"));
  std::string text;
  for (int i = 0; i < 12; ++i) text += "/Aorta_thoracica-" + std::to_string(i) + "/Liver..ooll";
  for (const int delay_ms : {0, 12}) {
    window.type(text, delay_ms);
    window.waitForValue("dialog/path", text);
    window.key("ctrl+a");
    window.key("BackSpace");
    window.waitForValue("dialog/path", "");
  }
  // Letters, Backspace and Ctrl in one sequence keep their order.
  window.keys({"a", "b", "c", "BackSpace", "d", "Left", "e", "ctrl+a", "x", "y", "BackSpace", "z"});
  window.waitForValue("dialog/path", "xz");
  window.key("Escape");
  window.key("Escape");
  C3DE_WAIT(window, "it is closed", !s["widgets"].contains("dialog/path"));
  // Characters typed right after the keys that open the dialog belong to it.
  window.keys({"ctrl+o", "s", "c", "e", "n", "e"});
  window.waitForValue("dialog/path", "scene");
}

TEST_CASE("messages cover no view, go by being closed, and can be read later", "[messages]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("messages");
  startGallery(window);
  window.click("test.gallery/notify");
  const Json told = C3DE_WAIT(window, "there is a message", s["widgets"].contains("notification/close.0"));
  CHECK(told["widgets"]["notification/close.0"][2].get<double>() <= told["area"]["x"].get<double>());
  window.screenshot("told");
  window.click("notification/close.0");
  C3DE_WAIT(window, "it is closed", s["notifications"].empty());
  window.click("status/messages");
  window.waitForValue("messages/count", "2");  // the file that is no mesh, and this one
  window.screenshot("log");
  window.key("Escape");
  C3DE_WAIT(window, "the list is closed", !s["values"].contains("messages/count"));
}

TEST_CASE("a panel that fails again and again is switched off with one message, and on again by it", "[switched_off]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("switched_off");
  const std::filesystem::path noMesh = c3de::test::outputFile("no_mesh.obj");
  std::ofstream(noMesh) << "this is no mesh\n";
  window.start({noMesh.string(), "--plugin", C3DE_THROWING_PLUGIN});
  const auto failures = [&] {
    const std::string log = window.logText();
    std::size_t n = 0;
    for (auto at = log.find("thrown in a panel"); at != std::string::npos; at = log.find("thrown in a panel", at + 1))
      ++n;
    return n;
  };
  C3DE_WAIT(window, "the panel is off", s["widgets"].contains("test.panel/c3de.switch_on"));
  CHECK(failures() == 3);
  const Json told = window.state();
  std::size_t messages = 0;
  for (const Json &n : told["notifications"])
    messages += n["title"].get<std::string>() == "panel 'Test' of test.throws_later" ? 1u : 0u;
  CHECK(messages == 1);
  window.screenshot("off");

  // The panel continues to fail: three more times, and it is off again.
  window.click("test.panel/c3de.switch_on");
  C3DE_WAIT(window, "the panel is off again", failures() == 6 && s["widgets"].contains("test.panel/c3de.switch_on"));
  window.click("notification/choose.0.0");  // the newest is on top
  window.waitUntil("the panel is off for the third time", [&](const Json &) { return failures() >= 9; });
}

TEST_CASE("mouse and keys move the camera", "[camera]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("camera");
  startGallery(window);
  window.moveTo(window.inView(0.5, 0.5));
  window.key("f");
  const Json fitted = window.state()["camera"];
  CHECK(fitted["focus"][0].get<double>() == Approx(0.0).margin(1e-9));
  CHECK(fitted["distance"] > 50.0);
  CHECK(fitted["distance"] < 2000.0);
  window.screenshot("fitted");

  const double yaw = cameraValue(window, "yaw"), distance = cameraValue(window, "distance");
  window.drag(window.inView(0.5, 0.5), window.inView(0.6, 0.5), 4);
  CHECK(std::abs(cameraValue(window, "yaw") - yaw) > 0.1);
  CHECK(cameraValue(window, "distance") == distance);

  window.drag(window.inView(0.5, 0.5), window.inView(0.6, 0.6), 4, 2);
  CHECK(std::abs(window.state()["camera"]["focus"][1].get<double>()) > 1.0);

  window.drag(window.inView(0.5, 0.5), window.inView(0.5, 0.7), 4, 3);
  const double dragged = cameraValue(window, "distance");
  CHECK(dragged != distance);
  window.wheel(3);
  C3DE_WAIT(window, "the wheel zooms in", s["camera"]["distance"] < 0.9 * dragged);

  window.key("5");
  C3DE_WAIT(window, "the view is from above", s["camera"]["pitch"] > 1.5);
  window.key("1");
  C3DE_WAIT(window, "the view is from the front", std::abs(s["camera"]["pitch"].get<double>()) < 1e-6);
  // A drag that begins in the panel is not the camera's.
  const Json before = window.state()["camera"];
  window.drag({20, 500}, window.inView(0.5, 0.5), 3);
  CHECK(window.state()["camera"] == before);
}

TEST_CASE("widgets of a panel do what they say", "[widgets]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("widgets");
  startGallery(window);
  window.click("test.gallery/press");
  window.click("test.gallery/press");
  window.waitForValue("test.gallery/Presses", "2");
  window.click("test.gallery/off");
  CHECK(window.value("test.gallery/Presses") == "2");
  window.click("test.gallery/check");
  window.waitForValue("test.gallery/check", "true");

  const Point slider = window.locate("test.gallery/slider");
  window.drag(slider, {slider.x + 20, slider.y}, 3);
  CHECK(window.number("test.gallery/Slider") > 2.5);
  CHECK(window.number("test.gallery/Slider") < 5.0);
  window.enterNumber("test.gallery/slider", "3.125 N");
  window.waitForValue("test.gallery/Slider", "3.125000");

  window.choose("test.gallery/choice", "quasistatic");
  window.waitForValue("test.gallery/choice", "quasistatic");
  window.click("test.gallery/text");
  window.key("ctrl+a");
  window.type("spleen");
  window.waitForValue("test.gallery/text", "spleen");
  // Typed text triggers no shortcut.
  CHECK(window.state()["tool"] == "orbit");
  window.key("Escape");

  const std::filesystem::path organ = c3de::test::outputFile("no_mesh.obj");
  window.click("test.gallery/file");
  window.enterFile(organ);
  C3DE_WAIT(window, "the file is chosen",
            fileOfProgram(s["values"].value("test.gallery/File", "")) == std::filesystem::weakly_canonical(organ));
  window.click("test.gallery/notify");
  C3DE_WAIT(window, "the plugin's message is shown",
            s["notifications"].size() == 1 && s["notifications"][0]["severity"] == "warn");
  window.screenshot("gallery");
}

TEST_CASE("parameters are edited with range and unit, and refused values say why", "[params]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("params");
  startGallery(window);
  CHECK(window.value("test.gallery/youngs") == "5 kPa");
  const Point youngs = window.locate("test.gallery/youngs");
  window.drag(youngs, {youngs.x + 15, youngs.y}, 3);
  CHECK_THAT(window.value("test.gallery/Changed"), Contains("youngs = "));

  window.enterNumber("test.gallery/poisson", "0.4501");
  window.waitForValue("test.gallery/Changed", "poisson = 0.4501");
  window.enterNumber("test.gallery/poisson", "0.5");
  window.waitFrames(1);
  CHECK(window.value("test.gallery/poisson") == "0.4501");
  CHECK(window.value("test.gallery/Changed") == "poisson = 0.4501");
  window.screenshot("refused");

  window.choose("test.gallery/law", "neo_hookean");
  window.waitForValue("test.gallery/Changed", "law = neo_hookean");
  CHECK(window.value("test.gallery/dt") == "auto");
  window.click("test.gallery/dt.auto");
  window.waitForValue("test.gallery/Changed", "dt = 0.001");
  window.click("test.gallery/dt.auto");
  window.waitForValue("test.gallery/Changed", "dt = auto");
  window.click("test.gallery/surface");
  window.waitForValue("test.gallery/Changed", "surface = 0");
  window.screenshot("parameters");
}

TEST_CASE("the active tool gets the left button, and lets go on Escape", "[tool]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("tool");
  startGallery(window);
  window.moveTo(window.inView(0.5, 0.5));
  window.key("t");
  C3DE_WAIT(window, "the tool is active", s["tool"] == "test.marker");
  const Json camera = window.state()["camera"];
  window.drag(window.inView(0.4, 0.5), window.inView(0.6, 0.5), 4);
  CHECK(window.state()["camera"] == camera);
  // The counts are far down in the panel, but they are values of every frame.
  CHECK(window.value("test.gallery/Tool presses") == "1");
  CHECK(window.value("test.gallery/Tool releases") == "1");
  CHECK(window.number("test.gallery/Tool moves") >= 4);
  CHECK(window.value("test.gallery/Tool cancels") == "0");
  window.screenshot("active");

  window.moveTo(window.inView(0.4, 0.5));
  window.press();
  window.key("Escape");
  window.waitForValue("test.gallery/Tool cancels", "1");
  window.release();
  CHECK(window.value("test.gallery/Tool releases") == "1");

  // Shift and the middle button still control the camera.
  window.drag(window.inView(0.4, 0.5), window.inView(0.5, 0.5), 3, 2);
  CHECK(window.state()["camera"]["focus"] != camera["focus"]);
  window.click("toolbar/tool.orbit");
  C3DE_WAIT(window, "no tool is active", s["tool"] == "orbit");
  window.drag(window.inView(0.4, 0.5), window.inView(0.5, 0.5), 3);
  CHECK(window.value("test.gallery/Tool presses") == "2");
}

TEST_CASE("a long job shows its progress beside a live window and can be cancelled", "[job]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("job");
  startGallery(window);
  window.click("test.gallery/job");
  const Json running = C3DE_WAIT(window, "the job runs", s["jobs"].size() == 1 && s["jobs"][0]["fraction"] > 0.0);
  CHECK(running["jobs"][0]["title"] == "A long job");
  window.click("test.gallery/press");
  window.waitForValue("test.gallery/Presses", "1");
  window.screenshot("running");
  window.click("job/cancel.0");
  C3DE_WAIT(window, "the job ends", s["jobs"].empty());
  window.waitForValue("test.gallery/Job", "-12");
}

TEST_CASE("a job that appears does not end what the mouse does", "[job_mid_press]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("job_mid_press");
  startGallery(window);
  const Point at = window.locate("test.gallery/press");
  window.click("test.gallery/job");
  // Pressed before the job is old enough to be shown, released after.
  window.moveTo(at);
  window.press();
  C3DE_WAIT(window, "the job is shown", s["widgets"].contains("job/cancel.0"));
  window.waitFrames(3);
  window.release();
  window.waitForValue("test.gallery/Presses", "1");
  window.click("job/cancel.0");
  window.waitForValue("test.gallery/Job", "-12");
}

TEST_CASE("what is under the mouse stays there while rows above it come and go", "[steady_rows]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("steady_rows");
  startGallery(window);
  window.click("test.gallery/restless");
  window.click("test.gallery/job");  // frames without input
  const Point at = window.locate("test.gallery/press");
  const double header = window.state()["widgets"]["test.gallery/header"][1];
  window.clickAt(at);
  window.waitForValue("test.gallery/Presses", "1");
  const auto rect = [&](const Json &s) { return s["widgets"]["test.gallery/press"]; };
  const Json stands = rect(window.state());
  bool wentDown = false, wentUp = false;
  for (int press = 2; press <= 20; ++press) {
    for (int i = 0; i < 3; ++i) {
      const Json now = window.state();
      CHECK(rect(now) == stands);
      const Json above = now["widgets"].contains("test.gallery/header") ? now["widgets"]["test.gallery/header"]
                                                                        : now["scrolled_out"]["test.gallery/header"];
      wentDown = wentDown || above[1] > header + 20.0;
      wentUp = wentUp || above[1] < header - 20.0;
      window.waitFrames(1);
    }
    window.clickAt(at);
    window.waitForValue("test.gallery/Presses", std::to_string(press));
  }
  CHECK(wentDown);  // there is space above
  CHECK(wentUp);
  window.screenshot("moving");
  // The free space follows the mouse.
  window.click("test.gallery/restless");
  window.moveTo(window.inView(0.5, 0.5));
  window.click("job/cancel.0");
  C3DE_WAIT(window, "the job ends", s["jobs"].empty());
  window.moveTo(window.inView(0.5, 0.5));
  CHECK(window.locate("test.gallery/header").y < header + 20.0);
  window.screenshot("left");
}

TEST_CASE("F12 writes a picture and says where", "[screenshot]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("screenshot");
  startGallery(window);
  window.key("F12");
  const Json state = C3DE_WAIT(window, "it says where", s["notifications"].size() == 1);
  CHECK(state["notifications"][0]["title"] == "Screenshot saved");
  const std::filesystem::path file = fileOfProgram(state["notifications"][0]["text"]);
  REQUIRE(std::filesystem::is_regular_file(file));
  CHECK(std::filesystem::file_size(file) > 500);
  std::filesystem::remove(file);
}

TEST_CASE("the side panel can be made wider, and the layout reset", "[layout]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("layout");
  startGallery(window);
  const double before = window.state()["view"]["x"];
  const Point grip = window.locate("window/splitter");
  window.drag(grip, {grip.x + 100, grip.y}, 4);
  CHECK(window.state()["view"]["x"].get<double>() == Approx(before + 100).margin(4));
  window.clickMenu("view.reset_layout");
  C3DE_WAIT(window, "the panel is as wide as before", s["view"]["x"] == before);
  // Its check box hides and shows a node.
  window.click("scene/box");
  C3DE_WAIT(window, "the box is hidden", s["nodes"][1]["visible"] == false);
  window.click("scene/box");
  C3DE_WAIT(window, "the box is shown", s["nodes"][1]["visible"] == true);
}

TEST_CASE("nothing is drawn while nothing changes", "[idle]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("idle");
  startGallery(window);
  window.moveTo(window.inView(0.5, 0.5));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const int before = window.state()["frame"];
  std::this_thread::sleep_for(std::chrono::seconds(2));
  CHECK(window.state()["frame"] <= before + 1);
}

TEST_CASE("without OpenGL 4.3 the program says what it found and ends with 6", "[old_gl]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver program("old_gl");
  const std::filesystem::path noMesh = c3de::test::outputFile("no_mesh.obj");
  std::ofstream(noMesh) << "this is no mesh\n";
  const int code = program.startAndWait({noMesh.string()}, {"LIBGL_ALWAYS_SOFTWARE=1", "MESA_GL_VERSION_OVERRIDE=3.1"});
  CHECK(code == 6);
  CHECK_THAT(program.logText(), Contains("4.3") && Contains("3.1"));
}
