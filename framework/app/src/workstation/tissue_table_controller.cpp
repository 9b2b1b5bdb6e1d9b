// SPDX-License-Identifier: Apache-2.0
#include "workstation/tissue_table_controller.h"

#include "c3de/render/image_renderer.h"

namespace c3de::app {

ui::TissueRow TissueTableController::rowOf(const TissueVoxels &body, const LabelVoxels &label,
                                           const LabelMotion *motion) const {
  constexpr double kMillilitres = 1e6, kMillimetres = 1e3;
  ui::TissueRow row;
  const scene::SceneTissue tissue = body.tissueAt(label.tissue);
  row.label = label.value == 0 ? "background" : label.name;
  row.tissue = tissue.preset;
  row.isRigid = tissue.isRigid;
  if (const scene::StoredLabels *shown = views_.labels())
    for (const auto &one : shown->map.labels)
      if (one.value == label.value && one.name == label.name) {
        const render::Colour colour = render::displayColour(one.colour);
        row.colour = {colour[0], colour[1], colour[2]};
      }
  row.reference_ml = 1e-3 * body.voxel_mm3 * static_cast<double>(label.voxels);
  if (motion && motion->isKnown()) {
    row.reference_ml = kMillilitres * motion->reference_m3;
    row.motion = {kMillilitres * motion->end_m3, kMillimetres * motion->meanDisplacement_m(),
                  kMillimetres * motion->largestDisplacement_m, motion->minJ};
  }
  return row;
}

void TissueTableController::update() {
  tracker_.want(table_.isShown);
  const auto bodies = tracker_.bodies();
  const auto newest = tracker_.newest();
  if (bodies == shownBodies_ && newest == shownMotions_) return;
  shownBodies_ = bodies;
  shownMotions_ = newest;
  table_.rows.clear();
  if (!bodies) return;
  for (std::size_t b = 0; b < bodies->size(); ++b) {
    const TissueVoxels &body = (*bodies)[b];
    for (std::size_t i = 0; i < body.labels.size(); ++i) {
      if (body.labels[i].voxels == 0) continue;
      const bool hasMotion = newest && b < newest->size() && i < (*newest)[b].labels.size();
      table_.rows.push_back(rowOf(body, body.labels[i], hasMotion ? &(*newest)[b].labels[i] : nullptr));
    }
  }
}

}  // namespace c3de::app
