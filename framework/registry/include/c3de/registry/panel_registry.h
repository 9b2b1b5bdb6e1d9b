// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "c3de/abi/panels.h"
#include "c3de/core/handle.h"

namespace c3de::registry {

struct Panel {
  std::string owner;  ///< plugin id
  std::string id, title;
  void *self = nullptr;
  void(C3DE_CALL *onUi)(void *self, const c3de_ui_v1 *ui) = nullptr;
  bool open = true;
  bool isInView = false;  ///< it requests input about what to show: drawn over the view instead of among the panels
};

/// A button shown below a message.
struct Choice {
  std::string label;
  std::function<void()> act;
};

/// Subject of a message: messages about a simulation are dismissed with it.
enum class About { program, simulation };

struct Notification {
  std::uint32_t severity = 1;  ///< as in log.h
  std::string title, text;
  std::uint64_t serial = 0;
  std::string time;  ///< time of day, "16:05:09"
  std::vector<Choice> choices;
  About about = About::program;
};

/// The panels registered by plugins, and messages to the user. Main thread only.
class PanelRegistry {
 public:
  Handle add(Panel panel);
  bool remove(Handle panel);
  void removeOwnedBy(const std::string &plugin);
  /// In the order in which they were added.
  [[nodiscard]] std::vector<Panel *> panels();
  /// Same, as handles: they remain valid if a panel adds or removes panels while it is drawn.
  [[nodiscard]] std::vector<Handle> handles() const { return order_; }
  [[nodiscard]] Panel *find(Handle panel) { return panels_.find(panel); }

  /// Sets the function that rewords messages for the user: plainWords(). The original text of a reworded message is
  /// logged.
  void setWording(std::function<std::string(const std::string &)> wording) { wording_ = std::move(wording); }
  /// Replaces an earlier message of the same title. The choices are also shown in the list of all messages.
  void notify(std::uint32_t severity, std::string title, std::string text, std::vector<Choice> choices = {},
              About about = About::program);
  [[nodiscard]] std::vector<Notification> &notifications() { return notifications_; }
  void dismiss(std::uint64_t serial);
  /// Serial of the latest message; 0 if there was none.
  [[nodiscard]] std::uint64_t lastSerial() const { return serial_; }
  /// Dismisses messages about a simulation that ends, up to this serial. They stay in the log, without their choices.
  void dismissAboutSimulation(std::uint64_t upTo);
  /// All messages since the start, dismissed or not, the oldest first. If there are very many, only the latest.
  [[nodiscard]] const std::vector<Notification> &log() const { return log_; }
  [[nodiscard]] bool hasViewPanel();

 private:
  HandleTable<Panel, HandleKind::panel> panels_;
  std::vector<Handle> order_;
  std::vector<Notification> notifications_, log_;
  std::uint64_t serial_ = 0;
  std::function<std::string(const std::string &)> wording_;
};

}  // namespace c3de::registry
