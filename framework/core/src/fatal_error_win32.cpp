// SPDX-License-Identifier: Apache-2.0
#include <windows.h>

#include <array>
#include <atomic>
#include <csignal>
#include <utility>

#include "fatal_error.h"

namespace c3de::detail {
namespace {

std::atomic<FatalHandler> handlerOfProcess{nullptr};
std::atomic<bool> isDying{false};
LPTOP_LEVEL_EXCEPTION_FILTER before = nullptr;  // filters have no user data argument: static

/// For the handler when the stack of a thread has overflowed.
constexpr ULONG kStackSize = 64 * 1024;

const char *howOf(DWORD code) {
  switch (code) {
    case EXCEPTION_ACCESS_VIOLATION: return "0xC0000005, an invalid access to memory";
    case EXCEPTION_STACK_OVERFLOW: return "0xC00000FD, a stack overflow";
    case EXCEPTION_INT_DIVIDE_BY_ZERO: return "0xC0000094, an integer division by zero";
    case EXCEPTION_ILLEGAL_INSTRUCTION: return "0xC000001D, an instruction that this processor does not have";
    case 0xE06D7363: return "0xE06D7363, an uncaught exception";
    default: return "an error of the system";
  }
}

void tell(const char *how, const void *first) {
  if (isDying.exchange(true)) return;
  std::array<const void *, 62> stack{};
  std::size_t depth = 0;
  if (first != nullptr) stack[depth++] = first;
  depth +=
      CaptureStackBackTrace(0, static_cast<DWORD>(stack.size() - depth), const_cast<void **>(&stack[depth]), nullptr);
  if (const FatalHandler handler = handlerOfProcess.load()) handler(how, stack.data(), depth);
}

LONG WINAPI onException(EXCEPTION_POINTERS *exception) {
  tell(howOf(exception->ExceptionRecord->ExceptionCode), exception->ExceptionRecord->ExceptionAddress);
  return before != nullptr ? before(exception) : EXCEPTION_CONTINUE_SEARCH;
}

void onAbort(int) { tell("SIGABRT, a call of abort() or an uncaught exception", nullptr); }

HANDLE handleOf(std::intptr_t file) { return reinterpret_cast<HANDLE>(file); }

std::optional<std::intptr_t> openAlone(const std::filesystem::path &path, DWORD disposition) {
  // Others may read, to see that it exists, but not write: this is what locks it.
  const HANDLE file = CreateFileW(path.c_str(), GENERIC_READ | GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_DELETE,
                                  nullptr, disposition, FILE_ATTRIBUTE_NORMAL, nullptr);
  if (file == INVALID_HANDLE_VALUE) return {};
  return reinterpret_cast<std::intptr_t>(file);
}

}  // namespace

void installFatalHandler(FatalHandler handler) {
  if (handlerOfProcess.exchange(handler) != nullptr) return;
  before = SetUnhandledExceptionFilter(&onException);
  std::signal(SIGABRT, &onAbort);
}

std::size_t presentStack(const void **out, std::size_t most) noexcept {
  return CaptureStackBackTrace(0, static_cast<DWORD>(most), const_cast<void **>(out), nullptr);
}

void endProcess(int exitCode) noexcept {
  for (;;) TerminateProcess(GetCurrentProcess(), static_cast<UINT>(exitCode));
}

HandlerStack::HandlerStack() {
  ULONG size = kStackSize;
  (void)SetThreadStackGuarantee(&size);
}

HandlerStack::~HandlerStack() = default;

std::optional<HeldFile> HeldFile::make(const std::filesystem::path &path) {
  const auto file = openAlone(path, CREATE_ALWAYS);
  if (!file) return {};
  return HeldFile(*file);
}

std::optional<HeldFile> HeldFile::takeOver(const std::filesystem::path &path) {
  const auto file = openAlone(path, OPEN_EXISTING);
  if (!file) return {};
  return HeldFile(*file);
}

HeldFile::HeldFile(HeldFile &&other) noexcept : file_(std::exchange(other.file_, -1)) {}

HeldFile::~HeldFile() {
  if (file_ != -1) CloseHandle(handleOf(file_));
}

void HeldFile::replace(const char *text, std::size_t size) const noexcept {
  if (SetFilePointer(handleOf(file_), 0, nullptr, FILE_BEGIN) == INVALID_SET_FILE_POINTER) return;
  if (!SetEndOfFile(handleOf(file_))) return;
  append(text, size);
}

void HeldFile::append(const char *text, std::size_t size) const noexcept {
  DWORD written = 0;
  (void)WriteFile(handleOf(file_), text, static_cast<DWORD>(size), &written, nullptr);
  (void)FlushFileBuffers(handleOf(file_));
}

void writeToErrorStream(const char *text, std::size_t size) noexcept {
  DWORD written = 0;
  (void)WriteFile(GetStdHandle(STD_ERROR_HANDLE), text, static_cast<DWORD>(size), &written, nullptr);
}

}  // namespace c3de::detail
