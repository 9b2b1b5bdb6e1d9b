// SPDX-License-Identifier: Apache-2.0
#include "commands/info_recording.h"

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <variant>

#include "c3de/core/text.h"
#include "c3de/session/recording_file.h"

namespace c3de::app {
namespace {

using Json = nlohmann::ordered_json;

struct Counts {
  std::map<std::string, std::uint64_t> changes;  ///< by id
  std::uint64_t resets = 0, states = 0, scenes = 0, hashes = 0;

  void operator()(const SimulationChange &change) { ++changes[change.id]; }
  void operator()(const RecordedReset &) { ++resets; }
  void operator()(const RecordedState &) { ++states; }
  void operator()(const RecordedScene &) { ++scenes; }
  void operator()(const RecordedHash &) { ++hashes; }
};

std::string countLines(const Counts &counts) {
  std::string text;
  const auto add = [&](const std::string &what, std::uint64_t n) {
    if (n > 0) text += fmt::format("  {}: {}\n", what, n);
  };
  for (const auto &[id, n] : counts.changes) add("change " + displayText(id), n);
  add("resets", counts.resets);
  add("loaded states", counts.states);
  add("added scenes", counts.scenes);
  return text;
}

}  // namespace

Expected<Described> describeRecording(const std::filesystem::path &file) {
  const auto recording = readRecording(file);
  if (!recording) return tl::unexpected(recording.error());
  Counts counts;
  for (const RecordedEvent &event : recording->events) std::visit(counts, event);
  const SessionFile &start = recording->start.session;
  const SimulatorIdentity &simulator = recording->start.simulator;
  const RecordedHash *last = recording->lastHash();
  const std::uint64_t made = last ? last->made : 0;
  const double end_s = last ? last->time_s : start.time_s;

  std::string text = fmt::format("recording of \"{}\", begun {} by {}, with {} {}\n", displayText(start.title),
                                 displayText(start.savedAt), displayText(start.program), displayText(simulator.plugin),
                                 displayText(simulator.version));
  text += fmt::format("begins at step {}, t = {} s; {} steps, to t = {} s\n", start.steps, formatNumber(start.time_s),
                      made, formatNumber(end_s));
  text += fmt::format("state hashes: {}, every {} steps and at the end\n", counts.hashes, recording->start.hashEvery);
  text += countLines(counts);
  if (!recording->isComplete()) text += recording->whyIncomplete() + "\n";

  Json json{{"kind", "recording"},
            {"file", file.string()},
            {"title", start.title},
            {"program", start.program},
            {"begun", start.savedAt},
            {"simulator", simulator.classId},
            {"plugin", simulator.plugin},
            {"plugin_version", simulator.version},
            {"begins_at", Json{{"steps", start.steps}, {"time_s", start.time_s}}},
            {"steps", made},
            {"time_s", end_s},
            {"changes", Json::object()},
            {"resets", counts.resets},
            {"loaded_states", counts.states},
            {"added_scenes", counts.scenes},
            {"hashes", counts.hashes},
            {"hash_every", recording->start.hashEvery},
            {"complete", recording->isComplete()}};
  for (const auto &[id, n] : counts.changes) json["changes"][id] = n;
  if (last) json["state_hash"] = fmt::format("{:016x}", last->hash);
  return Described{text, json};
}

}  // namespace c3de::app
