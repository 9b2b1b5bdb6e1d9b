// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/progress_line.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "c3de/core/platform.h"

namespace c3de::session {
namespace {

constexpr auto kTerminalInterval = std::chrono::milliseconds(100);
constexpr auto kLogInterval = std::chrono::seconds(2);
constexpr int kBarWidth = 30;

}  // namespace

ProgressLine::ProgressLine(bool silent) : silent_(silent), terminal_(stderrIsTerminal()) {
  // Short work prints nothing.
  next_ = Clock::now() + (terminal_ ? std::chrono::milliseconds(300) : std::chrono::milliseconds(2000));
}

bool ProgressLine::isDue() const { return !silent_ && Clock::now() >= next_; }

void ProgressLine::update(double fraction, const std::string &text) {
  if (!isDue()) return;
  const double part = std::clamp(std::isfinite(fraction) ? fraction : 0.0, 0.0, 1.0);
  if (terminal_) {
    const int filled = static_cast<int>(part * kBarWidth);
    const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                            std::string(static_cast<std::size_t>(kBarWidth - filled), '.');
    std::string line = "[" + bar + "] " + std::to_string(static_cast<int>(100.0 * part)) + " %  " + text;
    const std::size_t width = line.size();
    if (shown_.size() > width) line.append(shown_.size() - width, ' ');
    std::fprintf(stderr, "\r%s", line.c_str());
    std::fflush(stderr);
    shown_ = line;
    open_ = true;
    next_ = Clock::now() + kTerminalInterval;
  } else {
    std::fprintf(stderr, "c3de: %3d %%  %s\n", static_cast<int>(100.0 * part), text.c_str());
    next_ = Clock::now() + kLogInterval;
  }
}

void ProgressLine::finish() {
  if (open_) std::fprintf(stderr, "\n");
  open_ = false;
  shown_.clear();
}

}  // namespace c3de::session
