// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/embedded_files.h"
#include "c3de/core/file_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <set>
#include <utility>

#include "c3de/core/input_file.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "c3de/imaging/companion_files.h"
#include "files/archive_stream.h"
#include "files/embedded_names.h"
#include "files/file_hash.h"
#include "files/zip_archive.h"

namespace c3de::session {
namespace {

namespace fs = std::filesystem;

constexpr auto kKeptFor = std::chrono::hours(24 * 7);
constexpr auto kExtractsAtMost = std::chrono::hours(24);
constexpr const char *kUnfinished = ".extracting-";
constexpr const char *kUseLock = ".lock";
constexpr const char *kArchive = ".archive";  // beside a folder: names the session that it was extracted from

std::string uniqueSuffix() {
  std::random_device random;
  return fmt::format("{}-{:08x}", processId(), static_cast<std::uint32_t>(random()));
}

/// While it exists, no program removes the folder.
class ExtractionUse {
 public:
  /// Errors: output.
  static Expected<std::shared_ptr<ExtractionUse>> begin(const fs::path &folder) {
    fs::path file = folder;
    file += "." + uniqueSuffix() + kUseLock;
    auto lock = FileLock::take(file, "files of an open session");
    if (!lock) return fail(ErrorCode::output, lock.error().message);
    return std::shared_ptr<ExtractionUse>(new ExtractionUse(folder, std::move(file), std::move(*lock)));
  }
  ExtractionUse(const ExtractionUse &) = delete;
  ExtractionUse &operator=(const ExtractionUse &) = delete;
  ~ExtractionUse() {
    renew();
    lock_.reset();
    std::error_code ignored;
    fs::remove(file_, ignored);
  }
  /// The week begins anew.
  void renew() const {
    std::error_code ignored;
    fs::last_write_time(folder_, fs::file_time_type::clock::now(), ignored);
  }

 private:
  ExtractionUse(fs::path folder, fs::path file, FileLock lock) : folder_(std::move(folder)), file_(std::move(file)) {
    lock_.emplace(std::move(lock));
  }
  fs::path folder_, file_;
  std::optional<FileLock> lock_;
};

fs::path archiveFile(fs::path folder) { return folder += kArchive; }

/// Embedded files in one folder of an archive: files/SHA256.
struct Group {
  std::vector<FoundFile *> files;
  fs::path place;  ///< where they are extracted
  std::shared_ptr<ExtractionUse> use;
};

/// "NAME" of files/SHA256/NAME.
std::string nameInGroup(const ReferencedFile &file) {
  return embeddedName(file).substr(kEmbedded.size() + kSha256Digits + 1);
}

Expected<std::vector<Group>> groupsOf(std::vector<FoundFile> &files) {
  std::map<std::string, Group> byFolder;
  for (FoundFile &one : files)
    if (one.file.isEmbedded)
      byFolder[embeddedName(one.file).substr(0, kEmbedded.size() + kSha256Digits)].files.push_back(&one);
  std::vector<Group> groups;
  for (auto &[folder, group] : byFolder) {
    std::set<std::string> lines;
    for (const FoundFile *one : group.files) {
      const std::string name = nameInGroup(one->file);
      if (const std::string reason = refusedMemberName(name); !reason.empty())
        return fail(ErrorCode::input, fmt::format("member '{}' {}", displayMessage(embeddedName(one->file)), reason));
      lines.insert(lineOfFolder(one->file.sha256, name));
    }
    Sha256 hash;
    for (const std::string &line : lines) hash.add(line);
    const auto digits = hash.digits();
    if (!digits) return tl::unexpected(digits.error());
    group.place = extractionFolder() / *digits;
    groups.push_back(std::move(group));
  }
  return groups;
}

/// Whether all files of a group are there with the right content. Errors: cancelled.
Expected<bool> isThere(const Group &group, ByteProgress &progress) {
  std::error_code code;
  if (fs::symlink_status(group.place, code).type() != fs::file_type::directory) return false;
  for (const FoundFile *one : group.files) {
    const fs::path file = group.place / pathFromText(nameInGroup(one->file));
    if (fs::is_symlink(fs::symlink_status(file, code))) return false;
    const auto content = contentOf(file, one->file.bytes);
    if (!content || content->bytes != one->file.bytes) return false;
    const auto hash = hashOf(*content, progress);
    if (!hash && hash.error().code == ErrorCode::cancelled) return tl::unexpected(hash.error());
    if (!hash || *hash != one->file.sha256) return false;
  }
  return true;
}

/// Extracts groups into a folder of its own, and moves those that are complete to their places.
class Extractor {
 public:
  Extractor(const fs::path &session, std::vector<Group *> groups, ByteProgress &progress)
      : session_(session), groups_(std::move(groups)), progress_(progress) {}
  Extractor(const Extractor &) = delete;
  Extractor &operator=(const Extractor &) = delete;
  ~Extractor() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  Expected<void> extract() {
    if (auto free = checkSpace(); !free) return free;
    const auto archive = openArchive(session_);
    if (!archive) return tl::unexpected(archive.error());
    const auto streamed = streamZip((*archive)->stream(), pathText(session_),
                                    [this](const std::string &member) { return takerOf(member); });
    if (!streamed) return streamed;
    for (const Group *group : groups_)
      for (const FoundFile *one : group->files)
        if (auto same = checkHash(one->file); !same) return same;
    for (const Group *group : groups_)
      if (auto moved = move(*group); !moved) return moved;
    return {};
  }

 private:
  Expected<void> checkSpace() const {
    std::uint64_t total = 0;
    for (const Group *group : groups_)
      for (const FoundFile *one : group->files) total += one->file.bytes;
    std::error_code code;
    const fs::space_info space = fs::space(extractionFolder(), code);
    if (code || space.available >= total) return {};
    return fail(ErrorCode::output, fmt::format("{}: its files need {} bytes; {} has {} free", pathText(session_), total,
                                               pathText(extractionFolder()), space.available));
  }
  [[nodiscard]] fs::path placeIn(const Group &group) const { return folder_ / group.place.filename(); }

  struct Destination {
    fs::path file;                       ///< empty: none
    const ReferencedFile *of = nullptr;  ///< that the member belongs to
  };
  /// The file that a member becomes.
  [[nodiscard]] Destination destinationOf(const std::string &member) const {
    for (const Group *group : groups_)
      for (const FoundFile *one : group->files) {
        const std::string name = embeddedName(one->file);
        if (member == name || member.starts_with(name + "/"))
          return {placeIn(*group) / pathFromText(member.substr(kEmbedded.size() + kSha256Digits + 1)), &one->file};
      }
    return {};
  }

  Expected<TakePiece> takerOf(const std::string &member) {
    const auto [file, of] = destinationOf(member);
    if (file.empty()) return TakePiece();
    std::error_code code;
    fs::create_directories(file.parent_path(), code);
    auto opened = OutputFile::open(file);
    if (!opened) return tl::unexpected(opened.error());
    auto out = std::make_shared<OutputFile>(std::move(*opened));
    auto hash = std::make_shared<Sha256>();
    return TakePiece([this, member, out, hash, of = of](std::string_view piece) -> Expected<void> {
      if (piece.empty()) {
        auto digits = hash->digits();
        if (!digits) return tl::unexpected(digits.error());
        hashes_.insert_or_assign(member, std::move(*digits));
        return out->commit();
      }
      // Otherwise a small archive could fill the disk before its hash is compared.
      if ((written_[of] += piece.size()) > of->bytes)
        return fail(ErrorCode::input, fmt::format("{}: member '{}' is damaged: it has more than the {} bytes that the "
                                                  "session states",
                                                  pathText(session_), displayMessage(member), of->bytes));
      hash->add(piece);
      out->write(piece);
      return progress_.add(piece.size(), displayMessage(member.substr(member.rfind('/') + 1)));
    });
  }

  [[nodiscard]] Expected<void> checkHash(const ReferencedFile &file) const {
    const std::string name = embeddedName(file);
    const auto hash = embeddedHash(name, hashes_);
    if (!hash) return tl::unexpected(hash.error());
    if (*hash == file.sha256) return {};
    return fail(ErrorCode::input, fmt::format("{}: member '{}' is damaged: its SHA-256 is {}, and {} was saved",
                                              pathText(session_), displayMessage(name), *hash, file.sha256));
  }

  /// What another program has extracted meanwhile is replaced by the same content.
  [[nodiscard]] Expected<void> move(const Group &group) const {
    std::error_code code;
    const fs::path replaced = folder_ / ("replaced-" + pathText(group.place.filename()));
    if (fs::exists(fs::symlink_status(group.place, code))) fs::rename(group.place, replaced, code);
    fs::rename(placeIn(group), group.place, code);
    if (!code) return {};
    ProgressFn none;
    ByteProgress quiet(none, 0);
    if (isThere(group, quiet).value_or(false)) return {};
    return fail(ErrorCode::output, pathText(group.place) + ": could not be written: " + code.message());
  }

  fs::path session_, folder_ = extractionFolder() / (kUnfinished + uniqueSuffix());
  std::vector<Group *> groups_;
  ByteProgress &progress_;
  std::map<std::string, std::string> hashes_;                ///< by member
  std::map<const ReferencedFile *, std::uint64_t> written_;  ///< bytes
};

/// Whether a program uses the folder. Locks that ended programs have left are removed.
bool isUsed(const fs::path &folder) {
  const std::string begin = pathText(folder.filename()) + ".";
  std::error_code code;
  for (fs::directory_iterator at(folder.parent_path(), code), end; !code && at != end; at.increment(code)) {
    const std::string name = pathText(at->path().filename());
    if (!name.starts_with(begin) || !name.ends_with(kUseLock)) continue;
    if (!FileLock::take(at->path(), "")) return true;
    std::error_code ignored;
    fs::remove(at->path(), ignored);
  }
  return false;
}

}  // namespace

fs::path archiveOf(const fs::path &extracted) {
  std::error_code code;
  const fs::path folder = canonicalPath(extractionFolder(), code);
  const fs::path relative = relativePath(canonicalPath(extracted, code), folder);
  if (relative.empty() || *relative.begin() == "..") return {};
  auto in = openInputFile(archiveFile(folder / *relative.begin()));
  if (!in) return {};
  return pathFromText(std::string(std::istreambuf_iterator<char>(*in), {}));
}

Expected<void> extractAgain(const fs::path &archive, std::vector<FoundFile *> files, const ProgressFn &progress) {
  const auto open = openArchive(archive);
  if (!open) return tl::unexpected(open.error());
  const auto saved = readSession((*open)->stream(), pathText(archive), EmbeddedContent::stays);
  if (!saved) return tl::unexpected(saved.error());
  std::vector<FoundFile> embedded;
  for (const ReferencedFile &file : saved->files)
    if (file.isEmbedded) embedded.push_back({file, {}, FoundFile::State::same, nullptr});
  if (auto extracted = extractEmbedded(archive, embedded, progress); !extracted) return extracted;
  for (FoundFile *file : files)
    for (const FoundFile &one : embedded)
      if (file->state != FoundFile::State::same && one.file.sha256 == file->file.sha256)
        *file = {file->file, one.at, FoundFile::State::same, one.use};
  return {};
}

fs::path extractionFolder() { return userCacheDirectory() / "embedded"; }

bool isExtracted(const fs::path &file) {
  std::error_code code;
  const fs::path folder = canonicalPath(extractionFolder(), code);
  const fs::path relative = relativePath(canonicalPath(file, code), folder);
  return !relative.empty() && *relative.begin() != ".." && relative != ".";
}

void removeUnusedExtractions(fs::file_time_type now) {
  std::error_code code;
  std::vector<fs::path> old;
  for (fs::directory_iterator at(extractionFolder(), code), end; !code && at != end; at.increment(code)) {
    std::error_code ignored;
    if (!at->is_directory(ignored)) continue;
    const auto used = fs::last_write_time(at->path(), ignored);
    const bool isUnfinished = pathText(at->path().filename()).starts_with(kUnfinished);
    if (!ignored && now - used > (isUnfinished ? kExtractsAtMost : kKeptFor)) old.push_back(at->path());
  }
  for (const fs::path &folder : old) {
    if (isUsed(folder)) continue;
    fs::remove_all(folder, code);
    fs::remove(archiveFile(folder), code);
  }
}

Expected<void> extractEmbedded(const fs::path &session, std::vector<FoundFile> &files, const ProgressFn &progress) {
  auto groups = groupsOf(files);
  if (!groups) return fail(groups.error().code, pathText(session) + ": " + groups.error().message);
  if (groups->empty()) return {};
  removeUnusedExtractions();
  std::error_code code;
  fs::create_directories(extractionFolder(), code);
  if (code) return fail(ErrorCode::output, pathText(extractionFolder()) + ": cannot be created: " + code.message());
  std::uint64_t total = 0;
  for (const FoundFile &one : files) total += one.file.isEmbedded ? one.file.bytes : 0;
  ByteProgress checked(progress, total);
  std::vector<Group *> lacking;
  for (Group &group : *groups) {
    auto use = ExtractionUse::begin(group.place);
    if (!use) return tl::unexpected(use.error());
    group.use = std::move(*use);
    const auto there = isThere(group, checked);
    if (!there) return tl::unexpected(there.error());
    if (!*there) lacking.push_back(&group);
  }
  if (!lacking.empty()) {
    std::uint64_t bytes = 0;
    for (const Group *group : lacking)
      for (const FoundFile *one : group->files) bytes += one->file.bytes;
    ByteProgress extracted(progress, bytes, "Extracting");
    if (auto done = Extractor(session, lacking, extracted).extract(); !done) return done;
  }
  const std::string archive = pathText(normalPath(absolutePath(session, code)));
  for (const Group &group : *groups) {
    group.use->renew();
    // Without it, only a session that is opened again would find the files.
    if (auto noted = writeWholeFile(archiveFile(group.place), archive); !noted) return noted;
    for (FoundFile *one : group.files) {
      one->at = group.place / pathFromText(nameInGroup(one->file));
      one->state = FoundFile::State::same;
      one->use = group.use;
    }
  }
  return {};
}

namespace {

/// Files of the buffers of a glTF mesh.
Expected<std::vector<fs::path>> buffersOf(const fs::path &mesh) {
  auto in = openInputFile(mesh);
  if (!in) return tl::unexpected(in.error());
  const nlohmann::json json = nlohmann::json::parse(*in, nullptr, false);
  std::vector<fs::path> files;
  if (!json.is_object() || !json.contains("buffers") || !json["buffers"].is_array()) return files;
  for (const nlohmann::json &buffer : json["buffers"]) {
    if (!buffer.is_object() || !buffer.contains("uri") || !buffer["uri"].is_string()) continue;
    const auto uri = buffer["uri"].get<std::string>();
    if (uri.starts_with("data:")) continue;
    const fs::path file = namedFile(mesh.parent_path(), uri);
    std::error_code code;
    if (!fs::is_regular_file(file, code))
      return fail(ErrorCode::input, fmt::format("{}: names the file {}, which cannot be embedded; accepted: GLB, or a "
                                                "file beside it without % in its name",
                                                pathText(mesh), displayMessage(uri)));
    files.push_back(file);
  }
  return files;
}

}  // namespace

Expected<std::vector<fs::path>> filesBelongingTo(const fs::path &file, const ProgressFn &progress) {
  return file.extension() == ".gltf" ? buffersOf(file) : imaging::companionFiles(file, progress);
}

}  // namespace c3de::session
