// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_update.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>

#include "c3de/abi/iface/continuation.h"
#include "c3de/core/plugin_call.h"
#include "c3de/core/plugin_table.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/session.h"

namespace c3de {

template <>
struct TableSlots<c3de_continuation_v0> {
  using Table = c3de_continuation_v0;
  static constexpr const char *name = C3DE_IFACE_CONTINUATION_ID;
  static constexpr std::array slots = {TableSlot{"continue_from", offsetof(Table, continue_from), 1}};
};

}  // namespace c3de

namespace c3de::session {
namespace {

const scene::SceneBody *maskedBody(const SharedScene &scene, const std::string &name) {
  const auto found = std::find_if(scene->bodies.begin(), scene->bodies.end(), [&](const scene::SceneBody &body) {
    return body.name == name && body.volume.mask != nullptr;
  });
  return found == scene->bodies.end() ? nullptr : &*found;
}

}  // namespace

std::vector<MaskedBody> maskedBodies(const SimulationSource &source) {
  std::vector<MaskedBody> bodies;
  for (const auto &entry : source) {
    const auto *scene = std::get_if<SharedScene>(&entry);
    if (scene == nullptr) continue;
    for (const scene::SceneBody &body : (*scene)->bodies) {
      if (!body.volume.mask) continue;
      std::erase_if(bodies, [&body](const MaskedBody &earlier) { return earlier.name == body.name; });
      bodies.push_back({body.name, body.volume.mask});
    }
  }
  return bodies;
}

Expected<SimulationSource> withMask(const SimulationSource &source, const std::string &body,
                                    std::shared_ptr<const imaging::Mask> mask) {
  if (!mask || std::none_of(mask->voxels.begin(), mask->voxels.end(), [](std::uint8_t voxel) { return voxel != 0; }))
    return fail(ErrorCode::usage, body + ": the mask is empty; accepted: a mask with voxels");
  SimulationSource changed = source;
  // The last one: an earlier body of this name has been removed.
  for (auto entry = changed.rbegin(); entry != changed.rend(); ++entry) {
    auto *scene = std::get_if<SharedScene>(&*entry);
    if (scene == nullptr || maskedBody(*scene, body) == nullptr) continue;
    scene::SceneFile copy = **scene;
    const auto index = maskedBody(*scene, body) - (*scene)->bodies.data();
    copy.bodies[static_cast<std::size_t>(index)].volume.mask = std::move(mask);
    *scene = std::make_shared<const scene::SceneFile>(std::move(copy));
    return changed;
  }
  return fail(ErrorCode::usage,
              body +
                  ": no body of this name was created from a mask; accepted: bodies that were created from one "
                  "structure picked in an image");
}

Expected<std::vector<ContinuedBody>> continueFrom(Session &session, c3de_object *simulator, c3de_object *other) {
  const auto found = queryObject(simulator, C3DE_IFACE_CONTINUATION_ID, 1);
  if (!found) return fail(ErrorCode::plugin, "the simulator cannot continue from the state of another one");
  const auto *table = static_cast<const c3de_continuation_v0 *>(*found);
  if (std::string problem = tableProblem(table); !problem.empty())
    return fail(ErrorCode::plugin, "the simulator's table of " + std::move(problem));
  std::string text;
  const c3de_status code =
      callPluginFunction(session.plugins().ownerOf(simulator), "continuing a simulation", CallKind::step,
                         [&] { return table->continue_from(simulator, other, scene::sinkInto(text)); });
  if (code < 0) {
    const std::string reason = session.plugins().takeError();
    return fail(ErrorCode::state, reason.empty() ? "status " + std::to_string(code) : reason);
  }
  const auto json = nlohmann::json::parse(text, nullptr, false);
  std::vector<ContinuedBody> bodies;
  if (json.is_object() && json.contains("bodies") && json["bodies"].is_array())
    for (const auto &body : json["bodies"])
      if (body.is_object())
        bodies.push_back({body.value("name", ""), body.value("same", false), body.value("energy_before_J", 0.0),
                          body.value("energy_after_J", 0.0)});
  return bodies;
}

}  // namespace c3de::session
