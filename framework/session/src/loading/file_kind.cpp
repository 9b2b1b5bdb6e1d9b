// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/file_kind.h"
#include "c3de/core/file_path.h"

#include "c3de/core/input_file.h"
#include "c3de/core/path_text.h"

#include <string>

#include "c3de/geometry/mesh_formats.h"
#include "c3de/imaging/reading.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/recording_file.h"
#include "c3de/session/session_file.h"

namespace c3de::session {

FileKind kindOf(const std::filesystem::path &path, const geometry::MeshFormats *formats) {
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) return FileKind::image;
  if (scene::isScenePath(path)) return FileKind::scene;
  if (isSessionPath(path)) return FileKind::session;
  if (isRecordingPath(path)) return FileKind::recording;
  if (formats ? formats->isMeshFile(path) : geometry::isMeshFile(path)) return FileKind::mesh;
  return imaging::isLikelyImage(path) ? FileKind::image : FileKind::unknown;
}

Error unknownKind(const std::filesystem::path &path, const geometry::MeshFormats *formats) {
  std::error_code code;
  if (const std::string instead = describeNonFile(path); !instead.empty() && std::filesystem::exists(path, code))
    return {ErrorCode::input, path.string() + ": " + instead};
  if (isRecordingPath(path)) return {ErrorCode::input, path.string() + ": is a recording; `c3de replay` repeats it"};
  const auto own = geometry::meshExtensions();
  std::string meshes;
  for (const std::string &one : formats ? formats->extensions() : std::vector<std::string>(own.begin(), own.end()))
    meshes.append(meshes.empty() ? "" : ", ").append(one);
  return {ErrorCode::input,
          path.string() +
              ": is not a supported file; accepted: scenes (.toml), sessions (.c3de), images (NIfTI, NRRD, "
              "MetaImage, DICOM), meshes (" +
              meshes + ")"};
}

std::string notAFolder(const std::filesystem::path &path) {
  std::error_code code;
  return path.string() + (std::filesystem::exists(path, code) ? ": is a file, not a folder" : ": no such folder") +
         "; accepted: a folder of plugins";
}

std::string imageName(const std::filesystem::path &path) {
  const std::filesystem::path clean = normalPath(path);
  return pathText(clean.has_filename() ? clean.filename() : clean.parent_path().filename());
}

}  // namespace c3de::session
