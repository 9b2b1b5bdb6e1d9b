// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <variant>

#include "c3de/core/path_text.h"
#include "c3de/core/plugin_call.h"
#include "c3de/core/text.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/session.h"
#include "c3de/session/simulation_state.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {

/// Applies one event.
class Replay::Applier {
 public:
  Applier(Replay &replay, Session &session, c3de_object *simulator, const c3de_simulator_v1 *table, ChangeLog *changes,
          const ProgressFn &progress)
      : replay_(replay), session_(session), simulator_(simulator), table_(table), changes_(changes),
        progress_(progress) {}

  Expected<void> operator()(const SimulationChange &change) {
    return applyChange(simulator_, change, [this] { return session_.plugins().takeError(); });
  }
  Expected<void> operator()(const RecordedReset &) {
    const c3de_status code = callPluginFunction(session_.plugins().ownerOf(simulator_), "reset of the simulation",
                                                CallKind::step, [this] { return table_->reset(simulator_); });
    if (code >= 0) return {};
    const std::string reason = session_.plugins().takeError();
    return fail(ErrorCode::plugin, "the reset failed: " + (reason.empty() ? fmt::format("status {}", code) : reason));
  }
  Expected<void> operator()(const RecordedState &state) {
    return goToState(session_, simulator_, replay_.recording_.start.simulator, state.bytes, "the loaded state");
  }
  Expected<void> operator()(const RecordedScene &added) {
    const auto files = filesOfSession(added.session, replay_.file_, progress_);
    if (!files) return tl::unexpected(files.error());
    const auto source = sourceOfSession(added.session, replay_.file_, *files, &session_.materials());
    if (!source) return tl::unexpected(source.error());
    const SharedScene scene = std::get<SharedScene>(source->front());
    if (auto built = session_.addBodies(simulator_, *scene, progress_); !built) return built;
    if (changes_) changes_->addScene(scene);
    return {};
  }
  Expected<void> operator()(const RecordedHash &expected) {
    if (!replay_.checksHashes_) return {};
    const auto hash = stateHash(table_, simulator_);
    if (!hash) return tl::unexpected(hash.error());
    if (*hash == expected.hash)
      ++replay_.equalHashes_;
    else
      replay_.difference_ = fmt::format(
          "{}: the replay differs from the recording at step {}, t = {} s: the state hash is {:016x}, and {:016x} was "
          "recorded",
          pathText(replay_.file_), expected.steps, formatNumber(expected.time_s), *hash, expected.hash);
    return {};
  }

 private:
  Replay &replay_;
  Session &session_;
  c3de_object *simulator_;
  const c3de_simulator_v1 *table_;
  ChangeLog *changes_;
  const ProgressFn &progress_;
};

Replay::Replay(Recording recording, std::filesystem::path file, bool checksHashes)
    : recording_(std::move(recording)), file_(std::move(file)), checksHashes_(checksHashes) {
  if (const RecordedHash *last = recording_.lastHash()) planned_ = last->made;
}

Expected<void> Replay::checkSimulator(const SimulatorIdentity &identity) const {
  const SimulatorIdentity &recorded = recording_.start.simulator;
  if (identity.plugin == recorded.plugin && identity.version == recorded.version) return {};
  return fail(ErrorCode::plugin,
              fmt::format("{}: was recorded with {} {}; loaded is {} {}", pathText(file_), displayText(recorded.plugin),
                          displayText(recorded.version), identity.plugin, identity.version));
}

double Replay::fraction() const {
  return planned_ > 0 ? std::min(1.0, static_cast<double>(made_) / static_cast<double>(planned_)) : 0.0;
}

void Replay::goTo(const Position &position) {
  next_ = position.next;
  made_ = position.made;
  difference_.clear();
}

void Replay::passDifference() {
  difference_.clear();
  ++next_;
}

Expected<void> Replay::applyDueEvents(Session &session, c3de_object *simulator, const c3de_simulator_v1 *table,
                                      const std::shared_ptr<ChangeLog> &changes, const ProgressFn &progress) {
  Applier applier(*this, session, simulator, table, changes.get(), progress);
  while (!isAtEnd()) {
    const auto status = simulatorStatus(table, simulator);
    if (!status) return tl::unexpected(status.error());
    if (status->steps < nextStep()) return {};
    const std::string place = fmt::format("{}: at step {}", pathText(file_), nextStep());
    if (status->steps > nextStep())
      return fail(ErrorCode::input,
                  fmt::format("{}: cannot be repeated, as the simulation is at step {}", place, status->steps));
    const auto applied = std::visit(applier, recording_.events[next_]);
    if (!applied) return fail(applied.error().code, place + ": " + applied.error().message);
    if (difference_.empty()) ++next_;
  }
  return {};
}

}  // namespace c3de::session
