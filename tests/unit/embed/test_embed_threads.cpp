// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "../../cli/program.h"
#include "open_simulation.h"

namespace {

std::string boxScene(const std::string &name) { return writeBoxScene(freshFolder(name)).string(); }

/// kB of this process in memory.
long residentMemory() {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("VmRSS:", 0) == 0) return std::stol(line.substr(6));
  return 0;
}

int threadCount() {
  int count = 0;
  for ([[maybe_unused]] const auto &one : std::filesystem::directory_iterator("/proc/self/task")) ++count;
  return count;
}

}  // namespace

TEST_CASE("Ten simulations in ten threads of one process end as one alone") {
  const std::string file = boxScene("embed-ten");
  std::vector<std::uint64_t> alone(10), together(10);
  const auto simulate = [&](std::size_t i, std::vector<std::uint64_t> &hashes) {
    const std::string stiffness = "body.box.youngs_modulus=" + std::to_string(10000 + 1000 * i);
    c3de_sim sim = 0;
    if (tryOpen(file, {stiffness.c_str()}, sim) != C3DE_OK) return;
    if (c3de_embed_step(sim, 15, nullptr) == C3DE_OK) (void)c3de_embed_state_hash(sim, &hashes[i]);
    (void)c3de_embed_close(sim);
  };
  for (std::size_t i = 0; i < alone.size(); ++i) simulate(i, alone);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < together.size(); ++i) threads.emplace_back([&, i] { simulate(i, together); });
  for (std::thread &thread : threads) thread.join();
  for (const std::uint64_t hash : alone) CHECK(hash != 0);
  CHECK(alone == together);
  CHECK(alone[0] != alone[1]);
}

TEST_CASE("Several threads may call one simulation, one after the other") {
  const std::string file = boxScene("embed-shared");
  const OpenSimulation shared(file), alone(file);
  std::vector<std::thread> threads;
  std::atomic<int> failures{0};
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      std::vector<double> copy;
      for (int step = 0; step < 5; ++step) {
        if (c3de_embed_step(shared.get(), 1, nullptr) != C3DE_OK) ++failures;
        c3de_embed_array view{};
        view.size = sizeof view;
        if (c3de_embed_view_field(shared.get(), 0, 1, "position", &view) != C3DE_OK) ++failures;
        copy.resize(3 * view.shape[0]);
        if (c3de_embed_read_field(shared.get(), 0, 1, "position", copy.data(), 8 * copy.size()) != C3DE_OK) ++failures;
      }
    });
  for (std::thread &thread : threads) thread.join();
  CHECK(failures == 0);
  CHECK(statusOf(shared.get()).steps == 20);
  REQUIRE_OK(c3de_embed_step(alone.get(), 20, nullptr));
  CHECK(hashOf(shared.get()) == hashOf(alone.get()));
}

TEST_CASE("Another thread cancels a run, which leaves a complete state and can continue") {
  const OpenSimulation sim(boxScene("embed-cancel"));
  CHECK(c3de_embed_cancel(sim.get()) == C3DE_OK);  // nothing runs: no effect on what follows
  REQUIRE_OK(c3de_embed_step(sim.get(), 1, nullptr));
  std::atomic<bool> hasStepped{false}, isOver{false};
  std::thread other([&] {
    while (!hasStepped) std::this_thread::yield();
    while (!isOver) {
      (void)c3de_embed_cancel(sim.get());
      std::this_thread::yield();
    }
  });
  c3de_embed_run_options run{};
  run.size = sizeof run;
  run.until_s = 1e6;
  run.stepped_self = &hasStepped;
  run.stepped = [](void *self, const c3de_embed_status *, double) -> std::int32_t {
    *static_cast<std::atomic<bool> *>(self) = true;
    return 0;
  };
  const c3de_status ended = c3de_embed_run(sim.get(), &run);
  const std::string text = lastError();
  isOver = true;
  other.join();
  CHECK(ended == C3DE_E_CANCELLED);
  CHECK_THAT(text, Contains("cancelled at"));
  const std::uint64_t steps = statusOf(sim.get()).steps;
  REQUIRE_OK(c3de_embed_step(sim.get(), 1, nullptr));
  CHECK(statusOf(sim.get()).steps == steps + 1);
}

TEST_CASE("A callback may read and cancel, and must not step or close") {
  const OpenSimulation sim(boxScene("embed-callback"));
  struct Seen {
    c3de_sim sim;
    int calls = 0;
    c3de_status read = -1, stepped = 0, closed = 0;
    double fraction = -1.0;
  } seen{sim.get()};
  c3de_embed_run_options run{};
  run.size = sizeof run;
  run.max_steps = 10;
  run.stepped_self = &seen;
  run.stepped = [](void *self, const c3de_embed_status *status, double fraction) -> std::int32_t {
    auto &to = *static_cast<Seen *>(self);
    c3de_embed_array view{};
    view.size = sizeof view;
    to.read = c3de_embed_view_field(to.sim, 0, 1, "velocity", &view);
    to.stepped = c3de_embed_step(to.sim, 1, nullptr);
    to.closed = c3de_embed_close(to.sim);
    to.fraction = fraction;
    ++to.calls;
    return status->steps == 4 ? 1 : 0;
  };
  CHECK(c3de_embed_run(sim.get(), &run) == C3DE_E_CANCELLED);
  CHECK(seen.calls == 4);
  CHECK(seen.read == C3DE_OK);
  CHECK(seen.stepped == C3DE_E_STATE);
  CHECK(seen.closed == C3DE_E_STATE);
  CHECK_THAT(seen.fraction, WithinAbs(0.4, 1e-12));
}

TEST_CASE("Closing ends the run of another thread") {
  c3de_sim sim = 0;
  REQUIRE_OK(tryOpen(boxScene("embed-close"), {}, sim));
  std::atomic<bool> hasStepped{false};
  c3de_status ended = C3DE_OK;
  std::thread runner([&] {
    c3de_embed_run_options run{};
    run.size = sizeof run;
    run.until_s = 1e6;
    run.stepped_self = &hasStepped;
    run.stepped = [](void *self, const c3de_embed_status *, double) -> std::int32_t {
      *static_cast<std::atomic<bool> *>(self) = true;
      return 0;
    };
    ended = c3de_embed_run(sim, &run);
  });
  while (!hasStepped) std::this_thread::yield();
  CHECK(c3de_embed_close(sim) == C3DE_OK);
  runner.join();
  CHECK(ended == C3DE_E_CANCELLED);
  CHECK(c3de_embed_step(sim, 1, nullptr) == C3DE_E_STALE);
}

TEST_CASE("Opening can be cancelled by its progress") {
  const std::string file = boxScene("embed-cancel-open");
  c3de_embed_options options{};
  options.size = sizeof options;
  options.file = file.c_str();
  options.progress = [](void *, double, const char *) -> std::int32_t { return 1; };
  c3de_sim sim = 0;
  CHECK(c3de_embed_open(&options, &sim) == C3DE_E_CANCELLED);
  CHECK(sim == 0);
}

TEST_CASE("A thousand simulations are opened and closed without memory or threads left over") {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  C3DE_SKIP("a sanitizer keeps memory of its own");
#endif
  const std::string file = boxScene("embed-thousand");
  const auto openAndClose = [&](int times) {
    for (int i = 0; i < times; ++i) {
      c3de_sim sim = 0;
      REQUIRE_OK(tryOpen(file, {}, sim));
      REQUIRE_OK(c3de_embed_step(sim, 1, nullptr));
      REQUIRE_OK(c3de_embed_close(sim));
    }
  };
  openAndClose(100);
  const long before = residentMemory();
  const int threads = threadCount();
  openAndClose(900);
  CHECK(threadCount() == threads);
  // 10 kB for each would be 9 MB; an allocator keeps some.
  CHECK(residentMemory() - before < 4000);
  WARN("grown by " << residentMemory() - before << " kB in 900 simulations");
}
