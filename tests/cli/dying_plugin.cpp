// SPDX-License-Identifier: Apache-2.0
// Crashes, hangs or ends the program where the environment variable C3DE_TEST_DIES specifies: so that one file can be
// good at first and bad later.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#if !defined(_WIN32)
#include <sys/wait.h>
#include <unistd.h>
#endif

#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

bool diesIn(const std::string &place) {
  const char *wanted = std::getenv("C3DE_TEST_DIES");
  return wanted != nullptr && place == wanted;
}

/// Of the library itself, before it has identified itself.
struct Loading {
  Loading() {
    if (diesIn("loading")) std::abort();
  }
} loading;

void endsTheProgram(const std::string &place) {
  if (diesIn(place + " exit")) std::exit(0);
#if !defined(__MINGW32__)  // its C library has no such function
  if (diesIn(place + " quick_exit")) std::quick_exit(0);
#endif
  if (diesIn(place + " _Exit")) std::_Exit(0);
  if (diesIn(place + " thread exit")) std::thread([] { std::exit(0); }).join();
  if (diesIn(place + " thread _Exit")) std::thread([] { std::_Exit(0); }).join();
#if !defined(_WIN32)
  if (diesIn(place + " child _exit")) {  // a separate process may end in any way
    const pid_t child = fork();
    if (child == 0) _exit(7);
    int status = 0;
    if (waitpid(child, &status, 0) != child || WEXITSTATUS(status) != 7) std::abort();
  }
#endif
}

class Dying : public sdk::Panel {
 public:
  static constexpr sdk::PluginInfo info{.id = "test.dying", .version = "1.0.0", .displayName = "Dying"};
  static constexpr std::array needs{sdk::required<c3de_forces_v1>(), sdk::optional<c3de_panels_v1>(),
                                    sdk::optional<c3de_jobs_v1>(), sdk::optional<c3de_settings_v1>()};

  explicit Dying(sdk::Host host) : host_(host) {
    if (diesIn("create")) std::abort();
    if (diesIn("nowhere, and counts")) {
      const sdk::Settings settings(host);
      const auto before = settings.get("lives");
      sdk::orThrow(settings.set("lives", std::to_string(1 + (before ? std::stoi(*before) : 0))));
    }
    endsTheProgram("create");
    if (diesIn("hang")) std::this_thread::sleep_for(std::chrono::minutes(10));
    field_ = sdk::orThrow(sdk::Forces(host).add("dying", [](const c3de_force_call &) -> sdk::Result<void> {
      if (diesIn("step")) {
        volatile std::uintptr_t nowhere = 8;  // prevents the compiler from seeing the null access
        *reinterpret_cast<volatile int *>(nowhere) = 1;
      }
      endsTheProgram("step");
      // Shorter than the timeout of the requesting test.
      if (diesIn("slow step")) std::this_thread::sleep_for(std::chrono::seconds(14));
      return {};
    }));
    if (host.service<c3de_panels_v1>()) sdk::orThrow(show(host, "test.dying.panel", "Dying"));
  }

  void start() {
    // Rarely checks whether it is cancelled.
    if (diesIn("silent job"))
      sdk::orThrow(sdk::Jobs(host_).submit(
          "Endless",
          [](sdk::Progress progress) -> sdk::Result<void> {
            do {
              std::this_thread::sleep_for(std::chrono::seconds(14));
            } while (progress.update(-1.0, "endless"));
            return {};
          },
          [](const sdk::Result<void> &) {}));
    if (diesIn("thread")) {
      std::thread([] { throw std::runtime_error("of a thread of its own"); }).detach();
      std::this_thread::sleep_for(std::chrono::minutes(10));
    }
  }
  void stop() { field_.remove(); }
  void draw(sdk::Ui &ui) override {
    if (diesIn("panel")) std::abort();
    ui.text("I live.");
  }

 private:
  sdk::Host host_;
  sdk::ForceField field_;
};

}  // namespace

C3DE_DEFINE_PLUGIN(Dying)
