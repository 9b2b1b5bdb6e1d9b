// SPDX-License-Identifier: Apache-2.0
// Adapters that the registries of the UI call instead of the plugin. A plugin that throws or has been removed thus
// causes no harm there.
#pragma once

#include <memory>

#include "c3de/core/text.h"
#include "circuit_breaker.h"
#include "last_error.h"
#include "plugin_context.h"

namespace c3de::plugin_host {

/// Each holds a reference to itself while it runs, because the plugin may remove the registration from inside the call.
struct PanelCallback : std::enable_shared_from_this<PanelCallback> {
  PanelCallback(PluginContext &p, const c3de_panel &r, const std::string &title)
      : plugin(p), real(r), fuse(std::make_shared<CircuitBreaker>(p, "panel '" + title + "'")) {}
  static void C3DE_CALL onUi(void *self, const c3de_ui_v1 *ui) noexcept {
    const auto keep = static_cast<PanelCallback *>(self)->shared_from_this();
    if (keep->fuse->isOff()) {
      ui->text(ui->ctx, toAbi(keep->fuse->reason()));
      const auto pressed = ui->button(ui->ctx, toAbi("c3de.switch_on"), toAbi("Switch on again"), 1);
      if ((pressed & C3DE_UI_COMMITTED) != 0) keep->fuse->switchOn();
      return;
    }
    keep->fuse->call("on_ui of a panel", [&] {
      keep->real.on_ui(keep->real.self, ui);
      return C3DE_OK;
    });
  }
  PluginContext &plugin;
  c3de_panel real;
  std::shared_ptr<CircuitBreaker> fuse;
};

struct ToolCallback : std::enable_shared_from_this<ToolCallback> {
  ToolCallback(PluginContext &p, const c3de_tool &r, const std::string &label)
      : plugin(p), real(r), fuse(std::make_shared<CircuitBreaker>(p, "tool '" + label + "'")) {}
  static c3de_status C3DE_CALL activate(void *self) noexcept {
    const auto keep = static_cast<ToolCallback *>(self)->shared_from_this();
    if (keep->fuse->isOff()) {
      setLastError(keep->fuse->reason());
      return C3DE_E_STATE;
    }
    c3de_status status = C3DE_E_EXCEPTION;
    callPlugin(keep->plugin, "activate of a tool", [&] { status = keep->real.activate(keep->real.self); });
    return status;
  }
  static void C3DE_CALL cancel(void *self) noexcept {
    const auto keep = static_cast<ToolCallback *>(self)->shared_from_this();
    callPlugin(keep->plugin, "cancel of a tool", [&] { keep->real.cancel(keep->real.self); });
  }
  static c3de_status C3DE_CALL onEvent(void *self, const c3de_event *event, std::uint32_t *consumed) noexcept {
    const auto keep = static_cast<ToolCallback *>(self)->shared_from_this();
    if (keep->fuse->isOff()) return C3DE_OK;
    c3de_status status = C3DE_E_EXCEPTION;
    keep->fuse->call("on_event of a tool",
                     [&] { return status = keep->real.on_event(keep->real.self, event, consumed); });
    return status;
  }
  PluginContext &plugin;
  c3de_tool real;
  std::shared_ptr<CircuitBreaker> fuse;
};

/// Callback of a plugin for every frame.
struct FrameCallback {
  FrameCallback(PluginContext &p, void *s, void(C3DE_CALL *f)(void *self))
      : self(s), fn(f), fuse(std::make_shared<CircuitBreaker>(p, "frame callback")) {}
  void operator()() const {
    fuse->call("a frame callback", [this] {
      fn(self);
      return C3DE_OK;
    });
  }
  void *self;
  void(C3DE_CALL *fn)(void *self);
  std::shared_ptr<CircuitBreaker> fuse;
};

/// One step of the history. Destroyed when the list removes it.
struct EditCallback : std::enable_shared_from_this<EditCallback> {
  EditCallback(PluginContext &p, const c3de_edit &r) : plugin(p), real(r) {}
  static c3de_status C3DE_CALL undo(void *self) noexcept { return invoke(self, &c3de_edit::undo, "undo of a step"); }
  static c3de_status C3DE_CALL redo(void *self) noexcept { return invoke(self, &c3de_edit::redo, "redo of a step"); }
  static void C3DE_CALL release(void *self) noexcept {
    const auto keep = static_cast<EditCallback *>(self)->shared_from_this();
    if (keep->real.release) callPlugin(keep->plugin, "release of a step", [&] { keep->real.release(keep->real.self); });
    keep->plugin.edits.erase(keep.get());
  }
  static c3de_status invoke(void *self, c3de_status (C3DE_CALL *c3de_edit::*slot)(void *), const char *what) noexcept {
    const auto keep = static_cast<EditCallback *>(self)->shared_from_this();
    c3de_status status = C3DE_E_EXCEPTION;
    callPlugin(keep->plugin, what, [&] { status = (keep->real.*slot)(keep->real.self); });
    return status;
  }
  PluginContext &plugin;
  c3de_edit real;
  Handle handle;
};

struct ListenerCallback : std::enable_shared_from_this<ListenerCallback> {
  ListenerCallback(PluginContext &p, const c3de_param_listener &r, const std::string &title)
      : plugin(p), real(r), fuse(std::make_shared<CircuitBreaker>(p, "listener of the parameters '" + title + "'")) {}
  [[nodiscard]] c3de_param_listener trampoline() { return {sizeof(c3de_param_listener), 0, this, &changed}; }
  static void C3DE_CALL changed(void *self, const c3de_param_value *value) noexcept {
    const auto keep = static_cast<ListenerCallback *>(self)->shared_from_this();
    keep->fuse->call("changed of a parameter listener", [&] {
      keep->real.changed(keep->real.self, value);
      return C3DE_OK;
    });
  }
  PluginContext &plugin;
  c3de_param_listener real;
  std::shared_ptr<CircuitBreaker> fuse;
};

}  // namespace c3de::plugin_host
