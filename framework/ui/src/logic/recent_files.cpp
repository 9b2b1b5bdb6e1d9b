// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/recent_files.h"
#include "c3de/core/file_path.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>
#include <utility>

#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"

namespace c3de::ui {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kFormat = 1;
constexpr const char *kListName = "recent.json", *kDamagedName = "recent.damaged.json", *kLockName = "recent.lock";
constexpr const char *kPictureExtension = ".png";
constexpr std::array<const char *, 5> kKindNames{"scan", "dicom_folder", "scene", "mesh", "session"};

std::string timeText(std::int64_t time_s) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(static_cast<std::time_t>(time_s)));
}

std::optional<std::int64_t> parseTime(const std::string &text) {
  int year = 0;
  unsigned month = 0, day = 0, hour = 0, minute = 0, second = 0;
  if (std::sscanf(text.c_str(), "%4d-%2u-%2uT%2u:%2u:%2uZ", &year, &month, &day, &hour, &minute, &second) != 6)
    return {};
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month), std::chrono::day(day)};
  if (!date.ok() || hour > 23 || minute > 59 || second > 60) return {};
  const auto days = std::chrono::sys_days(date).time_since_epoch();
  return std::chrono::duration_cast<std::chrono::seconds>(days).count() + 3600 * hour + 60 * minute + second;
}

Json jsonOf(const RecentFile &file) {
  Json files = Json::array();
  for (const fs::path &path : file.files) files.push_back(pathText(path));
  Json entry{{"files", std::move(files)},
             {"kind", kKindNames[static_cast<std::size_t>(file.kind)]},
             {"opened_at", timeText(file.openedAt_s)}};
  if (!file.meshUnit.empty()) entry["mesh_unit"] = file.meshUnit;
  return entry;
}

/// Empty: not an entry of this format.
std::optional<RecentFile> entryOf(const Json &json) {
  constexpr std::size_t kMaxFiles = 1000;
  RecentFile file;
  if (!json.is_object() || !json.contains("files") || !json["files"].is_array()) return {};
  for (const Json &path : json["files"]) {
    if (!path.is_string()) return {};
    file.files.push_back(pathFromText(path.get<std::string>()));
    if (!isAbsolutePath(file.files.back())) return {};
  }
  if (file.files.empty() || file.files.size() > kMaxFiles) return {};
  const auto textOf = [&](const char *key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  const auto kind = std::find(kKindNames.begin(), kKindNames.end(), textOf("kind"));
  const auto time_s = parseTime(textOf("opened_at"));
  if (kind == kKindNames.end() || !time_s) return {};
  file.kind = static_cast<RecentKind>(kind - kKindNames.begin());
  file.openedAt_s = *time_s;
  file.meshUnit = textOf("mesh_unit");
  return file;
}

std::string listText(const std::vector<RecentFile> &files) {
  Json list = Json::array();
  for (const RecentFile &file : files) list.push_back(jsonOf(file));
  // Names that are not UTF-8 are stored with U+FFFD and reported as missing.
  return Json{{"format", kFormat}, {"files", std::move(list)}}.dump(1, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

/// Another process holds it for some milliseconds only.
Expected<FileLock> takeLock(const fs::path &folder) {
  constexpr int kTries = 200;
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) return fail(ErrorCode::output, pathText(folder) + ": cannot be created: " + code.message());
  for (int tries = 1;; ++tries) {
    auto lock = FileLock::take(folder / kLockName, "the list of recent files is being written");
    if (lock || lock.error().code != ErrorCode::state) return lock;
    if (tries == kTries)
      return fail(ErrorCode::output, pathText(folder / kLockName) + ": another program has held this lock for 2 s");
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

}  // namespace

bool RecentFile::isMissing() const {
  std::error_code ignored;
  return !std::all_of(files.begin(), files.end(), [&](const fs::path &file) { return fs::exists(file, ignored); });
}

RecentFiles::Listing RecentFiles::stored() const {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t{4} << 20;
  Listing listing;
  const fs::path file = folder_ / kListName;
  const auto refuse = [&](ErrorCode code, const std::string &why) {
    listing.problem = Error{code, pathText(file) + ": " + why};
    if (code == ErrorCode::input)
      listing.problem->message += std::string(". It is kept as ") + kDamagedName + " when the list changes.";
    return listing;
  };
  std::error_code code;
  if (!fs::exists(file, code)) return code ? refuse(ErrorCode::output, code.message()) : listing;
  const std::uintmax_t size = fs::file_size(file, code);
  if (code) return refuse(ErrorCode::output, "cannot be read: " + code.message());
  if (size > kMaxBytes) return refuse(ErrorCode::input, "damaged: it has " + std::to_string(size) + " bytes");
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad() || !in.is_open()) return refuse(ErrorCode::output, "cannot be read");
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("format") || !json["format"].is_number_integer())
    return refuse(ErrorCode::input, "damaged: it is not a list of recent files");
  if (json["format"].get<std::int64_t>() > kFormat)
    return refuse(ErrorCode::output, "is of the newer format " + std::to_string(json["format"].get<std::int64_t>()) +
                                         " and is kept as it is; accepted: format 1");
  if (!json.contains("files") || !json["files"].is_array())
    return refuse(ErrorCode::input, "damaged: 'files' is missing");
  std::size_t invalid = 0;
  for (const Json &one : json["files"]) {
    if (auto entry = entryOf(one))
      listing.files.push_back(std::move(*entry));
    else
      ++invalid;
  }
  if (invalid > 0) return refuse(ErrorCode::input, "damaged: " + std::to_string(invalid) + " entries are not readable");
  return listing;
}

void RecentFiles::applyTo(Files &files) const {
  for (const Change &change : unwritten_) change(files);
  if (files.size() > kMaxRecentFiles) files.resize(kMaxRecentFiles);
}

RecentFiles::Listing RecentFiles::read() const {
  Listing listing = stored();
  applyTo(listing.files);
  return listing;
}

RecentFiles::Listing RecentFiles::change(Change change, const std::function<Expected<void>(const Files &)> &more) {
  constexpr std::size_t kMaxUnwritten = 100;
  const auto lock = takeLock(folder_);
  Listing listing = stored();
  unwritten_.push_back(std::move(change));
  if (unwritten_.size() > kMaxUnwritten) unwritten_.erase(unwritten_.begin());
  applyTo(listing.files);
  if (!lock) {
    listing.problem = lock.error();
    return listing;
  }
  const bool isDamaged = listing.problem && listing.problem->code == ErrorCode::input;
  if (listing.problem && !isDamaged) return listing;
  std::error_code code;
  if (isDamaged) fs::rename(folder_ / kListName, folder_ / kDamagedName, code);
  if (code) {
    // Written now, the new list would replace the damaged one.
    listing.problem =
        Error{ErrorCode::output, fmt::format("{}: cannot be kept as {}: {}. The list is not written.",
                                             pathText(folder_ / kListName), kDamagedName, code.message())};
    return listing;
  }
  Expected<void> written = writeWholeFile(folder_ / kListName, listText(listing.files));
  if (written) {
    unwritten_.clear();
    if (more) written = more(listing.files);
    removeOtherPictures(listing.files);
  }
  if (!written) listing.problem = written.error();
  return listing;
}

RecentFiles::Listing RecentFiles::add(const RecentFile &file) {
  return change([file](Files &files) {
    std::erase_if(files, [&](const RecentFile &one) { return one.isSameAs(file); });
    files.insert(files.begin(), file);
  });
}

RecentFiles::Listing RecentFiles::remove(const RecentFile &file) {
  return change(
      [file](Files &files) { std::erase_if(files, [&](const RecentFile &one) { return one.isSameAs(file); }); });
}

RecentFiles::Listing RecentFiles::clear() {
  return change([](Files &files) { files.clear(); });
}

RecentFiles::Listing RecentFiles::setPicture(const RecentFile &file, const render::Image &picture) {
  return change([](Files &) {},
                [&](const Files &files) -> Expected<void> {
                  const auto isSame = [&](const RecentFile &one) { return one.isSameAs(file); };
                  if (std::none_of(files.begin(), files.end(), isSame)) return {};
                  return render::writePng(pathText(pictureFile(file)),
                                          reducedPicture(picture, kThumbnailWidth, kThumbnailHeight));
                });
}

fs::path RecentFiles::pictureFile(const RecentFile &file) const {
  // FNV-1a, since std::hash may differ between versions of the program.
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&hash](unsigned char byte) { hash = (hash ^ byte) * 0x100000001b3u; };
  for (const fs::path &path : file.files) {
    for (const char c : pathText(path)) add(static_cast<unsigned char>(c));
    add(0);
  }
  return folder_ / (fmt::format("{:016x}", hash) + kPictureExtension);
}

void RecentFiles::removeOtherPictures(const Files &files) const {
  std::error_code code, ignored;
  for (fs::directory_iterator at(folder_, code), end; !code && at != end; at.increment(code)) {
    const fs::path &file = at->path();
    const bool isUsed =
        std::any_of(files.begin(), files.end(), [&](const RecentFile &one) { return pictureFile(one) == file; });
    if (file.extension() == kPictureExtension && !isUsed) fs::remove(file, ignored);
  }
}

render::Image reducedPicture(const render::Image &picture, int width, int height) {
  if (picture.width < 1 || picture.height < 1 || width < 1 || height < 1) return {};
  const double scale =
      std::min(static_cast<double>(picture.width) / width, static_cast<double>(picture.height) / height);
  const double left = 0.5 * (picture.width - scale * width), top = 0.5 * (picture.height - scale * height);
  render::Image reduced{width, height, {}};
  reduced.rgb.reserve(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto range = [&](double origin, int i, int size) {
    const int first = std::clamp(static_cast<int>(origin + scale * i), 0, size - 1);
    return std::pair(first, std::clamp(static_cast<int>(origin + scale * (i + 1)), first + 1, size));
  };
  for (int y = 0; y < height; ++y) {
    const auto rows = range(top, y, picture.height);
    for (int x = 0; x < width; ++x) {
      const auto columns = range(left, x, picture.width);
      std::array<unsigned, 3> sum{};
      for (int row = rows.first; row < rows.second; ++row)
        for (int column = columns.first; column < columns.second; ++column)
          for (std::size_t c = 0; c < 3; ++c)
            sum[c] += picture.rgb[3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(picture.width) +
                                       static_cast<std::size_t>(column)) +
                                  c];
      const auto count = static_cast<unsigned>((rows.second - rows.first) * (columns.second - columns.first));
      for (const unsigned one : sum) reduced.rgb.push_back(static_cast<std::uint8_t>((one + count / 2) / count));
    }
  }
  return reduced;
}

}  // namespace c3de::ui
