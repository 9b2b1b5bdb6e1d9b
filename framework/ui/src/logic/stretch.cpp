// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/stretch.h"
#include "c3de/core/file_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"

namespace c3de::ui {
namespace {

namespace fs = std::filesystem;

/// Times are sums of steps, so they may be slightly below those of frames.
constexpr double kTolerance = 1e-6;
constexpr double kLeastInterval_ms = 1e-3, kMostInterval_ms = 1e6, kLeastRate = 1e-3, kMostRate = 1e4;
constexpr int kLeastSize = 16, kMostSize = 8192;
constexpr double kMostFrames = 999999.0;  // their names have six digits

std::string outside(const std::string &what, double value, double low, double high, const std::string &unit) {
  return fmt::format("{}: {}; accepted: {} to {}{}{}", what, formatNumber(value), formatNumber(low), formatNumber(high),
                     unit.empty() ? "" : " ", unit);
}

std::string problemOfPictures(const StretchExport &wanted, double duration_s) {
  if (!(wanted.pictureRate >= kLeastRate && wanted.pictureRate <= kMostRate))
    return outside("Pictures per simulated second", wanted.pictureRate, kLeastRate, kMostRate, {});
  for (const int size : {wanted.width, wanted.height})
    if (size < kLeastSize || size > kMostSize)
      return outside("Size of a picture", size, kLeastSize, kMostSize, "pixels");
  if (wanted.hasFilm && (wanted.width % 2 != 0 || wanted.height % 2 != 0))
    return fmt::format("Size of a film: {} × {}; accepted: even numbers", wanted.width, wanted.height);
  if (const double count = frameCount(duration_s, 1.0 / wanted.pictureRate); count > kMostFrames)
    return outside("Pictures", count, 1, kMostFrames, {});
  return {};
}

}  // namespace

void Stretch::setBegin(std::uint64_t position, std::uint64_t length) {
  begin = std::min(position, length > 0 ? length - 1 : 0);
  if (end <= begin) end = length;
}

void Stretch::setEnd(std::uint64_t position, std::uint64_t length) {
  end = std::clamp<std::uint64_t>(position, std::min<std::uint64_t>(length, 1), length);
  if (begin >= end) begin = 0;
}

StretchFiles filesOf(const StretchExport &wanted) {
  const auto named = [&](const char *suffix) { return wanted.folder / pathFromText(wanted.name + suffix); };
  return {named(".pvd"), named("_frames"), named(".csv"), named("_pictures"), named(".mp4")};
}

std::string pictureName(std::size_t number) { return fmt::format("picture_{:06}.png", number); }

std::vector<fs::path> existingFiles(const StretchExport &wanted) {
  const StretchFiles files = filesOf(wanted);
  std::vector<fs::path> found;
  const auto add = [&](bool isWanted, const fs::path &file) {
    std::error_code ignored;
    if (isWanted && fs::exists(file, ignored)) found.push_back(file);
  };
  add(wanted.hasFrames, files.frames);
  add(wanted.hasFrames, files.framesFolder);
  add(wanted.hasProbes, files.probes);
  add(wanted.hasPictures, files.picturesFolder);
  add(wanted.hasFilm, files.film);
  return found;
}

std::string problemOf(const StretchExport &wanted, double duration_s) {
  if (!wanted.hasFrames && !wanted.hasProbes && !wanted.hasPictures && !wanted.hasFilm) return "Nothing is chosen";
  if (wanted.hasFrames) {
    if (!(wanted.frameEvery_ms >= kLeastInterval_ms && wanted.frameEvery_ms <= kMostInterval_ms))
      return outside("Time between two frames", wanted.frameEvery_ms, kLeastInterval_ms, kMostInterval_ms, "ms");
    if (const double count = frameCount(duration_s, 1e-3 * wanted.frameEvery_ms); count > kMostFrames)
      return outside("Frames", count, 1, kMostFrames, {});
  }
  if (wanted.hasPictures || wanted.hasFilm)
    if (std::string problem = problemOfPictures(wanted, duration_s); !problem.empty()) return problem;
  if (wanted.name.empty()) return "The files have no name";
  if (wanted.name.find_first_of("/\\:*?\"<>|") != std::string::npos)
    return "Name '" + wanted.name + "': accepted: a name without / \\ : * ? \" < > |";
  std::error_code ignored;
  if (!isAbsolutePath(wanted.folder) || !fs::is_directory(wanted.folder, ignored))
    return "Folder '" + pathText(wanted.folder) + "': accepted: the full path of a folder that exists";
  return {};
}

double frameCount(double duration_s, double interval_s) {
  return std::floor(std::max(duration_s, 0.0) / interval_s * (1.0 + 1e-9) + kTolerance) + 1.0;
}

std::vector<std::uint64_t> framePositions(const Stretch &stretch, const TimeAt &timeAt_s, double interval_s) {
  std::vector<std::uint64_t> positions;
  const double begin_s = timeAt_s(stretch.begin), duration_s = timeAt_s(stretch.end) - begin_s;
  if (duration_s <= 0.0) {
    for (std::uint64_t at = stretch.begin; at <= stretch.end; ++at) positions.push_back(at);
    return positions;
  }
  const double tolerance_s = kTolerance * duration_s / static_cast<double>(stretch.end - stretch.begin);
  const auto count = static_cast<std::size_t>(frameCount(duration_s, interval_s));
  std::uint64_t at = stretch.begin;
  for (std::size_t k = 0; k < count; ++k) {
    const double limit_s = begin_s + static_cast<double>(k) * interval_s + tolerance_s;
    while (at < stretch.end && timeAt_s(at + 1) <= limit_s) ++at;
    positions.push_back(at);
  }
  return positions;
}

fs::path findProgram(const std::string &name, const std::string &folders) {
  const std::string file = pathListSeparator() == ';' ? name + ".exe" : name;
  for (std::size_t from = 0; from <= folders.size();) {
    const std::size_t to = std::min(folders.find(pathListSeparator(), from), folders.size());
    const fs::path folder = pathFromText(folders.substr(from, to - from));
    from = to + 1;
    // A relative folder would depend on where the program was started.
    if (!isAbsolutePath(folder)) continue;
    std::error_code ignored;
    const fs::file_status status = fs::status(folder / file, ignored);
    constexpr fs::perms kRuns = fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec;
    if (fs::is_regular_file(status) && (status.permissions() & kRuns) != fs::perms::none) return folder / file;
  }
  return {};
}

}  // namespace c3de::ui
