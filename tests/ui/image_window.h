// SPDX-License-Identifier: Apache-2.0
// Windows on the image of a phantom and its labels.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "c3de/core/vec.h"
#include "ui/workstation_driver.h"

namespace c3de::test {

/// Of 80 x 90 x 50 voxels of 2 x 2 x 3 mm around the origin: letters L, A, S on a block of 60 mm. Each scenario has its
/// own files, since scenarios run concurrently.
std::filesystem::path imageFile(const std::string &scenario);
std::filesystem::path labelFile(const std::string &scenario, const std::string &extension = ".nii.gz");

/// Starts and waits until the image is shown.
void startOn(WorkstationDriver &window, const std::vector<std::string> &files);
/// The same with the image and the labels of a scenario.
void startWithLabels(WorkstationDriver &window, const std::string &scenario);

[[nodiscard]] Vec3 crossHairOf(const Json &state);
/// Position of a world point in a slice of an image along the axes.
[[nodiscard]] Point pixelOf(const WorkstationDriver &window, const std::string &pane, const Vec3 &world);

}  // namespace c3de::test
