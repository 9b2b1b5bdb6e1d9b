// SPDX-License-Identifier: Apache-2.0
#include "ui/workstation_driver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include "support/environment.h"
#include "support/folders.h"
#include "ui/program_command.h"
#include "ui/workstation_state.h"

namespace c3de::test {
namespace {

using Clock = std::chrono::steady_clock;

// Twelve times the longest wait on an idle machine: a wait that ends here hangs, and is not slow.
constexpr double kPatience_s = 180.0;
constexpr double kOpening_s = 10.0;  // until a number that was clicked is a text field

void pause(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

double secondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

std::string readText(const std::filesystem::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

Point pointIn(const Json &rect, double u, double v) {
  return {rect["x"].get<double>() + u * rect["w"].get<double>(), rect["y"].get<double>() + v * rect["h"].get<double>()};
}

// The most informative part comes first: messages may be cut off.
std::string essentials(const Json &state) {
  nlohmann::ordered_json shown;
  for (const char *key : {"jobs", "notifications", "transport", "tool", "frame", "mouse", "values", "camera", "nodes"})
    if (state.contains(key)) shown[key] = state[key];
  return shown.dump(1);
}

// The program for Windows is driven in the same manner, on the display of this process.
bool isForWindows() { return !environmentVariable("C3DE_WINDOWS_BUILD").empty(); }

// What wine calls a file of this machine; plugins are those of the build for Windows.
std::string argumentForWindows(const std::string &argument) {
  if (!argument.starts_with('/')) return argument;
  const std::filesystem::path build = std::filesystem::path(testOutputRoot()).parent_path();
  std::filesystem::path file = argument;
  const std::filesystem::path inBuild = file.lexically_relative(build);
  if (file.extension() == pluginExtension() && !inBuild.empty() && *inBuild.begin() != "..")
    file = (environmentVariable("C3DE_WINDOWS_BUILD") / inBuild).replace_extension(".dll");
  return "Z:" + file.string();
}

// With its window program where `opensWindow`: it can be ended at once.
std::vector<std::string> commandFor(const std::vector<std::string> &arguments, bool opensWindow) {
  std::vector<std::string> all{C3DE_PROGRAM};
  if (isForWindows())
    all = {environmentVariable("C3DE_WINE"),
           environmentVariable("C3DE_WINDOWS_BUILD") + (opensWindow ? "/bin/c3de-workstation.exe" : "/bin/c3de.exe")};
  for (const std::string &argument : arguments) all.push_back(isForWindows() ? argumentForWindows(argument) : argument);
  return all;
}

}  // namespace

std::vector<std::string> programCommand(const std::vector<std::string> &arguments) {
  return commandFor(arguments, false);
}

std::filesystem::path fileOfProgram(const std::string &name) {
  if (!isForWindows() || !name.starts_with("Z:")) return name;
  std::string here = name.substr(2);
  std::replace(here.begin(), here.end(), '\\', '/');
  return here;
}

std::string nameInProgram(const std::filesystem::path &file) {
  return isForWindows() ? argumentForWindows(file.string()) : file.string();
}

std::filesystem::path outputFile(const std::string &name) {
  const std::filesystem::path folder = std::filesystem::path(testOutputRoot()) / "ui";
  std::filesystem::create_directories(folder);
  return folder / name;
}

WorkstationDriver::WorkstationDriver(std::string name)
    : name_(std::move(name)), folder_(outputFile("").parent_path()), stateFile_(outputFile(name_ + ".json")),
      log_(outputFile(name_ + ".log")) {
  std::error_code ignored;
  std::filesystem::remove(stateFile_, ignored);
}

WorkstationDriver::~WorkstationDriver() = default;

std::string WorkstationDriver::whyNot() {
  if (environmentVariable("DISPLAY").empty()) return "no display; these tests run under xvfb-run";
  for (const char *program : {"xdotool", "import"}) {
    const auto found = runProcess({program, program == std::string("import") ? "-version" : "version"}, 10.0);
    if (!found || found->exitCode != 0) return std::string(program) + " is not installed";
  }
  return {};
}

void WorkstationDriver::start(const std::vector<std::string> &arguments) {
  std::vector<std::string> all{"--automation-state", stateFile_.string()};
  all.insert(all.end(), arguments.begin(), arguments.end());
  launch(commandFor(all, true));
  if (isForWindows()) {
    // Without a window manager its first position leaves room for a title bar; the driver's points are those of the
    // screen. Wine may place it once more while it starts.
    int tries = 0;
    waitUntil("the window is in the corner of the screen", [&](const Json &s) {
      if (s["frame"].get<int>() < 2) return false;
      const int x = 700 + tries++ % 2;
      xdotool({"search", "--name", "^C3DE|C3DE$", "windowmove", "%@", "0", "0", "mousemove", std::to_string(x), "450"});
      pause(150);
      const Json now = state();
      return now["mouse"]["x"] == x && now["mouse"]["y"] == 450;
    });
  }
  // A few frames, so that everything that opens at the start has opened.
  waitUntil("the window is drawn",
            [](const Json &s) { return s["frame"].get<int>() >= 2 && s["focused"].get<bool>(); });
}

int WorkstationDriver::startAndWait(const std::vector<std::string> &arguments,
                                    const std::vector<std::string> &environment) {
  std::vector<std::string> all;
  if (!environment.empty()) {
    all.emplace_back("env");
    all.insert(all.end(), environment.begin(), environment.end());
  }
  const std::vector<std::string> command = commandFor(arguments, true);
  all.insert(all.end(), command.begin(), command.end());
  launch(all);
  return waitForExit();
}

/// As a user who has switched the panel of the simulation to All.
void WorkstationDriver::chooseAllRows() {
  const std::filesystem::path file = userConfigDirectory() / "settings" / "c3de.pointbased.json";
  Json settings = Json::parse(readText(file), nullptr, false);
  if (!settings.is_object()) settings = Json::object();
  if (settings.contains("panel.mode")) return;
  settings["panel.mode"] = "all";
  std::error_code unwritable;  // some scenarios have no folder for settings
  std::filesystem::create_directories(file.parent_path(), unwritable);
  std::ofstream(file, std::ios::binary) << settings.dump(2) << '\n';
}

void WorkstationDriver::launch(const std::vector<std::string> &command) {
  // Each driver has its own user folder: scenarios run in parallel and leave unsaved work.
  const std::string home = environmentVariable("C3DE_HOME");
  const ScopedEnvironment user("C3DE_HOME", home.empty() ? (folder_ / "user" / name_).string() : home);
  if (!isNewUser_) chooseAllRows();
  std::error_code ignored;
  if (home.empty())
    for (const std::filesystem::path &left : {userDataDirectory() / "recovery", userCacheDirectory() / "runs"})
      std::filesystem::remove_all(left, ignored);
  auto started = ChildProcess::start(command, log_);
  if (!started) throw std::runtime_error(started.error().message);
  program_ = std::move(*started);
}

std::string WorkstationDriver::logText() const { return readText(log_); }
bool WorkstationDriver::isRunning() { return program_ && program_->isRunning(); }

void WorkstationDriver::kill() { program_->kill(); }

int WorkstationDriver::waitForExit() {
  const auto code = program_->wait(C3DE_UI_PATIENCE * kPatience_s);
  if (!code) throw std::runtime_error("the program does not end: " + code.error().message + "\n" + logText());
  return *code;
}

Json WorkstationDriver::state() const {
  // The file is replaced atomically, but it may not exist yet.
  const Json read = Json::parse(readText(stateFile_), nullptr, false);
  return read.is_discarded() ? Json::object() : read;
}

Json WorkstationDriver::waitUntil(const std::string &what, const std::function<bool(const Json &)> &predicate) {
  const Clock::time_point begin = Clock::now();
  for (;;) {
    Json now = state();
    if (now.contains("frame") && predicate(now)) return now;
    if (program_ && !program_->isRunning())
      throw std::runtime_error("the program ended while waiting until " + what + "\n" + logText());
    if (secondsSince(begin) > C3DE_UI_PATIENCE * kPatience_s) {
      screenshot("timeout");
      throw std::runtime_error("timed out waiting until " + what + "; state: " + essentials(now) +
                               "\nlog: " + logText());
    }
    pause(20);
  }
}

void WorkstationDriver::waitFrames(int count, double idle_s) {
  // Without changes no frames are drawn.
  const int first = state().value("frame", 0);
  int last = first;
  Clock::time_point drawn = Clock::now();
  waitUntil(std::to_string(count) + " more frames are drawn", [&](const Json &s) {
    const int now = s["frame"].get<int>();
    if (std::exchange(last, now) != now) drawn = Clock::now();
    return now >= first + count || secondsSince(drawn) > C3DE_UI_PATIENCE * idle_s;
  });
}

void WorkstationDriver::waitForValue(const std::string &key, const std::string &text) {
  waitUntil("'" + key + "' shows '" + text + "'", [&](const Json &s) { return s["values"].value(key, "") == text; });
}

std::string WorkstationDriver::value(const std::string &key) const { return state()["values"].value(key, ""); }
double WorkstationDriver::number(const std::string &key) const { return std::strtod(value(key).c_str(), nullptr); }
bool WorkstationDriver::has(const std::string &widget) const { return state()["widgets"].contains(widget); }

Point WorkstationDriver::locate(const std::string &widget) {
  const auto middle = [](const Json &rect) {
    return Point{0.5 * (rect[0].get<double>() + rect[2].get<double>()),
                 0.5 * (rect[1].get<double>() + rect[3].get<double>())};
  };
  waitUntil("there is a widget '" + widget + "'",
            [&](const Json &s) { return s["widgets"].contains(widget) || s["scrolled_out"].contains(widget); });
  for (int tries = 0; tries < 100; ++tries) {
    const Json now = state();
    if (now["widgets"].contains(widget)) {
      // It may be about to move: a window that has just opened, a panel that scrolls.
      pause(80);
      const Json later = state();
      if (later["widgets"].contains(widget) && later["widgets"][widget] == now["widgets"][widget])
        return middle(now["widgets"][widget]);
      continue;
    }
    if (!now["scrolled_out"].contains(widget)) {
      pause(20);
      continue;
    }
    // Over the scroll bar of the panel, towards the widget: over a list the wheel would scroll the list.
    const double y = middle(now["scrolled_out"][widget]).y, top = now["area"]["y"], height = now["area"]["h"];
    moveTo({now["area"]["x"].get<double>() - 15.0, top + 0.5 * height});
    wheel(y < top + 0.5 * height ? 1 : -1);
    pause(60);
  }
  throw std::runtime_error("'" + widget + "' cannot be scrolled into view");
}

void WorkstationDriver::xdotool(const std::vector<std::string> &arguments) {
  std::vector<std::string> all{"xdotool"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  const auto result = runProcess(all, 10.0);
  if (!result || result->exitCode != 0)
    throw std::runtime_error("xdotool failed: " + (result ? result->errorOutput : result.error().message));
}

void WorkstationDriver::moveTo(Point at) {
  const int x = static_cast<int>(std::lround(at.x)), y = static_cast<int>(std::lround(at.y));
  xdotool({"mousemove", std::to_string(x), std::to_string(y)});
  waitUntil("the mouse is at " + std::to_string(x) + ", " + std::to_string(y), [&](const Json &s) {
    return std::lround(s["mouse"]["x"].get<double>()) == x && std::lround(s["mouse"]["y"].get<double>()) == y;
  });
}

void WorkstationDriver::press(int button) {
  const int first = state().value("frame", 0);
  xdotool({"mousedown", std::to_string(button)});
  waitUntil("the button is down",
            [&](const Json &s) { return s["mouse"]["buttons"].get<int>() != 0 && s["frame"].get<int>() >= first + 2; });
}

void WorkstationDriver::release(int button) {
  const int first = state().value("frame", 0);
  xdotool({"mouseup", std::to_string(button)});
  waitUntil("the button is up",
            [&](const Json &s) { return s["mouse"]["buttons"].get<int>() == 0 && s["frame"].get<int>() >= first + 2; });
}

void WorkstationDriver::clickToEnd(const std::string &widget) {
  pointAt(widget);
  xdotool({"click", "1"});
}

void WorkstationDriver::clickAt(Point at) {
  moveTo(at);
  press();
  release();
}

void WorkstationDriver::doubleClickAt(Point at) {
  moveTo(at);
  const int first = state().value("frame", 0);
  xdotool({"click", "--repeat", "2", "--delay", "60", "1"});
  waitUntil("the clicks are seen",
            [&](const Json &s) { return s["mouse"]["buttons"].get<int>() == 0 && s["frame"].get<int>() >= first + 4; });
}

void WorkstationDriver::click(const std::string &widget) {
  pointAt(widget);
  xdotool({"click", "1"});
  waitFrames(4, 0.3);
  waitUntil("the click is seen", [](const Json &s) { return s["mouse"]["buttons"].get<int>() == 0; });
}

void WorkstationDriver::controlClick(const std::string &widget) {
  pointAt(widget);
  xdotool({"keydown", "ctrl"});
  waitFrames(2);
  press();
  release();
  xdotool({"keyup", "ctrl"});
  waitFrames(2);
}

void WorkstationDriver::pointAt(const std::string &widget) {
  // A panel may grow while the mouse is moving: rows above the widget report the simulation. Under the mouse it is
  // fixed.
  for (int tries = 0; tries < 10; ++tries) {
    const Point at = locate(widget);
    moveTo(at);
    const Json now = state();
    const Json rect = now["widgets"].value(widget, Json());
    if (rect.is_array() && rect[0] <= at.x && at.x <= rect[2] && rect[1] <= at.y && at.y <= rect[3]) return;
  }
  throw std::runtime_error("'" + widget + "' does not stand still");
}

void WorkstationDriver::drag(Point from, Point to, int steps, int button) {
  moveTo(from);
  press(button);
  moveAlong(from, to, steps);
  release(button);
}

void WorkstationDriver::moveAlong(Point from, Point to, int steps) {
  for (int i = 1; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    moveTo({from.x + t * (to.x - from.x), from.y + t * (to.y - from.y)});
  }
}

void WorkstationDriver::enterNumber(const std::string &field, const std::string &text) {
  // A click during a slow step may miss: the row has moved before it is seen. As a user would, it is repeated.
  const auto opens = [this] {
    const Clock::time_point begin = Clock::now();
    while (!state().value("text_input", false))
      if (secondsSince(begin) > C3DE_UI_PATIENCE * kOpening_s) return false;
    return true;
  };
  controlClick(field);
  for (int tries = 1; tries < 3 && !opens(); ++tries) controlClick(field);
  key("ctrl+a");
  type(text);
  key("Return");
  waitUntil("the number is entered", [](const Json &s) { return !s["text_input"].get<bool>(); });
}

void WorkstationDriver::choose(const std::string &list, const std::string &option) {
  click(list);
  click(list + ".option." + option);
}

void WorkstationDriver::clickMenu(const std::string &item) {
  click("menu/" + item.substr(0, item.find('.')));
  click("menu/" + item);
}

void WorkstationDriver::openFile(const std::filesystem::path &file, int delay_ms) {
  C3DE_WAIT(*this, "a file is asked for", s["widgets"].contains("dialog/path"));
  key("ctrl+a");
  type(file.string(), delay_ms);
  click("dialog/open");
}

void WorkstationDriver::enterFile(const std::filesystem::path &file) {
  C3DE_WAIT(*this, "the dialog is open", s["widgets"].contains("dialog/path"));
  type(file.string());
  key("Return");
}

Point WorkstationDriver::inView(double u, double v) const { return pointIn(state()["view"], u, v); }

Point WorkstationDriver::inPane(const std::string &pane, double u, double v) const {
  return pointIn(state()["panes"][pane], u, v);
}

Point WorkstationDriver::inSlice(const std::string &pane, double right_mm, double down_mm) const {
  const Json now = state();
  const double scale = numberOf(now, "image/" + pane + ".scale_mm_per_px");
  const Point middle = pointIn(now["panes"][pane], 0.5, 0.5);
  return {middle.x + right_mm / scale, middle.y + down_mm / scale};
}

void WorkstationDriver::wheel(int clicks) {
  xdotool({"click", "--repeat", std::to_string(std::abs(clicks)), "--delay", "40", clicks > 0 ? "4" : "5"});
}

void WorkstationDriver::key(const std::string &name) {
  const int first = state().value("frame", 0);
  xdotool({"key", name});
  waitUntil("the key " + name + " is seen",
            [&](const Json &s) { return s["frame"].get<int>() >= first + 2 || s.value("closing", false); });
}

void WorkstationDriver::keys(const std::vector<std::string> &names) {
  std::vector<std::string> arguments{"key", "--delay", "1"};
  arguments.insert(arguments.end(), names.begin(), names.end());
  xdotool(arguments);
}

void WorkstationDriver::keyDown(const std::string &name) { xdotool({"keydown", name}); }
void WorkstationDriver::keyUp(const std::string &name) { xdotool({"keyup", name}); }

void WorkstationDriver::type(const std::string &text, int delay_ms) {
  // A field that a key has opened receives text from the next frame on.
  waitUntil("a text field receives what is typed", [](const Json &s) { return s["text_input"].get<bool>(); });
  const int first = state().value("frame", 0);
  xdotool({"type", "--delay", std::to_string(delay_ms), "--", text});
  waitUntil("the text is seen", [&](const Json &s) { return s["frame"].get<int>() > first; });
}

void WorkstationDriver::screenshot(const std::string &name) {
  (void)runProcess({"import", "-window", "root", (folder_ / (name_ + "-" + name + ".png")).string()}, 20.0);
}

void WorkstationDriver::screenshotAtRest(const std::string &name) {
  constexpr int kMaxTries = 20;
  screenshot(name);
  for (int tries = 0; tries < kMaxTries; ++tries) {
    const int frame = state().value("frame", 0);
    pause(300);
    screenshot("again");
    const double differing = differingPixels(name, "again", "screen");
    std::filesystem::rename(folder_ / (name_ + "-again.png"), folder_ / (name_ + "-" + name + ".png"));
    if (differing == 0.0 && state().value("frame", 0) == frame) return;
  }
  throw std::runtime_error("the picture '" + name + "' does not stand still");
}

bool WorkstationDriver::differsFrom(const std::string &first, const std::string &second, double least,
                                    const std::string &pane) {
  constexpr int kMaxTries = 20;
  for (int tries = 0; tries < kMaxTries; ++tries) {
    if (differingPixels(first, second, pane) > least) return true;
    pause(300);
    screenshot(second);
  }
  return false;
}

double WorkstationDriver::differingPixels(const std::string &first, const std::string &second,
                                          const std::string &pane) const {
  const auto file = [&](const std::string &name) { return (folder_ / (name_ + "-" + name + ".png")).string(); };
  const Json now = state();
  std::vector<std::string> command{"compare", "-metric", "AE", "-fuzz", "3%"};
  if (pane != "screen") {
    const Json view = pane.empty() ? now["view"] : now["panes"][pane];
    const auto whole = [&](const char *key) { return std::to_string(view[key].get<int>()); };
    command.insert(command.end(), {"-extract", whole("w") + "x" + whole("h") + "+" + whole("x") + "+" + whole("y")});
  }
  command.insert(command.end(), {file(first), file(second), "null:"});
  const auto result = runProcess(command, 30.0);
  // 0: equal, 1: they differ; the count goes to stderr.
  if (!result || result->exitCode > 1)
    throw std::runtime_error("compare failed: " + (result ? result->errorOutput : result.error().message));
  return std::strtod(result->errorOutput.c_str(), nullptr);
}

double WorkstationDriver::shareOfColour(const std::string &screenshot, const std::string &condition) const {
  const Json view = state()["view"];
  const auto whole = [&](const char *key) { return std::to_string(view[key].get<int>()); };
  const auto result =
      runProcess({"convert", (folder_ / (name_ + "-" + screenshot + ".png")).string(), "-crop",
                  whole("w") + "x" + whole("h") + "+" + whole("x") + "+" + whole("y"), "-resize", "25%", "-fx",
                  "(" + condition + ") ? 1 : 0", "-colorspace", "gray", "-format", "%[fx:mean]", "info:"},
                 60.0);
  if (!result || result->exitCode != 0)
    throw std::runtime_error("convert failed: " + (result ? result->errorOutput : result.error().message));
  return std::strtod(result->output.c_str(), nullptr);
}

}  // namespace c3de::test
