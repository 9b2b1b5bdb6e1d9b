// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/output_file.h"
#include "c3de/core/file_path.h"

#include <cerrno>
#include <string>
#include <system_error>
#include <vector>

#include "open_file.h"

namespace c3de {
namespace {

namespace fs = std::filesystem;
using detail::FilePointer;
using detail::openFile;
using detail::OpenMode;

constexpr int kMaxLinks = 40;   // same limit as the system
constexpr int kMaxNames = 100;  // left behind by killed runs

std::string textOf(const fs::path &path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

/// The file that writing to `path` changes: links are followed, also to a file that does not exist yet.
fs::path targetOf(fs::path path) {
  std::error_code code;
  for (int i = 0; i < kMaxLinks && fs::is_symlink(fs::symlink_status(path, code)); ++i) {
    const fs::path link = fs::read_symlink(path, code);
    if (code) break;
    path = isAbsolutePath(link) ? link : path.parent_path() / link;
  }
  return path;
}

fs::path folderOf(const fs::path &path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

/// The i-th candidate name in the target's folder.
fs::path temporaryName(fs::path target, int i) {
  target += i == 1 ? std::string(".part") : "." + std::to_string(i) + ".part";
  return target;
}

/// @param error  errno
tl::unexpected<Error> failed(const fs::path &path, int error) {
  const std::string name = textOf(path);
  std::error_code code;
  if (fs::is_directory(path, code)) return fail(ErrorCode::output, name + ": is a folder; accepted: a file name");
  const fs::path folder = folderOf(path);
  if (error == ENOENT && !fs::is_directory(folder, code))
    return fail(ErrorCode::output, name + ": cannot be written: there is no folder " + textOf(folder));
  return fail(ErrorCode::output,
              name + ": could not be written: " +
                  (error != 0 ? std::generic_category().message(error) : "the system gave no reason"));
}

/// Closes the file; returns the first error of writing and closing, or 0.
int closed(FilePointer &file, int error) {
  if (error == 0 && std::fflush(file.get()) != 0) error = errno;
  errno = 0;
  if (std::fclose(file.release()) != 0 && error == 0) error = errno != 0 ? errno : EIO;
  return error;
}

}  // namespace

Expected<OutputFile> OutputFile::open(const fs::path &path, Durability durability) {
  OutputFile out;
  out.durability_ = durability;
  out.path_ = path;
  out.target_ = targetOf(path);
  std::error_code code;
  const fs::file_status status = fs::status(out.target_, code);
  if (fs::is_directory(status)) return failed(path, EISDIR);
  int error = 0;
  if (!fs::exists(status) || fs::is_regular_file(status)) {
    out.file_.reset(detail::openUnnamed(folderOf(out.target_)));
    if (out.file_) {
      out.unnamed_ = true;
      return out;
    }
    for (int i = 1; i <= kMaxNames && !out.file_; ++i) {
      out.temporary_ = temporaryName(out.target_, i);
      errno = 0;
      out.file_.reset(openFile(out.temporary_, OpenMode::createNew));
      error = errno;
      if (!out.file_ && error != EEXIST) break;
    }
    if (out.file_) return out;
    out.temporary_.clear();
    if (durability == Durability::strict || !fs::exists(status) ||
        (error != EACCES && error != EPERM && error != EROFS))
      return failed(path, error);
  }
  errno = 0;
  out.file_.reset(openFile(out.target_, OpenMode::replace));
  if (!out.file_) return failed(path, errno);
  return out;
}

OutputFile::~OutputFile() { discard(); }

void OutputFile::discard() {
  if (!file_) return;
  file_.reset();
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void OutputFile::write(std::string_view bytes) {
  if (error_ != 0 || bytes.empty()) return;
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) error_ = errno != 0 ? errno : EIO;
}

int OutputFile::giveName() {
  int error = EEXIST;
  for (int i = 1; i <= kMaxNames && error == EEXIST; ++i) {
    temporary_ = temporaryName(target_, i);
    error = detail::nameFile(file_.get(), temporary_);
  }
  if (error != 0) temporary_.clear();
  return error;
}

Expected<void> OutputFile::commit() {
  const bool isStrict = durability_ == Durability::strict;
  if (unnamed_ || isStrict) {
    if (error_ == 0 && std::fflush(file_.get()) != 0) error_ = errno;
    if (error_ == 0 && isStrict) error_ = detail::syncFile(file_.get());
  }
  if (unnamed_) {
    if (error_ == 0) error_ = giveName();
    if (error_ != 0) {
      file_.reset();
      return failed(path_, error_);
    }
  }
  const int error = closed(file_, error_);
  std::error_code code, ignored;
  if (temporary_.empty()) return error == 0 ? Expected<void>{} : failed(path_, error);
  if (error == 0) {
    // The replacement gets the permissions of the replaced file.
    if (fs::exists(target_, ignored)) fs::permissions(temporary_, fs::status(target_, ignored).permissions(), ignored);
    fs::rename(temporary_, target_, code);
    if (!code && isStrict) detail::syncFolder(folderOf(target_));
    if (!code) return {};
  }
  fs::remove(temporary_, ignored);
  return failed(path_, error != 0 ? error : code.default_error_condition().value());
}

Expected<void> writeWholeFile(const fs::path &path, std::string_view bytes, Durability durability) {
  auto file = OutputFile::open(path, durability);
  if (!file) return tl::unexpected(file.error());
  file->write(bytes);
  return file->commit();
}

Expected<OutputRows> OutputRows::open(const fs::path &path) {
  OutputRows rows;
  rows.path_ = path;
  rows.target_ = targetOf(path);
  errno = 0;
  rows.file_.reset(openFile(rows.target_, OpenMode::replace));
  if (!rows.file_) return failed(path, errno);
  // Each row is passed to the system in one piece.
  std::setvbuf(rows.file_.get(), nullptr, _IONBF, 0);
  return rows;
}

Expected<void> OutputRows::add(std::string_view row) {
  if (!file_) return fail(ErrorCode::state, textOf(path_) + ": is closed");
  errno = 0;
  if (std::fwrite(row.data(), 1, row.size(), file_.get()) == row.size()) {
    bytes_ += row.size();
    return {};
  }
  const int error = errno;
  (void)closed(file_, error);
  std::error_code code;
  if (fs::is_regular_file(target_, code)) fs::resize_file(target_, bytes_, code);
  return failed(path_, error);
}

Expected<void> OutputRows::close() {
  if (!file_) return {};
  const int error = closed(file_, 0);
  return error == 0 ? Expected<void>{} : failed(path_, error);
}

namespace {

bool liesIn(const fs::path &file, const fs::path &folder) {
  std::error_code code;
  for (fs::path at = canonicalPath(file, code).parent_path(); !code && !at.empty(); at = at.parent_path()) {
    if (fs::equivalent(at, folder, code)) return true;
    if (at == at.parent_path()) break;
  }
  return false;
}

/// Creates files temporarily to examine what their names denote.
class TriedFiles {
 public:
  TriedFiles() = default;
  TriedFiles(const TriedFiles &) = delete;
  TriedFiles &operator=(const TriedFiles &) = delete;
  ~TriedFiles() {
    std::error_code ignored;
    for (const fs::path &file : made_) fs::remove(file, ignored);
  }
  Expected<void> open(const fs::path &path) {
    const fs::path target = targetOf(path);
    std::error_code code;
    const fs::file_status status = fs::status(target, code);
    if (fs::is_directory(status)) return failed(path, EISDIR);
    if (fs::exists(status) && !fs::is_regular_file(status)) return {};  // opening a pipe would wait for its reader
    errno = 0;
    const FilePointer file(openFile(target, OpenMode::append));
    if (!file) return failed(path, errno);
    if (!fs::exists(status)) made_.push_back(target);
    return {};
  }
  [[nodiscard]] bool isNew(const fs::path &path) const {
    for (const fs::path &file : made_)
      if (file == targetOf(path)) return true;
    return false;
  }

 private:
  std::vector<fs::path> made_;
};

}  // namespace

Expected<void> checkOutputs(std::span<const fs::path> outputs, std::span<const fs::path> inputs) {
  TriedFiles tried;
  std::error_code code;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    if (const auto opened = tried.open(outputs[i]); !opened) return opened;
    // Devices accept the output of several files.
    if (!fs::is_regular_file(targetOf(outputs[i]), code)) continue;
    for (std::size_t j = 0; j < i; ++j)
      if (!outputs[j].empty() && fs::equivalent(outputs[i], outputs[j], code))
        return fail(ErrorCode::usage,
                    textOf(outputs[i]) + ": is named for two outputs" +
                        (outputs[i] == outputs[j] ? "" : ", the other time as " + textOf(outputs[j])) +
                        "; accepted: a file for each");
    for (const fs::path &input : inputs) {
      if (input.empty()) continue;
      const bool isFolder = fs::is_directory(input, code);
      if (isFolder ? !tried.isNew(outputs[i]) && liesIn(outputs[i], input) : fs::equivalent(outputs[i], input, code))
        return fail(ErrorCode::usage, textOf(outputs[i]) + ": is read by this run" +
                                          (isFolder              ? " (in the folder " + textOf(input) + ")"
                                           : outputs[i] == input ? std::string()
                                                                 : " (as " + textOf(input) + ")") +
                                          " and would be lost; accepted: another file");
    }
  }
  return {};
}

}  // namespace c3de
