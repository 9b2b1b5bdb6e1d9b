// SPDX-License-Identifier: Apache-2.0
// Report, events, states and sessions.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "c3de/core/file_path.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/recorder.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/simulation_state.h"
#include "c3de/session/tissue_motion.h"
#include "use.h"

namespace c3de::embed {

Result<std::string> EmbeddedSimulation::simulatorReport() {
  std::string text;
  if (const c3de_status code = table_->report(simulator_->get(), scene::sinkInto(text)); code < 0)
    return tl::unexpected(reason("the simulator gives no report", code));
  return text;
}

Result<const char *> EmbeddedSimulation::events() {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  if (events_) return events_->c_str();
  const auto text = simulatorReport();
  if (!text) return tl::unexpected(text.error());
  const auto json = nlohmann::ordered_json::parse(*text, nullptr, false);
  const auto found = json.is_object() ? json.find("events") : json.end();
  events_ = found != json.end() && found->is_array()
                ? found->dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                : "[]";
  return events_->c_str();
}

Result<const char *> EmbeddedSimulation::report() {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  if (report_) return report_->c_str();
  const auto text = simulatorReport();
  if (!text) return tl::unexpected(text.error());
  const auto hash = session::stateHash(table_, simulator_->get());
  if (!hash) return refuse(hash.error());
  session::RunFacts facts = facts_;
  facts.outcome = status_.stopped > 0 ? "diverged" : "done";
  facts.steps = status_.steps;
  facts.time_s = status_.time_s;
  facts.dt_s = status_.dt_s;
  facts.stateHash = *hash;
  if (auto motions = session::tissueMotions(table_, simulator_->get(), facts.prepared.tissues))
    facts.tissues = std::move(*motions);
  auto json = session::reportJson(facts, *text);
  if (!json) return refuse(json.error());
  report_ = std::move(*json);
  return report_->c_str();
}

Result<void> EmbeddedSimulation::saveState(const std::filesystem::path &file) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  const auto bytes = session::stateBytes(*session_, simulator_->get(), identity_);
  if (!bytes) return refuse(bytes.error());
  if (const auto written = writeWholeFile(file, *bytes); !written) return refuse(written.error());
  return {};
}

Result<void> EmbeddedSimulation::loadState(const std::filesystem::path &file) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  const auto bytes = session::readStateFile(file);
  if (!bytes) return refuse(bytes.error());
  const auto restored = session::goToState(*session_, simulator_->get(), identity_, *bytes, pathText(file));
  stateChanged();
  if (!restored) return refuse(restored.error());
  if (recorder_) recorder_->addState(status_.steps, *bytes);
  return readStatus();
}

Result<void> EmbeddedSimulation::saveSession(const std::filesystem::path &file) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  const auto captured = session::captureState(*session_, simulator_->get(), identity_, session_->changes()->source());
  if (!captured) return refuse(captured.error());
  session::FileReferences references;
  const auto saved = session::sessionOf(*captured, absolutePath(file).parent_path(), references);
  if (!saved) return refuse(saved.error());
  if (const auto written = session::writeSession(*saved, file); !written) return refuse(written.error());
  return {};
}

}  // namespace c3de::embed
