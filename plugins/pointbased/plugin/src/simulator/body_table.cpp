// SPDX-License-Identifier: Apache-2.0
#include "simulator/body_table.h"

#include <algorithm>

namespace pointbased {
namespace {

template <class Map>
auto *findIn(Map &map, std::uint64_t id) {
  const auto found = map.find(id);
  return found == map.end() ? nullptr : &found->second;
}

template <class Map>
std::uint64_t idNamed(const Map &map, const ObjectName &name, const char *what) {
  for (const auto &[id, record] : map)
    if (record.identity() == name) return id;
  throw sdk::Error(C3DE_E_NOT_FOUND, "there is no " + std::string(what) + " '" + textOf(name) + "' in this simulation");
}

}  // namespace

std::vector<std::uint64_t> BodyTable::bodiesInOrder() const {
  std::vector<std::uint64_t> ids;
  for (const auto &[id, record] : bodies_) ids.push_back(id);
  std::sort(ids.begin(), ids.end(),
            [this](std::uint64_t a, std::uint64_t b) { return bodies_.at(a).order < bodies_.at(b).order; });
  return ids;
}

BodyRecord *BodyTable::body(std::uint64_t id) { return findIn(bodies_, id); }

const BodyRecord *BodyTable::body(std::uint64_t id) const { return findIn(bodies_, id); }

const ObstacleRecord *BodyTable::obstacle(std::uint64_t id) const { return findIn(obstacles_, id); }

BodyRecord &BodyTable::bodyOrThrow(std::uint64_t id) {
  if (BodyRecord *found = body(id)) return *found;
  throw sdk::Error(noSuch("body"));
}

std::uint64_t BodyTable::bodyNamed(const ObjectName &name) const { return idNamed(bodies_, name, "body"); }

std::uint64_t BodyTable::obstacleNamed(const ObjectName &name) const { return idNamed(obstacles_, name, "obstacle"); }

std::vector<Attachment> BodyTable::attachmentsOf(std::uint64_t id) const {
  std::vector<Attachment> out;
  for (const auto &[number, attachment] : attachments_)
    if (attachment.first == id || attachment.second == id) out.push_back(attachment);
  return out;
}

std::string BodyTable::nameOf(std::uint64_t id) const {
  if (id == kWorldBox) return "box";
  if (const BodyRecord *found = body(id)) return found->name;
  const ObstacleRecord *found = obstacle(id);
  return found ? found->name : std::string();
}

std::string BodyTable::nameOfAttached(std::uint64_t id) const {
  return id == kSurroundings ? "surroundings" : nameOf(id);
}

bool BodyTable::hasProbeTool(const std::string &name) const {
  return std::any_of(obstacles_.begin(), obstacles_.end(),
                     [&](const auto &one) { return one.second.tool && one.second.name == name; });
}

bool BodyTable::hasAttachment(const std::string &name) const {
  return std::any_of(attachments_.begin(), attachments_.end(),
                     [&](const auto &one) { return one.second.name == name; });
}

std::string BodyTable::freeInstrumentName() const {
  const auto isTaken = [this](const std::string &name) {
    return std::any_of(obstacles_.begin(), obstacles_.end(),
                       [&](const auto &one) { return one.second.name == name && !instruments_.contains(one.first); });
  };
  std::string name = "instrument";
  for (int k = 2; isTaken(name); ++k) name = "instrument " + std::to_string(k);
  return name;
}

void BodyTable::addBody(std::uint64_t id, BodyRecord record) {
  if (record.order == 0) record.order = ++lastOrder_;
  if (record.number == 0) record.number = ++bodyCounts_[record.name];
  bodies_.emplace(id, std::move(record));
}

void BodyTable::addObstacle(std::uint64_t id, ObstacleRecord record) {
  if (record.number == 0) record.number = ++obstacleCounts_[record.name];
  obstacles_.emplace(id, std::move(record));
}

void BodyTable::addAttachment(std::uint64_t id, Attachment attachment) {
  attachments_.emplace(id, std::move(attachment));
}

bool BodyTable::removeBody(std::uint64_t id) {
  if (bodies_.erase(id) == 0) return false;
  removeAttachmentsOf(id);
  return true;
}

bool BodyTable::removeObstacle(std::uint64_t id) {
  if (obstacles_.erase(id) == 0) return false;
  removeAttachmentsOf(id);
  return true;
}

void BodyTable::removeAttachmentsOf(std::uint64_t id) {
  std::erase_if(attachments_,
                [id](const auto &entry) { return entry.second.first == id || entry.second.second == id; });
}

void BodyTable::clear() {
  bodies_.clear();
  obstacles_.clear();
  instruments_.clear();
  attachments_.clear();
  bodyCounts_.clear();
  obstacleCounts_.clear();
}

void BodyTable::addInstrument(std::uint64_t id, const ObstacleRecord &record) {
  obstacles_.emplace(id, record);
  instruments_.emplace(id, record);
}

std::vector<std::uint64_t> BodyTable::removeInstruments() {
  std::vector<std::uint64_t> ids;
  for (const auto &[id, record] : instruments_)
    if (obstacles_.erase(id) > 0) ids.push_back(id);
  return ids;
}

void BodyTable::syncInstruments(const Simulator &simulator) {
  for (const auto &[id, record] : instruments_) {
    if (simulator.world().obstacle(id))
      obstacles_.emplace(id, record);
    else
      obstacles_.erase(id);
  }
}

sdk::Failure noSuch(const char *what) {
  return {C3DE_E_STALE, std::string("there is no such ") + what + " in this simulation"};
}

}  // namespace pointbased
