// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "c3de/session/session_file.h"
#include "support/catch.h"

namespace c3de::test {

inline std::string textIn(const std::filesystem::path &file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline std::filesystem::path write(const std::filesystem::path &file, const std::string &text) {
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

inline std::filesystem::path emptyFolder() {
  std::filesystem::path folder = testOutputFolder();
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

/// A session that uses every key.
inline session::SessionFile fullSession() {
  session::SessionFile file;
  file.program = "c3de 0.1.0";
  file.savedAt = "2026-11-28T10:46:27Z";
  file.title = "Liver, arm up – première";
  file.simulatorClass = "org.c3de.pointbased.World";
  file.scenes = {"format = 1\n[[body]]\nname = \"liver\"\n", "", "format = 1\r\n# a second one\n"};
  file.overrides = {"solver.dt=1e-3", "body.liver.material.youngs_modulus=6e3"};
  const std::string embedded(64, 'e');
  file.files = {{"../scans/ct.nii.gz", std::string(64, 'a'), 123456789012ull, false},
                {"/data/series/", std::string(64, '0'), 0, false},
                {"meshes/liver.obj", embedded, 4, true},
                {"mr/", std::string(64, 'd'), 2, true}};
  file.view.image = "../scans/ct.nii.gz";
  file.view.labels = {"labels/drawn.nii.gz", "other.nrrd"};
  file.view.series = "1.2.840.7";
  file.view.time = 3;
  file.view.crossHair_mm = Vec3{1.5, -2.25, 0.1};
  file.view.window = 350.0;
  file.view.level = -1.0 / 3.0;
  file.view.camera = {{1.0, 2.0, 3.0}, 0.6, -1.2, 512.25};
  file.view.comparison = session::SavedComparison{"follow-up.nrrd",
                                                  "1.2.840.8",
                                                  1,
                                                  {1.25, -2.5, 1.0 / 3.0},
                                                  {10, -20, 170},
                                                  {4, 5, 6},
                                                  true,
                                                  true,
                                                  0.3,
                                                  12.5,
                                                  80.0,
                                                  40.0};
  file.view.match = session::SavedMatch{.body = "liver",
                                        .points = "/scans/points.csv",
                                        .surface = "/scans/surface.ply",
                                        .labels = "/scans/labels.nrrd",
                                        .landmarks = "/scans/landmarks.csv",
                                        .time = 2,
                                        .source = "labels",
                                        .server = "tracker:18944",
                                        .tool = "Stylus",
                                        .toolPoints = 90,
                                        .label = "3",
                                        .unit = "cm",
                                        .noise_mm = 2.5,
                                        .landmarkWeight = 20.0,
                                        .fitsLandmarks = true,
                                        .isRigidFirst = false,
                                        .deforms = false};
  file.view.selection = {"selection.mask", {5, 65535}, "kidney left", -12.5, 300.0};
  file.members["selection.mask"] = "voxels";
  file.stateHash = 0xfedcba9876543210ull;
  file.steps = 18446744073709551615ull;
  file.time_s = 0.1 + 0.2;
  for (int i = 0; i < 5000; ++i) file.state += static_cast<char>(i * i % 251);
  file.members["labels/drawn.nii.gz"] = std::string("\0\x1f\x8b\xff", 4);
  file.members["thumbnails/3d.png"] = "";
  file.members["plugins/org.example.x"] = "private";
  file.members["files/" + embedded + "/liver.obj"] = "v 1\n";
  file.members["files/" + std::string(64, 'd') + "/mr/IM0001"] = "IM";
  file.members["a member of another program.txt"] = std::string(100000, 'x');
  return file;
}

/// What reading such a file refuses it for.
inline std::string refusal(const std::filesystem::path &file) {
  const auto read = session::readSession(file);
  if (read) return "";
  CHECK(read.error().code == ErrorCode::input);
  CHECK_THAT(read.error().message, Contains(file.filename().string() + ": "));
  return read.error().message;
}

}  // namespace c3de::test
