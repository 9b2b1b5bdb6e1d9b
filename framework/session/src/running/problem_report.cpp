// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/problem_report.h"
#include "c3de/core/file_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"

namespace c3de::session {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShortestUser = 3;

std::vector<std::string> homeFolders() {
  std::vector<std::string> all;
  for (const std::string &one :
       {pathText(homeDirectory()), environmentVariable("HOME"), environmentVariable("USERPROFILE")})
    if (one.size() > 1 && std::find(all.begin(), all.end(), one) == all.end()) all.push_back(one);
  return all;
}

/// Of system accounts, the names are ordinary words.
std::string userName() {
  for (const char *variable : {"USER", "USERNAME", "LOGNAME"})
    if (const std::string name = environmentVariable(variable); name.size() >= kShortestUser && name != "root")
      return name;
  return {};
}

bool isLetter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) > 127;
}

void replaceAll(std::string &text, const std::string &from, const char *to, bool isWord) {
  const std::size_t size = std::char_traits<char>::length(to);
  for (std::size_t at = 0; !from.empty() && (at = text.find(from, at)) != std::string::npos;) {
    const std::size_t end = at + from.size();
    if (isWord && ((at > 0 && isLetter(text[at - 1])) || (end < text.size() && isLetter(text[end])))) {
      at = end;
      continue;
    }
    text.replace(at, from.size(), to);
    at += size;
  }
}

bool namesHome(const std::string &bytes) {
  const std::vector<std::string> homes = homeFolders();
  return std::any_of(homes.begin(), homes.end(),
                     [&](const std::string &home) { return bytes.find(home) != std::string::npos; });
}

/// Of an image format whose header has no names of patients.
bool isPlainImage(const fs::path &file) {
  const std::string name = pathText(file.filename());
  constexpr std::array kEndings{".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd"};
  std::error_code code;
  return fs::is_regular_file(file, code) &&
         std::any_of(kEndings.begin(), kEndings.end(), [&name](const char *ending) { return name.ends_with(ending); });
}

bool isMadeFromImage(const scene::SceneBody &body) {
  const scene::SceneVolume &volume = body.volume;
  const bool hasRule = std::any_of(volume.tissues.begin(), volume.tissues.end(),
                                   [](const scene::SceneTissue &tissue) { return tissue.rule.has_value(); });
  return volume.threshold || volume.background || hasRule || (!volume.file.empty() && !isPlainImage(volume.file));
}

Expected<void> checkChange(const std::string &text, const std::string &bytes) {
  if (!namesHome(bytes)) return {};
  return fail(ErrorCode::state, fmt::format("the change '{}' names a file in your home folder; open the files from "
                                            "another folder, or save the report without a simulation",
                                            text));
}

/// Events as they are written. Texts lose personal data; data that cannot be changed must have none.
Expected<void> removePersonalData(SimulationChange &change) {
  change.text = withoutPersonalData(std::move(change.text));
  return checkChange(change.text, change.key + change.bytes);
}

/// Names of bodies stay: states and changes refer to them.
Expected<void> removePersonalData(SimulationSource &source) {
  for (auto &entry : source) {
    if (auto *change = std::get_if<SimulationChange>(&entry)) {
      if (auto good = removePersonalData(*change); !good) return good;
      continue;
    }
    SharedScene &shared = std::get<SharedScene>(entry);
    scene::SceneFile scene = *shared;
    scene.title = withoutPersonalData(std::move(scene.title));
    shared = std::make_shared<const scene::SceneFile>(std::move(scene));
  }
  return {};
}

/// The recorded events, completed with an end.
Expected<Recording> readPast(const ReportedPast &past) {
  auto recording = readRecording(past.recording);
  if (!recording) return recording;
  for (RecordedEvent &event : recording->events)
    if (auto *change = std::get_if<SimulationChange>(&event))
      if (auto good = removePersonalData(*change); !good) return tl::unexpected(good.error());
  if (recording->isComplete() || recording->events.empty()) return recording;
  if (const auto *last = std::get_if<RecordedHash>(&recording->events.back())) {
    RecordedEnd end;
    static_cast<RecordedHash &>(end) = *last;
    recording->events.back() = end;
  }
  return recording;
}

}  // namespace

std::string withoutPersonalData(std::string text) {
  for (const std::string &home : homeFolders()) replaceAll(text, home, "~", false);
  replaceAll(text, userName(), "USER", true);
  return text;
}

bool needsImage(const SimulationSource &source) {
  return std::any_of(source.begin(), source.end(), [](const auto &entry) {
    const auto *scene = std::get_if<SharedScene>(&entry);
    return scene != nullptr && std::any_of((*scene)->bodies.begin(), (*scene)->bodies.end(), isMadeFromImage);
  });
}

SimulationSource withoutImages(const SimulationSource &source) {
  SimulationSource out = source;
  for (auto &entry : out)
    if (auto *shared = std::get_if<SharedScene>(&entry); shared != nullptr && (*shared)->image) {
      scene::SceneFile scene = **shared;
      scene.image.reset();
      *shared = std::make_shared<const scene::SceneFile>(std::move(scene));
    }
  return out;
}

Expected<void> writeProblemReport(const ProblemReport &report, const fs::path &file, const ProgressFn &progress) {
  RecordingStart start;
  std::vector<RecordedEvent> events;
  if (report.past) {
    CapturedState captured = report.past->start;
    if (!report.hasImage && needsImage(captured.source))
      return fail(ErrorCode::state,
                  "the bodies are made from the image; check With the image, or close the simulation");
    if (!report.hasImage) captured.source = withoutImages(captured.source);
    if (auto good = removePersonalData(captured.source); !good) return good;
    auto recording = readPast(*report.past);
    if (!recording) return tl::unexpected(recording.error());
    FileReferences references;
    auto saved = sessionOf(captured, absolutePath(file).parent_path(), references, progress, Embedding::all);
    if (!saved) return tl::unexpected(saved.error());
    start.simulator = captured.identity;
    start.simulator.label.clear();
    start.hashEvery = recording->start.hashEvery;
    start.session = std::move(*saved);
    events = std::move(recording->events);
  } else {
    start.session.program = "C3DE " C3DE_VERSION;
    start.session.savedAt = savedNow();
  }
  SessionFile &session = start.session;
  for (const auto &[name, text] : {std::pair(kReportText, &report.description),
                                   {kReportVersions, &report.versions},
                                   {kReportValues, &report.values},
                                   {kReportLog, &report.log}})
    session.members.insert_or_assign(name, withoutPersonalData(*text));
  auto out = OutputFile::open(file, Durability::strict);
  if (!out) return tl::unexpected(out.error());
  const auto written = writeRecordingStart(
      start,
      [&out](std::string_view piece) {
        out->write(piece);
        return Expected<void>();
      },
      progress);
  if (!written) return written;
  for (const RecordedEvent &event : events) {
    const auto bytes = recordingBytes(event);
    if (!bytes) return tl::unexpected(bytes.error());
    out->write(*bytes);
  }
  return out->commit();
}

}  // namespace c3de::session
