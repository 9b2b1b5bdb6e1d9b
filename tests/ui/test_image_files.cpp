// SPDX-License-Identifier: Apache-2.0
// Files that are opened as images: those that cannot be read, several at once, series of a folder, segmentations.
#include <filesystem>
#include <fstream>
#include <string>

#include "c3de/imaging/writing.h"
#include "support/catch.h"
#include "ui/image_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace fs = std::filesystem;

TEST_CASE("a file that cannot be read leads to a message, and the image stays", "[image_bad_file]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_bad_file");
  const fs::path bad = outputFile("image_bad_file_broken.nii");
  std::ofstream(bad, std::ios::binary) << "this is no image";
  startOn(window, {imageFile("image_bad_file").string(), bad.string()});
  const Json state = C3DE_WAIT(window, "the message", s["notifications"].size() == 1);
  CHECK_THAT(state["notifications"][0]["title"].get<std::string>(), Contains("image_bad_file_broken.nii"));
  CHECK(state["notifications"][0]["severity"] == "error");
  CHECK(state["panes"].size() == 4);
}

TEST_CASE("of several files each that cannot be used says why, and the others are opened", "[image_several]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_several");
  const fs::path notes = outputFile("image_several_notes.xyz"), far = outputFile("image_several_far.nrrd");
  std::ofstream(notes) << "a shopping list";
  imaging::LabelMap map;
  map.geometry = {{4, 4, 4}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 900, 0, 0, 1}};
  map.voxels.assign(64, 1);
  REQUIRE(imaging::writeLabelMap(far, map));
  startOn(window, {imageFile("image_several").string(), notes.string(), organMesh().string(), far.string()});
  const Json state = C3DE_WAIT(window, "both messages and the organ",
                               s["notifications"].size() == 2 && s["transport"]["exists"].get<bool>());
  std::string all;
  for (const Json &n : state["notifications"])
    all += n["title"].get<std::string>() + ": " + n["text"].get<std::string>() + "\n";
  CHECK_THAT(all,
             Contains("image_several_notes.xyz: is not a supported file") && Contains("does not overlap the image"));
  CHECK(state["panes"].size() == 4);
}

TEST_CASE("a folder of several series asks for one, and for none", "[image_series]") {
  C3DE_WINDOW_OR_SKIP();
  C3DE_DATA_OR_SKIP(folder, "dicom/mr_mixed_orientation_4");
  WorkstationDriver window("image_series");
  window.start({folder.string()});
  const auto isAsked = [](const Json &s) { return s["jobs"].empty() && s["widgets"].contains("series/series.1"); };
  window.waitUntil("a series is asked for", isAsked);
  CHECK(window.state()["panes"].empty());
  // In the view, where the picture is going to be, and no other request is shown there.
  const Json asked = window.state();
  CHECK(asked["widgets"]["series/series.1"][0].get<double>() > asked["area"]["x"].get<double>());
  window.screenshot("asked");
  window.click("series/series.1");
  C3DE_WAIT(window, "the series is shown", s["panes"].size() == 4 && s["jobs"].empty());
  CHECK_FALSE(window.state()["widgets"].contains("series/series.0"));

  WorkstationDriver other("image_series_none");
  other.start({folder.string()});
  other.waitUntil("a series is asked for", isAsked);
  other.click("series/cancel");
  C3DE_WAIT(other, "the question is gone", !s["widgets"].contains("series/series.1"));
  CHECK(other.state()["panes"].empty());
}

TEST_CASE("a segmentation that is opened as an image is a label map", "[image_segmentation]") {
  C3DE_WINDOW_OR_SKIP();
  C3DE_DATA_OR_SKIP(segments, "dicom/ct_3slice_plus_seg/liver.dcm");
  C3DE_DATA_OR_SKIP(scan, "dicom/ct_3slice_plus_seg/01.dcm");
  // Alone: over its own numbers.
  for (const fs::path &file : {segments, labelFile("image_segmentation", ".seg.nrrd")}) {
    WorkstationDriver alone("image_segmentation" + file.extension().string());
    alone.start({file.string()});
    const Json state = C3DE_WAIT(alone, "its labels are there",
                                 s["panes"].size() == 4 && s["jobs"].empty() && !imageText(s, "Label map").empty());
    CHECK(imageText(state, "Label map") == file.filename().string());
    std::string all;
    for (const Json &n : state["notifications"]) all += n["text"].get<std::string>() + "\n";
    CHECK_THAT(all, Contains("Its segments lie over its numbers as labels"));
  }
  // Over a scan, which remains.
  WorkstationDriver window("image_segmentation_scan");
  startOn(window, {scan.string()});
  const std::string shown = imageText(window.state(), "Image");
  window.key("ctrl+i");
  C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("dialog/path"));
  window.click("dialog/path");
  window.key("ctrl+a");
  window.type(segments.string());
  window.key("Return");
  const Json state = C3DE_WAIT(window, "its labels are there", s["jobs"].empty() && !imageText(s, "Label map").empty());
  CHECK(imageText(state, "Image") == shown);
  CHECK(imageText(state, "Label map") == "liver.dcm");
  std::string all;
  for (const Json &n : state["notifications"]) all += n["text"].get<std::string>() + "\n";
  CHECK_THAT(all, Contains("lie over the image that is open, as labels"));
}
