// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/render/renderer.h"

namespace c3de::ui {

enum class RecentKind { scan, dicomFolder, scene, mesh, session };

/// Files that were opened together.
struct RecentFile {
  std::vector<std::filesystem::path> files;  ///< absolute; the first names the entry
  RecentKind kind = RecentKind::scan;
  std::string meshUnit;         ///< mm, cm, m; empty: the unit stated in each file, else mm
  std::int64_t openedAt_s = 0;  ///< since 1970, UTC

  [[nodiscard]] bool isSameAs(const RecentFile &other) const { return files == other.files; }
  /// One of the files does not exist. Accesses the disk.
  [[nodiscard]] bool isMissing() const;
};

inline constexpr std::size_t kMaxRecentFiles = 12;
inline constexpr int kThumbnailWidth = 192, kThumbnailHeight = 120;

/// The list of recent files in a folder: recent.json, and a picture for each entry. Several processes may change it at
/// the same time: each change reads the list again while it holds a lock, and replaces the file atomically. Accesses
/// the disk; any thread, one at a time.
class RecentFiles {
 public:
  /// The list, the newest first. It is complete in spite of a problem, as far as it is known.
  struct Listing {
    std::vector<RecentFile> files;
    std::optional<Error> problem;  ///< the file is damaged, or it cannot be read or written
  };
  /// @param folder  created by the first change
  explicit RecentFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  [[nodiscard]] Listing read() const;
  /// Makes the entry the newest one, and removes the oldest ones that are too many. A change that cannot be written is
  /// kept in this object and written with the next one.
  [[nodiscard]] Listing add(const RecentFile &file);
  [[nodiscard]] Listing remove(const RecentFile &file);
  [[nodiscard]] Listing clear();
  /// No effect if the list does not contain the entry.
  /// @param picture  of any size: its middle part, reduced to kThumbnailWidth x kThumbnailHeight, is written
  [[nodiscard]] Listing setPicture(const RecentFile &file, const render::Image &picture);
  /// Place of the entry's picture, which need not exist.
  [[nodiscard]] std::filesystem::path pictureFile(const RecentFile &file) const;

 private:
  using Files = std::vector<RecentFile>;
  using Change = std::function<void(Files &)>;
  [[nodiscard]] Listing change(Change change, const std::function<Expected<void>(const Files &)> &more = {});
  [[nodiscard]] Listing stored() const;
  void applyTo(Files &files) const;
  void removeOtherPictures(const Files &files) const;

  std::filesystem::path folder_;
  std::vector<Change> unwritten_;
};

/// The middle part of a picture with the proportions of the result, reduced by averaging. Empty: an image without
/// pixels.
[[nodiscard]] render::Image reducedPicture(const render::Image &picture, int width, int height);

}  // namespace c3de::ui
