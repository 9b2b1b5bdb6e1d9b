// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/core/vec.h"

namespace c3de::session {

/// The version of session.json that this program writes, and the newest that it reads.
inline constexpr std::int64_t kSessionFormat = 1;

/// A file, or a folder of one image (DICOM), that a session uses.
struct ReferencedFile {
  std::string path;         ///< UTF-8, forward slashes; relative to the folder of the session where possible
  std::string sha256;       ///< 64 lower-case hexadecimal digits, as sha256Of() gives them
  std::uint64_t bytes = 0;  ///< of a folder: of all files in it
  bool isEmbedded = false;  ///< its content is the member embeddedName(), of a folder the members below it

  friend bool operator==(const ReferencedFile &, const ReferencedFile &) = default;
};

/// Landmarks of the window, and distances and angles between them.
struct SavedMeasurements {
  struct Point {
    std::string name;  ///< unique
    std::string body;  ///< empty: the one in which it lies
    Vec3 at_mm{};      ///< at rest, world, LPS
    std::optional<Vec3> target_mm;
    bool isHidden = false, isOfScene = false;
    friend bool operator==(const Point &, const Point &) = default;
  };
  struct Between {
    std::string name;
    std::vector<std::string> points;  ///< two: a distance; three: an angle, the second is the vertex
    bool isHidden = false, isOfScene = false;
    friend bool operator==(const Between &, const Between &) = default;
  };
  std::vector<Point> points;
  std::vector<Between> measures;
  friend bool operator==(const SavedMeasurements &, const SavedMeasurements &) = default;
};

/// What was picked or painted in the image, of which no body had been created yet.
struct SavedSelection {
  std::string mask;                   ///< member with the mask; empty: none
  std::vector<std::uint64_t> labels;  ///< picked labels of the shown label map, in order
  std::string name;                   ///< of the organ
  double low = 0.0, high = 0.0;       ///< limits of the threshold, image values

  friend bool operator==(const SavedSelection &, const SavedSelection &) = default;
};

/// A second scan over the image, and its rigid motion: x -> R (x - centre) + centre + translation, R = Rz Ry Rx.
struct SavedComparison {
  std::string image;       ///< as SessionView::image
  std::string series;      ///< empty: the only or first one
  std::uint64_t time = 0;  ///< time point, from 0
  Vec3 translation_mm{}, rotation_deg{}, centre_mm{};
  bool isHidden = false, isCheckerboard = false;
  double blend = 0.5;       ///< weight of the second scan, 0 … 1
  double square_mm = 20.0;  ///< above 0
  std::optional<double> window, level;

  friend bool operator==(const SavedComparison &, const SavedComparison &) = default;
};

/// Values of the window's panel *Match*.
struct SavedMatch {
  std::string body;
  std::string points, surface, labels, landmarks;  ///< absolute paths; empty: none
  std::uint64_t time = 0;                          ///< time point of the label map, from 0
  std::string source = "points";                   ///< "points", "surface", "labels" or "stream"
  std::string server;                              ///< address of a tracking system; empty: none
  std::string tool;                                ///< of the tracking system; empty: none
  std::uint64_t toolPoints = 200;                  ///< of the tool in a frame
  std::string label;                               ///< number or name
  std::string unit;              ///< of points and surface: "m", "mm" or "cm"; empty: that of the file
  double noise_mm = 1.0;         ///< above 0: standard deviation of the measurement
  double landmarkWeight = 10.0;  ///< above 0: points that one fitted landmark counts as
  bool fitsLandmarks = false;    ///< false: landmarks evaluate the result
  bool isRigidFirst = true;      ///< false: the position of the body is given
  bool deforms = true;           ///< false: the rigid motion only

  friend bool operator==(const SavedMatch &, const SavedMatch &) = default;
};

/// What the window showed. Paths as in SessionFile::files, or names of members.
struct SessionView {
  struct CameraPose {
    Vec3 focus_mm{};
    double yaw_rad = 0.0, pitch_rad = 0.0, distance_mm = 0.0;  ///< as in render::Camera

    friend bool operator==(const CameraPose &, const CameraPose &) = default;
  };
  std::string image;                    ///< empty: none
  std::string series;                   ///< of the image; empty: its only or first one
  std::uint64_t time = 0;               ///< time point of the image, from 0
  std::vector<std::string> labels;      ///< label maps over the image
  std::optional<Vec3> crossHair_mm;     ///< world, LPS
  std::optional<double> window, level;  ///< in the unit of the voxels
  std::optional<CameraPose> camera;
  std::optional<SavedMeasurements> measurements;  ///< none: those of the scene
  std::optional<SavedSelection> selection;        ///< none: nothing is picked
  std::optional<SavedComparison> comparison;      ///< none: only the image is shown
  std::optional<SavedMatch> match;                ///< none: that of the scene

  friend bool operator==(const SessionView &, const SessionView &) = default;
};

/// A persistent change of the simulation (iface/changes.h).
struct SavedChange {
  std::string id, key, text;
  std::uint32_t flags = 0;
  std::uint64_t scenes = 1;  ///< of SessionFile::scenes, built before it
  std::string bytes;

  friend bool operator==(const SavedChange &, const SavedChange &) = default;
};

/// The content of a session file (.c3de): a zip of session.json, scene texts, a state and other members. Value type;
/// any thread.
struct SessionFile {
  std::string program;  ///< name and version of the program that saved it
  std::string savedAt;  ///< ISO 8601, UTC
  std::string title;
  std::string simulatorClass;          ///< class of the simulator, as its plugin registers it
  std::vector<std::string> scenes;     ///< TOML: the first one builds the simulation, each further one adds bodies
  std::vector<std::string> overrides;  ///< PATH=VALUE, applied to the first scene in this order
  std::vector<SavedChange> changes;    ///< in order; `scenes` does not decrease
  std::vector<ReferencedFile> files;   ///< each path once
  SessionView view;
  std::optional<std::uint64_t> stateHash;  ///< of the saved state, from the simulator
  std::uint64_t steps = 0;                 ///< made up to the saved state
  double time_s = 0.0;                     ///< simulated
  std::string state;                       ///< as stateBytes() gives it; empty: the initial state

  /// All other members by name: label maps drawn here, thumbnails, private state of plugins (plugins/ID), embedded
  /// files (files/…), and those of other programs.
  std::map<std::string, std::string> members;
  /// Members with content of embedded files that is not in `members`: the file on disk that has it, or an empty path
  /// for one that has stayed in its archive (EmbeddedContent::stays).
  std::map<std::string, std::filesystem::path> embedded;
  /// Keys of session.json that this version does not know: JSON pointer and compact JSON text. Those of an entry of
  /// `files` are addressed by its path (/files/PATH/KEY). They are saved again.
  std::map<std::string, std::string> unknown;

  friend bool operator==(const SessionFile &, const SessionFile &) = default;
};

/// Whether the file name has the extension of a session (".c3de").
[[nodiscard]] bool isSessionPath(const std::filesystem::path &path);

/// Name of the member with the content of an embedded file: files/SHA256/NAME. A path of this form is the name itself.
[[nodiscard]] std::string embeddedName(const ReferencedFile &file);

/// Writes a session. Equal content gives equal bytes (with one version of zlib). The file appears complete, after it is
/// on the disk; the former file stays on every error, also if the power fails. Any
/// thread. Errors: output, naming file and reason; usage, naming what a session cannot contain (a member that has the
/// name of another or leads out of the session, text that is not UTF-8, a number that is not finite, an embedded file
/// without its member); input, if the content of SessionFile::embedded is not that of its hash; cancelled, if
/// `progress` returns false. Files of SessionFile::embedded are read and packed in pieces and need no memory.
[[nodiscard]] Expected<void> writeSession(const SessionFile &session, const std::filesystem::path &path,
                                          const ProgressFn &progress = {});
/// The bytes of that file. Errors: as writeSession(), without the name of the file.
[[nodiscard]] Expected<std::string> sessionBytes(const SessionFile &session);
/// The same in pieces, from the first byte to the last.
[[nodiscard]] Expected<void> packSession(const SessionFile &session, const std::function<void(std::string_view)> &sink,
                                         const ProgressFn &progress = {});

/// What happens to the members of embedded files.
enum class EmbeddedContent {
  read,  ///< into SessionFile::members
  stays  ///< in the archive; named by SessionFile::embedded, and not checked
};

/// Reads a session into memory. Any thread. Errors (input) name the file and what is wrong: no zip,
/// truncated, a damaged or missing member, a newer format, a key of the wrong type, a name that leads out of the
/// session, more than 16 GiB or than the free memory.
[[nodiscard]] Expected<SessionFile> readSession(const std::filesystem::path &path,
                                                EmbeddedContent content = EmbeddedContent::read);
/// The same from an open file or memory. @param name  for messages
[[nodiscard]] Expected<SessionFile> readSession(std::istream &in, const std::string &name,
                                                EmbeddedContent content = EmbeddedContent::read);

/// SHA-256 of the bytes of a file, or of the list of files in a folder and its subfolders: a line "SHA256  NAME\n" for
/// each, ordered by name (relative to the folder, UTF-8, forward slashes). Files are not read into memory. Any thread.
/// Errors: input; cancelled, if `progress` returns false.
[[nodiscard]] Expected<std::string> sha256Of(const std::filesystem::path &path, const ProgressFn &progress = {});

/// ReferencedFile::path of a file or folder, which need not exist.
[[nodiscard]] std::string referencePath(const std::filesystem::path &path, const std::filesystem::path &sessionFolder);

/// A reference to a file or folder, from a session in `sessionFolder`, with its hash and size. Errors: as sha256Of().
[[nodiscard]] Expected<ReferencedFile> referenceTo(const std::filesystem::path &path,
                                                   const std::filesystem::path &sessionFolder,
                                                   const ProgressFn &progress = {});

struct FoundFile {
  enum class State {
    same,
    changed,  ///< there is a file, with another content
    missing   ///< there is no file, or it cannot be read
  };
  ReferencedFile file;
  std::filesystem::path at;  ///< empty: missing, or embedded (and then the same)
  State state = State::missing;
  std::shared_ptr<const void> use;  ///< while it exists, an extracted file is not removed
};

/// The files of a session, in its order: by their path (relative ones from `sessionFolder`), then by their name in
/// `sessionFolder`. The first one with the same content is taken, otherwise the first one that exists. Files of another
/// size are not read. Any thread. Errors: cancelled, if `progress` returns false.
[[nodiscard]] Expected<std::vector<FoundFile>> findFiles(const SessionFile &session,
                                                         const std::filesystem::path &sessionFolder,
                                                         const ProgressFn &progress = {});

/// Searches a folder and its subfolders for files that are missing or changed. Files are recognised by SHA-256,
/// whatever their names; folders by name and SHA-256. A file of the right name with another content is changed. Links
/// to folders are not followed. Any thread. Errors: input, if there is no such folder; cancelled, if `progress` returns
/// false.
/// @param unread  receives the folders that cannot be read, with the reason; null: nobody asks
[[nodiscard]] Expected<void> searchFolder(const std::filesystem::path &folder, std::vector<FoundFile> &files,
                                          const ProgressFn &progress = {}, std::vector<std::string> *unread = nullptr);

}  // namespace c3de::session
