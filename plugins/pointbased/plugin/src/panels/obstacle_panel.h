// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "c3de/sdk/panel.hpp"
#include "tools/move_tool.h"

namespace pointbased {

/// Part of the panel: obstacles and implants. One is added from a file in a unit the user selects, at the cross-hair or
/// at the position in its file. It can be moved and removed. Adding and removing are undo steps. Main thread.
class ObstaclePanel {
 public:
  ObstaclePanel(const Services &services, MoveTool &move) : services_(services), move_(move) {}
  ObstaclePanel(const ObstaclePanel &) = delete;
  ObstaclePanel &operator=(const ObstaclePanel &) = delete;

  /// Null if none.
  void setSimulator(WorldSimulator *simulator);
  void draw(sdk::Ui &ui, const Snapshot *snapshot);

 private:
  using Obstacle = std::shared_ptr<ObjectName>;  ///< written on the simulation's thread
  /// A file that has been read but is not part of the simulation yet.
  struct Candidate {
    std::string name;
    std::shared_ptr<const sdk::MeshHandle> mesh;
    Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();  ///< as read
    double read_mm = 1.0;                               ///< mm, of the unit that was assumed when it was read
    std::uint32_t unit = 0, place = 0;                  ///< the user's choice
    std::string overlapped;  ///< bodies that overlapped it when Add was pressed; adding it must then be confirmed
    std::string middle;      ///< its position at that time
  };
  /// A reset of the simulation because an obstacle was placed where tissue was; reported once.
  struct Reset {
    std::string name;
    std::shared_ptr<std::atomic<bool>> hasMade = std::make_shared<std::atomic<bool>>(false);
  };

  void read();
  void take(const std::string &name, sdk::MeshHandle mesh);
  void drawCandidate(sdk::Ui &ui, const Snapshot *snapshot);
  void add(const Snapshot &snapshot);
  /// @param isCaptured  Undo restores the simulation as it was captured; otherwise it removes the obstacle
  void insert(const std::string &name, const std::shared_ptr<AddObstacle> &change, bool isCaptured);
  void remove(const Snapshot &snapshot);
  void keepStep(const std::string &what, const std::string &name, const Obstacle &obstacle, bool isIn);
  /// Makes a change of an obstacle on the simulation's thread. @param change  returns whether the simulation was reset
  [[nodiscard]] sdk::Result<void> post(const std::string &name, std::function<bool(Changes &)> change);
  [[nodiscard]] Placement placementOf(const Candidate &candidate) const;
  /// Names of the bodies whose skin is inside the candidate; empty if none.
  [[nodiscard]] std::string bodiesIn(const Candidate &candidate, const Snapshot &snapshot) const;
  void submit(const std::string &title, std::function<sdk::Result<void>(sdk::Progress)> work,
              std::function<void()> whenDone);
  void fail(const std::string &text);

  const Services &services_;
  MoveTool &move_;
  sdk::Ref<WorldSimulator> simulator_;
  std::string path_;
  std::optional<Candidate> candidate_;
  std::optional<c3de_handle> job_;
  std::uint64_t serial_ = 0;        // of the simulator; results of a job started for an earlier one are discarded
  std::vector<c3de_handle> steps_;  // undo steps
  std::vector<Reset> resets_;
};

}  // namespace pointbased
