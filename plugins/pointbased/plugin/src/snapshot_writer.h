// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>

#include "body_table.h"
#include "evaluation_points.h"
#include "pointbased/error_estimate.h"
#include "snapshot.h"

namespace pointbased {

/// Writes what the window sees of a simulation and hands it out. Of what is dear it keeps from one snapshot to the next
/// what has not changed: error estimates and colours.
///
/// It reads the simulator and the table, so the mutex of WorldSimulator is held in every call but latest().
class SnapshotWriter {
 public:
  SnapshotWriter(const Services &services, Simulator &simulator, const BodyTable &table, EvaluationPoints &points);

  /// The present moment. Solver's thread.
  /// @param grasps  as they hold now
  void publish(const ViewSettings &view, std::vector<GraspSnapshot> grasps);
  /// Null before the first. Any thread, without the mutex.
  [[nodiscard]] std::shared_ptr<const Snapshot> latest() const { return exchange_.latest(); }
  /// Of a body that is gone.
  void forget(std::uint64_t body) { estimated_.erase(body); }
  /// The latest, which snapshots show as long as the bodies are as they were in it.
  void setVerification(std::shared_ptr<const WorldVerification> verification) {
    verification_ = std::move(verification);
  }
  /// The latest, if it is of the present state; else null.
  [[nodiscard]] std::shared_ptr<const WorldVerification> verificationOfNow() const {
    return verification_ && isOfNow(*verification_) ? verification_ : nullptr;
  }

 private:
  struct Estimated {
    std::chrono::steady_clock::time_point next{};  // not before
    AccuracyStatement statement;
    std::shared_ptr<const DisplacementTrials> trials;       // that it was made with
    std::shared_ptr<const WorldVerification> verification;  // likewise
    ErrorScratch scratch;
  };

  void takeBodies(Snapshot &s);
  void takeContact(Snapshot &s) const;
  void takeView(Snapshot &s);
  void estimate(const BodyRecord &record, bool moved, BodySnapshot &out);
  /// Whether it is of the present state.
  [[nodiscard]] bool isOfNow(const WorldVerification &verification) const;

  const Services &services_;
  Simulator &simulator_;
  const BodyTable &table_;
  EvaluationPoints &points_;
  SnapshotExchange exchange_;
  Colouring colouring_;
  std::map<std::uint64_t, Estimated> estimated_;
  std::shared_ptr<const WorldVerification> verification_;
  std::uint64_t generation_ = 0;
};

}  // namespace pointbased
