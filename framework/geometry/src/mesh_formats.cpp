// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/mesh_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <span>
#include <thread>

#include "c3de/core/output_file.h"
#include "c3de/core/text.h"
#include "check_written.h"
#include "file_text.h"

namespace c3de::geometry {
namespace {

bool contains(std::span<const std::string_view> all, const std::string &one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}
bool contains(const std::vector<std::string> &all, const std::string &one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

bool isReadByProgram(const std::string &extension) { return contains(meshExtensions(), extension); }

}  // namespace

/// A reader or a writer; one of the two functions is set.
struct MeshFormats::Entry {
  Info info;
  std::string magic;
  decltype(MeshReader::read) read;
  decltype(MeshWriter::write) write;
  Handle handle;
  std::atomic<bool> isGone{false};
  std::mutex mutex;
  std::condition_variable ended;
  std::vector<std::thread::id> users;

  [[nodiscard]] std::string name() const {
    return fmt::format("{} '{}' of {}", read ? "reader" : "writer", info.id, info.owner);
  }
  [[nodiscard]] bool isAlike(const Entry &other) const {
    return static_cast<bool>(read) == static_cast<bool>(other.read);
  }
};

/// Marks that a thread is in a function of an entry.
class MeshFormats::Use {
 public:
  explicit Use(Entry &entry) : entry_(entry) {
    const std::lock_guard lock(entry_.mutex);
    entry_.users.push_back(std::this_thread::get_id());
  }
  Use(const Use &) = delete;
  Use &operator=(const Use &) = delete;
  ~Use() {
    const std::lock_guard lock(entry_.mutex);
    entry_.users.erase(std::find(entry_.users.begin(), entry_.users.end(), std::this_thread::get_id()));
    entry_.ended.notify_all();
  }

 private:
  Entry &entry_;
};

MeshFormats::MeshFormats() = default;
MeshFormats::~MeshFormats() = default;

Expected<MeshFormats::Added> MeshFormats::add(MeshReader reader) {
  auto entry = std::make_shared<Entry>();
  entry->info = {std::move(reader.id), std::move(reader.label), std::move(reader.owner), std::move(reader.extensions)};
  entry->magic = std::move(reader.magic);
  entry->read = std::move(reader.read);
  return add(std::move(entry));
}

Expected<MeshFormats::Added> MeshFormats::add(MeshWriter writer) {
  auto entry = std::make_shared<Entry>();
  entry->info = {std::move(writer.id), std::move(writer.label), std::move(writer.owner), std::move(writer.extensions)};
  entry->write = std::move(writer.write);
  return add(std::move(entry));
}

Expected<MeshFormats::Added> MeshFormats::add(std::shared_ptr<Entry> entry) {
  const std::lock_guard lock(mutex_);
  Added added;
  const bool reads = static_cast<bool>(entry->read);
  const char *does = reads ? "read" : "written";
  const char *otherwise = reads ? "where it is asked for" : "never";
  for (const auto &other : entries_)
    if (other->isAlike(*entry) && other->info.id == entry->info.id)
      return fail(ErrorCode::usage, fmt::format("the mesh {} '{}' already exists (plugin {})",
                                                reads ? "reader" : "writer", entry->info.id, other->info.owner));
  for (const std::string &extension : entry->info.extensions) {
    if (reads ? isReadByProgram(extension) : contains(writableMeshExtensions(), extension)) {
      added.conflicts.push_back(fmt::format("{} is {} by the program itself, by the {} {}{}", extension, does,
                                            entry->name(), reads ? "only " : "", otherwise));
      continue;
    }
    for (const auto &other : entries_)
      if (other->isAlike(*entry) && contains(other->info.extensions, extension)) {
        added.conflicts.push_back(fmt::format(
            "{} is {} by the {}, by the {} {}{}", extension, does, other->name(), entry->name(), reads ? "only " : "",
            other->magic.empty() ? otherwise : "for files without that format's signature"));
        break;
      }
  }
  entry->handle = added.handle = {next_++, Handle::firstOf(HandleKind::meshReader)};
  entries_.push_back(std::move(entry));
  return added;
}

void MeshFormats::end(Entry &entry) {
  entry.isGone = true;
  std::unique_lock lock(entry.mutex);
  entry.ended.wait(lock, [&] { return entry.users.empty(); });
}

MeshFormats::Removal MeshFormats::remove(Handle format, const std::string &owner) {
  std::shared_ptr<Entry> gone;
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const auto &entry) {
      return entry->handle == format && entry->info.owner == owner;
    });
    if (found == entries_.end()) return Removal::stale;
    {
      const std::lock_guard own((*found)->mutex);
      const auto &threads = (*found)->users;
      if (std::find(threads.begin(), threads.end(), std::this_thread::get_id()) != threads.end())
        return Removal::fromWithin;
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
                 [&](const auto &entry) { return entry->info.owner == owner; });
    std::erase_if(entries_, [&](const auto &entry) { return entry->info.owner == owner; });
  }
  for (const auto &entry : gone) end(*entry);
}

bool MeshFormats::isMeshFile(const std::filesystem::path &path) const {
  const std::string extension = lowerExtension(path);
  if (isReadByProgram(extension)) return true;
  const std::lock_guard lock(mutex_);
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const auto &entry) { return entry->read && contains(entry->info.extensions, extension); });
}

std::vector<std::string> MeshFormats::extensions() const {
  const auto own = meshExtensions();
  std::vector<std::string> all(own.begin(), own.end());
  const std::lock_guard lock(mutex_);
  for (const auto &entry : entries_)
    for (const std::string &extension : entry->info.extensions)
      if (entry->read && !contains(all, extension)) all.push_back(extension);
  return all;
}

std::vector<MeshFormats::Info> MeshFormats::entriesThat(bool write) const {
  const std::lock_guard lock(mutex_);
  std::vector<Info> all;
  for (const auto &entry : entries_)
    if (static_cast<bool>(entry->write) == write) all.push_back(entry->info);
  return all;
}
std::vector<MeshFormats::Info> MeshFormats::readers() const { return entriesThat(false); }
std::vector<MeshFormats::Info> MeshFormats::writers() const { return entriesThat(true); }

std::vector<std::string> MeshFormats::writableExtensions() const {
  const auto own = writableMeshExtensions();
  std::vector<std::string> all(own.begin(), own.end());
  for (const Info &writer : writers())
    for (const std::string &extension : writer.extensions)
      if (!contains(all, extension)) all.push_back(extension);
  return all;
}

Expected<void> MeshFormats::checkWritable(const std::filesystem::path &path) const {
  const std::vector<std::string> all = writableExtensions();
  const std::string extension = lowerExtension(path);
  if (contains(all, extension)) return {};
  return fail(ErrorCode::usage,
              fmt::format("{}: surfaces with the extension {} cannot be written; accepted: {}", displayPath(path),
                          extension.empty() ? "'' (none)" : quotedText(extension), fmt::join(all, ", ")));
}

Expected<void> MeshFormats::write(const std::filesystem::path &path, const TriangleMesh &mesh,
                                  const MeshWriteOptions &options, const ProgressFn &progress) const {
  const std::string extension = lowerExtension(path);
  if (contains(writableMeshExtensions(), extension)) return writeMesh(path, mesh, options);
  if (auto good = checkWritable(path); !good) return good;
  if (mesh.triangles.empty())
    return fail(ErrorCode::state, displayPath(path) + ": not written: the surface has no triangles");
  if (auto good = checkTriangles(path, mesh); !good) return good;
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    for (const auto &one : entries_)
      if (!entry && one->write && contains(one->info.extensions, extension)) entry = one;
  }
  if (!entry) return fail(ErrorCode::usage, displayPath(path) + ": its writer was removed");
  const std::string origin = fmt::format("{} ({})", displayPath(path), entry->name());
  const Use use(*entry);
  if (entry->isGone) return fail(ErrorCode::usage, origin + ": its plugin has gone");
  const auto bytes = entry->write(mesh, options.title, [&](double fraction, const std::string &what) {
    return !entry->isGone && (!progress || progress(fraction, what));
  });
  if (!bytes) return fail(bytes.error().code, origin + ": " + bytes.error().message);
  if (bytes->empty()) return fail(ErrorCode::plugin, origin + ": it returned no data");
  return writeWholeFile(path, *bytes);
}

/// The mesh from a reader of a plugin, and the reader, for messages.
struct MeshFormats::Raw {
  ReadMesh mesh;
  std::string origin;
};

Expected<MeshFormats::Raw> MeshFormats::read(const std::filesystem::path &path, const ProgressFn &progress,
                                             const std::string &readerId) const {
  const std::string name = displayPath(path), extension = lowerExtension(path);
  if (readerId.empty() && !isMeshFile(path))
    return fail(
        ErrorCode::input,
        fmt::format("{}: meshes with the extension {} cannot be read; {} can, and formats of plugins (--plugin)", name,
                    path.has_extension() ? quotedText(extension) : "'' (none)", fmt::join(extensions(), ", ")));
  if (progress && !progress(0.0, "reading " + displayPath(path.filename())))
    return fail(ErrorCode::cancelled, name + ": cancelled");
  const auto bytes = readWholeFile(path);
  if (!bytes) return tl::unexpected(bytes.error());
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    for (const auto &one : entries_)
      if (one->read && (readerId.empty() ? contains(one->info.extensions, extension) && bytes->starts_with(one->magic)
                                         : one->info.id == readerId)) {
        entry = one;
        break;
      }
  }
  if (!entry && !readerId.empty()) {
    std::string ids;
    for (const Info &one : readers()) ids += (ids.empty() ? "" : ", ") + one.id;
    return fail(ErrorCode::usage, fmt::format("{}: there is no mesh reader '{}'; there are: {}", name, readerId,
                                              ids.empty() ? "none (no plugin provides one)" : ids));
  }
  if (!entry)
    return fail(ErrorCode::input, fmt::format("{}: does not have the signature of any {} reader", name, extension));

  const std::string origin = fmt::format("{} ({})", name, entry->name());
  const Use use(*entry);
  if (entry->isGone) return fail(ErrorCode::input, origin + ": its plugin has gone");
  auto mesh = entry->read(path, *bytes, [&](double fraction, const std::string &what) {
    return !entry->isGone && (!progress || progress(fraction < 0.0 ? fraction : 0.5 * std::min(fraction, 1.0), what));
  });
  if (!mesh) return fail(mesh.error().code, origin + ": " + mesh.error().message);
  return Raw{std::move(*mesh), origin};
}

Expected<LoadedMesh> MeshFormats::load(const std::filesystem::path &path, std::optional<LengthUnit> stated,
                                       const ProgressFn &progress, const std::string &readerId) const {
  if (readerId.empty() && isReadByProgram(lowerExtension(path))) return loadMesh(path, stated, progress);
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
  if (isReadByProgram(lowerExtension(path))) return geometry::unitInFile(path);
  const auto raw = read(path, {}, {});
  return raw ? raw->mesh.unit : std::nullopt;
}

Expected<LengthUnit> MeshFormats::unitOf(const std::filesystem::path &path, std::optional<LengthUnit> stated) const {
  if (stated) return *stated;
  if (const auto said = unitInFile(path); said || !isMeshFile(path))
    return said.value_or(LengthUnit::millimetre);  // read errors are reported when it is loaded
  return fail(ErrorCode::input,
              fmt::format("'mesh_unit' is missing; {} does not state its unit; accepted: \"m\", \"mm\", "
                          "\"cm\"",
                          displayPath(path.filename())));
}

}  // namespace c3de::geometry
