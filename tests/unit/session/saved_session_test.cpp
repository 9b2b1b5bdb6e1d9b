// SPDX-License-Identifier: Apache-2.0
// What a simulation was built from, and its session: scenes, voxels in memory, changes in order.
#include "c3de/session/saved_session.h"

#include <fstream>

#include "c3de/session/body_creation.h"
#include "files/mask_bytes.h"
#include "support/catch.h"
#include "support/folders.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using namespace c3de::test;
namespace fs = std::filesystem;

namespace {

imaging::Mask cube() {
  imaging::Mask mask;
  mask.geometry = {{7, 5, 6}, {0.1, 0, 0, 0, 0, 2.0 / 3.0, 0, 0, 0, 0, 2, 0, 1e-17, -3, 1.0 / 7.0, 1}};
  mask.voxels.assign(mask.geometry.voxelCount(), 0);
  for (std::size_t k = 1; k < 5; ++k)
    for (std::size_t j = 1; j < 4; ++j)
      for (std::size_t i = 1; i < 6; ++i) mask.voxels[i + 7 * (j + 5 * k)] = 1;
  return mask;
}

SharedScene sceneOfCube(const std::string &name) {
  segmentation::BodyRequest request;
  request.name = name;
  scene::SceneFile scene = sceneOf(request, cube(), nullptr);
  scene.bodies.front().volume.colour = std::array<float, 3>{0.25f, 0.5f, 1.0f / 3.0f};
  return std::make_shared<const scene::SceneFile>(std::move(scene));
}

/// A session without plugins whose simulator reports changes.
struct Fixture {
  RecordingSimulator simulator;
  std::unique_ptr<Session> session;
  SimulatorIdentity identity{"test.simulator/1", "", "test", "1"};

  Fixture() {
    simulator.hasChanges = simulator.hasStates = simulator.hashesState = true;
    simulator.bodyIds = {"surroundings.stiffness"};
    SessionOptions options;
    options.searchPlugins = false;
    options.threads = 1;
    session = std::move(*Session::create(options));
  }
  SessionFile saved(const fs::path &folder) {
    const auto captured = captureState(*session, simulator.object(), identity, session->changes()->source());
    if (!captured) FAIL(captured.error().message);
    FileReferences references;
    auto file = sessionOf(*captured, folder, references);
    if (!file) FAIL(file.error().message);
    file->savedAt.clear();
    return std::move(*file);
  }
};

std::string bytesOf(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> textsOf(const SimulationSource &source) {
  std::vector<std::string> texts;
  for (const auto &entry : source) {
    const auto *change = std::get_if<SimulationChange>(&entry);
    texts.push_back(change ? change->text : "scene " + std::get<SharedScene>(entry)->bodies.front().name);
  }
  return texts;
}

}  // namespace

TEST_CASE("Scenes, voxels in memory and changes of a session are those of the simulation, in their order") {
  const fs::path folder = testOutputFolder(), file = folder / "a.c3de";
  Fixture first;
  REQUIRE(first.session->adoptForRun(first.simulator.object(), "test", {sceneOfCube("liver")}));
  first.simulator.change("stiffer");
  first.simulator.change("pull", C3DE_SIM_CHANGE_TRANSIENT);
  first.session->changes()->addScene(sceneOfCube("spleen"));
  first.simulator.change("implant");
  const std::vector<std::string> expected{"scene liver", "add stiffer", "scene spleen", "add implant"};
  CHECK(textsOf(first.session->changes()->source()) == expected);
  REQUIRE(writeSession(first.saved(folder), file));

  const auto read = readSession(file);
  REQUIRE(read);
  CHECK(read->title == "liver");
  const auto files = filesOfSession(*read, file);
  REQUIRE(files);
  const auto source = sourceOfSession(*read, file, *files, nullptr);
  if (!source) FAIL(source.error().message);
  CHECK(textsOf(*source) == expected);
  for (const std::size_t scene : {0u, 2u}) {
    const scene::SceneVolume &volume = std::get<SharedScene>((*source)[scene])->bodies.front().volume;
    REQUIRE(volume.mask);
    CHECK(volume.file.empty());
    CHECK(volume.mask->geometry.indexToWorld == cube().geometry.indexToWorld);
    CHECK(volume.mask->voxels == cube().voxels);
    CHECK(volume.colour == std::array<float, 3>{0.25f, 0.5f, 1.0f / 3.0f});
  }

  // Built again, it saves the same bytes.
  Fixture second;
  if (const auto built = buildRemaining(*second.session, second.simulator.object(), *source, {}, nullptr); !built)
    FAIL(built.error().message);
  REQUIRE(restoreSession(*second.session, second.simulator.object(), second.identity, *read, file));
  REQUIRE(second.session->adoptForRun(second.simulator.object(), "test", *source));
  REQUIRE(writeSession(second.saved(folder), folder / "b.c3de"));
  CHECK(bytesOf(folder / "a.c3de") == bytesOf(folder / "b.c3de"));
}

TEST_CASE("A later change replaces an earlier one of its key, unless a scene or a reset lies between them") {
  Fixture f;
  REQUIRE(f.session->adoptForRun(f.simulator.object(), "test", {sceneOfCube("liver")}));
  ChangeLog &log = *f.session->changes();
  const auto report = [&](const char *text, const char *key, std::uint32_t flags) {
    f.simulator.change(text, flags, key);
  };
  report("gravity 1", "gravity", 0);
  report("density 1", "density", 0);
  report("gravity 2", "gravity", 0);
  CHECK(textsOf(log.source()) == std::vector<std::string>{"scene liver", "add density 1", "add gravity 2"});
  report("rebuild", "", C3DE_SIM_CHANGE_RESETS);
  report("gravity 3", "gravity", 0);
  report("density 2", "density", 0);
  CHECK(textsOf(log.source()) == std::vector<std::string>{"scene liver", "add density 1", "add gravity 2",
                                                          "add rebuild", "add gravity 3", "add density 2"});
  log.addScene(sceneOfCube("spleen"));
  report("gravity 4", "gravity", 0);
  CHECK(log.source().size() == 8);
  CHECK(log.count() == 8);
}

TEST_CASE("Damaged voxels of a session are refused") {
  const std::string good = maskBytes(cube(), {});
  REQUIRE(maskOfBytes(good));
  CHECK_FALSE(maskOfBytes(good)->colour);
  for (std::size_t size = 0; size < good.size(); ++size) CHECK_FALSE(maskOfBytes(good.substr(0, size)));
  CHECK_FALSE(maskOfBytes(good + "x"));
  for (std::size_t byte = 12; byte < 36; ++byte) {  // the size of the grid
    std::string changed = good;
    changed[byte] = static_cast<char>(0xff);
    CHECK_FALSE(maskOfBytes(changed));
  }
}
