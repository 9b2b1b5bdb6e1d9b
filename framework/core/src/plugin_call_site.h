// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace c3de::detail {

/// The plugin call that the present thread is, or was last, in.
struct PluginCallSite {
  const char *owner = nullptr, *what = nullptr;  ///< null: in no such call so far
  bool isInside = false;                         ///< otherwise the last call has returned
};
/// Can also be called from signal handlers and handlers of exit().
[[nodiscard]] PluginCallSite pluginCallSiteOfThread() noexcept;
/// The last completed call of the present thread with an owner other than this one; null if there is none.
[[nodiscard]] PluginCallSite previousCallSiteOfThread(const char *owner) noexcept;

}  // namespace c3de::detail
