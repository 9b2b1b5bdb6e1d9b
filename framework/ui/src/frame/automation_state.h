// SPDX-License-Identifier: Apache-2.0
// A mirror of the window as JSON. Scripts and tests use it to find widgets and values; assistive tools can read it out.
// Written atomically (a temporary file next to it is renamed), at most 20 times a second.
//
//   frame          number of frames drawn
//   processor_s    processor time of the program so far, all threads, s
//   window         [width, height] in window pixels
//   view           {x, y, w, h}: the 3D view in window pixels
//   area           same for all views: everything right of the side panel
//   panes          {axial, sagittal, coronal, 3D}: visible views of an image, in the form of `view`; {} without one
//   mouse          {x, y, buttons}: in the last frame; buttons as in C3DE_BUTTON_*
//   focused        the window has the keyboard focus
//   text_input     a text field receives what is typed
//   widgets        "area/id": [x0, y0, x1, y1] of every clickable item, clipped to its visible part. Areas:
//                  menu, toolbar, scene, dialog, notification, job, window, and the id of each panel with the ids of
//                  its widgets (a parameter has its own id, its "auto" box ".auto", an open list ".option.NAME")
//   scrolled_out   "area/id": same for items that exist but are scrolled out of their panel
//   disabled       ["area/id", …] items of `widgets` that do not respond at present
//   values         "area/name": text of value rows and of what widgets show
//   transport      {exists, title, mode, steps, time_s, target_rate, real_time_factor, step_ms, step_running_s,
//                  activity}; mode: stopped, playing, paused, failed; activity: what takes long in a step, and what
//                  would help
//   tool           id of the active tool, "orbit" for none
//   notifications  [{severity, title, text}], severity: debug, info, warn, error
//   jobs           [{title, what, fraction}]
//   camera         {yaw, pitch, distance, focus: [x, y, z]}
//   nodes          [{name, depth, visible}] of the scene
//   answers        [[frame, x, y, characters, shown_s], …] of the latest frames that processed input: the mouse
//                  as in `mouse`, the total number of characters processed, and the time at which the frame had been
//                  shown, s on the steady clock
//   closing        true in the last written state
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>

namespace c3de::ui {

struct FrameContext;

class AutomationState {
 public:
  /// @param file  empty: nothing is recorded or written
  explicit AutomationState(std::filesystem::path file);
  ~AutomationState();

  using Rect = std::array<float, 4>;
  void beginFrame();
  void widget(const std::string &area, const std::string &id, const Rect &rect, const Rect &clip, bool enabled);
  void value(const std::string &area, const std::string &name, const std::string &text);
  /// Records the rest of the frame; writes when a write is due.
  void endFrame(const FrameContext &frame, double now_s);
  /// The frame is on the screen. @param characters  number it has processed
  void shown(const FrameContext &frame, std::size_t characters);

  [[nodiscard]] bool isOn() const;
  /// Seconds until changes may be written; negative: there are none.
  [[nodiscard]] double secondsUntilWrite(double now_s) const;
  void writeIfDue(double now_s);
  void writeNow(bool isClosing);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::ui
