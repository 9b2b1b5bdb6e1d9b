// SPDX-License-Identifier: Apache-2.0
// [[attachment]]: elastic supports of a body.
#include <algorithm>

#include "scene_fields.h"

namespace c3de::scene {
bool SceneReader::readTable(const SceneTable<SceneAttachment> &table, const TomlValue &keys) {
  SceneAttachment attachment;
  attachment.line = keys.line;
  if (!readFields(table, keys, attachment)) return false;
  if (attachment.names[0].empty())
    return refuse(keys.line, table.owner + " has no 'bodies'; accepted: " + table.find("bodies")->rules.required);
  const bool toSurroundings = attachment.names[1] == kSurroundingsName;
  if (toSurroundings && attachment.within_m)
    return refuse(keys.line, "within_mm applies to two surfaces; accepted for an attachment to the surroundings: " +
                                 std::string("region = { … }, or neither, for all of the surface"));
  if (toSurroundings && !attachment.region && attachment.tearsAt_Pa == 0.0) {
    Attachment &whole = attachments_.emplace_back(Attachment{attachment.names[0], {}, keys.line});
    for (const auto &[key, value] : keys.entries)
      if (std::find(kSurroundingsKeys.begin(), kSurroundingsKeys.end(), key) != kSurroundingsKeys.end())
        if (!read("surroundings." + key, value, whole.params)) return false;
    return true;
  }
  if (const TomlValue *retardation = keys.find("retardation_time"))
    return refuse(retardation->line,
                  "retardation_time is of an attachment of all of the surface to the surroundings "
                  "that does not tear; accepted elsewhere: no retardation_time");
  if (!toSurroundings && !attachment.region && !attachment.within_m)
    return refuse(keys.line,
                  "the attachment does not say where; accepted: within_mm = 3 (where the surfaces lie that "
                  "near), region = { … } (of the first body), or both");
  if (attachment.name.empty()) attachment.name = attachment.names[0] + "/" + attachment.names[1];
  scene_.attachments.push_back(std::move(attachment));
  return true;
}

bool SceneReader::attachBodies() {
  std::vector<std::string> attached;
  for (Attachment &attachment : attachments_) {
    if (!checkBodyName("attachment", attachment.line, attachment.body)) return false;
    if (std::find(attached.begin(), attached.end(), attachment.body) != attached.end())
      return refuse(attachment.line, "a second attachment holds all of '" + attachment.body +
                                         "' where it is in the scan; accepted: one for each body");
    attached.push_back(attachment.body);
    const auto give = [&](const std::string &name, std::vector<SceneValue> &params) {
      if (name != attachment.body) return;
      for (const SceneValue &value : attachment.params) params.push_back(value);
    };
    for (SceneBody &body : scene_.bodies) {
      give(body.name, body.params);
      if (!body.volume.slides.empty()) give(nameOfRest(body), body.volume.rest.params);
      const std::vector<std::string> pieces = namesOfPieces(body);
      for (std::size_t i = 0; i < pieces.size(); ++i) give(pieces[i], body.volume.slides[i].params);
    }
  }
  return true;
}

bool SceneReader::checkAttachments() {
  const std::vector<std::string> bodies = referableNames(scene_);
  std::vector<std::string> others = bodies;
  for (const SceneObstacle &obstacle : scene_.obstacles) others.push_back(obstacle.name);
  for (std::size_t i = 0; i < scene_.attachments.size(); ++i) {
    const SceneAttachment &attachment = scene_.attachments[i];
    const auto check = [&](const std::string &name, const std::vector<std::string> &known, const char *what) {
      const auto count = std::count(known.begin(), known.end(), name);
      if (count == 1) return true;
      if (count > 1)
        return refuse(attachment.line, "'" + name + "' is the name of " + std::to_string(count) +
                                           " bodies or obstacles; accepted: names that only one has");
      return refuse(attachment.line,
                    "there is no " + std::string(what) + " '" + name + "'; " + suggestion(name, known));
    };
    std::vector<std::string> known = others;
    known.emplace_back(kSurroundingsName);
    if (!check(attachment.names[0], bodies, "body") || !check(attachment.names[1], known, "body or obstacle"))
      return false;
    if (attachment.names[0] == attachment.names[1])
      return refuse(attachment.line,
                    "the attachment has '" + attachment.names[0] + "' twice; accepted: two different names");
    for (std::size_t k = 0; k < i; ++k)
      if (scene_.attachments[k].name == attachment.name)
        return refuse(attachment.line, "a second attachment is named '" + attachment.name +
                                           "'; accepted: names that differ, name = \"…\"");
  }
  return true;
}

}  // namespace c3de::scene
