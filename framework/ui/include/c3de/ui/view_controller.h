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

/// An input event in a view.
struct ViewInput {
  enum class Kind { press, release, move, wheel, key };
  Kind kind = Kind::move;
  std::uint32_t button = 0;     ///< C3DE_BUTTON_*, for press and release
  std::uint32_t modifiers = 0;  ///< C3DE_MOD_*
  std::uint32_t key = 0;        ///< ASCII upper case
  double x = 0.0, y = 0.0;      ///< pixels from the view's upper left corner; may be outside during a drag
  double wheel = 0.0;
  double time_s = 0.0;
};

/// Mouse controls of the 3D view. The left button goes to the active tool and, if the tool does not use it, rotates the
/// camera. Middle or Shift+left pans; right or Ctrl+left and the wheel zoom. Main thread.
class ViewController {
 public:
  ViewController(registry::ToolRegistry &tools, render::Camera &camera) : tools_(tools), camera_(camera) {}

  void setViewSize(int width, int height);
  /// What is cut away cannot be picked: the ray of a press starts where it enters the remaining part.
  void setCuts(std::vector<render::CutPlane> cuts) { cuts_ = std::move(cuts); }
  /// Finds how far along the ray of a press the inside of a body is visible; none if it is not.
  void setInsideFinder(std::function<std::optional<double>(const render::Ray &)> find) {
    findInside_ = std::move(find);
  }
  /// True if the tool used the event, or the camera moved.
  bool handle(const ViewInput &input);
  /// For Escape and loss of focus: the tool releases what it holds, the camera stops. Buttons that are still down are
  /// ignored until released.
  void cancel();
  /// Between press and release of a button that was pressed in the view.
  [[nodiscard]] bool isDragging() const { return buttons_ != 0; }

 private:
  enum class Drag { none, tool, orbit, pan, zoom };
  [[nodiscard]] bool sendToTool(const ViewInput &input, std::uint32_t type);
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

/// Initial camera: from the front; for a patient slightly from the left and above.
void resetCamera(render::Camera &camera);
/// Rotates the camera so that it looks along the direction as closely as its pitch limit allows.
void lookAlong(render::Camera &camera, const Vec3 &direction);

}  // namespace c3de::ui
