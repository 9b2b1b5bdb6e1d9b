// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/saved_session.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/session/simulation_state.h"
#include "c3de/session/simulator_access.h"
#include "files/mask_bytes.h"

namespace c3de::session {
namespace {

constexpr const char *kMasks = "masks/";

/// Two forms of one path compare equal.
std::filesystem::path comparable(const std::filesystem::path &path) {
  return std::filesystem::absolute(path).lexically_normal();
}

std::string utcNow() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now())); }

}  // namespace

std::vector<std::filesystem::path *> filesOf(scene::SceneFile &scene) {
  std::vector<std::filesystem::path *> all;
  const auto add = [&](std::filesystem::path &file) {
    if (!file.empty()) all.push_back(&file);
  };
  for (scene::SceneBody &body : scene.bodies) {
    add(body.mesh);
    add(body.volume.file);
    if (body.volume.background) add(body.volume.background->image);
    for (scene::SceneTissue &tissue : body.volume.tissues)
      if (tissue.rule) add(tissue.rule->image);
  }
  for (scene::SceneObstacle &obstacle : scene.obstacles) add(obstacle.mesh);
  if (scene.image) {
    add(scene.image->file);
    for (std::filesystem::path &labels : scene.image->labels) add(labels);
  }
  return all;
}

std::optional<FileStamp> stampOf(const std::filesystem::path &path) {
  FileStamp stamp;
  std::error_code code;
  const auto add = [&](const std::filesystem::path &file) {
    ++stamp.files;
    stamp.bytes += std::filesystem::file_size(file, code);
    if (!code) stamp.changed = std::max(stamp.changed, std::filesystem::last_write_time(file, code));
  };
  if (std::filesystem::is_regular_file(path, code)) {
    add(path);
  } else {
    std::filesystem::recursive_directory_iterator at(path, code), end;
    for (; !code && at != end; at.increment(code))
      if (at->is_regular_file(code)) add(at->path());
  }
  return code ? std::nullopt : std::optional(stamp);
}

Expected<ReferencedFile> FileReferences::of(const std::filesystem::path &file, const std::filesystem::path &folder,
                                            const ProgressFn &progress) {
  const std::filesystem::path path = comparable(file);
  const std::optional<FileStamp> stamp = stampOf(path);
  const auto known = known_.find(path);
  if (stamp && known != known_.end() && known->second.stamp == *stamp) {
    ReferencedFile reference = known->second.reference;
    reference.path = referencePath(path, folder);
    return reference;
  }
  auto reference = referenceTo(path, folder, progress);
  if (reference && stamp) known_.insert_or_assign(path, Known{*stamp, *reference});
  return reference;
}

std::vector<std::filesystem::path> FileReferences::changedSince(std::filesystem::file_time_type time) const {
  std::vector<std::filesystem::path> changed;
  for (const auto &[path, known] : known_)
    if (known.stamp.changed > time) changed.push_back(path);
  return changed;
}

Expected<CapturedState> captureState(Session &session, c3de_object *simulator, const SimulatorIdentity &identity,
                                     SimulationSource source) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  CapturedState captured{std::move(source), identity, {}, {}, 0, 0.0};
  auto state = stateBytes(session, simulator, identity);
  if (!state) return tl::unexpected(state.error());
  captured.state = std::move(*state);
  const auto hash = stateHash(*table, simulator);
  if (!hash) return tl::unexpected(hash.error());
  captured.hash = *hash;
  if (const auto status = simulatorStatus(*table, simulator)) {
    captured.steps = status->steps;
    captured.time_s = status->time_s;
  }
  return captured;
}

Expected<CapturedState> captureState(Session &session, c3de_object *simulator, const SimulatorIdentity &identity,
                                     const ChangeLog &changes) {
  constexpr int kTries = 3;
  for (int i = 0; i < kTries; ++i) {
    if (changes.isAdding()) return fail(ErrorCode::state, "bodies are being added; save when they are complete");
    const std::uint64_t before = changes.count();
    auto captured = captureState(session, simulator, identity, changes.source());
    if (!captured || (changes.count() == before && !changes.isAdding())) return captured;
  }
  return fail(ErrorCode::state, "the simulation is being changed; save again after that");
}

namespace {

/// Adds a scene as text, its masks as members and its files.
Expected<void> addScene(const scene::SceneFile &scene, const std::filesystem::path &folder, FileReferences &references,
                        const ProgressFn &progress, SessionFile &saved) {
  const auto nameOfMask = [&saved](const scene::SceneBody &body) {
    const std::string name = fmt::format("{}{}.mask", kMasks, saved.members.size() + 1);
    saved.members.emplace(name, maskBytes(*body.volume.mask, body.volume.colour));
    return name;
  };
  auto text = scene::sceneText(scene, folder, nameOfMask);
  if (!text) return tl::unexpected(text.error());
  saved.scenes.push_back(std::move(*text));
  scene::SceneFile named = scene;
  for (const std::filesystem::path *file : filesOf(named)) {
    auto reference = references.of(*file, folder, progress);
    if (!reference) return tl::unexpected(reference.error());
    if (std::none_of(saved.files.begin(), saved.files.end(),
                     [&](const ReferencedFile &one) { return one.path == reference->path; }))
      saved.files.push_back(std::move(*reference));
  }
  return {};
}

}  // namespace

Expected<SessionFile> sessionOf(const CapturedState &captured, const std::filesystem::path &folder,
                                FileReferences &references, const ProgressFn &progress) {
  SessionFile saved;
  saved.program = "C3DE " C3DE_VERSION;
  saved.savedAt = utcNow();
  saved.simulatorClass = captured.identity.classId;
  for (const auto &entry : captured.source) {
    if (const auto *change = std::get_if<SimulationChange>(&entry)) {
      saved.changes.push_back(
          {change->id, change->key, change->text, change->flags, saved.scenes.size(), change->bytes});
      continue;
    }
    scene::SceneFile scene = *std::get<SharedScene>(entry);
    if (saved.scenes.empty()) {
      saved.title = scene.title;
      scene.simulatorClass = captured.identity.classId;
    }
    if (auto added = addScene(scene, folder, references, progress, saved); !added) return tl::unexpected(added.error());
  }
  std::sort(saved.files.begin(), saved.files.end(),
            [](const ReferencedFile &a, const ReferencedFile &b) { return a.path < b.path; });
  saved.state = captured.state;
  saved.stateHash = captured.hash;
  saved.steps = captured.steps;
  saved.time_s = captured.time_s;
  return saved;
}

namespace {

/// The mask of a body whose volume file is a member of the session.
Expected<void> restoreMask(const SessionFile &saved, const std::filesystem::path &file, scene::SceneVolume &volume) {
  if (volume.file.empty()) return {};
  const std::string name = referencePath(volume.file, std::filesystem::absolute(file).parent_path());
  const auto member = name.starts_with(kMasks) ? saved.members.find(name) : saved.members.end();
  if (member == saved.members.end()) return {};
  auto picked = maskOfBytes(member->second);
  if (!picked)
    return fail(ErrorCode::input, fmt::format("{}: is damaged: {} {}", pathText(file), name, picked.error().message));
  volume.mask = std::make_shared<const imaging::Mask>(std::move(picked->mask));
  volume.colour = picked->colour;
  volume.file.clear();
  volume.label.reset();
  return {};
}

}  // namespace

Expected<std::vector<FoundFile>> filesOfSession(const SessionFile &saved, const std::filesystem::path &file,
                                                const ProgressFn &progress,
                                                const std::map<std::string, std::filesystem::path> &instead) {
  auto found = findFiles(saved, std::filesystem::absolute(file).parent_path(), progress);
  if (!found) return found;
  std::string problems;
  for (FoundFile &one : *found) {
    if (const auto given = instead.find(one.file.path); given != instead.end()) {
      const auto hash = sha256Of(given->second, progress);
      if (!hash) return tl::unexpected(hash.error());
      one.at = given->second;
      one.state = *hash == one.file.sha256 ? FoundFile::State::same : FoundFile::State::changed;
    }
    if (one.file.isEmbedded) problems += "\n  " + one.file.path + ": is embedded, which this version does not read";
    if (one.state == FoundFile::State::missing) problems += "\n  " + one.file.path + ": is missing";
    if (one.state == FoundFile::State::changed) problems += "\n  " + pathText(one.at) + ": has changed since";
  }
  if (!problems.empty())
    return fail(ErrorCode::input, pathText(file) + ": files were not found or have changed since " + saved.savedAt +
                                      "; restore them, or copy them to the folder of the session" + problems);
  return found;
}

Expected<SimulationSource> sourceOfSession(const SessionFile &saved, const std::filesystem::path &file,
                                           const std::vector<FoundFile> &files,
                                           const scene::MaterialLibrary *materials) {
  if (saved.scenes.empty()) return fail(ErrorCode::input, pathText(file) + ": the session has no scene");
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  SimulationSource source;
  auto change = saved.changes.begin();
  for (std::size_t i = 0; i < saved.scenes.size(); ++i) {
    auto scene = scene::parseScene(saved.scenes[i], file, materials, false);
    if (!scene) return tl::unexpected(scene.error());
    for (scene::SceneBody &body : scene->bodies)
      if (auto restored = restoreMask(saved, file, body.volume); !restored) return tl::unexpected(restored.error());
    for (std::filesystem::path *named : filesOf(*scene))
      for (const FoundFile &one : files)
        if (referencePath(*named, folder) == one.file.path) *named = one.at;
    if (i == 0) {
      for (const std::string &assignment : saved.overrides)
        if (auto applied = scene::applyOverride(*scene, assignment, materials); !applied)
          return tl::unexpected(applied.error());
      scene->simulatorClass = saved.simulatorClass;
    }
    source.emplace_back(std::make_shared<const scene::SceneFile>(std::move(*scene)));
    for (; change != saved.changes.end() && change->scenes == i + 1; ++change)
      source.emplace_back(SimulationChange{change->id, change->key, change->text, change->flags, 0, change->bytes});
  }
  return source;
}

Expected<void> buildRemaining(Session &session, c3de_object *simulator, const SimulationSource &source,
                              const ProgressFn &progress, Prepared *prepared) {
  for (std::size_t i = 1; i < source.size(); ++i) {
    Expected<void> built;
    if (const auto *change = std::get_if<SimulationChange>(&source[i]))
      built = applyChange(simulator, *change, [&session] { return session.plugins().takeError(); });
    else
      built = session.addBodies(simulator, *std::get<SharedScene>(source[i]), progress, prepared);
    if (!built) return built;
  }
  return {};
}

Expected<void> restoreSession(Session &session, c3de_object *simulator, const SimulatorIdentity &identity,
                              const SessionFile &saved, const std::filesystem::path &file) {
  if (saved.state.empty()) return {};
  if (auto restored = goToState(session, simulator, identity, saved.state, pathText(file)); !restored) return restored;
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  const auto hash = stateHash(*table, simulator);
  if (!hash) return tl::unexpected(hash.error());
  if (saved.stateHash && *hash != *saved.stateHash)
    return fail(ErrorCode::internal, fmt::format("{}: the state hash is {:016x}, and {:016x} was saved", pathText(file),
                                                 *hash, *saved.stateHash));
  return {};
}

}  // namespace c3de::session
