// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/saved_session.h"
#include "c3de/core/file_path.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <string>
#include <utility>

#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/core/plugin_call.h"
#include "c3de/core/text.h"
#include "c3de/session/embedded_files.h"
#include "c3de/session/simulation_state.h"
#include "c3de/session/simulator_access.h"
#include "files/embedded_names.h"
#include "files/file_hash.h"
#include "files/mask_bytes.h"

namespace c3de::session {
namespace {

namespace fs = std::filesystem;

constexpr const char *kMasks = "masks/", *kSelectionMask = "selection.mask";

/// Two forms of one path compare equal.
std::filesystem::path comparable(const std::filesystem::path &path) { return normalPath(absolutePath(path)); }

/// In the order of their paths.
void addOnce(ReferencedFile reference, SessionFile &saved) {
  const auto at = std::lower_bound(saved.files.begin(), saved.files.end(), reference.path,
                                   [](const ReferencedFile &one, const std::string &path) { return one.path < path; });
  if (at == saved.files.end() || at->path != reference.path) saved.files.insert(at, std::move(reference));
}

}  // namespace

std::string savedNow() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now())); }

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
  if (scene.match)
    for (std::filesystem::path *file :
         {&scene.match->surface, &scene.match->points, &scene.match->labels.file, &scene.match->landmarks})
      add(*file);
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

/// Makes members of a file or folder, and of what belongs to it, and gives the reference the name of its member.
Expected<void> embedFile(const fs::path &file, const fs::path &folder, FileReferences &references,
                         const ProgressFn &progress, ReferencedFile &reference, SessionFile &saved) {
  reference.path = genericPathText(comparable(file));
  reference.path = embeddedName(reference);
  reference.isEmbedded = true;
  std::error_code code;
  if (fs::is_directory(file, code)) {
    const auto content = contentOf(file);
    if (!content) return tl::unexpected(content.error());
    for (const fs::path &one : content->files) saved.embedded[reference.path + "/" + genericPathText(one)] = file / one;
    return {};
  }
  const auto others = filesBelongingTo(file, progress);
  if (!others) return tl::unexpected(others.error());
  std::vector<std::pair<ReferencedFile, fs::path>> belonging;
  std::set<std::string> lines;
  for (const fs::path &other : *others) {
    const fs::path relative = relativePath(comparable(other), comparable(file).parent_path());
    if (relative.empty() || *relative.begin() == "..")
      return fail(ErrorCode::input, fmt::format("{}: needs {}, which cannot be embedded; accepted: files beside it",
                                                pathText(file), pathText(other)));
    auto one = references.of(other, folder, progress);
    if (!one) return tl::unexpected(one.error());
    one->path = genericPathText(relative);
    one->isEmbedded = true;
    lines.insert(lineOfFolder(one->sha256, one->path));
    belonging.emplace_back(std::move(*one), other);
  }
  // Headers of equal text may name different files: their folder is then that of all contents.
  std::string group = reference.path.substr(0, kEmbedded.size() + kSha256Digits + 1);
  if (!lines.empty()) {
    const std::string name = reference.path.substr(group.size());
    lines.insert(lineOfFolder(reference.sha256, name));
    Sha256 hash;
    for (const std::string &line : lines) hash.add(line);
    const auto digits = hash.digits();
    if (!digits) return tl::unexpected(digits.error());
    group = fmt::format("{}{}/", kEmbedded, *digits);
    reference.path = group + name;
  }
  saved.embedded[reference.path] = file;
  for (auto &[one, at] : belonging) {
    one.path = group + one.path;
    saved.embedded[one.path] = at;
    addOnce(std::move(one), saved);
  }
  return {};
}

/// Adds a scene as text, its masks as members and its files.
Expected<void> addScene(const scene::SceneFile &scene, const std::filesystem::path &folder, FileReferences &references,
                        const ProgressFn &progress, Embedding embedding, SessionFile &saved) {
  const auto nameOfMask = [&saved](const scene::SceneBody &body) {
    const std::string name = fmt::format("{}{}.mask", kMasks, saved.members.size() + 1);
    saved.members.emplace(name, maskBytes(*body.volume.mask, body.volume.colour));
    return name;
  };
  scene::SceneFile named = scene;
  for (std::filesystem::path *file : filesOf(named)) {
    const auto path = addFile(*file, folder, references, progress, embedding, saved);
    if (!path) return tl::unexpected(path.error());
    if (isEmbeddedPath(*path)) *file = folder / pathFromText(*path);
  }
  auto text = scene::sceneText(named, folder, nameOfMask);
  if (!text) return tl::unexpected(text.error());
  saved.scenes.push_back(std::move(*text));
  return {};
}

}  // namespace

Expected<std::string> addFile(const std::filesystem::path &file, const std::filesystem::path &folder,
                              FileReferences &references, const ProgressFn &progress, Embedding embedding,
                              SessionFile &saved) {
  auto reference = references.of(file, folder, progress);
  if (!reference) return tl::unexpected(reference.error());
  if (embedding == Embedding::all || (embedding == Embedding::extracted && isExtracted(file)))
    if (auto embedded = embedFile(file, folder, references, progress, *reference, saved); !embedded)
      return tl::unexpected(embedded.error());
  std::string path = reference->path;
  addOnce(std::move(*reference), saved);
  return path;
}

Expected<SessionFile> sessionOf(const CapturedState &captured, const std::filesystem::path &folder,
                                FileReferences &references, const ProgressFn &progress, Embedding embedding) {
  SessionFile saved;
  saved.program = "C3DE " C3DE_VERSION;
  saved.savedAt = savedNow();
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
    if (auto added = addScene(scene, folder, references, progress, embedding, saved); !added)
      return tl::unexpected(added.error());
  }
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
  const std::string name = referencePath(volume.file, absolutePath(file).parent_path());
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

void addMaskOfSelection(const imaging::Mask &mask, SessionFile &saved) {
  saved.view.selection->mask = kSelectionMask;
  saved.members.insert_or_assign(kSelectionMask, maskBytes(mask, std::nullopt));
}

Expected<std::shared_ptr<const imaging::Mask>> maskOfSelection(const SessionFile &saved,
                                                               const std::filesystem::path &file) {
  if (!saved.view.selection || saved.view.selection->mask.empty()) return nullptr;
  const std::string &name = saved.view.selection->mask;
  const auto member = saved.members.find(name);
  if (member == saved.members.end())
    return fail(ErrorCode::input, fmt::format("{}: is damaged: {} is missing, the mask of view.selection",
                                              pathText(file), displayText(name)));
  auto picked = maskOfBytes(member->second);
  if (!picked)
    return fail(ErrorCode::input,
                fmt::format("{}: is damaged: {} {}", pathText(file), displayText(name), picked.error().message));
  return std::make_shared<const imaging::Mask>(std::move(picked->mask));
}

void keepUnknown(const SessionFile &opened, SessionFile &saved) {
  const std::string selection = opened.view.selection ? opened.view.selection->mask : std::string();
  for (const auto &[name, bytes] : opened.members)
    if (!name.starts_with(kMasks) && name != selection) saved.members.emplace(name, bytes);
  saved.unknown.insert(opened.unknown.begin(), opened.unknown.end());
}

Expected<void> keepRest(const SessionFile &opened, const std::vector<FoundFile> &files,
                        const std::filesystem::path &folder, FileReferences &references, Embedding embedding,
                        SessionFile &saved) {
  keepUnknown(opened, saved);
  saved.view = opened.view;
  std::vector<std::string *> paths;
  if (!saved.view.image.empty()) paths.push_back(&saved.view.image);
  for (std::string &labels : saved.view.labels) paths.push_back(&labels);
  if (saved.view.comparison) paths.push_back(&saved.view.comparison->image);
  for (std::string *path : paths) {
    const auto found = std::find_if(files.begin(), files.end(),
                                    [path](const FoundFile &one) { return one.file.path == *path && !one.at.empty(); });
    if (found == files.end()) continue;  // a member
    auto added = addFile(found->at, folder, references, {}, embedding, saved);
    if (!added) return tl::unexpected(added.error());
    *path = std::move(*added);
  }
  if (saved.view.selection && !saved.view.selection->mask.empty())
    if (const auto mask = opened.members.find(saved.view.selection->mask); mask != opened.members.end())
      saved.members.insert(*mask);
  return {};
}

Expected<FileStamp> stampOfFiles(const SimulationSource &source, const std::vector<std::filesystem::path> &shown,
                                 const ProgressFn &progress) {
  std::set<fs::path> files;
  const auto add = [&](const fs::path &file) { files.insert(comparable(file)); };
  for (const auto &entry : source) {
    const auto *scene = std::get_if<SharedScene>(&entry);
    if (scene == nullptr) continue;
    scene::SceneFile named = **scene;
    for (const fs::path *file : filesOf(named)) add(*file);
  }
  for (const fs::path &file : shown) add(file);
  for (const fs::path &file : std::set<fs::path>(files)) {
    const auto others = filesBelongingTo(file, progress);
    if (!others) return tl::unexpected(others.error());
    for (const fs::path &other : *others) add(other);
  }
  FileStamp sum;
  for (const fs::path &file : files)
    if (const auto stamp = stampOf(file)) {
      sum.files += stamp->files;
      sum.bytes += stamp->bytes;
      sum.changed = std::max(sum.changed, stamp->changed);
    }
  return sum;
}

namespace {

/// Key of an entry of `files`: the session or recording that the file was extracted from.
std::string archiveKey(const std::string &path) {
  return (nlohmann::json::json_pointer() / "files" / path / "archive").to_string();
}

/// Files that had been extracted, and are not in the cache any more. One whose archive cannot be read stays missing.
Expected<void> findInArchives(const SessionFile &saved, std::vector<FoundFile> &files, const ProgressFn &progress) {
  std::map<std::string, std::vector<FoundFile *>> byArchive;
  for (FoundFile &one : files)
    if (const auto key = saved.unknown.find(archiveKey(one.file.path));
        key != saved.unknown.end() && one.state != FoundFile::State::same)
      if (const auto text = nlohmann::json::parse(key->second, nullptr, false); text.is_string())
        byArchive[text.get<std::string>()].push_back(&one);
  for (const auto &[archive, missing] : byArchive)
    if (auto again = extractAgain(pathFromText(archive), missing, progress);
        !again && again.error().code == ErrorCode::cancelled)
      return again;
  return {};
}

}  // namespace

void nameArchives(const std::filesystem::path &folder, SessionFile &saved) {
  for (const ReferencedFile &file : saved.files)
    if (const fs::path archive = file.isEmbedded ? fs::path() : archiveOf(folder / pathFromText(file.path));
        !archive.empty())
      saved.unknown[archiveKey(file.path)] = nlohmann::json(pathText(archive)).dump();
}

Expected<std::vector<FoundFile>> locateFiles(const SessionFile &saved, const std::filesystem::path &file,
                                             const ProgressFn &progress, const FileSearch &search) {
  auto found = findFiles(saved, absolutePath(file).parent_path(), progress);
  if (!found) return found;
  for (FoundFile &one : *found)
    if (const auto given = search.instead.find(one.file.path); given != search.instead.end()) {
      const auto hash = sha256Of(given->second, progress);
      if (!hash) return tl::unexpected(hash.error());
      one.at = given->second;
      one.state = *hash == one.file.sha256 ? FoundFile::State::same : FoundFile::State::changed;
    }
  if (auto again = findInArchives(saved, *found, progress); !again) return tl::unexpected(again.error());
  std::vector<std::string> unread;
  for (const std::filesystem::path &folder : search.folders)
    if (auto searched = searchFolder(folder, *found, progress, &unread); !searched)
      return tl::unexpected(searched.error());
  for (const std::string &one : unread) log(LogLevel::warn, "a folder could not be searched: " + one);
  if (auto extracted = extractEmbedded(file, *found, progress); !extracted) return tl::unexpected(extracted.error());
  return found;
}

Expected<std::vector<FoundFile>> filesOfSession(const SessionFile &saved, const std::filesystem::path &file,
                                                const ProgressFn &progress, const FileSearch &search) {
  auto found = locateFiles(saved, file, progress, search);
  if (!found) return found;
  std::string problems;
  for (const FoundFile &one : *found) {
    if (one.state == FoundFile::State::missing) problems += "\n  " + one.file.path + ": is missing";
    if (one.state == FoundFile::State::changed) problems += "\n  " + pathText(one.at) + ": has changed since";
  }
  if (!problems.empty())
    return fail(ErrorCode::input, pathText(file) + ": files were not found or have changed since " + saved.savedAt +
                                      "; restore them, copy them to the folder of the session, or name a folder that "
                                      "has them with --search FOLDER" +
                                      problems);
  return found;
}

Expected<SimulationSource> sourceOfSession(const SessionFile &saved, const std::filesystem::path &file,
                                           const std::vector<FoundFile> &files,
                                           const scene::MaterialLibrary *materials) {
  if (saved.scenes.empty()) return fail(ErrorCode::input, pathText(file) + ": the session has no scene");
  const std::filesystem::path folder = absolutePath(file).parent_path();
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

Expected<std::string> restoreIfPossible(Session &session, c3de_object *simulator, const SimulatorIdentity &identity,
                                        const SessionFile &saved, const std::filesystem::path &file) {
  const auto restored = restoreSession(session, simulator, identity, saved, file);
  if (restored) return std::string();
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  const c3de_status code = callPluginFunction(session.plugins().ownerOf(simulator), "reset of the simulation",
                                              CallKind::step, [&] { return (*table)->reset(simulator); });
  if (code >= 0) return restored.error().message;
  const std::string reason = session.plugins().takeError();
  return fail(ErrorCode::plugin,
              fmt::format("{}\nThe initial state could not be restored either: {}", restored.error().message,
                          reason.empty() ? fmt::format("status {}", code) : reason));
}

}  // namespace c3de::session
