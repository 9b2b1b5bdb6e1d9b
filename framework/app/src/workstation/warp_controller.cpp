// SPDX-License-Identifier: Apache-2.0
#include "workstation/warp_controller.h"

#include <string>
#include <utility>
#include <vector>

#include "c3de/session/fixed_region_rule.h"
#include "c3de/session/simulator_access.h"

namespace c3de::app {

WarpController::FixedRegionRequest WarpController::presentFixedRegions() const {
  const ui::ImageViews &views = images_.views();
  return {views.options().still, views.sharedImage(), views.sharedLabels()};
}

void WarpController::request() {
  scene::Simulation *simulation = session_.simulation();
  const scene::StoredImage *image = images_.views().image();
  const bool wanted = settings_.warp && simulation && image && supportsFills(simulation->table());
  requestedFixedRegions_ = presentFixedRegions();
  sampler_.want(wanted, settings_.rim_mm, wanted ? image->volume.geometry : imaging::VolumeGeometry{},
                wanted ? fixedRegions() : FixedRegions{});
  if (!wanted) return images_.showDisplacement(nullptr);
  simulation->post([] {});  // publishes once more
}

FixedRegions WarpController::fixedRegions() const {
  const ui::ImageViews &views = images_.views();
  FixedRegions places{views.sharedImage(), views.sharedLabels(), {}, tissues_.bodies()};
  auto rule = fixedRegionRuleOf(views.options().still, places.image->volume,
                                places.labels ? &places.labels->map : nullptr, session_.materials());
  if (rule)
    places.rule = std::move(*rule);
  else
    failed_("Everything in the image moves with the bodies", rule.error());
  return places;
}

/// Fields of the tissue, while they are visible.
void WarpController::requestFields() {
  ui::ImageViews &views = images_.views();
  std::vector<std::pair<std::string, std::string>> offered;
  for (const PointField &field : sampler_.offered()) offered.emplace_back(field.name, field.unit);
  views.setOfferedFields(std::move(offered));
  images_.followOverlay();
  const ui::ImageOptions &options = views.options();
  const RequestedFields wanted{views.wantsFields(),
                               options.overlay == ui::Overlay::field ? options.overlayField : std::string()};
  if (wanted == requestedFields_) return;
  requestedFields_ = wanted;
  sampler_.requestFields(wanted);
  scene::Simulation *simulation = session_.simulation();
  const imaging::DisplacementGrid *shown = views.displacement();
  const bool isThere =
      shown && shown->field(imaging::kVolumeRatio) && (wanted.name.empty() || shown->field(wanted.name));
  if (wanted.any && simulation && !isThere) simulation->post([] {});  // publishes once more
}

void WarpController::showLatest() {
  if (sampler_.wanted() && requestedFixedRegions_ != presentFixedRegions()) request();
  if (auto newest = sampler_.take()) images_.showDisplacement(std::move(newest));
  requestFields();
}

}  // namespace c3de::app
