// SPDX-License-Identifier: Apache-2.0
// Figures for papers, and the sizes of screenshots.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "c3de/render/png_file.h"
#include "support/catch.h"
#include "support/environment.h"
#include "support/png_resolution.h"
#include "ui/image_window.h"
#include "ui/program_command.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

PngSize sizeOf(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  const auto size = pngSize(bytes.str());
  REQUIRE(size.has_value());
  return *size;
}

/// An organ with a landmark and an instrument that pushes it, whose force is a part of captions.
fs::path pushedOrgan(const std::string &scenario) {
  fs::path scene = outputFile(scenario + ".toml");
  std::ofstream(scene)
      << "format = 1\ntitle = \"Organ for a figure\"\n[world]\ngravity = [0.0, 0.0, 0.0]\n[solver]\ndamping = 5.0\n"
         "[[body]]\nname = \"organ\"\nmesh = \""
      << organMesh().generic_string() << "\"\nmesh_unit = \"mm\"\n"
      << "material = { law = \"neo_hookean\", youngs_modulus = 6e3, poisson_ratio = 0.4, density = 1000.0 }\n"
      << "sampling = { count = 400 }\n"
         "[[landmark]]\nname = \"tip\"\nat = [0.0, 0.0, 0.0]\n"
         "[[probe_tool]]\nname = \"finger\"\nradius_mm = 6\npath = [ { time = 0.0, at = [0, 0.2, 0] }, { time = 1.0, "
         "at = [0, 0.19, 0] } ]\n";
  return scene;
}

void enterField(WorkstationDriver &window, const std::string &field, const std::string &text) {
  window.click(field);
  window.key("ctrl+a");
  window.type(text);
  window.key("Tab");
}

/// By its command, with the values of the dialog; returns the file.
fs::path savedFigure(WorkstationDriver &window, const std::string &name) {
  const fs::path file = freshFile(name);
  window.click("figure/save");
  window.enterFile(file);
  C3DE_WAIT(window, "the figure is saved", s["notifications"].dump().find(name + "\\n") != std::string::npos);
  return file;
}

/// The number of points in "47.8 mm; 13 points; shown"; 0: it is not there.
int numberAfterFirst(const std::string &text) {
  const std::size_t at = text.find("; ");
  return at == std::string::npos ? 0 : std::stoi(text.substr(at + 2));
}

/// Fraction of the picture whose colour is nearly this grey.
double shareOfGrey(const render::Image &image, int grey, int within) {
  std::size_t count = 0;
  for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
    bool isNear = true;
    for (std::size_t c = 0; c < 3; ++c) isNear = isNear && std::abs(image.rgb[i + c] - grey) <= within;
    count += isNear ? 1 : 0;
  }
  return 3.0 * static_cast<double>(count) / static_cast<double>(image.rgb.size());
}

}  // namespace

TEST_CASE("a figure has its size on paper, states its resolution, and shows a light 3D view and slices", "[figure]") {
  C3DE_ORGAN_OR_SKIP();
  // Settings of its own: other scenarios run at the same time.
  const fs::path home = outputFile("figure_home");
  fs::remove_all(home);
  const ScopedEnvironment user("C3DE_HOME", home.string());
  WorkstationDriver window("figure");
  startOn(window, {imageFile("figure").string(), pushedOrgan("figure").string()});
  C3DE_WAIT(window, "the organ is cut", imageNumber(s, "axial.outlines") >= 1);
  window.choose(kPanel + "view.colour", "von_mises");
  window.moveTo(window.inPane("3D", 0.5, 0.5));
  window.key("f");
  window.key("shift+F12");
  C3DE_WAIT(window, "the dialog is shown", s["widgets"].contains("figure/save"));
  enterField(window, "figure/width", "120");
  enterField(window, "figure/dpi", "300");
  window.choose("figure/shape", "4_3");
  // 120 mm = 4.7244 inches
  window.waitForValue("figure/size", "1417 × 1063 pixels, 120 × 90 mm");
  window.screenshotAtRest("dialog");
  const fs::path file = savedFigure(window, "figure-four.png");
  const PngSize size = sizeOf(file);
  CHECK(size.width == 1417);
  CHECK(size.height == 1063);
  CHECK(size.perMetreX == 11811);
  CHECK(size.perMetreY == 11811);
  CHECK(size.unit == 1);
  const auto four = render::readPng(file);
  REQUIRE(four.has_value());
  // The background of the 3D view is white, what is beside the image in slices is black.
  CHECK(shareOfGrey(*four, 255, 0) > 0.1);
  CHECK(shareOfGrey(*four, 0, 2) > 0.1);

  // A single view, larger than the screen, with a dark background.
  window.key("shift+F12");
  C3DE_WAIT(window, "the dialog has the last values", textOf(s, "figure/width") == "120");
  window.choose("figure/views", "3d");
  window.choose("figure/background", "dark");
  enterField(window, "figure/dpi", "900");
  window.waitForValue("figure/size", "4252 × 3189 pixels, 120 × 90 mm");
  const fs::path large = savedFigure(window, "figure-space.png");
  CHECK(sizeOf(large).width == 4252);
  CHECK(sizeOf(large).perMetreX == 35433);  // 900 / 0.0254 m
  CHECK(sizeOf(large).height == 3189);

  // What cannot be drawn is refused, with the limit.
  window.key("shift+F12");
  C3DE_WAIT(window, "the dialog is shown", s["widgets"].contains("figure/save"));
  enterField(window, "figure/width", "2000");
  enterField(window, "figure/dpi", "2400");
  const Json refused = C3DE_WAIT(window, "the size is refused",
                                 textOf(s, "figure/size").find("the limit of the graphics") != std::string::npos);
  CHECK(refused["disabled"].dump().find("figure/save") != std::string::npos);
  enterField(window, "figure/width", "1");
  window.waitForValue("figure/size", "Width: 1 mm; accepted: 10 to 2000 mm");
  window.click("dialog/close");
  C3DE_WAIT(window, "the dialog is closed", !s["widgets"].contains("figure/save"));
  // The window shows what it did before.
  CHECK(window.value("image/layout") == "four");
}

TEST_CASE("screenshots have the size of the menu, also after a restart", "[screenshot_size]") {
  C3DE_ORGAN_OR_SKIP();
  // Files remain until the end, so that each has another name.
  std::vector<fs::path> files;
  const auto shoot = [&files](WorkstationDriver &window) {
    window.key("F12");
    const auto newFile = [&files](const Json &state) {
      for (const Json &message : state["notifications"]) {
        if (message["title"] != "Screenshot saved") continue;
        const std::string text = message["text"].get<std::string>();
        const fs::path file = fileOfProgram(text.substr(0, text.find('\n')));
        if (std::find(files.begin(), files.end(), file) == files.end()) return file;
      }
      return fs::path();
    };
    files.push_back(newFile(C3DE_WAIT(window, "it says where", !newFile(s).empty())));
    return sizeOf(files.back());
  };
  // Settings of its own: other scenarios run at the same time.
  const fs::path home = outputFile("screenshot_size_home");
  fs::remove_all(home);
  const ScopedEnvironment user("C3DE_HOME", home.string());
  WorkstationDriver window("screenshot_size");
  openOrgan(window, {pushedOrgan("screenshot_size").string()});
  const auto chooseSize = [&](const std::string &id) {
    window.click("menu/file");
    window.click("menu/file.screenshot_size");
    window.click("menu/file.screenshot_size." + id);
    C3DE_WAIT(window, "the menu is closed", !s["widgets"].contains("menu/file.screenshot_size"));
  };
  const PngSize view = shoot(window);
  const Json shown = window.state()["view"];
  CHECK(view.width == shown["w"].get<std::uint32_t>());
  CHECK(view.height == shown["h"].get<std::uint32_t>());
  chooseSize("ultra_hd");
  CHECK(shoot(window).width == 3840);
  chooseSize("full_hd");
  const PngSize fullHd = shoot(window);
  CHECK(fullHd.width == 1920);
  CHECK(fullHd.height == 1080);
  chooseSize("figure");
  CHECK(shoot(window).perMetreX == 11811);
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);

  WorkstationDriver again("screenshot_size_again");
  openOrgan(again, {pushedOrgan("screenshot_size_again").string()});
  CHECK(shoot(again).perMetreX == 11811);
  for (const fs::path &file : files) fs::remove(file);
}

TEST_CASE("curves over time are gathered in the strip, chosen, read under the mouse and saved", "[plots]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path home = outputFile("plots_home");
  fs::remove_all(home);
  const ScopedEnvironment user("C3DE_HOME", home.string());
  WorkstationDriver window("plots");
  openOrgan(window, {(fs::path(testResourcesFolder()) / "scenes" / "first_light.toml").string()});
  const double before = window.state()["area"]["h"];
  window.key("ctrl+t");
  C3DE_WAIT(window, "the strip is shown", textOf(s, "plots/shown") == "true" && s["area"]["h"].get<double>() < before);
  const std::string probe = "plots/probe.rim.displacement", kinetic = "plots/body.organ.energy.kinetic";
  window.key("space");
  const auto points = [&](const Json &s) { return numberAfterFirst(textOf(s, probe)); };
  C3DE_WAIT(window, "the probe falls", points(s) > 12 && s["transport"]["time_s"].get<double>() > 0.3);
  window.key("space");
  C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  CHECK(window.value(probe).find("mm; ") != std::string::npos);
  CHECK(window.value(kinetic).find("shown") != std::string::npos);
  CHECK(window.value("plots/cost").find("hidden") != std::string::npos);
  const Json list = window.state()["widgets"]["plots/show.body.organ.energy.kinetic"];
  window.moveTo({list[0].get<double>() + 5.0, list[1].get<double>() + 5.0});
  for (int tries = 0; tries < 40 && !window.has("plots/show.cost"); ++tries) {
    window.wheel(-1);
    window.waitFrames(3);
  }
  window.click("plots/show.cost");
  C3DE_WAIT(window, "the cost is shown", textOf(s, "plots/cost").find("shown") != std::string::npos);
  for (int tries = 0; tries < 40 && !window.has("plots/show.body.organ.energy.kinetic"); ++tries) {
    window.wheel(1);
    window.waitFrames(3);
  }
  window.click("plots/show.body.organ.energy.kinetic");
  C3DE_WAIT(window, "the energy is hidden", textOf(s, kinetic).find("hidden") != std::string::npos);

  // Over the middle of the curves.
  const Json area = window.state()["area"];
  const double left = area["x"].get<double>() + 300.0, right = area["x"].get<double>() + area["w"].get<double>();
  window.moveTo({0.5 * (left + right), area["y"].get<double>() + area["h"].get<double>() + 80.0});
  C3DE_WAIT(window, "values are shown with units",
            textOf(s, "plots/hover").find("rim: displacement: ") != std::string::npos &&
                textOf(s, "plots/hover").find(" mm") != std::string::npos);
  window.screenshotAtRest("hover");

  const fs::path table = freshFile("plots.csv"), picture = freshFile("plots.png");
  window.click("plots/csv");
  window.enterFile(table);
  C3DE_WAIT(window, "the table is saved", fs::exists(table));
  std::ifstream in(table);
  std::string header, row, last;
  std::getline(in, header);
  CHECK(header.find("time [s]") == 0);
  CHECK(header.find("rim: displacement [mm]") != std::string::npos);
  CHECK(header.find("kinetic") == std::string::npos);
  double before_s = -1.0;
  int rows = 0;
  while (std::getline(in, row)) {
    const double time_s = std::stod(row);
    REQUIRE(time_s > before_s);
    before_s = time_s;
    ++rows;
  }
  CHECK(rows > 12);
  window.click("plots/png");
  window.enterFile(picture);
  C3DE_WAIT(window, "the picture is saved", s["notifications"].dump().find("plots.png\\n") != std::string::npos);
  CHECK(sizeOf(picture).width == 2008);  // 170 mm at 300 dpi
  CHECK(sizeOf(picture).height == 1004);

  // A reset begins the curves again.
  window.key("ctrl+r");
  C3DE_WAIT(window, "the curves begin again", points(s) <= 2);
  window.key("ctrl+t");
  C3DE_WAIT(window, "the strip is hidden",
            textOf(s, "plots/shown") != "true" && s["area"]["h"].get<double>() == before);
}
