// SPDX-License-Identifier: Apache-2.0
#include "ui/scan_window.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <utility>

#include "c3de/imaging/writing.h"
#include "support/catch.h"

namespace c3de::test {

namespace fs = std::filesystem;

std::vector<ScannedOrgan> threeOrgans(const std::array<std::string, 3> &names) {
  return {{names[0], {-45, -10, 0}, {48, 40, 38}, 100, {0.6f, 0.2f, 0.1f}},
          {names[1], {50, 22, 0}, {22, 22, 36}, 160, {0.2f, 0.5f, 0.8f}},
          {names[2], {0, 40, 0}, {18, 18, 1e9}, 500, {0.9f, 0.9f, 0.6f}}};
}

ScanFiles writeScan(const std::string &name, const std::vector<ScannedOrgan> &organs, double spacing_mm) {
  const auto along = [&](double millimetres) { return static_cast<std::size_t>(std::ceil(millimetres / spacing_mm)); };
  const std::array<std::size_t, 3> n{along(256), along(192), along(120)};
  std::array<double, 3> first{};
  for (std::size_t a = 0; a < 3; ++a) first[a] = -0.5 * spacing_mm * static_cast<double>(n[a] - 1);
  imaging::Volume volume;
  volume.geometry = {n,
                     {spacing_mm, 0, 0, 0, 0, spacing_mm, 0, 0, 0, 0, spacing_mm, 0, first[0], first[1], first[2], 1}};
  volume.unit = "HU";
  imaging::LabelMap map;
  map.geometry = volume.geometry;
  for (std::size_t o = 0; o < organs.size(); ++o)
    map.labels.push_back({static_cast<std::uint16_t>(o + 1), organs[o].name, organs[o].colour});
  std::vector<std::int16_t> values;
  std::uint32_t noise = 1;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i) {
        const std::array<double, 3> at{first[0] + spacing_mm * static_cast<double>(i),
                                       first[1] + spacing_mm * static_cast<double>(j),
                                       first[2] + spacing_mm * static_cast<double>(k)};
        const auto isWithin = [&](const std::array<double, 3> &middle, const std::array<double, 3> &halfAxes) {
          double sum = 0.0;
          for (std::size_t a = 0; a < 3; ++a) sum += std::pow((at[a] - middle[a]) / halfAxes[a], 2.0);
          return sum <= 1.0;
        };
        const bool isHigh = std::abs(at[2]) < 50;
        const bool isBody = isHigh && isWithin({0, 0, 0}, {110, 70, 1e9});
        int value = isBody ? -90 : isHigh && at[1] > 82 && at[1] < 90 ? 30 : -1000;
        std::uint16_t label = 0;
        for (std::size_t o = 0; isBody && o < organs.size(); ++o)
          if (isWithin(organs[o].middle, organs[o].halfAxes)) {
            value = organs[o].value;
            label = static_cast<std::uint16_t>(o + 1);
          }
        // Noise, so that the motion of the tissue is visible.
        noise = noise * 1664525u + 1013904223u;
        values.push_back(static_cast<std::int16_t>(value + static_cast<int>(noise >> 26) - 32));
        map.voxels.push_back(label);
      }
  volume.voxels = std::move(values);
  ScanFiles files{outputFile(name + ".nii.gz"), outputFile(name + "_labels.nrrd")};
  if (const auto written = imaging::writeVolume(files.image, volume); !written) FAIL(written.error().message);
  if (const auto written = imaging::writeLabelMap(files.labels, map); !written) FAIL(written.error().message);
  return files;
}

bool isOver(const Json &state, const std::string &pane, double millimetres) {
  return displacement_mm(state, pane) > millimetres;
}

double numberAfter(const std::string &text, const std::string &words, int n) {
  std::size_t at = 0;
  for (int i = 0; i < n; ++i) {
    at = text.find(words, at);
    if (at == std::string::npos) return std::nan("");
    at += words.size();
  }
  return std::strtod(text.c_str() + at, nullptr);
}

void openDialog(WorkstationDriver &window, const ScanFiles &files) {
  window.start({files.image.string(), files.labels.string()});
  C3DE_WAIT(window, "image and labels are there",
            s["panes"].size() == 4 && s["jobs"].empty() && s["widgets"].contains("segmentation/create_scan_body"));
  window.clickMenu("file.create_scan_body");
  C3DE_WAIT(window, "the labels are measured",
            s["widgets"].contains("scan/make") && textOf(s, "scan/reason").find("measured") == std::string::npos);
}

void chooseTissue(WorkstationDriver &window, const std::string &label, const std::string &tissue) {
  window.choose("scan/use." + label, tissue);
  window.waitForValue("scan/use." + label, tissue);
}

void typeInto(WorkstationDriver &window, const std::string &field, const std::string &text) {
  window.click("scan/" + field);
  window.key("ctrl+a");
  if (text.empty())
    window.key("BackSpace");
  else
    window.type(text);
}

Json createBody(WorkstationDriver &window) {
  window.click("scan/make");
  return C3DE_WAIT(window, "the body is there and plays",
                   s["jobs"].empty() && s["transport"]["mode"] == "playing" && s["transport"]["steps"].get<int>() > 3 &&
                       numberOf(s, "image/axial.outlines") > 0);
}

void setPoints(WorkstationDriver &window, const std::string &count) {
  typeInto(window, "points", count);
  window.key("Tab");
  window.waitForValue("scan/points", count);
}

Json createBodyFromScan(WorkstationDriver &window, const std::string &name, const std::string &points) {
  openDialog(window, writeScan(name, threeOrgans()));
  setPoints(window, points);
  return createBody(window);
}

fs::path exported(WorkstationDriver &window, const std::string &item, const std::string &name) {
  fs::path file = outputFile(name);
  fs::remove(file);
  window.clickMenu("file." + item);
  window.openFile(file, 10);
  C3DE_WAIT(window, "it is written", s["jobs"].empty() && fs::exists(file));
  return file;
}

std::map<std::string, TissueMotion> exportTissues(WorkstationDriver &window, const std::string &name) {
  std::map<std::string, TissueMotion> motions;
  std::ifstream file(exported(window, "export_tissues", name + ".csv"));
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    const std::size_t begin = line.find(',', line.find(',') + 1) + 1;
    motions[line.substr(begin, line.find(',', begin) - begin)] = {
        1e3 * numberAfter(line, ",", 9), 1e3 * numberAfter(line, ",", 10), numberAfter(line, ",", 11)};
  }
  return motions;
}

}  // namespace c3de::test
