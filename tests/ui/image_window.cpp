// SPDX-License-Identifier: Apache-2.0
#include "ui/image_window.h"

#include "c3de/imaging/writing.h"
#include "support/catch.h"
#include "ui/workstation_state.h"
#include "unit/render/phantom.h"

namespace c3de::test {
namespace {

using render::test::Phantom;

Phantom phantom() {
  return render::test::makePhantom({80, 90, 50}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, -79, -89, -73.5, 1});
}

}  // namespace

std::filesystem::path imageFile(const std::string &scenario) {
  const Phantom p = phantom();
  imaging::Volume volume;
  volume.geometry = {p.size, p.worldFromIndex};
  volume.voxels = p.voxels;
  std::filesystem::path file = outputFile(scenario + "_phantom.nii.gz");
  if (const auto written = imaging::writeVolume(file, volume); !written) FAIL(written.error().message);
  return file;
}

std::filesystem::path labelFile(const std::string &scenario, const std::string &extension) {
  const Phantom p = phantom();
  imaging::LabelMap map;
  map.geometry = {p.size, p.worldFromIndex};
  map.voxels = p.labels;
  map.labels = {{1, "block", {0.1f, 0.6f, 0.1f}}, {2, "letters", {1.0f, 0.2f, 0.1f}}};
  std::filesystem::path file = outputFile(scenario + "_labels" + extension);
  if (const auto written = imaging::writeLabelMap(file, map); !written) FAIL(written.error().message);
  return file;
}

void startOn(WorkstationDriver &window, const std::vector<std::string> &files) {
  window.start(files);
  C3DE_WAIT(window, "the image is shown", s["panes"].size() == 4 && s["jobs"].empty());
}

void startWithLabels(WorkstationDriver &window, const std::string &scenario) {
  startOn(window, {imageFile(scenario).string(), labelFile(scenario).string()});
  C3DE_WAIT(window, "the labels are there", s["jobs"].empty() && !imageText(s, "Label map").empty());
}

Vec3 crossHairOf(const Json &state) { return vectorOf(state, "image/cross_hair"); }

Point pixelOf(const WorkstationDriver &window, const std::string &pane, const Vec3 &world) {
  return window.inSlice(pane, pane == "sagittal" ? world[1] : world[0], pane == "axial" ? world[1] : -world[2]);
}

}  // namespace c3de::test
