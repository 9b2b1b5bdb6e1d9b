// SPDX-License-Identifier: Apache-2.0
#include "simulator/attachments.h"

#include "c3de/sdk/structs.hpp"

namespace pointbased {

using sdk::Error;

void Attachments::add(const c3de_sim_attachment *attachment, c3de_handle *out) {
  const c3de_sim_attachment in = sdk::readStruct(attachment, "attachment");
  Attachment read;
  read.name = std::string(sdk::text(in.name));
  const std::string which = "attachment '" + read.name + "': ";
  read.first = in.first.v;
  read.second = in.second.v;
  if (in.region != nullptr) read.region = readRegion(in.region, {"attachment", 0, {}});
  if ((in.flags & C3DE_SIM_ATTACHMENT_WITHIN) != 0) read.within = in.within_m;
  read.stiffness = in.stiffness_Pa_m;
  read.tangential = in.tangential_Pa_m;
  read.tearsAt = in.tears_at_Pa;
  const StepInterrupt::Waiting waiting(world_.request);
  const StateLock lock(world_);
  if (!table_.hasBody(read.first) || (read.second != kSurroundings && !table_.has(read.second)))
    throw Error(C3DE_E_STALE, which + "there is no such body or obstacle in this simulation");
  if (table_.hasAttachment(read.name)) throw Error(C3DE_E_EXISTS, which + "there is one of this name already");
  const auto added = simulator_.world().addAttachment(read);
  table_.syncInstruments(simulator_);  // a new attachment restarts the simulation
  if (!added) throw Error(C3DE_E_ARG, which + added.error());
  table_.addAttachment(*added, std::move(read));
  if (out) *out = {*added};
}

void Attachments::reattach(Attachment attachment, std::uint64_t before, std::uint64_t now) {
  (attachment.first == before ? attachment.first : attachment.second) = now;
  if (const auto added = simulator_.world().addAttachment(attachment))
    table_.addAttachment(*added, std::move(attachment));
  else
    simulator_.diagnostics().addWarning(now, "attachment '" + attachment.name + "' was removed: " + added.error());
}

std::vector<ReportedAttachment> Attachments::reported() const {
  std::vector<ReportedAttachment> out;
  for (AttachmentSummary &summary : simulator_.world().attachments()) {
    const Attachment &of = table_.attachments().at(summary.id);
    out.push_back(
        {std::move(summary), {table_.nameOf(of.first), table_.nameOfAttached(of.second)}, of.stiffness, of.tangential});
  }
  return out;
}

c3de_status Attachments::enumerate(void *visitor, Each each) {
  if (!each) throw Error(C3DE_E_ARG, "each is null");
  const std::lock_guard lock(world_.mutex);
  for (const AttachmentSummary &attachment : simulator_.world().attachments()) {
    c3de_sim_attachment_state state{};
    state.size = sizeof state;
    state.name = sdk::str(attachment.name);
    for (int a = 0; a < 3; ++a) state.force_N[a] = attachment.force[a];
    state.torn_part = attachment.tornPart;
    state.area_m2 = attachment.area;
    state.traction_Pa = attachment.traction;
    if (const c3de_status status = each(visitor, &state); status != C3DE_OK) return status;
  }
  return C3DE_OK;
}

}  // namespace pointbased
