// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "session.h"

namespace c3de::app {

/// Opens meshes and scenes beside the window: reading and building run in a background job, and only what is complete
/// takes the place of what was there. Main thread. Must outlive the session's jobs.
class WorkstationLoader {
 public:
  struct Events {
    std::function<void()> loaded;                                            ///< the new simulation is the present one
    std::function<void(const std::string &title, const Error &error)> failed;  ///< what was there stays
  };
  WorkstationLoader(Session &session, Events events) : session_(session), events_(std::move(events)) {}

  /// Meshes become bodies of one scene; beside a scene they are added to it. Ends a load that is running.
  void open(const std::vector<std::filesystem::path> &files, const std::string &meshUnit);
  /// The same files once more, as they are now.
  void reload();
  [[nodiscard]] bool hasOpened() const { return !files_.empty(); }

 private:
  [[nodiscard]] Expected<scene::SceneFile> read(const std::vector<std::filesystem::path> &files,
                                                const std::string &meshUnit) const;

  Session &session_;
  Events events_;
  Handle job_;
  std::uint64_t serial_ = 0;  ///< of the load that was asked for last
  std::vector<std::filesystem::path> files_;  ///< of the present simulation, or the last try when there is none
  std::string meshUnit_;
};

}  // namespace c3de::app
