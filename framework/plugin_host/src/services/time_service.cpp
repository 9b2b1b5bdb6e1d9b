// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>

#include "arguments.h"
#include "c3de/core/main_queue.h"
#include "services/callbacks.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

std::uint64_t C3DE_CALL nowNs(void *) noexcept {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
}

std::uint64_t C3DE_CALL frameIndex(void *ctx) noexcept {
  std::uint64_t frame = 0;
  (void)serve(ctx, "time.frame_index",
              [&](PluginContext &plugin) { frame = plugin.services().mainQueue->frameIndex(); });
  return frame;
}

void C3DE_CALL requestRedraw(void *ctx) noexcept {
  (void)serve(ctx, "time.request_redraw", [](PluginContext &plugin) { plugin.services().mainQueue->requestRedraw(); });
}

c3de_status C3DE_CALL postToMain(void *ctx, void *self, void(C3DE_CALL *fn)(void *self)) noexcept {
  return serve(ctx, "time.post_to_main", [&](PluginContext &plugin) {
    requireNonNull(fn, "fn");
    {
      const std::lock_guard lock(plugin.posted->mutex);
      // Checked again, under the lock with which revokeAll() clears the list.
      if (plugin.isClosed()) throw Refusal(C3DE_E_STATE, "the plugin is being unloaded");
      plugin.posted->waiting.emplace_back(self, fn);
    }
    // The queue holds the waiting list, not the plugin: functions that were already run or dropped are no longer in it.
    // The context exists as long as its list is not empty.
    plugin.services().mainQueue->post([posted = plugin.posted, owner = &plugin] {
      std::pair<void *, void(C3DE_CALL *)(void *)> next;
      {
        const std::lock_guard lock(posted->mutex);
        if (posted->waiting.empty()) return;
        next = posted->waiting.front();
        posted->waiting.pop_front();
      }
      callPlugin(*owner, "a posted function", [&] { next.second(next.first); });
    });
  });
}

c3de_status C3DE_CALL addFrameCallback(void *ctx, void *self, void(C3DE_CALL *fn)(void *self),
                                       c3de_handle *out) noexcept {
  return serveOnMain(ctx, "time.add_frame_callback", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    requireNonNull(fn, "fn");
    const Handle handle = plugin.services().mainQueue->addFrameCallback(plugin.id(), FrameCallback(plugin, self, fn));
    plugin.frameCallbacks.insert(handle.bits());
    writeHandle(out, handle);
  });
}

c3de_status C3DE_CALL removeFrameCallback(void *ctx, c3de_handle callback) noexcept {
  return serveOnMain(ctx, "time.remove_frame_callback", [&](PluginContext &plugin) {
    if (plugin.frameCallbacks.erase(callback.v) == 0)
      throw Refusal(C3DE_E_STALE,
                    fmt::format("plugin {} has no frame callback of handle {}", plugin.id(), textOf(callback)));
    plugin.services().mainQueue->removeFrameCallback(handleOf(callback));
  });
}

}  // namespace

c3de_time_v1 makeTimeTable(PluginContext *plugin) {
  return {sizeof(c3de_time_v1), kServiceRevision,    plugin, &nowNs, &frameIndex, &requestRedraw, &postToMain,
          &addFrameCallback,    &removeFrameCallback};
}

}  // namespace c3de::plugin_host
