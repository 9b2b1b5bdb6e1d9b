// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/render/camera.h"
#include "c3de/render/image_renderer.h"

namespace c3de::ui {

/// What happened in a view, in the order in which it happened.
struct ViewInput {
  enum class Kind { press, release, move, wheel, key };
  Kind kind = Kind::move;
  std::uint32_t button = 0;     ///< C3DE_BUTTON_*, of press and release
  std::uint32_t modifiers = 0;  ///< C3DE_MOD_*
  std::uint32_t key = 0;        ///< ASCII upper case
  double x = 0.0, y = 0.0;      ///< pixels from the view's upper left corner; may lie outside during a drag
  double wheel = 0.0;
  double time_s = 0.0;
};

/// Mouse habits of the 3D view: the left button belongs to the active tool and, where that does not want it, turns the
/// camera; middle or Shift+left shifts; right or Ctrl+left and the wheel zoom. Main thread.
class ViewController {
 public:
  ViewController(registry::ToolRegistry &tools, render::Camera &camera) : tools_(tools), camera_(camera) {}

  void setViewSize(int width, int height);
  /// What is cut away cannot be grasped: the ray of a press begins where it enters what is left.
  void setCuts(std::vector<render::CutPlane> cuts) { cuts_ = std::move(cuts); }
  /// Who knows how far along the ray of a press the inside of a body is seen; none: it is not.
  void setInsideFinder(std::function<std::optional<double>(const render::Ray &)> find) {
    findInside_ = std::move(find);
  }
  /// True: the tool took it, or the camera moved.
  bool handle(const ViewInput &input);
  /// Escape, loss of focus: the tool lets go, the camera stops. Buttons that are still down are ignored until released.
  void cancel();
  /// Between press and release of a button that was pressed in the view.
  [[nodiscard]] bool isDragging() const { return buttons_ != 0; }

 private:
  enum class Drag { none, tool, orbit, pan, zoom };
  [[nodiscard]] bool tellTool(const ViewInput &input, std::uint32_t type);
  [[nodiscard]] Drag dragOf(const ViewInput &input);

  registry::ToolRegistry &tools_;
  render::Camera &camera_;
  int width_ = 1, height_ = 1;
  std::vector<render::CutPlane> cuts_;
  std::function<std::optional<double>(const render::Ray &)> findInside_;
  Drag drag_ = Drag::none;
  Handle dragTool_;
  std::uint32_t buttons_ = 0, dragButton_ = 0;
  double lastX_ = 0.0, lastY_ = 0.0;
};

/// From where a view begins: the front; of a patient a little from the left and above.
void lookFromStart(render::Camera &camera);
/// Turns the camera so that it looks along the direction as closely as its pitch limit allows.
void lookAlong(render::Camera &camera, const Vec3 &direction);

}  // namespace c3de::ui
