// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/reading.h"
#include "c3de/scene/image_store.h"

namespace c3de::app {

/// Result of a reading job, passed to the main thread when it is complete.
struct ReadImage {
  std::shared_ptr<scene::StoredImage> image;
  std::vector<std::string> notices;
  std::vector<imaging::SeriesInfo> series;  ///< to choose from; if there is no image, nothing was read
  bool isSegmentation = false;              ///< to be opened as labels
  std::string description;                  ///< modality and description of its series
};

/// A file, or one of its series at one of its time points.
struct ImageToRead {
  std::filesystem::path path;
  std::string series;
  std::size_t time = 0;
  std::string name;  ///< display name
  bool needsDescription = false;
};

/// Reads an image with the range and the histogram of its values. Any thread. Errors: those of imaging::readVolume().
[[nodiscard]] Expected<void> readStored(const ImageToRead &wanted, const ProgressFn &progress, ReadImage &read);

/// The same of a file of which no series has been chosen. Of several series `read` receives the list, and no image, as
/// for a segmentation if `laysOver`. Any thread.
[[nodiscard]] Expected<void> readFirst(const ImageToRead &wanted, bool laysOver, const ProgressFn &progress,
                                       ReadImage &read);

}  // namespace c3de::app
