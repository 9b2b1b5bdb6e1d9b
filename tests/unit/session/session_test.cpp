// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/session.h"

#include <algorithm>
#include <fstream>

#include "box_mesh.h"
#include "c3de/geometry/mesh_writer.h"
#include "c3de/imaging/writing.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/build_scene.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
namespace fs = std::filesystem;
using c3de::test::RecordingSimulator;
using session::test::boxMesh;

namespace {

std::unique_ptr<Session> sessionWithoutPlugins(registry::PanelRegistry *panels = nullptr) {
  SessionOptions options;
  options.panels = panels;
  options.searchPlugins = false;
  options.threads = 1;
  auto session = Session::create(options);
  if (!session) FAIL(session.error().message);
  return std::move(*session);
}

/// A session, a simulator that declares a few values, and a folder with box.obj, labels.nrrd (label 1) and files that
/// cannot be read.
struct Fixture {
  std::unique_ptr<Session> session = sessionWithoutPlugins();
  RecordingSimulator simulator;
  fs::path folder = testOutputFolder();

  Fixture() {
    simulator.worldIds = {"world.gravity", "solver.dt"};
    simulator.bodyIds = {"material.density", "sampling.count", "friction"};
    REQUIRE(geometry::writeMesh(folder / "box.obj", boxMesh({0, 0, 0}, {100, 20, 20})));
    std::ofstream(folder / "garbage.obj") << "# UNITS=mm\nv 0 0 zero\n";
    std::ofstream(folder / "garbage.nrrd") << "NRRD0004\ntype: odd\n";
    imaging::LabelMap labels;
    labels.geometry = {{12, 12, 12}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1}};
    labels.voxels.assign(12 * 12 * 12, 0);
    for (std::size_t k = 2; k < 10; ++k)
      for (std::size_t j = 2; j < 10; ++j)
        for (std::size_t i = 2; i < 10; ++i) labels.voxels[i + 12 * (j + 12 * k)] = 1;
    labels.labels = {{1, "spleen", {0, 1, 0}}};
    REQUIRE(imaging::writeLabelMap(folder / "labels.nrrd", labels));
  }
  scene::SceneFile scene(const std::string &text) {
    auto parsed = scene::parseScene("format = 1\n" + text, folder / "scene.toml", nullptr);
    if (!parsed) FAIL(parsed.error().message);
    return std::move(*parsed);
  }
  Expected<void> populate(const std::string &text) { return session->populate(simulator.object(), scene(text), {}); }
  std::string where(int line) { return (folder / "scene.toml").string() + ":" + std::to_string(line) + ": "; }
};

const std::string kBox = "[[body]]\nname = \"box\"\nmesh = \"box.obj\"\n";
const std::string kSpleen = "[[body]]\nname = \"spleen\"\nvolume = \"labels.nrrd\"\nlabel = 1\n";

}  // namespace

TEST_CASE("A scene's values, obstacles, bodies and probes are handed to the simulator") {
  Fixture f;
  const scene::SceneFile scene =
      f.scene("[world]\ngravity = [0, -9, 0]\n" + kBox + "material = { density = 900.0 }\n" + kSpleen +
              "[[fix]]\nbody = \"spleen\"\nregion = { sphere = { centre = [0, 0, 0], radius = 0.1 } }\n"
              "[[obstacle]]\nname = \"floor\"\nmesh = \"box.obj\"\nfriction = 0.5\n"
              "[[probe]]\nname = \"tip\"\nbody = \"box\"\nat = [0.05, 0.01, 0.01]\n");
  Prepared prepared;
  std::vector<double> fractions;
  REQUIRE(f.session->populate(
      f.simulator.object(), scene,
      [&](double fraction, const std::string &) { return fractions.push_back(fraction), true; }, &prepared));
  REQUIRE(f.simulator.world.size() == 1);
  CHECK(f.simulator.world[0].vec == Vec3{0, -9, 0});
  CHECK(f.simulator.obstacles == std::vector<std::string>{"floor"});
  REQUIRE(f.simulator.added.size() == 2);
  CHECK(f.simulator.added[0].name == "box");
  CHECK(f.simulator.added[0].params.at("material.density") == 900.0);
  CHECK_FALSE(f.simulator.added[0].hasFill);
  CHECK(f.simulator.added[0].fixes == 0);
  CHECK(f.simulator.added[1].hasFill);
  CHECK(f.simulator.added[1].hasColour);
  CHECK(f.simulator.added[1].fixes == 1);
  // Their meshes were lent for the call only.
  CHECK(f.simulator.added[0].mesh != 0);
  CHECK_FALSE(f.session->meshes().find(Handle::fromBits(f.simulator.added[0].mesh)));
  // The coverage of the bodies from images.
  REQUIRE(prepared.coverage.size() == 1);
  CHECK(prepared.coverage[0].body == "spleen");
  CHECK(prepared.took.reading_s > 0.0);
  REQUIRE(fractions.size() > 2);
  CHECK(fractions.back() <= 1.0);
  CHECK(*std::max_element(fractions.begin(), fractions.end()) > 0.3);
}

TEST_CASE("A key that the simulator does not know, or a value it does not take, is told with its line") {
  Fixture f;
  auto refused = f.populate(kBox + "material = { densty = 900.0 }\n");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::input);
  CHECK_THAT(refused.error().message,
             Contains(f.where(5)) && Contains("material.densty") && Contains("material.density"));
  refused = f.populate("[solver]\ndt = -5.0\n" + kBox);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains(f.where(3)) && Contains("solver.dt") && Contains("-5"));
  refused = f.session->checkValues(f.simulator.object(), f.scene("[solver]\ndt = -5.0\n" + kBox));
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains(f.where(3)));
  CHECK(f.session->checkValues(f.simulator.object(), f.scene(kBox)));
  CHECK(f.simulator.added.empty());
  CHECK(f.simulator.world.empty());
}

TEST_CASE("What is said of a piece is checked before the map that it is cut from is read") {
  Fixture f;
  c3de_contact_v1 contact{};
  contact.size = sizeof contact;
  contact.rev = 1;
  contact.set_pair = [](c3de_object *, const c3de_sim_contact_pair *) -> c3de_status { return C3DE_OK; };
  f.simulator.contact = &contact;
  scene::SceneFile scene = f.scene(
      "[[body]]\nname = \"scan\"\nvolume = \"garbage.nrrd\"\nslides = [\"a\"]\n"
      "tissues = [ { label = \"a\", material = { density = 900 } }, { label = \"b\", material = { density = 900 } } "
      "]\n");
  REQUIRE(f.session->checkValues(f.simulator.object(), scene));
  REQUIRE(scene::applyOverride(scene, "body.scan.a.material.densty=5", nullptr));
  const auto refused = f.session->populate(f.simulator.object(), scene, {});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::usage);
  CHECK_THAT(refused.error().message, Contains("--set body.scan.a.material.densty: unknown key"));
}

TEST_CASE("A body of an image is refused by name and line where the simulator fills none") {
  Fixture f;
  f.simulator.hasDisplacement = false;
  const auto refused = f.populate(kSpleen);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::input);
  CHECK_THAT(refused.error().message, Contains(f.where(2)) && Contains("'volume' is not supported"));
  CHECK(f.populate(kBox));
}

TEST_CASE("Files that cannot be read are told with the line of their body, before the first body is built") {
  Fixture f;
  auto refused = f.populate(kBox + "[[body]]\nname = \"other\"\nmesh = \"garbage.obj\"\n");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::input);
  CHECK_THAT(refused.error().message, Contains(f.where(5)) && Contains("garbage.obj"));
  CHECK(f.simulator.added.empty());
  refused = f.populate("[[body]]\nname = \"spleen\"\nvolume = \"labels.nrrd\"\nlabel = 7\n");
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains(f.where(2)) && Contains("labels.nrrd has no label 7"));
  refused = f.populate("[[obstacle]]\nname = \"floor\"\nmesh = \"garbage.obj\"\n" + kBox);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains(f.where(2)) && Contains("garbage.obj"));
}

TEST_CASE("A simulator that refuses is told with the line of what it refused") {
  const std::string text = "[[obstacle]]\nname = \"floor\"\nmesh = \"box.obj\"\n" + kBox +
                           "[[probe]]\nname = \"tip\"\nbody = \"box\"\nat = [0, 0, 0]\n";
  const std::pair<const char *, std::pair<int, const char *>> refusals[] = {
      {"set_world", {0, "setting the world failed (status -1)"}},
      {"add_obstacle", {2, "adding obstacle 'floor' failed (status -1)"}},
      {"add_body", {5, "building body 'box' failed (status -1)"}},
      {"add_probe", {8, "adding probe 'tip' failed (status -1)"}}};
  for (const auto &[function, expected] : refusals) {
    Fixture f;
    f.simulator.fail(function, C3DE_E_ARG);
    const auto refused = f.populate(text);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::input);
    const std::string place = expected.first > 0 ? f.where(expected.first) : (f.folder / "scene.toml").string() + ": ";
    CHECK(refused.error().message == place + expected.second);
  }
  Fixture f;
  f.simulator.fail("add_body", C3DE_E_CANCELLED);
  const auto cancelled = f.populate(text);
  REQUIRE_FALSE(cancelled);
  CHECK(cancelled.error().code == ErrorCode::cancelled);
  CHECK(cancelled.error().message == "building body 'box' was cancelled");
}

TEST_CASE("Bodies can be added to a simulator that goes on with the rest as it is") {
  Fixture f;
  REQUIRE(f.session->addBodies(f.simulator.object(), f.scene("[world]\ngravity = [0, -9, 0]\n" + kBox), {}));
  REQUIRE(f.simulator.added.size() == 1);
  CHECK(f.simulator.world.empty());
  CHECK_FALSE(f.session->addBodies(f.simulator.object(), f.scene(kBox + "material = { densty = 1.0 }\n"), {}));
  CHECK(f.simulator.added.size() == 1);
}

TEST_CASE("A scene is built with the image beside it, which is read first") {
  Fixture f;
  BodySources sources;
  const auto build = [&](const std::string &text) {
    return buildScene(*f.session, f.simulator.object(), f.scene(text), sources, {});
  };
  REQUIRE(build(kSpleen + "[image]\nfile = \"labels.nrrd\"\n"));
  CHECK(f.simulator.added.size() == 1);
  const auto refused = build("[image]\nfile = \"garbage.nrrd\"\n" + kBox);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains(f.where(2)) && Contains("garbage.nrrd"));
  CHECK(f.simulator.added.size() == 1);
}

TEST_CASE("Without a plugin there is no simulator, and the folders that were searched are named") {
  const auto session = sessionWithoutPlugins();
  const auto simulator = session->createSimulator();
  REQUIRE_FALSE(simulator);
  CHECK(simulator.error().code == ErrorCode::plugin);
  CHECK_THAT(simulator.error().message, Contains("no plugin that simulates is loaded") &&
                                            Contains("folders searched: none") && Contains("`c3de plugins`"));
  CHECK(session->simulation() == nullptr);
  CHECK(session->simulationNode().isNull());
}

TEST_CASE("A folder of plugins that is none, and a named plugin that does not load, fail the session") {
  const fs::path folder = testOutputFolder();
  SessionOptions options;
  options.pluginFolders = {folder / "nowhere"};
  auto session = Session::create(options);
  REQUIRE_FALSE(session);
  CHECK(session.error().code == ErrorCode::plugin);
  CHECK(session.error().message ==
        "--plugin-path " + (folder / "nowhere").string() + ": no such folder; accepted: a folder of plugins");
  options.pluginFolders.clear();
  options.pluginFiles = {folder / "none.so"};
  session = Session::create(options);
  REQUIRE_FALSE(session);
  CHECK(session.error().code == ErrorCode::plugin);
  CHECK_THAT(session.error().message, Contains("none.so"));
}

TEST_CASE("An adopted simulator has a node of its own in millimetres, and the one before goes") {
  RecordingSimulator first, second;
  {
    const auto session = sessionWithoutPlugins();
    REQUIRE(session->adopt(first.object(), "first"));
    const Handle node = session->simulationNode();
    REQUIRE(session->sceneGraph().find(node));
    CHECK(session->sceneGraph().find(node)->name == "first");
    CHECK(norm(transformPoint(session->sceneGraph().worldFromNode(node), {0.001, 0.002, 0.003}) - Vec3{1, 2, 3}) <
          1e-12);
    CHECK(first.attached == node.bits());
    REQUIRE(session->adopt(second.object(), "second"));
    CHECK_FALSE(session->sceneGraph().find(node));
    CHECK(first.attached == 0);
    CHECK(first.references() == 1);
    CHECK(session->simulation()->object() == second.object());
  }
  CHECK(second.attached == 0);
  CHECK(second.references() == 1);
}

TEST_CASE("Messages about a simulation end with it, whether it is closed or replaced") {
  using registry::About;
  RecordingSimulator first, second;
  registry::PanelRegistry panels;
  {
    const auto session = sessionWithoutPlugins(&panels);
    session->closeSimulation();  // there is none
    REQUIRE(session->adopt(first.object(), "first"));
    const Handle node = session->simulationNode();
    panels.notify(1, "Body created: liver", "", {{"Undo", [] {}}}, About::simulation);
    panels.notify(1, "Saved", "");
    second.fail("attach", C3DE_E_GPU);
    REQUIRE_FALSE(session->adopt(second.object(), "second"));
    CHECK(panels.notifications().size() == 2);
    second.fail("attach", C3DE_OK);
    REQUIRE(session->adopt(second.object(), "second"));
    REQUIRE(panels.notifications().size() == 1);
    CHECK(panels.notifications()[0].title == "Saved");
    panels.notify(2, "Paused: a step took too long", "", {}, About::simulation);
    session->closeSimulation();
    CHECK(session->simulation() == nullptr);
    CHECK(session->simulationNode().isNull());
    CHECK(session->sceneGraph().rows().empty());
    CHECK_FALSE(session->sceneGraph().find(node));
    CHECK(second.attached == 0);
    CHECK(second.references() == 1);
    REQUIRE(panels.notifications().size() == 1);
    // The list of all messages stores them without their choices.
    REQUIRE(panels.log().size() == 3);
    CHECK(panels.log()[0].choices.empty());
  }
}

TEST_CASE("A simulator that cannot be shown leaves the present one as it was") {
  RecordingSimulator present, next;
  const auto session = sessionWithoutPlugins();
  REQUIRE(session->adopt(present.object(), "present"));
  const Handle node = session->simulationNode();
  next.fail("attach", C3DE_E_GPU);
  const auto adopted = session->adopt(next.object(), "next");
  REQUIRE_FALSE(adopted);
  CHECK(adopted.error().code == ErrorCode::plugin);
  CHECK(adopted.error().message == "the simulator could not be shown: status -15");
  CHECK(session->simulation()->object() == present.object());
  CHECK(session->simulationNode() == node);
  CHECK(present.attached == node.bits());
  CHECK(next.references() == 1);
  CHECK(session->sceneGraph().rows().size() == 1);
  next.answersInterface = false;
  CHECK_FALSE(session->adopt(next.object(), "next"));
}
