// SPDX-License-Identifier: Apache-2.0
// The values of the panel *Match* in a session.
#pragma once

#include <filesystem>

#include "app.h"
#include "c3de/session/session_file.h"
#include "c3de/ui/match_panel.h"

namespace c3de::app {

/// Its files as absolute paths. A path that is not UTF-8 is omitted, because a session cannot contain it.
[[nodiscard]] SavedMatch savedOf(const ui::MatchForm &form);
/// @param folder  of the session: a file that is no longer at its path may be there
[[nodiscard]] ui::MatchForm formOf(const SavedMatch &saved, const std::filesystem::path &folder);

/// The values of the panel *Match*, which outlive the panel. Main thread.
class MatchValues {
 public:
  ui::MatchForm form;

  /// Whether they are those of the present scene or session.
  [[nodiscard]] bool areSet() const { return areSet_; }
  void assign(ui::MatchForm values);
  /// Of another scene, which is not known yet.
  void clear();
  /// Increases with assign() and clear().
  [[nodiscard]] std::uint64_t assignments() const { return assignments_; }
  /// Increases when the user has changed a value.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  /// Called before a frame in which the panel is open.
  void countChanges();

 private:
  bool areSet_ = false;
  std::uint64_t assignments_ = 0, revision_ = 0;
  SavedMatch last_;  // at this revision; without the body, which follows the simulation
};

}  // namespace c3de::app
