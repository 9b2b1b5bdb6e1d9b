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

[[nodiscard]] render::GridGeometry placeOf(const imaging::VolumeGeometry &geometry);
[[nodiscard]] render::ImageVoxels voxelsOf(const imaging::Volume &volume);  ///< points into the volume

/// Marks in the slices the parts of masks that are in no body, with an entry in their legend. Negligible parts are not
/// marked. Replaces the previous marks. No effect without an image.
[[nodiscard]] Expected<void> showMissing(render::ImageRenderer &images, ui::ImageViews &views,
                                         const std::vector<Coverage> &bodies);

/// The displacement shown by the views, in graphics memory: u and gaps, and the reference region of the bodies. Main
/// thread.
class DisplacementPresenter {
 public:
  DisplacementPresenter(render::ImageRenderer *images, ui::ImageViews &views) : images_(images), views_(views) {}
  ~DisplacementPresenter() { forget(); }
  DisplacementPresenter(const DisplacementPresenter &) = delete;
  DisplacementPresenter &operator=(const DisplacementPresenter &) = delete;

  /// Shows the displacement of the tissue; the grid must not change while it is shown. Null: no displacement. Called
  /// every frame: a grid that replaces a previous one only transfers its values. No effect without an image.
  [[nodiscard]] Expected<void> show(std::shared_ptr<const imaging::DisplacementGrid> displacement);
  /// Shows the field currently requested by the views, for the displayed displacement.
  void followOverlay() { showField(); }
  /// Releases its graphics memory; called before the image is removed.
  void forget();

 private:
  [[nodiscard]] bool takesValues(const imaging::DisplacementGrid &displacement) const;
  void showField();
  void showBodies(std::shared_ptr<const imaging::Mask> bodies);

  render::ImageRenderer *images_;  ///< null: nothing is drawn
  ui::ImageViews &views_;
  std::shared_ptr<const imaging::Mask> bodies_;
  std::shared_ptr<const imaging::DisplacementGrid> shown_;
  Handle fieldOn_{};  ///< the displacement whose graphics memory holds the field
  std::shared_ptr<const imaging::DisplacementGrid> fieldOf_;
  std::string fieldName_;
};

}  // namespace c3de::app
