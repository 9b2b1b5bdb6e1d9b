// SPDX-License-Identifier: Apache-2.0
#include "mpi/mpi_ranks.h"

// The C interface; the C++ one has been removed from the standard.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <list>
#include <map>
#include <thread>

#include "c3de/core/log.h"
#include "c3de/session/interrupt.h"
#include "commands/exit_code.h"

namespace c3de::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kBeat = std::chrono::seconds(1), kSilence = std::chrono::seconds(30);
constexpr const char *kSomeAreLost = "some are lost";  // finalising MPI would wait for them
enum Tag : int { kTask = 1, kResult = 2, kAlive = 3, kStop = 4 };

/// Messages in transit. Sending does not block, since the receiver may no longer exist.
class Outbox {
 public:
  void send(int rank, Tag tag, std::string text) {
    Message &message = messages_.emplace_back(Message{std::move(text), MPI_REQUEST_NULL});
    if (MPI_Isend(message.text.data(), static_cast<int>(message.text.size()), MPI_CHAR, rank, tag, MPI_COMM_WORLD,
                  &message.request) != MPI_SUCCESS)
      messages_.pop_back();
  }
  /// Removes those that have arrived. @return whether none remains
  bool tidy() {
    for (auto message = messages_.begin(); message != messages_.end();) {
      int done = 0;
      if (MPI_Test(&message->request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS || done != 0)
        message = messages_.erase(message);
      else
        ++message;
    }
    return messages_.empty();
  }
  void empty(Clock::duration patience) {
    for (const auto end = Clock::now() + patience; !tidy() && Clock::now() < end;)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }

 private:
  struct Message {
    std::string text;
    MPI_Request request;
  };
  std::list<Message> messages_;
};

struct Received {
  int rank = 0, tag = 0;
  std::string text;
};

std::optional<Received> receive() {
  int isThere = 0;
  MPI_Status status;
  if (MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &isThere, &status) != MPI_SUCCESS || isThere == 0)
    return std::nullopt;
  int count = 0;
  MPI_Get_count(&status, MPI_CHAR, &count);
  Received out{status.MPI_SOURCE, status.MPI_TAG, std::string(static_cast<std::size_t>(count), '\0')};
  if (MPI_Recv(out.text.data(), count, MPI_CHAR, out.rank, out.tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE) != MPI_SUCCESS)
    return std::nullopt;
  return out;
}

/// A result begins with '+', an error with '-' and its code.
std::string textOf(const Expected<study::Result> &result) {
  if (result) return '+' + result->text();
  return '-' + std::to_string(static_cast<int>(result.error().code)) + ' ' + result.error().message;
}

Expected<study::Result> resultOf(const std::string &text) {
  if (text.starts_with('+')) return study::Result::fromText(text.substr(1));
  const std::size_t space = text.find(' ');
  if (!text.starts_with('-') || space == std::string::npos)
    return fail(ErrorCode::internal, "a rank sent what is no result");
  return fail(static_cast<ErrorCode>(std::atoi(text.c_str() + 1)), text.substr(space + 1));
}

}  // namespace

/// One point at a time in each rank, this one included.
class RankWorkers : public study::Workers {
 public:
  RankWorkers(MpiRanks &ranks, std::size_t jobs) : ranks_(ranks), jobs_(jobs) {
    for (int rank = 1; rank < ranks.size_; ++rank) others_[rank].heard = Clock::now();
  }
  [[nodiscard]] bool hasRoom() const override {
    std::size_t running = own_.hasRoom() ? 0 : 1, room = own_.hasRoom() ? 1 : 0;
    for (const auto &[rank, other] : others_) ++(other.task ? running : room);
    return room > 0 && running < jobs_;
  }
  void start(study::Task task) override {
    // Other ranks first: this one also distributes the points.
    for (auto &[rank, other] : others_) {
      if (other.task) continue;
      outbox_.send(rank, kTask, task.text());
      other.task = std::move(task);
      return;
    }
    own_.start(std::move(task));
  }
  [[nodiscard]] std::vector<Done> poll() override;

 private:
  struct Other {
    std::optional<study::Task> task;
    Clock::time_point heard;
  };
  MpiRanks &ranks_;
  std::size_t jobs_;
  study::LocalWorkers own_{1};
  std::map<int, Other> others_;  ///< the ranks that are present
  Outbox outbox_;
  Clock::time_point nextBeat_{};
};

std::vector<study::Workers::Done> RankWorkers::poll() {
  std::vector<Done> out = own_.poll();
  while (auto message = receive()) {
    const auto other = others_.find(message->rank);
    if (other == others_.end()) continue;  // given up; it has responded too late
    other->second.heard = Clock::now();
    if (message->tag != kResult || !other->second.task) continue;
    out.push_back({std::move(*other->second.task), resultOf(message->text)});
    other->second.task.reset();
  }
  outbox_.tidy();
  const Clock::time_point now = Clock::now();
  if (now >= nextBeat_) {
    for (const auto &[rank, other] : others_) outbox_.send(rank, kAlive, "");
    nextBeat_ = now + kBeat;
  }
  for (auto other = others_.begin(); other != others_.end();) {
    if (now - other->second.heard < kSilence) {
      ++other;
      continue;
    }
    log(LogLevel::warn, "rank " + std::to_string(other->first) + " does not respond; its point is run by another rank");
    ranks_.lost_.insert(other->first);
    if (other->second.task) out.push_back({std::move(*other->second.task), study::Result(), true});
    other = others_.erase(other);
  }
  return out;
}

MpiRanks::MpiRanks(int &argc, char **&argv) {
  MPI_Init(&argc, &argv);
  // A rank that has ended is detected by its silence; it must not end all others.
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

std::unique_ptr<study::Workers> MpiRanks::workers(std::size_t jobs) {
  return std::make_unique<RankWorkers>(*this, jobs);
}

int MpiRanks::work() {
  session::watchForInterrupt();
  std::optional<study::PointRun> run;
  Outbox outbox;
  Clock::time_point nextBeat{}, heard = Clock::now();
  bool isToldToEnd = false, areAllThere = false;
  // Planning a large study and drawing its samples may take the first rank minutes before it sends anything.
  auto patience = std::chrono::duration_cast<Clock::duration>(std::chrono::hours(1));
  while (!isToldToEnd && !session::wasInterrupted() && Clock::now() - heard < patience) {
    while (const auto message = receive()) {
      heard = Clock::now();
      patience = kSilence;
      if (message->tag == kStop) {
        isToldToEnd = true;
        areAllThere = message->text.empty();
      }
      if (message->tag != kTask) continue;
      auto task = study::Task::fromText(message->text);
      if (task)
        run.emplace(std::move(*task));
      else
        outbox.send(0, kResult, textOf(tl::unexpected(task.error())));
    }
    if (run)
      if (const auto result = run->poll()) {
        outbox.send(0, kResult, textOf(*result));
        run.reset();
      }
    if (Clock::now() >= nextBeat) {
      outbox.send(0, kAlive, "");
      nextBeat = Clock::now() + kBeat;
    }
    outbox.tidy();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  run.reset();
  outbox.empty(std::chrono::seconds(2));
  if (!areAllThere) std::_Exit(isToldToEnd ? kDone : session::wasInterrupted() ? kInterrupted : kFailed);
  MPI_Finalize();
  return kDone;
}

void MpiRanks::end(int exitCode) {
  Outbox outbox;
  for (int rank = 1; rank < size_; ++rank)
    if (!lost_.contains(rank)) outbox.send(rank, kStop, lost_.empty() ? "" : kSomeAreLost);
  outbox.empty(std::chrono::seconds(2));
  if (lost_.empty()) {
    // Messages still in transit from the others are received; otherwise their finalisation would wait.
    for (const auto until = Clock::now() + std::chrono::milliseconds(200); Clock::now() < until;)
      if (!receive()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    MPI_Finalize();
    return;
  }
  std::fflush(nullptr);
  std::_Exit(exitCode);
}

}  // namespace c3de::app
