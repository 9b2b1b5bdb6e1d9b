// SPDX-License-Identifier: Apache-2.0
// From a scan and its labels to one body of all labelled tissues, by the dialog of the window.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

namespace c3de::test {

struct ScanFiles {
  std::filesystem::path image, labels;
};

/// An ellipsoid with a label, LPS in mm, with its value in HU.
struct ScannedOrgan {
  std::string name;
  std::array<double, 3> middle, halfAxes;
  int value;
  std::array<float, 3> colour;
};

std::vector<ScannedOrgan> threeOrgans(const std::array<std::string, 3> &names = {"liver", "kidney_left",
                                                                                 "vertebrae_L1"});
/// A trunk: fat with organs in it, an ellipse of 220 x 140 mm that is 100 mm high, on a separate table.
ScanFiles writeScan(const std::string &name, const std::vector<ScannedOrgan> &organs, double spacing_mm = 4.0);

/// Opens them, and the dialog that creates a body.
void openDialog(WorkstationDriver &window, const ScanFiles &files);
/// The material of a label in the dialog.
void chooseTissue(WorkstationDriver &window, const std::string &label, const std::string &tissue);
void typeInto(WorkstationDriver &window, const std::string &field, const std::string &text);
void setPoints(WorkstationDriver &window, const std::string &count);
/// Waits until it plays, too.
Json createBody(WorkstationDriver &window);
/// The same from a scan of three organs, with so many points.
Json createBodyFromScan(WorkstationDriver &window, const std::string &name, const std::string &points);

/// The displacement in the read-out of a slice.
[[nodiscard]] bool isOver(const Json &state, const std::string &pane, double millimetres);
/// The number after the n-th of these words; NaN: not found.
[[nodiscard]] double numberAfter(const std::string &text, const std::string &words, int n = 1);

/// The file written by an item of the menu "File".
std::filesystem::path exported(WorkstationDriver &window, const std::string &item, const std::string &name);
/// The table entry of each label: its displacement, mm, and its smallest det F.
struct TissueMotion {
  double mean_mm, largest_mm, leastRatio;
};
std::map<std::string, TissueMotion> exportTissues(WorkstationDriver &window, const std::string &name);

}  // namespace c3de::test
