// SPDX-License-Identifier: Apache-2.0
// Windows that simulate with the point-based plugin: an organ is opened, plays, is pulled.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ui/workstation_driver.h"

namespace c3de::test {

std::filesystem::path organMesh();
/// A scene of an organ that only the user moves.
std::filesystem::path floatingOrgan();
/// A scene of a bar along x that is stretched by 2 %. Without lateral contraction the displacement is 0.02 x, exactly.
/// @param measured  tables of landmarks and distances
std::filesystem::path stretchedBar(const std::string &scenario, double length_m, double youngsModulus_Pa,
                                   const std::string &measured);
/// The file of a plugin of plugins/, for --plugin.
std::string examplePlugin(const std::string &name);

/// Starts, waits until the body is shown, and fits it into the view.
void openOrgan(WorkstationDriver &window, const std::vector<std::string> &arguments);
/// The same with the floating organ.
void startOrgan(WorkstationDriver &window, const std::vector<std::string> &more = {});

/// By its key.
void play(WorkstationDriver &window);
Json pause(WorkstationDriver &window);
/// With the mouse in the middle of the 3D view.
void takePinch(WorkstationDriver &window);
/// Presses there, with a tool that holds a surfel.
Json holdSurfel(WorkstationDriver &window, const Point &at);
/// The button stays pressed.
void pull(WorkstationDriver &window, const Point &from, const Point &to);
/// Plays, pulls the middle of the view for at least 150 steps, and releases it.
void playAndPull(WorkstationDriver &window);

}  // namespace c3de::test
