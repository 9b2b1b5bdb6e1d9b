// SPDX-License-Identifier: Apache-2.0
// Measures how soon the window responds while every core is busy with other work. Speed is neither passed nor failed:
// this is a command that prints its measurements.
//   xvfb-run -a -s "-screen 0 1400x900x24" build/release/bin/test_ui "[latency]"
// The default scene plays and warps its scan in four views, next to as many busy loops as there are cores, at the same
// priority (C3DE_BUSY_LOOPS: another number). Real X events are sent by one process that waits for them on a pipe. A
// response begins before its event is passed to that process, and ends when the buffers have been swapped after the
// first frame that received the event (`answers` of the automation state, steady clock), with software OpenGL after the
// X server has the picture.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <thread>

#include "support/catch.h"
#include "support/folders.h"
#include "ui/workstation_driver.h"

namespace {

using c3de::test::Json;
using c3de::test::outputFile;
using c3de::test::Point;
using c3de::test::WorkstationDriver;
namespace fs = std::filesystem;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }
void pause_s(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

/// One process that generates X events from the lines it receives; starting one for each would take longer than a
/// response.
class EventSource {
 public:
  EventSource() {
    const fs::path pipe = outputFile("latency.pipe");
    std::error_code ignored;
    fs::remove(pipe, ignored);
    const auto made = c3de::runProcess({"mkfifo", pipe.string()}, 10.0);
    if (!made || made->exitCode != 0) throw std::runtime_error("no pipe can be made");
    auto started = c3de::ChildProcess::start({"sh", "-c", "exec xdotool - < \"$0\"", pipe.string()},
                                             outputFile("latency-xdotool.log"));
    if (!started) throw std::runtime_error(started.error().message);
    process_.emplace(std::move(*started));
    out_.open(pipe);
  }
  /// @return time of sending, s
  double send(const std::string &line) {
    const double sent_s = now_s();
    out_ << line << std::endl;
    return sent_s;
  }

 private:
  std::optional<c3de::ChildProcess> process_;
  std::ofstream out_;
};

/// A frame that received input.
struct Answer {
  long x = 0, y = 0;
  long characters = 0;  ///< total received so far
  double shown_s = 0.0;
};

/// The responses of the program so far, by frame.
class Answers {
 public:
  explicit Answers(const WorkstationDriver &window) : window_(window) {}
  /// Reads at most twice a second: reading takes processor time as well.
  void lookNowAndThen() {
    if (now_s() - lookedAt_s_ > 0.5) look();
  }
  void look() {
    lookedAt_s_ = now_s();
    const Json state = window_.state();
    for (const Json &a : state.value("answers", Json::array()))
      byFrame_[a[0].get<long>()] = {std::lround(a[1].get<double>()), std::lround(a[2].get<double>()), a[3].get<long>(),
                                    a[4].get<double>()};
  }
  [[nodiscard]] const std::map<long, Answer> &byFrame() const { return byFrame_; }
  [[nodiscard]] long characters() {
    look();
    return byFrame_.empty() ? 0 : byFrame_.rbegin()->second.characters;
  }

 private:
  const WorkstationDriver &window_;
  std::map<long, Answer> byFrame_;
  double lookedAt_s_ = 0.0;
};

struct Box {
  double x = 0.0, y = 0.0, w = 0.0, h = 0.0;
};
Box boxOf(const Json &rect) { return {rect["x"], rect["y"], rect["w"], rect["h"]}; }

/// Responses to consecutive events, s; sorted.
void tell(const std::string &what, std::vector<double> times_s, std::size_t sent, const std::string &more = {}) {
  std::sort(times_s.begin(), times_s.end());
  const auto at_ms = [&](double share) {
    return times_s.empty()
               ? NAN
               : 1e3 * times_s[static_cast<std::size_t>(std::lround(share * static_cast<double>(times_s.size() - 1)))];
  };
  std::printf("%-44s %4zu of %4zu   p50 %6.1f   p95 %6.1f   max %6.1f ms%s\n", what.c_str(), times_s.size(), sent,
              at_ms(0.5), at_ms(0.95), at_ms(1.0), more.c_str());
  std::fflush(stdout);
}

/// The default scene with the brain in motion, a busy load, and the measurements.
class Trial {
 public:
  Trial() : window_("latency"), answers_(window_) {
    window_.start({"--play", (fs::path(testResourcesFolder()) / "scenes" / "brain_shift.toml").string()});
    C3DE_WAIT(window_, "the scan is warped",
              s["panes"].size() == 4 && s["jobs"].empty() && s["transport"]["time_s"].get<double>() > 0.5 &&
                  s["values"].value("image/axial.readout", std::string()).find("|u|") != std::string::npos);
    events_.emplace();
    const char *given = std::getenv("C3DE_BUSY_LOOPS");
    const unsigned loops =
        given ? static_cast<unsigned>(std::strtoul(given, nullptr, 10)) : std::thread::hardware_concurrency();
    for (unsigned i = 0; i < loops; ++i) {
      auto loop = c3de::ChildProcess::start({"sh", "-c", "while :; do :; done"}, outputFile("latency-busy.log"));
      if (loop) busy_.push_back(std::move(*loop));
    }
    std::string load;
    std::getline(std::ifstream("/proc/loadavg") >> std::ws, load);
    std::printf("%zu busy loops, %u cores; load before: %s\n", busy_.size(), std::thread::hardware_concurrency(),
                load.c_str());
    pause_s(2.0);
  }

  [[nodiscard]] WorkstationDriver &window() { return window_; }

  /// Moves the mouse over a part of the window. @param least_s, most_s  between two moves
  void move(const std::string &what, const Box &box, double least_s, double most_s, bool isDrag = false) {
    constexpr std::size_t kMoves = 120;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> gap_s(least_s, most_s);
    begin();
    const auto placeOf = [&](std::size_t i) {
      // Row by row; no position twice.
      const auto width = static_cast<std::size_t>(box.w), step = 7 * i;
      return std::pair(std::lround(box.x) + static_cast<long>(step % width),
                       std::lround(box.y) + static_cast<long>(3 * (step / width)));
    };
    const auto moveTo = [&](std::pair<long, long> at) {
      return events_->send("mousemove " + std::to_string(at.first) + " " + std::to_string(at.second));
    };
    if (isDrag) {
      moveTo({std::lround(box.x) - 3, std::lround(box.y) - 3});
      pause_s(0.3);
      events_->send("mousedown 1");
      pause_s(0.3);
    }
    std::map<std::pair<long, long>, std::size_t> places;
    std::vector<double> sent_s;
    for (std::size_t i = 0; i < kMoves; ++i) {
      places[placeOf(i)] = i;
      sent_s.push_back(moveTo(placeOf(i)));
      answers_.lookNowAndThen();
      keepMoving();
      pause_s(std::max(sent_s.back() + gap_s(random) - now_s(), 0.0));
    }
    pause_s(0.7);
    if (isDrag) events_->send("mouseup 1");
    answers_.look();
    std::vector<double> times_s;
    std::size_t next = 0;  // the first move without a response
    for (const auto &[frame, answer] : answers_.byFrame()) {
      const auto found = places.find({answer.x, answer.y});
      if (found == places.end() || answer.shown_s < sent_s[found->second]) continue;
      for (; next <= found->second; ++next) times_s.push_back(answer.shown_s - sent_s[next]);
    }
    tell(what, times_s, kMoves, rates());
  }

  /// Types into the focused field, one character after the other.
  void type(const std::string &what, std::size_t count, double gap_s) {
    begin();
    const long before = answers_.characters();
    std::vector<double> sent_s;
    for (std::size_t i = 0; i < count; ++i) {
      sent_s.push_back(events_->send(std::string("key ") + static_cast<char>('a' + i % 26)));
      answers_.lookNowAndThen();
      pause_s(std::max(sent_s.back() + gap_s - now_s(), 0.0));
    }
    for (const double end_s = now_s() + 20.0;
         now_s() < end_s && answers_.characters() < before + static_cast<long>(count);)
      pause_s(0.3);
    std::vector<double> times_s;
    double last_s = 0.0;
    for (const auto &[frame, answer] : answers_.byFrame())
      for (; static_cast<long>(times_s.size()) < std::min(answer.characters - before, static_cast<long>(count));
           last_s = answer.shown_s)
        times_s.push_back(answer.shown_s - sent_s[times_s.size()]);
    char rate[64];
    std::snprintf(rate, sizeof rate, "   %.1f characters/s",
                  static_cast<double>(times_s.size()) / (last_s - sent_s.front()));
    tell(what, times_s, count, rate + rates());
  }

  /// The brain from its initial state: at rest there would be less to do.
  void startAnew() {
    events_->send("key ctrl+r");
    pause_s(0.3);
  }

 private:
  void begin() {
    const Json s = window_.state();
    frames_ = s["frame"].get<double>();
    simulated_s_ = s["transport"]["time_s"].get<double>();
    began_s_ = startedAnew_s_ = now_s();
  }
  void keepMoving() {
    if (now_s() - startedAnew_s_ < 2.5) return;
    simulated_s_ -= window_.state()["transport"]["time_s"].get<double>();
    events_->send("key ctrl+r");
    startedAnew_s_ = now_s();
  }
  std::string rates() const {
    const Json s = window_.state();
    const double wall_s = now_s() - began_s_;
    char text[96];
    std::snprintf(text, sizeof text, "   %.0f frames/s, %.2f x real time",
                  (s["frame"].get<double>() - frames_) / wall_s,
                  (s["transport"]["time_s"].get<double>() - simulated_s_) / wall_s);
    return text;
  }

  WorkstationDriver window_;
  Answers answers_;
  std::optional<EventSource> events_;
  std::vector<c3de::ChildProcess> busy_;
  double began_s_ = 0.0, startedAnew_s_ = 0.0, frames_ = 0.0, simulated_s_ = 0.0;
};

Box inner(const Box &box) { return {box.x + 0.15 * box.w, box.y + 0.3 * box.h, 0.7 * box.w, 0.5 * box.h}; }

}  // namespace

TEST_CASE("How soon the window answers mouse and keys while the cores are busy", "[.latency]") {
  C3DE_WINDOW_OR_SKIP();
  Trial trial;
  WorkstationDriver &window = trial.window();
  const Json state = window.state();
  const Box axial = inner(boxOf(state["panes"]["axial"])), space = inner(boxOf(state["panes"]["3D"]));
  const Box area = boxOf(state["area"]);

  constexpr double kLeast_s = 0.04, kMost_s = 0.16, kHand_s = 0.016;
  trial.startAnew();
  trial.move("mouse over a slice, now and then", axial, kLeast_s, kMost_s);
  trial.move("mouse over a slice, 60 moves/s", axial, kHand_s, kHand_s);
  trial.move("mouse over the 3D view, now and then", space, kLeast_s, kMost_s);
  trial.move("mouse over the panels, now and then", {20.0, area.y + 0.3 * area.h, 0.7 * area.x, 0.4 * area.h}, kLeast_s,
             kMost_s);
  trial.move("cross-hair dragged, 60 moves/s", axial, kHand_s, kHand_s, true);
  trial.move("3D view turned, 60 moves/s", space, kHand_s, kHand_s, true);
  window.click("menu/view");
  const Json widgets = C3DE_WAIT(window, "the menu is open", s["widgets"].contains("menu/view.cut_axial"))["widgets"];
  const Json item = widgets["menu/view.cut_axial"];
  const double width = item[2].get<double>() - item[0].get<double>();
  trial.move("mouse over an open menu, now and then", {item[0], item[1].get<double>() - 60.0, 0.9 * width, 120.0},
             kLeast_s, kMost_s);
  window.key("Escape");
  trial.startAnew();
  window.key("ctrl+o");
  C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("dialog/path"));
  trial.type("typing in a dialog, 25 keys/s", 100, 0.04);
  trial.type("typing in a dialog, as fast as keys come", 200, 0.0);
  C3DE_WAIT(window, "none of the characters is lost", s["values"].value("dialog/path", std::string()).size() == 300);
  CHECK(window.state()["transport"]["mode"] == "playing");
}
