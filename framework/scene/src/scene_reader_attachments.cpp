// SPDX-License-Identifier: Apache-2.0
// [[attachment]]: what holds a body elastically.
#include <algorithm>

#include "c3de/core/text.h"
#include "scene_reader.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kKeys{"bodies", "stiffness", "tangential", "retardation_time", "tears_at"};
const std::vector<std::string> kNotServed{"within_mm", "region"};
const char *const kSurroundings = "surroundings";
const char *const kBodies = "two names, [\"liver\", \"surroundings\"]";

}  // namespace

bool SceneReader::readAttachment(const TomlValue &table) {
  Attachment attachment;
  attachment.line = table.line;
  bool hasStiffness = false;
  for (const auto &[key, value] : table.entries) {
    if (key == "bodies") {
      const bool good = value.kind == TomlValue::Kind::array && value.items.size() == 2 &&
                        value.items[0].kind == TomlValue::Kind::text && value.items[1].kind == TomlValue::Kind::text;
      if (!good) return refuse(value.line, "bodies is " + value.kindName() + "; accepted: " + kBodies);
      attachment.body = value.items[0].text;
      if (value.items[1].text != kSurroundings)
        return refuse(value.line, "an attachment to '" + value.items[1].text +
                                      "' is not served yet, only to where a body is in the scan; accepted: " + kBodies);
    } else if (key == "tears_at") {
      double stress = 0.0;
      if (!readNumber(key, "0: an attachment that tears is not served yet", value, stress)) return false;
      if (stress != 0.0)
        return refuse(value.line, "tears_at is " + formatNumber(stress) +
                                      " Pa; an attachment that tears is not served yet; accepted: 0");
    } else if (key == "stiffness" || key == "tangential" || key == "retardation_time") {
      hasStiffness = hasStiffness || key == "stiffness";
      if (!store(attachment.params, "surroundings." + key, value)) return false;
    } else if (std::find(kNotServed.begin(), kNotServed.end(), key) != kNotServed.end()) {
      return refuse(value.line, "'" + key + "' is not served yet: the surroundings hold the whole surface; accepted: " +
                                    joined(kKeys));
    } else {
      return refuseKey(value.line, key, "[[attachment]]", kKeys);
    }
  }
  if (attachment.body.empty())
    return refuse(table.line, std::string("the attachment has no 'bodies'; accepted: ") + kBodies);
  if (!hasStiffness)
    return refuse(table.line,
                  "the attachment has no 'stiffness'; accepted: a number of at least 0, Pa/m (stress per way)");
  attachments_.push_back(std::move(attachment));
  return true;
}

bool SceneReader::attachBodies() {
  std::vector<std::string> attached;
  for (Attachment &attachment : attachments_) {
    if (!checkBodyName("attachment", attachment.line, attachment.body)) return false;
    if (std::find(attached.begin(), attached.end(), attachment.body) != attached.end())
      return refuse(attachment.line, "a second attachment holds '" + attachment.body +
                                         "' where it is in the scan; accepted: one for each body");
    attached.push_back(attachment.body);
    const auto body = std::find_if(scene_.bodies.begin(), scene_.bodies.end(),
                                   [&](const SceneBody &candidate) { return candidate.name == attachment.body; });
    for (SceneValue &value : attachment.params) body->params.push_back(std::move(value));
  }
  return true;
}

}  // namespace c3de::scene
