// SPDX-License-Identifier: Apache-2.0
#include <windows.h>

#include <fcntl.h>
#include <io.h>
#include <shellapi.h>
#include <shlobj.h>
#include <sys/stat.h>

#include <chrono>
#include <clocale>
#include <cstdio>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include "c3de/core/embedding.h"
#include "c3de/core/guarded_memory.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/program_arguments.h"
#include "descriptors.h"
#include "open_file.h"
#include "plugin_call_environment.h"
#include "process_output.h"

namespace c3de {
namespace {

std::string utf8(const std::wstring &wide) {
  const int n =
      WideCharToMultiByte(CP_UTF8, 0, wide.data(), static_cast<int>(wide.size()), nullptr, 0, nullptr, nullptr);
  std::string text(static_cast<std::size_t>(n), '\0');
  WideCharToMultiByte(CP_UTF8, 0, wide.data(), static_cast<int>(wide.size()), text.data(), n, nullptr, nullptr);
  return text;
}

std::wstring wide(const std::string &text) {
  const int n = MultiByteToWideChar(CP_UTF8, 0, text.data(), static_cast<int>(text.size()), nullptr, 0);
  std::wstring out(static_cast<std::size_t>(n), L'\0');
  MultiByteToWideChar(CP_UTF8, 0, text.data(), static_cast<int>(text.size()), out.data(), n);
  return out;
}

std::string lastErrorText() {
  const DWORD code = GetLastError();
  wchar_t *buffer = nullptr;
  const DWORD n =
      FormatMessageW(FORMAT_MESSAGE_ALLOCATE_BUFFER | FORMAT_MESSAGE_FROM_SYSTEM | FORMAT_MESSAGE_IGNORE_INSERTS,
                     nullptr, code, 0, reinterpret_cast<wchar_t *>(&buffer), 0, nullptr);
  std::string text = n ? utf8(std::wstring(buffer, n)) : "error";
  LocalFree(buffer);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text + " (" + std::to_string(code) + ")";
}

std::filesystem::path knownFolder(const KNOWNFOLDERID &id) {
  wchar_t *path = nullptr;
  std::filesystem::path out = ".";
  if (SHGetKnownFolderPath(id, 0, nullptr, &path) == S_OK) out = path;
  CoTaskMemFree(path);
  return out;
}

std::filesystem::path folderOfUser(const KNOWNFOLDERID &id, const char *ofProgram) {
  if (const std::string all = environmentVariable("C3DE_HOME"); !all.empty())
    return std::filesystem::path(wide(all)) / ofProgram;
  return knownFolder(id) / "c3de";
}

/// One command line that CommandLineToArgvW splits back into the arguments.
std::wstring commandLine(const std::vector<std::string> &arguments) {
  std::wstring line;
  for (const std::string &argument : arguments) {
    if (!line.empty()) line += L' ';
    const std::wstring text = wide(argument);
    if (!text.empty() && text.find_first_of(L" \t\n\v\"") == std::wstring::npos) {
      line += text;  // cmd.exe knows its own options without quotes only
      continue;
    }
    line += L'"';
    std::size_t backslashes = 0;
    for (const wchar_t c : text) {
      if (c == L'\\') {
        ++backslashes;
        continue;
      }
      line.append(c == L'"' ? 2 * backslashes + 1 : backslashes, L'\\');
      backslashes = 0;
      line += c;
    }
    line.append(2 * backslashes, L'\\');
    line += L'"';
  }
  return line;
}

/// A process and those that it starts.
class ProcessTree {
 public:
  /// @param endsWithThis  this process ends them by its end, whatever the reason
  explicit ProcessTree(bool endsWithThis) : job_(CreateJobObjectW(nullptr, nullptr)) {
    JOBOBJECT_EXTENDED_LIMIT_INFORMATION limits{};
    limits.BasicLimitInformation.LimitFlags = endsWithThis ? JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE : 0;
    if (job_ != nullptr) SetInformationJobObject(job_, JobObjectExtendedLimitInformation, &limits, sizeof limits);
  }
  ~ProcessTree() {
    if (job_ != nullptr) CloseHandle(job_);
  }
  ProcessTree(const ProcessTree &) = delete;
  ProcessTree &operator=(const ProcessTree &) = delete;

  /// @param process  has not run yet. Where it cannot be added, end() ends it alone.
  void add(HANDLE process) { isAdded_ = job_ != nullptr && AssignProcessToJobObject(job_, process); }
  void end(HANDLE process, UINT exitCode) const {
    if (isAdded_)
      TerminateJobObject(job_, exitCode);
    else
      TerminateProcess(process, exitCode);
  }

 private:
  HANDLE job_;
  bool isAdded_ = false;
};

/// Held while this process has handles that a new process inherits: every process that is started inherits all of them, and
/// a file or pipe that another one holds open too can neither be removed nor come to its end.
std::mutex &inheritance() {
  static std::mutex mutex;
  return mutex;
}

/// @param tree  to which the process is added; null: none
Expected<PROCESS_INFORMATION> start(const std::vector<std::string> &arguments, STARTUPINFOW &startup, DWORD flags,
                                    ProcessTree *tree) {
  if (arguments.empty()) return fail(ErrorCode::usage, "no program to run");
  PROCESS_INFORMATION process{};
  std::wstring line = commandLine(arguments);
  if (!CreateProcessW(nullptr, line.data(), nullptr, nullptr, TRUE, flags | (tree != nullptr ? CREATE_SUSPENDED : 0),
                      nullptr, nullptr, &startup, &process))
    return fail(ErrorCode::state, "cannot start " + arguments.front() + ": " + lastErrorText());
  if (tree != nullptr) {
    tree->add(process.hProcess);
    ResumeThread(process.hThread);
  }
  CloseHandle(process.hThread);
  return process;
}

Expected<PROCESS_INFORMATION> spawn(const std::vector<std::string> &arguments, HANDLE out, HANDLE err,
                                    ProcessTree *tree) {
  STARTUPINFOW startup{};
  startup.cb = sizeof startup;
  startup.dwFlags = STARTF_USESTDHANDLES;
  startup.hStdInput = GetStdHandle(STD_INPUT_HANDLE);
  startup.hStdOutput = out;
  startup.hStdError = err;
  return start(arguments, startup, CREATE_NO_WINDOW, tree);
}

void readAll(HANDLE pipe, std::string *text) {
  char buffer[4096];
  for (DWORD n = 0; ReadFile(pipe, buffer, sizeof buffer, &n, nullptr) && n > 0;) appendOutput(*text, {buffer, n});
}

}  // namespace

Expected<DynamicLibrary> DynamicLibrary::open(const std::filesystem::path &path) {
  const UINT mode = SetErrorMode(SEM_FAILCRITICALERRORS);
  DynamicLibrary library;
  library.handle_ =
      LoadLibraryExW(path.c_str(), nullptr, LOAD_LIBRARY_SEARCH_DLL_LOAD_DIR | LOAD_LIBRARY_SEARCH_DEFAULT_DIRS);
  const std::string why = library.handle_ ? "" : lastErrorText();
  SetErrorMode(mode);
  if (!library.handle_) return fail(ErrorCode::plugin, why);
  return library;
}

void *DynamicLibrary::symbol(const char *name) const {
  return handle_ ? reinterpret_cast<void *>(GetProcAddress(static_cast<HMODULE>(handle_), name)) : nullptr;
}

CodeRange DynamicLibrary::codeRange() const {
  if (!handle_) return {};
  const auto *base = static_cast<const char *>(handle_);
  const auto *dos = reinterpret_cast<const IMAGE_DOS_HEADER *>(base);
  const auto *headers = reinterpret_cast<const IMAGE_NT_HEADERS *>(base + dos->e_lfanew);
  return {base, base + headers->OptionalHeader.SizeOfImage};
}

std::filesystem::path executablePath() {
  std::wstring path(32768, L'\0');
  path.resize(GetModuleFileNameW(nullptr, path.data(), static_cast<DWORD>(path.size())));
  return path;
}

std::filesystem::path modulePath() {
  HMODULE module = nullptr;
  constexpr DWORD kFlags = GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
  if (GetModuleHandleExW(kFlags, reinterpret_cast<LPCWSTR>(&modulePath), &module) == 0) return executablePath();
  std::wstring path(32768, L'\0');
  path.resize(GetModuleFileNameW(module, path.data(), static_cast<DWORD>(path.size())));
  return path;
}

ProgramArguments::ProgramArguments(int, char **) {
  int count = 0;
  wchar_t **arguments = CommandLineToArgvW(GetCommandLineW(), &count);
  for (int i = 0; i < count; ++i) texts_.push_back(utf8(arguments[i]));
  LocalFree(arguments);
  for (std::string &text : texts_) pointers_.push_back(text.data());
  pointers_.push_back(nullptr);
}

OwnEnvironment::OwnEnvironment() {
  (void)std::fegetenv(&before_);
  (void)std::fesetenv(FE_DFL_ENV);
}

OwnEnvironment::~OwnEnvironment() { (void)std::fesetenv(&before_); }

std::filesystem::path homeDirectory() { return knownFolder(FOLDERID_Profile); }
std::filesystem::path userDataDirectory() { return folderOfUser(FOLDERID_LocalAppData, "data"); }
std::filesystem::path userConfigDirectory() { return folderOfUser(FOLDERID_RoamingAppData, "config"); }
std::filesystem::path userCacheDirectory() {
  return environmentVariable("C3DE_HOME").empty() ? knownFolder(FOLDERID_LocalAppData) / "c3de" / "cache"
                                                  : folderOfUser(FOLDERID_LocalAppData, "cache");
}
std::vector<std::filesystem::path> fontDirectories() { return {knownFolder(FOLDERID_Fonts)}; }

std::string environmentVariable(const char *name) {
  wchar_t buffer[32767];
  const DWORD n = GetEnvironmentVariableW(wide(name).c_str(), buffer, 32767);
  return n ? utf8(std::wstring(buffer, n)) : "";
}

char pathListSeparator() { return ';'; }
const char *pluginExtension() { return ".dll"; }

std::uint64_t availableMemory() {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  return GlobalMemoryStatusEx(&status) ? status.ullAvailPhys : 0;
}

std::string cpuName() {
  const std::string name = environmentVariable("PROCESSOR_IDENTIFIER");
  return name.empty() ? "unknown" : name;
}

std::FILE *detail::openFile(const std::filesystem::path &path, OpenMode mode) {
  if (mode != OpenMode::createNew) return _wfopen(path.c_str(), mode == OpenMode::replace ? L"wb" : L"ab");
  // Not fopen's "x": older C libraries of Windows ignore it.
  const int descriptor =
      _wopen(path.c_str(), _O_CREAT | _O_EXCL | _O_WRONLY | _O_BINARY | _O_NOINHERIT, _S_IREAD | _S_IWRITE);
  return descriptor == -1 ? nullptr : _fdopen(descriptor, "wb");
}

std::FILE *detail::openUnnamed(const std::filesystem::path &) { return nullptr; }
int detail::nameFile(std::FILE *, const std::filesystem::path &) { return ENOSYS; }

int detail::syncFile(std::FILE *file) {
  if (_commit(_fileno(file)) == 0) return 0;
  return errno == EBADF ? 0 : errno;  // a device
}
void detail::syncFolder(const std::filesystem::path &) {}

double processorTime_s() {
  FILETIME created{}, ended{}, kernel{}, user{};
  if (!GetProcessTimes(GetCurrentProcess(), &created, &ended, &kernel, &user)) return 0.0;
  const auto seconds = [](const FILETIME &time) {
    return 1e-7 * (4294967296.0 * static_cast<double>(time.dwHighDateTime) + static_cast<double>(time.dwLowDateTime));
  };
  return seconds(kernel) + seconds(user);
}

long long processId() { return static_cast<long long>(GetCurrentProcessId()); }

std::string hostName() { return environmentVariable("COMPUTERNAME"); }

bool stderrIsTerminal() { return _isatty(2) != 0; }

int duplicateDescriptor(int descriptor) { return _dup(descriptor); }
void redirectDescriptor(int descriptor, int to) { _dup2(to, descriptor); }
void closeDescriptor(int descriptor) { _close(descriptor); }
int descriptorOf(std::FILE *file) { return _fileno(file); }

void endWithParent() {}

Expected<int> continueAs(const std::vector<std::string> &arguments) {
  STARTUPINFOW startup{};
  startup.cb = sizeof startup;
  ProcessTree tree(true);  // who ends this program ends the other one
  const Expected<PROCESS_INFORMATION> process = start(arguments, startup, 0, &tree);
  if (!process) return tl::unexpected<Error>(process.error());
  WaitForSingleObject(process->hProcess, INFINITE);
  DWORD code = 1;
  GetExitCodeProcess(process->hProcess, &code);
  CloseHandle(process->hProcess);
  return static_cast<int>(code);
}

Expected<ProcessResult> runProcess(const std::vector<std::string> &arguments, double timeout_s) {
  SECURITY_ATTRIBUTES inherit{sizeof(SECURITY_ATTRIBUTES), nullptr, TRUE};
  HANDLE outRead, outWrite, errRead, errWrite;
  std::unique_lock<std::mutex> inherited(inheritance());
  if (!CreatePipe(&outRead, &outWrite, &inherit, 0)) return fail(ErrorCode::state, "no pipe");
  if (!CreatePipe(&errRead, &errWrite, &inherit, 0)) {
    CloseHandle(outRead);
    CloseHandle(outWrite);
    return fail(ErrorCode::state, "no pipe");
  }
  SetHandleInformation(outRead, HANDLE_FLAG_INHERIT, 0);
  SetHandleInformation(errRead, HANDLE_FLAG_INHERIT, 0);
  ProcessTree tree(false);
  const Expected<PROCESS_INFORMATION> process = spawn(arguments, outWrite, errWrite, &tree);
  CloseHandle(outWrite);
  CloseHandle(errWrite);
  inherited.unlock();
  ProcessResult result;
  if (process) {
    std::thread outReader(readAll, outRead, &result.output), errReader(readAll, errRead, &result.errorOutput);
    if (WaitForSingleObject(process->hProcess, static_cast<DWORD>(timeout_s * 1000)) == WAIT_TIMEOUT) {
      result.timedOut = true;
      tree.end(process->hProcess, 124);
    }
    outReader.join();
    errReader.join();
    DWORD code = 0;
    GetExitCodeProcess(process->hProcess, &code);
    result.exitCode = static_cast<int>(code);
    CloseHandle(process->hProcess);
  }
  CloseHandle(outRead);
  CloseHandle(errRead);
  if (!process) return tl::unexpected<Error>(process.error());
  return result;
}

Expected<FileLock> FileLock::take(const std::filesystem::path &file, const std::string &note) {
  // No other process may write while it is open; the system closes it with the process.
  const HANDLE handle = CreateFileW(file.c_str(), GENERIC_READ | GENERIC_WRITE, FILE_SHARE_READ, nullptr, OPEN_ALWAYS,
                                    FILE_ATTRIBUTE_NORMAL, nullptr);
  if (handle == INVALID_HANDLE_VALUE) {
    if (GetLastError() != ERROR_SHARING_VIOLATION)
      return fail(ErrorCode::output, pathText(file) + ": " + lastErrorText());
    const HANDLE held = CreateFileW(file.c_str(), GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE, nullptr,
                                    OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr);
    char text[256] = {};
    DWORD n = 0;
    if (held != INVALID_HANDLE_VALUE) {
      ReadFile(held, text, sizeof text - 1, &n, nullptr);
      CloseHandle(held);
    }
    return fail(ErrorCode::state, std::string(text, n));
  }
  DWORD n = 0;
  SetEndOfFile(handle);
  WriteFile(handle, note.data(), static_cast<DWORD>(note.size()), &n, nullptr);
  return FileLock(reinterpret_cast<std::intptr_t>(handle));
}

FileLock::FileLock(FileLock &&other) noexcept : handle_(std::exchange(other.handle_, -1)) {}

FileLock::~FileLock() {
  if (handle_ != -1) CloseHandle(reinterpret_cast<HANDLE>(handle_));
}

Expected<ChildProcess> ChildProcess::start(const std::vector<std::string> &arguments,
                                           const std::filesystem::path &log) {
  SECURITY_ATTRIBUTES inherit{sizeof(SECURITY_ATTRIBUTES), nullptr, TRUE};
  const std::lock_guard<std::mutex> inherited(inheritance());
  const HANDLE file = CreateFileW(log.c_str(), GENERIC_WRITE, FILE_SHARE_READ, &inherit, CREATE_ALWAYS, 0, nullptr);
  const Expected<PROCESS_INFORMATION> process = spawn(arguments, file, file, nullptr);
  CloseHandle(file);
  if (!process) return tl::unexpected<Error>(process.error());
  ChildProcess child;
  child.id_ = reinterpret_cast<long long>(process->hProcess);
  child.running_ = true;
  return child;
}

ChildProcess::ChildProcess(ChildProcess &&other) noexcept
    : id_(other.id_), exitCode_(other.exitCode_), running_(std::exchange(other.running_, false)) {}

ChildProcess &ChildProcess::operator=(ChildProcess &&other) noexcept {
  if (this != &other) {
    kill();
    id_ = other.id_;
    exitCode_ = other.exitCode_;
    running_ = std::exchange(other.running_, false);
  }
  return *this;
}

ChildProcess::~ChildProcess() { kill(); }

bool ChildProcess::isRunning() {
  if (!running_) return false;
  const HANDLE process = reinterpret_cast<HANDLE>(id_);
  if (WaitForSingleObject(process, 0) == WAIT_OBJECT_0) {
    DWORD code = 0;
    GetExitCodeProcess(process, &code);
    exitCode_ = static_cast<int>(code);
    running_ = false;
    CloseHandle(process);
  }
  return running_;
}

Expected<int> ChildProcess::wait(double timeout_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  while (isRunning()) {
    if (std::chrono::steady_clock::now() > end) return fail(ErrorCode::state, "the program is still running");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return exitCode_;
}

void ChildProcess::kill() {
  if (!isRunning()) return;
  TerminateProcess(reinterpret_cast<HANDLE>(id_), 1);
  (void)wait(2.0);
}

GuardedMemory::GuardedMemory(std::size_t bytes) {
  SYSTEM_INFO system{};
  GetSystemInfo(&system);
  size_ = (bytes + system.dwPageSize - 1) / system.dwPageSize * system.dwPageSize;
  auto *all = static_cast<unsigned char *>(VirtualAlloc(nullptr, size_ + 2 * kGuard, MEM_RESERVE, PAGE_NOACCESS));
  if (all == nullptr) throw std::bad_alloc();
  data_ = all + kGuard;
  if (VirtualAlloc(data_, size_, MEM_COMMIT, PAGE_READWRITE) != nullptr) return;
  VirtualFree(all, 0, MEM_RELEASE);
  throw std::bad_alloc();
}

GuardedMemory::~GuardedMemory() {
  if (data_ != nullptr) VirtualFree(data_ - kGuard, 0, MEM_RELEASE);
}

GuardedMemory::GuardedMemory(GuardedMemory &&other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

GuardedMemory &GuardedMemory::operator=(GuardedMemory &&other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

bool detail::resetThreadLocale() noexcept {
  (void)_configthreadlocale(_DISABLE_PER_THREAD_LOCALE);  // returns whether it was on before
  return false;
}

}  // namespace c3de
