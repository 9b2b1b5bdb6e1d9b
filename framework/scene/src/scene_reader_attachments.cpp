// SPDX-License-Identifier: Apache-2.0
// [[attachment]]: elastic supports of a body.
#include <algorithm>

#include "c3de/core/text.h"
#include "scene_reader.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kKeys{"name",      "bodies",     "within_mm", "region",
                                     "stiffness", "tangential", "tears_at",  "retardation_time"};
const char *const kBodies =
    "two names, [\"liver\", \"surroundings\"]: a body, and another body, an obstacle, or where it is in the scan";
const char *const kStiffness = "a number of at least 0, Pa/m (stress per displacement)";
constexpr double kMetresPerMillimetre = 1e-3;

}  // namespace

bool SceneReader::readNotNegative(const std::string &key, const std::string &unit, const TomlValue &value,
                                  double &out) {
  const std::string accepted = "a number of at least 0, " + unit;
  if (!readNumber(key, accepted, value, out)) return false;
  return out >= 0.0 || refuse(value.line, key + " is " + formatNumber(out) + "; accepted: " + accepted);
}

bool SceneReader::attachmentKey(SceneAttachment &attachment, const std::string &key, const TomlValue &value) {
  if (key == "name") return readName(value, attachment.name);
  if (key == "bodies") {
    const bool good = value.kind == TomlValue::Kind::array && value.items.size() == 2 &&
                      value.items[0].kind == TomlValue::Kind::text && value.items[1].kind == TomlValue::Kind::text;
    if (!good) return refuse(value.line, "bodies is " + value.kindName() + "; accepted: " + kBodies);
    attachment.names = {value.items[0].text, value.items[1].text};
    return true;
  }
  if (key == "within_mm") {
    double within = 0.0;
    const char *accepted = "a number above 0, mm";
    if (!readNumber(key, accepted, value, within)) return false;
    if (!(within > 0.0)) return refuse(value.line, "within_mm is " + formatNumber(within) + "; accepted: " + accepted);
    attachment.within_m = kMetresPerMillimetre * within;
    return true;
  }
  if (key == "region") return readRegion(value, attachment.region.emplace());
  if (key == "stiffness")
    return readNotNegative(key, "Pa/m (stress per displacement)", value, attachment.stiffness_Pa_m);
  if (key == "tangential")
    return readNotNegative(key, "Pa/m (stress per displacement)", value, attachment.givenTangential_Pa_m.emplace());
  if (key == "tears_at") return readNotNegative(key, "Pa; 0: never", value, attachment.tearsAt_Pa);
  return refuseKey(value.line, key, "[[attachment]]", kKeys);
}

bool SceneReader::readAttachment(const TomlValue &table) {
  SceneAttachment attachment;
  attachment.line = table.line;
  Attachment whole{{}, {}, table.line};
  const TomlValue *retardation = nullptr;
  for (const auto &[key, value] : table.entries) {
    if (key == "retardation_time") retardation = &value;
    if (key == "stiffness" || key == "tangential" || key == "retardation_time")
      if (!store(whole.params, "surroundings." + key, value)) return false;
    if (key != "retardation_time" && !attachmentKey(attachment, key, value)) return false;
  }
  if (attachment.names[0].empty())
    return refuse(table.line, std::string("the attachment has no 'bodies'; accepted: ") + kBodies);
  if (table.find("stiffness") == nullptr)
    return refuse(table.line, std::string("the attachment has no 'stiffness'; accepted: ") + kStiffness);
  const bool toSurroundings = attachment.names[1] == kSurroundingsName;
  if (toSurroundings && attachment.within_m)
    return refuse(table.line, "within_mm is between two surfaces; of an attachment to the surroundings accepted: " +
                                  std::string("region = { … }, or neither, for all of the surface"));
  if (toSurroundings && !attachment.region && attachment.tearsAt_Pa == 0.0) {
    whole.body = attachment.names[0];
    attachments_.push_back(std::move(whole));
    return true;
  }
  if (retardation != nullptr)
    return refuse(retardation->line,
                  "retardation_time is of an attachment of all of the surface to the surroundings "
                  "that does not tear; accepted elsewhere: no retardation_time");
  if (!toSurroundings && !attachment.region && !attachment.within_m)
    return refuse(table.line,
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
      const std::string nearest = nearestName(name, known);
      if (count > 1)
        return refuse(attachment.line, "'" + name + "' is the name of " + std::to_string(count) +
                                           " bodies or obstacles; accepted: names that only one has");
      return refuse(attachment.line, "there is no " + std::string(what) + " '" + name + "'; " +
                                         (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                                         "accepted: " + joined(known));
    };
    std::vector<std::string> known = others;
    known.emplace_back(kSurroundingsName);
    if (!check(attachment.names[0], bodies, "body") || !check(attachment.names[1], known, "body or obstacle"))
      return false;
    if (attachment.names[0] == attachment.names[1])
      return refuse(attachment.line,
                    "the attachment is of '" + attachment.names[0] + "' and itself; accepted: two that differ");
    for (std::size_t k = 0; k < i; ++k)
      if (scene_.attachments[k].name == attachment.name)
        return refuse(attachment.line, "a second attachment is named '" + attachment.name +
                                           "'; accepted: names that differ, name = \"…\"");
  }
  return true;
}

}  // namespace c3de::scene
