// SPDX-License-Identifier: Apache-2.0
#include "ui/simulation_window.h"

#include <fstream>
#include <utility>

#include "c3de/core/platform.h"
#include "support/folders.h"
#include "ui/workstation_state.h"

namespace c3de::test {

namespace fs = std::filesystem;

fs::path organMesh() { return fs::path(testResourcesFolder()) / "meshes" / "organ.obj"; }

fs::path floatingOrgan() {
  fs::path scene = outputFile("floating.toml");
  std::ofstream(scene)
      << "format = 1\ntitle = \"Floating organ\"\n[world]\ngravity = [0.0, 0.0, 0.0]\n"
         "[solver]\ndamping = 5.0\n[[body]]\nname = \"organ\"\nmesh = \""
      << organMesh().generic_string() << "\"\nmesh_unit = \"mm\"\n"
      << "material = { law = \"neo_hookean\", youngs_modulus = 6e3, poisson_ratio = 0.4, density = 1000.0 }\n"
      << "sampling = { count = 400 }\n";
  return scene;
}

fs::path stretchedBar(const std::string &scenario, double length_m, double youngsModulus_Pa,
                      const std::string &measured) {
  std::ofstream mesh(outputFile(scenario + ".obj"));
  for (const double z : {0.0, 0.2})
    for (const auto &[x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 0.2}, {0.0, 0.2}})
      mesh << "v " << length_m * x << " " << length_m * y << " " << length_m * z << "\n";
  mesh
      << "f 1 4 3\nf 1 3 2\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 4 8 7\nf 4 7 3\nf 1 5 8\nf 1 8 4\nf 2 3 7\nf 2 7 6\n";
  fs::path scene = outputFile(scenario + ".toml");
  std::ofstream(scene) << "format = 1\ntitle = \"Stretched bar\"\n[world]\ngravity = [0, 0, 0]\n[solver]\n"
                          "integrator = \"quasistatic\"\n[[body]]\nname = \"box\"\nmesh = \""
                       << scenario << ".obj\"\nmesh_unit = \"m\"\nmaterial = { law = \"linear\", youngs_modulus = "
                       << youngsModulus_Pa
                       << ", poisson_ratio = 0, density = 1000.0 }\nsampling = { spacing = " << 0.05 * length_m
                       << " }\n[[fix]]\nregion = { box = { min = [-0.001, -1, -1], max = [0, 1, 1] } }\n"
                          "[[fix]]\nregion = { box = { min = ["
                       << length_m << ", -1, -1], max = [" << length_m + 0.001 << ", 1, 1] } }\ndisplacement = ["
                       << 0.02 * length_m << ", 0, 0]\n"
                       << measured;
  return scene;
}

std::string examplePlugin(const std::string &name) {
  return (fs::path(testExampleFolder()) / (name + pluginExtension())).string();
}

void openOrgan(WorkstationDriver &window, const std::vector<std::string> &arguments) {
  window.start(arguments);
  // Its node and its rows appear with the first snapshot and push the rows below them down.
  C3DE_WAIT(window, "the organ is shown",
            s["transport"]["exists"].get<bool>() && s["jobs"].empty() && s["nodes"].size() >= 2 &&
                !row(s, "Surfels").empty());
  window.moveTo(window.inView(0.5, 0.5));
  window.key("f");
}

void startOrgan(WorkstationDriver &window, const std::vector<std::string> &more) {
  std::vector<std::string> arguments{floatingOrgan().string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  openOrgan(window, arguments);
}

void play(WorkstationDriver &window) {
  window.key("space");
  C3DE_WAIT(window, "it plays", mode(s) == "playing" && s["transport"]["steps"] > 5);
}

Json pause(WorkstationDriver &window) {
  window.key("space");
  return C3DE_WAIT(window, "it pauses", mode(s) == "paused");
}

void takePinch(WorkstationDriver &window) {
  window.moveTo(window.inView(0.5, 0.5));
  window.key("p");
  C3DE_WAIT(window, "the pinch tool is active", s["tool"] == "pointbased.pinch");
}

Json holdSurfel(WorkstationDriver &window, const Point &at) {
  window.moveTo(at);
  window.press();
  return C3DE_WAIT(window, "a surfel is held", !row(s, "Held surfel").empty());
}

void pull(WorkstationDriver &window, const Point &from, const Point &to) {
  window.moveTo(from);
  window.press();
  window.moveAlong(from, to, 8);
}

void playAndPull(WorkstationDriver &window) {
  takePinch(window);
  play(window);
  pull(window, window.inView(0.5, 0.5), window.inView(0.65, 0.4));
  const int pulled = window.state()["transport"]["steps"];
  C3DE_WAIT(window, "the pull lasts", s["transport"]["steps"].get<int>() > pulled + 150);
  window.release();
}

}  // namespace c3de::test
