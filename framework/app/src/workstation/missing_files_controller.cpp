// SPDX-License-Identifier: Apache-2.0
#include "workstation/missing_files_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "c3de/core/background_jobs.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/ui/file_browser.h"

namespace c3de::app {

MissingFilesController::MissingFilesController(Parts parts) : parts_(std::move(parts)) {
  dialog_.locate = [this](std::size_t row, const std::filesystem::path &path) { locate(row, path); };
  dialog_.useAnyway = [this](std::size_t row) { useAnyway(row); };
  dialog_.search = [this](const std::filesystem::path &folder) { search(folder); };
  dialog_.open = [this] { open(); };
  dialog_.cancel = [this] { cancel(); };
}

bool MissingFilesController::isNeeded(const std::vector<FoundFile> &files) {
  return std::any_of(files.begin(), files.end(),
                     [](const FoundFile &one) { return one.state != FoundFile::State::same; });
}

void MissingFilesController::show(Opened opened) {
  cancel();
  opened_ = std::move(opened);
  candidates_.clear();
  dialog_.rows.clear();
  dialog_.note.clear();
  dialog_.session = displayText(pathText(opened_->file.filename()));
  for (std::size_t i = 0; i < opened_->files.size(); ++i) {
    const FoundFile &one = opened_->files[i];
    if (one.state == FoundFile::State::same) continue;
    candidates_.push_back({i, one.at, {}});
    ui::MissingFiles::Row row;
    const std::filesystem::path path = pathFromText(one.file.path);
    row.name = displayText(pathText(path.has_filename() ? path.filename() : path.parent_path().filename()));
    row.path = displayText(one.file.path);
    row.size = ui::sizeText(one.file.bytes);
    row.why = one.state == FoundFile::State::missing ? "It is missing." : "It has changed since the session was saved.";
    dialog_.rows.push_back(std::move(row));
    updateRow(dialog_.rows.size() - 1);
  }
  dialog_.isShown = true;
}

void MissingFilesController::updateRow(std::size_t index) {
  ui::MissingFiles::Row &row = dialog_.rows[index];
  const Candidate &candidate = candidates_[index];
  const FoundFile &file = opened_->files[candidate.file];
  row.canUseAnyway = !candidate.other.empty();
  row.refusal.clear();
  if (!candidate.otherHash.empty())
    row.refusal = fmt::format("{} has another content. SHA-256:\n{} of this file\n{} in the session",
                              displayText(pathText(candidate.other)), candidate.otherHash, file.file.sha256);
  if (file.state == FoundFile::State::same) row.found = "Found: " + displayText(pathText(file.at));
}

void MissingFilesController::locate(std::size_t row, const std::filesystem::path &path) {
  if (!opened_ || row >= candidates_.size()) return;
  const auto hash = std::make_shared<std::string>();
  run(
      "Checking " + pathText(path.filename()),
      [path, hash](const ProgressFn &progress) -> Expected<void> {
        auto computed = sha256Of(path, progress);
        if (!computed) return tl::unexpected(computed.error());
        *hash = std::move(*computed);
        return {};
      },
      [this, row, path, hash](const Expected<void> &result) {
        if (!result) return;
        Candidate &candidate = candidates_[row];
        FoundFile &file = opened_->files[candidate.file];
        dialog_.rows[row].found.clear();
        const bool isSame = *hash == file.file.sha256;
        file.state = isSame ? FoundFile::State::same : FoundFile::State::missing;
        file.at = isSame ? path : std::filesystem::path();
        candidate.other = isSame ? std::filesystem::path() : path;
        candidate.otherHash = isSame ? std::string() : *hash;
        updateRow(row);
      });
}

void MissingFilesController::useAnyway(std::size_t row) {
  if (!opened_ || row >= candidates_.size() || candidates_[row].other.empty()) return;
  FoundFile &file = opened_->files[candidates_[row].file];
  file.at = candidates_[row].other;
  file.state = FoundFile::State::changed;
  dialog_.rows[row].found = "Used with its other content: " + displayText(pathText(file.at));
}

void MissingFilesController::search(const std::filesystem::path &folder) {
  if (!opened_) return;
  const auto files = std::make_shared<std::vector<FoundFile>>();
  for (std::size_t row = 0; row < candidates_.size(); ++row)
    if (dialog_.rows[row].found.empty()) {
      files->push_back(opened_->files[candidates_[row].file]);
      files->back().state = FoundFile::State::missing;
      files->back().at.clear();
    }
  const auto unread = std::make_shared<std::vector<std::string>>();
  run(
      "Searching " + pathText(folder.filename()),
      [folder, files, unread](const ProgressFn &progress) {
        return searchFolder(folder, *files, progress, unread.get());
      },
      [this, folder, files, unread](const Expected<void> &result) {
        std::size_t found = 0;
        for (std::size_t row = 0, i = 0; row < candidates_.size(); ++row) {
          if (!dialog_.rows[row].found.empty()) continue;
          FoundFile &one = (*files)[i++];
          if (one.state == FoundFile::State::changed && candidates_[row].other.empty()) candidates_[row].other = one.at;
          if (one.state == FoundFile::State::same) {
            opened_->files[candidates_[row].file] = std::move(one);
            ++found;
          }
          updateRow(row);
        }
        dialog_.note = !result && result.error().code == ErrorCode::cancelled ? "The search was stopped. " : "";
        dialog_.note += fmt::format("{} of {} files found in {}.", found, files->size(), displayText(pathText(folder)));
        if (!unread->empty())
          dialog_.note += fmt::format(" {} folder{} could not be read, for example {}.", unread->size(),
                                      unread->size() == 1 ? "" : "s", displayText(unread->front()));
      });
}

void MissingFilesController::run(const std::string &title, std::function<Expected<void>(const ProgressFn &)> job,
                                 std::function<void(const Expected<void> &)> done) {
  if (!dialog_.job.isNull()) parts_.session.jobs().cancel(dialog_.job);
  dialog_.note.clear();
  dialog_.job =
      parts_.session.jobs().submit(kJobOwner, title, std::move(job),
                                   [this, serial = ++serial_, done = std::move(done)](const Expected<void> &result) {
                                     if (serial != serial_) return;
                                     dialog_.job = {};
                                     if (!result && result.error().code != ErrorCode::cancelled)
                                       dialog_.note = displayText(result.error().message);
                                     done(result);
                                   });
}

void MissingFilesController::open() {
  if (!opened_ || !dialog_.isComplete()) return;
  const Opened opened = std::exchange(opened_, nullptr);
  opened->usesChangedFiles = isNeeded(opened->files);
  cancel();
  parts_.open(opened);
}

void MissingFilesController::cancel() {
  ++serial_;
  if (!dialog_.job.isNull()) parts_.session.jobs().cancel(std::exchange(dialog_.job, {}));
  dialog_.isShown = false;
  opened_.reset();
}

}  // namespace c3de::app
