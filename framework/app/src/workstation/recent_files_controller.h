// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "app.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/session/session.h"
#include "c3de/ui/start_page.h"
#include "c3de/ui/workstation_window.h"

namespace c3de::app {

/// Keeps the list of recent files: an entry is added when what the user opened is shown, and gets a picture of the
/// views when it is closed or saved. A thread of its own accesses the disk. Main thread. Must be destroyed before the
/// session.
class RecentFilesController {
 public:
  /// Files that the window shows at present.
  struct Shown {
    std::filesystem::path session;  ///< empty: not from or in a session file
    std::vector<std::filesystem::path> others;
  };
  struct Parts {
    Session &session;
    registry::PanelRegistry &panels;
    ui::WorkstationWindow &window;
    std::function<Shown()> shown;
  };
  explicit RecentFilesController(Parts parts);
  ~RecentFilesController() { stop(); }
  RecentFilesController(const RecentFilesController &) = delete;
  RecentFilesController &operator=(const RecentFilesController &) = delete;

  /// Adds the actions of the list. Saving a session also updates its entry.
  void connect(ui::WindowActions &actions);
  /// The user has asked for these files. They are listed once they are shown.
  void onRequested(const ui::OpenRequest &request);
  /// Image or simulation is about to be closed: keeps the picture of the views until update().
  void beforeClosing() { closingPicture_ = parts_.window.viewPicture(); }
  /// Called before each frame.
  void update();
  /// Writes the last pictures, and ends the thread. Later calls have no effect.
  void stop();
  [[nodiscard]] const ui::StartPage &page() const { return page_; }

 private:
  using Listing = ui::RecentFiles::Listing;
  using Task = std::function<Listing(ui::RecentFiles &)>;
  void run();
  void post(Task task);
  void onSaved(const std::filesystem::path &file);
  void storePicture(const ui::RecentFile &file);
  void report(const Error &problem);

  Parts parts_;
  ui::StartPage page_;
  std::vector<ui::RecentFile> requested_;  ///< not shown yet
  std::vector<ui::RecentFile> shown_;
  std::optional<render::Image> closingPicture_;
  std::set<ErrorCode> reported_;  ///< a problem of each kind is shown once
  ui::RecentFiles files_;         ///< of the thread
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Task> tasks_;
  bool isStopping_ = false;
  std::thread thread_;
};

}  // namespace c3de::app
