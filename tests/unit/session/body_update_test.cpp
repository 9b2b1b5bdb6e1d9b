// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_update.h"

#include "c3de/session/session.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using c3de::test::RecordingSimulator;

namespace {

std::shared_ptr<const imaging::Mask> maskOf(std::size_t voxels) {
  imaging::Mask mask;
  mask.geometry = {{4, 4, 4}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1}};
  mask.voxels.assign(64, 0);
  std::fill_n(mask.voxels.begin(), voxels, std::uint8_t{1});
  return std::make_shared<const imaging::Mask>(std::move(mask));
}

SharedScene sceneOf(const std::string &body, std::shared_ptr<const imaging::Mask> mask) {
  scene::SceneFile scene;
  scene::SceneBody one;
  one.name = body;
  one.volume.mask = std::move(mask);
  scene.bodies.push_back(std::move(one));
  return std::make_shared<const scene::SceneFile>(std::move(scene));
}

const scene::SceneBody &bodyOf(const SimulationSource &source, std::size_t entry) {
  return std::get<SharedScene>(source.at(entry))->bodies.front();
}

}  // namespace

TEST_CASE("Bodies of masks are listed, and the mask of the last one of a name is replaced", "[body_update]") {
  const auto first = maskOf(8), second = maskOf(16), corrected = maskOf(20);
  SimulationChange change;
  change.id = "body.parameter";
  const SimulationSource source{sceneOf("liver", first), change, sceneOf("liver", second), sceneOf("tumour", nullptr)};
  const std::vector<MaskedBody> bodies = maskedBodies(source);
  REQUIRE(bodies.size() == 1);
  CHECK(bodies[0].name == "liver");
  CHECK(bodies[0].mask == second);

  const auto changed = withMask(source, "liver", corrected);
  REQUIRE(changed);
  REQUIRE(changed->size() == source.size());
  CHECK(bodyOf(*changed, 0).volume.mask == first);
  CHECK(bodyOf(*changed, 2).volume.mask == corrected);
  CHECK(std::get<SimulationChange>(changed->at(1)) == change);
  CHECK(bodyOf(source, 2).volume.mask == second);  // other holders of the scene keep it

  for (const std::string name : {"tumour", "spleen"}) {
    const auto refused = withMask(source, name, corrected);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::usage);
    CHECK_THAT(refused.error().message, Contains(name) && Contains("accepted: "));
  }
  for (const auto &empty : {maskOf(0), std::shared_ptr<const imaging::Mask>()}) {
    const auto refused = withMask(source, "liver", empty);
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().message, Contains("the mask is empty"));
  }
}

TEST_CASE("A simulator without the interface does not continue from another one", "[body_update]") {
  RecordingSimulator one, other;
  SessionOptions options;
  options.searchPlugins = false;
  options.threads = 1;
  const auto session = Session::create(options);
  REQUIRE(session);
  const auto continued = continueFrom(**session, one.object(), other.object());
  REQUIRE_FALSE(continued);
  CHECK(continued.error().code == ErrorCode::plugin);
  CHECK_THAT(continued.error().message, Contains("cannot continue"));
}
