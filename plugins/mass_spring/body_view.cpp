// SPDX-License-Identifier: Apache-2.0
#include "body_view.h"

namespace mass_spring {
namespace {

constexpr std::array<float, 3> kColour{0.34f, 0.55f, 0.66f};  // not that of other simulators' organs

}  // namespace

void SimulatorView::update() {
  const auto snapshot = simulator_.snapshot();
  if (!snapshot || snapshot == shownSnapshot_) return;
  shownSnapshot_ = snapshot;
  std::erase_if(shown_, [&](const auto &shown) {
    return std::none_of(snapshot->bodies.begin(), snapshot->bodies.end(),
                        [&](const Snapshot::Body &body) { return body.id == shown.first; });
  });
  for (const Snapshot::Body &body : snapshot->bodies) {
    const c3de_view positions = sdk::rows<double, 3>(body.skin);
    const auto found = shown_.find(body.id);
    if (found != shown_.end()) {
      sdk::orThrow(render_.update(found->second.skin.handle(), C3DE_ATTR_POSITIONS, positions));
      continue;
    }
    const std::array<float, 3> c = body.colour.value_or(kColour);
    Shown shown;
    shown.node = sdk::orThrow(scene_.addNode(node_, body.name));
    shown.skin =
        sdk::orThrow(render_.createMesh(shown.node.handle(), positions, sdk::rows<std::uint32_t, 3>(*body.triangles),
                                        {{c[0], c[1], c[2], 1.0f}, false}));
    shown_.emplace(body.id, std::move(shown));
  }
}

}  // namespace mass_spring
