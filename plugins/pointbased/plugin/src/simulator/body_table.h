// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "simulator/body_record.h"

namespace pointbased {

/// The bodies and obstacles of a simulation by id, with their names and attachments. The ids are those assigned by
/// Simulator: code that adds or removes an entry here does the same there. Probe tools and instruments are obstacles.
///
/// The table has no lock. The mutex of SimulatedWorld guards it, also against readers. Pointers and references into it
/// are valid only while that mutex is held.
class BodyTable {
 public:
  /// All in ascending order of id.
  [[nodiscard]] const std::map<std::uint64_t, BodyRecord> &bodies() const { return bodies_; }
  [[nodiscard]] const std::map<std::uint64_t, ObstacleRecord> &obstacles() const { return obstacles_; }
  [[nodiscard]] const std::map<std::uint64_t, Attachment> &attachments() const { return attachments_; }
  /// Ids of the bodies in the order in which they were added. A rebuilt body keeps its position.
  [[nodiscard]] std::vector<std::uint64_t> bodiesInOrder() const;

  [[nodiscard]] bool hasBody(std::uint64_t id) const { return bodies_.contains(id); }
  /// A body or an obstacle.
  [[nodiscard]] bool has(std::uint64_t id) const { return hasBody(id) || obstacles_.contains(id); }
  /// Null if there is none.
  [[nodiscard]] BodyRecord *body(std::uint64_t id);
  [[nodiscard]] const BodyRecord *body(std::uint64_t id) const;
  [[nodiscard]] const ObstacleRecord *obstacle(std::uint64_t id) const;
  /// Throws sdk::Error C3DE_E_STALE if there is none.
  [[nodiscard]] BodyRecord &bodyOrThrow(std::uint64_t id);
  /// Throw sdk::Error C3DE_E_NOT_FOUND if there is none of this name.
  [[nodiscard]] std::uint64_t bodyNamed(const ObjectName &name) const;
  [[nodiscard]] std::uint64_t obstacleNamed(const ObjectName &name) const;
  /// Attachments that join a body or an obstacle to something.
  [[nodiscard]] std::vector<Attachment> attachmentsOf(std::uint64_t id) const;

  /// Name of a body, of an obstacle, or of the walls (kWorldBox). Empty if there is none.
  [[nodiscard]] std::string nameOf(std::uint64_t id) const;
  /// Name of anything an attachment may join: a body, an obstacle or kSurroundings.
  [[nodiscard]] std::string nameOfAttached(std::uint64_t id) const;
  [[nodiscard]] bool hasProbeTool(const std::string &name) const;
  [[nodiscard]] bool hasAttachment(const std::string &name) const;
  /// "instrument", or with the first number that is not in use: "instrument 2".
  [[nodiscard]] std::string freeInstrumentName() const;

  /// Last in the order, unless the record already has a position there.
  void addBody(std::uint64_t id, BodyRecord record);
  void addObstacle(std::uint64_t id, ObstacleRecord record);
  void addAttachment(std::uint64_t id, Attachment attachment);
  /// Also removes its attachments. False if there is none.
  bool removeBody(std::uint64_t id);
  bool removeObstacle(std::uint64_t id);
  bool removeAttachment(std::uint64_t id) { return attachments_.erase(id) > 0; }
  void clear();

  /// An obstacle that appears and disappears with the state of the simulation: see syncInstruments().
  void addInstrument(std::uint64_t id, const ObstacleRecord &record);
  /// Removes all present instruments. @return their ids
  std::vector<std::uint64_t> removeInstruments();
  /// Called after the simulator has changed to another state: the instruments become those of that state.
  void syncInstruments(const Simulator &simulator);
  /// Called after a reset, from which no earlier state can be restored.
  void clearInstrumentHistory() { instruments_.clear(); }

 private:
  void removeAttachmentsOf(std::uint64_t id);

  std::map<std::uint64_t, BodyRecord> bodies_;
  std::map<std::uint64_t, ObstacleRecord> obstacles_;
  std::map<std::uint64_t, ObstacleRecord> instruments_;  // since the last reset, including removed ones
  std::map<std::uint64_t, Attachment> attachments_;
  std::size_t lastOrder_ = 0;
  std::map<std::string, std::uint32_t> bodyCounts_, obstacleCounts_;  // by name, including removed ones
};

/// C3DE_E_STALE: no object of this kind has the id.
[[nodiscard]] sdk::Failure noSuch(const char *what);

}  // namespace pointbased
