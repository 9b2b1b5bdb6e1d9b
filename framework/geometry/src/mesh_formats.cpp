// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/mesh_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <thread>

#include "file_text.h"

namespace c3de::geometry {
namespace {

bool isOfProgram(const std::string &extension) {
  const auto own = meshExtensions();
  return std::find(own.begin(), own.end(), extension) != own.end();
}

bool contains(const std::vector<std::string> &all, const std::string &one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

std::string nameOf(const MeshReader &reader) { return fmt::format("reader '{}' of {}", reader.id, reader.owner); }

}  // namespace

struct MeshFormats::Entry {
  MeshReader reader;
  Handle handle;
  std::atomic<bool> isGone{false};
  std::mutex mutex;
  std::condition_variable ended;
  std::vector<std::thread::id> reading;
};

MeshFormats::MeshFormats() = default;
MeshFormats::~MeshFormats() = default;

Expected<MeshFormats::Added> MeshFormats::add(MeshReader reader) {
  const std::lock_guard lock(mutex_);
  Added added;
  for (const auto &entry : entries_)
    if (entry->reader.id == reader.id)
      return fail(ErrorCode::usage,
                  fmt::format("the mesh reader '{}' is there already, of {}", reader.id, entry->reader.owner));
  for (const std::string &extension : reader.extensions) {
    if (isOfProgram(extension)) {
      added.conflicts.push_back(fmt::format("{} is read by the program itself, by the {} only where it is asked for",
                                            extension, nameOf(reader)));
      continue;
    }
    for (const auto &entry : entries_)
      if (contains(entry->reader.extensions, extension)) {
        added.conflicts.push_back(fmt::format(
            "{} is read by the {}, by the {} only {}", extension, nameOf(entry->reader), nameOf(reader),
            entry->reader.magic.empty() ? "where it is asked for" : "where a file does not begin as that one wants"));
        break;
      }
  }
  auto entry = std::make_shared<Entry>();
  entry->reader = std::move(reader);
  entry->handle = added.handle = {next_++, Handle::firstOf(HandleKind::meshReader)};
  entries_.push_back(std::move(entry));
  return added;
}

void MeshFormats::end(Entry &entry) {
  entry.isGone = true;
  std::unique_lock lock(entry.mutex);
  entry.ended.wait(lock, [&] { return entry.reading.empty(); });
}

MeshFormats::Removal MeshFormats::remove(Handle reader, const std::string &owner) {
  std::shared_ptr<Entry> gone;
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const auto &entry) {
      return entry->handle == reader && entry->reader.owner == owner;
    });
    if (found == entries_.end()) return Removal::stale;
    {
      const std::lock_guard own((*found)->mutex);
      const auto &threads = (*found)->reading;
      if (std::find(threads.begin(), threads.end(), std::this_thread::get_id()) != threads.end())
        return Removal::fromRead;
    }
    gone = *found;
    entries_.erase(found);
  }
  end(*gone);
  return Removal::done;
}

void MeshFormats::removeOwnedBy(const std::string &owner) {
  std::vector<std::shared_ptr<Entry>> gone;
  {
    const std::lock_guard lock(mutex_);
    std::copy_if(entries_.begin(), entries_.end(), std::back_inserter(gone),
                 [&](const auto &entry) { return entry->reader.owner == owner; });
    std::erase_if(entries_, [&](const auto &entry) { return entry->reader.owner == owner; });
  }
  for (const auto &entry : gone) end(*entry);
}

bool MeshFormats::isMeshFile(const std::filesystem::path &path) const {
  const std::string extension = lowerExtension(path);
  if (isOfProgram(extension)) return true;
  const std::lock_guard lock(mutex_);
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const auto &entry) { return contains(entry->reader.extensions, extension); });
}

std::vector<std::string> MeshFormats::extensions() const {
  const auto own = meshExtensions();
  std::vector<std::string> all(own.begin(), own.end());
  const std::lock_guard lock(mutex_);
  for (const auto &entry : entries_)
    for (const std::string &extension : entry->reader.extensions)
      if (!contains(all, extension)) all.push_back(extension);
  return all;
}

std::vector<MeshFormats::Info> MeshFormats::readers() const {
  const std::lock_guard lock(mutex_);
  std::vector<Info> all;
  for (const auto &entry : entries_)
    all.push_back({entry->reader.id, entry->reader.label, entry->reader.owner, entry->reader.extensions});
  return all;
}

/// What a reader of a plugin gave, and who that is, for messages.
struct MeshFormats::Raw {
  ReadMesh mesh;
  std::string origin;
};

Expected<MeshFormats::Raw> MeshFormats::read(const std::filesystem::path &path, const ProgressFn &progress,
                                             const std::string &readerId) const {
  const std::string name = displayPath(path), extension = lowerExtension(path);
  if (readerId.empty() && !isMeshFile(path))
    return fail(ErrorCode::input,
                fmt::format("{}: meshes with the extension {} cannot be read; {} can", name,
                            path.has_extension() ? quotedText(extension) : "'' (none)", fmt::join(extensions(), ", ")));
  if (progress && !progress(0.0, "reading " + displayPath(path.filename())))
    return fail(ErrorCode::cancelled, name + ": cancelled");
  const auto bytes = readWholeFile(path);
  if (!bytes) return tl::unexpected(bytes.error());
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    for (const auto &one : entries_)
      if (readerId.empty() ? contains(one->reader.extensions, extension) && bytes->starts_with(one->reader.magic)
                           : one->reader.id == readerId) {
        entry = one;
        break;
      }
  }
  if (!entry && !readerId.empty()) {
    std::string ids;
    for (const Info &one : readers()) ids += (ids.empty() ? "" : ", ") + one.id;
    return fail(ErrorCode::usage, fmt::format("{}: there is no mesh reader '{}'; there are: {}", name, readerId,
                                              ids.empty() ? "none (no plugin brings one)" : ids));
  }
  if (!entry)
    return fail(ErrorCode::input, fmt::format("{}: does not begin as any reader of {} files expects", name, extension));

  const std::string origin = fmt::format("{} ({})", name, nameOf(entry->reader));
  struct Reading {
    explicit Reading(Entry &e) : entry(e) {
      const std::lock_guard lock(entry.mutex);
      entry.reading.push_back(std::this_thread::get_id());
    }
    ~Reading() {
      const std::lock_guard lock(entry.mutex);
      entry.reading.erase(std::find(entry.reading.begin(), entry.reading.end(), std::this_thread::get_id()));
      entry.ended.notify_all();
    }
    Entry &entry;
  } const reading(*entry);
  if (entry->isGone) return fail(ErrorCode::input, origin + ": its plugin has gone");
  auto mesh = entry->reader.read(path, *bytes, [&](double fraction, const std::string &what) {
    return !entry->isGone && (!progress || progress(fraction < 0.0 ? fraction : 0.5 * std::min(fraction, 1.0), what));
  });
  if (!mesh) return fail(mesh.error().code, origin + ": " + mesh.error().message);
  return Raw{std::move(*mesh), origin};
}

Expected<LoadedMesh> MeshFormats::load(const std::filesystem::path &path, std::optional<LengthUnit> stated,
                                       const ProgressFn &progress, const std::string &readerId) const {
  if (readerId.empty() && isOfProgram(lowerExtension(path))) return loadMesh(path, stated, progress);
  auto raw = read(path, progress, readerId);
  if (!raw) return tl::unexpected(raw.error());
  ReadMesh &read = raw->mesh;
  const LengthUnit unit = stated.value_or(read.unit.value_or(LengthUnit::millimetre));
  auto loaded = buildMesh(std::move(read.mesh), unit, raw->origin, std::move(read.notes), progress);
  if (loaded && stated && read.unit && *read.unit != *stated)
    loaded->report.warnings.push_back(unitsDiffer(*read.unit, *stated));
  return loaded;
}

std::optional<LengthUnit> MeshFormats::unitInFile(const std::filesystem::path &path) const {
  if (isOfProgram(lowerExtension(path))) return geometry::unitInFile(path);
  const auto raw = read(path, {}, {});
  return raw ? raw->mesh.unit : std::nullopt;
}

}  // namespace c3de::geometry
