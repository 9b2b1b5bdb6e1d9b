// SPDX-License-Identifier: Apache-2.0
// The page that the window shows while nothing is open, and the recent files.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "support/catch.h"
#include "support/dicom_series.h"
#include "support/environment.h"
#include "ui/image_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

/// Empty, and removed with all lists of other tests.
fs::path freshHome(const std::string &name) {
  fs::path home = outputFile(name + "_home");
  fs::remove_all(home);
  return home;
}

std::string recent(const Json &state, int index, const std::string &what = {}) {
  return state["values"].value("start/recent." + std::to_string(index) + (what.empty() ? "" : "." + what), "");
}

bool isPageShown(const Json &state) { return state["widgets"].contains("start/open_scan"); }

bool isOpen(const Json &state) { return state["transport"]["exists"].get<bool>() && state["jobs"].empty(); }

void closeSimulation(WorkstationDriver &window) {
  window.clickMenu("file.close_simulation");
  C3DE_WAIT(window, "the page is shown", isPageShown(s));
}

void quit(WorkstationDriver &window) {
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);
}

}  // namespace

TEST_CASE("the start page opens an example, and lists it with a picture after it was closed", "[start_page]") {
  C3DE_ORGAN_OR_SKIP();
  const ScopedEnvironment user("C3DE_HOME", freshHome("start_page").string());
  {
    WorkstationDriver window("start_page");
    window.start(std::vector<std::string>{});
    const Json empty =
        C3DE_WAIT(window, "the page is shown", isPageShown(s) && s["widgets"].contains("start/example.organ"));
    CHECK(empty["notifications"].empty());
    CHECK(recent(empty, 0).empty());
    window.screenshotAtRest("empty");
    window.click("start/example.organ");
    const Json opened = C3DE_WAIT(window, "the organ is there", isOpen(s) && s["nodes"].size() >= 2);
    CHECK_FALSE(isPageShown(opened));
    window.waitFrames(5, 1.0);
    // The page is not in the way of the camera.
    const Json camera = window.state()["camera"];
    window.drag(window.inView(0.4, 0.5), window.inView(0.5, 0.5), 3);
    CHECK(window.state()["camera"] != camera);
    closeSimulation(window);
    const Json listed = C3DE_WAIT(window, "it is listed", recent(s, 0, "state") == "with picture");
    CHECK(recent(listed, 0) == "first_light.toml");
    CHECK(recent(listed, 0, "kind") == "Scene");
    window.screenshotAtRest("listed");
    // A drag over the page does not turn the camera.
    const Json turned = window.state()["camera"];
    window.drag(window.inView(0.4, 0.95), window.inView(0.5, 0.95), 3);
    CHECK(window.state()["camera"] == turned);
    window.click("start/recent.0");
    C3DE_WAIT(window, "it is open again", isOpen(s));
    quit(window);
  }
  WorkstationDriver window("start_page_again");
  window.start(std::vector<std::string>{});
  C3DE_WAIT(window, "the next window lists it", recent(s, 0, "state") == "with picture");
  window.key("Return");
  C3DE_WAIT(window, "Enter opens it", isOpen(s));
  quit(window);
}

TEST_CASE("missing files are marked on the start page and can be removed from the list", "[start_missing]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path home = freshHome("start_missing");
  const ScopedEnvironment user("C3DE_HOME", home.string());
  const fs::path first = outputFile("start_first.obj"), second = outputFile("start_second.obj");
  for (const fs::path &file : {first, second}) fs::copy_file(organMesh(), file, fs::copy_options::overwrite_existing);
  WorkstationDriver window("start_missing");
  window.start({first.string()});
  C3DE_WAIT(window, "the mesh is open", isOpen(s));
  CHECK_FALSE(isPageShown(window.state()));
  window.key("ctrl+m");
  window.openFile(second);
  C3DE_WAIT(window, "the other one is open", isOpen(s) && s["title"].get<std::string>().starts_with("start_second"));
  closeSimulation(window);
  const Json both =
      C3DE_WAIT(window, "both are listed", !recent(s, 1).empty() && recent(s, 0, "state") == "with picture");
  CHECK(recent(both, 0) == "start_second.obj");
  CHECK(recent(both, 1) == "start_first.obj");
  CHECK(recent(both, 1, "kind") == "Mesh");
  CHECK(recent(both, 1, "state") == "with picture");

  fs::remove(second);
  window.click("menu/file");
  window.click("menu/file.open_recent");
  const Json menu = C3DE_WAIT(window, "the menu lists them",
                              s["widgets"].contains("menu/file.recent.1") && recent(s, 0, "state") == "missing");
  CHECK(std::count(menu["disabled"].begin(), menu["disabled"].end(), "menu/file.recent.0") == 1);
  window.screenshotAtRest("menu");
  window.click("menu/file.recent.1");
  C3DE_WAIT(window, "the first is open", isOpen(s) && s["title"].get<std::string>().starts_with("start_first"));
  closeSimulation(window);
  const Json missing = C3DE_WAIT(window, "the order has changed", recent(s, 0) == "start_first.obj");
  CHECK(recent(missing, 1, "state") == "missing");
  CHECK(std::count(missing["disabled"].begin(), missing["disabled"].end(), "start/recent.1") == 1);
  window.screenshotAtRest("missing");
  // Enter does not open it, and its button removes it.
  window.key("Right");
  window.key("Return");
  window.waitFrames(4, 0.5);
  CHECK(window.state()["notifications"].empty());
  CHECK(isPageShown(window.state()));
  window.click("start/recent.1.remove");
  C3DE_WAIT(window, "it is removed", recent(s, 1).empty() && !recent(s, 0).empty());
  window.clickMenu("file.open_recent");
  window.click("menu/file.clear_recent");
  C3DE_WAIT(window, "the list is empty", recent(s, 0).empty());
  CHECK(fs::exists(first));
  quit(window);
}

TEST_CASE("scans and sessions are listed, and a damaged list is reported once", "[start_kinds]") {
  C3DE_WINDOW_OR_SKIP();
  const fs::path home = freshHome("start_kinds");
  const ScopedEnvironment user("C3DE_HOME", home.string());
  fs::path folder;
  {
    const fs::path session = outputFile("start_kinds.c3de");
    fs::remove(session);
    WorkstationDriver window("start_kinds");
    startWithLabels(window, "start_kinds");
    window.key("ctrl+s");
    window.enterFile(session);
    C3DE_WAIT(window, "it is saved", s["title"] == "start_kinds.c3de - C3DE");
    window.clickMenu("file.close_image");
    const Json listed = C3DE_WAIT(window, "both are listed",
                                  recent(s, 0, "state") == "with picture" && recent(s, 1, "state") == "with picture");
    CHECK(recent(listed, 0) == "start_kinds.c3de");
    CHECK(recent(listed, 0, "kind") == "Session");
    CHECK(recent(listed, 1) == "start_kinds_phantom.nii.gz and 1 more");
    CHECK(recent(listed, 1, "kind") == "Scan");
    window.screenshotAtRest("listed");
    window.moveTo(window.locate("start/recent.0"));
    window.press(3);
    window.release(3);
    C3DE_WAIT(window, "its menu is open", s["widgets"].contains("start/recent.0.open"));
    window.screenshot("context");
    window.click("start/recent.0.remove");
    C3DE_WAIT(window, "it is removed", recent(s, 0).starts_with("start_kinds_phantom"));
    window.click("start/recent.0");
    C3DE_WAIT(window, "image and labels are open",
              s["panes"].size() == 4 && s["jobs"].empty() && !imageText(s, "Label map").empty());
    quit(window);
    for (const auto &entry : fs::recursive_directory_iterator(home))
      if (entry.path().filename() == "recent.json") folder = entry.path().parent_path();
  }
  REQUIRE_FALSE(folder.empty());
  std::ofstream(folder / "recent.json") << "{";
  WorkstationDriver window("start_damaged");
  window.start(std::vector<std::string>{});
  const Json told = C3DE_WAIT(window, "it is reported", isPageShown(s) && !s["notifications"].empty());
  CHECK(told["notifications"].size() == 1);
  CHECK_THAT(told["notifications"][0]["text"].get<std::string>(), Contains("recent.json") && Contains("damaged"));
  window.screenshotAtRest("damaged");
  window.click("start/open_folder");
  C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("dialog/path"));
  window.screenshot("folder");
  window.key("Escape");
  window.key("Escape");
  C3DE_WAIT(window, "it is closed", !s["widgets"].contains("dialog/path"));
  window.click("start/open_scene");
  window.enterFile(fs::path(testResourcesFolder()) / "nothing.toml");
  C3DE_WAIT(window, "the dialog says why", s["values"].contains("dialog/error"));
  CHECK(window.state()["notifications"].size() == 1);
}

TEST_CASE("arrow keys scroll a long list of recent files, and a DICOM folder is opened and listed", "[start_folder]") {
  C3DE_WINDOW_OR_SKIP();
  const fs::path home = freshHome("start_folder");
  const ScopedEnvironment user("C3DE_HOME", home.string());
  const fs::path list = userDataDirectory() / "recent", series = outputFile("start_series");
  fs::create_directories(list);
  fs::create_directories(series);
  Json files = Json::array();
  for (int i = 0; i < 12; ++i) {
    const fs::path mesh = outputFile("start_mesh_" + std::to_string(i) + ".obj");
    std::ofstream(mesh) << "v 0 0 0\n";
    files.push_back({{"files", {mesh.string()}}, {"kind", "mesh"}, {"opened_at", "2026-01-02T03:04:05Z"}});
  }
  std::ofstream(list / "recent.json") << Json{{"format", 1}, {"files", files}};
  const std::vector<std::int16_t> values(12 * 10 * 4, 40);
  writeDicomSeries(series, {12, 10, 4}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1}, values);
  WorkstationDriver window("start_folder");
  window.start(std::vector<std::string>{});
  const Json full = C3DE_WAIT(window, "all are listed", !recent(s, 11).empty());
  CHECK(recent(full, 0) == "start_mesh_0.obj");
  CHECK(full["scrolled_out"].contains("start/recent.11"));
  window.screenshotAtRest("full");
  for (int i = 0; i < 4; ++i) window.key("Down");
  C3DE_WAIT(window, "the last row is in view", s["widgets"].contains("start/recent.8"));
  window.screenshotAtRest("scrolled");

  window.clickMenu("file.open_folder");
  C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("dialog/path"));
  window.type(series.string());
  window.click("dialog/use_folder");
  C3DE_WAIT(window, "the series is open", s["panes"].size() == 4 && s["jobs"].empty());
  window.clickMenu("file.close_image");
  const Json listed = C3DE_WAIT(window, "it is listed", recent(s, 0, "state") == "with picture");
  CHECK(recent(listed, 0) == "start_series");
  CHECK(recent(listed, 0, "kind") == "DICOM folder");
  CHECK(recent(listed, 11) == "start_mesh_10.obj");
  CHECK(recent(listed, 12).empty());
  window.click("start/recent.0");
  C3DE_WAIT(window, "it is open again", s["panes"].size() == 4 && s["jobs"].empty());
  quit(window);
}
