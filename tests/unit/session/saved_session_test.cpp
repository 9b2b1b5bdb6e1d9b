// SPDX-License-Identifier: Apache-2.0
// What a simulation was built from, and its session: scenes, voxels in memory, changes in order.
#include "c3de/session/saved_session.h"

#include <fstream>

#include "c3de/session/body_creation.h"
#include "files/mask_bytes.h"
#include "support/catch.h"
#include "support/environment.h"
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

namespace {

/// Liver as voxels, a tetrahedron as an embedded mesh, an added spleen, two changes, a state, a view, and what this
/// version does not know.
void writeSample(const fs::path &file) {
  const fs::path folder = file.parent_path();
  std::ofstream(folder / "tetrahedron.obj")
      << "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  scene::SceneFile first = *sceneOfCube("liver");
  first.title = "Kept sample";
  first.bodies.emplace_back();
  first.bodies.back().name = "tumour";
  first.bodies.back().mesh = folder / "tetrahedron.obj";
  first.bodies.back().meshUnit = geometry::LengthUnit::millimetre;
  Fixture f;
  REQUIRE(f.session->adoptForRun(f.simulator.object(), "test", {std::make_shared<const scene::SceneFile>(first)}));
  f.simulator.change("stiffer");
  f.session->changes()->addScene(sceneOfCube("spleen"));
  f.simulator.change("implant");
  const auto captured = captureState(*f.session, f.simulator.object(), f.identity, f.session->changes()->source());
  REQUIRE(captured);
  FileReferences references;
  auto saved = sessionOf(*captured, folder, references, {}, Embedding::all);
  if (!saved) FAIL(saved.error().message);
  saved->view.crossHair_mm = Vec3{1.0, 2.0, 3.0};
  saved->view.camera = SessionView::CameraPose{{4.0, 5.0, 6.0}, 0.5, -0.25, 300.0};
  saved->members["plugins/org.example.x"] = "private";
  saved->members["later/x"] = "member of a later version";
  saved->unknown["/later"] = R"({"a":[1,2.5,null]})";
  saved->unknown["/view/zoom"] = "2";
  saved
      ->unknown["/files/" + std::string(saved->files.front().path).replace(5, 1, "~1").replace(71, 1, "~1") + "/kind"] =
      R"("tumour")";
  REQUIRE(writeSession(*saved, file));
}

}  // namespace

// Written once, with the first version that had embedded files: the next case opens what it wrote then.
TEST_CASE("Write the sample of this version", "[.sample]") { writeSample(testOutputFolder() / "session-1.c3de"); }

TEST_CASE("A session of format 1 that was kept is opened, and saved again with all that is in it") {
  const fs::path folder = testOutputFolder(), file = folder / "kept.c3de";
  const ScopedEnvironment home("C3DE_HOME", (folder / "home").string());
  fs::remove(file);
  fs::copy_file(fs::path(C3DE_KEPT_SESSIONS) / "session-1.c3de", file);
  const auto read = readSession(file, EmbeddedContent::stays);
  if (!read) FAIL(read.error().message);
  CHECK(read->title == "Kept sample");
  CHECK(read->simulatorClass == "test.simulator/1");
  CHECK(read->scenes.size() == 2);
  CHECK(read->view.crossHair_mm == Vec3{1.0, 2.0, 3.0});
  CHECK(read->view.camera == SessionView::CameraPose{{4.0, 5.0, 6.0}, 0.5, -0.25, 300.0});
  CHECK(read->unknown.size() == 3);
  CHECK_FALSE(read->state.empty());

  const auto files = filesOfSession(*read, file);
  if (!files) FAIL(files.error().message);
  REQUIRE(files->size() == 1);
  CHECK(bytesOf(files->front().at).starts_with("v 0 0 0\n"));
  const auto source = sourceOfSession(*read, file, *files, nullptr);
  if (!source) FAIL(source.error().message);
  CHECK(textsOf(*source) == std::vector<std::string>{"scene liver", "add stiffer", "scene spleen", "add implant"});
  const auto &bodies = std::get<SharedScene>(source->front())->bodies;
  REQUIRE(bodies.size() == 2);
  REQUIRE(bodies[0].volume.mask);
  CHECK(bodies[0].volume.mask->voxels == cube().voxels);
  CHECK(bodies[1].mesh == files->front().at);

  Fixture f;
  if (const auto built = buildRemaining(*f.session, f.simulator.object(), *source, {}, nullptr); !built)
    FAIL(built.error().message);
  REQUIRE(restoreSession(*f.session, f.simulator.object(), f.identity, *read, file));
  REQUIRE(f.session->adoptForRun(f.simulator.object(), "test", *source));
  SessionFile again = f.saved(folder);
  FileReferences references;
  REQUIRE(keepRest(*read, *files, folder, references, Embedding::extracted, again));
  CHECK(again.unknown == read->unknown);
  CHECK(again.members == read->members);
  CHECK(again.files == read->files);
  CHECK(again.view == read->view);
  CHECK(again.state == read->state);
  REQUIRE(writeSession(again, folder / "again.c3de"));
  const auto whole = readSession(folder / "again.c3de");
  REQUIRE(whole);
  CHECK(whole->members.at("later/x") == "member of a later version");
  CHECK(whole->unknown == read->unknown);
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

TEST_CASE("The mask of a selection is stored, kept when another program saves the session, and refused if damaged") {
  const fs::path folder = testOutputFolder();
  SessionFile saved;
  CHECK(*maskOfSelection(saved, "a.c3de") == nullptr);
  saved.view.selection = SavedSelection{{}, {7}, "liver", 20.0, 100.0};
  addMaskOfSelection(cube(), saved);
  const auto mask = maskOfSelection(saved, "a.c3de");
  REQUIRE((mask && *mask));
  CHECK((*mask)->voxels == cube().voxels);

  // A window saves another selection, or none; `run` keeps it.
  SessionFile foreign;
  keepUnknown(saved, foreign);
  CHECK(foreign.members.empty());
  SessionFile again;
  FileReferences references;
  REQUIRE(keepRest(saved, {}, folder, references, Embedding::extracted, again));
  CHECK(again.members == saved.members);
  CHECK(again.view.selection->name == "liver");
  const auto kept = maskOfSelection(again, "a.c3de");
  REQUIRE((kept && *kept));
  CHECK((*kept)->voxels == cube().voxels);

  std::string &bytes = saved.members.at(saved.view.selection->mask);
  bytes.pop_back();
  const auto cut = maskOfSelection(saved, "a.c3de");
  REQUIRE_FALSE(cut);
  CHECK_THAT(cut.error().message, Contains("a.c3de: is damaged: ") && Contains(saved.view.selection->mask));
  saved.members.clear();
  CHECK_THAT(maskOfSelection(saved, "a.c3de").error().message, Contains("is missing"));
}

TEST_CASE("The second scan of a session is kept when another program saves it, with the file that was found") {
  const fs::path folder = testOutputFolder(), elsewhere = folder / "elsewhere";
  fs::create_directories(elsewhere);
  std::ofstream(elsewhere / "follow-up.nrrd") << "voxels";
  SessionFile saved;
  saved.view.comparison =
      SavedComparison{"old/follow-up.nrrd", "", 0, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}, false, true, 0.25, 15.0, {}, {}};
  const auto reference = referenceTo(elsewhere / "follow-up.nrrd", folder / "old");
  REQUIRE(reference);
  FoundFile found{{"old/follow-up.nrrd", reference->sha256, reference->bytes, false},
                  elsewhere / "follow-up.nrrd",
                  FoundFile::State::same,
                  nullptr};
  saved.files = {found.file};
  SessionFile again;
  FileReferences references;
  REQUIRE(keepRest(saved, {found}, folder, references, Embedding::extracted, again));
  REQUIRE(again.view.comparison);
  CHECK(again.view.comparison->image == "elsewhere/follow-up.nrrd");
  REQUIRE(again.files.size() == 1);
  CHECK(again.files[0].path == "elsewhere/follow-up.nrrd");
  again.view.comparison->image = saved.view.comparison->image;
  CHECK(again.view.comparison == saved.view.comparison);
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
