// SPDX-License-Identifier: Apache-2.0
// An image with bodies in it: organs, implants and instruments cut by its slices, and tissue that it follows.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "c3de/core/vec.h"
#include "c3de/imaging/reading.h"
#include "support/catch.h"
#include "ui/image_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

/// The scene of a free block, shown in its own image, that flies along x.
fs::path flyingBlock(const std::string &scenario, const std::string &image, double speed_mm_s) {
  fs::path scene = outputFile(scenario + ".toml");
  std::ofstream(scene) << "format = 1\ntitle = \"Flying\"\n[image]\nfile = \"" << image << "\"\nrim = 8\n"
                       << "[world]\ngravity = [0, 0, 0]\n[solver]\ndamping = 0\n[[body]]\nname = \"block\"\nvolume = \""
                       << image << "\"\nthreshold = [-480, 10000]\nvelocity = [" << 1e-3 * speed_mm_s
                       << ", 0, 0]\nsampling = { count = 300 }\n";
  return scene;
}

}  // namespace

TEST_CASE("an organ is cut by the slices and can be pulled in the 3D view beside them", "[image_organ]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("image_organ");
  const fs::path scene = outputFile("image_organ.toml");
  std::ofstream(scene)
      << "format = 1\ntitle = \"Organ in an image\"\n[world]\ngravity = [0.0, 0.0, 0.0]\n[solver]\ndamping = 5.0\n"
         "[[body]]\nname = \"organ\"\nmesh = \""
      << organMesh().generic_string() << "\"\nmesh_unit = \"mm\"\n"
      << "material = { law = \"neo_hookean\", youngs_modulus = 6e3, poisson_ratio = 0.4, density = 1000.0 }\n"
      << "sampling = { count = 400 }\n";
  startOn(window, {imageFile("image_organ").string(), scene.string()});
  C3DE_WAIT(window, "the organ is cut by all slices",
            imageNumber(s, "axial.outlines") >= 1 && imageNumber(s, "sagittal.outlines") >= 1 &&
                imageNumber(s, "coronal.outlines") >= 1);
  // the planes would hide the organ from the mouse
  window.click("scene/" + imageFile("image_organ").filename().string());
  window.moveTo(window.inPane("3D", 0.5, 0.5));
  window.key("f");
  window.screenshot("rest");
  takePinch(window);
  window.key("space");
  window.moveTo(window.inPane("3D", 0.5, 0.5));
  window.press();
  C3DE_WAIT(window, "a surfel is held", !row(s, "Held surfel").empty() && row(s, "Held surfel") != "–");
  for (int i = 1; i <= 6; ++i) window.moveTo(window.inPane("3D", 0.5 + 0.05 * i, 0.5 - 0.04 * i));
  C3DE_WAIT(window, "the hand pulls", numberOf(s, kPanel + "Pinch force") > 0.0);
  window.waitFrames(10);
  window.screenshot("pulled");
  window.release();
  CHECK(window.differsFrom("rest", "pulled", 100));
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("implants, instruments and jaws are cut by the slices, as they move", "[image_rigid]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("image_rigid");
  std::ofstream(outputFile("image_rigid_plate.obj"))
      << "v -40 56 -20\nv -40 56 20\nv -40 64 -20\nv -40 64 20\nv 40 56 -20\nv 40 56 20\nv 40 64 -20\nv 40 64 20\n"
         "f 1 2 4\nf 1 4 3\nf 5 7 8\nf 5 8 6\nf 1 5 6\nf 1 6 2\nf 3 4 8\nf 3 8 7\nf 1 3 7\nf 1 7 5\nf 2 6 8\nf 2 8 4\n";
  const fs::path scene = outputFile("image_rigid.toml");
  std::ofstream(scene)
      << "format = 1\ntitle = \"Rigid in an image\"\n[world]\ngravity = [0.0, 0.0, 0.0]\n[solver]\ndamping = 20.0\n"
         "[[body]]\nname = \"organ\"\nmesh = \""
      << organMesh().generic_string()
      << "\"\nmesh_unit = \"mm\"\nmaterial = { youngs_modulus = 6e3, poisson_ratio = 0.4 }\n"
         "sampling = { count = 400 }\n"
         "[[attachment]]\nbodies = [\"organ\", \"surroundings\"]\nstiffness = 5e4\n"
         "[[obstacle]]\nname = \"plate\"\nmesh = \"image_rigid_plate.obj\"\nmesh_unit = \"mm\"\n"
         "[[grasp]]\nname = \"forceps\"\nat = [0, 0, 0.05]\naxis = [1, 0, 0]\njaw_mm = 30\nclosed_mm = 55\n";
  startOn(window, {imageFile("image_rigid").string(), scene.string()});
  const auto outlines = [](const std::string &pane, int count) {
    return [key = pane + ".outlines", count](const Json &s) { return imageNumber(s, key) == count; };
  };
  // Of the organ, and of the plate where its plane intersects it: it is behind the coronal one.
  window.waitUntil("organ and plate are cut", outlines("axial", 2));
  CHECK(imageNumber(window.state(), "sagittal.outlines") == 2);
  CHECK(imageNumber(window.state(), "coronal.outlines") == 1);
  window.screenshot("behind");
  window.click("scene/" + imageFile("image_rigid").filename().string());
  window.moveTo(window.inPane("3D", 0.5, 0.5));
  window.key("f");
  window.key("m");
  window.choose(kPanel + "placed", "plate");
  window.enterNumber(kPanel + "placed_z", "70");
  window.waitUntil("the plate has left the axial slice", outlines("axial", 1));
  window.enterNumber(kPanel + "placed_y", "0");
  window.waitUntil("it has come into the coronal one", outlines("coronal", 2));
  window.moveTo(window.inPane("3D", 0.9, 0.9));
  window.screenshot("moved");
  CHECK(window.differsFrom("behind", "moved", 50, "coronal"));

  // Jaws grasp at the first step.
  window.key("space");
  window.waitUntil("both jaws are cut", outlines("coronal", 4));
  // The instrument, on the far side of the organ.
  window.moveTo(window.inPane("3D", 0.5, 0.5));
  window.key("t");
  C3DE_WAIT(window, "the touch tool is active", s["tool"] == "pointbased.touch");
  window.moveTo(window.inPane("3D", 0.4, 0.5));
  window.press();
  C3DE_WAIT(window, "an instrument is there", row(s, "Contact area").ends_with("mm²"));
  window.release();
  window.enterNumber(kPanel + "touch_x", "-75");
  window.enterNumber(kPanel + "touch_z", "0");
  window.enterNumber(kPanel + "touch_y", "0");
  window.waitUntil("the instrument is cut", outlines("axial", 2));
  window.waitUntil("in both slices", outlines("coronal", 5));
  window.moveTo(window.inPane("3D", 0.9, 0.9));
  window.screenshot("all");
  CHECK(window.differsFrom("moved", "all", 20, "axial"));
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("an image moves with its body, stands where it stands and goes back with it", "[image_warp]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("image_warp");
  const std::string image = imageFile("image_warp").generic_string();
  constexpr double kSpeed_mm_s = 4.0;
  startOn(window, {flyingBlock("image_warp", image, kSpeed_mm_s).string()});
  const auto shift_mm = [](const Json &s) { return displacement_mm(s, "axial"); };
  C3DE_WAIT(window, "the image knows its displacement", shift_mm(s) == 0.0);
  window.screenshot("rest");
  window.key("space");
  C3DE_WAIT(window, "it flies", s["transport"]["time_s"] > 0.8);
  window.key("space");
  // At the end the displacement belongs to the displayed time; the read-out has two decimals.
  C3DE_WAIT(window, "it stands",
            s["transport"]["mode"] == "paused" &&
                std::abs(shift_mm(s) - kSpeed_mm_s * s["transport"]["time_s"].get<double>()) < 0.011);
  window.screenshot("flown");
  CHECK(window.differsFrom("rest", "flown", 500));

  // The displayed image can be exported, by the menu.
  const auto save = [&](const std::string &entry, const fs::path &file) {
    fs::remove(file);
    window.click("menu/file");
    C3DE_WAIT(window, "the menu is open", s["widgets"].contains("menu/" + entry));
    window.click("menu/" + entry);
    window.enterFile(file);
    C3DE_WAIT(window, "it is written", s["notifications"].size() == 1);
    CHECK(window.state()["notifications"][0]["title"] == "Exported");
    CHECK_THAT(window.state()["notifications"][0]["text"].get<std::string>(), Contains(file.filename().string()));
    window.click("notification/close.0");
    C3DE_WAIT(window, "the message is closed", s["notifications"].empty());
  };
  const fs::path seen = outputFile("image_warp_seen.nii.gz"), field = outputFile("image_warp_u.nrrd");
  save("file.export_image", seen);
  save("file.export_displacement", field);
  const auto before = imaging::readVolume(image), after = imaging::readVolume(seen);
  REQUIRE(before);
  REQUIRE(after);
  const auto middle = [](const imaging::Volume &v) {
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < v.geometry.size[2]; ++k)
      for (std::size_t j = 0; j < v.geometry.size[1]; ++j)
        for (std::size_t i = 0; i < v.geometry.size[0]; ++i) {
          // By brightness above the surroundings: faces between voxels count in part.
          const double bright = std::max(0.0, v.value(i, j, k) - v.value(0, 0, 0));
          sum +=
              bright * v.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})[0];
          count += bright;
        }
    return sum / count;
  };
  const double flown_mm = kSpeed_mm_s * window.state()["transport"]["time_s"].get<double>();
  // Voxels of 2 mm belong to the block or not: its two faces jump from one to the next, half a voxel behind and ahead
  // of the tissue in turn. Measured over 1.6 … 6.4 mm: a saw tooth of ±0.53 mm.
  CHECK(middle(after->volume) - middle(before->volume) == Approx(flown_mm).margin(0.6));
  CHECK(fs::file_size(field) > 1000);
  window.moveTo(window.inPane("3D", 0.5, 0.9));  // over a slice the key is the slice's
  window.key("ctrl+r");
  C3DE_WAIT(window, "it is back", s["transport"]["time_s"] == 0.0 && shift_mm(s) == 0.0);
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("an image follows its body far from where it began", "[image_warp_far]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("image_warp_far");
  constexpr double kSpeed_mm_s = 45.0;
  // The block extends from -30 to 30 mm. A rim of 8 mm, a spacing of about 9 mm and a margin of 9 mm: the first grid
  // ends at 56.
  const Vec3 place{65, 0, 0};
  const std::string image = imageFile("image_warp_far").generic_string();
  startOn(window, {flyingBlock("image_warp_far", image, kSpeed_mm_s).string()});
  const auto shift_mm = [](const Json &s) { return displacement_mm(s, "coronal"); };
  C3DE_WAIT(window, "the image knows its displacement", shift_mm(s) == 0.0);
  window.clickAt(pixelOf(window, "axial", place));
  C3DE_WAIT(window, "the cross-hair is there", std::abs(crossHairOf(s)[0] - place[0]) < 2.0);
  CHECK_THAT(imageText(window.state(), "coronal.readout"), Contains("   -1000"));
  window.choose("image/overlay", "|u|");
  window.waitForValue("image/overlay", "|u|");
  window.moveTo(window.inPane("3D", 0.5, 0.9));  // over a slice the keys are the slice's
  window.screenshot("rest");
  window.key("space");
  C3DE_WAIT(window, "it is far away", s["transport"]["time_s"] > 1.1);
  window.key("space");
  const Json flown =
      C3DE_WAIT(window, "it stands",
                s["transport"]["mode"] == "paused" &&
                    std::abs(shift_mm(s) - kSpeed_mm_s * s["transport"]["time_s"].get<double>()) < 0.011);
  CHECK_THAT(imageText(flown, "coronal.readout"), !Contains("   -1000"));
  window.screenshot("flown");
  CHECK(window.differsFrom("rest", "flown", 500));
  window.key("ctrl+r");
  C3DE_WAIT(window, "it is back", s["transport"]["time_s"] == 0.0 && shift_mm(s) == 0.0);
  CHECK(window.state()["notifications"].empty());
}
