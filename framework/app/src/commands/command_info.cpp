// SPDX-License-Identifier: Apache-2.0
// `c3de info`
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/session/file_kind.h"
#include "c3de/session/landmark_file.h"
#include "c3de/session/session_file.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/info_image.h"
#include "commands/info_recording.h"
#include "commands/info_scene.h"
#include "commands/last_crash.h"
#include "commands/standard_output.h"
#include "commands/standard_streams.h"

namespace c3de::app {
namespace {

using Json = nlohmann::ordered_json;

struct InfoArguments {
  std::string series;         ///< of a folder of images with several; empty: the only one, or a list of them
  std::size_t time = 0;       ///< of images of several time points
  bool patientNames = false;  ///< whether the names of patients are shown
  std::string reader;         ///< of meshes: the reader of a plugin; empty: by the extension
  bool isQuick = false;       ///< bodies of scenes are not built: checks that require this are omitted
  std::vector<std::filesystem::path> search{};  ///< folders with files of sessions that have moved
};

/// @param formats  null: no plugin is needed
Expected<Described> describeMesh(const std::filesystem::path &file, const std::string &unitText,
                                 const geometry::MeshFormats *formats, const std::string &reader) {
  std::optional<geometry::LengthUnit> unit;
  if (!unitText.empty()) {
    const auto stated = scene::parseLengthUnit(unitText);
    if (!stated) return fail(ErrorCode::usage, "--unit: " + stated.error().message);
    unit = *stated;
  }
  const auto loaded = formats ? formats->load(file, unit, {}, reader) : geometry::loadMesh(file, unit);
  if (!loaded) return tl::unexpected(loaded.error());
  Described out;
  out.json = Json::parse(loaded->report.json(), nullptr, false);
  if (!out.json.is_object()) out.json = Json::object();
  out.json["file"] = file.string();
  out.json["kind"] = "mesh";
  out.text = loaded->report.text();
  const auto fillable = geometry::checkFillable(loaded->mesh, loaded->report);
  out.json["fillable"] = fillable.has_value();
  if (!fillable) {
    out.json["not_fillable_because"] = fillable.error().message;
    out.text += "\nnot fillable: " + fillable.error().message;
  }
  return out;
}

Expected<Described> describeLandmarks(const std::filesystem::path &file) {
  const auto landmarks = readLandmarks(file);
  if (!landmarks) return tl::unexpected(landmarks.error());
  std::string text = fmt::format("{} landmark{}, LPS\n", landmarks->size(), landmarks->size() == 1 ? "" : "s");
  Json json{{"kind", "landmarks"}, {"file", file.string()}, {"landmarks", Json::array()}};
  for (const FileLandmark &one : *landmarks) {
    text += fmt::format("  {}: {}, {}, {} mm\n", displayText(one.name), formatNumber(one.lps_mm[0]),
                        formatNumber(one.lps_mm[1]), formatNumber(one.lps_mm[2]));
    json["landmarks"].push_back(Json{{"name", one.name}, {"at_mm", one.lps_mm}});
  }
  return Described{text, json};
}

/// Scenes need plugins, and so do files that only a plugin may be able to read.
bool needsPlugins(const std::filesystem::path &file, const InfoArguments &arguments) {
  if (file == kStandardStream) return true;
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return false;
  const FileKind kind = kindOf(file);
  if (isLandmarkPath(file) && arguments.reader.empty()) return false;
  return kind == FileKind::scene || kind == FileKind::unknown || !arguments.reader.empty();
}

/// What a session contains, and which of its files are missing or have changed.
Expected<Described> describeSession(const std::filesystem::path &file,
                                    const std::vector<std::filesystem::path> &search) {
  const auto saved = readSession(file, EmbeddedContent::stays);
  if (!saved) return tl::unexpected(saved.error());
  Json files;
  const auto fileLines = describeFiles(*saved, file, search, files);
  if (!fileLines) return tl::unexpected(fileLines.error());
  const std::string hash = saved->stateHash ? fmt::format("{:016x}", *saved->stateHash) : std::string();
  std::string text = fmt::format("session of \"{}\", saved {} by {}\n", saved->title, saved->savedAt, saved->program);
  text += saved->state.empty() ? "state: the initial one\n"
                               : fmt::format("state: step {}, t = {} s, hash {}, {} bytes\n", saved->steps,
                                             formatNumber(saved->time_s), hash, saved->state.size());
  Json json{{"kind", "session"},         {"file", file.string()},   {"title", saved->title},
            {"program", saved->program}, {"saved", saved->savedAt}, {"simulator", saved->simulatorClass},
            {"steps", saved->steps},     {"time_s", saved->time_s}, {"state_hash", hash},
            {"changes", Json::array()}};
  for (const SavedChange &change : saved->changes) {
    text += fmt::format("  change: {}\n", displayText(change.text));
    json["changes"].push_back(Json{{"id", change.id}, {"text", change.text}});
  }
  text += *fileLines;
  json.update(files);
  return Described{text, json};
}

/// @param session  null if the file needs none
Expected<Described> describe(const std::filesystem::path &file, const InfoArguments &arguments, const CommandLine &line,
                             Session *session) {
  if (file == kStandardStream) {
    const auto text = readSceneFromInput();
    if (!text) return tl::unexpected(text.error());
    return describeScene(*session, kStandardInput, &*text, arguments.isQuick);
  }
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return fail(ErrorCode::input, file.string() + ": no such file");
  imaging::ReadOptions options;
  options.series = arguments.series;
  options.time = arguments.time;
  const geometry::MeshFormats *formats = session ? &session->meshFormats() : nullptr;
  if (isLandmarkPath(file) && arguments.reader.empty()) return describeLandmarks(file);
  switch (arguments.reader.empty() ? kindOf(file, formats) : FileKind::mesh) {
    case FileKind::image: return describeImage(file, options, arguments.patientNames);
    case FileKind::scene: return describeScene(*session, file, nullptr, arguments.isQuick);
    case FileKind::session: return describeSession(file, arguments.search);
    case FileKind::recording: return describeRecording(file, arguments.search);
    case FileKind::mesh: return describeMesh(file, line.unit, formats, arguments.reader);
    case FileKind::unknown: break;
  }
  return tl::unexpected(unknownKind(file, formats));
}

/// Describes the contents and problems of each file; continues after a file that is refused.
int showInfo(const InfoArguments &arguments, const CommandLine &line) {
  std::optional<CrashJournal> journal;
  std::unique_ptr<Session> session;
  ExitCode exitCode = kDone;
  Json list = Json::array();
  for (const std::string &file : line.files) {
    // Plugins are loaded only if they are needed.
    if (!session && needsPlugins(file, arguments)) {
      if (auto begun = beginJournal(line.sessionOptions())) journal.emplace(std::move(*begun));
      auto made = Session::create(line.sessionOptions());
      if (!made) return reportError(made.error());
      session = std::move(*made);
    }
    auto described = describe(file, arguments, line, session.get());
    const std::string name = file == kStandardStream ? kStandardInput : file;
    if (!described) {
      const ExitCode failed = reportError(described.error());
      if (exitCode == kDone) exitCode = failed;
      list.push_back(Json{{"file", name}, {"error", described.error().message}});
      continue;
    }
    list.push_back(std::move(described->json));
    if (line.json) continue;
    const std::string &text = described->text;
    printOut(name + "\n" + text + (text.empty() || text.back() == '\n' ? "" : "\n"));
  }
  if (line.json) {
    const Json &out = list.size() == 1 ? list.front() : list;
    printOut(out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  }
  return exitCode;
}

Handler declareInfo(CLI::App &app, CommandLine &line) {
  const auto arguments = std::make_shared<InfoArguments>();
  app.add_option(
         "FILE", line.files,
         "Meshes, images (DICOM, NIfTI, NRRD, MetaImage), folders of DICOM files, scenes, sessions, recordings and "
         "landmarks (.csv, .fcsv, .mrk.json); - reads a scene from standard input")
      ->required();
  app.add_option("--series", arguments->series,
                 "The series of a folder that holds several: its identifier, number or description, a part behind a #")
      ->type_name("ID");
  app.add_option("--time", arguments->time, "The time point of an image that holds several, from 0")
      ->check(CLI::Range(0LL, 1000000LL))
      ->type_name("N");
  app.add_flag("--patient-names", arguments->patientNames, "Show the names of patients, which are left out otherwise");
  app.add_option("--reader", arguments->reader, "Read meshes by this reader of a plugin, whatever their extension")
      ->type_name("ID");
  app.add_flag("--quick", arguments->isQuick, "Do not build the bodies of scenes; checks that need them are omitted");
  addSearch(app, arguments->search);
  app.add_flag("--json", line.json, "One object for one file, a list for several");
  addUnit(app, line);
  addSessionOptions(app, line);
  app.footer(
      "Examples:\n"
      "    c3de info scan.nii.gz labels.nii.gz\n"
      "    c3de info SCENE.toml --json\n"
      "    c3de info FILE.c3de --search FOLDER");
  return [arguments, &line] { return showInfo(*arguments, line); };
}

}  // namespace

const Command kInfoCommand{"info", "What a mesh, image, folder of images or scene contains, and what is wrong with it",
                           declareInfo};

}  // namespace c3de::app
