// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "body_record.h"

namespace pointbased {

/// Which bodies and obstacles a simulation has, under which id and name, and what attaches them to one another. The ids
/// are those that Simulator has given: those who add or remove one here do so there as well. Probe tools and
/// instruments are obstacles.
///
/// It has no lock of its own: the mutex of WorldSimulator guards it, against readers too, and what is found here is
/// used while that mutex is held.
class BodyTable {
 public:
  /// All by ascending id.
  [[nodiscard]] const std::map<std::uint64_t, BodyRecord> &bodies() const { return bodies_; }
  [[nodiscard]] const std::map<std::uint64_t, ObstacleRecord> &obstacles() const { return obstacles_; }
  [[nodiscard]] const std::map<std::uint64_t, Attachment> &attachments() const { return attachments_; }
  /// Ids of the bodies as they were added; one that is built again stays in its place.
  [[nodiscard]] std::vector<std::uint64_t> bodiesInOrder() const;

  [[nodiscard]] bool hasBody(std::uint64_t id) const { return bodies_.contains(id); }
  /// A body or an obstacle.
  [[nodiscard]] bool has(std::uint64_t id) const { return hasBody(id) || obstacles_.contains(id); }
  /// Null: there is none.
  [[nodiscard]] BodyRecord *body(std::uint64_t id);
  [[nodiscard]] const BodyRecord *body(std::uint64_t id) const;
  [[nodiscard]] const ObstacleRecord *obstacle(std::uint64_t id) const;
  /// sdk::Error C3DE_E_STALE: there is none.
  [[nodiscard]] BodyRecord &bodyOrThrow(std::uint64_t id);
  /// Those that join a body or an obstacle to something.
  [[nodiscard]] std::vector<Attachment> attachmentsOf(std::uint64_t id) const;

  /// Of a body, an obstacle or kWorldBox, the walls; empty: there is none.
  [[nodiscard]] std::string nameOf(std::uint64_t id) const;
  /// Of what an attachment may join: a body, an obstacle or kSurroundings.
  [[nodiscard]] std::string nameOfAttached(std::uint64_t id) const;
  [[nodiscard]] bool hasProbeTool(const std::string &name) const;
  [[nodiscard]] bool hasAttachment(const std::string &name) const;
  /// "instrument", or with the first number that no other obstacle has: "instrument 2".
  [[nodiscard]] std::string freeInstrumentName() const;

  /// Last in the order, unless it has a place there already.
  void addBody(std::uint64_t id, BodyRecord record);
  void addObstacle(std::uint64_t id, ObstacleRecord record);
  void addAttachment(std::uint64_t id, Attachment attachment);
  /// With what attached it. False: there is none.
  bool removeBody(std::uint64_t id);
  bool removeObstacle(std::uint64_t id);
  bool removeAttachment(std::uint64_t id) { return attachments_.erase(id) > 0; }
  void clear();

  /// An obstacle that comes and goes with the state of the simulation: followInstruments().
  void addInstrument(std::uint64_t id, const ObstacleRecord &record);
  /// Takes out all that are in. @return their ids
  std::vector<std::uint64_t> removeInstruments();
  /// After the simulator has gone to another state: the instruments are those that it has now.
  void followInstruments(const Simulator &simulator);
  /// After a reset, which no state of before comes back from.
  void forgetInstruments() { instruments_.clear(); }

 private:
  void removeAttachmentsOf(std::uint64_t id);

  std::map<std::uint64_t, BodyRecord> bodies_;
  std::map<std::uint64_t, ObstacleRecord> obstacles_;
  std::map<std::uint64_t, ObstacleRecord> instruments_;  // since the last reset, also those that have gone
  std::map<std::uint64_t, Attachment> attachments_;
  std::size_t lastOrder_ = 0;
};

/// C3DE_E_STALE: nothing of this kind has the id that was named.
[[nodiscard]] sdk::Failure noSuch(const char *what);

}  // namespace pointbased
