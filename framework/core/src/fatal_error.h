// SPDX-License-Identifier: Apache-2.0
// Errors that end the process: signals, and exceptions of the system on Windows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

namespace c3de::detail {

/// Called on the thread that dies: may only read and write memory that is there, and write to open files.
/// @param how  "SIGSEGV, an invalid access to memory"
/// @param stack  code addresses, the innermost first; what can be had of them
using FatalHandler = void (*)(const char *how, const void *const *stack, std::size_t depth) noexcept;

/// From now on; the process dies after it as it would have without. One handler.
void installFatalHandler(FatalHandler handler);

/// Code addresses of the present stack, the innermost first; how many.
[[nodiscard]] std::size_t presentStack(const void **out, std::size_t most) noexcept;

/// Ends the process at once: no handler of exit() runs, nothing is flushed.
[[noreturn]] void endProcess(int exitCode) noexcept;

/// For the platform, where it can see that somebody asks for the end of the process: returns unless that is code from
/// outside, which is named then.
/// @param how  "_exit()"
void onExit(const char *how) noexcept;

/// A stack for the handler on the present thread, so that one whose own has overflown can be handled. Made and given
/// back by the thread that uses it.
class HandlerStack {
 public:
  HandlerStack();
  ~HandlerStack();
  HandlerStack(const HandlerStack &) = delete;
  HandlerStack &operator=(const HandlerStack &) = delete;

 private:
  std::unique_ptr<unsigned char[]> memory_;
};

/// A file that one process has to itself while it lives; the system lets go of it however the process ends.
class HeldFile {
 public:
  /// Empty: it cannot be made, or somebody else has it.
  [[nodiscard]] static std::optional<HeldFile> make(const std::filesystem::path &path);
  /// Of a process that has gone; empty: its process lives, or it cannot be read.
  [[nodiscard]] static std::optional<HeldFile> takeOver(const std::filesystem::path &path);
  HeldFile(HeldFile &&other) noexcept;
  HeldFile &operator=(HeldFile &&) = delete;
  ~HeldFile();  ///< closes it; it stays on disk

  /// Puts the text into the file in place of what it held. As FatalHandler.
  void replace(const char *text, std::size_t size) const noexcept;
  void append(const char *text, std::size_t size) const noexcept;

 private:
  explicit HeldFile(std::intptr_t file) : file_(file) {}
  std::intptr_t file_;
};

/// To the error stream of the process, as FatalHandler.
void writeToErrorStream(const char *text, std::size_t size) noexcept;

}  // namespace c3de::detail
