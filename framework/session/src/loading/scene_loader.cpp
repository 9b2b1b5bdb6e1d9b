// SPDX-License-Identifier: Apache-2.0
#include "loading/scene_loader.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "c3de/core/text.h"
#include "c3de/session/scene_to_abi.h"
#include "c3de/session/tissues.h"
#include "loading/body_loader.h"
#include "loading/touch_loader.h"

namespace c3de::session {
namespace {

bool isSettled(const scene::SceneFile &scene) {
  return std::all_of(scene.bodies.begin(), scene.bodies.end(),
                     [](const scene::SceneBody &body) { return !body.volume.hasTissues() || body.volume.isSettled; });
}

Expected<void> setWorld(const LoadingScene &loading) {
  const std::vector<c3de_param_value> world = toAbi(loading.fitted().world);
  const c3de_status code =
      loading.table()->set_world(loading.simulator(), world.data(), world.size(), sizeof(c3de_param_value));
  if (code < 0) return tl::unexpected(loading.failure(code, "setting the world", 0));
  return {};
}

Expected<void> addProbes(const LoadingScene &loading, const NamedHandles &handles) {
  for (const scene::SceneProbe &probe : loading.scene().probes) {
    c3de_handle added{};
    const c3de_status code = loading.table()->add_probe(loading.simulator(), c3de::toAbi(probe.name),
                                                        handles.at(probe.body), probe.at_m.data(), &added);
    if (code < 0) return tl::unexpected(loading.failure(code, "adding probe '" + probe.name + "'", probe.line));
  }
  return {};
}

}  // namespace

Expected<LoadingScene> SceneLoader::begin(const scene::SceneFile &asked) {
  // Also before a label map is read, so that an invalid key is reported first.
  auto fitted = fitScene(simulator_, asked);
  if (fitted && !isSettled(fitted->scene)) {
    const auto settled = resolveTissues(fitted->scene, services_.materials, sources_, progress_, prepared_.took);
    if (!settled) return tl::unexpected(settled.error());
    fitted = fitScene(simulator_, std::move(fitted->scene));
  }
  if (!fitted) return tl::unexpected(fitted.error());
  return LoadingScene::into(simulator_, services_.host, std::move(*fitted));
}

Expected<NamedHandles> SceneLoader::addSkins(const LoadingScene &loading) {
  return BodyLoader(loading, services_.meshes, services_.meshFormats, sources_, progress_).add(prepared_);
}

Expected<void> SceneLoader::populate(const scene::SceneFile &scene) {
  const auto loading = begin(scene);
  if (!loading) return tl::unexpected(loading.error());
  if (auto set = setWorld(*loading); !set) return set;
  auto handles = addSkins(*loading);
  if (!handles) return tl::unexpected(handles.error());
  prepared_.notices = sources_.reportedNotices();
  if (auto added = addProbes(*loading, *handles); !added) return added;
  return addTouch(*loading, std::move(*handles));
}

Expected<void> SceneLoader::addBodies(const scene::SceneFile &scene) {
  scene::SceneFile bodies = scene;
  bodies.obstacles.clear();
  const auto loading = begin(bodies);
  if (!loading) return tl::unexpected(loading.error());
  const auto handles = addSkins(*loading);
  if (!handles) return tl::unexpected(handles.error());
  prepared_.notices = sources_.reportedNotices();
  return {};
}

}  // namespace c3de::session
