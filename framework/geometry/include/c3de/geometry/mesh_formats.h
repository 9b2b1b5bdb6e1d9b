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

/// A mesh as a reader found it: numbers as they stand in the file, not checked yet.
struct ReadMesh {
  TriangleMesh mesh;
  std::optional<LengthUnit> unit;  ///< that the file says; none: nothing is said
  std::vector<std::string> notes;  ///< what was left out, a sentence each
};

/// A reader of meshes beside those of the program.
struct MeshReader {
  std::string id;                       ///< for example "org.example.tetra"
  std::string label;                    ///< for people: "Points and triangles"
  std::string owner;                    ///< the plugin's id
  std::vector<std::string> extensions;  ///< lower case with the dot
  std::string magic;                    ///< what its files begin with; empty: anything
  /// Reads the bytes of a file; any thread, several at once. ErrorCode::cancelled when progress answers false.
  std::function<Expected<ReadMesh>(const std::filesystem::path &, std::string_view bytes, const ProgressFn &)> read;
};

/// A writer of meshes beside those of the program.
struct MeshWriter {
  std::string id, label, owner;         ///< as of a reader
  std::vector<std::string> extensions;  ///< lower case with the dot
  /// Gives the bytes of a file; any thread, several at once. ErrorCode::cancelled when progress answers false.
  std::function<Expected<std::string>(const TriangleMesh &, const std::string &name, const ProgressFn &)> write;
};

/// The mesh formats that can be read and written: those of the program (loadMesh, writeMesh) and those of plugins. Any
/// thread.
///
/// The program's own readers win the extensions they have; of several readers the one that was added first and whose
/// magic the file begins with. Any reader can be asked for by its id.
class MeshFormats {
 public:
  MeshFormats();
  ~MeshFormats();

  /// Of a reader that was added: what it will not get unless it is asked for by its id, a sentence per extension that
  /// names who wins.
  struct Added {
    Handle handle;
    std::vector<std::string> conflicts;
  };
  /// Refused (ErrorCode::usage) where the id is taken; the error names by whom.
  [[nodiscard]] Expected<Added> add(MeshReader reader);
  [[nodiscard]] Expected<Added> add(MeshWriter writer);
  enum class Removal { done, stale, fromWithin };
  /// Ends what a reader or writer is doing; when this returns, it does nothing and never will. Not from within itself.
  Removal remove(Handle format, const std::string &owner);
  void removeOwnedBy(const std::string &owner);

  /// By the extension alone.
  [[nodiscard]] bool isMeshFile(const std::filesystem::path &path) const;
  /// Those of the program first, then those of plugins, lower case with the dot, each once.
  [[nodiscard]] std::vector<std::string> extensions() const;
  struct Info {
    std::string id, label, owner;
    std::vector<std::string> extensions;
  };
  [[nodiscard]] std::vector<Info> readers() const;  ///< of plugins, in the order they were added
  [[nodiscard]] std::vector<Info> writers() const;  ///< likewise

  /// Those that can be written: of the program first, then of plugins, lower case with the dot, each once.
  [[nodiscard]] std::vector<std::string> writableExtensions() const;
  /// Error (ErrorCode::usage) that names the accepted extensions.
  [[nodiscard]] Expected<void> checkWritable(const std::filesystem::path &path) const;
  /// As geometry::writeMesh, by writers of plugins as well. Errors of a writer name it, its plugin and the file.
  [[nodiscard]] Expected<void> write(const std::filesystem::path &path, const TriangleMesh &mesh,
                                     const MeshWriteOptions &options, const ProgressFn &progress = {}) const;

  /// As geometry::loadMesh, from readers of plugins as well; what they give is checked, welded, oriented and reported
  /// like any other mesh. Errors of a reader name it, its plugin and the file.
  /// @param readerId  that shall read it, whatever the extension; empty: by the rule above
  [[nodiscard]] Expected<LoadedMesh> load(const std::filesystem::path &path, std::optional<LengthUnit> unit,
                                          const ProgressFn &progress = {}, const std::string &readerId = {}) const;
  /// The unit that the file says; of readers of plugins by reading it. None: it says none, or cannot be read.
  [[nodiscard]] std::optional<LengthUnit> unitInFile(const std::filesystem::path &path) const;
  /// What a scene states, else what the file says. ErrorCode::input where neither does.
  [[nodiscard]] Expected<LengthUnit> unitOf(const std::filesystem::path &path, std::optional<LengthUnit> stated) const;

 private:
  struct Entry;
  struct Raw;
  class Use;
  [[nodiscard]] Expected<Added> add(std::shared_ptr<Entry> entry);
  [[nodiscard]] std::vector<Info> entriesThat(bool write) const;
  /// By readers of plugins alone.
  [[nodiscard]] Expected<Raw> read(const std::filesystem::path &path, const ProgressFn &progress,
                                   const std::string &readerId) const;
  static void end(Entry &entry);

  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<Entry>> entries_;
  std::uint32_t next_ = 1;
};

}  // namespace c3de::geometry
