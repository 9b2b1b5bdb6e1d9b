// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>

#include "c3de/core/assert.h"
#include "c3de/core/embedding.h"

namespace c3de {
namespace {

// The process has one stderr, so the line writer, the listener and the assertion handler are the module's only statics.
struct LogState {
  std::mutex mutex;
  std::shared_ptr<spdlog::logger> logger;
  std::function<void(LogLevel, const std::string &)> listener;

  LogState() {
    // https://no-color.org: any value that is not empty
    const char *noColour = std::getenv("NO_COLOR");
    const bool isPlain = noColour != nullptr && *noColour != '\0';
    logger = std::make_shared<spdlog::logger>(
        "c3de", std::make_shared<spdlog::sinks::stderr_color_sink_mt>(isPlain ? spdlog::color_mode::never
                                                                              : spdlog::color_mode::automatic));
    logger->set_pattern("c3de: %^%l%$: %v");
    logger->set_level(spdlog::level::info);
    logger->flush_on(spdlog::level::debug);
  }
};

LogState &logState() {
  static LogState state;
  return state;
}

spdlog::level::level_enum toSpdlog(LogLevel level) {
  switch (level) {
    case LogLevel::debug: return spdlog::level::debug;
    case LogLevel::info: return spdlog::level::info;
    case LogLevel::warn: return spdlog::level::warn;
    case LogLevel::error: return spdlog::level::err;
  }
  return spdlog::level::info;
}

std::atomic<AssertHandler> assertHandler{nullptr};
std::atomic<bool> embedded{false};

}  // namespace

void log(LogLevel level, std::string_view message) {
  LogState &state = logState();
  state.logger->log(toSpdlog(level), spdlog::string_view_t(message.data(), message.size()));
  std::function<void(LogLevel, const std::string &)> listener;
  {
    std::lock_guard lock(state.mutex);
    listener = state.listener;
  }
  if (listener) listener(level, std::string(message));
}

void setLogThreshold(LogLevel level) { logState().logger->set_level(toSpdlog(level)); }

void setEmbedded() {
  embedded = true;
  logState().logger->set_level(spdlog::level::off);
}

bool isEmbedded() { return embedded.load(std::memory_order_relaxed); }

void setLogListener(std::function<void(LogLevel, const std::string &)> listener) {
  LogState &state = logState();
  std::lock_guard lock(state.mutex);
  state.listener = std::move(listener);
}

AssertHandler setAssertHandler(AssertHandler handler) { return assertHandler.exchange(handler); }

void reportAssertion(const char *condition, const char *text, const char *file, int line) {
  if (const AssertHandler handler = assertHandler.load()) {
    handler(condition, text, file, line);
    return;
  }
  std::fprintf(stderr, "c3de: assertion failed: %s (%s) at %s:%d\n", text, condition, file, line);
  std::abort();
}

}  // namespace c3de
