// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/platform.h"

namespace c3de::test {

using Json = nlohmann::json;

struct Point {
  double x = 0.0, y = 0.0;
};

/// A file in the folder of logs and screenshots, which exists.
std::filesystem::path outputFile(const std::string &name);

/// Runs the real program on the display of this process and operates it with mouse and keyboard (xdotool), polling the
/// automation state instead of sleeping. A wait that is not met for three minutes (with sanitizers, for longer) throws
/// std::runtime_error with the last state's essentials, which fails the test case. No wait is a measurement of speed:
/// each is met within 15 s on an idle machine.
class WorkstationDriver {
 public:
  /// @param name  of the scenario: names the log, the state file and the screenshots
  explicit WorkstationDriver(std::string name);
  ~WorkstationDriver();

  /// Why windows cannot be driven here; empty: they can.
  [[nodiscard]] static std::string whyNot();

  /// The panel of the simulation has the mode that a new user sees, or has chosen. Without this call it shows all rows
  /// from the start. Before start().
  void asNewUser() { isNewUser_ = true; }
  /// Starts the program and waits until its window is drawn.
  void start(const std::vector<std::string> &arguments);
  /// Starts it and waits for its end: for runs without a window.
  /// @return exit code
  [[nodiscard]] int startAndWait(const std::vector<std::string> &arguments,
                                 const std::vector<std::string> &environment = {});
  [[nodiscard]] std::string logText() const;
  [[nodiscard]] bool isRunning();
  /// As kill -9.
  void kill();
  /// @return exit code, after it has ended normally
  [[nodiscard]] int waitForExit();

  /// The newest state.
  [[nodiscard]] Json state() const;
  Json waitUntil(const std::string &what, const std::function<bool(const Json &)> &predicate);
  /// Waits for `count` more frames. Input makes the window draw, so this needs input just before.
  void waitFrames(int count, double idle_s = 3.0);  // or until none has been drawn for so long
  /// Waits until a value row shows this text.
  void waitForValue(const std::string &key, const std::string &text);
  [[nodiscard]] std::string value(const std::string &key) const;
  [[nodiscard]] double number(const std::string &key) const;
  /// Scrolls the side panel until the widget is visible; returns its centre in window pixels.
  Point locate(const std::string &widget);
  /// Moves the mouse to the middle of a widget, and waits until it stays there.
  void pointAt(const std::string &widget);
  [[nodiscard]] bool has(const std::string &widget) const;

  void moveTo(Point at);
  void press(int button = 1);
  void release(int button = 1);
  void click(const std::string &widget);
  /// Without waiting for frames: the program ends by it.
  void clickToEnd(const std::string &widget);
  void clickAt(Point at);
  void doubleClickAt(Point at);
  void controlClick(const std::string &widget);
  /// Presses at the first point, moves in steps, releases at the last one; each is processed in its own frame.
  void drag(Point from, Point to, int steps, int button = 1);
  /// The moves of a drag.
  void moveAlong(Point from, Point to, int steps);
  /// A point of the 3D view; 0 … 1 from its upper left corner.
  [[nodiscard]] Point inView(double u, double v) const;
  /// The same of one of the four views of an image.
  [[nodiscard]] Point inPane(const std::string &pane, double u, double v) const;
  /// A position in a slice that is not zoomed, mm from the middle of its view: to the right, and down.
  [[nodiscard]] Point inSlice(const std::string &pane, double right_mm, double down_mm) const;
  void wheel(int clicks);
  void key(const std::string &name);
  /// One right after the other, from one process.
  void keys(const std::vector<std::string> &names);
  /// Holds a key (xdotool's name, for example "ctrl") until keyUp().
  void keyDown(const std::string &name);
  void keyUp(const std::string &name);
  /// Waits until a text field receives input. @param delay_ms  between characters
  void type(const std::string &text, int delay_ms = 40);
  /// Replaces the number in a field, and confirms it by Return.
  void enterNumber(const std::string &field, const std::string &text);
  /// Opens a list and clicks on one of its options.
  void choose(const std::string &list, const std::string &option);
  /// Opens a menu and clicks on its item.
  /// @param item  with the name of the menu: "file.export_labels"
  void clickMenu(const std::string &item);
  /// In the file dialog that opens: replaces the path and opens it, or types one in the folder and presses Return.
  void openFile(const std::filesystem::path &file, int delay_ms = 40);
  void enterFile(const std::filesystem::path &file);
  /// PNG next to the log.
  void screenshot(const std::string &name);
  /// Waits until the picture is static: the state is written before the frame is on the screen, and on a busy machine
  /// that takes a while.
  void screenshotAtRest(const std::string &name);
  /// The number of pixels that differ visibly between two screenshots: of the 3D view, or of one of the four views of
  /// an image; of the whole screen for "screen".
  [[nodiscard]] double differingPixels(const std::string &first, const std::string &second,
                                       const std::string &pane = {}) const;
  /// Takes the screenshot `second` until more than `least` pixels differ from `first`: the picture follows the state,
  /// on a busy machine by seconds. False: they never did.
  [[nodiscard]] bool differsFrom(const std::string &first, const std::string &second, double least,
                                 const std::string &pane = {});

  /// The fraction of the 3D view of a screenshot with a colour, 0 … 1.
  /// @param condition  of r, g, b of a pixel, 0 … 1
  [[nodiscard]] double shareOfColour(const std::string &screenshot, const std::string &condition) const;

 private:
  void launch(const std::vector<std::string> &command);
  static void chooseAllRows();
  void xdotool(const std::vector<std::string> &arguments);

  std::string name_;
  bool isNewUser_ = false;
  std::filesystem::path folder_, stateFile_, log_;
  std::optional<ChildProcess> program_;
};

}  // namespace c3de::test

#define C3DE_WINDOW_OR_SKIP() \
  if (const std::string reason = c3de::test::WorkstationDriver::whyNot(); !reason.empty()) C3DE_SKIP(reason)
/// Windows that simulate with the point-based plugin.
#define C3DE_ORGAN_OR_SKIP()                                                           \
  C3DE_WINDOW_OR_SKIP();                                                               \
  if (!std::filesystem::exists(std::filesystem::path(testPluginFolder()) /             \
                               (std::string("pointbased") + c3de::pluginExtension()))) \
  C3DE_SKIP("the point-based plugin is not built")

/// window.waitUntil() for a condition on the state `s`.
#define C3DE_WAIT(window, what, ...) (window).waitUntil(what, [&](const c3de::test::Json &s) { return __VA_ARGS__; })
