// SPDX-License-Identifier: Apache-2.0
// How functions called by plugins report errors: Refusal inside, a status and a text outside. serve() wraps each of
// them.
#pragma once

#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "c3de/core/error_status.h"
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

[[nodiscard]] ErrorCode errorCodeOf(c3de_status status) noexcept;

/// Converts the exception in flight to a status, with "where: what" as the last error. For an error about a file it is
/// "what" alone, because that text is for the user and not for the author of the plugin. The only catch-all of the
/// adapters.
c3de_status refuse(const char *where) noexcept;

/// Runs f(plugin) for the plugin to which a table's ctx belongs. f may return nothing or a c3de_status.
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

/// Same as serve(), for functions restricted to the main thread.
template <class F>
c3de_status serveOnMain(void *ctx, const char *where, F &&f) noexcept {
  return serve(ctx, where, [&](PluginContext &plugin) {
    plugin.requireMainThread();
    return std::forward<F>(f)(plugin);
  });
}

/// Converts a failed Expected to a Refusal.
template <class T>
T orRefuse(Expected<T> result) {
  if (!result) throw Refusal(statusOf(result.error().code), result.error().message);
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

}  // namespace c3de::plugin_host
