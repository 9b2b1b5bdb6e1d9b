// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "app.h"
#include "c3de/core/handle.h"
#include "c3de/render/renderer.h"
#include "c3de/scene/scene_graph.h"
#include "c3de/session/tissue_surfaces.h"

namespace c3de::app {

/// Surfaces of tissues in the 3D view, each with a node in the tree that shows and hides it. Main thread.
class TissuePresenter {
 public:
  TissuePresenter(render::Renderer &renderer, scene::SceneGraph &scene) : renderer_(renderer), scene_(scene) {}
  ~TissuePresenter() { forget(); }
  TissuePresenter(const TissuePresenter &) = delete;
  TissuePresenter &operator=(const TissuePresenter &) = delete;

  /// Replaces what was shown.
  /// @param parent  the node of the simulation; the nodes of the tissues are removed with it
  void show(std::shared_ptr<const std::vector<TissueSurface>> surfaces, Handle parent);
  void forget();
  /// Moves the displayed surfaces; no effect for others.
  void place(const std::shared_ptr<const SurfacePositions> &places);
  /// Called before a frame: shows the surfaces that are visible in the tree.
  void followTree();
  /// Null if there are none, or if the tree shows none that moves.
  [[nodiscard]] std::shared_ptr<const std::vector<TissueSurface>> seen() const;

 private:
  struct Drawn {
    Handle node, mesh;
    bool isVisible = true;
  };
  render::Renderer &renderer_;
  scene::SceneGraph &scene_;
  std::shared_ptr<const std::vector<TissueSurface>> surfaces_;
  std::shared_ptr<const SurfacePositions> places_;
  Handle group_;
  std::vector<Drawn> drawn_;
};

}  // namespace c3de::app
