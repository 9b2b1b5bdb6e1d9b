// SPDX-License-Identifier: Apache-2.0
#include "long_calls.h"

#include <fmt/format.h>

#include "c3de/abi/log.h"
#include "c3de/abi/simulation.h"
#include "c3de/core/background_jobs.h"
#include "c3de/core/crash_journal.h"
#include "c3de/core/log.h"
#include "c3de/core/main_queue.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/scene/simulation_directory.h"

namespace c3de::plugin_host {
namespace {

/// What a person can do about a call that does not return.
std::vector<registry::Choice> choices(const Services &services, const LongCall &call) {
  std::vector<registry::Choice> out;
  if (call.kind == CallKind::job && call.subject != 0 && services.jobs)
    out.push_back(
        {"Cancel the job", [jobs = services.jobs, job = Handle::fromBits(call.subject)] { (void)jobs->cancel(job); }});
  if (call.kind == CallKind::step && services.simulations)
    out.push_back({"Stop the simulation", [simulations = services.simulations] {
                     for (const auto &entry : simulations->all()) entry.simulation->transport(C3DE_TRANSPORT_STOP);
                   }});
  if (!out.empty()) out.push_back({"Wait", [] {}});
  return out;
}

}  // namespace

void tellLongCall(const Services &services, const LongCall &call) {
  noteHang(call);
  const std::string name = fmt::format("plugin {}: {}", call.owner, call.what);
  std::string line;
  if (call.isOver && call.kind == CallKind::prompt)
    line = fmt::format("{} has returned after {:.1f} s", name, call.seconds);
  else if (call.isOver)
    line = fmt::format("{} has got on after {:.1f} s", name, call.seconds);
  else
    line = fmt::format("{} has not returned for {:.1f} s{}", name, call.seconds,
                       call.isOnMain ? "; the program waits for it" : "");
  log(LogLevel::warn, line);
  // While the main thread hangs nothing can be drawn: then the end is told, with how long it took.
  if (!services.panels || !services.mainQueue || (call.isOnMain && !call.isOver)) return;
  const std::uint32_t severity = call.isOver ? C3DE_LOG_INFO : C3DE_LOG_WARN;
  auto actions = call.isOver ? std::vector<registry::Choice>() : choices(services, call);
  services.mainQueue->post([panels = services.panels, severity, title = call.owner + " is slow to answer", line,
                            actions = std::move(actions)] { panels->notify(severity, title, line, actions); });
}

}  // namespace c3de::plugin_host
