// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "c3de/core/file_path.h"
#include "c3de/core/path_text.h"
#include "c3de/session/session_file.h"
#include "files/file_hash.h"

namespace c3de::session {
namespace {

namespace fs = std::filesystem;

/// Of a file, or of a folder with a slash at its end.
fs::path nameOf(const ReferencedFile &file) {
  const fs::path path = pathFromText(file.path);
  return path.has_filename() ? path.filename() : path.parent_path().filename();
}

/// Where a file may be, in the order of preference.
std::vector<fs::path> candidates(const ReferencedFile &file, const fs::path &sessionFolder) {
  const fs::path path = pathFromText(file.path);
  std::vector<fs::path> out{sessionFolder / path};
  const fs::path name = nameOf(file);
  if (sessionFolder / name != out.front() && !name.empty()) out.push_back(sessionFolder / name);
  return out;
}

Expected<FoundFile> find(const ReferencedFile &file, const fs::path &sessionFolder, ByteProgress &progress) {
  FoundFile found{file, {}, FoundFile::State::missing, nullptr};
  for (const fs::path &candidate : candidates(file, sessionFolder)) {
    const auto content = contentOf(candidate, file.bytes);
    if (!content) continue;
    bool isSame = content->bytes == file.bytes;
    if (isSame) {
      const auto hash = hashOf(*content, progress);
      if (!hash && hash.error().code == ErrorCode::cancelled) return tl::unexpected(hash.error());
      if (!hash) continue;
      isSame = *hash == file.sha256;
    }
    if (isSame) return FoundFile{file, candidate, FoundFile::State::same, nullptr};
    if (found.at.empty()) found = {file, candidate, FoundFile::State::changed, nullptr};
  }
  return found;
}

/// Searches one folder for several files.
class FolderSearch {
 public:
  FolderSearch(std::vector<FoundFile> &files, const ProgressFn &progress) : files_(files), progress_(progress) {}

  Expected<void> in(const fs::path &folder) {
    name_ = pathText(folder.filename().empty() ? folder.parent_path().filename() : folder.filename());
    if (auto compared = compare(folder, false); !compared) return compared;
    // A recursive iterator would end at the first folder that cannot be read.
    std::vector<fs::path> folders{folder};
    while (!folders.empty() && !isComplete()) {
      const fs::path present = std::move(folders.back());
      folders.pop_back();
      std::error_code code;
      std::vector<fs::path> below;
      for (fs::directory_iterator at(present, code), end; !code && at != end && !isComplete(); at.increment(code)) {
        std::error_code ignored;
        const bool isFile = at->is_regular_file(ignored), isFolder = at->is_directory(ignored);
        if (auto compared = isFile || isFolder ? compare(at->path(), isFile) : report(); !compared) return compared;
        if (isFolder && !at->is_symlink(ignored)) below.push_back(at->path());
      }
      if (code) unread_.push_back(pathText(present) + ": " + code.message());
      folders.insert(folders.end(), below.rbegin(), below.rend());
    }
    return report();
  }
  [[nodiscard]] std::vector<std::string> &unread() { return unread_; }

 private:
  [[nodiscard]] bool isComplete() const {
    return std::all_of(files_.begin(), files_.end(),
                       [](const FoundFile &one) { return one.state == FoundFile::State::same; });
  }
  Expected<void> report() {
    ++seen_;
    if (progress_ && !progress_(-1.0, fmt::format("Searching {}: {} files", name_, seen_)))
      return fail(ErrorCode::cancelled, "cancelled");
    return {};
  }
  /// Files of the right size are compared whatever their names; of folders, those of the right name.
  Expected<void> compare(const fs::path &path, bool isFile) {
    if (auto reported = report(); !reported) return reported;
    std::error_code code;
    const std::uint64_t size = isFile ? fs::file_size(path, code) : 0;
    std::string hash;
    for (FoundFile &one : files_) {
      if (code || one.file.isEmbedded || one.state == FoundFile::State::same) continue;
      const bool hasName = path.filename() == nameOf(one.file);
      if (isFile ? size != one.file.bytes && !hasName : !hasName) continue;
      const auto content = contentOf(path, one.file.bytes);
      if (!content) continue;
      bool isSame = content->bytes == one.file.bytes;
      if (isSame && hash.empty()) {
        auto computed =
            sha256Of(path, [this](double, const std::string &what) { return !progress_ || progress_(-1.0, what); });
        if (!computed && computed.error().code == ErrorCode::cancelled) return tl::unexpected(computed.error());
        if (!computed) continue;
        hash = std::move(*computed);
      }
      isSame = isSame && hash == one.file.sha256;
      if (isSame || (hasName && one.at.empty()))
        one = {one.file, path, isSame ? FoundFile::State::same : FoundFile::State::changed, nullptr};
    }
    return {};
  }

  std::vector<FoundFile> &files_;
  const ProgressFn &progress_;
  std::string name_;
  std::uint64_t seen_ = 0;
  std::vector<std::string> unread_;
};

}  // namespace

Expected<void> searchFolder(const fs::path &folder, std::vector<FoundFile> &files, const ProgressFn &progress,
                            std::vector<std::string> *unread) {
  std::error_code code;
  if (!fs::is_directory(folder, code)) return fail(ErrorCode::input, pathText(folder) + ": there is no such folder");
  FolderSearch search(files, progress);
  auto searched = search.in(folder);
  if (unread != nullptr) unread->insert(unread->end(), search.unread().begin(), search.unread().end());
  return searched;
}

Expected<std::string> sha256Of(const fs::path &path, const ProgressFn &progress) {
  const auto content = contentOf(path);
  if (!content) return tl::unexpected(content.error());
  ByteProgress bytes(progress, content->bytes);
  return hashOf(*content, bytes);
}

std::string referencePath(const fs::path &path, const fs::path &sessionFolder) {
  std::error_code code;
  fs::path absolute = canonicalPath(path, code);
  if (!absolute.has_filename()) absolute = absolute.parent_path();
  const fs::path folder = canonicalPath(sessionFolder.empty() ? "." : sessionFolder, code);
  const fs::path relative = relativePath(absolute, folder);
  return genericPathText(relative.empty() ? absolute : relative);
}

Expected<ReferencedFile> referenceTo(const fs::path &path, const fs::path &sessionFolder, const ProgressFn &progress) {
  const auto content = contentOf(path);
  if (!content) return tl::unexpected(content.error());
  ByteProgress bytes(progress, content->bytes);
  auto hash = hashOf(*content, bytes);
  if (!hash) return tl::unexpected(hash.error());
  return ReferencedFile{referencePath(path, sessionFolder), std::move(*hash), content->bytes, false};
}

Expected<std::vector<FoundFile>> findFiles(const SessionFile &session, const fs::path &sessionFolder,
                                           const ProgressFn &progress) {
  std::uint64_t total = 0;
  for (const ReferencedFile &file : session.files)
    if (!file.isEmbedded) total += file.bytes;
  ByteProgress bytes(progress, total);
  std::vector<FoundFile> out;
  for (const ReferencedFile &file : session.files) {
    if (file.isEmbedded) {
      out.push_back({file, {}, FoundFile::State::same, nullptr});
      continue;
    }
    auto found = find(file, sessionFolder, bytes);
    if (!found) return tl::unexpected(found.error());
    out.push_back(std::move(*found));
  }
  return out;
}

}  // namespace c3de::session
