// SPDX-License-Identifier: Apache-2.0
// Loads plugins whose descriptor has changed bytes, each in a child process: refused with a reason or accepted, in
// time. A child may crash or hang only where a pointer was changed, which may point anywhere, and which no host can
// detect.
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>

#include "c3de/abi/entry.h"
#include "trial_host.h"

namespace {

c3de_status C3DE_CALL create(const c3de_host *, void **self) {
  *self = nullptr;
  return C3DE_OK;
}
c3de_status C3DE_CALL doNothing(void *) { return C3DE_OK; }
void C3DE_CALL destroy(void *) {}

/// A complete descriptor, whose bytes may be changed.
struct Descriptor {
  std::array<c3de_service_req, 2> needs{
      c3de_service_req{sizeof(c3de_service_req), C3DE_REQUIRED, {"c3de.log/1", 10}, 1, 0},
      c3de_service_req{sizeof(c3de_service_req), C3DE_OPTIONAL, {"c3de.panels/1", 13}, 1, 0}};
  c3de_plugin plugin{sizeof(c3de_plugin),
                     1,
                     {"test.mutant", 11},
                     {"1.0.0", 5},
                     {"Mutant", 6},
                     {"Me", 2},
                     {"MIT", 3},
                     nullptr,
                     2,
                     sizeof(c3de_service_req),
                     create,
                     doNothing,
                     doNothing,
                     destroy};
};

/// Whether a change of this byte makes a pointer wild, or lets an accepted count or length reach beyond memory.
bool isPointer(std::size_t offset, const unsigned char *base, const Descriptor &of) {
  const auto within = [&](const void *member, std::size_t size) {
    const auto at = static_cast<std::size_t>(static_cast<const unsigned char *>(member) - base);
    return offset >= at && offset < at + size;
  };
  const c3de_plugin &p = of.plugin;
  for (const c3de_str *text :
       {&p.id, &p.version, &p.display_name, &p.vendor, &p.license, &of.needs[0].id, &of.needs[1].id})
    if (within(&text->ptr, sizeof text->ptr) || within(&text->len, sizeof text->len)) return true;
  return within(&p.needs, sizeof p.needs) || within(&p.needs_n, sizeof p.needs_n) ||
         within(&p.needs_stride, sizeof p.needs_stride) || within(&p.create, 4 * sizeof p.create);
}

constexpr unsigned kPatience_s = 5;

/// In the child: loads mutants `first` … `last` - 1 of the seed; prints the number of each before loading it.
[[noreturn]] void loadMutants(std::uint64_t seed, std::uint64_t first, std::uint64_t last, int pipe) {
  std::freopen("/dev/null", "w", stderr);
  const auto folder = std::filesystem::temp_directory_path() / ("c3de-fuzz-" + std::to_string(getpid()));
  for (std::uint64_t i = first; i < last; ++i) {
    alarm(kPatience_s);
    std::mt19937_64 engine(seed * 1000003u + i);
    Descriptor mutant;
    mutant.plugin.needs = mutant.needs.data();
    auto *base = reinterpret_cast<unsigned char *>(&mutant);
    std::uint64_t report[2]{i, 0};
    for (std::size_t n = 1 + engine() % 3; n > 0; --n) {
      const std::size_t at = engine() % sizeof mutant;
      if (isPointer(at, base, mutant)) report[1] = 1;
      base[at] = static_cast<unsigned char>(engine());
    }
    if (write(pipe, report, sizeof report) != sizeof report) _exit(3);
    char where[32];
    std::snprintf(where, sizeof where, "%llx",
                  static_cast<unsigned long long>(reinterpret_cast<std::uintptr_t>(&mutant.plugin)));
    setenv("C3DE_TEST_DESCRIPTOR", where, 1);
    c3de::validate::TrialHost host(folder, c3de::validate::TrialHost::Serves::least);
    (void)host.refusalOf(C3DE_SEAM);
    host.host.reset();
  }
  _exit(0);
}

}  // namespace

int main(int argc, char **argv) {
  std::uint64_t seed = static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
  std::uint64_t count = 5000;
  CLI::App app("Descriptors of plugins with changed bytes.");
  app.add_option("--count", count, "How many");
  app.add_option("--seed", seed, "Which");
  CLI11_PARSE(app, argc, argv);
  std::uint64_t findings = 0, died = 0, next = 0;
  while (next < count) {
    int ends[2];
    if (pipe(ends) != 0) return 2;
    const pid_t child = fork();
    if (child < 0) return 2;
    if (child == 0) loadMutants(seed, next, std::min(next + 500, count), ends[1]);
    close(ends[1]);
    std::uint64_t report[2]{next, 0}, seen[2];
    while (read(ends[0], seen, sizeof seen) == sizeof seen) std::memcpy(report, seen, sizeof seen);
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    next = report[0] + 1;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) continue;
    ++died;
    if (report[1] != 0) continue;
    ++findings;
    std::printf("finding: seed %llu, mutant %llu: %s %d\n", static_cast<unsigned long long>(seed),
                static_cast<unsigned long long>(report[0]), WIFSIGNALED(status) ? "signal" : "exit code",
                WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
  }
  std::printf("%llu descriptors, seed %llu: %llu ended their process by a wild pointer, %llu findings\n",
              static_cast<unsigned long long>(count), static_cast<unsigned long long>(seed),
              static_cast<unsigned long long>(died - findings), static_cast<unsigned long long>(findings));
  return findings == 0 ? 0 : 1;
}
