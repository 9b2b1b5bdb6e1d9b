// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>

#include "fields/evaluation_points.h"
#include "pointbased/error_estimate.h"
#include "simulator/body_table.h"
#include "simulator/snapshot.h"

namespace pointbased {

/// Writes and publishes the snapshots of a simulation for the window. Expensive results that have not changed are
/// reused in the next snapshot: error estimates and colours.
///
/// It reads the simulator and the table, so the mutex of SimulatedWorld is held in every call except latest().
class SnapshotWriter {
 public:
  SnapshotWriter(const Services &services, Simulator &simulator, const BodyTable &table, EvaluationPoints &points);

  /// Publishes the present state. Solver thread.
  /// @param grasps  as they hold now
  /// @param isShowing  a body has a shape of SimulatedWorld::show(): no errors are estimated
  void publish(const ViewSettings &view, std::vector<GraspSnapshot> grasps, std::vector<ConditionSnapshot> conditions,
               bool isShowing);
  /// Null before the first. Any thread, without the mutex.
  [[nodiscard]] std::shared_ptr<const Snapshot> latest() const { return exchange_.latest(); }
  /// Called for a body that has been removed.
  void forget(std::uint64_t body) { estimated_.erase(body); }
  /// The latest verification, shown in snapshots as long as the bodies are in the verified state.
  void setVerification(std::shared_ptr<const WorldVerification> verification) {
    verification_ = std::move(verification);
  }
  /// The latest verification if it belongs to the present state; otherwise null.
  [[nodiscard]] std::shared_ptr<const WorldVerification> verificationOfNow() const {
    return verification_ && isOfNow(*verification_) ? verification_ : nullptr;
  }

 private:
  struct Estimated {
    std::chrono::steady_clock::time_point next{};  // no update before this time
    AccuracyStatement statement;
    std::shared_ptr<const DisplacementTrials> trials;       // used for `statement`
    std::shared_ptr<const WorldVerification> verification;  // used for `statement`
    ErrorScratch scratch;
  };

  void takeBodies(Snapshot &s, bool isShowing);
  void takeContact(Snapshot &s) const;
  void takeView(Snapshot &s);
  void estimate(const BodyRecord &record, bool moved, BodySnapshot &out);
  /// Whether it belongs to the present state.
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
