// SPDX-License-Identifier: Apache-2.0
// Errors that terminate the process: signals, and system exceptions on Windows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

namespace c3de::detail {

/// Called on the crashing thread: may only access existing memory, and write to open files.
/// @param how  "SIGSEGV, an invalid access to memory"
/// @param stack  available code addresses, the innermost first
using FatalHandler = void (*)(const char *how, const void *const *stack, std::size_t depth) noexcept;

/// Effective from now on; afterwards the process terminates as it would have otherwise. One handler.
void installFatalHandler(FatalHandler handler);

/// Code addresses of the present stack, the innermost first; returns their number.
[[nodiscard]] std::size_t presentStack(const void **out, std::size_t most) noexcept;

/// Terminates the process immediately: no handler of exit() runs, nothing is flushed.
[[noreturn]] void endProcess(int exitCode) noexcept;

/// Called by the platform where it can intercept a request to terminate the process. Returns unless the request is from
/// plugin code, which is then reported.
/// @param how  "_exit()"
void onExit(const char *how) noexcept;

/// A stack for the handler on the present thread, for overflows of the thread's own stack. Created and released by the
/// thread that uses it.
class HandlerStack {
 public:
  HandlerStack();
  ~HandlerStack();
  HandlerStack(const HandlerStack &) = delete;
  HandlerStack &operator=(const HandlerStack &) = delete;

 private:
  std::unique_ptr<unsigned char[]> memory_;
};

/// A file that is exclusive to one process during its lifetime; the system releases it when the process ends, for
/// whatever reason.
class HeldFile {
 public:
  /// Empty: it cannot be created, or another process holds it.
  [[nodiscard]] static std::optional<HeldFile> make(const std::filesystem::path &path);
  /// The file of a process that has ended; empty: its process is running, or it cannot be read.
  [[nodiscard]] static std::optional<HeldFile> takeOver(const std::filesystem::path &path);
  HeldFile(HeldFile &&other) noexcept;
  HeldFile &operator=(HeldFile &&) = delete;
  ~HeldFile();  ///< closes it; it stays on disk

  /// Replaces the contents of the file by the text. Restrictions as for FatalHandler.
  void replace(const char *text, std::size_t size) const noexcept;
  void append(const char *text, std::size_t size) const noexcept;

 private:
  explicit HeldFile(std::intptr_t file) : file_(file) {}
  std::intptr_t file_;
};

/// Writes to the error stream of the process. Restrictions as for FatalHandler.
void writeToErrorStream(const char *text, std::size_t size) noexcept;

}  // namespace c3de::detail
