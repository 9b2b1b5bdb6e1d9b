// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>

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

constexpr std::uint64_t kMostExtensions = 64, kLongestMagic = 4096;

/// What a reader puts, checked as it comes. Nothing may be thrown through the boundary.
class MeshCollector {
 public:
  explicit MeshCollector(geometry::ReadMesh &mesh)
      : mesh_(mesh), abi_{sizeof(c3de_mesh_sink), 0, this, &addVertices, &addTriangles, &setUnit, &note} {}
  [[nodiscard]] const c3de_mesh_sink *abi() const { return &abi_; }
  /// Why something was refused, whatever the reader made of it; C3DE_OK: nothing was.
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
        // Kept for the person, and left as the last error, which the reader may hand on.
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
      // Vertices may come later, so whether an index is in range is seen at the end.
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

/// Progress of the host for a reader; remembers that it said stop.
struct ReadProgress {
  explicit ReadProgress(const ProgressFn &fn) : progress(fn), abi{sizeof(c3de_progress), 0, this, &update} {}
  static c3de_status C3DE_CALL update(void *self, double fraction, c3de_str what) noexcept {
    auto &own = *static_cast<ReadProgress *>(self);
    try {
      own.call->noteProgress();
      if (own.progress && !own.progress(fraction, std::string(fromAbi(what)))) own.isCancelled = true;
      return own.isCancelled ? C3DE_E_CANCELLED : C3DE_OK;
    } catch (...) {
      return refuse("progress");
    }
  }
  const ProgressFn &progress;
  const ForeignCall *call = nullptr;
  c3de_progress abi;
  std::atomic<bool> isCancelled{false};
};

Expected<geometry::ReadMesh> readWith(PluginContext &plugin, const c3de_mesh_reader &reader,
                                      const std::filesystem::path &path, std::string_view bytes,
                                      const ProgressFn &progress) {
  geometry::ReadMesh mesh;
  MeshCollector collector(mesh);
  ReadProgress reading(progress);
  const std::string name = pathText(path);
  const c3de_mesh_source source{sizeof(c3de_mesh_source), 0, toAbi(name), bytes.data(), bytes.size()};
  setLastError(std::string_view());
  c3de_status status = C3DE_E_EXCEPTION;
  const auto read = [&](const ForeignCall &recorded) {
    reading.call = &recorded;
    status = reader.read(reader.self, &source, &reading.abi, collector.abi());
  };
  const bool returned = callPlugin(plugin, "read of a mesh reader", read, CallKind::job);
  std::string text = takeLastError();
  if (reading.isCancelled) return fail(ErrorCode::cancelled, "cancelled");
  if (!returned) return fail(ErrorCode::plugin, "an exception left it; the log says which");
  // A reader that goes on after something of it was refused has not given a whole mesh.
  if (collector.status() < 0) return fail(ErrorCode::input, collector.refusal());
  if (status == C3DE_E_CANCELLED)
    return fail(ErrorCode::plugin, "it says that it was cancelled, which nobody asked for");
  if (status < 0) return fail(ErrorCode::input, text.empty() ? "it fails with " + statusName(status) : text);
  return mesh;
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

c3de_status C3DE_CALL addMeshReader(void *ctx, const c3de_mesh_reader *reader, c3de_handle *out) noexcept {
  return serve(ctx, "files.add_mesh_reader", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    const c3de_mesh_reader in = structOf(reader, "reader");
    geometry::MeshReader made;
    made.owner = plugin.id();
    made.id = idOf(in.id, "reader id");
    made.label = textOf(in.label, "reader label");
    made.magic = textOf(in.magic, "magic");
    if (made.label.empty()) throw Refusal(C3DE_E_ARG, "reader label is empty");
    if (made.magic.size() > kLongestMagic)
      throw Refusal(C3DE_E_ARG,
                    fmt::format("magic has {} bytes, accepted are at most {}", made.magic.size(), kLongestMagic));
    requireNonNull(in.read, "reader read");
    if (in.extensions_n == 0 || in.extensions_n > kMostExtensions)
      throw Refusal(C3DE_E_ARG, fmt::format("extensions_n is {}, accepted: 1 to {}", in.extensions_n, kMostExtensions));
    requireNonNull(in.extensions, "extensions");
    for (std::uint64_t i = 0; i < in.extensions_n; ++i) made.extensions.push_back(extensionOf(in.extensions[i]));
    made.read = [owner = &plugin, in](const std::filesystem::path &path, std::string_view bytes,
                                      const ProgressFn &progress) {
      return readWith(*owner, in, path, bytes, progress);
    };
    const auto added = plugin.services().meshFormats->add(std::move(made));
    if (!added) throw Refusal(C3DE_E_EXISTS, added.error().message);
    for (const std::string &conflict : added->conflicts) log(LogLevel::warn, "[" + plugin.id() + "] " + conflict);
    writeHandle(out, added->handle);
  });
}

c3de_status C3DE_CALL removeReader(void *ctx, c3de_handle reader) noexcept {
  return serve(ctx, "files.remove", [&](PluginContext &plugin) {
    switch (plugin.services().meshFormats->remove(handleOf(reader), plugin.id())) {
      case geometry::MeshFormats::Removal::done: return;
      case geometry::MeshFormats::Removal::fromRead:
        throw Refusal(C3DE_E_STATE, "a reader cannot be removed while it reads on this thread");
      case geometry::MeshFormats::Removal::stale:
        throw Refusal(C3DE_E_STALE,
                      fmt::format("plugin {} has no mesh reader of handle {}", plugin.id(), textOf(reader)));
    }
  });
}

}  // namespace

c3de_files_v0 makeFilesTable(PluginContext *plugin) {
  return {sizeof(c3de_files_v0), kServiceRevision, plugin, &addMeshReader, &removeReader};
}

}  // namespace c3de::plugin_host
