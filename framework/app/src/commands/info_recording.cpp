// SPDX-License-Identifier: Apache-2.0
#include "commands/info_recording.h"

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <variant>

#include "c3de/core/file_path.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/session/problem_report.h"
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

std::string memberOf(const SessionFile &session, const char *name) {
  const auto found = session.members.find(name);
  return found == session.members.end() ? std::string() : found->second;
}

/// A report about a problem: the text of the user and the versions.
Json reportJson(const SessionFile &session) {
  Json versions = Json::parse(memberOf(session, kReportVersions), nullptr, false);
  if (versions.is_discarded()) versions = nullptr;
  return Json{{"description", memberOf(session, kReportText)},
              {"versions", std::move(versions)},
              {"values", memberOf(session, kReportValues)},
              {"log", memberOf(session, kReportLog)}};
}

std::string reportText(const SessionFile &session) {
  const auto shown = [&session](const char *name) { return displayText(memberOf(session, name), Lines::many); };
  const std::string described = shown(kReportText);
  return "report: " + (described.empty() ? std::string("(no text)") : described) + "\nversions:\n" +
         shown(kReportVersions) + "\nvalues:\n" + shown(kReportValues) + "log:\n" + shown(kReportLog);
}

Described describeReport(const SessionFile &session, const std::filesystem::path &file) {
  return {fmt::format("report without a simulation, saved {} by {}\n", displayText(session.savedAt),
                      displayText(session.program)) +
              reportText(session),
          Json{{"kind", "report"},
               {"file", file.string()},
               {"program", session.program},
               {"saved", session.savedAt},
               {"report", reportJson(session)}}};
}

}  // namespace

Expected<std::string> describeFiles(const SessionFile &saved, const std::filesystem::path &file,
                                    const std::vector<std::filesystem::path> &search, Json &json) {
  auto found = findFiles(saved, absolutePath(file).parent_path());
  if (!found) return tl::unexpected(found.error());
  std::vector<std::string> unread;
  for (const std::filesystem::path &folder : search)
    if (const auto searched = searchFolder(folder, *found, {}, &unread); !searched)
      return tl::unexpected(searched.error());
  std::string text;
  Json &list = json["files"] = Json::array();
  for (const FoundFile &one : *found) {
    const char *state = one.file.isEmbedded                      ? "embedded"
                        : one.state == FoundFile::State::same    ? "same"
                        : one.state == FoundFile::State::changed ? "changed"
                                                                 : "missing";
    const std::string place = one.at.empty() ? std::string() : pathText(normalPath(one.at));
    const bool isElsewhere = !search.empty() && !place.empty();
    text += fmt::format("  {}: {}{}\n", displayText(one.file.path), state, isElsewhere ? ", at " + place : "");
    list.push_back(
        Json{{"path", one.file.path}, {"bytes", one.file.bytes}, {"sha256", one.file.sha256}, {"state", state}});
    if (!place.empty()) list.back()["at"] = place;
  }
  if (!unread.empty()) json["unread_folders"] = unread;
  for (const std::string &one : unread)
    text += fmt::format("  folder that could not be searched: {}\n", displayText(one));
  return text;
}

Expected<Described> describeRecording(const std::filesystem::path &file,
                                      const std::vector<std::filesystem::path> &search) {
  const auto recording = readRecording(file);
  if (!recording) return tl::unexpected(recording.error());
  Counts counts;
  for (const RecordedEvent &event : recording->events) std::visit(counts, event);
  const SessionFile &start = recording->start.session;
  const SimulatorIdentity &simulator = recording->start.simulator;
  const RecordedHash *last = recording->lastHash();
  const std::uint64_t made = last ? last->made : 0;
  const double end_s = last ? last->time_s : start.time_s;

  Json files;
  const auto fileLines = describeFiles(start, file, search, files);
  if (!fileLines) return tl::unexpected(fileLines.error());
  const bool isReport = start.members.contains(kReportVersions);
  if (start.scenes.empty()) return describeReport(start, file);
  std::string text = fmt::format("recording of \"{}\", begun {} by {}, with {} {}\n", displayText(start.title),
                                 displayText(start.savedAt), displayText(start.program), displayText(simulator.plugin),
                                 displayText(simulator.version));
  text += fmt::format("begins at step {}, t = {} s; {} steps, to t = {} s\n", start.steps, formatNumber(start.time_s),
                      made, formatNumber(end_s));
  text += fmt::format("state hashes: {}, every {} steps and at the end\n", counts.hashes, recording->start.hashEvery);
  text += countLines(counts);
  if (!recording->isComplete()) text += recording->whyIncomplete() + "\n";
  text += *fileLines;
  if (isReport) text += reportText(start);

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
  json.update(files);
  if (isReport) json["report"] = reportJson(start);
  if (last) json["state_hash"] = fmt::format("{:016x}", last->hash);
  return Described{text, json};
}

}  // namespace c3de::app
