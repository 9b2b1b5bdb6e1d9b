// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "c3de/core/handle.h"

namespace c3de {

/// Work of the main thread once per frame before it draws: functions posted from any thread, and permanent callbacks.
class MainQueue {
 public:
  /// Runs `fn` before the next frame and wakes the window. Any thread.
  void post(std::function<void()> fn);
  /// Main thread.
  Handle addFrameCallback(std::string owner, std::function<void()> fn);
  bool removeFrameCallback(Handle callback);
  void removeOwnedBy(const std::string &owner);

  /// Runs the posted functions, then the frame callbacks in the order they were added. Main thread.
  void runFrame();
  [[nodiscard]] std::uint64_t frameIndex() const;

  /// Called when a function was posted or a redraw was requested; any thread.
  void setWaker(std::function<void()> waker);
  void requestRedraw();

 private:
  struct Callback {
    std::string owner;
    std::function<void()> fn;
  };
  mutable std::mutex mutex_;
  std::vector<std::function<void()>> posted_;
  std::function<void()> waker_;
  HandleTable<Callback, HandleKind::frameCallback> callbacks_;
  std::uint64_t frame_ = 0;
};

}  // namespace c3de
