// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/handle.h"
#include "c3de/core/progress.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/geometry/mesh_writer.h"

namespace c3de::geometry {

/// A mesh as read: unchecked values from the file.
struct ReadMesh {
  TriangleMesh mesh;
  std::optional<LengthUnit> unit;  ///< stated in the file; none: not stated
  std::vector<std::string> notes;  ///< omissions, a sentence each
};

/// A mesh reader in addition to the built-in ones.
struct MeshReader {
  std::string id;                       ///< for example "org.example.tetra"
  std::string label;                    ///< display name: "Points and triangles"
  std::string owner;                    ///< the plugin's id
  std::vector<std::string> extensions;  ///< lower case with the dot
  std::string magic;                    ///< the first bytes of its files; empty: anything
  /// Reads the bytes of a file; any thread, several at once. ErrorCode::cancelled when progress returns false.
  std::function<Expected<ReadMesh>(const std::filesystem::path &, std::string_view bytes, const ProgressFn &)> read;
};

/// A mesh writer in addition to the built-in ones.
struct MeshWriter {
  std::string id, label, owner;         ///< as for a reader
  std::vector<std::string> extensions;  ///< lower case with the dot
  /// Returns the bytes of a file; any thread, several at once. ErrorCode::cancelled when progress returns false.
  std::function<Expected<std::string>(const TriangleMesh &, const std::string &name, const ProgressFn &)> write;
};

/// The mesh formats that can be read and written: the built-in ones (loadMesh, writeMesh) and those of plugins. Any
/// thread.
///
/// Built-in readers take precedence for their extensions. Of several plugin readers the first added one whose magic
/// matches the file is used. Any reader can be selected by its id.
class MeshFormats {
 public:
  MeshFormats();
  ~MeshFormats();

  /// For an added reader: the files it will only get when selected by its id, a sentence per extension that names the
  /// preferred reader.
  struct Added {
    Handle handle;
    std::vector<std::string> conflicts;
  };
  /// Refused (ErrorCode::usage) where the id is in use; the error names its owner.
  [[nodiscard]] Expected<Added> add(MeshReader reader);
  [[nodiscard]] Expected<Added> add(MeshWriter writer);
  enum class Removal { done, stale, fromWithin };
  /// Cancels running calls of a reader or writer. When this returns, none is running and none will start. Do not call
  /// it from within one.
  Removal remove(Handle format, const std::string &owner);
  void removeOwnedBy(const std::string &owner);

  /// By the extension alone.
  [[nodiscard]] bool isMeshFile(const std::filesystem::path &path) const;
  /// Built-in ones first, then those of plugins, lower case with the dot, each once.
  [[nodiscard]] std::vector<std::string> extensions() const;
  struct Info {
    std::string id, label, owner;
    std::vector<std::string> extensions;
  };
  [[nodiscard]] std::vector<Info> readers() const;  ///< of plugins, in the order they were added
  [[nodiscard]] std::vector<Info> writers() const;  ///< same

  /// Writable extensions: built-in ones first, then those of plugins, lower case with the dot, each once.
  [[nodiscard]] std::vector<std::string> writableExtensions() const;
  /// The error (ErrorCode::usage) lists the accepted extensions.
  [[nodiscard]] Expected<void> checkWritable(const std::filesystem::path &path) const;
  /// Same as geometry::writeMesh, including writers of plugins. Errors of a writer name it, its plugin and the file.
  [[nodiscard]] Expected<void> write(const std::filesystem::path &path, const TriangleMesh &mesh,
                                     const MeshWriteOptions &options, const ProgressFn &progress = {}) const;

  /// Same as geometry::loadMesh, including readers of plugins. Their meshes are checked, welded, oriented and reported
  /// like any other mesh. Errors of a reader name it, its plugin and the file.
  /// @param readerId  selects a reader, whatever the extension; empty: by the rule above
  [[nodiscard]] Expected<LoadedMesh> load(const std::filesystem::path &path, std::optional<LengthUnit> unit,
                                          const ProgressFn &progress = {}, const std::string &readerId = {}) const;
  /// The unit stated in the file; for readers of plugins by reading it. None: not stated, or the file cannot be read.
  [[nodiscard]] std::optional<LengthUnit> unitInFile(const std::filesystem::path &path) const;
  /// The unit stated in a scene, otherwise that in the file. ErrorCode::input where neither is stated.
  [[nodiscard]] Expected<LengthUnit> unitOf(const std::filesystem::path &path, std::optional<LengthUnit> stated) const;

 private:
  struct Entry;
  struct Raw;
  class Use;
  [[nodiscard]] Expected<Added> add(std::shared_ptr<Entry> entry);
  [[nodiscard]] std::vector<Info> entriesThat(bool write) const;
  /// Uses readers of plugins only.
  [[nodiscard]] Expected<Raw> read(const std::filesystem::path &path, const ProgressFn &progress,
                                   const std::string &readerId) const;
  static void end(Entry &entry);

  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<Entry>> entries_;
  std::uint32_t next_ = 1;
};

}  // namespace c3de::geometry
