// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/change_log.h"
#include "c3de/session/session.h"
#include "c3de/session/session_file.h"
#include "c3de/session/simulator_identity.h"

namespace c3de::session {

/// The files that a scene names: meshes, images, label maps. Writable, so that a file that has moved can be replaced.
[[nodiscard]] std::vector<std::filesystem::path *> filesOf(scene::SceneFile &scene);

/// Number, size and last change of a file, or of all files in a folder.
struct FileStamp {
  std::uintmax_t files = 0, bytes = 0;
  std::filesystem::file_time_type changed = std::filesystem::file_time_type::min();

  friend bool operator==(const FileStamp &, const FileStamp &) = default;
};
/// None: it does not exist, or cannot be listed.
[[nodiscard]] std::optional<FileStamp> stampOf(const std::filesystem::path &path);

/// References to files with their SHA-256. A file is hashed again only if its size or time of change differs. One
/// thread at a time.
class FileReferences {
 public:
  /// Errors: as sha256Of().
  [[nodiscard]] Expected<ReferencedFile> of(const std::filesystem::path &file, const std::filesystem::path &folder,
                                            const ProgressFn &progress);
  /// Those that were changed after a time, as far as they have been asked for.
  [[nodiscard]] std::vector<std::filesystem::path> changedSince(std::filesystem::file_time_type time) const;

 private:
  struct Known {
    FileStamp stamp;
    ReferencedFile reference;
  };
  std::map<std::filesystem::path, Known> known_;  ///< by absolute path
};

/// What only the simulation's thread can read between two steps: source and state of a simulation, which belong
/// together.
struct CapturedState {
  SimulationSource source;
  SimulatorIdentity identity;
  std::string state;  ///< as stateBytes() gives it; empty: the initial state
  std::optional<std::uint64_t> hash;
  std::uint64_t steps = 0;
  double time_s = 0.0;
};

/// Call on the thread that steps the simulation, between two steps. Errors: the simulator stores no state, or not this
/// one.
[[nodiscard]] Expected<CapturedState> captureState(Session &session, c3de_object *simulator,
                                                   const SimulatorIdentity &identity, SimulationSource source);

/// The same of a simulation that other threads may change meanwhile. Errors also: bodies are being added, or it changes
/// all the time.
[[nodiscard]] Expected<CapturedState> captureState(Session &session, c3de_object *simulator,
                                                   const SimulatorIdentity &identity, const ChangeLog &changes);

/// Which files become members of a session.
enum class Embedding {
  none,
  extracted,  ///< those that have been extracted from a session: they have no other place
  all
};

/// A session of a captured simulation: its scenes as text, its changes, files by SHA-256, the state with its hash. Any
/// thread.
/// @param folder  of the session file, to which paths are relative
/// Errors: a file cannot be read; what sceneText() cannot write; those of filesBelongingTo() for embedded files.
[[nodiscard]] Expected<SessionFile> sessionOf(const CapturedState &captured, const std::filesystem::path &folder,
                                              FileReferences &references, const ProgressFn &progress = {},
                                              Embedding embedding = Embedding::extracted);

/// Adds a file, or a folder, that a session uses, and returns its path in the session. Errors: as sessionOf().
[[nodiscard]] Expected<std::string> addFile(const std::filesystem::path &file, const std::filesystem::path &folder,
                                            FileReferences &references, const ProgressFn &progress, Embedding embedding,
                                            SessionFile &saved);

/// Adds the mask of SessionView::selection, which must exist, as a member.
void addMaskOfSelection(const imaging::Mask &mask, SessionFile &saved);
/// The mask of SessionView::selection; null: none. @param file  for messages. Errors (input): its member is missing or
/// damaged.
[[nodiscard]] Expected<std::shared_ptr<const imaging::Mask>> maskOfSelection(const SessionFile &saved,
                                                                             const std::filesystem::path &file);

/// Adds what this program does not change or know in a session that was opened: members, keys, view.
/// @param files  of the opened session
/// Errors: as addFile().
[[nodiscard]] Expected<void> keepRest(const SessionFile &opened, const std::vector<FoundFile> &files,
                                      const std::filesystem::path &folder, FileReferences &references,
                                      Embedding embedding, SessionFile &saved);
/// Only members and keys.
void keepUnknown(const SessionFile &opened, SessionFile &saved);

/// Number and size of the files that Embedding::all would store. Any thread. Errors: those of filesBelongingTo().
/// @param shown  further files, such as an image in the window
[[nodiscard]] Expected<FileStamp> stampOfFiles(const SimulationSource &source,
                                               const std::vector<std::filesystem::path> &shown,
                                               const ProgressFn &progress = {});

/// Adds to files that were extracted from a session or a recording where that is. locateFiles() extracts them from there
/// again after the cache has been cleaned. @param folder  of the session file
void nameArchives(const std::filesystem::path &folder, SessionFile &saved);

/// SessionFile::savedAt of a session that is saved now.
[[nodiscard]] std::string savedNow();

/// Where files of a session may be, besides their path and the folder of the session.
struct FileSearch {
  std::map<std::string, std::filesystem::path> instead{};  ///< files to use, by ReferencedFile::path
  std::vector<std::filesystem::path> folders{};            ///< searched with their subfolders, in this order
};

/// The files of a session, in its order: as findFiles(), otherwise by the search. Embedded ones are extracted. Any
/// thread. Errors: those of searchFolder() and extractEmbedded().
[[nodiscard]] Expected<std::vector<FoundFile>> locateFiles(const SessionFile &saved, const std::filesystem::path &file,
                                                           const ProgressFn &progress = {},
                                                           const FileSearch &search = {});

/// The same. Errors (input) also name every file that is missing or has changed since.
[[nodiscard]] Expected<std::vector<FoundFile>> filesOfSession(const SessionFile &saved,
                                                              const std::filesystem::path &file,
                                                              const ProgressFn &progress = {},
                                                              const FileSearch &search = {});

/// Scenes and changes of a session file, with files that have moved replaced. Any thread.
/// @param files  those of filesOfSession(); one that has changed is used as it is
[[nodiscard]] Expected<SimulationSource> sourceOfSession(const SessionFile &saved, const std::filesystem::path &file,
                                                         const std::vector<FoundFile> &files,
                                                         const scene::MaterialLibrary *materials);

/// Adds bodies of further scenes and repeats changes on a simulator that was built from the first entry. Any thread,
/// before the simulation runs. Errors: those of Session::addBodies() and applyChange().
[[nodiscard]] Expected<void> buildRemaining(Session &session, c3de_object *simulator, const SimulationSource &source,
                                            const ProgressFn &progress, Prepared *prepared);

/// Restores the state of a session in a simulator built from its source. Errors: those of goToState(); the state hash
/// is not that of the saved state.
[[nodiscard]] Expected<void> restoreSession(Session &session, c3de_object *simulator, const SimulatorIdentity &identity,
                                            const SessionFile &saved, const std::filesystem::path &file);

/// The same for a source with files that have changed: a state that does not fit leaves the simulator in its initial
/// state. Returns why it does not fit; empty: it is restored. Errors: the initial state cannot be restored either.
[[nodiscard]] Expected<std::string> restoreIfPossible(Session &session, c3de_object *simulator,
                                                      const SimulatorIdentity &identity, const SessionFile &saved,
                                                      const std::filesystem::path &file);

}  // namespace c3de::session
