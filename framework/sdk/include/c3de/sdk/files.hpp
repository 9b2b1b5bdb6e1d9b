// SPDX-License-Identifier: Apache-2.0
// Formats of files that a plugin brings.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/sdk/services.hpp"

namespace c3de::sdk {

/// Where a reader puts what it finds; valid while it reads, on its thread. What is refused is thrown as Error, which
/// ends the read; the person hears of it.
class MeshSink {
 public:
  explicit MeshSink(const c3de_mesh_sink *sink) noexcept : sink_(sink) {}
  /// In the unit of the file; they follow those that were added before.
  void addVertices(std::span<const Vec3> positions) const {
    check(sink_->add_vertices(sink_->self, rows<double, 3>(positions)));
  }
  /// Indices of vertices from 0, outwards by the right-hand rule where the file knows it.
  void addTriangles(std::span<const std::array<std::uint32_t, 3>> triangles) const {
    check(sink_->add_triangles(sink_->self, rows<std::uint32_t, 3>(triangles)));
  }
  /// @param unit  C3DE_UNIT_M, C3DE_UNIT_MM or C3DE_UNIT_CM, where the file says it
  void setUnit(std::uint32_t unit) const { check(sink_->set_unit(sink_->self, unit)); }
  /// A sentence for the mesh report: what was left out, what was assumed.
  void note(std::string_view sentence) const { check(sink_->note(sink_->self, str(sentence))); }

 private:
  static void check(c3de_status status) {
    if (status < 0) throw Error(currentHost().failure(status));
  }
  const c3de_mesh_sink *sink_;
};

/// A file to read; valid while it is read.
struct MeshSource {
  std::string_view path;   ///< UTF-8; for files that lie beside it
  std::string_view bytes;  ///< all of it
};

/// A reader of meshes until it is destroyed or removed.
class MeshReader {
 public:
  MeshReader() noexcept = default;
  MeshReader(MeshReader &&) noexcept = default;
  MeshReader &operator=(MeshReader &&other) noexcept {
    if (this == &other) return *this;
    remove();  // before its function goes, which may be reading
    read_ = std::move(other.read_);
    owned_ = std::move(other.owned_);
    return *this;
  }
  ~MeshReader() = default;
  [[nodiscard]] c3de_handle handle() const noexcept { return owned_.handle(); }
  explicit operator bool() const noexcept { return static_cast<bool>(owned_); }
  /// When this returns, nothing is being read by it. Not from within its function.
  void remove() noexcept {
    owned_.reset();
    read_.reset();
  }

 private:
  friend class Files;
  using Read = std::function<Result<void>(const MeshSource &, Progress, const MeshSink &)>;
  std::unique_ptr<Read> read_;
  Owned<c3de_files_v1, &c3de_files_v1::remove> owned_;  // goes first
};

/// A surface to write; valid while it is written.
struct MeshContents {
  std::string_view name;            ///< of the body, for people; may be empty
  std::span<const Vec3> positions;  ///< mm, LPS
  std::span<const std::array<std::uint32_t, 3>> triangles;
};

/// A writer of meshes until it is destroyed or removed.
class MeshWriter {
 public:
  MeshWriter() noexcept = default;
  MeshWriter(MeshWriter &&) noexcept = default;
  MeshWriter &operator=(MeshWriter &&other) noexcept {
    if (this == &other) return *this;
    remove();
    write_ = std::move(other.write_);
    owned_ = std::move(other.owned_);
    return *this;
  }
  ~MeshWriter() = default;
  [[nodiscard]] c3de_handle handle() const noexcept { return owned_.handle(); }
  explicit operator bool() const noexcept { return static_cast<bool>(owned_); }
  /// When this returns, nothing is being written by it. Not from within its function.
  void remove() noexcept {
    owned_.reset();
    write_.reset();
  }

 private:
  friend class Files;
  using Write = std::function<Result<void>(const MeshContents &, Progress, c3de_sink)>;
  std::unique_ptr<Write> write_;
  Owned<c3de_files_v1, &c3de_files_v1::remove> owned_;  // goes first
};

/// What a reader or writer of meshes is; everything is copied by the host.
struct MeshFormat {
  std::string_view id{}, label{};
  std::vector<std::string_view> extensions{};  ///< without the dot
  std::string_view magic{};                    ///< of readers: what their files begin with; empty: anything
};

/// Files that the program can open and write because of this plugin. Any thread.
class Files : public Service<c3de_files_v1> {
 public:
  using Service::Service;
  /// @param read  any thread, several at once; fails or throws with what is wrong with the file, in which line. Ask its
  ///              progress several times a second; where that answers false, fail with C3DE_E_CANCELLED.
  Result<MeshReader> addMeshReader(
      const MeshFormat &format,
      std::function<Result<void>(const MeshSource &, Progress, const MeshSink &)> read) const {
    MeshReader out;
    out.read_ = std::make_unique<MeshReader::Read>(std::move(read));
    const auto thunk = [](void *self, const c3de_mesh_source *source, const c3de_progress *progress,
                          const c3de_mesh_sink *sink) noexcept -> c3de_status {
      return guard([&] {
        const MeshSource given{text(source->path),
                               {static_cast<const char *>(source->bytes), static_cast<std::size_t>(source->bytes_n)}};
        return (*static_cast<MeshReader::Read *>(self))(given, Progress(progress), MeshSink(sink));
      });
    };
    std::vector<c3de_str> extensions;
    for (const std::string_view one : format.extensions) extensions.push_back(str(one));
    const c3de_mesh_reader reader{sizeof(c3de_mesh_reader),
                                  1,
                                  str(format.id),
                                  str(format.label),
                                  extensions.data(),
                                  extensions.size(),
                                  str(format.magic),
                                  out.read_.get(),
                                  +thunk};
    auto owned = own<&c3de_files_v1::add_mesh_reader, Owned<c3de_files_v1, &c3de_files_v1::remove>>(&reader);
    if (!owned) return owned.failure();
    out.owned_ = std::move(*owned);
    return out;
  }
  /// @param write  any thread, several at once; puts the bytes of the file, or fails or throws with why it cannot. Ask its
  ///               progress several times a second, as a reader does.
  /// Error: C3DE_E_VERSION of a host without writers.
  Result<MeshWriter> addMeshWriter(const MeshFormat &format,
                                   std::function<Result<void>(const MeshContents &, Progress, c3de_sink)> write) const {
    if (table_ && table_->rev < 2)
      return Failure{C3DE_E_VERSION, "the host takes no writers (c3de.files/1 of revision 1)"};
    MeshWriter out;
    out.write_ = std::make_unique<MeshWriter::Write>(std::move(write));
    const auto thunk = [](void *self, const c3de_mesh_contents *mesh, const c3de_progress *progress,
                          c3de_sink bytes) noexcept -> c3de_status {
      return guard([&] {
        const MeshContents given{
            text(mesh->name),
            {static_cast<const Vec3 *>(mesh->positions_mm.data), mesh->positions_mm.count},
            {static_cast<const std::array<std::uint32_t, 3> *>(mesh->triangles.data), mesh->triangles.count}};
        return (*static_cast<MeshWriter::Write *>(self))(given, Progress(progress), bytes);
      });
    };
    std::vector<c3de_str> extensions;
    for (const std::string_view one : format.extensions) extensions.push_back(str(one));
    const c3de_mesh_writer writer{
        sizeof(c3de_mesh_writer), 1,     str(format.id), str(format.label), extensions.data(), extensions.size(),
        out.write_.get(),         +thunk};
    auto owned = own<&c3de_files_v1::add_mesh_writer, Owned<c3de_files_v1, &c3de_files_v1::remove>>(&writer);
    if (!owned) return owned.failure();
    out.owned_ = std::move(*owned);
    return out;
  }
};

}  // namespace c3de::sdk
