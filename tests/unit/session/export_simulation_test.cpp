// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/export_simulation.h"

#include <fstream>
#include <sstream>

#include "box_mesh.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::session;
namespace fs = std::filesystem;
using session::test::boxMesh;

namespace {

std::string textOf(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// @param onlyHere  the name of an array that other bodies lack; empty: none
BodyState state(const std::string &name, const std::string &onlyHere = {}) {
  BodyState body;
  body.name = name;
  body.skin = boxMesh({0, 0, 0}, {1, 1, 1});
  body.skinArrays = {{"displacement [mm]", 3, std::vector<double>(24, 0.0)}};
  if (!onlyHere.empty()) body.skinArrays.push_back({onlyHere, 1, std::vector<double>(8, 1.0)});
  body.inside.points = {{0, 0, 0}, {1, 1, 1}};
  body.inside.arrays = {{"mass [kg]", 1, {1.0, 2.0}}};
  return body;
}

}  // namespace

TEST_CASE("Frames of a list lie in a folder of its name") {
  CHECK(framesFolder("out/run.pvd") == fs::path("out/run_frames"));
  CHECK(framesFolder("a.b/run.1.pvd") == fs::path("a.b/run.1_frames"));
}

TEST_CASE("Surfaces of several bodies have their names, each a file of its own on every system") {
  const std::vector<std::string> one{"liver"}, several{"liver", "spleen", "liver", "a/b:c", "", "liver"};
  CHECK(surfaceFiles("out/s.obj", one) == std::vector<fs::path>{"out/s.obj"});
  CHECK(surfaceFiles("out/s.obj", {}) == std::vector<fs::path>{"out/s.obj"});
  CHECK(surfaceFiles("out/s.obj", several) == std::vector<fs::path>{"out/s-liver.obj", "out/s-spleen.obj",
                                                                    "out/s-liver-2.obj", "out/s-a_b_c.obj",
                                                                    "out/s-body.obj", "out/s-liver-3.obj"});
}

TEST_CASE("Whether a sequence can be written is known before, and nothing is left behind") {
  const fs::path folder = testOutputFolder();
  CHECK(checkSimulationExport(folder / "run.pvd"));
  CHECK(fs::is_empty(folder));
  const auto kind = checkSimulationExport(folder / "run.vtk");
  REQUIRE_FALSE(kind);
  CHECK(kind.error().code == ErrorCode::usage);
  CHECK_THAT(kind.error().message, Contains("run.vtk") && Contains("'.vtk'") && Contains("accepted: .pvd"));
  const auto nowhere = checkSimulationExport(folder / "nowhere" / "run.pvd");
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().code == ErrorCode::output);
  std::ofstream(folder / "run_frames") << "a file";
  const auto blocked = checkSimulationExport(folder / "run.pvd");
  REQUIRE_FALSE(blocked);
  CHECK(blocked.error().code == ErrorCode::output);
  CHECK_THAT(blocked.error().message, Contains("run_frames: is a file, where a folder"));
  fs::remove(folder / "run_frames");
  fs::create_directories(folder / "run_frames" / "skin_000000.vtp");
  CHECK_FALSE(checkSimulationExport(folder / "run.pvd"));
  fs::remove_all(folder / "run_frames");
}

TEST_CASE("A frame has all bodies, told apart by a number, with the arrays that all of them have") {
  const fs::path folder = testOutputFolder(), frames = folder / "run_frames";
  fs::remove_all(frames);
  {
    SimulationExport exported(folder / "run.pvd");
    REQUIRE(exported.addFrame(0.0, {state("liver", "only [1]"), state("spleen")}));
    REQUIRE(exported.addFrame(0.25, {state("liver"), state("spleen")}));
    REQUIRE(exported.finish());
  }
  const std::string list = textOf(folder / "run.pvd");
  CHECK_THAT(list, Contains("timestep=\"0.25\"") && Contains("run_frames/skin_000001.vtp") &&
                       Contains("run_frames/points_000000.vtu"));
  const std::string skin = textOf(frames / "skin_000000.vtp"), points = textOf(frames / "points_000001.vtu");
  CHECK_THAT(skin, Contains("bodies: 0 = liver, 1 = spleen") && Contains("NumberOfPoints=\"16\"") &&
                       Contains("NumberOfPolys=\"24\"") && Contains("Name=\"displacement [mm]\"") &&
                       Contains("Name=\"body\"") && !Contains("only [1]"));
  CHECK_THAT(points, Contains("NumberOfPoints=\"4\"") && Contains("Name=\"mass [kg]\"") && Contains("Name=\"body\""));
}

TEST_CASE("What was written before a sequence broke off is listed") {
  const fs::path folder = testOutputFolder();
  fs::remove(folder / "run.pvd");
  {
    SimulationExport exported(folder / "run.pvd");
    REQUIRE(exported.addFrame(0.0, {state("liver")}));
    REQUIRE(exported.addFrame(0.5, {state("liver")}));
    const auto none = exported.addFrame(1.0, {});
    REQUIRE_FALSE(none);
    CHECK(none.error().code == ErrorCode::state);
    CHECK_THAT(none.error().message, Contains("run.pvd: not written: there is no body"));
  }
  CHECK_THAT(textOf(folder / "run.pvd"), Contains("timestep=\"0.5\"") && !Contains("timestep=\"1\""));
}

TEST_CASE("A skin that cannot be written is told and does not keep the others from being written") {
  const fs::path folder = testOutputFolder();
  fs::remove(folder / "s-liver.obj");
  fs::remove(folder / "s-points.obj");
  BodyState points = state("points");
  points.skin.triangles.clear();
  std::vector<std::pair<std::string, bool>> told;
  std::vector<Error> errors;
  const auto tell = [&](const fs::path &file, const Expected<void> &result) {
    told.emplace_back(file.filename().string(), result.has_value());
    if (!result) errors.push_back(result.error());
  };
  const geometry::MeshFormats formats;
  writeSurfaces(formats, folder / "s.obj", {points, state("liver")}, tell);
  CHECK(told == std::vector<std::pair<std::string, bool>>{{"s-points.obj", false}, {"s-liver.obj", true}});
  REQUIRE(errors.size() == 1);
  CHECK(errors[0].code == ErrorCode::state);
  CHECK(fs::exists(folder / "s-liver.obj"));
  CHECK_FALSE(fs::exists(folder / "s-points.obj"));
  writeSurfaces(formats, folder / "s.obj", {}, tell);
  REQUIRE(errors.size() == 2);
  CHECK(errors[1].code == ErrorCode::state);
  CHECK_THAT(errors[1].message, Contains("s.obj: not written: there is no body"));
}

TEST_CASE("A surface is checked by its extension and the files of all bodies") {
  const fs::path folder = testOutputFolder();
  const std::vector<std::string> names{"liver", "spleen"};
  CHECK(checkSurfaceExport(geometry::MeshFormats(), folder / "s.stl", names));
  const auto kind = checkSurfaceExport(geometry::MeshFormats(), folder / "s.txt", names);
  REQUIRE_FALSE(kind);
  CHECK(kind.error().code == ErrorCode::usage);
  CHECK_THAT(kind.error().message, Contains(".obj") && Contains(".vtp"));
  fs::create_directories(folder / "s-spleen.stl");
  const auto taken = checkSurfaceExport(geometry::MeshFormats(), folder / "s.stl", names);
  REQUIRE_FALSE(taken);
  CHECK_THAT(taken.error().message, Contains("s-spleen.stl"));
  fs::remove(folder / "s-spleen.stl");
}
