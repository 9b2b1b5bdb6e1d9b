// SPDX-License-Identifier: Apache-2.0
#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <charconv>
#include <cstdint>
#include <memory>

#include "c3de/core/input_file.h"
#include "c3de/core/path_text.h"
#include "file_text.h"
#include "ply_header.h"
#include "raw_mesh.h"

namespace c3de::geometry {
namespace {

/// "a%20b" to "a b"; text that is not an escape is unchanged.
std::string withoutEscapes(std::string_view uri) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned char byte = 0;
    const char *from = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() && std::from_chars(from, from + 2, byte, 16).ptr == from + 2) {
      out += static_cast<char>(byte);
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

/// The files visible to assimp: the mesh, which is in memory already, so that paths in any script work on any system,
/// and the files that a glTF names by their URIs.
class MeshFiles : public Assimp::IOSystem {
 public:
  MeshFiles(const std::filesystem::path &path, const std::string &text)
      : folder_(path.parent_path()), name_(displayPath(path)), text_(text) {}

  /// Why a file that the mesh names could not be read; empty: no such failure.
  [[nodiscard]] const std::string &problem() const { return problem_; }

  bool Exists(const char *file) const override { return file == name_ || checkInputFile(resolved(file)); }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream *Open(const char *file, const char * = "rb") override {
    if (file == name_) return stream(text_);
    auto read = readWholeFile(resolved(file));
    if (!read) {
      problem_ = read.error().message;
      return nullptr;
    }
    return stream(*others_.emplace_back(std::make_unique<std::string>(std::move(*read))));
  }
  void Close(Assimp::IOStream *stream) override { delete stream; }

 private:
  static Assimp::IOStream *stream(const std::string &bytes) {
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t *>(bytes.data()), bytes.size());
  }
  /// Resolves a path from assimp, which concatenates the folder of the mesh and a URI.
  [[nodiscard]] std::filesystem::path resolved(std::string_view file) const {
    const std::size_t own = name_.find_last_of("/\\") + 1;  // 0: no folder
    if (file.starts_with(std::string_view(name_).substr(0, own))) file.remove_prefix(own);
    const std::filesystem::path asWritten = namedFile(folder_, std::string(file));
    std::error_code code;
    if (std::filesystem::exists(asWritten, code)) return asWritten;
    if (file.starts_with("file:")) {
      file.remove_prefix(file.starts_with("file://") ? 7 : 5);
      constexpr bool kHasDrives = std::filesystem::path::preferred_separator == '\\';
      if (kHasDrives && file.size() > 2 && file[0] == '/' && file[2] == ':') file.remove_prefix(1);  // file:///C:/a.bin
    }
    return namedFile(folder_, withoutEscapes(file));
  }

  std::filesystem::path folder_;
  std::string name_;
  const std::string &text_;
  std::vector<std::unique_ptr<std::string>> others_;
  std::string problem_;
};

/// Appends the meshes of a node and its descendants with their transforms. A mesh may occur at several nodes.
Expected<void> addNode(const std::string &fileName, const aiScene &scene, const aiNode &node, const aiMatrix4x4 &parent,
                       int depth, RawMesh &raw) {
  if (depth > 256) return fail(ErrorCode::input, fileName + ": nodes nested more than 256 deep");
  const aiMatrix4x4 placement = parent * node.mTransformation;
  const bool mirrored = placement.Determinant() < 0.0f;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh &mesh = *scene.mMeshes[node.mMeshes[m]];
    const std::size_t first = raw.vertices.size();
    if (first + mesh.mNumVertices > 0xfffffffeu)
      return fail(ErrorCode::input, fileName + ": more than 4294967294 vertices");
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D p = placement * mesh.mVertices[v];
      raw.vertices.push_back({p.x, p.y, p.z});
    }
    std::vector<unsigned> corners;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace &face = mesh.mFaces[f];
      if (face.mNumIndices > kMaxFaceCorners)
        return fail(ErrorCode::input, fmt::format("{}: face {} has {} corners; up to {} are accepted", fileName, f,
                                                  face.mNumIndices, kMaxFaceCorners));
      corners.clear();
      for (unsigned i = 0; i < face.mNumIndices; ++i) {
        if (face.mIndices[i] >= mesh.mNumVertices)
          return fail(
              ErrorCode::input,
              fmt::format(
                  "{}: face {}: vertex index {} is out of range; the mesh has {} vertices, 0 to {} are accepted",
                  fileName, f, face.mIndices[i], mesh.mNumVertices, static_cast<long long>(mesh.mNumVertices) - 1));
        corners.push_back(static_cast<unsigned>(first) + face.mIndices[i]);
      }
      if (mirrored) std::reverse(corners.begin(), corners.end());
      if (!addFace(raw, corners))
        return fail(ErrorCode::input,
                    fmt::format("{}: face {} is a concave polygon with {} corners; up to 4096 are accepted", fileName,
                                f, corners.size()));
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c)
    if (auto ok = addNode(fileName, scene, *node.mChildren[c], placement, depth + 1, raw); !ok) return ok;
  return {};
}

}  // namespace

Expected<RawMesh> readWithAssimp(const std::filesystem::path &path) {
  const std::string name = displayPath(path);
  auto text = readWholeFile(path);  // existence, size and readability with the program's own messages
  if (!text) return tl::unexpected(text.error());
  const std::string extension = lowerExtension(path);
  if (extension == ".ply")
    if (auto ok = checkPlyHeader(name, *text); !ok) return tl::unexpected(ok.error());
  // No post-processing that changes vertices: welding, triangulation and the search for invalid values are done by the
  // clean-up, which reports its changes (and does not take minutes for a face with 600 000 corners).
  constexpr unsigned kFlags = aiProcess_ValidateDataStructure;
  try {
    Assimp::Importer importer;
    auto *const files = new MeshFiles(path, *text);
    importer.SetIOHandler(files);  // takes ownership
    const aiScene *scene = importer.ReadFile(name, kFlags);
    if (!scene)
      return fail(ErrorCode::input,
                  fmt::format("{}: cannot be read as {}: {}{}", name, extension.substr(1), importer.GetErrorString(),
                              files->problem().empty() ? "" : " (" + files->problem() + ")"));
    if (scene->mNumMeshes == 0 || !scene->mRootNode)
      return fail(ErrorCode::input, fmt::format("{}: no surface in it; is this a {} file?", name, extension.substr(1)));
    RawMesh raw;
    if (auto ok = addNode(name, *scene, *scene->mRootNode, aiMatrix4x4(), 0, raw); !ok)
      return tl::unexpected(ok.error());
    if (raw.triangles.empty())
      return fail(ErrorCode::input,
                  fmt::format("{}: {} vertices but no faces; a surface is expected", name, raw.vertices.size()));
    return raw;
  } catch (const std::exception &exception) {
    return fail(ErrorCode::input,
                fmt::format("{}: cannot be read as {}: {}", name, extension.substr(1), exception.what()));
  }
}

}  // namespace c3de::geometry
