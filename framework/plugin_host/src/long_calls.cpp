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

/// The user's options for a call that does not return.
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

/// What the user is waiting for.
std::string titleOf(const LongCall &call) {
  if (call.isOnMain) return "The window did not respond";
  switch (call.kind) {
    case CallKind::step: return "The simulation is slow to respond";
    case CallKind::job: return "A job is slow to respond";
    default: return "A plugin is slow to respond";
  }
}

/// The duration, and the remedy. The ids are in the log.
std::string textOf(const LongCall &call) {
  if (call.isOnMain)
    return fmt::format("It waited {:.1f} s for a plugin and responds again. The log names the plugin.", call.seconds);
  switch (call.kind) {
    case CallKind::step: return fmt::format("A step of the simulation has taken {:.1f} s so far.", call.seconds);
    case CallKind::job:
      return fmt::format("A job in the background has reported no progress for {:.1f} s so far.", call.seconds);
    default:
      return fmt::format(
          "A plugin has been busy for {:.1f} s so far. The log names it; Plugins in the menu switches it off.",
          call.seconds);
  }
}

/// While the main thread waits, nothing can be drawn, so only the end is reported. The program's own work shows its
/// progress and can be cancelled there. The end of a job or step is visible.
bool isShown(const LongCall &call) {
  if (call.isOnMain) return call.isOver;
  return !call.isOver && !(call.kind == CallKind::job && call.subject == 0);
}

}  // namespace

void reportLongCall(const Services &services, const LongCall &call) {
  noteHang(call);
  const std::string name = fmt::format("plugin {}: {}", call.owner, call.what);
  std::string line;
  if (call.isOver && call.kind == CallKind::prompt)
    line = fmt::format("{} has returned after {:.1f} s", name, call.seconds);
  else if (call.isOver)
    line = fmt::format("{} continued after {:.1f} s", name, call.seconds);
  else
    line = fmt::format("{} has not returned for {:.1f} s{}", name, call.seconds,
                       call.isOnMain ? "; the program waits for it" : "");
  log(LogLevel::warn, line);
  if (!services.panels || !services.mainQueue || !isShown(call)) return;
  const std::uint32_t severity = call.isOver ? C3DE_LOG_INFO : C3DE_LOG_WARN;
  auto actions = call.isOver ? std::vector<registry::Choice>() : choices(services, call);
  services.mainQueue->post([panels = services.panels, severity, title = titleOf(call), text = textOf(call),
                            actions = std::move(actions)] { panels->notify(severity, title, text, actions); });
}

}  // namespace c3de::plugin_host
