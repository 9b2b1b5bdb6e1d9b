// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/session/session.h"
#include "c3de/ui/missing_files.h"
#include "workstation/messages.h"
#include "workstation/workstation_loader.h"

namespace c3de::app {

/// Asks for files of a session that are missing or have changed. Files are checked and folders are searched in
/// background jobs. Main thread. Must outlive the session's jobs.
class MissingFilesController {
 public:
  using Opened = std::shared_ptr<WorkstationLoader::OpenedSession>;
  struct Parts {
    Session &session;
    ReportError failed;
    std::function<void(const Opened &)> open;  ///< all files are found, or are used although they have changed
  };
  explicit MissingFilesController(Parts parts);

  /// Whether the dialog is needed for these files.
  [[nodiscard]] static bool isNeeded(const std::vector<FoundFile> &files);
  /// Asks for the files of this session. Replaces a session that is being asked about.
  void show(Opened opened);
  [[nodiscard]] ui::MissingFiles &dialog() { return dialog_; }

 private:
  struct Candidate {
    std::size_t file = 0;           ///< in OpenedSession::files
    std::filesystem::path other{};  ///< a file with another content; empty: none
    std::string otherHash{};        ///< empty: unknown
  };

  void locate(std::size_t row, const std::filesystem::path &path);
  void useAnyway(std::size_t row);
  void search(const std::filesystem::path &folder);
  void open();
  void cancel();
  void updateRow(std::size_t row);
  /// A job of which only the latest counts.
  void run(const std::string &title, std::function<Expected<void>(const ProgressFn &)> job,
           std::function<void(const Expected<void> &)> done);

  Parts parts_;
  ui::MissingFiles dialog_;
  Opened opened_;
  std::vector<Candidate> candidates_;  ///< by row
  std::uint64_t serial_ = 0;
};

}  // namespace c3de::app
