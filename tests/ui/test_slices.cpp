// SPDX-License-Identifier: Apache-2.0
// Interaction in the slices of an image: pulling and touching the tissue that they show.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "c3de/imaging/writing.h"
#include "support/catch.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;
constexpr double kRadians = 0.017453292519943295;  // of a degree

/// A scan of 64 x 64 x 48 voxels of 2 x 2 x 2.5 mm: an organ of 64 x 52 x 50 mm about the middle of the grid with
/// stripes in it, and a bone next to it, towards +i. Rotated about its centre, the origin of the world.
struct Scan {
  imaging::VolumeGeometry geometry;
  std::vector<std::int16_t> image;
  std::vector<std::uint16_t> labels;
};

Scan scan(double degrees) {
  Scan s;
  const double c = std::cos(degrees * kRadians), d = std::sin(degrees * kRadians);
  const std::array<std::size_t, 3> n{64, 64, 48};
  const Vec3 ci{2 * c, 2 * d, 0}, cj{-2 * d, 2 * c, 0}, ck{0, 0, 2.5};
  const Vec3 origin = -31.5 * ci - 31.5 * cj - 23.5 * ck;
  s.geometry = {
      n, {ci[0], ci[1], ci[2], 0, cj[0], cj[1], cj[2], 0, ck[0], ck[1], ck[2], 0, origin[0], origin[1], origin[2], 1}};
  for (int k = 0; k < 48; ++k)
    for (int j = 0; j < 64; ++j)
      for (int i = 0; i < 64; ++i) {
        const bool isHigh = k >= 14 && k < 34;
        const bool isOrgan = isHigh && i >= 16 && i < 48 && j >= 19 && j < 45;
        const bool isBone = isHigh && i >= 52 && i < 60 && j >= 19 && j < 45;
        // Stripes, so that the motion of the tissue is visible.
        const int stripe = isOrgan && ((i / 4 + j / 4) % 2 == 0) ? 60 : 0;
        s.image.push_back(static_cast<std::int16_t>(isOrgan ? 40 + stripe : isBone ? 700 : -1000));
        s.labels.push_back(isOrgan ? 1 : isBone ? 2 : 0);
      }
  return s;
}

/// Its scene text: the organ is held by its surroundings, the bone is static.
struct SceneText {
  double degrees = 0.0;
  std::string organ = {}, bone = "rigid = true\n", damping = "10";
  std::string rest = "[[attachment]]\nbodies = [\"organ\", \"surroundings\"]\nstiffness = 2e4\n";
};
fs::path sceneOf(const std::string &name, const SceneText &says = SceneText()) {
  const Scan s = scan(says.degrees);
  const fs::path image = outputFile(name + ".nii.gz"), labels = outputFile(name + "_labels.nii.gz"),
                 scene = outputFile(name + ".toml");
  imaging::Volume volume;
  volume.geometry = s.geometry;
  volume.voxels = s.image;
  volume.unit = "HU";
  const auto written = imaging::writeVolume(image, volume);
  if (!written) FAIL(written.error().message);
  const imaging::LabelMap map{s.geometry, s.labels, {{1, "organ", {0.1f, 0.6f, 0.1f}}, {2, "bone", {1, 1, 0.6f}}}};
  const auto writtenMap = imaging::writeLabelMap(labels, map);
  if (!writtenMap) FAIL(writtenMap.error().message);
  const std::string volumeLine = "volume = \"" + labels.filename().generic_string() + "\"\n";
  std::ofstream(scene) << "format = 1\ntitle = \"Scan\"\n[image]\nfile = \"" << image.filename().generic_string()
                       << "\"\nrim = 8\nstill = \"nothing\"\n[world]\ngravity = [0, 0, 0]\n[solver]\ndamping = "
                       << says.damping << "\n[[body]]\nname = \"organ\"\nlabel = 1\n"
                       << volumeLine << "material = { youngs_modulus = 3e3, poisson_ratio = 0.4 }\n"
                       << "sampling = { count = 600 }\n"
                       << says.organ << "[[body]]\nname = \"bone\"\nlabel = 2\n"
                       << volumeLine << "material = { youngs_modulus = 3e3, poisson_ratio = 0.4 }\n"
                       << "sampling = { count = 300 }\n"
                       << says.bone << says.rest;
  return scene;
}

double number(const Json &state, const std::string &name) { return std::strtod(row(state, name).c_str(), nullptr); }
long long steps(const Json &state) { return state["transport"]["steps"]; }

void start(WorkstationDriver &window, const fs::path &scene) {
  window.start({scene.string()});
  C3DE_WAIT(window, "organ and bone are in the scan",
            s["panes"].size() == 4 && s["jobs"].empty() && !row(s, "Surfels").empty() &&
                imageText(s, "axial.outlines") == "2" &&
                imageText(s, "axial.readout").find("|u| ") != std::string::npos);
}

void take(WorkstationDriver &window, const char *key, const std::string &tool) {
  window.moveTo(window.inView(0.5, 0.5));
  window.key(key);
  C3DE_WAIT(window, "the tool is active", s["tool"] == tool);
}

void play(WorkstationDriver &window) {
  window.moveTo(window.inView(0.9, 0.9));
  window.key("space");
  C3DE_WAIT(window, "it plays", mode(s) == "playing" && steps(s) > 5);
}

}  // namespace

TEST_CASE("tissue is pulled where a slice shows it, within its plane, and one Undo takes it back", "[slice_pinch]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("slice_pinch");
  start(window, sceneOf("slice_pinch"));
  take(window, "p", "pointbased.pinch");
  play(window);
  const std::string crossHair = imageText(window.state(), "cross_hair");
  const Point from = window.inSlice("axial", -10, 5), to = window.inSlice("axial", -28, -12);
  window.moveTo(from);
  C3DE_WAIT(window, "the hint says what a press does",
            s["values"].value("status/hint", "").find("Pinch: Press on the organ, here or in a slice") == 0);
  window.screenshot("before");
  window.press();
  const Json held = C3DE_WAIT(window, "it is held", row(s, "Held inside") == "organ");
  // The point under the mouse, inside, in the plane; a pixel is 0.5 mm.
  const Vec3 pressed = vectorOf(held, kPanel + "Held point");
  INFO(row(held, "Held point"));
  CHECK(std::abs(pressed[0] + 10) < 0.6);
  CHECK(std::abs(pressed[1] - 5) < 0.6);
  const double plane = pressed[2];
  CHECK(std::abs(plane) < 1.3);
  window.moveAlong(from, to, 8);
  C3DE_WAIT(window, "the tissue has come after the hand",
            number(s, "Pinch force") > 0.05 && norm(vectorOf(s, kPanel + "Held point") - pressed) > 6.0);
  // The material under the mouse has come from the pressed position: the slice shows that.
  C3DE_WAIT(window, "the scan follows", displacement_mm(s, "axial") > 3.0);
  window.waitFrames(20);
  window.screenshot("pulled");
  const Json pulled = window.state();
  const Vec3 hand = vectorOf(pulled, kPanel + "Hand"), now = vectorOf(pulled, kPanel + "Held point");
  INFO(row(pulled, "Hand"));
  CHECK(std::abs(hand[0] + 28) < 0.6);
  CHECK(std::abs(hand[1] + 12) < 0.6);
  CHECK(std::abs(hand[2] - plane) < 0.01);
  CHECK(std::abs(now[2] - plane) < 1.0);
  CHECK(imageText(pulled, "axial.marks").find(" 0 beside it") != std::string::npos);
  CHECK(imageText(pulled, "axial.marks").find("0 in the plane") != 0);
  CHECK(imageText(pulled, "coronal.marks").find("0 in the plane, 0 beside it") == std::string::npos);
  CHECK(imageText(pulled, "cross_hair") == crossHair);
  for (const char *pane : {"axial", "sagittal", "coronal", "3D"}) {
    INFO(pane);
    CHECK(window.differsFrom("before", "pulled", 100, pane));
  }
  window.release();
  C3DE_WAIT(window, "it is let go", row(s, "Pinch force") == "–");
  CHECK(imageText(window.state(), "axial.marks") == "0 in the plane, 0 beside it");
  window.moveTo(window.inView(0.9, 0.9));
  window.key("space");
  const Json paused = C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  window.key("ctrl+z");
  const Json undone = C3DE_WAIT(window, "the pull is undone", steps(s) < steps(paused));
  C3DE_WAIT(window, "the scan is back", displacement_mm(s, "axial") < 0.01);
  window.screenshot("undone");
  CHECK(steps(undone) > 0);  // to before the pull, not to the beginning
  window.key("ctrl+y");
  C3DE_WAIT(window, "it is done again", steps(s) == steps(paused));
  window.key("ctrl+z");
  C3DE_WAIT(window, "one step was it", steps(s) == steps(undone));

  // In another view, zoomed and panned: the point under the mouse before the zoom stays there.
  window.key("space");
  const Point sagittal = window.inSlice("sagittal", 8, -10);
  window.moveTo(sagittal);
  window.keyDown("ctrl");
  window.wheel(4);
  window.keyUp("ctrl");
  window.waitFrames(2);
  window.moveTo(sagittal);
  window.press();
  const Json second = C3DE_WAIT(window, "it is held", row(s, "Held inside") == "organ");
  const Vec3 there = vectorOf(second, kPanel + "Held point");
  INFO(row(second, "Held point"));
  CHECK(std::abs(there[1] - 8) < 0.7);
  CHECK(std::abs(there[2] - 10) < 0.7);
  window.moveAlong(sagittal, {sagittal.x + 60, sagittal.y - 40}, 8);
  C3DE_WAIT(window, "the hand pulls", number(s, "Pinch force") > 0.05);
  window.waitFrames(20);
  window.screenshot("sagittal");
  CHECK(std::abs(vectorOf(window.state(), kPanel + "Hand")[0] - there[0]) < 0.01);

  // The slice is scrolled during the drag: the target moves along, 2 mm a slice.
  window.wheel(3);
  C3DE_WAIT(window, "the hand has gone along",
            std::abs(std::abs(vectorOf(s, kPanel + "Hand")[0] - there[0]) - 6) < 0.05);
  window.screenshot("scrolled");
  window.key("Escape");
  C3DE_WAIT(window, "Escape lets go", row(s, "Pinch force") == "–");
  const std::string cross = imageText(window.state(), "cross_hair");
  window.moveTo({sagittal.x, sagittal.y + 30});
  window.release();
  window.waitFrames(2);
  CHECK(row(window.state(), "Pinch force") == "–");
  CHECK(imageText(window.state(), "cross_hair") == cross);

  // Without a tool the slice's own gestures are active again.
  window.moveTo(window.inView(0.5, 0.5));
  window.key("o");
  window.clickAt(window.inSlice("axial", 20, 10));
  C3DE_WAIT(window, "the cross-hair moves", imageText(s, "cross_hair") != cross);
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("a press beside tissue and on rigid bone holds nothing and says why", "[slice_refused]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("slice_refused");
  // The lowest 10 mm of the organ are fixed.
  SceneText says;
  says.rest += "[[fix]]\nbody = \"organ\"\nregion = { half_space = { point = [0, 0, -0.015], normal = [0, 0, 1] } }\n";
  start(window, sceneOf("slice_refused", says));
  take(window, "p", "pointbased.pinch");
  play(window);
  const Json before = window.state();
  const auto press = [&](const char *pane, double right, double down, const std::string &why) {
    window.moveTo(window.inSlice(pane, right, down));
    window.press();
    const Json told = C3DE_WAIT(window, "it is said: " + why, row(s, "Not held") == why);
    CHECK(row(told, "Held inside").empty());
    CHECK(imageText(told, std::string(pane) + ".marks") == "1 in the plane, 0 beside it");
    window.moveTo(window.inSlice(pane, right + 10, down));
    window.release();
    C3DE_WAIT(window, "the word at the place goes",
              imageText(s, std::string(pane) + ".marks") == "0 in the plane, 0 beside it");
  };
  press("axial", -50, 5, "No body here");
  window.screenshot("beside");
  window.moveTo(window.inSlice("axial", 49, 5));
  window.press();
  C3DE_WAIT(window, "it is said", row(s, "Not held") == "bone is rigid and fixed");
  window.screenshot("bone");
  window.release();
  press("coronal", 0, 22, "organ is held by a fix there");
  CHECK(imageText(window.state(), "cross_hair") == imageText(before, "cross_hair"));
  // Nothing was begun that could be undone.
  const long long now = steps(window.state());
  window.key("ctrl+z");
  window.waitFrames(3);
  CHECK(steps(window.state()) >= now);
  // Above it is free; while paused it is held, and pulled once it plays.
  window.key("space");
  C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  const Point from = window.inSlice("coronal", 0, -15);
  window.moveTo(from);
  window.press();
  C3DE_WAIT(window, "it is held", row(s, "Held inside") == "organ");
  CHECK(row(window.state(), "Not held").empty());
  window.moveAlong(from, {from.x - 30, from.y - 20}, 3);
  CHECK(number(window.state(), "Pinch force") == 0.0);
  window.key("space");
  C3DE_WAIT(window, "it is pulled", number(s, "Pinch force") > 0.05);
  window.release();
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("in a scan that is turned and a body that has gone far, what is seen is held", "[slice_oblique]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("slice_oblique");
  // It flies 30 mm in a second towards -j of the rotated scan, unsupported.
  SceneText says;
  says.degrees = 25.0;
  const double c = std::cos(says.degrees * kRadians), d = std::sin(says.degrees * kRadians);
  std::ostringstream velocity;
  velocity << "velocity = [" << 0.03 * d << ", " << -0.03 * c << ", 0]\n";
  says.organ = velocity.str();
  says.damping = "0";
  says.rest.clear();
  start(window, sceneOf("slice_oblique", says));
  take(window, "p", "pointbased.pinch");
  play(window);
  C3DE_WAIT(window, "it is far away", s["transport"]["time_s"] > 0.9);
  window.key("space");
  C3DE_WAIT(window, "it stands", mode(s) == "paused");
  const double gone = 30.0 * window.state()["transport"]["time_s"].get<double>();
  // The centre of the former lower half of the organ, in the frame of the scan.
  const Point where = window.inSlice("axial", 6.0, 15.0 - gone);
  window.moveTo(where);
  C3DE_WAIT(window, "the scan shows tissue there", std::abs(displacement_mm(s, "axial") - gone) < 0.1);
  window.press();
  const Json held = C3DE_WAIT(window, "it is held", row(s, "Held inside") == "organ");
  const Vec3 point = vectorOf(held, kPanel + "Held point");
  const Vec3 right{c, d, 0}, down{-d, c, 0};
  INFO(row(held, "Held point"));
  CHECK(std::abs(dot(point, right) - 6.0) < 0.7);
  CHECK(std::abs(dot(point, down) - (15.0 - gone)) < 0.7);
  window.moveAlong(where, {where.x - 60, where.y}, 4);
  window.moveTo({where.x - 60, where.y});
  const Vec3 hand = vectorOf(window.state(), kPanel + "Hand");
  CHECK(std::abs(dot(hand - point, down)) < 0.05);
  CHECK(dot(hand - point, right) < -15.0);
  window.screenshot("held");
  window.key("space");
  C3DE_WAIT(window, "it is pulled", number(s, "Pinch force") > 0.05);
  window.waitFrames(20);
  window.screenshot("pulled");
  window.release();
  // Its former region is empty.
  window.moveTo(window.inSlice("axial", 6, 22));
  window.press();
  C3DE_WAIT(window, "nothing is there", row(s, "Not held") == "No body here");
  window.release();
}

TEST_CASE("where two bodies lie over each other the one is held that the slice shows", "[slice_overlap]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("slice_overlap");
  // The former bone is soft and flies 18 mm into the organ, which ends at x = 32 mm: it then extends from 23 to 39 mm.
  SceneText says;
  says.bone = "velocity = [-0.006, 0, 0]\n";
  says.damping = "0";
  says.rest = "[contact]\nenabled = false\n";
  start(window, sceneOf("slice_overlap", says));
  take(window, "p", "pointbased.pinch");
  window.moveTo(window.inView(0.9, 0.9));
  window.key("space");
  C3DE_WAIT(window, "it is there", s["transport"]["time_s"] > 2.9);
  window.key("space");
  C3DE_WAIT(window, "it stands", mode(s) == "paused");
  const double gone = 6.0 * window.state()["transport"]["time_s"].get<double>();
  INFO(gone);
  REQUIRE(gone < 20.0);
  // From the region of only the one to that of only the other: the grabbed body is the displayed one. Two presses
  // nearer than 5 pixels, 2.2 mm, would be a double click.
  int ofOrgan = 0, ofBone = 0;
  for (double x = 12.0; x < 55.0 - gone; x += 2.6) {
    INFO(x);
    window.moveTo(window.inSlice("axial", x, 5));
    const Json shown = C3DE_WAIT(window, "the slice tells of it",
                                 std::abs(std::strtod(imageText(s, "axial.readout").c_str() + 4, nullptr) - x) < 0.6);
    window.press();
    const Json held = C3DE_WAIT(window, "it is held", !row(s, "Held inside").empty());
    window.release();
    C3DE_WAIT(window, "it is let go", row(s, "Held inside").empty());
    // Between the two the slice blends.
    const double shift = displacement_mm(shown, "axial");
    if (shift > 1.0 && shift < gone - 1.0) continue;
    const bool isOfOrgan = shift <= 1.0;
    ++(isOfOrgan ? ofOrgan : ofBone);
    CHECK(row(held, "Held inside") == (isOfOrgan ? "organ" : "bone"));
  }
  CHECK(ofOrgan > 0);
  CHECK(ofBone > 2);
  window.screenshot("over_each_other");
}

TEST_CASE("an instrument is put into a slice, drawn where it is cut, and pushed within the plane", "[slice_touch]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("slice_touch");
  start(window, sceneOf("slice_touch"));
  take(window, "t", "pointbased.touch");
  play(window);
  const auto outlines = [](const char *pane, const char *count) {
    return [key = std::string(pane) + ".outlines", count](const Json &s) { return imageText(s, key) == count; };
  };
  // In the coronal view, to the left of the organ: it ends 32 mm from the middle.
  const Point from = window.inSlice("coronal", -45, 3);
  window.moveTo({from.x - 10, from.y});
  window.moveTo(from);
  window.waitFrames(3);
  window.screenshot("hovered");
  CHECK(imageText(window.state(), "coronal.marks") == "1 in the plane, 0 beside it");
  window.press();
  window.waitUntil("it is cut", outlines("coronal", "3"));
  const double radius = number(window.state(), "touch_radius"), y = number(window.state(), "touch_y");
  CHECK(std::abs(number(window.state(), "touch_x") + 45) < 0.6);
  CHECK(std::abs(number(window.state(), "touch_z") + 3) < 0.6);
  CHECK(radius >= 6.0);
  window.moveAlong(from, window.inSlice("coronal", -26, 3), 8);
  C3DE_WAIT(window, "it is felt", number(s, "Contact force") > 0.1);
  window.waitFrames(30);
  window.screenshot("pressed");
  const Json pressed = window.state();
  CHECK(std::abs(number(pressed, "touch_x") + 26) < 0.6);
  CHECK(std::abs(number(pressed, "touch_y") - y) < 0.01);  // within the plane
  CHECK(imageText(pressed, "coronal.marks").find("0 in the plane") != 0);
  window.release();
  CHECK(window.differsFrom("hovered", "pressed", 200, "coronal"));
  // A press on it grabs it again; the wheel scrolls to the next slice, and it moves along.
  const Point again = window.inSlice("coronal", -26, 4);
  window.moveTo(again);
  window.press();
  window.moveTo({again.x - 2, again.y});
  window.wheel(2);
  C3DE_WAIT(window, "it has gone along", std::abs(std::abs(number(s, "touch_y") - y) - 4) < 0.05);
  CHECK(outlines("coronal", "3")(window.state()));
  window.release();
  window.moveTo(window.inView(0.9, 0.9));
  const long long last = steps(window.state());
  window.key("ctrl+z");
  C3DE_WAIT(window, "the second push is undone", steps(s) < last);
  window.key("ctrl+z");
  window.waitUntil("it was never there", outlines("coronal", "2"));
  // Within the tissue: it is placed next to the skin, in the plane.
  const Point inside = window.inSlice("coronal", -27, 3);
  window.moveTo(inside);
  window.press();
  window.waitUntil("it is cut", outlines("coronal", "3"));
  const double x = number(window.state(), "touch_x");
  INFO(x);
  CHECK(std::abs(x + 32 + radius) < 2.5);  // the skin of voxels of 2 mm is smooth
  CHECK(std::abs(number(window.state(), "touch_z") + 3) < 1.0);
  window.release();
  window.screenshot("beside");
  window.key("x");
  window.waitUntil("it is taken away", outlines("coronal", "2"));
  CHECK(window.state()["notifications"].empty());
}
