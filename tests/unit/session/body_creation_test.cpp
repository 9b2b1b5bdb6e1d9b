// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_creation.h"

#include <algorithm>
#include <thread>

#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using c3de::test::RecordingSimulator;
using segmentation::BodyRequest;

namespace {

/// A cube of 8 voxels of 2 mm along each axis: y from 4 to 18 mm between centres.
imaging::Mask cubeMask(std::uint8_t value = 1) {
  imaging::Mask mask;
  mask.geometry = {{12, 12, 12}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1}};
  mask.voxels.assign(12 * 12 * 12, 0);
  for (std::size_t k = 2; k < 10; ++k)
    for (std::size_t j = 2; j < 10; ++j)
      for (std::size_t i = 2; i < 10; ++i) mask.voxels[i + 12 * (j + 12 * k)] = value;
  return mask;
}

BodyRequest request(const std::string &name, std::uint8_t value = 1) {
  BodyRequest out;
  out.name = name;
  out.mask = std::make_shared<const imaging::Mask>(cubeMask(value));
  out.material = "liver";
  return out;
}

const scene::SceneValue *valueOf(const scene::SceneFile &scene, const std::string &id) {
  const auto &params = scene.bodies.at(0).params;
  const auto found = std::find_if(params.begin(), params.end(), [&](const auto &one) { return one.value.id == id; });
  return found == params.end() ? nullptr : &*found;
}

/// A session with or without a simulation, and the results of requests.
struct Fixture {
  RecordingSimulator simulator;
  std::unique_ptr<Session> session;
  std::vector<BodyCreation::Result> created;
  std::vector<std::pair<std::string, Error>> failed;
  std::optional<BodyCreation> creation;

  explicit Fixture(bool hasSimulation) {
    simulator.bodyIds = {"material.density", "material.youngs_modulus", "material.poisson_ratio",
                         "surroundings.stiffness"};
    SessionOptions options;
    options.searchPlugins = false;
    options.threads = 1;
    session = std::move(*Session::create(options));
    if (hasSimulation) {
      REQUIRE(session->adopt(simulator.object(), "present"));
      session->simulation()->call([] {});  // it is paused: tests may change the simulator's results
    }
    creation.emplace(*session,
                     BodyCreation::Events{
                         [this](const BodyCreation::Result &result) { created.push_back(result); },
                         [this](const std::string &title, const Error &error) { failed.emplace_back(title, error); }});
  }
  ~Fixture() {
    session->jobs().finishOwnedBy(kJobOwner);
    session.reset();  // destroyed before the simulator
  }
  void settle() {
    const auto start = std::chrono::steady_clock::now();
    while (!session->jobs().running().empty()) {
      session->mainQueue().runFrame();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      REQUIRE(std::chrono::steady_clock::now() - start < std::chrono::seconds(60));
    }
  }
};

std::vector<std::string> namesIn(const std::vector<BodyRequest> &requests) {
  std::vector<std::string> names;
  for (const BodyRequest &one : requests) names.push_back(one.name);
  return names;
}

}  // namespace

TEST_CASE("Bodies are named as one says them, of more than four the first three") {
  std::vector<BodyRequest> requests;
  const std::pair<const char *, const char *> steps[] = {{"liver", "liver"},
                                                         {"spleen", "liver and spleen"},
                                                         {"stomach", "liver, spleen and stomach"},
                                                         {"aorta", "liver, spleen, stomach and aorta"},
                                                         {"colon", "liver, spleen, stomach and 2 more"},
                                                         {"brain", "liver, spleen, stomach and 3 more"}};
  CHECK(namesOf(requests).empty());
  for (const auto &[name, expected] : steps) {
    requests.push_back(request(name));
    CHECK(namesOf(requests) == expected);
  }
}

TEST_CASE("Bodies from a scan begin without gravity") {
  const scene::SceneFile scene = sceneWithoutBodies();
  CHECK(scene.bodies.empty());
  REQUIRE_FALSE(scene.world.empty());
  CHECK(scene.world[0].value.id == "world.gravity");
  CHECK(scene.world[0].value.type == C3DE_PARAM_VEC3);
  CHECK(scene.world[0].value.vec == Vec3{});
}

TEST_CASE("A request becomes a scene of one body with its material, count and colour") {
  scene::MaterialPreset preset;
  preset.density = 1060.0;
  preset.youngsModulus = 6000.0;
  preset.poissonRatio = 0.49;
  BodyRequest one = request("liver");
  one.points = 400;
  one.edge_mm = 3.5;
  auto labels = std::make_shared<scene::StoredLabels>();
  labels->map.labels = {{2, "spleen", {1, 0, 0}}, {5, "liver", {0, 0.5f, 1}}};
  one.labels = labels;
  one.label = 5;
  scene::SceneFile scene = sceneOf(one, cubeMask(), &preset);
  CHECK(scene.title == "liver");
  REQUIRE(scene.bodies.size() == 1);
  const scene::SceneBody &body = scene.bodies[0];
  CHECK(body.name == "liver");
  REQUIRE(valueOf(scene, "sampling.count"));
  CHECK(valueOf(scene, "sampling.count")->value.num == 400.0);
  CHECK(valueOf(scene, "sampling.count")->value.type == C3DE_PARAM_I64);
  CHECK(valueOf(scene, "material.density")->value.num == 1060.0);
  CHECK(valueOf(scene, "material.youngs_modulus")->value.num == 6000.0);
  CHECK(valueOf(scene, "material.poisson_ratio")->value.num == 0.49);
  CHECK(body.volume.edgeLength_mm == 3.5);
  REQUIRE(body.volume.mask);
  CHECK(body.volume.mask->voxels == cubeMask().voxels);
  REQUIRE(body.volume.colour);
  CHECK((*body.volume.colour)[1] == 0.5f);
  // Without a preset and a count the simulator's own values are used.
  one.points = 0;
  scene = sceneOf(one, cubeMask(), nullptr);
  CHECK_FALSE(valueOf(scene, "sampling.count"));
  CHECK_FALSE(valueOf(scene, "material.density"));
}

TEST_CASE("A body is held by its surroundings, at its lowest part, not at all, or stands as a rigid one") {
  BodyRequest one = request("liver");
  scene::SceneFile scene = sceneOf(one, cubeMask(), nullptr);
  REQUIRE(valueOf(scene, "surroundings.stiffness"));
  CHECK(valueOf(scene, "surroundings.stiffness")->value.num == segmentation::kSurroundingsStiffness);
  one.surroundings_Pa_m = 0.0;
  CHECK_FALSE(valueOf(sceneOf(one, cubeMask(), nullptr), "surroundings.stiffness"));

  one.held = segmentation::Held::lowestPart;
  scene = sceneOf(one, cubeMask(), nullptr);
  CHECK_FALSE(valueOf(scene, "surroundings.stiffness"));
  REQUIRE(scene.fixes.size() == 1);
  CHECK(scene.fixes[0].body == "liver");
  CHECK(scene.fixes[0].region.kind == scene::SceneRegion::Kind::halfSpace);
  // y grows towards the back: 12 % of the 14 mm between the outermost centres, from 18 mm.
  CHECK_THAT(scene.fixes[0].region.a[1], WithinAbs(0.001 * (18.0 - 0.12 * 14.0), 1e-12));
  CHECK(scene.fixes[0].region.b == Vec3{0, -1, 0});

  one.held = segmentation::Held::nothing;
  CHECK(sceneOf(one, cubeMask(), nullptr).fixes.empty());
  one.held = segmentation::Held::surroundings;
  one.surroundings_Pa_m = 1e4;
  one.isRigid = true;
  scene = sceneOf(one, cubeMask(), nullptr);
  REQUIRE(valueOf(scene, "rigid"));
  CHECK(valueOf(scene, "rigid")->value.type == C3DE_PARAM_BOOL);
  CHECK(valueOf(scene, "rigid")->value.num == 1.0);
  CHECK_FALSE(valueOf(scene, "surroundings.stiffness"));
}

TEST_CASE("Bodies join the present simulation, and one that fails is named and loses nothing") {
  Fixture f(true);
  f.creation->createBodies({request("liver"), request("nothing", 0), request("spleen")});
  REQUIRE(f.session->jobs().running().size() == 1);
  CHECK(f.session->jobs().running()[0].title == "Creating liver, nothing and spleen");
  f.settle();
  CHECK(f.failed.empty());
  REQUIRE(f.created.size() == 1);
  const BodyCreation::Result &result = f.created[0];
  CHECK(namesIn(result.created) == std::vector<std::string>{"liver", "spleen"});
  CHECK(result.notTried.empty());
  CHECK_FALSE(result.isNew);
  REQUIRE(result.failed.size() == 1);
  CHECK(result.failed[0].first == "nothing");
  CHECK(result.failed[0].second.message == "nothing: the mask is empty; accepted: one with voxels");
  REQUIRE(result.coverage.size() == 2);
  CHECK(result.coverage[1].body == "spleen");
  REQUIRE(f.simulator.added.size() == 2);
  CHECK(f.simulator.added[0].name == "liver");
  CHECK(f.simulator.added[0].hasFill);
  CHECK(f.simulator.added[0].params.at("material.youngs_modulus") == 6000.0);
  CHECK(f.session->simulation()->object() == f.simulator.object());
  CHECK(f.simulator.world.empty());
}

TEST_CASE("A name that the simulation has already is refused, and what is left is created") {
  Fixture f(true);
  (void)f.session->sceneGraph().add(f.session->simulationNode(), "liver");
  f.creation->createBodies({request("liver")});
  f.settle();
  REQUIRE(f.failed.size() == 1);
  CHECK(f.failed[0].first == "Could not create liver");
  CHECK(f.failed[0].second.code == ErrorCode::usage);
  CHECK_THAT(f.failed[0].second.message, Contains("liver: the simulation has a body of this name already"));
  f.creation->createBodies({request("liver"), request("spleen")});
  f.settle();
  REQUIRE(f.created.size() == 1);
  CHECK(namesIn(f.created[0].created) == std::vector<std::string>{"spleen"});
  REQUIRE(f.created[0].failed.size() == 1);
  CHECK(f.created[0].failed[0].first == "liver");
}

TEST_CASE("Where no body can be created the reasons of all are told") {
  Fixture f(true);
  f.simulator.fail("add_body", C3DE_E_NOMEM);
  f.creation->createBodies({request("liver"), request("nothing", 0)});
  f.settle();
  CHECK(f.created.empty());
  REQUIRE(f.failed.size() == 1);
  CHECK(f.failed[0].first == "Could not create liver and nothing");
  CHECK(f.failed[0].second.code == ErrorCode::input);
  CHECK(f.failed[0].second.message ==
        "liver: building body 'liver' failed (status -9)\n"
        "nothing: the mask is empty; accepted: one with voxels");
  f.creation->createBodies({});
  CHECK(f.session->jobs().running().empty());
}

TEST_CASE("Without a simulator no body is created, and the reason is that of the plugins") {
  Fixture f(false);
  f.creation->createBodies({request("liver")});
  f.settle();
  REQUIRE(f.failed.size() == 1);
  CHECK(f.failed[0].first == "Could not create liver");
  CHECK(f.failed[0].second.code == ErrorCode::plugin);
  CHECK_THAT(f.failed[0].second.message, Contains("no plugin that simulates is loaded"));
  CHECK(f.session->simulation() == nullptr);
}

TEST_CASE("Bodies that were created before a cancellation stay, and the others are not tried") {
  Fixture f(true);
  f.simulator.fail("add_body", C3DE_E_CANCELLED);
  f.creation->createBodies({request("liver"), request("spleen")});
  f.settle();
  CHECK(f.created.empty());
  REQUIRE(f.failed.size() == 1);
  CHECK(f.failed[0].second.code == ErrorCode::cancelled);
  f.failed.clear();
  f.simulator.failNowhere();
  f.simulator.cancelsFrom = 2;
  f.creation->createBodies({request("liver"), request("spleen"), request("aorta")});
  f.settle();
  CHECK(f.failed.empty());
  REQUIRE(f.created.size() == 1);
  CHECK(namesIn(f.created[0].created) == std::vector<std::string>{"liver"});
  CHECK(namesIn(f.created[0].notTried) == std::vector<std::string>{"spleen", "aorta"});
}

TEST_CASE("Bodies whose simulation is closed while they are made are refused") {
  Fixture f(true);
  f.creation->createBodies({request("liver")});
  f.session->closeSimulation();
  f.settle();
  CHECK(f.created.empty());
  REQUIRE(f.failed.size() == 1);
  CHECK(f.failed[0].second.code == ErrorCode::state);
  CHECK_THAT(f.failed[0].second.message, Contains("has been closed"));
}
