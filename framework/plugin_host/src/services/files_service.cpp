// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <functional>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "arguments.h"
#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/geometry/mesh_formats.h"
#include "last_error.h"
#include "services/length_unit.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

constexpr std::uint64_t kMaxExtensions = 64, kLongestMagic = 4096;
constexpr std::uint64_t kLargestFile = std::uint64_t{1} << 32;

/// Receives and checks the output of a reader. Nothing may be thrown across the boundary.
class MeshCollector {
 public:
  explicit MeshCollector(geometry::ReadMesh &mesh)
      : mesh_(mesh), abi_{sizeof(c3de_mesh_sink), 0, this, &addVertices, &addTriangles, &setUnit, &note} {}
  [[nodiscard]] const c3de_mesh_sink *abi() const { return &abi_; }
  /// Why data was refused, regardless of the reader's reaction; C3DE_OK: nothing was.
  [[nodiscard]] const std::string &refusal() const { return refusal_; }
  [[nodiscard]] c3de_status status() const { return status_; }

 private:
  template <class F>
  static c3de_status take(void *self, const char *where, F &&f) noexcept {
    auto &collector = *static_cast<MeshCollector *>(self);
    try {
      f(collector.mesh_);
      return C3DE_OK;
    } catch (...) {
      const c3de_status status = refuse(where);
      if (collector.status_ == C3DE_OK) {
        collector.status_ = status;
        // Stored for the user, and set as the last error, which the reader may pass on.
        collector.refusal_ = takeLastError();
        setLastError(collector.refusal_);
      }
      return status;
    }
  }
  static c3de_status C3DE_CALL addVertices(void *self, c3de_view positions) noexcept {
    return take(self, "add_vertices", [&](geometry::ReadMesh &mesh) {
      if (positions.count == 0) return;
      const std::vector<Vec3> rows = positionsOf(positions, "positions");
      mesh.mesh.vertices.insert(mesh.mesh.vertices.end(), rows.begin(), rows.end());
    });
  }
  static c3de_status C3DE_CALL addTriangles(void *self, c3de_view triangles) noexcept {
    return take(self, "add_triangles", [&](geometry::ReadMesh &mesh) {
      if (triangles.count == 0) return;
      // Vertices may follow later, so the range of indices is checked at the end.
      const std::vector<Triangle> rows = trianglesOf(triangles, "triangles", std::size_t{1} << 32);
      mesh.mesh.triangles.insert(mesh.mesh.triangles.end(), rows.begin(), rows.end());
    });
  }
  static c3de_status C3DE_CALL setUnit(void *self, std::uint32_t unit) noexcept {
    return take(self, "set_unit", [&](geometry::ReadMesh &mesh) { mesh.unit = unitOf(unit); });
  }
  static c3de_status C3DE_CALL note(void *self, c3de_str sentence) noexcept {
    return take(self, "note", [&](geometry::ReadMesh &mesh) {
      if (mesh.notes.size() < 100) mesh.notes.push_back(textOf(sentence, "sentence"));
    });
  }

  geometry::ReadMesh &mesh_;
  c3de_mesh_sink abi_;
  std::string refusal_;
  c3de_status status_ = C3DE_OK;
};

/// Progress of the host for a reader or writer; remembers a request to stop.
struct FormatProgress {
  explicit FormatProgress(const ProgressFn &fn) : progress(fn), abi{sizeof(c3de_progress), 0, this, &update} {}
  static c3de_status C3DE_CALL update(void *self, double fraction, c3de_str what) noexcept {
    auto &own = *static_cast<FormatProgress *>(self);
    try {
      own.call->noteProgress();
      if (own.progress && !own.progress(fraction, std::string(fromAbi(what)))) own.isCancelled = true;
      return own.isCancelled ? C3DE_E_CANCELLED : C3DE_OK;
    } catch (...) {
      return refuse("progress");
    }
  }
  const ProgressFn &progress;
  const PluginCall *call = nullptr;
  c3de_progress abi;
  std::atomic<bool> isCancelled{false};
};

/// Detects by checksum that a plugin writes to bytes it may only read.
class ReadOnlyBytes {
 public:
  ReadOnlyBytes(std::initializer_list<std::string_view> lent) : lent_(lent), before_(sum()) {}
  /// Logged once per call.
  void report(const PluginContext &plugin, const char *what) const {
    if (sum() != before_)
      log(LogLevel::error, fmt::format("plugin {}: {} has written to read-only data", plugin.id(), what));
  }

 private:
  [[nodiscard]] std::size_t sum() const {
    std::size_t all = 0;
    for (const std::string_view bytes : lent_) all = 31 * all + std::hash<std::string_view>()(bytes);
    return all;
  }
  std::vector<std::string_view> lent_;
  std::size_t before_;
};

template <class T>
std::string_view bytesOf(const std::vector<T> &values) {
  return {reinterpret_cast<const char *>(values.data()), values.size() * sizeof(T)};
}

Expected<geometry::ReadMesh> readWith(PluginContext &plugin, const c3de_mesh_reader &reader,
                                      const std::filesystem::path &path, std::string_view bytes,
                                      const ProgressFn &progress) {
  geometry::ReadMesh mesh;
  MeshCollector collector(mesh);
  FormatProgress reading(progress);
  const std::string name = pathText(path);
  const c3de_mesh_source source{sizeof(c3de_mesh_source), 0, toAbi(name), bytes.data(), bytes.size()};
  setLastError(std::string_view());
  c3de_status status = C3DE_E_EXCEPTION;
  const auto read = [&](const PluginCall &recorded) {
    reading.call = &recorded;
    status = reader.read(reader.self, &source, &reading.abi, collector.abi());
  };
  const ReadOnlyBytes lent{bytes};
  const bool returned = callPlugin(plugin, "read of a mesh reader", read, CallKind::job);
  lent.report(plugin, "read of a mesh reader");
  std::string text = takeLastError();
  if (reading.isCancelled) return fail(ErrorCode::cancelled, "cancelled");
  if (!returned) return fail(ErrorCode::plugin, "an exception left it; the log says which");
  // A reader that continues after some of its data was refused has not provided a whole mesh.
  if (collector.status() < 0) return fail(ErrorCode::input, collector.refusal());
  if (status == C3DE_E_CANCELLED) return fail(ErrorCode::plugin, "it reports a cancellation that was not requested");
  if (status < 0) return fail(ErrorCode::input, text.empty() ? "it fails with " + statusName(status) : text);
  return mesh;
}

/// Receives the output of a writer in pieces.
struct ByteCollector {
  static c3de_status C3DE_CALL put(void *self, const void *bytes, std::uint64_t n) noexcept {
    auto &own = *static_cast<ByteCollector *>(self);
    try {
      if (n > 0) requireNonNull(bytes, "bytes");
      if (n > kLargestFile - own.bytes.size())
        throw Refusal(C3DE_E_ARG, fmt::format("a file of more than {} bytes", kLargestFile));
      own.bytes.append(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
      return C3DE_OK;
    } catch (...) {
      const c3de_status status = refuse("put");
      own.refusal = takeLastError();
      setLastError(own.refusal);
      return status;
    }
  }
  std::string bytes;
  std::string refusal;  // set regardless of the writer's reaction
};

Expected<std::string> writeWith(PluginContext &plugin, const c3de_mesh_writer &writer,
                                const geometry::TriangleMesh &mesh, const std::string &name,
                                const ProgressFn &progress) {
  ByteCollector collector;
  FormatProgress writing(progress);
  c3de_mesh_contents contents{sizeof(c3de_mesh_contents), 0, toAbi(name), {}, {}};
  contents.positions_mm = {mesh.vertices.data(), mesh.vertices.size(), 3, C3DE_F64, sizeof(Vec3)};
  contents.triangles = {mesh.triangles.data(), mesh.triangles.size(), 3, C3DE_U32, sizeof(Triangle)};
  setLastError(std::string_view());
  c3de_status status = C3DE_E_EXCEPTION;
  const auto write = [&](const PluginCall &recorded) {
    writing.call = &recorded;
    status = writer.write(writer.self, &contents, &writing.abi, {&collector, &ByteCollector::put});
  };
  const ReadOnlyBytes lent{bytesOf(mesh.vertices), bytesOf(mesh.triangles)};
  const bool returned = callPlugin(plugin, "write of a mesh writer", write, CallKind::job);
  lent.report(plugin, "write of a mesh writer");
  const std::string text = takeLastError();
  if (writing.isCancelled) return fail(ErrorCode::cancelled, "cancelled");
  if (!returned) return fail(ErrorCode::plugin, "an exception left it; the log says which");
  if (!collector.refusal.empty()) return fail(ErrorCode::plugin, collector.refusal);
  if (status == C3DE_E_CANCELLED) return fail(ErrorCode::plugin, "it reports a cancellation that was not requested");
  if (status < 0) return fail(ErrorCode::plugin, text.empty() ? "it fails with " + statusName(status) : text);
  return std::move(collector.bytes);
}

/// "TRI" or "tri" as ".tri".
std::string extensionOf(c3de_str text) {
  std::string extension = textOf(text, "extension");
  const auto isGood = [](unsigned char c) { return std::isalnum(c) != 0 && c < 0x80; };
  if (extension.empty() || extension.size() > 16 || !std::all_of(extension.begin(), extension.end(), isGood))
    throw Refusal(C3DE_E_ARG,
                  fmt::format("extension '{}': accepted are 1 to 16 letters and digits, without the dot", extension));
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return "." + extension;
}

/// Members that a reader and a writer have in common.
template <class Format, class In>
Format formatOf(const PluginContext &plugin, const In &in, const std::string &what) {
  Format made;
  made.owner = plugin.id();
  made.id = idOf(in.id, (what + " id").c_str());
  made.label = textOf(in.label, (what + " label").c_str());
  if (made.label.empty()) throw Refusal(C3DE_E_ARG, what + " label is empty");
  if (in.extensions_n == 0 || in.extensions_n > kMaxExtensions)
    throw Refusal(C3DE_E_ARG, fmt::format("extensions_n is {}, accepted: 1 to {}", in.extensions_n, kMaxExtensions));
  requireNonNull(in.extensions, "extensions");
  for (std::uint64_t i = 0; i < in.extensions_n; ++i) made.extensions.push_back(extensionOf(in.extensions[i]));
  return made;
}

template <class Format>
void addFormat(PluginContext &plugin, Format made, c3de_handle *out) {
  const auto added = plugin.services().meshFormats->add(std::move(made));
  if (!added) throw Refusal(C3DE_E_EXISTS, added.error().message);
  for (const std::string &conflict : added->conflicts) log(LogLevel::warn, "[" + plugin.id() + "] " + conflict);
  writeHandle(out, added->handle);
}

c3de_status C3DE_CALL addMeshReader(void *ctx, const c3de_mesh_reader *reader, c3de_handle *out) noexcept {
  return serve(ctx, "files.add_mesh_reader", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    const c3de_mesh_reader in = structOf(reader, "reader");
    auto made = formatOf<geometry::MeshReader>(plugin, in, "reader");
    made.magic = textOf(in.magic, "magic");
    if (made.magic.size() > kLongestMagic)
      throw Refusal(C3DE_E_ARG,
                    fmt::format("magic has {} bytes, accepted are at most {}", made.magic.size(), kLongestMagic));
    requireNonNull(in.read, "reader read");
    made.read = [owner = &plugin, in](const std::filesystem::path &path, std::string_view bytes,
                                      const ProgressFn &progress) {
      return readWith(*owner, in, path, bytes, progress);
    };
    addFormat(plugin, std::move(made), out);
  });
}

c3de_status C3DE_CALL addMeshWriter(void *ctx, const c3de_mesh_writer *writer, c3de_handle *out) noexcept {
  return serve(ctx, "files.add_mesh_writer", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    const c3de_mesh_writer in = structOf(writer, "writer");
    auto made = formatOf<geometry::MeshWriter>(plugin, in, "writer");
    requireNonNull(in.write, "writer write");
    made.write = [owner = &plugin, in](const geometry::TriangleMesh &mesh, const std::string &name,
                                       const ProgressFn &progress) {
      return writeWith(*owner, in, mesh, name, progress);
    };
    addFormat(plugin, std::move(made), out);
  });
}

c3de_status C3DE_CALL removeFormat(void *ctx, c3de_handle format) noexcept {
  return serve(ctx, "files.remove", [&](PluginContext &plugin) {
    switch (plugin.services().meshFormats->remove(handleOf(format), plugin.id())) {
      case geometry::MeshFormats::Removal::done: return;
      case geometry::MeshFormats::Removal::fromWithin:
        throw Refusal(C3DE_E_STATE, "a reader or writer cannot be removed while it works on this thread");
      case geometry::MeshFormats::Removal::stale:
        throw Refusal(C3DE_E_STALE,
                      fmt::format("plugin {} has no mesh reader or writer of handle {}", plugin.id(), textOf(format)));
    }
  });
}

}  // namespace

c3de_files_v1 makeFilesTable(PluginContext *plugin) {
  return {sizeof(c3de_files_v1), kFilesRevision, plugin, &addMeshReader, &removeFormat, &addMeshWriter};
}

}  // namespace c3de::plugin_host
