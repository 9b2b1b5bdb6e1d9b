// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/session/body_update.h"
#include "c3de/session/default_floor.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"

namespace c3de::app {

/// Opens meshes and scenes without blocking the window. Reading and building run in a background job, and only a
/// complete result replaces the present simulation. Main thread. Must outlive the session's jobs.
class WorkstationLoader {
 public:
  /// A session file that was read, with its scenes and changes.
  struct OpenedSession {
    std::filesystem::path file;
    SessionFile saved;
    std::vector<FoundFile> files;
    std::shared_ptr<const imaging::Mask> mask;  ///< of saved.view.selection; null: none
    SimulationSource source;                    ///< empty: no simulation, only an image
    std::string action;  ///< what builds it, besides opening a file: "undo create liver", "update liver"; or empty
    std::string title;   ///< of the simulation; empty: that of its scene
    bool usesChangedFiles = false;  ///< a state that does not fit is not restored
    /// The simulator from whose state it continues, with what became of its bodies; null: none.
    std::shared_ptr<ObjectRef> continuesFrom = nullptr;
    std::shared_ptr<std::vector<ContinuedBody>> continued = nullptr;  ///< not null with continuesFrom
    std::function<bool()> isOutdated = {};                            ///< asked before it becomes the present one
  };
  struct Loaded {
    bool isReload = false;                         ///< the same files as before
    std::shared_ptr<const OpenedSession> session;  ///< null: not from a session
    std::string
        notRestored;       ///< why its state does not fit, and the simulation begins at the initial one; empty: it fits
    double size_mm = 0.0;  ///< diagonal of all bodies; 0: unknown
    std::string unit;      ///< unit in which meshes were read, and why, as display text; empty if only a scene was
                           ///< opened
    std::optional<scene::SceneImage> image;  ///< the image shown by the scene next to its bodies
    bool isImageOpen = false;                ///< it is already open in the window
    std::vector<Coverage> coverage;          ///< of bodies from images
    std::vector<TissueVoxels> tissues;       ///< of bodies of many tissues
  };
  struct Events {
    /// The new simulation has become the present one.
    std::function<void(const Loaded &)> loaded;
    /// The previous simulation remains.
    std::function<void(const std::string &title, const Error &error)> failed;
  };
  WorkstationLoader(Session &session, Events events) : session_(session), events_(std::move(events)) {}

  /// Meshes become bodies of one scene, with a floor below them; if there is also a scene, they are added to it. Ends a
  /// running load.
  /// @param meshUnit  mm, cm, m; empty: the unit stated in each file, else mm
  void open(const std::vector<std::filesystem::path> &files, const std::string &meshUnit) {
    load({files, meshUnit, {}, {}, {}}, false);
  }
  /// Builds the simulation of a session and restores its state. Ends a running load.
  /// @param isReload  the view stays
  /// @param done      as for openText(); empty: Events::failed
  void openSession(std::shared_ptr<const OpenedSession> session, bool isReload = false,
                   std::function<void(const Expected<void> &)> done = {}) {
    load({{session->file}, {}, {}, std::move(done), session}, isReload);
  }
  [[nodiscard]] bool isLoading() const { return !job_.isNull(); }
  /// Ends a running load.
  void cancel() {
    if (!job_.isNull()) session_.jobs().cancel(job_);
  }
  /// Opens a scene written in the window for the image that is open there. Ends a running load.
  /// @param done  receives the result, instead of Events::failed; also if another load has ended this one
  void openText(const std::string &scene, std::function<void(const Expected<void> &)> done) {
    load({{}, {}, scene, std::move(done), {}}, false);
  }
  /// Loads the same files again, in their present state.
  void reload() {
    Source again = source_;
    again.done = {};
    load(std::move(again), true);
  }
  /// Files of the last simulation that was loaded; empty for a text.
  [[nodiscard]] const std::vector<std::filesystem::path> &files() const { return source_.files; }

 private:
  /// Source of a simulation: files, or the text of a scene.
  struct Source {
    std::vector<std::filesystem::path> files;
    std::string meshUnit;
    std::string text;
    std::function<void(const Expected<void> &)> done;  ///< receives the result; may be empty
    std::shared_ptr<const OpenedSession> session;      ///< null: not from a session
  };
  /// A simulation that is being built.
  struct Build {
    ObjectRef simulator;
    SimulatorIdentity identity;
    SharedScene scene;
    bool needsFloor = false;
    Prepared prepared;
    std::optional<Bounds_m> bodies, room;
    std::string notRestored;  ///< Loaded::notRestored
  };
  /// In a background job. @param opened  null: not from a session
  [[nodiscard]] Expected<void> build(Build &build, const OpenedSession *opened, const ProgressFn &progress) const;
  void load(Source source, bool isReload);
  /// @param notRestored  receives Loaded::notRestored
  [[nodiscard]] Expected<void> restore(const OpenedSession &opened, c3de_object *simulator,
                                       const SimulatorIdentity &identity, std::string &notRestored) const;
  [[nodiscard]] Expected<scene::SceneFile> sceneOf(const Source &source) const;
  [[nodiscard]] Expected<scene::SceneFile> read(const std::vector<std::filesystem::path> &files,
                                                const std::string &meshUnit) const;

  Session &session_;
  Events events_;
  Handle job_;
  std::uint64_t serial_ = 0;  ///< of the last requested load
  Source source_;             ///< of the present simulation, or of the last attempt if there is none
};

}  // namespace c3de::app
