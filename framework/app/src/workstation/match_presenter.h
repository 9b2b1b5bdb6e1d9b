// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "app.h"
#include "c3de/core/handle.h"
#include "c3de/render/renderer.h"
#include "c3de/scene/scene_graph.h"
#include "c3de/session/match_stages.h"

namespace c3de::app {

/// A landmark of a match in the space of the body.
struct ShownLandmark {
  Vec3 at_mm{}, target_mm{};  ///< where it is, and where it was measured
};

/// The skin of a matched body with its expected errors at the vertices; none: not known there.
struct ShownErrors {
  const geometry::TriangleMesh &skin;
  const std::vector<std::optional<double>> &errors_mm;
};

/// The measured points of a match in the 3D view: spheres with the colour of their distance to the surface, arrows from
/// the surface to them, targets of landmarks, expected errors of the body, and legends. Each part has a node in the
/// tree that shows and hides it.
/// Main thread.
class MatchPresenter {
 public:
  MatchPresenter(render::Renderer &renderer, scene::SceneGraph &scene) : renderer_(renderer), scene_(scene) {}
  ~MatchPresenter() { forget(); }
  MatchPresenter(const MatchPresenter &) = delete;
  MatchPresenter &operator=(const MatchPresenter &) = delete;

  /// Replaces what was shown. Points that are not used are grey.
  /// @param noise_mm  the colours end at three times the noise, or later
  /// @param parent    the node of the simulation
  void show(std::vector<MatchedPoint> points, const std::vector<ShownLandmark> &landmarks, double noise_mm,
            Handle parent);
  /// Adds the expected errors to what is shown, hidden at first. No effect without any.
  void addErrors(const ShownErrors &errors);
  void forget();
  /// Arrows are longer than the residuals by this factor, at least 1.
  void setArrowScale(double scale);
  /// Called before a frame: shows what is visible in the tree.
  void followTree();

 private:
  struct Part {
    Handle node;
    std::vector<Handle> proxies;
    bool isVisible = true;
  };
  [[nodiscard]] render::Legend legend() const;
  [[nodiscard]] render::Colour colourOf(const MatchedPoint &point) const;
  void addPoints();
  void drawArrows();
  void addLandmarks(const std::vector<ShownLandmark> &landmarks);

  render::Renderer &renderer_;
  scene::SceneGraph &scene_;
  std::vector<MatchedPoint> points_;
  double high_mm_ = 1.0;    ///< of the last colour
  double radius_mm_ = 1.0;  ///< of the spheres
  double arrowScale_ = 1.0;
  Handle group_, arrows_, legend_;
  std::vector<Part> parts_;
};

}  // namespace c3de::app
