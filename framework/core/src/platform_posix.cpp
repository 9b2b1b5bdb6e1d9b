// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <locale.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <new>
#include <thread>
#include <utility>

#include "c3de/core/embedding.h"
#include "c3de/core/guarded_memory.h"
#include "c3de/core/platform.h"
#include "c3de/core/program_arguments.h"
#include "descriptors.h"
#include "open_file.h"
#include "plugin_call_environment.h"
#include "process_output.h"

extern char **environ;

namespace c3de {
namespace {

using Clock = std::chrono::steady_clock;

std::filesystem::path homeBased(const char *variable, const char *fallback, const char *ofProgram) {
  if (const std::string all = environmentVariable("C3DE_HOME"); !all.empty())
    return std::filesystem::path(all) / ofProgram;
  if (const std::string set = environmentVariable(variable); !set.empty()) return std::filesystem::path(set) / "c3de";
  const std::string home = environmentVariable("HOME");
  return std::filesystem::path(home.empty() ? "." : home) / fallback / "c3de";
}

int exitCodeOf(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

Expected<pid_t> spawn(const std::vector<std::string> &arguments, posix_spawn_file_actions_t *actions) {
  if (arguments.empty()) return fail(ErrorCode::usage, "no program to run");
  std::vector<char *> argv;
  for (const std::string &argument : arguments) argv.push_back(const_cast<char *>(argument.c_str()));
  argv.push_back(nullptr);
  // A parent may leave SIGCHLD ignored; exit codes of child processes would then be lost, and waiting would fail.
  struct sigaction present {};
  if (sigaction(SIGCHLD, nullptr, &present) == 0 && present.sa_handler == SIG_IGN) signal(SIGCHLD, SIG_DFL);
  pid_t pid = 0;
  const int error = posix_spawnp(&pid, argv[0], actions, nullptr, argv.data(), environ);
  if (error != 0) return fail(ErrorCode::state, "cannot start " + arguments.front() + ": " + std::strerror(error));
  return pid;
}

}  // namespace

Expected<DynamicLibrary> DynamicLibrary::open(const std::filesystem::path &path) {
  DynamicLibrary library;
  library.handle_ = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library.handle_) {
    const char *why = dlerror();
    return fail(ErrorCode::plugin, why ? why : "unknown reason");
  }
  return library;
}

void *DynamicLibrary::symbol(const char *name) const { return handle_ ? dlsym(handle_, name) : nullptr; }

CodeRange DynamicLibrary::codeRange() const {
  link_map *map = nullptr;
  if (!handle_ || dlinfo(handle_, RTLD_DI_LINKMAP, &map) != 0 || map == nullptr) return {};
  struct Search {
    ElfW(Addr) base;
    CodeRange found;
  } search{map->l_addr, {}};
  dl_iterate_phdr(
      [](dl_phdr_info *info, std::size_t, void *data) {
        auto *wanted = static_cast<Search *>(data);
        if (info->dlpi_addr != wanted->base) return 0;
        for (int i = 0; i < info->dlpi_phnum; ++i) {
          const auto &header = info->dlpi_phdr[i];
          if (header.p_type != PT_LOAD || (header.p_flags & PF_X) == 0) continue;
          const auto *begin = reinterpret_cast<const char *>(info->dlpi_addr + header.p_vaddr);
          wanted->found = {begin, begin + header.p_memsz};
        }
        return 1;
      },
      &search);
  return search.found;
}

std::filesystem::path executablePath() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error);
}

std::filesystem::path modulePath() {
  // Asked once: a relative name holds only for the folder in which the library was loaded.
  static const std::filesystem::path path = [] {
    Dl_info info{};
    link_map *map = nullptr;
    // The program itself has an empty name there.
    if (dladdr1(reinterpret_cast<const void *>(&modulePath), &info, reinterpret_cast<void **>(&map), RTLD_DL_LINKMAP) ==
            0 ||
        map == nullptr || map->l_name == nullptr || *map->l_name == '\0')
      return executablePath();
    std::error_code error;
    std::filesystem::path found = std::filesystem::canonical(map->l_name, error);
    return error ? executablePath() : found;
  }();
  return path;
}

ProgramArguments::ProgramArguments(int argc, char **argv) : pointers_(argv, argv + argc) {
  pointers_.push_back(nullptr);
}

OwnEnvironment::OwnEnvironment() {
  static const locale_t c = newlocale(LC_ALL_MASK, "C", static_cast<locale_t>(nullptr));  // as long as the process
  (void)std::fegetenv(&before_);
  (void)std::fesetenv(FE_DFL_ENV);
  if (c != static_cast<locale_t>(nullptr)) locale_ = uselocale(c);
}

OwnEnvironment::~OwnEnvironment() {
  if (locale_ != nullptr) (void)uselocale(static_cast<locale_t>(locale_));
  (void)std::fesetenv(&before_);
}

std::filesystem::path homeDirectory() { return environmentVariable("HOME"); }
std::filesystem::path userDataDirectory() { return homeBased("XDG_DATA_HOME", ".local/share", "data"); }
std::filesystem::path userConfigDirectory() { return homeBased("XDG_CONFIG_HOME", ".config", "config"); }
std::filesystem::path userCacheDirectory() { return homeBased("XDG_CACHE_HOME", ".cache", "cache"); }

std::vector<std::filesystem::path> fontDirectories() {
  return {"/usr/share/fonts/truetype/dejavu", "/usr/share/fonts/truetype", "/usr/share/fonts",
          std::filesystem::path(environmentVariable("HOME")) / ".local/share/fonts",
          // Of the archive, for systems without fonts.
          executablePath().parent_path() / ".." / "share" / "c3de" / "fonts"};
}

std::string environmentVariable(const char *name) {
  const char *value = std::getenv(name);
  return value ? value : "";
}

char pathListSeparator() { return ':'; }
const char *pluginExtension() { return ".so"; }

std::uint64_t availableMemory() {
  std::ifstream file("/proc/meminfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("MemAvailable:")) return std::strtoull(line.c_str() + 13, nullptr, 10) * 1024;
  return 0;
}

std::string cpuName() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("model name", 0) == 0)
      if (const auto colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
  return "unknown";
}

std::FILE *detail::openFile(const std::filesystem::path &path, OpenMode mode) {
  return std::fopen(path.c_str(), mode == OpenMode::replace ? "wb" : mode == OpenMode::createNew ? "wbx" : "ab");
}

#ifdef O_TMPFILE
std::FILE *detail::openUnnamed(const std::filesystem::path &folder) {
  const int descriptor = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (descriptor < 0) return nullptr;
  // Gets its name through /proc.
  const std::string name = "/proc/self/fd/" + std::to_string(descriptor);
  std::FILE *file = access(name.c_str(), F_OK) == 0 ? fdopen(descriptor, "wb") : nullptr;
  if (file == nullptr) close(descriptor);
  return file;
}

int detail::nameFile(std::FILE *file, const std::filesystem::path &path) {
  const std::string name = "/proc/self/fd/" + std::to_string(fileno(file));
  return linkat(AT_FDCWD, name.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0 ? 0 : errno;
}
#else
std::FILE *detail::openUnnamed(const std::filesystem::path &) { return nullptr; }
int detail::nameFile(std::FILE *, const std::filesystem::path &) { return ENOSYS; }
#endif

int detail::syncFile(std::FILE *file) {
  // EINVAL: a device or a pipe.
  return fsync(fileno(file)) == 0 || errno == EINVAL || errno == ENOTSUP ? 0 : errno;
}

void detail::syncFolder(const std::filesystem::path &folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

double processorTime_s() {
  timespec time{};
  if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time) != 0) return 0.0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

long long processId() { return getpid(); }

std::string hostName() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

bool stderrIsTerminal() { return isatty(STDERR_FILENO) == 1; }

int duplicateDescriptor(int descriptor) { return dup(descriptor); }
void redirectDescriptor(int descriptor, int to) { dup2(to, descriptor); }
void closeDescriptor(int descriptor) { close(descriptor); }
int descriptorOf(std::FILE *file) { return fileno(file); }

#ifdef __linux__
void endWithParent() { prctl(PR_SET_PDEATHSIG, SIGKILL); }
#else
void endWithParent() {}
#endif

Expected<int> continueAs(const std::vector<std::string> &arguments) {
  if (arguments.empty()) return fail(ErrorCode::usage, "no program to run");
  std::vector<char *> words;
  for (const std::string &argument : arguments) words.push_back(const_cast<char *>(argument.c_str()));
  words.push_back(nullptr);
  execv(words.front(), words.data());
  return fail(ErrorCode::state, "cannot start " + arguments.front() + ": " + std::strerror(errno));
}

Expected<ProcessResult> runProcess(const std::vector<std::string> &arguments, double timeout_s) {
  int out[2], err[2];
  if (pipe2(out, O_CLOEXEC) != 0) return fail(ErrorCode::state, "no pipe");
  if (pipe2(err, O_CLOEXEC) != 0) {
    close(out[0]);
    close(out[1]);
    return fail(ErrorCode::state, "no pipe");
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
  const Expected<pid_t> pid = spawn(arguments, &actions);
  posix_spawn_file_actions_destroy(&actions);
  close(out[1]);
  close(err[1]);
  if (!pid) {
    close(out[0]);
    close(err[0]);
    return tl::unexpected<Error>(pid.error());
  }

  ProcessResult result;
  const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
  pollfd fds[2] = {{out[0], POLLIN, 0}, {err[0], POLLIN, 0}};
  std::string *texts[2] = {&result.output, &result.errorOutput};
  int open = 2;
  int status = 0;
  bool exited = false;
  while (open > 0) {
    const double left = std::chrono::duration<double>(end - Clock::now()).count();
    if (left <= 0.0) {
      if (exited) break;  // a grandchild produces endless output
      result.timedOut = true;
      ::kill(*pid, SIGKILL);
      break;
    }
    // A grandchild may keep the pipes open after the program has ended, so its end is checked separately.
    if (!exited && waitpid(*pid, &status, WNOHANG) == *pid) exited = true;
    const int ready = poll(fds, 2, exited ? 0 : 20);
    if (ready == 0 && exited) break;
    for (int i = 0; i < 2; ++i) {
      if (fds[i].fd < 0 || fds[i].revents == 0) continue;
      char buffer[4096];
      const ssize_t n = read(fds[i].fd, buffer, sizeof buffer);
      if (n > 0) {
        appendOutput(*texts[i], {buffer, static_cast<std::size_t>(n)});
      } else {
        fds[i].fd = -1;
        --open;
      }
    }
  }
  close(out[0]);
  close(err[0]);
  while (!exited) {
    if (waitpid(*pid, &status, WNOHANG) == *pid) break;
    if (Clock::now() > end && !result.timedOut) {
      result.timedOut = true;
      ::kill(*pid, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  result.exitCode = exitCodeOf(status);
  return result;
}

Expected<FileLock> FileLock::take(const std::filesystem::path &file, const std::string &note) {
  const int descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0) return fail(ErrorCode::output, file.string() + ": " + std::strerror(errno));
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    const int error = errno;
    char held[256] = {};
    const ssize_t n = read(descriptor, held, sizeof held - 1);
    close(descriptor);
    if (error == EWOULDBLOCK) return fail(ErrorCode::state, std::string(held, n > 0 ? static_cast<std::size_t>(n) : 0));
    return fail(ErrorCode::output, file.string() + ": cannot be locked: " + std::strerror(error));
  }
  // The note is informative only; the lock is valid without it.
  if (ftruncate(descriptor, 0) != 0 || write(descriptor, note.data(), note.size()) < 0) errno = 0;
  return FileLock(descriptor);
}

FileLock::FileLock(FileLock &&other) noexcept : handle_(std::exchange(other.handle_, -1)) {}

FileLock::~FileLock() {
  if (handle_ >= 0) close(static_cast<int>(handle_));
}

Expected<ChildProcess> ChildProcess::start(const std::vector<std::string> &arguments,
                                           const std::filesystem::path &log) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  const Expected<pid_t> pid = spawn(arguments, &actions);
  posix_spawn_file_actions_destroy(&actions);
  if (!pid) return tl::unexpected<Error>(pid.error());
  ChildProcess child;
  child.id_ = *pid;
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
  int status = 0;
  if (waitpid(static_cast<pid_t>(id_), &status, WNOHANG) == static_cast<pid_t>(id_)) {
    running_ = false;
    exitCode_ = exitCodeOf(status);
  }
  return running_;
}

Expected<int> ChildProcess::wait(double timeout_s) {
  const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
  while (isRunning()) {
    if (Clock::now() > end) return fail(ErrorCode::state, "the program is still running");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return exitCode_;
}

void ChildProcess::kill() {
  if (!isRunning()) return;
  ::kill(static_cast<pid_t>(id_), SIGTERM);
  if (wait(2.0)) return;
  ::kill(static_cast<pid_t>(id_), SIGKILL);
  (void)wait(2.0);
}

GuardedMemory::GuardedMemory(std::size_t bytes) {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  size_ = (bytes + page - 1) / page * page;
  void *all = mmap(nullptr, size_ + 2 * kGuard, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (all == MAP_FAILED) throw std::bad_alloc();
  data_ = static_cast<unsigned char *>(all) + kGuard;
  if (mprotect(data_, size_, PROT_READ | PROT_WRITE) == 0) return;
  munmap(all, size_ + 2 * kGuard);
  throw std::bad_alloc();
}

GuardedMemory::~GuardedMemory() {
  if (data_ != nullptr) munmap(data_ - kGuard, size_ + 2 * kGuard);
}

GuardedMemory::GuardedMemory(GuardedMemory &&other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

GuardedMemory &GuardedMemory::operator=(GuardedMemory &&other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

bool detail::resetThreadLocale() noexcept {
  if (uselocale(nullptr) == LC_GLOBAL_LOCALE) return false;
  (void)uselocale(LC_GLOBAL_LOCALE);
  return true;
}

}  // namespace c3de
