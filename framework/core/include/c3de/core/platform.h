// SPDX-License-Identifier: Apache-2.0
// The only part of this module that calls POSIX or Win32 (src/platform_posix.cpp, src/platform_win32.cpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de {

/// Address range of a library's code in this process; empty: unknown.
struct CodeRange {
  const void *begin = nullptr, *end = nullptr;
};

/// A shared library in this process. Never unloaded: unloading is not reliable (thread-local destructors, unique
/// symbols).
class DynamicLibrary {
 public:
  /// @param path  absolute; dependencies are searched in its folder
  [[nodiscard]] static Expected<DynamicLibrary> open(const std::filesystem::path &path);
  /// Null if there is no such symbol.
  [[nodiscard]] void *symbol(const char *name) const;
  [[nodiscard]] CodeRange codeRange() const;

 private:
  void *handle_ = nullptr;
};

[[nodiscard]] std::filesystem::path executablePath();
[[nodiscard]] std::filesystem::path homeDirectory();  ///< empty: there is none
/// Per-user folders, created by the code that writes to them: below C3DE_HOME if that is set, otherwise XDG on Linux,
/// AppData on Windows.
[[nodiscard]] std::filesystem::path userDataDirectory();
[[nodiscard]] std::filesystem::path userConfigDirectory();
[[nodiscard]] std::filesystem::path userCacheDirectory();
[[nodiscard]] std::vector<std::filesystem::path> fontDirectories();
[[nodiscard]] std::string environmentVariable(const char *name);  ///< empty when unset
[[nodiscard]] char pathListSeparator();                           ///< ':' or ';'
[[nodiscard]] const char *pluginExtension();                      ///< ".so" or ".dll"
[[nodiscard]] std::string cpuName();
/// Bytes of memory available without swapping; 0: unknown
[[nodiscard]] std::uint64_t availableMemory();
/// Processor time of this process, all threads together, s
[[nodiscard]] double processorTime_s();
[[nodiscard]] long long processId();
[[nodiscard]] std::string hostName();  ///< empty: unknown
[[nodiscard]] bool stderrIsTerminal();

/// Captures the output to the error stream of the process, from any thread, during its lifetime; for libraries that
/// print. No effect if the stream cannot be replaced. One at a time; a second one waits for the first.
class ErrorStreamCapture {
 public:
  ErrorStreamCapture();
  ~ErrorStreamCapture();  ///< restores the stream; the text is lost unless text() was called
  ErrorStreamCapture(const ErrorStreamCapture &) = delete;
  ErrorStreamCapture &operator=(const ErrorStreamCapture &) = delete;
  /// Ends the capture and returns the captured text.
  [[nodiscard]] std::string text();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct ProcessResult {
  int exitCode = -1;  ///< 128 + signal for a killed process
  /// For each stream at least the last kKept bytes: endless output must not fill the memory of this process.
  std::string output, errorOutput;
  bool timedOut = false;

  static constexpr std::size_t kKept = std::size_t{8} << 20;
};
/// Runs a program to its end, or terminates it after timeout_s.
[[nodiscard]] Expected<ProcessResult> runProcess(const std::vector<std::string> &arguments, double timeout_s);

/// From now on this process is killed when its parent ends, for whatever reason. Linux; no effect elsewhere.
void endWithParent();

/// Continues as another program, with the same console, folder and environment; arguments.front() is the program.
/// Returns only the error if it cannot be started; on Windows, which cannot replace a process, also its exit code at
/// its end.
[[nodiscard]] Expected<int> continueAs(const std::vector<std::string> &arguments);

/// A file lock for one process at a time; the system releases it when the process ends, for whatever reason.
class FileLock {
 public:
  /// ErrorCode::state: another process holds it; the message is that process's note. ErrorCode::output: the file cannot
  /// be created.
  /// @param note  one line for processes that find it locked
  [[nodiscard]] static Expected<FileLock> take(const std::filesystem::path &file, const std::string &note);
  FileLock(FileLock &&other) noexcept;
  FileLock &operator=(FileLock &&) = delete;
  ~FileLock();

 private:
  explicit FileLock(std::intptr_t handle) : handle_(handle) {}
  std::intptr_t handle_;
};

/// A child process; terminated by the destructor.
class ChildProcess {
 public:
  /// Output is written to the file `log` (both streams).
  [[nodiscard]] static Expected<ChildProcess> start(const std::vector<std::string> &arguments,
                                                    const std::filesystem::path &log);
  ChildProcess(ChildProcess &&other) noexcept;
  ChildProcess &operator=(ChildProcess &&other) noexcept;
  ~ChildProcess();
  [[nodiscard]] bool isRunning();
  /// The exit code if it ended within timeout_s.
  [[nodiscard]] Expected<int> wait(double timeout_s);
  void kill();

 private:
  ChildProcess() = default;
  long long id_ = 0;
  int exitCode_ = -1;
  bool running_ = false;
};

}  // namespace c3de
