// SPDX-License-Identifier: Apache-2.0
// Time, frames, and functions for the main thread.
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "c3de/sdk/guard.hpp"
#include "c3de/sdk/owned.hpp"
#include "c3de/sdk/services/service.hpp"

namespace c3de::sdk {

/// A function that the host calls at the start of every frame, until this goes.
class FrameCallback {
 public:
  FrameCallback() noexcept = default;

 private:
  friend class Time;
  // The function is declared first, so that the registration goes before it.
  std::unique_ptr<std::function<void()>> fn_;
  Owned<c3de_time_v1, &c3de_time_v1::remove_frame_callback> registration_;
};

class Time : public Service<c3de_time_v1> {
 public:
  using Service::Service;
  [[nodiscard]] std::uint64_t nowNs() const noexcept { return table_ ? table_->now_ns(table_->ctx) : 0; }
  [[nodiscard]] std::uint64_t frameIndex() const noexcept { return table_ ? table_->frame_index(table_->ctx) : 0; }
  void requestRedraw() const noexcept {
    if (table_) table_->request_redraw(table_->ctx);
  }
  /// Runs on the main thread before the next frame. Any thread.
  Result<void> postToMain(std::function<void()> fn) const {
    auto box = std::make_unique<std::function<void()>>(std::move(fn));
    if (auto posted = call<&c3de_time_v1::post_to_main>(static_cast<void *>(box.get()), &runOnce); !posted)
      return posted.failure();
    (void)box.release();  // runOnce deletes it
    return {};
  }
  Result<FrameCallback> addFrameCallback(std::function<void()> fn) const {
    FrameCallback callback;
    callback.fn_ = std::make_unique<std::function<void()>>(std::move(fn));
    c3de_handle handle{0};
    if (auto added = call<&c3de_time_v1::add_frame_callback>(static_cast<void *>(callback.fn_.get()), &run, &handle);
        !added)
      return added.failure();
    callback.registration_ = {table_, handle};
    return callback;
  }

 private:
  static void C3DE_CALL run(void *self) noexcept {
    guardQuietly("frame callback", [&] { (*static_cast<std::function<void()> *>(self))(); });
  }
  static void C3DE_CALL runOnce(void *self) noexcept {
    const std::unique_ptr<std::function<void()>> fn(static_cast<std::function<void()> *>(self));
    guardQuietly("posted function", [&] { (*fn)(); });
  }
};

}  // namespace c3de::sdk
