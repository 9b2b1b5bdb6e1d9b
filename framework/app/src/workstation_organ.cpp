// SPDX-License-Identifier: Apache-2.0
#include "workstation_organ.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "simulator_access.h"

namespace c3de::app {
namespace {

// Of the extent along gravity: how much is held of an organ that lies.
constexpr double kHeldPart = 0.12;

scene::SceneValue numberOf(const std::string &id, double value) {
  scene::SceneValue out;
  out.value.id = id;
  out.value.type = C3DE_PARAM_F64;
  out.value.num = value;
  return out;
}

// Lowest and highest y of the voxels of a mask, with half a voxel, mm.
std::pair<double, double> extentToTheBack(const imaging::Mask &mask) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto &size = mask.geometry.size;
  for (std::size_t k = 0; k < size[2]; ++k)
    for (std::size_t j = 0; j < size[1]; ++j)
      for (std::size_t i = 0; i < size[0]; ++i) {
        if (mask.voxels[i + size[0] * (j + size[1] * k)] == 0) continue;
        const double y =
            mask.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})[1];
        low = std::min(low, y);
        high = std::max(high, y);
      }
  return {low, high};
}

}  // namespace

scene::SceneFile sceneOf(ui::OrganRequest request, const scene::MaterialPreset *preset) {
  scene::SceneFile scene;
  scene.title = request.name;
  scene::SceneBody body;
  body.name = request.name;
  body.params.push_back(numberOf("sampling.count", static_cast<double>(request.phyxels)));
  body.params.back().value.type = C3DE_PARAM_I64;
  if (preset) {
    body.params.push_back(numberOf("material.density", preset->density));
    body.params.push_back(numberOf("material.youngs_modulus", preset->youngsModulus));
    body.params.push_back(numberOf("material.poisson_ratio", preset->poissonRatio));
  }
  if (request.holdsLowestPart) {
    const auto [low, high] = extentToTheBack(request.mask);
    scene::SceneFix fix;
    fix.name = "back";
    fix.body = request.name;
    fix.region.kind = scene::SceneRegion::Kind::halfSpace;
    fix.region.a = {0.0, (high - kHeldPart * (high - low)) / scene::kMillimetresPerMetre, 0.0};
    fix.region.b = {0.0, -1.0, 0.0};
    scene.fixes.push_back(fix);
  }
  scene::SceneValue gravity;
  gravity.value.id = "world.gravity";
  gravity.value.type = C3DE_PARAM_VEC3;
  gravity.value.vec = {0.0, 0.0, 0.0};  // the scan shows the organ in balance with it
  scene.world.push_back(gravity);
  scene.world.push_back(numberOf("solver.damping", 2.0));
  body.volume.edgeLength_mm = request.edge_mm;
  body.volume.mask = std::make_shared<const imaging::Mask>(std::move(request.mask));
  scene.bodies.push_back(std::move(body));
  return scene;
}

void WorkstationOrgan::makeOrgan(ui::OrganRequest request) {
  if (!job_.isNull()) session_.jobs().cancel(job_);
  const std::uint64_t serial = ++serial_;
  const std::string name = request.name, title = "Could not make " + name;
  const auto scene = std::make_shared<const scene::SceneFile>(sceneOf(std::move(request), session_.materials().find(request.material)));

  scene::Simulation *present = session_.simulation();
  const bool joins = present && servesFills(present->table());
  std::shared_ptr<ObjectRef> simulator;
  if (joins) {
    c3de_object *object = present->object();
    object->vt->retain(object);
    simulator = std::make_shared<ObjectRef>(object);
  } else {
    auto created = session_.createSimulator();
    if (!created) return events_.failed(title, created.error());
    simulator = std::make_shared<ObjectRef>(*created);
  }
  job_ = session_.jobs().submit(
      kJobOwner, "Making " + name,
      [this, simulator, scene, joins](const ProgressFn &progress) {
        return joins ? session_.addBodies(simulator->get(), *scene, progress)
                     : session_.populate(simulator->get(), *scene, progress);
      },
      [this, serial, simulator, name, title, joins](const Expected<void> &done) {
        if (serial != serial_) return;
        job_ = {};
        if (!done) return events_.failed(title, done.error());
        if (!joins)
          if (auto adopted = session_.adopt(simulator->get(), name); !adopted) return events_.failed(title, adopted.error());
        events_.made(name, !joins);
      });
}

}  // namespace c3de::app
