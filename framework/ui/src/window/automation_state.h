// SPDX-License-Identifier: Apache-2.0
// A mirror of the window as JSON: scripts and tests find widgets and values in it, and tools for people who cannot use
// the screen can read it out. Written atomically (a file beside it is renamed), at most 20 times a second.
//
//   frame          number of frames drawn
//   processor_s    processor time of the program until then, all threads, s
//   window         [width, height] in window pixels
//   view           {x, y, w, h}: the 3D view in window pixels
//   area           the same of all views: what is right of the side panel
//   panes          {axial, sagittal, coronal, 3D}: those of an image that are visible, as view; {} without an image
//   mouse          {x, y, buttons}: as the last frame saw it; buttons as in C3DE_BUTTON_*
//   focused        the window has the keyboard
//   widgets        "area/id": [x0, y0, x1, y1] of everything that can be clicked, clipped to what is visible. Areas:
//                  menu, toolbar, scene, dialog, notification, job, window, and the id of each panel with the ids of
//                  its widgets (a parameter has its own id, its "auto" box ".auto", an open list ".option.NAME")
//   scrolled_out   "area/id": the same for what exists but is scrolled out of its panel
//   disabled       ["area/id", …] of those in `widgets` that do not react now
//   values         "area/name": text of value rows and of what widgets show
//   transport      {exists, title, mode, steps, time_s, target_rate, real_time_factor, step_ms, step_running_s,
//                  activity}; mode: stopped, playing, paused, failed; activity: of a step that takes long, what would
//                  help
//   tool           id of the active tool, "orbit" for none
//   notifications  [{severity, title, text}], severity: debug, info, warn, error
//   jobs           [{title, what, fraction}]
//   camera         {yaw, pitch, distance, focus: [x, y, z]}
//   nodes          [{name, depth, visible}] of the scene
//   answers        [[frame, x, y, characters, shown_s], …] of the newest frames that took input: the mouse as in
//                  `mouse`, characters that had been taken in all, and when the frame had been shown, s on the steady
//                  clock
//   closing        true in the last state that is written
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>

namespace c3de::ui {

struct FrameContext;

class AutomationState {
 public:
  /// @param file  empty: nothing is kept or written
  explicit AutomationState(std::filesystem::path file);
  ~AutomationState();

  using Rect = std::array<float, 4>;
  void beginFrame();
  void widget(const std::string &area, const std::string &id, const Rect &rect, const Rect &clip, bool enabled);
  void value(const std::string &area, const std::string &name, const std::string &text);
  /// Takes over the rest of the frame; writes when a write is due.
  void endFrame(const FrameContext &frame, double now_s);
  /// The frame is on the screen. @param characters  it has taken
  void shown(const FrameContext &frame, std::size_t characters);

  [[nodiscard]] bool isOn() const;
  /// Seconds until what has changed may be written; negative: nothing waits.
  [[nodiscard]] double secondsUntilWrite(double now_s) const;
  void writeIfDue(double now_s);
  void writeNow(bool isClosing);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::ui
