// SPDX-License-Identifier: Apache-2.0
#include "loading/touch_loader.h"

#include <string>
#include <vector>

#include "c3de/core/text.h"
#include "c3de/session/scene_to_abi.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

Expected<void> addAttachments(const LoadingScene &loading, const NamedHandles &handles) {
  const auto table = attachmentTable(loading.simulator());
  if (!table) return tl::unexpected(table.error());
  for (const scene::SceneAttachment &attachment : loading.scene().attachments) {
    const c3de_sim_region region = toAbi(attachment.region.value_or(scene::SceneRegion{}));
    c3de_sim_attachment abi{};
    abi.size = sizeof abi;
    abi.flags = attachment.within_m ? C3DE_SIM_ATTACHMENT_WITHIN : 0u;
    abi.name = c3de::toAbi(attachment.name);
    abi.first = handles.at(attachment.names[0]);
    abi.second = handles.at(attachment.names[1]);
    abi.region = &region;
    abi.within_m = attachment.within_m.value_or(0.0);
    abi.stiffness_Pa_m = attachment.stiffness_Pa_m;
    abi.tangential_Pa_m = attachment.tangential_Pa_m();
    abi.tears_at_Pa = attachment.tearsAt_Pa;
    c3de_handle added{};
    if (const c3de_status code = (*table)->add(loading.simulator(), &abi, &added); code < 0)
      return tl::unexpected(loading.failure(code, "adding attachment '" + attachment.name + "'", attachment.line));
  }
  return {};
}

Expected<void> addGrasps(const LoadingScene &loading, const NamedHandles &handles) {
  const auto table = graspTable(loading.simulator());
  if (!table) return tl::unexpected(table.error());
  for (const scene::SceneGrasp &grasp : loading.scene().grasps) {
    const std::vector<c3de_sim_grasp_place> path = toAbi(grasp.path);
    c3de_sim_grasp abi = toAbi(grasp, path);
    abi.body = handles.at(grasp.body);
    c3de_handle added{};
    if (const c3de_status code = (*table)->add(loading.simulator(), &abi, &added); code < 0)
      return tl::unexpected(loading.failure(code, "adding grasp '" + grasp.name + "'", grasp.line));
  }
  return {};
}

/// Probe tools after the bodies that they may be in, then the pairs that may refer to them.
Expected<void> addContacts(const LoadingScene &loading, NamedHandles &handles) {
  const scene::SceneFile &scene = loading.scene();
  if (scene.probeTools.empty() && scene.contactPairs.empty()) return {};
  const auto table = contactTable(loading.simulator());
  if (!table) return tl::unexpected(table.error());
  for (const scene::SceneProbeTool &tool : scene.probeTools) {
    const std::vector<c3de_sim_tool_place> path = toAbi(tool.path);
    const c3de_sim_probe_tool abi = toAbi(tool, path);
    c3de_handle added{};
    if (const c3de_status code = (*table)->add_probe_tool(loading.simulator(), &abi, &added); code < 0)
      return tl::unexpected(loading.failure(code, "adding probe tool '" + tool.name + "'", tool.line));
    handles[tool.name] = added;
  }
  for (const scene::SceneContactPair &pair : scene.contactPairs) {
    c3de_sim_contact_pair abi{};
    abi.size = sizeof abi;
    abi.flags = (pair.friction ? C3DE_SIM_PAIR_HAS_FRICTION : 0u) | (pair.enabled ? 0u : C3DE_SIM_PAIR_OFF) |
                (pair.fits ? C3DE_SIM_PAIR_FITS : 0u);
    abi.first = handles.at(pair.names[0]);
    abi.second = handles.at(pair.names[1]);
    abi.friction = pair.friction.value_or(0.0);
    if (const c3de_status code = (*table)->set_pair(loading.simulator(), &abi); code < 0)
      return tl::unexpected(loading.failure(
          code, "setting the contact of '" + pair.names[0] + "' and '" + pair.names[1] + "'", pair.line));
  }
  return {};
}

}  // namespace

Expected<void> addTouch(const LoadingScene &loading, NamedHandles handles) {
  handles.emplace(scene::kWallsName, c3de_handle{0});
  handles[scene::kSurroundingsName] = {0};
  if (auto good = addAttachments(loading, handles); !good) return good;
  if (auto good = addGrasps(loading, handles); !good) return good;
  return addContacts(loading, handles);
}

}  // namespace c3de::session
