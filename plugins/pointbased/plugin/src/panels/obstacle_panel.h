// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "c3de/sdk/panel.hpp"
#include "instruments/implant_shape.h"
#include "tools/move_tool.h"

namespace pointbased {

/// Part of the panel: obstacles and implants. One is added from a file in a unit the user selects, or as a shape of
/// given size. Its place is at the cross-hair, at the position in its file, or on the nearest surface. It can be moved
/// and removed. Adding and removing are undo steps. Main thread.
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
  /// A file that has been read, or a shape, but is not part of the simulation yet.
  struct Candidate {
    std::string name;
    std::shared_ptr<const sdk::MeshHandle> mesh;
    Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();  ///< as read
    double read_mm = 1.0;                               ///< mm, of the unit that was assumed when it was read
    std::uint32_t unit = 0, place = 0;                  ///< the user's choice
    double contactPlane_mm = 0.0;                       ///< z of the plane that is placed on a surface, as read
    const ImplantShape *shape = nullptr;                ///< null: a file
    std::vector<double> sizes_mm = {};                  ///< of the shape
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
  void takeShape(const ImplantShape &shape);
  /// Makes the surface of a shape with its present sizes.
  void makeShape(Candidate &candidate);
  void drawCandidate(sdk::Ui &ui, const Snapshot *snapshot);
  void add(const Snapshot &snapshot);
  /// @param isCaptured  Undo restores the simulation as it was captured; otherwise it removes the obstacle
  void insert(const std::string &name, const std::shared_ptr<AddObstacle> &change, bool isCaptured);
  void remove(const Snapshot &snapshot);
  void keepStep(const std::string &what, const std::string &name, const Obstacle &obstacle, bool isIn);
  /// Makes a change of an obstacle on the simulation's thread. @param change  returns whether the simulation was reset
  [[nodiscard]] sdk::Result<void> post(const std::string &name, std::function<bool(Changes &)> change);
  /// How far it is moved along the normal of its contact plane so that it touches skin but does not enter it, mm as
  /// read.
  [[nodiscard]] static double clearanceShift(const Candidate &candidate, const Snapshot &snapshot,
                                             const PlacementTransform &transform, const Mat3 &rotation);
  [[nodiscard]] Placement placementOf(const Candidate &candidate, const Snapshot *snapshot) const;
  /// Names of the bodies whose skin is inside the candidate; empty if none.
  [[nodiscard]] std::string bodiesIn(const Candidate &candidate, const Snapshot &snapshot) const;
  void submit(const std::string &title, std::function<sdk::Result<void>(sdk::Progress)> work,
              std::function<void()> whenDone);
  void fail(const std::string &text);

  const Services &services_;
  MoveTool &move_;
  sdk::Ref<WorldSimulator> simulator_;
  std::string path_;
  std::uint32_t shape_ = 0;  // index among implantShapes()
  std::optional<Candidate> candidate_;
  std::optional<c3de_handle> job_;
  std::uint64_t serial_ = 0;        // of the simulator; results of a job started for an earlier one are discarded
  std::vector<c3de_handle> steps_;  // undo steps
  std::vector<Reset> resets_;
};

}  // namespace pointbased
