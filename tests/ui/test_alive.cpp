// SPDX-License-Identifier: Apache-2.0
// From a scan and its labels to one body of all that they show, by mouse.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "c3de/imaging/writing.h"
#include "support/catch.h"
#include "ui/workstation_driver.h"

using namespace c3de;
using c3de::test::Json;
using c3de::test::Point;
using c3de::test::WorkstationDriver;
using Catch::Matchers::Contains;

namespace {

namespace fs = std::filesystem;

#define C3DE_ALIVE_OR_SKIP()                                                                             \
  if (const std::string reason = WorkstationDriver::whyNot(); !reason.empty()) C3DE_SKIP(reason);        \
  if (!fs::exists(fs::path(testPluginFolder()) / (std::string("pointbased") + c3de::pluginExtension()))) \
  C3DE_SKIP("the point-based plugin is not built")

struct Files {
  fs::path image, labels;
};

/// A trunk of 64 x 48 x 24 voxels of 4 x 4 x 5 mm, LPS: an ellipse of fat with three labels in it, on a table apart.
Files writeScan(const std::string &name, const std::array<std::string, 3> &names) {
  const std::array<std::size_t, 3> n{64, 48, 24};
  const imaging::VolumeGeometry geometry{n, {4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 5, 0, -126, -94, -57.5, 1}};
  std::vector<std::int16_t> image;
  std::vector<std::uint16_t> labels;
  for (int k = 0; k < 24; ++k)
    for (int j = 0; j < 48; ++j)
      for (int i = 0; i < 64; ++i) {
        const double x = 4.0 * i - 126, y = 4.0 * j - 94, z = 5.0 * k - 57.5;
        const auto within = [&](double cx, double cy, double cz, double rx, double ry, double rz) {
          const double u = (x - cx) / rx, v = (y - cy) / ry, w = (z - cz) / rz;
          return u * u + v * v + w * w <= 1.0;
        };
        const bool isBody = within(0, 0, 0, 110, 70, 1e9) && std::abs(z) < 50;
        const bool isTable = y > 82 && y < 90 && std::abs(z) < 50;
        const bool isLiver = within(-45, -10, 0, 48, 40, 38);
        const bool isKidney = within(50, 22, 0, 22, 22, 36);
        const bool isBone = within(0, 40, 0, 18, 18, 1e9) && isBody;
        // Stripes, so that it is seen how the tissue moves.
        const int stripe = (i / 3 + j / 3) % 2 == 0 ? 20 : -20;
        image.push_back(static_cast<std::int16_t>(isBone     ? 500
                                                  : isLiver  ? 100 + stripe
                                                  : isKidney ? 160 + stripe
                                                  : isBody   ? -90 + stripe
                                                  : isTable  ? 30
                                                             : -1000));
        labels.push_back(isBone ? 3 : isLiver ? 1 : isKidney ? 2 : 0);
      }
  const fs::path folder = fs::path(testOutputRoot()) / "ui";
  fs::create_directories(folder);
  const Files files{folder / (name + ".nii.gz"), folder / (name + "_labels.nrrd")};
  imaging::Volume volume;
  volume.geometry = geometry;
  volume.voxels = std::move(image);
  volume.unit = "HU";
  if (const auto written = imaging::writeVolume(files.image, volume); !written) FAIL(written.error().message);
  const imaging::LabelMap map{
      geometry,
      std::move(labels),
      {{1, names[0], {0.6f, 0.2f, 0.1f}}, {2, names[1], {0.2f, 0.5f, 0.8f}}, {3, names[2], {0.9f, 0.9f, 0.6f}}}};
  if (const auto written = imaging::writeLabelMap(files.labels, map); !written) FAIL(written.error().message);
  return files;
}

std::string value(const Json &state, const std::string &key) { return state["values"].value(key, ""); }

bool isOver(const Json &state, const std::string &pane, double millimetres) {
  const std::string readout = value(state, "image/" + pane + ".readout");
  const std::size_t at = readout.find("|u| ");
  return at != std::string::npos && std::strtod(readout.c_str() + at + 4, nullptr) > millimetres;
}

/// A place of the axial view, mm from its middle: to the right, and down.
Point inAxial(const WorkstationDriver &window, double right_mm, double down_mm) {
  const Json state = window.state(), r = state["panes"]["axial"];
  const double scale = std::strtod(value(state, "image/axial.scale_mm_per_px").c_str(), nullptr);
  return {r["x"].get<double>() + 0.5 * r["w"].get<double>() + right_mm / scale,
          r["y"].get<double>() + 0.5 * r["h"].get<double>() + down_mm / scale};
}

void openDialog(WorkstationDriver &window, const Files &files) {
  window.start({files.image.string(), files.labels.string()});
  window.waitUntil(
      "image and labels are there",
      [](const Json &s) {
        return s["panes"].size() == 4 && s["jobs"].empty() && s["widgets"].contains("segmentation/make_alive");
      },
      60.0);
  window.click("menu/file");
  window.click("menu/file.make_alive");
  window.waitUntil("the labels are measured", [](const Json &s) {
    return s["widgets"].contains("scan/make") && value(s, "scan/reason").find("measured") == std::string::npos;
  });
}

void choose(WorkstationDriver &window, const std::string &label, const std::string &what) {
  window.click("scan/use." + label);
  window.click("scan/use." + label + ".option." + what);
  window.waitForValue("scan/use." + label, what);
}

void typeInto(WorkstationDriver &window, const std::string &field, const std::string &text) {
  window.click("scan/" + field);
  window.key("ctrl+a");
  if (text.empty())
    window.key("BackSpace");
  else
    window.type(text);
}

}  // namespace

TEST_CASE("A scan becomes one body of all its labels, and is pulled where a slice shows it", "[scan_alive]") {
  C3DE_ALIVE_OR_SKIP();
  WorkstationDriver window("scan_alive");
  openDialog(window, writeScan("scan_alive", {"liver", "kidney_left", "vertebrae_L1"}));
  CHECK(window.value("scan/liver.known") == "liver");
  CHECK(window.value("scan/use.kidney_left") == "kidney_cortex");
  CHECK(window.value("scan/use.vertebrae_L1") == "rigid");
  CHECK_THAT(window.value("scan/liver.stiffness"), Contains("kPa"));
  // An ellipsoid of half axes 48, 40 and 38 mm has 305.6 ml.
  CHECK(std::abs(std::strtod(window.value("scan/liver.volume").c_str(), nullptr) - 305.6) < 10.0);
  CHECK(window.value("scan/from") == "-150");
  CHECK(window.value("scan/background.material") == "fat");
  window.screenshotAtRest("dialog");

  typeInto(window, "filter", "kidney");
  window.waitUntil("one label is listed",
                   [](const Json &s) { return value(s, "scan/count").find("1 of 3 labels") == 0; });
  CHECK_FALSE(window.has("scan/use.liver"));
  choose(window, "kidney_left", "spleen");
  typeInto(window, "filter", "");
  window.waitUntil("all are listed", [](const Json &s) { return value(s, "scan/count").find("3 of 3") == 0; });
  typeInto(window, "points", "800");
  window.key("Tab");
  window.waitForValue("scan/points", "800");
  window.screenshot("chosen");
  window.click("scan/make");
  const Json alive = window.waitUntil(
      "the body is there and plays",
      [](const Json &s) {
        return s["jobs"].empty() && s["transport"]["mode"] == "playing" && s["transport"]["steps"].get<int>() > 3 &&
               std::strtod(value(s, "image/axial.outlines").c_str(), nullptr) > 0;
      },
      120.0);
  CHECK_FALSE(alive["widgets"].contains("scan/make"));
  CHECK(alive["panes"].size() == 4);
  bool isTold = false;
  for (const Json &n : alive["notifications"]) {
    INFO(n.dump());
    CHECK(n["severity"] == "info");
    isTold = isTold || n["title"] == "The scan is alive";
  }
  CHECK(isTold);
  window.screenshot("alive");

  window.moveTo(window.inView(0.5, 0.5));
  window.key("p");
  window.waitUntil("the pinch is active", [](const Json &s) { return s["tool"] == "pointbased.pinch"; });
  const Point from = inAxial(window, -60, -20), to = inAxial(window, -85, -50);
  window.moveTo(from);
  // It is in balance: nothing has moved by itself.
  const Json resting = window.waitUntil("the read-out is there", [](const Json &s) { return isOver(s, "axial", -1); });
  CHECK_FALSE(isOver(resting, "axial", 0.2));
  window.press();
  for (int step = 1; step <= 8; ++step)
    window.moveTo({from.x + step / 8.0 * (to.x - from.x), from.y + step / 8.0 * (to.y - from.y)});
  window.waitUntil(
      "the scan follows", [](const Json &s) { return isOver(s, "axial", 4.0); }, 90.0);
  window.waitFrames(20);
  window.screenshot("pulled");
  CHECK(window.differingPixels("alive", "pulled", "axial") > 200);
  window.release();
}

TEST_CASE("A scan that cannot become a body says why, and what is there stays", "[scan_not_alive]") {
  C3DE_ALIVE_OR_SKIP();
  WorkstationDriver window("scan_not_alive");
  openDialog(window, writeScan("scan_not_alive", {"gizmo", "thing", "something"}));
  CHECK(window.value("scan/gizmo.known") == "not known");
  CHECK_THAT(window.value("scan/count"), Contains("3 not known"));
  CHECK_THAT(window.value("scan/reason"), Contains("no label is known by its name"));
  window.click("scan/background");
  window.waitForValue("scan/use.gizmo", "left out");
  const Json state = window.state();
  CHECK(std::find(state["disabled"].begin(), state["disabled"].end(), "scan/make") != state["disabled"].end());
  window.screenshotAtRest("unknown");
  choose(window, "gizmo", "rigid");
  window.waitUntil("nothing could move", [](const Json &s) {
    return value(s, "scan/reason").find("nothing could move: all labels are rigid") == 0;
  });
  choose(window, "gizmo", "liver");
  typeInto(window, "points", "300");
  window.key("Tab");
  window.click("scan/make");
  window.waitUntil(
      "the body is there", [](const Json &s) { return s["jobs"].empty() && s["transport"]["mode"] == "playing"; },
      120.0);

  // A region that holds nothing of it is refused by the loader: in the dialog, and the body stays.
  window.click("segmentation/make_alive");
  window.waitUntil("it is asked again", [](const Json &s) { return s["widgets"].contains("scan/make"); });
  CHECK(window.value("scan/use.gizmo") == "liver");
  window.click("scan/region");
  window.waitForValue("scan/region", "true");
  typeInto(window, "region.x.from", "110");
  window.key("Tab");
  window.waitForValue("scan/region.x.from", "110");
  window.click("scan/make");
  const Json refused = window.waitUntil(
      "it is refused",
      [](const Json &s) {
        return s["widgets"].contains("scan/make") &&
               value(s, "scan/problem").find("nothing is left of what was asked for") != std::string::npos;
      },
      60.0);
  window.screenshotAtRest("refused");
  CHECK(refused["transport"]["exists"] == true);
  CHECK(refused["transport"]["mode"] == "playing");
  CHECK(refused["panes"].size() == 4);
  window.click("dialog/close");
  window.waitUntil("it is closed", [](const Json &s) { return !s["widgets"].contains("scan/make"); });
}

TEST_CASE("Pictures of a scan that was made alive for the user guide", "[.guide]") {
  C3DE_ALIVE_OR_SKIP();
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  C3DE_DATA_OR_SKIP(labels, "volume/totalseg/example_seg_fast_force_split.nii.gz");
  WorkstationDriver window("guide");
  openDialog(window, {image, labels});
  choose(window, "spleen", "liver");
  window.screenshotAtRest("alive_dialog");
  choose(window, "spleen", "spleen");
  window.click("scan/make");
  window.waitUntil(
      "it plays",
      [](const Json &s) {
        return s["jobs"].empty() && s["transport"]["mode"] == "playing" && s["transport"]["steps"].get<int>() > 3 &&
               std::strtod(value(s, "image/axial.outlines").c_str(), nullptr) > 0;
      },
      300.0);
  window.moveTo(window.inView(0.5, 0.5));
  window.key("p");
  const Point from = inAxial(window, -60, -20), to = inAxial(window, -100, -60);
  window.moveTo(from);
  window.press();
  for (int step = 1; step <= 8; ++step)
    window.moveTo({from.x + step / 8.0 * (to.x - from.x), from.y + step / 8.0 * (to.y - from.y)});
  window.waitUntil(
      "the scan follows", [](const Json &s) { return isOver(s, "axial", 5.0); }, 90.0);
  window.waitFrames(20);
  window.screenshot("alive");
  window.release();
}
