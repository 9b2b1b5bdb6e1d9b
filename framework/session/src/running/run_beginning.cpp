// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/run_beginning.h"

#include <utility>

#include "c3de/core/input_file.h"
#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/session/file_kind.h"

namespace c3de::session {
namespace {

/// @param first  first scene of the session that is continued; null: none
Expected<scene::SceneFile> readScene(const RunOptions &options, const scene::SceneFile *first,
                                     const scene::MaterialLibrary &materials, const geometry::MeshFormats &formats) {
  Expected<scene::SceneFile> scene;
  if (first != nullptr) {
    scene = *first;
  } else if (!options.sceneText.empty()) {
    scene = scene::parseScene(options.sceneText, options.scene, &materials);
  } else if (scene::isScenePath(options.scene)) {
    scene = scene::loadScene(options.scene, &materials);
  } else {
    if (const auto good = checkInputFile(options.scene); !good)
      return fail(ErrorCode::input, good.error().message + "; accepted: a scene (.toml), a session (.c3de) or a mesh");
    if (const FileKind kind = kindOf(options.scene, &formats); kind == FileKind::unknown || kind == FileKind::recording)
      return tl::unexpected(unknownKind(options.scene, &formats));
    else if (kind == FileKind::image)
      return fail(ErrorCode::input, options.scene.string() +
                                        ": is an image; accepted: a mesh, or a scene (.toml) whose [[body]] "
                                        "names it as its volume, with a label or a threshold");
    geometry::LengthUnit unit = formats.unitInFile(options.scene).value_or(geometry::LengthUnit::millimetre);
    if (!options.meshUnit.empty()) {
      const auto stated = scene::parseLengthUnit(options.meshUnit);
      if (!stated) return fail(ErrorCode::usage, "--unit: " + stated.error().message);
      unit = *stated;
    }
    scene = scene::sceneForMesh(options.scene, unit);
  }
  for (const std::string &assignment : options.overrides) {
    if (!scene) break;
    if (auto applied = scene::applyOverride(*scene, assignment, &materials); !applied)
      return tl::unexpected(applied.error());
  }
  return scene;
}

}  // namespace

Expected<RunBeginning> readBeginning(const RunOptions &options, Session &session, const ProgressFn &progress) {
  RunBeginning beginning;
  if (options.isReplay) {
    auto recording = readRecording(options.scene);
    if (!recording) return tl::unexpected(recording.error());
    if (recording->start.session.scenes.empty())
      return fail(ErrorCode::input, pathText(options.scene) + ": " + kNothingToReplay);
    if (const std::string text = recording->whyIncomplete(); !text.empty())
      log(LogLevel::warn, pathText(options.scene) + ": the recording " + text);
    beginning.saved = recording->start.session;
    beginning.replay = std::make_unique<Replay>(std::move(*recording), options.scene, options.checkHashes);
  } else if (isSessionPath(options.scene)) {
    if (!options.fromState.empty())
      return fail(ErrorCode::usage, "--from-state is for scenes: a session has its own state");
    auto read = readSession(options.scene, EmbeddedContent::stays);
    if (!read) return tl::unexpected(read.error());
    beginning.saved = std::move(*read);
  } else if (!options.search.empty()) {
    return fail(ErrorCode::usage, "--search is for sessions (.c3de)");
  }
  if (beginning.saved) {
    auto files = filesOfSession(*beginning.saved, options.scene, progress, {{}, options.search});
    if (!files) return tl::unexpected(files.error());
    beginning.files = std::move(*files);
    auto source = sourceOfSession(*beginning.saved, options.scene, beginning.files, &session.materials());
    if (!source) return tl::unexpected(source.error());
    beginning.source = std::move(*source);
  } else {
    beginning.source.emplace_back(SharedScene());
  }
  auto scene = readScene(options, std::get<SharedScene>(beginning.source.front()).get(), session.materials(),
                         session.meshFormats());
  if (!scene) return tl::unexpected(scene.error());
  beginning.source.front() = std::make_shared<const scene::SceneFile>(std::move(*scene));
  return beginning;
}

}  // namespace c3de::session
