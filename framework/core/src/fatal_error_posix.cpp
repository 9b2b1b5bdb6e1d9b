// SPDX-License-Identifier: Apache-2.0
#include <execinfo.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <utility>

#include "fatal_error.h"

namespace c3de::detail {
namespace {

struct Fatal {
  int signal;
  const char *how;
};
constexpr std::array kFatal{Fatal{SIGSEGV, "SIGSEGV, an invalid memory access or a stack overflow"},
                            Fatal{SIGBUS, "SIGBUS, an invalid access to memory"},
                            Fatal{SIGFPE, "SIGFPE, an integer division by zero"},
                            Fatal{SIGILL, "SIGILL, an illegal instruction"},
                            Fatal{SIGABRT, "SIGABRT, a call of abort() or an uncaught exception"}};

std::array<struct sigaction, kFatal.size()> before;  // signal handlers have no user data argument: static
std::atomic<FatalHandler> handlerOfProcess{nullptr};
std::atomic<bool> isDying{false};

constexpr std::size_t kStackSize = 64 * 1024;
/// Unwinding a corrupted stack may not terminate.
constexpr unsigned kMaxSeconds = 5;

void onSignal(int signal, siginfo_t *info, void *) {
  std::size_t i = 0;
  while (i + 1 < kFatal.size() && kFatal[i].signal != signal) ++i;
  if (!isDying.exchange(true)) {
    alarm(kMaxSeconds);
    std::array<void *, 64> stack{};
    const int depth = backtrace(stack.data(), static_cast<int>(stack.size()));
    if (const FatalHandler handler = handlerOfProcess.load())
      handler(kFatal[i].how, stack.data(), depth > 0 ? static_cast<std::size_t>(depth) : 0);
    alarm(0);
  }
  sigaction(signal, &before[i], nullptr);
  // A fault recurs when this returns; a sent signal does not.
  if (info == nullptr || info->si_code <= 0 || signal == SIGABRT) raise(signal);
}

}  // namespace

void installFatalHandler(FatalHandler handler) {
  if (handlerOfProcess.exchange(handler) != nullptr) return;
  void *loads[1];
  (void)backtrace(loads, 1);  // the first call loads required libraries, which a handler must not do
  struct sigaction action {};
  action.sa_sigaction = &onSignal;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < kFatal.size(); ++i) sigaction(kFatal[i].signal, &action, &before[i]);
}

std::size_t presentStack(const void **out, std::size_t most) noexcept {
  const int depth = backtrace(const_cast<void **>(out), static_cast<int>(most));
  return depth > 0 ? static_cast<std::size_t>(depth) : 0;
}

void endProcess(int exitCode) noexcept {
  for (;;) {
#if defined(SYS_exit_group)
    syscall(SYS_exit_group, exitCode);
#else
    raise(SIGKILL);
#endif
  }
}

HandlerStack::HandlerStack() {
  stack_t present{};
  // Sanitizers install their own.
  if (sigaltstack(nullptr, &present) != 0 || (present.ss_flags & SS_DISABLE) == 0) return;
  memory_ = std::make_unique<unsigned char[]>(kStackSize);
  stack_t stack{};
  stack.ss_sp = memory_.get();
  stack.ss_size = kStackSize;
  if (sigaltstack(&stack, nullptr) != 0) memory_.reset();
}

HandlerStack::~HandlerStack() {
  if (!memory_) return;
  stack_t none{};
  none.ss_flags = SS_DISABLE;
  (void)sigaltstack(&none, nullptr);
}

std::optional<HeldFile> HeldFile::make(const std::filesystem::path &path) {
  for (int attempt = 0; attempt < 8; ++attempt) {
    const int file = open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
    if (file < 0) return {};
    HeldFile held(file);
    struct stat status {};
    if (flock(file, LOCK_EX | LOCK_NB) != 0 || fstat(file, &status) != 0) return {};
    // Another process may have taken it for an abandoned file and removed it before it was locked.
    if (status.st_nlink > 0) return held;
  }
  return {};
}

std::optional<HeldFile> HeldFile::takeOver(const std::filesystem::path &path) {
  const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return {};
  HeldFile held(file);
  if (flock(file, LOCK_EX | LOCK_NB) != 0) return {};
  return held;
}

HeldFile::HeldFile(HeldFile &&other) noexcept : file_(std::exchange(other.file_, -1)) {}

HeldFile::~HeldFile() {
  if (file_ >= 0) close(static_cast<int>(file_));
}

void HeldFile::replace(const char *text, std::size_t size) const noexcept {
  if (ftruncate(static_cast<int>(file_), 0) != 0 || lseek(static_cast<int>(file_), 0, SEEK_SET) != 0) return;
  append(text, size);
}

void HeldFile::append(const char *text, std::size_t size) const noexcept {
  if (write(static_cast<int>(file_), text, size) < 0) return;
}

void writeToErrorStream(const char *text, std::size_t size) noexcept {
  if (write(STDERR_FILENO, text, size) < 0) return;
}

}  // namespace c3de::detail

#if defined(__linux__)
// Plugins resolve these before those of the C library, because the program comes first in symbol lookup. The C
// library's exit() does not call them.
extern "C" {
__attribute__((visibility("default"))) void _exit(int code) {  // NOLINT(bugprone-reserved-identifier): its name
  c3de::detail::onExit("_exit()");
  c3de::detail::endProcess(code);
}
__attribute__((visibility("default"))) void _Exit(
    int code) noexcept {  // NOLINT(bugprone-reserved-identifier): as above
  c3de::detail::onExit("_Exit()");
  c3de::detail::endProcess(code);
}
}
#endif
