// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/crash_journal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <optional>
#include <random>
#include <string_view>
#include <thread>
#include <utility>

#include "c3de/core/embedding.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "fatal_error.h"
#include "plugin_call_site.h"

namespace c3de {
namespace {

constexpr const char *kExtension = ".run";

/// Indexed by Place.
constexpr std::array kPlaces{"program", "call", "thread", "before", "hang"};

struct PluginCode {
  std::atomic<const char *> owner{nullptr};
  CodeRange range;
};

// A signal handler has no user data argument: static.
std::array<PluginCode, 256> pluginCode;
std::atomic<std::size_t> pluginCodeUsed{0};
std::atomic<const detail::HeldFile *> journalOfProcess{nullptr};
std::mutex hangMutex;

const char *ownerOfCode(const void *address) noexcept {
  const std::size_t used = std::min(pluginCodeUsed.load(), pluginCode.size());
  for (std::size_t i = 0; i < used; ++i) {
    const char *owner = pluginCode[i].owner.load(std::memory_order_acquire);
    const CodeRange &range = pluginCode[i].range;
    if (owner != nullptr && address >= range.begin && address < range.end) return owner;
  }
  return nullptr;
}

/// Text that needs no heap, which may be damaged.
class FixedText {
 public:
  FixedText &operator<<(const char *text) noexcept {
    if (text == nullptr) return *this;
    const std::size_t n = std::min(std::strlen(text), text_.size() - size_);
    std::memcpy(text_.data() + size_, text, n);
    size_ += n;
    return *this;
  }
  [[nodiscard]] const char *data() const { return text_.data(); }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::array<char, 2048> text_{};
  std::size_t size_ = 0;
};

const char *nameOf(CrashRecord::Place place) { return kPlaces[static_cast<std::size_t>(place)]; }

/// The code that a stack belongs to.
struct PluginAttribution {
  CrashRecord::Place place = CrashRecord::Place::program;
  const char *owner = nullptr, *what = nullptr;
};

PluginAttribution culpritOf(const void *const *stack, std::size_t depth) noexcept {
  using Place = CrashRecord::Place;
  const detail::PluginCallSite at = detail::pluginCallSiteOfThread();
  const char *owner = nullptr;
  for (std::size_t i = 0; i < depth && owner == nullptr; ++i) owner = ownerOfCode(stack[i]);
  if (at.isInside) return {Place::call, owner != nullptr ? owner : at.owner, at.what};
  if (owner != nullptr) return {Place::thread, owner, nullptr};
  if (at.owner != nullptr) return {Place::before, at.owner, at.what};
  return {};
}

void writeToJournal(const PluginAttribution &culprit, const char *how) noexcept {
  const detail::HeldFile *journal = journalOfProcess.load();
  if (journal == nullptr) return;
  FixedText record;
  record << nameOf(culprit.place) << "\n" << how << "\n" << culprit.owner << "\n" << culprit.what << "\n";
  journal->replace(record.data(), record.size());
}

void onFatalError(const char *how, const void *const *stack, std::size_t depth) noexcept {
  using Place = CrashRecord::Place;
  const PluginAttribution at = culpritOf(stack, depth);
  FixedText told;
  told << "\nc3de: fatal: " << how;
  if (at.place == Place::program) told << ", in the program itself";
  if (at.place == Place::call) told << ", in plugin " << at.owner << " (" << at.what << ")";
  if (at.place == Place::thread) told << ", in plugin " << at.owner << " (on its own thread)";
  if (at.place == Place::before) told << ", in the program itself, after plugin " << at.owner << " (" << at.what << ")";
  // Heap damage is detected by the next allocation, possibly in another plugin.
  const detail::PluginCallSite earlier = detail::previousCallSiteOfThread(at.owner);
  // Before a plugin has stated its id, it is recorded under its file name.
  if (at.place == Place::call && earlier.owner != nullptr &&
      !std::string_view(earlier.owner).ends_with(pluginExtension()))
    told << "; called before it: plugin " << earlier.owner << " (" << earlier.what << ")";
  told << "\n";
  detail::writeToErrorStream(told.data(), told.size());
  writeToJournal(at, how);
}

/// Handlers of exit() and the replacement of _exit() have no user data argument: static.
struct ExitWatch {
  std::atomic<int> code{0};
  std::atomic<long long> process{-1};
  std::atomic<std::thread::id> mainThread{};
} exitWatch;

/// Empty: it contains no record.
std::optional<CrashRecord> read(const std::filesystem::path &path) {
  std::ifstream file(path);
  std::string place;
  CrashRecord record;
  std::getline(file, place);
  std::getline(file, record.how);
  std::getline(file, record.owner);
  std::getline(file, record.what);
  const auto *found = std::find(kPlaces.begin(), kPlaces.end(), place);
  if (found == kPlaces.end()) return {};
  record.place = static_cast<CrashRecord::Place>(found - kPlaces.begin());
  record.how = displayMessage(record.how);
  record.owner = displayMessage(record.owner);
  record.what = displayMessage(record.what);
  return record;
}

}  // namespace

struct CrashJournal::Impl {
  std::filesystem::path path;
  detail::HeldFile file;
};

CrashJournal::CrashJournal(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {
  journalOfProcess = &impl_->file;
  installFatalErrorReport();
}

CrashJournal::CrashJournal(CrashJournal &&) noexcept = default;

CrashJournal::~CrashJournal() {
  if (!impl_) return;
  journalOfProcess = nullptr;
  const std::lock_guard lock(hangMutex);  // no thread writes to it any more
  std::error_code ignored;
  std::filesystem::remove(impl_->path, ignored);
}

Expected<CrashJournal> CrashJournal::begin(const std::filesystem::path &folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::random_device random;
  const auto path = folder / (fmt::format("{:08x}{:08x}", random(), random()) + kExtension);
  auto file = detail::HeldFile::make(path);
  if (!file)
    return fail(ErrorCode::output, pathText(path) +
                                       " cannot be written; what this run dies of will not be known to "
                                       "the next one");
  return CrashJournal(std::make_unique<Impl>(Impl{path, std::move(*file)}));
}

std::vector<CrashRecord> CrashJournal::popCrashRecords(const std::filesystem::path &folder) {
  std::vector<CrashRecord> records;
  std::vector<std::filesystem::path> gone;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() != kExtension) continue;
    const auto held = detail::HeldFile::takeOver(it->path());
    if (!held) continue;
    if (const auto record = read(it->path())) records.push_back(*record);
    gone.push_back(it->path());
  }
  for (const auto &path : gone) std::filesystem::remove(path, error);
  return records;
}

std::string CrashRecord::cause() const {
  switch (place) {
    case Place::program: break;
    case Place::call: return fmt::format("ended by {}, in plugin {} ({})", how, owner, what);
    case Place::thread: return fmt::format("ended by {}, in plugin {} (on its own thread)", how, owner);
    case Place::before:
      return fmt::format("ended by {}, in the program itself, after plugin {} ({})", how, owner, what);
    case Place::hang:
      return fmt::format("was ended from outside while plugin {} ({}) did not return for {}", owner, what, how);
  }
  return fmt::format("ended by {}, in the program itself", how);
}

// Does not log: plugin code may be inside the logger, or in a signal handler.
void detail::onExit(const char *how) noexcept {
  using Place = CrashRecord::Place;
  // A forked child may exit as it likes.
  if (processId() != exitWatch.process.load()) return;
  std::array<const void *, 64> stack{};
  const PluginAttribution at = culpritOf(stack.data(), presentStack(stack.data(), stack.size()));
  const bool isPluginCall = at.place == Place::call || at.place == Place::thread;
  if (!isPluginCall && std::this_thread::get_id() == exitWatch.mainThread.load()) return;
  FixedText told;
  told << "c3de: error: ";
  if (isPluginCall)
    told << "plugin " << at.owner;
  else
    told << "a thread that is not the program's";
  told << " has ended the program, by " << how;
  if (at.place == Place::call) told << " within " << at.what;
  if (at.place == Place::thread) told << " on a thread of its own";
  told << "; results that were not written are lost\n";
  writeToErrorStream(told.data(), told.size());
  writeToJournal(isPluginCall ? at : PluginAttribution{}, how);
  endProcess(exitWatch.code.load());
}

void reportPluginExits(int code) {
  if (isEmbedded()) return;
  exitWatch.code = code;
  exitWatch.process = processId();
  exitWatch.mainThread = std::this_thread::get_id();
  std::array<const void *, 1> loads{};
  (void)detail::presentStack(loads.data(), loads.size());  // the first call loads required libraries
  static const bool isRegistered = [] {
#if !defined(__MINGW32__)  // it has no quick_exit
    (void)std::at_quick_exit([] { detail::onExit("quick_exit()"); });
#endif
    return std::atexit([] { detail::onExit("exit()"); }) == 0;
  }();
  (void)isRegistered;
}

void installFatalErrorReport() { detail::installFatalHandler(&onFatalError); }

void notePluginCode(const char *owner, const CodeRange &range) {
  if (range.begin == nullptr) return;
  for (std::size_t i = 0; i < std::min(pluginCodeUsed.load(), pluginCode.size()); ++i)
    if (pluginCode[i].range.begin == range.begin) return pluginCode[i].owner.store(owner);
  const std::size_t i = pluginCodeUsed.fetch_add(1);
  if (i >= pluginCode.size()) return;
  pluginCode[i].range = range;
  pluginCode[i].owner.store(owner, std::memory_order_release);
}

void noteHang(const LongCall &call) {
  const std::lock_guard lock(hangMutex);
  const detail::HeldFile *journal = journalOfProcess.load();
  if (journal == nullptr) return;
  std::string record;
  if (!call.isOver)
    record =
        fmt::format("{}\n{:.0f} s\n{}\n{}\n", nameOf(CrashRecord::Place::hang), call.seconds, call.owner, call.what);
  journal->replace(record.data(), record.size());
}

}  // namespace c3de
