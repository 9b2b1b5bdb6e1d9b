// SPDX-License-Identifier: Apache-2.0
// What a person starts by a menu or by keys, and what a plugin remembers from one run to the next.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/sdk/services.hpp"

namespace c3de::sdk {

/// Texts by key that survive the end of the program. Any thread.
class Settings : public Service<c3de_settings_v1> {
 public:
  using Service::Service;
  /// Nothing when nothing was set, or when settings are not served.
  [[nodiscard]] std::optional<std::string> get(std::string_view key) const {
    TextSink value;
    if (!call<&c3de_settings_v1::get>(str(key), value.sink())) return std::nullopt;
    return value.take();
  }
  /// On disk when this returns; a failure with C3DE_E_IO says why not, the value holds for this run all the same.
  Result<void> set(std::string_view key, std::string_view value) const {
    return call<&c3de_settings_v1::set>(str(key), str(value));
  }
  Result<void> remove(std::string_view key) const { return call<&c3de_settings_v1::remove>(str(key)); }
  Result<std::vector<std::string>> keys() const {
    std::vector<std::string> out;
    const auto each = [](void *self, c3de_str key) noexcept -> c3de_status {
      return guard([&] { static_cast<std::vector<std::string> *>(self)->emplace_back(text(key)); });
    };
    if (auto done = call<&c3de_settings_v1::keys>(static_cast<void *>(&out), +each); !done) return done.failure();
    return out;
  }
};

/// An entry of the menu; everything is copied by the host.
struct CommandInfo {
  std::string_view id{}, title{}, doc{};
  std::uint32_t key = 0;        ///< ASCII upper case letter or digit; 0: none
  std::uint32_t modifiers = 0;  ///< C3DE_MOD_*, with CTRL or ALT where there is a key
};

/// A command until it is destroyed.
class Command {
 public:
  Command() noexcept = default;
  [[nodiscard]] c3de_handle handle() const noexcept { return owned_.handle(); }
  explicit operator bool() const noexcept { return static_cast<bool>(owned_); }
  /// False: another command has the keys; the log names both.
  [[nodiscard]] bool hasShortcut() const noexcept { return hasShortcut_; }
  void setEnabled(bool isEnabled) const noexcept {
    if (owned_) (void)owned_.table()->set_enabled(owned_.table()->ctx, owned_.handle(), isEnabled ? 1u : 0u);
  }

 private:
  friend class Commands;
  // The function is declared first, so that the registration goes before it.
  std::unique_ptr<std::function<Result<void>()>> run_;
  Owned<c3de_commands_v1, &c3de_commands_v1::remove> owned_;
  bool hasShortcut_ = false;
};

/// Main thread.
class Commands : public Service<c3de_commands_v1> {
 public:
  using Service::Service;
  /// @param run  may fail or throw; the person sees the text
  Result<Command> add(const CommandInfo &info, std::function<Result<void>()> run) const {
    if (!table_) return absent();
    Command out;
    out.run_ = std::make_unique<std::function<Result<void>()>>(std::move(run));
    const auto thunk = [](void *self) noexcept -> c3de_status {
      return guard([&] { return (*static_cast<std::function<Result<void>()> *>(self))(); });
    };
    const c3de_command command{
        sizeof(c3de_command), 1,     str(info.id), str(info.title), str(info.doc), info.key, info.modifiers,
        out.run_.get(),       +thunk};
    c3de_handle handle{0};
    const c3de_status status = table_->add(table_->ctx, &command, &handle);
    if (status < 0) return host_.failure(status);
    out.owned_ = {table_, handle};
    out.hasShortcut_ = info.key != 0 && status != C3DE_S_NO_SHORTCUT;
    return out;
  }
  /// Carries out a command of any plugin.
  Result<void> run(std::string_view id) const { return call<&c3de_commands_v1::run>(str(id)); }
};

}  // namespace c3de::sdk
