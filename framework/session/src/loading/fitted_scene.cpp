// SPDX-License-Identifier: Apache-2.0
#include "loading/fitted_scene.h"

#include <algorithm>
#include <string>
#include <utility>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

// Bodies are passed one by one, and the first one has to leave time budget for the others.
void setBudgetShare(const scene::SceneFile &scene, const std::vector<ParameterDecl> &declared,
                    std::vector<ParameterValue> &world) {
  const std::string id = C3DE_PARAM_ID_ACCURACY_BODIES;
  if (std::none_of(declared.begin(), declared.end(), [&](const ParameterDecl &d) { return d.id == id; })) return;
  if (std::any_of(world.begin(), world.end(), [&](const ParameterValue &v) { return v.id == id; })) return;
  ParameterValue bodies;
  bodies.id = id;
  bodies.type = C3DE_PARAM_I64;
  bodies.num =
      static_cast<double>(std::count_if(scene.bodies.begin(), scene.bodies.end(), [](const scene::SceneBody &b) {
        return !scene::trueOf(b.params, C3DE_PARAM_ID_RIGID);
      }));
  bodies.num = std::max(1.0, bodies.num);
  world.push_back(std::move(bodies));
}

/// Checks that the simulator supports the features that the scene requires besides values.
Expected<void> checkSupported(c3de_object *simulator, const scene::SceneFile &scene) {
  const auto refuse = [&](int line, const char *what) {
    return fail(ErrorCode::input, scene.where(line) + ": '" + what + "' is not supported by this simulator");
  };
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  if (!supportsFills(*table))
    for (const scene::SceneBody &body : scene.bodies)
      if (body.mesh.empty()) return refuse(body.line, "volume");
  const auto contact = contactTable(simulator);
  if (!contact) return tl::unexpected(contact.error());
  if (*contact == nullptr) {
    for (const scene::SceneBody &body : scene.bodies)
      if (!body.volume.slides.empty()) return refuse(body.line, "slides");
    if (!scene.contactPairs.empty()) return refuse(scene.contactPairs.front().line, "[[contact.pair]]");
  }
  if ((*contact == nullptr || (*contact)->add_probe_tool == nullptr) && !scene.probeTools.empty())
    return refuse(scene.probeTools.front().line, "[[probe_tool]]");
  const auto attachments = attachmentTable(simulator);
  if (!attachments) return tl::unexpected(attachments.error());
  if (*attachments == nullptr && !scene.attachments.empty())
    return refuse(scene.attachments.front().line, "[[attachment]]");
  const auto grasps = graspTable(simulator);
  if (!grasps) return tl::unexpected(grasps.error());
  if (*grasps == nullptr && !scene.grasps.empty()) return refuse(scene.grasps.front().line, "[[grasp]]");
  return {};
}

Expected<FittedBody> fitBody(const scene::SceneFile &scene, const scene::SceneBody &body,
                             const std::vector<ParameterDecl> &declared) {
  FittedBody fitted;
  auto values = scene::fitToDeclarations(scene, body.params, declared);
  if (!values) return tl::unexpected(values.error());
  fitted.values = std::move(*values);
  for (const scene::ScenePart &part : body.parts) {
    values = scene::fitToDeclarations(scene, part.params, declared);
    if (!values) return tl::unexpected(values.error());
    fitted.parts.push_back(std::move(*values));
  }
  return fitted;
}

}  // namespace

Expected<FittedScene> fitScene(c3de_object *simulator, scene::SceneFile scene) {
  if (const auto served = checkSupported(simulator, scene); !served) return tl::unexpected(served.error());
  const auto world = simulatorDeclarations(simulator, C3DE_SIM_SCOPE_WORLD);
  if (!world) return tl::unexpected(world.error());
  const auto body = simulatorDeclarations(simulator, C3DE_SIM_SCOPE_BODY);
  if (!body) return tl::unexpected(body.error());
  const auto obstacle = simulatorDeclarations(simulator, C3DE_SIM_SCOPE_OBSTACLE);
  if (!obstacle) return tl::unexpected(obstacle.error());

  FittedScene fitted;
  auto values = scene::fitToDeclarations(scene, scene.world, *world);
  if (!values) return tl::unexpected(values.error());
  fitted.world = std::move(*values);
  setBudgetShare(scene, *world, fitted.world);
  for (const scene::SceneBody &one : scene.bodies) {
    auto good = fitBody(scene, one, *body);
    if (!good) return tl::unexpected(good.error());
    fitted.bodies.push_back(std::move(*good));
    if (one.volume.slides.empty()) continue;
    if (const auto rest = fitBody(scene, scene::bodyOfRest(one), *body); !rest) return tl::unexpected(rest.error());
    for (std::size_t s = 0; s < one.volume.slides.size(); ++s)
      if (const auto piece = fitBody(scene, scene::bodyOfPiece(one, s), *body); !piece)
        return tl::unexpected(piece.error());
  }
  for (const scene::SceneObstacle &one : scene.obstacles) {
    values = scene::fitToDeclarations(scene, one.params, *obstacle);
    if (!values) return tl::unexpected(values.error());
    fitted.obstacles.push_back(std::move(*values));
  }
  fitted.scene = std::move(scene);
  return fitted;
}

}  // namespace c3de::session
