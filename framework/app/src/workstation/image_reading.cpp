// SPDX-License-Identifier: Apache-2.0
#include "workstation/image_reading.h"

#include <algorithm>
#include <utility>

namespace c3de::app {
namespace {

constexpr std::size_t kHistogramBins = 128;  // about two pixels each in the panel

/// Whether to open it as labels: the named file is a segmentation, or all series are.
bool isSegmentation(const std::vector<imaging::SeriesInfo> &readable) {
  const auto segments = [](const imaging::SeriesInfo &s) { return s.isSegmentation; };
  return (!readable.empty() && std::all_of(readable.begin(), readable.end(), segments)) ||
         std::any_of(readable.begin(), readable.end(),
                     [&](const imaging::SeriesInfo &s) { return s.holdsNamedFile && segments(s); });
}

/// Modality and description of a series; if none is named, of the one that is read.
std::string descriptionOf(const std::vector<imaging::SeriesInfo> &all, const std::string &series) {
  const imaging::SeriesInfo *found = nullptr;
  for (const imaging::SeriesInfo &one : all) {
    const bool isNamed = series.empty() ? one.holdsNamedFile : one.id == series;
    if (!found || (isNamed && found->id != series)) found = &one;
  }
  return found ? found->modality + " " + found->description : std::string();
}

}  // namespace

Expected<void> readStored(const ImageToRead &wanted, const ProgressFn &progress, ReadImage &read) {
  imaging::ReadOptions options;
  options.series = wanted.series;
  options.time = wanted.time;
  options.progress = progress;
  auto loaded = imaging::readVolume(wanted.path, options);
  if (!loaded) return tl::unexpected(loaded.error());
  if (progress && !progress(-1.0, "analysing the values"))
    return fail(ErrorCode::cancelled, "opening " + wanted.name + " was cancelled");
  auto image = std::make_shared<scene::StoredImage>();
  image->name = wanted.name;
  image->volume = std::move(loaded->volume);
  image->range = imaging::robustRange(image->volume);
  if (image->volume.colours.empty())
    image->histogram = imaging::histogramOf(image->volume, image->range.min, image->range.max, kHistogramBins);
  image->time = wanted.time;
  image->times = loaded->times;
  read.image = std::move(image);
  read.notices = std::move(loaded->notices);
  return {};
}

Expected<void> readFirst(const ImageToRead &wanted, bool laysOver, const ProgressFn &progress, ReadImage &read) {
  if (wanted.series.empty() || wanted.needsDescription) {
    auto found = imaging::listSeries(wanted.path, progress);
    if (!found) return tl::unexpected(found.error());
    read.description = descriptionOf(*found, wanted.series);
    if (!wanted.series.empty()) return readStored(wanted, progress, read);
    std::erase_if(*found, [](const imaging::SeriesInfo &s) { return !s.refusal.empty(); });
    read.isSegmentation = isSegmentation(*found);
    if (read.isSegmentation && laysOver) return {};
    std::erase_if(*found, [&](const imaging::SeriesInfo &s) { return s.isSegmentation != read.isSegmentation; });
    const auto wholes =
        std::count_if(found->begin(), found->end(), [](const imaging::SeriesInfo &s) { return !s.isPart; });
    if (found->size() > 1 && !read.isSegmentation) read.series = std::move(*found);
    // one series in parts is opened as a whole, and its parts are offered
    if (wholes > 1 && !read.isSegmentation) return {};
  }
  return readStored(wanted, progress, read);
}

}  // namespace c3de::app
