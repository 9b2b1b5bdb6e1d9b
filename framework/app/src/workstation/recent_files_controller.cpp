// SPDX-License-Identifier: Apache-2.0
#include "workstation/recent_files_controller.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <system_error>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/file_path.h"
#include "c3de/core/log.h"
#include "c3de/core/platform.h"
#include "c3de/core/thread_priority.h"
#include "c3de/render/png_file.h"
#include "c3de/session/file_kind.h"
#include "c3de/session/resources.h"

namespace c3de::app {
namespace {

namespace fs = std::filesystem;

fs::path listedPath(const fs::path &file) {
  fs::path clean = normalPath(absolutePath(file));
  if (!clean.has_filename() && clean.has_relative_path()) clean = clean.parent_path();  // "scan/"
  return clean;
}

std::int64_t now_s() {
  return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

ui::RecentKind recentKindOf(FileKind kind, const fs::path &file) {
  std::error_code ignored;
  switch (kind) {
    case FileKind::session: return ui::RecentKind::session;
    case FileKind::scene: return ui::RecentKind::scene;
    case FileKind::mesh: return ui::RecentKind::mesh;
    default: return fs::is_directory(file, ignored) ? ui::RecentKind::dicomFolder : ui::RecentKind::scan;
  }
}

/// Reads the pictures, too. Any thread.
std::vector<ui::RecentItem> itemsOf(const ui::RecentFiles &files, std::vector<ui::RecentFile> list) {
  std::vector<ui::RecentItem> items;
  for (ui::RecentFile &file : list) {
    ui::RecentItem item;
    item.isMissing = file.isMissing();
    // An entry whose picture is not there or is damaged is shown without it.
    if (auto picture = render::readPng(files.pictureFile(file)))
      item.picture = std::make_shared<const render::Image>(std::move(*picture));
    item.file = std::move(file);
    items.push_back(std::move(item));
  }
  return items;
}

/// Those that can be opened on this machine. Any thread.
std::vector<ui::ExampleScene> findExamples() {
  std::vector<ui::ExampleScene> examples;
  if (const auto organ = findResource("scenes/first_light.toml"))
    examples.push_back({"organ", "Try the example organ", "An organ of the program that falls on a floor", *organ});
  if (const auto scan = findResource("scenes/living_scan.toml"))
    examples.push_back(
        {"scan", "Try the living scan", "The synthetic scan. The patient stands up: the liver sinks", *scan});
  if (const auto head = findDefaultScene(); head && head->notice.empty())
    examples.push_back({"head", "Try the living head", "A scan of a head whose brain moves in its skull", head->file});
  return examples;
}

}  // namespace

RecentFilesController::RecentFilesController(Parts parts)
    : parts_(std::move(parts)), files_(userDataDirectory() / "recent") {
  thread_ = std::thread([this] { run(); });
}

void RecentFilesController::connect(ui::WindowActions &actions) {
  actions.removeRecent = [this](const ui::RecentFile &file) {
    post([file](ui::RecentFiles &files) { return files.remove(file); });
  };
  actions.clearRecent = [this] { post([](ui::RecentFiles &files) { return files.clear(); }); };
  actions.refreshRecent = [this] { post([](ui::RecentFiles &files) { return files.read(); }); };
  actions.saveSession = [this, save = actions.saveSession](const fs::path &file, const std::function<void()> &saved) {
    save(file, [this, file, saved] {
      onSaved(file);
      if (saved) saved();
    });
  };
}

void RecentFilesController::onRequested(const ui::OpenRequest &request) {
  if (request.files.empty() || request.areLabels) return;
  ui::RecentFile file;
  file.meshUnit = request.meshUnit;
  bool isFirst = true;
  for (const fs::path &one : request.files) {
    const FileKind kind = kindOf(one, &parts_.session.meshFormats());
    if (kind == FileKind::unknown || kind == FileKind::recording) continue;
    file.files.push_back(listedPath(one));
    // A scene names the entry, since it decides what the meshes opened with it become.
    if (std::exchange(isFirst, false) || kind == FileKind::scene) {
      file.kind = recentKindOf(kind, one);
      std::swap(file.files.front(), file.files.back());
    }
  }
  if (file.files.empty()) return;
  // Requests that failed are not waited for.
  if (requested_.size() >= ui::kMaxRecentFiles) requested_.erase(requested_.begin());
  std::erase_if(requested_, [&](const ui::RecentFile &one) { return one.isSameAs(file); });
  requested_.push_back(std::move(file));
}

void RecentFilesController::update() {
  const Shown now = parts_.shown();
  std::vector<fs::path> present;
  for (const fs::path &file : now.others) present.push_back(listedPath(file));
  if (!now.session.empty()) present.push_back(listedPath(now.session));
  const auto isShown = [&present](const ui::RecentFile &file) {
    return std::any_of(file.files.begin(), file.files.end(), [&](const fs::path &one) {
      return std::find(present.begin(), present.end(), one) != present.end();
    });
  };
  for (const ui::RecentFile &file : shown_)
    if (!isShown(file)) storePicture(file);
  std::erase_if(shown_, [&](const ui::RecentFile &file) { return !isShown(file); });
  closingPicture_.reset();

  const auto begin = [this](ui::RecentFile file) {
    file.openedAt_s = now_s();
    std::erase_if(shown_, [&](const ui::RecentFile &one) { return one.isSameAs(file); });
    shown_.push_back(file);
    post([file = std::move(file)](ui::RecentFiles &files) { return files.add(file); });
  };
  for (auto at = requested_.begin(); at != requested_.end();) {
    if (isShown(*at)) {
      begin(std::move(*at));
      at = requested_.erase(at);
    } else {
      ++at;
    }
  }
  if (now.session.empty()) return;
  const ui::RecentFile session{{listedPath(now.session)}, ui::RecentKind::session, {}, 0};
  if (std::none_of(shown_.begin(), shown_.end(), [&](const ui::RecentFile &one) { return one.isSameAs(session); }))
    begin(session);
}

void RecentFilesController::onSaved(const fs::path &file) {
  update();
  const fs::path saved = listedPath(file);
  for (const ui::RecentFile &one : shown_)
    if (one.files.front() == saved) storePicture(one);
}

void RecentFilesController::storePicture(const ui::RecentFile &file) {
  auto picture =
      std::make_shared<std::optional<render::Image>>(closingPicture_ ? closingPicture_ : parts_.window.viewPicture());
  if (!*picture) return;
  post([file, picture](ui::RecentFiles &files) { return files.setPicture(file, **picture); });
}

void RecentFilesController::post(Task task) {
  {
    const std::lock_guard lock(mutex_);
    if (isStopping_) return;
    tasks_.push_back(std::move(task));
  }
  wake_.notify_one();
}

void RecentFilesController::stop() {
  if (!thread_.joinable()) return;
  for (const ui::RecentFile &file : shown_) storePicture(file);
  shown_.clear();
  {
    const std::lock_guard lock(mutex_);
    isStopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void RecentFilesController::report(const Error &problem) {
  if (!reported_.insert(problem.code).second) return;
  log(LogLevel::warn, "recent files: " + problem.message);
  parts_.panels.notify(C3DE_LOG_WARN, "The list of recent files is not complete", problem.message);
}

void RecentFilesController::run() {
  lowerThreadPriority();
  MainQueue &queue = parts_.session.mainQueue();
  queue.post([this, examples = findExamples()] { page_.examples = examples; });
  for (;;) {
    std::deque<Task> tasks;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return isStopping_ || !tasks_.empty(); });
      if (tasks_.empty()) return;
      tasks = std::exchange(tasks_, {});
    }
    Listing listing;
    std::vector<Error> problems;
    for (const Task &task : tasks) {
      try {
        listing = task(files_);
        if (listing.problem) problems.push_back(*listing.problem);
      } catch (const std::exception &error) {
        problems.push_back({ErrorCode::internal, error.what()});
      }
    }
    queue.post([this, items = itemsOf(files_, std::move(listing.files)), problems = std::move(problems)] {
      page_.recent = items;
      for (const Error &problem : problems) report(problem);
    });
  }
}

}  // namespace c3de::app
