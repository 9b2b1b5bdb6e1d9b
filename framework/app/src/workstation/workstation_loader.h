// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/session/session.h"

namespace c3de::app {

/// Opens meshes and scenes beside the window: reading and building run in a background job, and only what is complete
/// takes the place of what was there. Main thread. Must outlive the session's jobs.
class WorkstationLoader {
 public:
  struct Loaded {
    bool isReload = false;  ///< the same files as before
    double size_mm = 0.0;   ///< diagonal of all bodies; 0: not known
    std::string unit;       ///< that meshes were read in, and why, for a person; empty when only a scene was opened
    std::optional<scene::SceneImage> image;  ///< that the scene shows beside its bodies
    bool isImageOpen = false;                ///< it is in the window already
    std::vector<Coverage> coverage;          ///< of bodies from images
    std::vector<TissuePlaces> tissues;       ///< of bodies of many tissues
  };
  struct Events {
    /// The new simulation is the present one.
    std::function<void(const Loaded &)> loaded;
    /// What was there stays.
    std::function<void(const std::string &title, const Error &error)> failed;
  };
  WorkstationLoader(Session &session, Events events) : session_(session), events_(std::move(events)) {}

  /// Meshes become bodies of one scene, with a floor below them; beside a scene they are added to it. Ends a load that
  /// is running.
  /// @param meshUnit  mm, cm, m; empty: what each file says, else mm
  void open(const std::vector<std::filesystem::path> &files, const std::string &meshUnit) {
    load({files, meshUnit, {}, {}}, false);
  }
  /// A scene that was written in the window, of the image that is open there. Ends a load that is running.
  /// @param done  how it ended, in the place of Events::failed; also of one that another load has ended
  void openText(const std::string &scene, std::function<void(const Expected<void> &)> done) {
    load({{}, {}, scene, std::move(done)}, false);
  }
  /// The same files once more, as they are now.
  void reload() {
    Source again = source_;
    again.done = {};
    load(std::move(again), true);
  }

 private:
  /// What a simulation is made of: files, or the text of a scene.
  struct Source {
    std::vector<std::filesystem::path> files;
    std::string meshUnit;
    std::string text;
    std::function<void(const Expected<void> &)> done;  ///< of a text
  };
  void load(Source source, bool isReload);
  [[nodiscard]] Expected<scene::SceneFile> read(const std::vector<std::filesystem::path> &files,
                                                const std::string &meshUnit) const;

  Session &session_;
  Events events_;
  Handle job_;
  std::uint64_t serial_ = 0;  ///< of the load that was asked for last
  Source source_;             ///< of the present simulation, or the last try when there is none
};

}  // namespace c3de::app
