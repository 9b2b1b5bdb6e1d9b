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
  /// Revision 2: the host can undo changes without an inverse.
  [[nodiscard]] bool canCapture() const noexcept { return table_ && table_->rev >= 2; }
  /// Stores the present simulation, then calls `begin`, later; not if the plugin is stopped before.
  Result<void> capture(std::function<void()> begin) const {
    if (!canCapture()) return Failure{C3DE_E_UNSUPPORTED, "the host does not capture simulations for undo"};
    auto box = std::make_unique<std::function<void()>>(std::move(begin));
    auto done = call<&c3de_history_v1::capture>(static_cast<void *>(box.get()), &readyThunk);
    if (done) (void)box.release();
    return done;
  }
  /// The change started by `begin` of the last capture has succeeded: a step, for the menu as "Undo LABEL".
  Result<void> addCaptured(std::string_view label) const {
    if (!canCapture()) return Failure{C3DE_E_UNSUPPORTED, "the host does not capture simulations for undo"};
    return call<&c3de_history_v1::add_captured>(str(label));
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
  static void C3DE_CALL readyThunk(void *self, c3de_status status) noexcept {
    guardQuietly("begin of a change", [&] {
      const std::unique_ptr<std::function<void()>> begin(static_cast<std::function<void()> *>(self));
      if (status == C3DE_OK) (*begin)();
    });
  }
  static void C3DE_CALL releaseThunk(void *self) noexcept {
    guardQuietly("release of a step", [&] { delete static_cast<Step *>(self); });
  }
};

}  // namespace c3de::sdk
