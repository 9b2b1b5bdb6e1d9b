// SPDX-License-Identifier: Apache-2.0
// From an image to an organ by the panel: threshold, a click on the component, filled holes, material, the button.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>

#include "c3de/imaging/reading.h"
#include "c3de/imaging/writing.h"
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

constexpr double kSpacing_mm = 2.0;
constexpr Vec3 kOrgan{-15, 0, 0}, kRadii{30, 26, 22}, kOther{42, 0, 0};

/// 70 x 50 x 40 voxels around the origin. An ellipsoid of value 100 with a cavity of 8 mm, and a separate ball of 14
/// mm.
struct Phantom {
  imaging::Volume volume;
  std::size_t organ = 0, cavity = 0, other = 0;  ///< voxels

  Phantom() {
    constexpr std::array<std::size_t, 3> n{70, 50, 40};
    volume.geometry = {n, {kSpacing_mm, 0, 0, 0, 0, kSpacing_mm, 0, 0, 0, 0, kSpacing_mm, 0, -69, -49, -39, 1}};
    std::vector<std::int16_t> voxels;
    for (std::size_t k = 0; k < n[2]; ++k)
      for (std::size_t j = 0; j < n[1]; ++j)
        for (std::size_t i = 0; i < n[0]; ++i) {
          const Vec3 x = volume.geometry.worldAt({double(i), double(j), double(k)}), r = x - kOrgan;
          const bool isCavity = norm(r) < 8.0, isOther = norm(x - kOther) < 14.0;
          const bool isOrgan = !isCavity && norm({r[0] / kRadii[0], r[1] / kRadii[1], r[2] / kRadii[2]}) < 1.0;
          organ += isOrgan;
          cavity += isCavity;
          other += isOther;
          voxels.push_back(isOrgan || isOther ? 100 : 0);
        }
    volume.voxels = voxels;
  }
};

std::string pickedText(std::size_t voxels) {
  return fmt::format("{:.1f} ml, {} voxels",
                     static_cast<double>(voxels) * kSpacing_mm * kSpacing_mm * kSpacing_mm / 1000.0, voxels);
}

bool hasNode(const Json &state, const std::string &name) {
  return std::any_of(state["nodes"].begin(), state["nodes"].end(),
                     [&](const Json &node) { return node["name"] == name; });
}

/// In the axial view of an image along the axes, not zoomed.
Point axialPixel(const WorkstationDriver &window, const Vec3 &world) {
  return window.inSlice("axial", world[0], world[1]);
}

}  // namespace

TEST_CASE("an organ is picked by threshold, click and filled holes, and becomes a body", "[image_guide]") {
  C3DE_WINDOW_OR_SKIP();
  const Phantom phantom;
  const fs::path file = outputFile("image_guide_phantom.nii.gz");
  if (const auto written = imaging::writeVolume(file, phantom.volume); !written) FAIL(written.error().message);
  const fs::path home = freshHome("image_guide_home");
  const ScopedEnvironment user("C3DE_HOME", home.string());
  WorkstationDriver window("image_guide");
  window.start({file.string()});
  C3DE_WAIT(window, "the image is shown", s["panes"].size() == 4 && s["jobs"].empty());
  CHECK(window.value("image/preview") == "none");
  window.screenshot("before");

  window.enterNumber("segmentation/low", "60");
  window.waitForValue("segmentation/Picked", pickedText(phantom.organ + phantom.other));
  CHECK(window.value("image/preview") == "shown");
  CHECK(window.value("segmentation/Values") == "100 ± 0, 100 … 100");
  // The threshold divides an interval of the histogram that is empty.
  CHECK(window.value("segmentation/Between") ==
        fmt::format("about {:.3g} % of the voxels",
                    100.0 * double(phantom.organ + phantom.other) / (70.0 * 50.0 * 40.0)));
  window.moveTo(axialPixel(window, {0, -45, 0}));
  window.screenshot("threshold");
  CHECK(window.differsFrom("before", "threshold", 500));

  window.click("segmentation/component");
  C3DE_WAIT(window, "a click is waited for", textOf(s, "image/picking") == "on");
  window.clickAt(axialPixel(window, {0, -40, 0}));
  C3DE_WAIT(window, "a click beside it is told",
            textOf(s, "segmentation/Problem").find("outside of the mask") != std::string::npos);
  CHECK(window.value("segmentation/Picked") == pickedText(phantom.organ + phantom.other));
  const std::string cross = window.value("image/cross_hair");
  window.click("segmentation/component");
  C3DE_WAIT(window, "a click is waited for again", textOf(s, "image/picking") == "on");
  window.screenshot("picking");
  window.clickAt(axialPixel(window, {-35, 0, 0}));
  window.waitForValue("segmentation/Picked", pickedText(phantom.organ));
  CHECK(window.value("image/cross_hair") == cross);
  CHECK(window.value("image/picking") == "off");

  window.click("segmentation/fill_holes");
  window.waitForValue("segmentation/Picked", pickedText(phantom.organ + phantom.cavity));
  window.click("segmentation/undo");
  window.waitForValue("segmentation/Picked", pickedText(phantom.organ));
  window.click("segmentation/fill_holes");
  window.waitForValue("segmentation/Picked", pickedText(phantom.organ + phantom.cavity));

  CHECK(window.value("segmentation/material") == "– choose –");
  window.click("segmentation/name");
  window.key("ctrl+a");
  window.type("liver");
  window.key("Return");
  window.waitForValue("segmentation/material", "liver");
  CHECK_THAT(window.value("segmentation/Young's modulus"), Contains("6 kPa (1 kPa … 15 kPa)"));
  window.screenshot("material");
  window.waitUntil("the mask is autosaved", [&](const Json &) { return !recoveryIn(home).empty(); });
  window.click("segmentation/create");
  C3DE_WAIT(window, "the body is created",
            s["jobs"].empty() && s["transport"]["exists"] == true && s["transport"]["mode"] == "playing" &&
                s["transport"]["time_s"] > 0.0);
  const Json state = window.state();
  CHECK(std::any_of(state["nodes"].begin(), state["nodes"].end(),
                    [](const Json &node) { return node["name"] == "liver"; }));
  // The body continues the session of the mask, and nothing is reported as lost.
  REQUIRE(state["notifications"].size() == 1);
  CHECK(state["notifications"][0]["title"] == "Body created: liver");
  window.moveTo(axialPixel(window, {0, -45, 0}));
  window.screenshot("made");

  // Undo removes the body and picks the structure again; redo returns the body with its state.
  window.key("space");
  const Json paused = C3DE_WAIT(window, "it pauses", s["transport"]["mode"] == "paused");
  window.key("ctrl+z");
  C3DE_WAIT(window, "the body is removed", s["transport"]["exists"] == false && s["jobs"].empty());
  window.waitForValue("segmentation/Picked", pickedText(phantom.organ + phantom.cavity));
  window.screenshot("undone");
  window.key("ctrl+y");
  const Json again = C3DE_WAIT(window, "the body is there again",
                               s["jobs"].empty() && s["transport"]["steps"] == paused["transport"]["steps"]);
  CHECK(hasNode(again, "liver"));
  window.screenshot("redone");

  // Requests right after each other wait for each other.
  window.keys({"ctrl+z", "ctrl+y", "ctrl+z"});
  C3DE_WAIT(window, "the body is removed", s["transport"]["exists"] == false && s["jobs"].empty());
  window.key("ctrl+y");
  C3DE_WAIT(window, "the body is there once more",
            s["jobs"].empty() && s["transport"]["steps"] == paused["transport"]["steps"]);
  // Another scene ends these steps.
  window.key("ctrl+o");
  window.enterFile(floatingOrgan());
  C3DE_WAIT(window, "another scene is open", s["jobs"].empty() && hasNode(s, "organ"));
  window.key("ctrl+z");
  window.waitFrames(5);
  const Json other = C3DE_WAIT(window, "nothing is being done", s["jobs"].empty());
  CHECK(hasNode(other, "organ"));
  CHECK_FALSE(hasNode(other, "liver"));
}

namespace {

/// 60 x 60 x 60 voxels of 8 mm: two kidneys of 24 mm radius, a trunk of 0.4 m, and single voxels with names.
imaging::LabelMap manyLabels() {
  constexpr std::size_t n = 60;
  imaging::LabelMap map;
  map.geometry = {{n, n, n}, {8, 0, 0, 0, 0, 8, 0, 0, 0, 0, 8, 0, -236, -236, -236, 1}};
  map.voxels.assign(n * n * n, 0);
  map.labels = {{2, "kidney_right", {0.2f, 0.2f, 1.0f}},
                {3, "kidney_left", {1.0f, 1.0f, 0.2f}},
                {4, "muscle_trunk", {0.8f, 0.3f, 0.3f}}};
  const auto at = [&](std::size_t i, std::size_t j, std::size_t k) -> std::uint16_t & {
    return map.voxels[i + n * (j + n * k)];
  };
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) {
        if (i >= 8 && j >= 8 && k >= 8 && i < 58 && j < 58 && k < 58) at(i, j, k) = 4;
        for (const auto &[label, middle] :
             {std::pair{std::uint16_t{2}, Vec3{3.5, 3.5, 10}}, {std::uint16_t{3}, Vec3{3.5, 3.5, 50}}})
          if (norm(Vec3{double(i), double(j), double(k)} - middle) < 3.0) at(i, j, k) = label;
      }
  for (std::uint16_t v = 20; v < 32; ++v) {
    map.labels.push_back({v, "vertebra_" + std::to_string(v), {0.5f, 0.5f, 0.5f}});
    at(59, 59, v) = v;
  }
  return map;
}

}  // namespace

TEST_CASE("several labels become bodies at once, one that fails is named, and steps are undone by keys",
          "[image_organs]") {
  C3DE_WINDOW_OR_SKIP();
  const fs::path folder = fs::path(testOutputRoot()) / "ui";
  fs::create_directories(folder);
  const fs::path image = folder / "image_organs.nii.gz", many = folder / "image_organs_many.nrrd",
                 other = folder / "image_organs_other.nrrd";
  const imaging::LabelMap map = manyLabels();
  imaging::Volume volume;
  volume.geometry = map.geometry;
  volume.voxels = std::vector<std::int16_t>(map.voxels.begin(), map.voxels.end());
  imaging::LabelMap few = map;
  std::replace_if(
      few.voxels.begin(), few.voxels.end(), [](std::uint16_t v) { return v != 4; }, std::uint16_t{0});
  few.labels = {{4, "block", {0.0f, 1.0f, 0.0f}}};
  REQUIRE(imaging::writeVolume(image, volume));
  REQUIRE(imaging::writeLabelMap(many, map));
  REQUIRE(imaging::writeLabelMap(other, few));

  WorkstationDriver window("image_organs");
  window.start({image.string(), many.string(), other.string()});
  C3DE_WAIT(window, "both label maps are open",
            s["jobs"].empty() && textOf(s, "image/label_map") == "image_organs_other.nrrd");
  CHECK(window.has("segmentation/label.4"));
  CHECK_FALSE(window.has("segmentation/label_filter"));
  window.choose("image/label_map", "image_organs_many.nrrd");
  window.waitForValue("image/label_map", "image_organs_many.nrrd");

  window.click("segmentation/label_filter");
  window.type("kidney");
  window.click("segmentation/tick_listed");
  C3DE_WAIT(window, "both are picked", textOf(s, "segmentation/Picked").starts_with("2 labels"));
  CHECK(window.value("segmentation/material.2") == "kidney_cortex");
  CHECK(window.value("segmentation/Young's modulus") == "5 kPa (2 kPa … 15 kPa)");
  CHECK_THAT(window.value("segmentation/Source"), Contains("PMID"));
  window.click("segmentation/label_filter");
  window.key("ctrl+a");
  window.type("trunk");
  window.click("segmentation/label.4");
  C3DE_WAIT(window, "three are picked", textOf(s, "segmentation/Picked").starts_with("3 labels"));
  window.moveTo(axialPixel(window, {0, -45, 0}));
  window.screenshot("picked");
  window.key("ctrl+z");
  C3DE_WAIT(window, "the last is taken back", textOf(s, "segmentation/Picked").starts_with("2 labels"));
  window.key("ctrl+shift+z");
  C3DE_WAIT(window, "it is there again", textOf(s, "segmentation/Picked").starts_with("3 labels"));

  // Edges of half a millimetre are too many for the trunk alone.
  window.click("segmentation/edge_automatic");
  window.enterNumber("segmentation/edge", "0.5");
  window.click("segmentation/create");
  const Json made = C3DE_WAIT(window, "the kidneys are created",
                              s["jobs"].empty() && s["transport"]["exists"] == true && s["transport"]["time_s"] > 0.0 &&
                                  hasNode(s, "kidney_left"));
  CHECK(hasNode(made, "kidney_right"));
  CHECK_FALSE(hasNode(made, "muscle_trunk"));
  CHECK_FALSE(notification(made, "Bodies created: kidney_right and kidney_left").is_null());
  const Json refused = notification(made, "muscle_trunk could not be created");
  REQUIRE_FALSE(refused.is_null());
  CHECK(refused["severity"] == "error");
  CHECK_THAT(refused["text"].get<std::string>(), Contains("edge length of 0.5 mm") && Contains("It stays picked"));
  C3DE_WAIT(window, "it is what is picked", textOf(s, "segmentation/Picked").ends_with(" 125000 voxels"));
  // Bodies have the colours of their labels: both are blue ones.
  window.screenshot("kidneys");
  CHECK(window.shareOfColour("kidneys", "b > 1.5*r && b > 0.25") > 0.002);
  // Outlines have replaced the labels.
  CHECK(window.value("image/label.2") == "false");
  CHECK(window.value("image/label.3") == "false");
  CHECK(window.value("image/label.4") == "true");

  window.click("segmentation/edge_automatic");
  // A custom count replaces that by the thickness.
  CHECK_FALSE(window.has("segmentation/points"));
  window.click("segmentation/count_automatic");
  window.enterNumber("segmentation/points", "400");
  window.waitForValue("segmentation/points", "400");
  window.screenshot("own_count");
  window.click("segmentation/create");
  C3DE_WAIT(window, "the trunk has joined them",
            s["jobs"].empty() && hasNode(s, "muscle_trunk") && hasNode(s, "kidney_left"));
  window.waitForValue("image/label.4", "false");
  window.moveTo(axialPixel(window, {0, -45, 0}));
  window.screenshot("created");

  // Undo removes the body and picks its label again; the others stay. Redo returns it.
  window.key("ctrl+z");
  C3DE_WAIT(window, "the trunk is removed",
            s["jobs"].empty() && !hasNode(s, "muscle_trunk") && hasNode(s, "kidney_left"));
  C3DE_WAIT(window, "it is picked again", textOf(s, "segmentation/Picked").ends_with(" 125000 voxels"));
  window.key("ctrl+y");
  C3DE_WAIT(window, "the trunk is there again",
            s["jobs"].empty() && hasNode(s, "muscle_trunk") && textOf(s, "image/preview") == "none");
  window.waitFrames(10);  // a simulation that played before plays again
  if (mode(window.state()) != "playing") window.key("space");
  C3DE_WAIT(window, "it plays", s["transport"]["mode"] == "playing");
  // A body of this name exists: its mask can be replaced instead. Here they are equal.
  window.click("segmentation/undo");
  // The panel grows row by row until the mask is shown, and the rows below move.
  C3DE_WAIT(window, "it is picked again",
            textOf(s, "segmentation/Picked").ends_with(" 125000 voxels") && s["jobs"].empty() &&
                textOf(s, "segmentation/overlay") == "true" && textOf(s, "image/preview") == "shown");
  window.waitFrames(3);
  const Json again =
      C3DE_WAIT(window, "the body is offered for an update",
                s["widgets"].contains("segmentation/update") || s["scrolled_out"].contains("segmentation/update"));
  CHECK_FALSE(window.has("segmentation/create"));
  CHECK(mode(again) == "playing");
  CHECK(hasNode(again, "muscle_trunk"));
}

TEST_CASE("a mask is grown, painted, filled between slices, erased, undone and saved as a label map",
          "[segmentation_brush]") {
  C3DE_WINDOW_OR_SKIP();
  const Phantom phantom;
  const fs::path file = outputFile("segmentation_brush_phantom.nii.gz"), map = outputFile("segmentation_brush.nrrd");
  fs::remove(map);
  if (const auto written = imaging::writeVolume(file, phantom.volume); !written) FAIL(written.error().message);
  WorkstationDriver window("segmentation_brush");
  window.start({file.string()});
  C3DE_WAIT(window, "the image is shown", s["panes"].size() == 4 && s["jobs"].empty());
  const auto voxels = [](const Json &s) {
    const std::string text = textOf(s, "segmentation/Picked");
    const std::size_t comma = text.find(", ");
    return comma == std::string::npos || text.ends_with("…") ? -1.0 : std::strtod(text.c_str() + comma + 2, nullptr);
  };
  const auto waitForVoxels = [&](const std::string &what, double least, double most) {
    const Json s = window.waitUntil(what, [&](const Json &state) {
      return voxels(state) >= least && voxels(state) <= most && state["jobs"].empty();
    });
    return voxels(s);
  };

  window.click("segmentation/grow");
  C3DE_WAIT(window, "a click is waited for", textOf(s, "image/picking") == "on");
  window.clickAt(axialPixel(window, {-35, 0, 0}));
  window.waitForValue("segmentation/Picked", pickedText(phantom.organ));
  window.key("ctrl+z");
  window.waitForValue("segmentation/Picked", "nothing yet");

  // A stroke of 30 mm with a brush of 10 mm: 914 mm², of pixels of 4 mm²; one in ten is on the outline.
  constexpr double kArea = 914.0 / 4.0;
  window.moveTo(axialPixel(window, {-30, 0, 0}));
  window.key("k");
  C3DE_WAIT(window, "the brush is active", s["tool"] == "segmentation.brush");
  window.enterNumber("segmentation/brush_radius", "10");
  window.waitForValue("segmentation/brush_radius", "10 mm");
  window.drag(axialPixel(window, {-45, 0, 0}), axialPixel(window, {-15, 0, 0}), 6);
  const double first = waitForVoxels("a stroke is painted", 0.9 * kArea, 1.1 * kArea);
  C3DE_WAIT(window, "its surface is in the tree", hasNode(s, "mask"));
  const int slice = std::stoi(window.value("image/axial.slice"));
  window.moveTo(axialPixel(window, {-30, 0, 0}));
  for (int i = 0; i < 5; ++i) window.wheel(1);
  C3DE_WAIT(window, "another slice is shown", std::abs(std::stoi(textOf(s, "image/axial.slice")) - slice) == 5);
  window.drag(axialPixel(window, {-45, 0, 0}), axialPixel(window, {-15, 0, 0}), 6);
  const double both = waitForVoxels("a second stroke is painted", 1.95 * first, 2.05 * first);
  window.click("segmentation/fill_between");
  const double filled = waitForVoxels("the slices between are filled", 2.9 * both, 3.1 * both);
  window.moveTo(axialPixel(window, {-30, 0, 0}));
  window.screenshotAtRest("filled");
  CHECK(window.shareOfColour("filled", "r > 1.6*b && r > 0.25") > 0.002);
  window.click("segmentation/surface");
  C3DE_WAIT(window, "its surface is hidden", !hasNode(s, "mask"));

  window.key("e");
  C3DE_WAIT(window, "it erases", textOf(s, "image/brush") == "erase 10.00 mm");
  window.clickAt(axialPixel(window, {-30, 0, 0}));
  waitForVoxels("a disc is erased", filled - 0.4 * kArea, filled - 0.3 * kArea);
  window.screenshot("erased");
  window.key("ctrl+z");
  waitForVoxels("it is undone", filled, filled);

  window.click("segmentation/save_labels");
  window.enterFile(map);
  const Json saved = C3DE_WAIT(window, "it is saved", !notification(s, "Label map saved").is_null());
  CHECK_THAT(notification(saved, "Label map saved")["text"].get<std::string>(), Contains("segmentation_brush.nrrd"));
  const auto read = imaging::readLabelMap(map);
  REQUIRE(read);
  REQUIRE(read->labels.labels.size() == 1);
  CHECK(read->labels.labels[0].name == "organ");
  CHECK(std::count(read->labels.voxels.begin(), read->labels.voxels.end(), read->labels.labels[0].value) ==
        static_cast<std::ptrdiff_t>(filled));
  const fs::path table = outputFile("segmentation_brush.csv");
  fs::remove(table);
  window.clickMenu("file.save_statistics");
  window.enterFile(table);
  C3DE_WAIT(window, "the statistics are saved", !notification(s, "Region statistics saved").is_null());
  std::ifstream csv(table);
  std::string head, row;
  std::getline(csv, head);
  std::getline(csv, row);
  CHECK(head == "label,name,voxels,volume_ml,measured,mean,sd,minimum,maximum,unit");
  CHECK(row.starts_with(
      fmt::format(",organ,{0},{1},{0},", filled, filled * kSpacing_mm * kSpacing_mm * kSpacing_mm / 1000.0)));
  // An undone step is not what was saved: quitting asks. Saved, nothing is lost by it.
  window.key("ctrl+z");
  waitForVoxels("the last step is undone", both, both);
  window.key("ctrl+q");
  C3DE_WAIT(window, "it asks", s["values"].contains("quit/text"));
  window.key("Escape");
  C3DE_WAIT(window, "it stays", !s["values"].contains("quit/text"));
  window.click("segmentation/save_labels");
  window.enterFile(freshFile("segmentation_brush_undone.nrrd"));
  C3DE_WAIT(window, "it is saved again", s["notifications"].dump().find("brush_undone") != std::string::npos);
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);
}

TEST_CASE("a painted mask is part of sessions and of the recovery file", "[segmentation_session]") {
  C3DE_WINDOW_OR_SKIP();
  const Phantom phantom;
  const fs::path file = outputFile("segmentation_session_phantom.nii.gz"), session = freshFile("mask.c3de"),
                 home = outputFile("segmentation_session_home");
  fs::remove_all(home);
  if (const auto written = imaging::writeVolume(file, phantom.volume); !written) FAIL(written.error().message);
  const ScopedEnvironment user("C3DE_HOME", home.string());
  std::string picked;
  {
    WorkstationDriver window("segmentation_session");
    window.start({file.string()});
    C3DE_WAIT(window, "the image is shown", s["panes"].size() == 4 && s["jobs"].empty());
    CHECK(window.state()["title"] == "segmentation_session_phantom.nii.gz - C3DE");
    window.enterNumber("segmentation/low", "60");
    window.waitForValue("segmentation/Picked", pickedText(phantom.organ + phantom.other));
    window.moveTo(axialPixel(window, {-30, 0, 0}));
    window.key("k");
    C3DE_WAIT(window, "the brush is active", s["tool"] == "segmentation.brush");
    window.drag(axialPixel(window, {0, -40, 0}), axialPixel(window, {20, -40, 0}), 4);
    C3DE_WAIT(window, "a stroke is painted",
              s["jobs"].empty() && textOf(s, "segmentation/Picked").ends_with(" voxels") &&
                  textOf(s, "segmentation/Picked") != pickedText(phantom.organ + phantom.other));
    picked = window.value("segmentation/Picked");
    window.moveTo(window.inView(0.9, 0.9));
    window.key("ctrl+s");
    window.enterFile(session);
    waitForMessage(window, "Session saved");
    CHECK(window.state()["title"] == "mask.c3de - C3DE");
    window.screenshotAtRest("saved");
    window.key("ctrl+q");
    CHECK(window.waitForExit() == 0);
  }
  {
    WorkstationDriver window("segmentation_session_opened");
    window.start({session.string()});
    C3DE_WAIT(window, "the mask is restored", s["jobs"].empty() && textOf(s, "segmentation/Picked") == picked);
    CHECK(window.value("image/preview") == "shown");
    CHECK(window.state()["title"] == "mask.c3de - C3DE");
    window.screenshotAtRest("opened");
    window.click("segmentation/fill_holes");
    C3DE_WAIT(window, "it can be edited",
              s["jobs"].empty() && textOf(s, "segmentation/Picked").ends_with(" voxels") &&
                  textOf(s, "segmentation/Picked") != picked);
    picked = window.value("segmentation/Picked");
    C3DE_WAIT(window, "that is not saved", s["title"] == "mask.c3de* - C3DE");
    window.waitUntil("it is backed up", [&](const Json &) { return !recoveryIn(home).empty(); });
    window.kill();
  }
  WorkstationDriver window("segmentation_session_recovered");
  window.start({});
  waitForMessage(window, "Unsaved work of ");
  window.click("notification/choose.0.0");
  C3DE_WAIT(window, "the edited mask is restored", s["jobs"].empty() && textOf(s, "segmentation/Picked") == picked);
  window.key("ctrl+q");
  const Json asked = C3DE_WAIT(window, "it asks", s["values"].contains("quit/text"));
  CHECK_THAT(textOf(asked, "quit/text"), Contains("What is picked in the image is not saved"));
}
