// SPDX-License-Identifier: Apache-2.0
// Steps of Undo and Redo.
#pragma once

#include <functional>
#include <memory>
#include <string_view>
#include <utility>

#include "c3de/sdk/guard.hpp"
#include "c3de/sdk/services/service.hpp"

namespace c3de::sdk {

/// Undo and Redo of the window. Main thread.
class History : public Service<c3de_history_v1> {
 public:
  using Service::Service;
  /// A step that has been done just now, for the menu as "Undo LABEL". The functions may fail or throw: the step is
  /// forgotten then. They are destroyed when the host forgets the step.
  Result<c3de_handle> add(std::string_view label, std::function<Result<void>()> undo,
                          std::function<Result<void>()> redo) const {
    auto box = std::make_unique<Step>(Step{std::move(undo), std::move(redo)});
    const c3de_edit edit{sizeof(c3de_edit), 1, str(label), box.get(), &undoThunk, &redoThunk, &releaseThunk};
    c3de_handle handle{0};
    if (auto done = call<&c3de_history_v1::add>(&edit, &handle); !done) return done.failure();
    (void)box.release();
    return handle;
  }
  /// Forgets a step; nothing when it is forgotten already.
  void remove(c3de_handle step) const { (void)call<&c3de_history_v1::remove>(step); }

 private:
  struct Step {
    std::function<Result<void>()> undo, redo;
  };
  static c3de_status C3DE_CALL undoThunk(void *self) noexcept {
    return guard([&] { return static_cast<Step *>(self)->undo(); });
  }
  static c3de_status C3DE_CALL redoThunk(void *self) noexcept {
    return guard([&] { return static_cast<Step *>(self)->redo(); });
  }
  static void C3DE_CALL releaseThunk(void *self) noexcept {
    guardQuietly("release of a step", [&] { delete static_cast<Step *>(self); });
  }
};

}  // namespace c3de::sdk
