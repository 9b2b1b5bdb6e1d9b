// SPDX-License-Identifier: Apache-2.0
// How a function that plugins call refuses: Refusal inside, a status and a text outside. serve() stands around each.
#pragma once

#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "c3de/core/expected.h"
#include "plugin_context.h"

namespace c3de::plugin_host {

/// Thrown inside an adapter function; names the argument, the value and what is accepted.
class Refusal : public std::runtime_error {
 public:
  Refusal(c3de_status status, const std::string &text) : std::runtime_error(text), status_(status) {}
  [[nodiscard]] c3de_status status() const noexcept { return status_; }

 private:
  c3de_status status_;
};

[[nodiscard]] c3de_status statusOf(ErrorCode code) noexcept;
[[nodiscard]] ErrorCode errorCodeOf(c3de_status status) noexcept;

/// The exception in flight as a status, "where: what" left as the last error; "what" alone when it speaks of a file,
/// which is for the person at the program and not for the author of the plugin. The one catch-all of the adapters.
c3de_status refuse(const char *where) noexcept;

/// Runs f(plugin) for the plugin that a table's ctx stands for. f may return nothing or a c3de_status.
template <class F>
c3de_status serve(void *ctx, const char *where, F &&f) noexcept {
  try {
    PluginContext &plugin = PluginContext::of(ctx);
    if constexpr (std::is_void_v<std::invoke_result_t<F, PluginContext &>>) {
      std::forward<F>(f)(plugin);
      return C3DE_OK;
    } else {
      return std::forward<F>(f)(plugin);
    }
  } catch (...) {
    return refuse(where);
  }
}

/// As serve(), for functions that belong to the main thread.
template <class F>
c3de_status serveOnMain(void *ctx, const char *where, F &&f) noexcept {
  return serve(ctx, where, [&](PluginContext &plugin) {
    plugin.requireMainThread();
    return std::forward<F>(f)(plugin);
  });
}

/// Turns a failed Expected into a Refusal.
template <class T>
T orRefuse(Expected<T> result) {
  if (!result) throw Refusal(statusOf(result.error().code), result.error().message);
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

}  // namespace c3de::plugin_host
