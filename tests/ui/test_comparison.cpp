// SPDX-License-Identifier: Apache-2.0
// A second scan over the first one: opened, aligned by landmarks and by hand, blended and in squares, saved.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "c3de/imaging/writing.h"
#include "support/catch.h"
#include "ui/image_window.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"
#include "unit/render/phantom.h"

using namespace c3de;
using namespace c3de::test;

namespace fs = std::filesystem;

namespace {

const std::string kSecond = "comparison/";

/// Rz(30) Ry(-15) Rx(10) degrees, then a shift in mm.
Mat4 motion() {
  const auto turn = [](std::size_t axis, double degrees) {
    const double c = std::cos(degrees * std::numbers::pi / 180.0), s = std::sin(degrees * std::numbers::pi / 180.0);
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    Mat4 m = kIdentity4;
    m[5 * a] = m[5 * b] = c;
    m[4 * a + b] = s;
    m[4 * b + a] = -s;
    return m;
  };
  Mat4 m = multiply(turn(2, 30.0), multiply(turn(1, -15.0), turn(0, 10.0)));
  m[12] = 12.0;
  m[13] = -9.0;
  m[14] = 6.0;
  return m;
}

/// The phantom of imageFile(), rotated and shifted, as another scanner shows it: other spacing, oblique, other size.
fs::path secondFile(const std::string &scenario, const Mat4 &moved = motion()) {
  const double c = std::cos(0.2), s = std::sin(0.2);
  const Mat4 oblique{1.5 * c, 1.5 * s, 0, 0, -1.5 * s, 1.5 * c, 0, 0, 0, 0, 2.5, 0, 0, 0, 0, 1};
  Mat4 own = oblique;
  const Vec3 middle = transformPoint(oblique, {37, 35.5, 19.5});
  for (std::size_t r = 0; r < 3; ++r) own[12 + r] = -middle[r];
  const auto phantom = render::test::makePhantom({75, 72, 40}, own);
  imaging::Volume volume;
  volume.geometry = {phantom.size, multiply(moved, own)};
  volume.voxels = phantom.voxels;
  fs::path file = outputFile(scenario + "_second.nrrd");
  if (const auto written = imaging::writeVolume(file, volume); !written) FAIL(written.error().message);
  return file;
}

const std::vector<std::pair<std::string, Vec3>> kLandmarks{
    {"left", {30, 0, 0}}, {"front", {0, -30, 0}}, {"top", {0, 0, 30}}, {"corner", {-30, 30, -30}}};

/// @param count  of the landmarks
fs::path landmarkFile(const std::string &name, const Mat4 &moved, std::size_t count = 4) {
  fs::path file = outputFile(name);
  std::ofstream out(file);
  out.precision(17);
  out << "name,x_mm,y_mm,z_mm\n";
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 at = transformPoint(moved, kLandmarks[i].second);
    out << kLandmarks[i].first << "," << at[0] << "," << at[1] << "," << at[2] << "\n";
  }
  return file;
}

void openComparison(WorkstationDriver &window, const fs::path &file) {
  window.clickMenu("file.open_comparison");
  window.openFile(file);
}

void loadFirstLandmarks(WorkstationDriver &window, const std::string &scenario) {
  window.click("measurements/header");
  window.click("measurements/load");
  window.openFile(landmarkFile(scenario + "_first.csv", kIdentity4));
  C3DE_WAIT(window, "the landmarks are listed", textOf(s, "measurements/count") == "4");
  window.click("measurements/header");
}

std::string messagesOf(const Json &state) {
  std::string all;
  for (const Json &n : state["notifications"])
    all += n["severity"].get<std::string>() + " " + n["title"].get<std::string>() + ": " +
           n["text"].get<std::string>() + "\n";
  return all;
}

/// They cover a part of the side panel.
void closeMessages(WorkstationDriver &window) {
  for (std::size_t n = window.state()["notifications"].size(); n > 0; n = window.state()["notifications"].size()) {
    window.click("notification/close.0");
    C3DE_WAIT(window, "a message is closed", s["notifications"].size() < n);
  }
}

void alignBy(WorkstationDriver &window, const fs::path &file) {
  window.click("comparison/align");
  window.openFile(file);
}

}  // namespace

TEST_CASE("a second scan is aligned by landmarks, undone, compared in squares, and kept by a session",
          "[comparison_landmarks]") {
  C3DE_WINDOW_OR_SKIP();
  const std::string scenario = "comparison_landmarks";
  const fs::path session = freshFile(scenario + ".c3de"), second = secondFile(scenario);
  WorkstationDriver window(scenario);
  startOn(window, {imageFile(scenario).string()});
  loadFirstLandmarks(window, scenario);
  // The block is grey, and air is black.
  window.enterNumber("image/window", "1700");
  window.enterNumber("image/level", "-150");
  window.screenshotAtRest("alone");
  openComparison(window, second);
  C3DE_WAIT(window, "the second scan is there", textOf(s, kSecond + "name") == second.filename().string());
  C3DE_WAIT(window, "it has the position of its file",
            textOf(s, kSecond + "text") == second.filename().string() + " 50 %");
  window.enterNumber("comparison/window", "1700");
  window.enterNumber("comparison/level", "-150");
  window.enterNumber("comparison/blend", "100");
  C3DE_WAIT(window, "it is alone", textOf(s, kSecond + "text") == second.filename().string() + " 100 %");
  window.screenshotAtRest("unaligned");

  alignBy(window, landmarkFile(scenario + "_moving.csv", motion()));
  const Json aligned = C3DE_WAIT(window, "it is aligned", textOf(s, kSecond + "mean_mm") != "none");
  CHECK(numberOf(aligned, kSecond + "mean_mm") < 0.01);
  CHECK(textOf(aligned, kSecond + "Pairs") == "4");
  CHECK_THAT(textOf(aligned, kSecond + "Residual"), Contains("mean 0.000 mm, max 0.000 mm"));
  const Vec3 translation = vectorOf(aligned, kSecond + "translation_mm"),
             rotation = vectorOf(aligned, kSecond + "rotation_deg");
  // The middle of the second scan comes to the origin.
  CHECK(norm(translation + Vec3{12, -9, 6}) < 1e-4);
  CHECK(norm(rotation) > 20.0);
  window.screenshotAtRest("aligned");
  CHECK(window.differsFrom("unaligned", "aligned", 5000, "axial"));
  // It shows the same as the first one, apart from the edges of voxels and texts.
  for (const std::string pane : {"axial", "sagittal", "coronal"}) {
    CAPTURE(pane);
    CHECK(window.differingPixels("alone", "aligned", pane) < 0.4 * window.differingPixels("alone", "unaligned", pane));
  }
  // Both values under the mouse, in the block and in air.
  window.moveTo(pixelOf(window, "axial", {-20, 20, 0}));
  C3DE_WAIT(window, "both values are read out",
            textOf(s, "image/axial.readout").find("40   second 40") != std::string::npos);

  window.key("ctrl+z");
  C3DE_WAIT(window, "it is undone", norm(vectorOf(s, kSecond + "rotation_deg")) == 0.0);
  CHECK(textOf(window.state(), kSecond + "mean_mm") == "none");
  window.key("ctrl+y");
  C3DE_WAIT(window, "and redone", norm(vectorOf(s, kSecond + "translation_mm") - translation) < 1e-5);

  window.enterNumber("comparison/blend", "50");
  window.choose("comparison/mode", "checkerboard");
  window.enterNumber("comparison/square", "15");
  C3DE_WAIT(window, "there are squares", textOf(s, kSecond + "text").find("squares of 15 mm") != std::string::npos);
  // Another window of the second scan makes the squares visible.
  window.enterNumber("comparison/window", "800");
  window.screenshotAtRest("checkerboard");
  CHECK(window.differsFrom("aligned", "checkerboard", 5000, "axial"));

  window.key("ctrl+s");
  window.enterFile(session);
  waitForMessage(window, "Session saved");
  C3DE_WAIT(window, "nothing is unsaved", s["title"].get<std::string>().find('*') == std::string::npos);
  const Json saved = window.state();
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);

  // The second scan has moved meanwhile: the dialog asks for it.
  const fs::path elsewhere = freshFile(scenario + "_elsewhere.nrrd");
  fs::rename(second, elsewhere);
  WorkstationDriver again(scenario + "_opened");
  again.start({session.string()});
  C3DE_WAIT(again, "the missing file is asked for", s["widgets"].contains("missing/locate.0"));
  CHECK(again.value("missing/name.0") == second.filename().string());
  again.click("missing/locate.0");
  again.openFile(elsewhere);
  C3DE_WAIT(again, "it is found", textOf(s, "missing/found.0").find("elsewhere") != std::string::npos);
  again.click("missing/open");
  C3DE_WAIT(again, "the comparison is back",
            s["jobs"].empty() && textOf(s, kSecond + "text") == elsewhere.filename().string() + " in squares of 15 mm");
  const Json back = again.state();
  CHECK(norm(vectorOf(back, kSecond + "translation_mm") - vectorOf(saved, kSecond + "translation_mm")) < 1e-5);
  CHECK(norm(vectorOf(back, kSecond + "rotation_deg") - vectorOf(saved, kSecond + "rotation_deg")) < 1e-5);
  CHECK(numberOf(back, kSecond + "window") == 800.0);
  CHECK(back["title"].get<std::string>().find('*') == std::string::npos);
  again.screenshotAtRest("checkerboard");
  again.clickMenu("file.close_comparison");
  C3DE_WAIT(again, "it is removed", textOf(s, kSecond + "name") == "none");
  CHECK(again.state()["panes"].size() == 4);
}

TEST_CASE("a second scan is moved and rotated by drags and by numbers, and put back", "[comparison_by_hand]") {
  C3DE_WINDOW_OR_SKIP();
  const std::string scenario = "comparison_by_hand";
  WorkstationDriver window(scenario);
  startOn(window, {imageFile(scenario).string()});
  openComparison(window, secondFile(scenario, kIdentity4));
  C3DE_WAIT(window, "the second scan is there", textOf(s, kSecond + "name") == scenario + "_second.nrrd");
  window.screenshotAtRest("before");
  window.click("toolbar/tool.comparison.move");
  window.drag(pixelOf(window, "axial", {-10, 0, 0}), pixelOf(window, "axial", {10, 15, 0}), 5);
  const Json moved = C3DE_WAIT(window, "it has moved", norm(vectorOf(s, kSecond + "translation_mm")) > 20.0);
  // A pixel of the window is about half a millimetre.
  CHECK(norm(vectorOf(moved, kSecond + "translation_mm") - Vec3{20, 15, 0}) < 2.0);
  CHECK(norm(vectorOf(moved, kSecond + "rotation_deg")) < 1e-6);
  window.screenshotAtRest("moved");
  CHECK(window.differsFrom("before", "moved", 2000, "axial"));
  // Escape takes back a drag in progress.
  window.moveTo(pixelOf(window, "coronal", {0, 0, 0}));
  window.press();
  window.moveAlong(pixelOf(window, "coronal", {0, 0, 0}), pixelOf(window, "coronal", {0, 0, 25}), 3);
  C3DE_WAIT(window, "it follows", vectorOf(s, kSecond + "translation_mm")[2] > 5.0);
  window.key("Escape");
  C3DE_WAIT(window, "it is back", std::abs(vectorOf(s, kSecond + "translation_mm")[2]) < 1e-6);
  window.release();

  window.click("toolbar/tool.comparison.turn");
  const Vec3 pivot = crossHairOf(window.state());
  window.drag(pixelOf(window, "axial", pivot + Vec3{40, 0, 0}), pixelOf(window, "axial", pivot + Vec3{0, 40, 0}), 8);
  const Json turned = C3DE_WAIT(window, "it is turned", norm(vectorOf(s, kSecond + "rotation_deg")) > 80.0);
  CHECK(norm(vectorOf(turned, kSecond + "rotation_deg") - Vec3{0, 0, 90}) < 3.0);
  window.key("ctrl+z");
  C3DE_WAIT(window, "the turn is undone", norm(vectorOf(s, kSecond + "rotation_deg")) < 1e-6);

  window.enterNumber("comparison/ry", "12.5");
  C3DE_WAIT(window, "a number rotates", norm(vectorOf(s, kSecond + "rotation_deg") - Vec3{0, 12.5, 0}) < 1e-6);
  window.enterNumber("comparison/x", "-31");
  C3DE_WAIT(window, "a number moves", std::abs(vectorOf(s, kSecond + "translation_mm")[0] + 31.0) < 1e-6);
  window.click("comparison/reset");
  C3DE_WAIT(window, "it is reset",
            norm(vectorOf(s, kSecond + "translation_mm")) == 0.0 && norm(vectorOf(s, kSecond + "rotation_deg")) == 0.0);
  // The four steps are undone one by one.
  for (int i = 0; i < 4; ++i) window.key("ctrl+z");
  C3DE_WAIT(window, "all is undone",
            norm(vectorOf(s, kSecond + "translation_mm")) == 0.0 && norm(vectorOf(s, kSecond + "rotation_deg")) == 0.0);
  window.click("comparison/remove");
  C3DE_WAIT(window, "it is removed, and the tool with it",
            textOf(s, kSecond + "name") == "none" && !s["widgets"].contains("toolbar/tool.comparison.move"));
  window.key("ctrl+z");
  C3DE_WAIT(
      window, "it is back at its position",
      textOf(s, kSecond + "name") == scenario + "_second.nrrd" && norm(vectorOf(s, kSecond + "translation_mm")) == 0.0);
  window.key("ctrl+shift+z");
  C3DE_WAIT(window, "it is removed again", textOf(s, kSecond + "name") == "none");
}

TEST_CASE("the target of a landmark that is clicked on a moved second scan is its position in that scan",
          "[comparison_target]") {
  C3DE_WINDOW_OR_SKIP();
  const std::string scenario = "comparison_target";
  WorkstationDriver window(scenario);
  startOn(window, {imageFile(scenario).string()});
  openComparison(window, secondFile(scenario, kIdentity4));
  C3DE_WAIT(window, "the second scan is there", textOf(s, kSecond + "name") == scenario + "_second.nrrd");
  window.enterNumber("comparison/x", "-31");
  C3DE_WAIT(window, "it has moved", std::abs(vectorOf(s, kSecond + "translation_mm")[0] + 31.0) < 1e-6);
  window.click("toolbar/tool.measure.landmark");
  window.clickAt(pixelOf(window, "axial", {10, 5, 0}));
  window.click("measurements/header");
  C3DE_WAIT(window, "a landmark is placed", textOf(s, "measurements/count") == "1");
  window.click("measurements/set_target");
  window.clickAt(pixelOf(window, "axial", {-21, 5, 0}));
  const Json placed = C3DE_WAIT(window, "it has a target", textOf(s, "measurements/Landmark 1.target") != "none");
  // Both scans are the same phantom, so that the places are the same; a pixel is about half a millimetre.
  CHECK(norm(vectorOf(placed, "measurements/Landmark 1.target") -
             vectorOf(placed, "measurements/Landmark 1.reference")) < 1.5);
  CHECK(messagesOf(placed).find("without the motion of Compare") != std::string::npos);
  window.screenshotAtRest("target");
  // Escape cancels the click.
  window.click("measurements/set_target");
  C3DE_WAIT(window, "the next click is a target", textOf(s, "measurements/target_of") == "Landmark 1");
  window.moveTo(pixelOf(window, "axial", {0, 0, 0}));
  window.key("Escape");
  C3DE_WAIT(window, "it is no target any more", textOf(s, "measurements/target_of") == "none");
}

TEST_CASE("what cannot be compared leads to a message, and the image stays", "[comparison_bad]") {
  C3DE_WINDOW_OR_SKIP();
  const std::string scenario = "comparison_bad";
  WorkstationDriver window(scenario);
  const fs::path first = imageFile(scenario), broken = outputFile(scenario + "_broken.nii");
  std::ofstream(broken, std::ios::binary) << "this is no image";
  startOn(window, {first.string()});
  openComparison(window, broken);
  waitForMessage(window, "_broken.nii");
  openComparison(window, labelFile(scenario, ".seg.nrrd"));
  waitForMessage(window, "is a label map; accepted: a scan");
  CHECK(window.value(kSecond + "name") == "none");

  Mat4 far = kIdentity4;
  far[12] = 900.0;
  openComparison(window, secondFile(scenario, far));
  waitForMessage(window, "It does not overlap " + first.filename().string());
  const std::string messages = messagesOf(window.state());
  CHECK_THAT(messages, Contains(first.filename().string() + ": x -80 … 80, y -90 … 90, z -75 … 75 mm") &&
                           Contains(scenario + "_second.nrrd: x 8"));
  window.screenshotAtRest("far");
  closeMessages(window);
  // Landmarks of which too few have partners.
  loadFirstLandmarks(window, scenario);
  alignBy(window, landmarkFile(scenario + "_two.csv", far, 2));
  waitForMessage(window, "2 pairs of points; accepted: at least 3");
  CHECK(norm(vectorOf(window.state(), kSecond + "translation_mm")) == 0.0);
  closeMessages(window);
  window.click("comparison/centre");
  C3DE_WAIT(window, "it is centred", std::abs(vectorOf(s, kSecond + "translation_mm")[0] + 900.0) < 1.0);

  openComparison(window, first);
  waitForMessage(window, "It is the file of the open image.");
  CHECK(window.value(kSecond + "name") == first.filename().string());
  CHECK(window.state()["panes"].size() == 4);
}

TEST_CASE("the image that was open before another one can be compared with it", "[comparison_offered]") {
  C3DE_WINDOW_OR_SKIP();
  const std::string scenario = "comparison_offered";
  WorkstationDriver window(scenario);
  const fs::path first = imageFile(scenario), second = secondFile(scenario);
  startOn(window, {first.string()});
  window.key("ctrl+i");
  window.openFile(second);
  C3DE_WAIT(window, "the second is open", imageText(s, "name") == second.filename().string());
  waitForMessage(window, first.filename().string() + " was open before");
  window.click("notification/choose.0.0");
  C3DE_WAIT(window, "both are shown", textOf(s, kSecond + "text") == first.filename().string() + " 50 %");
  CHECK(imageText(window.state(), "name") == second.filename().string());
  // It is closed with the image.
  window.clickMenu("file.close_image");
  C3DE_WAIT(window, "both are closed, and the tool with them",
            s["panes"].empty() && !s["widgets"].contains("toolbar/tool.comparison.move"));
}

TEST_CASE("a body deforms the open image, and the second scan stays where it is", "[comparison_body]") {
  C3DE_ORGAN_OR_SKIP();
  const std::string scenario = "comparison_body";
  const fs::path image = imageFile(scenario), scene = outputFile(scenario + ".toml");
  std::ofstream(scene) << "format = 1\ntitle = \"Flying\"\n[image]\nfile = \"" << image.generic_string()
                       << "\"\nrim = 8\n[world]\ngravity = [0, 0, 0]\n[solver]\ndamping = 0\n[[body]]\nname = "
                          "\"block\"\nvolume = \""
                       << image.generic_string()
                       << "\"\nthreshold = [-480, 10000]\nvelocity = [0.008, 0, 0]\nsampling = { count = 300 }\n";
  WorkstationDriver window(scenario);
  startOn(window, {scene.string()});
  C3DE_WAIT(window, "the block is there", s["transport"]["exists"].get<bool>());
  openComparison(window, image);
  C3DE_WAIT(window, "the same scan is shown over it", textOf(s, kSecond + "name") == image.filename().string());
  window.choose("comparison/mode", "checkerboard");
  window.moveTo(pixelOf(window, "axial", {10, 20, 0}));
  window.key("space");
  C3DE_WAIT(window, "the block has moved", displacement_mm(s, "axial") > 16.0);
  window.key("space");
  C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  window.moveTo(pixelOf(window, "axial", {-28, 20, 0}));
  C3DE_WAIT(window, "the first is vacated there, and the second has the block",
            textOf(s, "image/axial.readout").find("vacated by a body   second 40") != std::string::npos);
  window.moveTo(pixelOf(window, "axial", {35, 20, 0}));
  C3DE_WAIT(window, "the block is there now, and the second has air",
            textOf(s, "image/axial.readout").find("]   40   second -1000") != std::string::npos);
  window.screenshotAtRest("moved");
}
