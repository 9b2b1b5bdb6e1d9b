// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "app.h"
#include "c3de/core/expected.h"
#include "c3de/imaging/displacement.h"
#include "c3de/render/image_renderer.h"
#include "c3de/session/coverage.h"
#include "c3de/ui/image_views.h"

namespace c3de::app {

[[nodiscard]] render::GridPlace placeOf(const imaging::VolumeGeometry &geometry);
[[nodiscard]] render::ImageVoxels voxelsOf(const imaging::Volume &volume);  ///< points into it

/// Marks in the slices what of masks is in no body, with an entry in their legend; nothing where nothing is missing
/// that is worth saying. Takes the place of what was marked. Without an image nothing is done.
[[nodiscard]] Expected<void> showMissing(render::ImageRenderer &images, ui::ImageViews &views,
                                         const std::vector<Coverage> &bodies);

/// The displacement that the views show, in the memory of the graphics: u and gaps, and where the bodies were. Main
/// thread.
class DisplacementPresenter {
 public:
  DisplacementPresenter(render::ImageRenderer *images, ui::ImageViews &views) : images_(images), views_(views) {}
  ~DisplacementPresenter() { forget(); }
  DisplacementPresenter(const DisplacementPresenter &) = delete;
  DisplacementPresenter &operator=(const DisplacementPresenter &) = delete;

  /// Shows how the tissue has moved; the grid must not change while it is shown. Null: as it was. Every frame: a grid
  /// in the place of the one before only takes its values. Without an image nothing is done.
  [[nodiscard]] Expected<void> show(std::shared_ptr<const imaging::DisplacementGrid> displacement);
  /// Shows the field that the views ask for now, of the displacement that is shown.
  void followOverlay() { showField(); }
  /// Gives back what it has in the memory of the graphics; before the image goes.
  void forget();

 private:
  [[nodiscard]] bool takesValues(const imaging::DisplacementGrid &displacement) const;
  void showField();
  void showBodies(std::shared_ptr<const imaging::Mask> bodies);

  render::ImageRenderer *images_;  ///< null: nothing is drawn
  ui::ImageViews &views_;
  std::shared_ptr<const imaging::Mask> bodies_;
  std::shared_ptr<const imaging::DisplacementGrid> shown_;
  Handle fieldOn_{};  ///< the displacement that has it in the memory of the graphics
  std::shared_ptr<const imaging::DisplacementGrid> fieldOf_;
  std::string fieldName_;
};

}  // namespace c3de::app
