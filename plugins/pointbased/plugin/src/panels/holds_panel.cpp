// SPDX-License-Identifier: Apache-2.0
#include "panels/holds_panel.h"

#include <algorithm>
#include <string>

#include "base/number_text.h"

namespace pointbased {
namespace {

constexpr std::size_t kListedSupports = 5;

std::string listed(const std::vector<std::string> &names) {
  std::string out;
  for (std::size_t i = 0; i < std::min(names.size(), kListedSupports); ++i) out += (i > 0 ? ", " : "") + names[i];
  if (names.size() > kListedSupports) out += " and " + std::to_string(names.size() - kListedSupports) + " more";
  return out;
}

void drawContactsOf(sdk::Ui &ui, const Snapshot &snapshot, const BodySnapshot &body) {
  for (const ContactSnapshot &contact : snapshot.contacts) {
    const ContactSummary &now = contact.summary;
    if (now.first == now.second || (now.first != body.id && now.second != body.id)) continue;
    ui.value("Contact with " + (now.first == body.id ? contact.second : contact.first),
             significant(now.force.norm(), 3) + " N");
    ui.tooltip("Contact force between them, mean over the last step");
  }
}

}  // namespace

void drawHolds(sdk::Ui &ui, const Snapshot &snapshot, const BodySnapshot &body) {
  if (body.isStatic) {
    ui.value("Fixed", "rigid, fixed in its reference position");
    return;
  }
  bool isHeld = false;
  if (!body.supports.empty()) {
    isHeld = true;
    ui.value("Supports of the scene", std::to_string(body.supports.size()) + ": " + listed(body.supports));
    ui.tooltip("Unnamed supports are listed by number");
  }
  if (body.held > 0) {
    isHeld = true;
    ui.value("Fixed points", std::to_string(body.held) + " of " + std::to_string(body.phyxels.size()) + " phyxels");
    ui.tooltip("By supports and by rigid tissue, such as bone");
  }
  for (const AttachmentSnapshot &one : snapshot.attachments) {
    if (one.first != body.name && one.second != body.name) continue;
    isHeld = true;
    std::string text = significant(one.force, 3) + " N";
    if (one.tornPart > 0.0) text += ", " + significant(100.0 * one.tornPart) + " % torn";
    ui.value("Attached to " + (one.first == body.name ? one.second : one.first), text);
    ui.tooltip("Force of the attachment '" + one.name + "'");
  }
  drawContactsOf(ui, snapshot, body);
  isHeld = isHeld ||
           std::any_of(snapshot.conditions.begin(), snapshot.conditions.end(),
                       [&](const ConditionSnapshot &one) { return one.body == body.id && one.condition.isSupport(); });
  // Contacts come and go from step to step; this line does not.
  if (!isHeld) ui.text(body.name + " has no support, only contacts. Add a support where it is fixed.");
}

}  // namespace pointbased
