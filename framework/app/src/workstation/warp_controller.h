// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <tuple>

#include "app.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/displacement_sampler.h"
#include "c3de/session/session.h"
#include "c3de/session/tissue_tracker.h"
#include "workstation/messages.h"
#include "workstation/workstation_images.h"

namespace c3de::app {

/// Warps the open image with the bodies of the simulation while both exist, and requests the tissue fields that the
/// views show. Main thread, except onPublished(). Must outlive the session.
class WarpController {
 public:
  WarpController(Session &session, WorkstationImages &images, const TissueTracker &tissues, ReportError failed)
      : session_(session), images_(images), tissues_(tissues), failed_(std::move(failed)) {}

  /// How images deform with the simulation, as its scene specifies.
  void setSettings(const scene::SceneImage &settings) { settings_ = settings; }
  [[nodiscard]] double falloff_mm() const { return settings_.rim_mm; }
  /// Starts with the present simulation.
  void begin() { sampler_.begin(); }
  /// Requests the displacement for the open image; without one, or without bodies, the image is shown undeformed.
  void request();
  /// The image has been closed.
  void stop() { sampler_.want(false, settings_.rim_mm); }
  /// Called before a frame, so that its texts agree with its slices.
  void showLatest();
  /// Fixed regions of the open image, as set in the panel.
  [[nodiscard]] FixedRegions fixedRegions() const;

  /// As DisplacementSampler. [simulation's thread]
  std::shared_ptr<const imaging::DisplacementGrid> onPublished(const scene::Simulation &simulation) {
    return sampler_.onPublished(simulation);
  }
  [[nodiscard]] bool wanted() const { return sampler_.wanted(); }
  [[nodiscard]] bool isBehind() const { return sampler_.isBehind(); }

 private:
  using FixedRegionRequest = std::tuple<scene::SceneFixedRegions, std::shared_ptr<const scene::StoredImage>,
                                        std::shared_ptr<const scene::StoredLabels>>;
  [[nodiscard]] FixedRegionRequest presentFixedRegions() const;
  void requestFields();

  Session &session_;
  WorkstationImages &images_;
  const TissueTracker &tissues_;
  ReportError failed_;
  DisplacementSampler sampler_;
  scene::SceneImage settings_;
  RequestedFields requestedFields_;
  FixedRegionRequest requestedFixedRegions_;
};

}  // namespace c3de::app
