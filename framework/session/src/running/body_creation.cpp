// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_creation.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

// Fraction of the extent along gravity that is held for a body lying on its back.
constexpr double kHeldPart = 0.12;

scene::SceneValue numberOf(const std::string &id, double value) {
  scene::SceneValue out;
  out.value.id = id;
  out.value.type = C3DE_PARAM_F64;
  out.value.num = value;
  return out;
}

// Lowest and highest y of the voxels of a mask, including half a voxel, mm.
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

std::set<std::string> bodyNames(Session &session) {
  std::set<std::string> names;
  const scene::SceneGraph &graph = session.sceneGraph();
  for (const scene::SceneGraph::Row &row : graph.rows())
    if (const scene::Node *node = graph.find(row.node);
        node && !node->parent.isNull() && node->parent == session.simulationNode())
      names.insert(node->name);
  return names;
}

scene::SceneFile sceneWithoutBodies() {
  scene::SceneFile scene;
  scene::SceneValue gravity;
  gravity.value.id = C3DE_PARAM_ID_GRAVITY;
  gravity.value.type = C3DE_PARAM_VEC3;
  gravity.value.vec = {0.0, 0.0, 0.0};  // the scan shows the organs in equilibrium with it
  scene.world.push_back(gravity);
  scene.world.push_back(numberOf(C3DE_PARAM_ID_DAMPING, 2.0));
  return scene;
}

scene::SceneFile sceneOf(const segmentation::BodyRequest &request, imaging::Mask mask,
                         const scene::MaterialPreset *preset) {
  scene::SceneFile scene;
  scene.title = request.name;
  scene::SceneBody body;
  body.name = request.name;
  if (request.points > 0) {
    body.params.push_back(numberOf(C3DE_PARAM_ID_COUNT, static_cast<double>(request.points)));
    body.params.back().value.type = C3DE_PARAM_I64;
  }
  if (preset) {
    body.params.push_back(numberOf(C3DE_PARAM_ID_DENSITY, preset->density));
    body.params.push_back(numberOf(C3DE_PARAM_ID_YOUNGS_MODULUS, preset->youngsModulus));
    body.params.push_back(numberOf(C3DE_PARAM_ID_POISSON_RATIO, preset->poissonRatio));
  }
  if (request.isRigid) {
    scene::SceneValue rigid = numberOf(C3DE_PARAM_ID_RIGID, 1.0);
    rigid.value.type = C3DE_PARAM_BOOL;
    body.params.push_back(rigid);
  } else if (request.held == segmentation::Held::surroundings && request.surroundings_Pa_m > 0.0) {
    body.params.push_back(numberOf(C3DE_PARAM_ID_SURROUNDINGS_STIFFNESS, request.surroundings_Pa_m));
  } else if (request.held == segmentation::Held::lowestPart) {
    const auto [low, high] = extentToTheBack(mask);
    scene::SceneFix fix;
    fix.name = "back";
    fix.body = request.name;
    fix.region.kind = scene::SceneRegion::Kind::halfSpace;
    fix.region.a = {0.0, (high - kHeldPart * (high - low)) / scene::kMillimetresPerMetre, 0.0};
    fix.region.b = {0.0, -1.0, 0.0};
    scene.fixes.push_back(fix);
  }
  body.volume.edgeLength_mm = request.edge_mm;
  body.volume.mask = std::make_shared<const imaging::Mask>(std::move(mask));
  if (request.labels)
    for (const imaging::LabelMap::Label &label : request.labels->map.labels)
      if (label.value == request.label) body.volume.colour = label.colour;
  scene.bodies.push_back(std::move(body));
  return scene;
}

std::string namesOf(const std::vector<segmentation::BodyRequest> &requests) {
  constexpr std::size_t kMost = 4;
  const std::size_t named = requests.size() > kMost ? kMost - 1 : requests.size();
  std::string names;
  for (std::size_t i = 0; i < named; ++i)
    names += (i == 0 ? "" : i + 1 == requests.size() ? " and " : ", ") + requests[i].name;
  return named < requests.size() ? names + " and " + std::to_string(requests.size() - named) + " more" : names;
}

Expected<void> BodyCreation::createAll(c3de_object *simulator, const std::shared_ptr<ChangeLog> &changes,
                                       Result &result, const ProgressFn &progress) {
  const bool isNew = changes == nullptr;
  scene::SceneFile world;
  if (isNew) {
    world = sceneWithoutBodies();
    if (const auto decls = simulatorDeclarations(simulator, C3DE_SIM_SCOPE_WORLD))
      std::erase_if(world.world,
                    [&](const scene::SceneValue &value) { return !findParameter(*decls, value.value.id); });
    if (auto begun = session_.populate(simulator, world, {}); !begun) return begun;
  }
  const std::vector<segmentation::BodyRequest> requests = std::exchange(result.notTried, {});
  const auto count = static_cast<double>(requests.size());
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const segmentation::BodyRequest &request = requests[i];
    const ProgressFn part = [&](double fraction, const std::string &what) {
      return progress((static_cast<double>(i) + std::clamp(fraction, 0.0, 1.0)) / count,
                      what.starts_with(request.name) ? what : request.name + ": " + what);
    };
    Expected<void> made;
    Prepared prepared;
    SharedScene scene;
    if (auto mask = segmentation::maskOf(request, part); !mask) {
      made = tl::unexpected(mask.error());
    } else {
      scene = std::make_shared<const scene::SceneFile>(
          sceneOf(request, std::move(*mask), session_.materials().find(request.material)));
      made = session_.addBodies(simulator, *scene, part, &prepared);
    }
    if (made) {
      result.created.push_back(request);
      if (changes) changes->addScene(scene);
      result.scenes.push_back(std::move(scene));
      result.coverage.insert(result.coverage.end(), prepared.coverage.begin(), prepared.coverage.end());
    } else if (made.error().code == ErrorCode::cancelled) {
      result.notTried.assign(requests.begin() + static_cast<std::ptrdiff_t>(i), requests.end());
      if (isNew || result.created.empty()) return made;
      break;
    } else {
      // Some errors contain the name already.
      Error error = made.error();
      if (!error.message.starts_with(request.name + ": ")) error.message = request.name + ": " + error.message;
      result.failed.emplace_back(request.name, std::move(error));
    }
  }
  if (isNew && !result.scenes.empty()) {
    scene::SceneFile first = *result.scenes.front();
    first.world = world.world;
    result.scenes.front() = std::make_shared<const scene::SceneFile>(std::move(first));
  }
  if (!result.created.empty()) return {};
  std::string text;
  for (const auto &[name, error] : result.failed) text += (text.empty() ? "" : "\n") + error.message;
  return fail(result.failed.empty() ? ErrorCode::state : result.failed.front().second.code, text);
}

void BodyCreation::createBodies(std::vector<segmentation::BodyRequest> requests) {
  if (requests.empty()) return;
  if (!job_.isNull()) session_.jobs().cancel(job_);
  const std::uint64_t serial = ++serial_;
  const std::string names = namesOf(requests), title = "Could not create " + names;

  scene::Simulation *present = session_.simulation();
  const auto result = std::make_shared<Result>();
  result->isNew = !present || !supportsFills(present->table());
  result->hasReplaced = result->isNew && present;
  // Two bodies of one name would overlap and be indistinguishable.
  const std::set<std::string> taken = result->isNew ? std::set<std::string>() : bodyNames(session_);
  for (segmentation::BodyRequest &request : requests) {
    if (taken.contains(request.name))
      result->failed.emplace_back(
          request.name, Error{ErrorCode::usage, request.name + ": the simulation has a body of this name already; "
                                                               "accepted: another name"});
    else
      result->notTried.push_back(std::move(request));
  }
  if (result->notTried.empty()) return events_.failed(title, result->failed.front().second);
  std::shared_ptr<ObjectRef> simulator;
  if (!result->isNew) {
    c3de_object *object = present->object();
    object->vt->retain(object);
    simulator = std::make_shared<ObjectRef>(object);
  } else {
    auto created = session_.createSimulator();
    if (!created) return events_.failed(title, created.error());
    simulator = std::make_shared<ObjectRef>(*created);
  }
  const std::shared_ptr<ChangeLog> changes = result->isNew ? nullptr : session_.changes();
  job_ = session_.jobs().submit(
      kJobOwner, "Creating " + names,
      [this, simulator, result, changes](const ProgressFn &progress) {
        struct Adding {
          ChangeLog *log;
          explicit Adding(ChangeLog *of) : log(of) {
            if (log) log->beginAdding();
          }
          ~Adding() {
            if (log) log->endAdding();
          }
        } const adding(changes.get());
        auto created = createAll(simulator->get(), changes, *result, progress);
        // The first frame that shows the simulation shows its state.
        if (created && result->isNew) publishSnapshot(simulator->get());
        return created;
      },
      [this, serial, simulator, result, title](const Expected<void> &done) {
        if (serial != serial_) return;
        job_ = {};
        if (!done) return events_.failed(title, done.error());
        if (result->isNew)
          if (auto adopted = session_.adopt(simulator->get(), namesOf(result->created),
                                            {result->scenes.begin(), result->scenes.end()});
              !adopted)
            return events_.failed(title, adopted.error());
        if (const scene::Simulation *now = session_.simulation(); !now || now->object() != simulator->get())
          return events_.failed(title, {ErrorCode::state, "the simulation that they were to join has been closed"});
        events_.created(*result);
      });
}

}  // namespace c3de::session
