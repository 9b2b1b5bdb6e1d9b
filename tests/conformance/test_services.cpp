// SPDX-License-Identifier: Apache-2.0
// A plugin in C drives every service with good and bad arguments.
#include <array>
#include <sstream>
#include <string>
#include <thread>

#include "c3de/scene/simulation.h"
#include "host_fixture.h"
#include "service_driver.h"
#include "services/catalogue.h"
#include "support/recording_simulator.h"

using namespace c3de;
using c3de::test::HostFixture;
using c3de::test::RecordingSimulator;

namespace {

/// The fixture with the driver loaded and a simulation behind a node.
struct DrivenHost : HostFixture {
  explicit DrivenHost(const std::filesystem::path &plugin = testPlugin("service_driver")) {
    REQUIRE(refusalOf(plugin).empty());
    node = sceneGraph.add({}, "simulation");
    const auto simulator = sdk::make<RecordingSimulator>();
    auto created = scene::Simulation::create(simulator.abi());
    REQUIRE(created);
    simulation = std::move(*created);
    simulations.add(node, "test", simulation);
    auto made = host->createObject(TEST_DRIVER_CLASS);
    REQUIRE(made);
    object = *made;
    const void *table = nullptr;
    REQUIRE(object->vt->query(object, {TEST_DRIVER_ID, sizeof TEST_DRIVER_ID - 1}, 1, &table) == C3DE_OK);
    driver = static_cast<const test_driver_v0 *>(table);
  }
  ~DrivenHost() { simulations.remove(node); }

  /// Differences between actual and expected results, a line each.
  std::string run(std::string_view service) {
    std::string differences;
    const c3de_sink sink{&differences, [](void *self, const void *bytes, std::uint64_t n) -> c3de_status {
                           static_cast<std::string *>(self)->append(static_cast<const char *>(bytes), n);
                           return C3DE_OK;
                         }};
    compared = driver->run(object, {service.data(), service.size()}, {node.bits()}, sink);
    return differences;
  }

  Handle node;
  std::shared_ptr<scene::Simulation> simulation;
  c3de_object *object = nullptr;
  const test_driver_v0 *driver = nullptr;
  std::uint64_t compared = 0;
};

/// Two images and a label map, as the driver of the imaging service expects them.
std::array<Handle, 3> storeImages(DrivenHost &f) {
  // 3 x 4 x 5 voxels in an oblique, left-handed frame; values are linear in the index, so that sampling is exact.
  auto image = std::make_shared<scene::StoredImage>();
  image->name = "phantom";
  image->range = {-90.0, 800.0, -50.0, 700.0};
  image->volume.unit = "HU";
  image->volume.slope = 2.0;
  image->volume.intercept = -100.0;
  image->volume.geometry.size = {3, 4, 5};
  image->volume.geometry.indexToWorld = {0, 2, 0, 0, 3, 0, 0, 0, 0, 1, 4, 0, 10, 20, 30, 1};
  std::vector<std::int16_t> voxels;
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 3; ++i) voxels.push_back(static_cast<std::int16_t>(5 + i + 10 * j + 100 * k));
  image->volume.voxels = voxels;

  auto labels = std::make_shared<scene::StoredLabels>();
  labels->name = "organs";
  labels->map.geometry.size = {2, 1, 1};
  labels->map.geometry.indexToWorld = {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 1};
  labels->map.voxels = {3, 40000};
  labels->map.labels = {{3, "liver", {0.5f, 0.25f, 0.0f}}, {40000, "spleen", {0.0f, 0.0f, 1.0f}}};
  return {f.images.add(image), f.images.add(image), f.images.add(labels)};
}

void takeQuit(DrivenHost &f) {
  f.commands.setProgramKeys([](std::uint32_t key, std::uint32_t modifiers) {
    return std::string(key == 'Q' && modifiers == C3DE_MOD_CTRL ? "'Quit' of the program" : "");
  });
}

void check(const std::string &service, std::uint64_t atLeast) {
  DrivenHost f;
  CHECK(f.run(service) == "");
  CHECK(f.compared >= atLeast);
}

}  // namespace

TEST_CASE("plugins of this tree load where everything is served") {
  HostFixture f;
  for (const char *name : {"plugins/pointbased", "examples/hello", "examples/magnet"})
    CHECK(f.refusalOf(std::filesystem::path(testPluginFolder()).parent_path() /
                      (name + std::string(pluginExtension()))) == "");
}

#if defined(__linux__) && defined(__x86_64__)
TEST_CASE("a kept binary uses every frozen service, and each answers it as then") {
  // Its texts may have been improved since; the results of its calls have not changed.
  DrivenHost f(std::filesystem::path(C3DE_KEPT_PLUGINS) / "linux-x86_64" / "services_of_1.so");
  (void)storeImages(f);
  takeQuit(f);
  for (const char *service :
       {"host", "log", "registry", "mesh", "scene", "render", "collision", "params", "panels", "tools", "history",
        "jobs", "time", "simulation", "forces", "files", "settings", "commands", "imaging"}) {
    std::istringstream lines(f.run(service));
    CHECK(f.compared >= 3);
    for (std::string line; std::getline(lines, line);)
      if (line.find(": text has: ") == std::string::npos) FAIL_CHECK(service << ": " << line);
  }
  for (int i = 0; i < 500 && !f.jobs.running().empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    f.mainQueue.runFrame();
  }
  for (const plugin_host::ServiceEntry &entry : plugin_host::serviceCatalogue()) {
    INFO(entry.id << ": no binary of tests/conformance/kept uses it; kept/README.md says how one is made");
    CHECK(f.host->isUsed(entry.id));
  }
}
#endif

TEST_CASE("get_service and the error text behave as documented") { check("host", 10); }
TEST_CASE("the registry service answers good and bad arguments") { check("registry", 20); }
TEST_CASE("the mesh service answers good and bad arguments") { check("mesh", 35); }
TEST_CASE("the scene service answers good and bad arguments") { check("scene", 20); }
TEST_CASE("the render service answers good and bad arguments") { check("render", 35); }
TEST_CASE("the collision service answers good and bad arguments") { check("collision", 35); }
TEST_CASE("the params service answers good and bad arguments") { check("params", 30); }
TEST_CASE("the panels service answers good and bad arguments") { check("panels", 10); }
TEST_CASE("the tools service answers good and bad arguments") {
  DrivenHost f;
  f.tools.setMarkedPoint([] { return Vec3{1.0, -2.0, 3.5}; });
  CHECK(f.run("tools") == "");
  CHECK(f.compared >= 24);
}

TEST_CASE("the history service answers good and bad arguments, and its steps are undone and redone") {
  DrivenHost f;
  CHECK(f.run("history") == "");
  CHECK(f.compared >= 12);
  CHECK(f.edits.undoLabel() == "quiet");
  f.edits.undo();
  CHECK(f.edits.undoLabel() == "pull");
  f.edits.undo();
  CHECK(f.edits.undoLabel() == "");
  f.edits.redo();
  CHECK(f.edits.redoLabel() == "quiet");
  CHECK(f.run("history after") == "");
  CHECK(f.edits.undoLabel() == "last");
  CHECK(f.edits.redoLabel() == "");
  f.host.reset();
  CHECK(f.edits.undoLabel() == "");  // an unloaded plugin removes its undo steps
}

TEST_CASE("the history service captures the simulation before a change and adds its step afterwards") {
  struct Steps : registry::SimulationSteps {
    void captureBefore(const std::function<void(std::uint64_t)> &begin) override { waiting.push_back(begin); }
    bool addCaptured(std::uint64_t capture, const std::string &label) override {
      added = std::to_string(capture) + " " + label;
      return capture == waiting.size();
    }
    std::vector<std::function<void(std::uint64_t)>> waiting;
    std::string added;
  } steps;
  DrivenHost f;
  f.edits.setSimulationSteps(&steps);
  CHECK(f.run("history capture") == "");
  REQUIRE(steps.waiting.size() == 2);
  steps.waiting[0](1);
  steps.waiting[1](2);
  steps.waiting[1](2);  // begun once only
  CHECK(f.run("history captured") == "");
  CHECK(steps.added == "2 load");
  CHECK(f.run("history capture") == "");
  f.host.reset();
  steps.waiting[2](3);  // of a plugin that is unloaded: no call
}
TEST_CASE("a handle of one kind is refused where another is asked for, with both kinds") { check("kinds", 8); }
TEST_CASE("the files service answers good and bad arguments") { check("files", 20); }
TEST_CASE("the commands service answers good and bad arguments") {
  DrivenHost f;
  takeQuit(f);
  CHECK(f.run("commands") == "");
  CHECK(f.compared >= 30);
  CHECK(f.linesWith("the command 'Count' has no shortcut: its keys are those of 'Quit' of the program").size() == 1);
}
TEST_CASE("the settings service answers good and bad arguments") { check("settings", 20); }
TEST_CASE("the forces service answers good and bad arguments") { check("forces", 18); }
TEST_CASE("the simulation service answers good and bad arguments") { check("simulation", 12); }

TEST_CASE("the imaging service reads what is stored and refuses bad arguments") {
  DrivenHost f;
  const auto [first, second, map] = storeImages(f);

  CHECK(f.run("imaging") == "");
  CHECK(f.compared >= 50);
  std::string differences;
  std::thread([&] { differences = f.run("imaging"); }).join();
  CHECK(differences == "");

  CHECK(f.images.removeImage(first));
  CHECK(f.images.removeImage(second));
  CHECK(f.images.removeLabels(map));
  CHECK(f.run("imaging of what is gone") == "");
  CHECK(f.compared >= 10);
}

TEST_CASE("the imaging service is not served without a store of images") {
  HostFixture f;
  f.services.images = nullptr;
  f.host = std::make_unique<plugin_host::PluginHost>(f.services);
  REQUIRE(f.refusalOf(HostFixture::testPlugin("service_driver")).empty());
  const auto object = f.host->createObject(TEST_DRIVER_CLASS);
  REQUIRE(object);
  const void *table = nullptr;
  REQUIRE((*object)->vt->query(*object, {TEST_DRIVER_ID, sizeof TEST_DRIVER_ID - 1}, 1, &table) == C3DE_OK);
  std::string differences;
  const c3de_sink sink{&differences, [](void *self, const void *bytes, std::uint64_t n) -> c3de_status {
                         static_cast<std::string *>(self)->append(static_cast<const char *>(bytes), n);
                         return C3DE_OK;
                       }};
  constexpr std::string_view kRun = "imaging without a store";
  CHECK(static_cast<const test_driver_v0 *>(table)->run(*object, {kRun.data(), kRun.size()}, {0}, sink) >= 2);
  CHECK(differences == "");
}

TEST_CASE("the log service writes one line, with the plugin's id, and shows warnings") {
  DrivenHost f;
  CHECK(f.run("log") == "");
  CHECK(f.linesWith("[test.service_driver] two lines").size() == 1);
  REQUIRE(f.panels.notifications().size() == 1);
  CHECK(f.panels.notifications().front().text == "severity beyond the last");
}

TEST_CASE("the jobs service answers good and bad arguments and hands every job back") {
  DrivenHost f;
  CHECK(f.run("jobs") == "");
  for (int i = 0; i < 500 && !f.jobs.running().empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    f.mainQueue.runFrame();
  }
  CHECK(f.jobs.running().empty());
}

TEST_CASE("the time service answers good and bad arguments") {
  DrivenHost f;
  CHECK(f.run("time") == "");
  f.mainQueue.runFrame();
}

TEST_CASE("functions of the main thread refuse other threads, the others do not") {
  DrivenHost f;
  std::string differences;
  std::thread([&] { differences = f.run("wrong thread"); }).join();
  CHECK(differences == "");
  CHECK(f.compared > 25);
  CHECK(f.panels.notifications().empty());
  f.mainQueue.runFrame();
  CHECK(f.panels.notifications().size() == 1);  // the warning was transferred to the main thread
}

TEST_CASE("a plugin that calls after it was taken back gets a status instead of a crash") {
  HostFixture f;
  // create succeeds, so its class can be used; start fails, and the plugin is unloaded while its object still exists.
  REQUIRE(f.host->load(HostFixture::testPlugin("service_driver_that_goes")));
  const auto object = f.host->createObject(TEST_DRIVER_CLASS);
  REQUIRE(object);
  f.host->start();
  REQUIRE(f.host->classes().empty());
  const void *table = nullptr;
  REQUIRE((*object)->vt->query(*object, {TEST_DRIVER_ID, sizeof TEST_DRIVER_ID - 1}, 1, &table) == C3DE_OK);
  std::string differences;
  const c3de_sink sink{&differences, [](void *self, const void *bytes, std::uint64_t n) -> c3de_status {
                         static_cast<std::string *>(self)->append(static_cast<const char *>(bytes), n);
                         return C3DE_OK;
                       }};
  const std::string_view name = "taken back";
  const auto compared = static_cast<const test_driver_v0 *>(table)->run(*object, {name.data(), name.size()}, {0}, sink);
  CHECK(differences == "");
  CHECK(compared == 4);
}
