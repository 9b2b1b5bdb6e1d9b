// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/mesh_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "clean_up.h"
#include "file_text.h"
#include "frame_comment.h"
#include "raw_mesh.h"
#include "wording.h"

namespace c3de::geometry {
namespace {

constexpr std::array<std::string_view, 9> kExtensions{".obj", ".stl", ".ply",  ".vtk", ".vtp",
                                                      ".off", ".glb", ".gltf", ".vtu"};

tl::unexpected<Error> cancelled(const std::string &what) { return fail(ErrorCode::cancelled, what + ": cancelled"); }

Expected<void> checkNumbers(const TriangleMesh &mesh, LengthUnit unit) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (unsigned v : mesh.triangles[t])
      if (v >= mesh.vertices.size())
        return fail(
            ErrorCode::input,
            fmt::format("triangle {}: vertex index {} is out of range; there are {} vertices, 0 to {} are accepted", t,
                        v, mesh.vertices.size(), static_cast<long long>(mesh.vertices.size()) - 1));
  const double limit = kMaxCoordinate_mm / millimetresPer(unit);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = mesh.vertices[v][k];
      if (!std::isfinite(x))
        return fail(ErrorCode::input, fmt::format("{} coordinate {} of vertex {} is not finite", "xyz"[k], x, v));
      if (std::abs(x) > limit)
        return fail(ErrorCode::input,
                    fmt::format("{} coordinate {:g} {} of vertex {} is beyond 1e9 mm; up to {:g} {} is accepted",
                                "xyz"[k], x, unitName(unit), v, limit, unitName(unit)));
    }
  return {};
}

/// @param origin  prefix of error messages: a file name or "mesh"
Expected<LoadedMesh> cleanUp(TriangleMesh mesh, LengthUnit unit, std::vector<std::string> repairs,
                             const std::string &origin, const ProgressFn &progress) {
  const auto report = [&](double fraction, const char *what) { return !progress || progress(fraction, what); };
  if (mesh.triangles.empty()) return fail(ErrorCode::input, origin + ": no faces; a surface is expected");
  if (auto ok = checkNumbers(mesh, unit); !ok) return fail(ok.error().code, origin + ": " + ok.error().message);
  const double scale = millimetresPer(unit);
  for (Vec3 &v : mesh.vertices) v = scale * v;

  // Removes unused vertices first: a distant stray point would enlarge the box, and with it the tolerances.
  removeUnusedVertices(mesh, repairs);
  if (!report(0.5, "welding vertices")) return cancelled(origin);
  weldVertices(mesh, repairs);
  removeDegenerateTriangles(mesh, repairs);
  removeDuplicateTriangles(mesh, repairs);
  std::vector<std::string> silent;  // vertices become unused in the steps above, which have reported it
  removeUnusedVertices(mesh, silent);
  if (mesh.triangles.size() < 4)
    return fail(
        ErrorCode::input,
        fmt::format("{}: {} triangles with an area are left; a surface around a volume has at least 4{}{}", origin,
                    mesh.triangles.size(), repairs.empty() ? "" : ". Cleaning up: ", fmt::join(repairs, "; ")));
  if (!report(0.7, "orienting triangles outwards")) return cancelled(origin);
  orient(mesh, repairs);
  if (!report(0.9, "inspecting the mesh")) return cancelled(origin);
  LoadedMesh loaded;
  loaded.report = inspect(mesh, unit);
  loaded.report.repairs = std::move(repairs);
  loaded.mesh = std::move(mesh);
  if (!report(1.0, "done")) return cancelled(origin);
  return loaded;
}

}  // namespace

std::span<const std::string_view> meshExtensions() { return kExtensions; }

bool isMeshFile(const std::filesystem::path &path) {
  return std::find(kExtensions.begin(), kExtensions.end(), lowerExtension(path)) != kExtensions.end();
}

std::optional<LengthUnit> unitInFile(const std::filesystem::path &path) { return frameCommentOf(path).unit; }

Expected<LoadedMesh> loadMesh(const std::filesystem::path &path, std::optional<LengthUnit> stated,
                              const ProgressFn &progress) {
  const std::string name = displayPath(path);
  if (!isMeshFile(path))
    return fail(ErrorCode::input, fmt::format("{}: meshes with the extension {} cannot be read; {} can", name,
                                              path.has_extension() ? quotedText(lowerExtension(path)) : "'' (none)",
                                              fmt::join(kExtensions, ", ")));
  if (progress && !progress(0.0, "reading " + displayPath(path.filename()))) return cancelled(name);
  const std::string extension = lowerExtension(path);
  const FrameComment said = frameCommentOf(path);
  const LengthUnit unit = stated.value_or(said.unit.value_or(LengthUnit::millimetre));
  Expected<RawMesh> raw = extension == ".obj"                          ? readObj(path, millimetresPer(unit))
                          : extension == ".stl"                        ? readStl(path)
                          : extension == ".vtk"                        ? readVtk(path)
                          : extension == ".vtp" || extension == ".vtu" ? readVtp(path)
                                                                       : readWithAssimp(path);
  if (!raw) return tl::unexpected(raw.error());
  std::vector<std::string> repairs = std::move(raw->notes);
  if (raw->facesDropped)
    repairs.push_back(fmt::format("{} with fewer than three different corners {} dropped",
                                  counted(raw->facesDropped, "face", "faces"), wasOrWere(raw->facesDropped)));
  if (raw->polygonsSplit)
    repairs.push_back(fmt::format("{} {} split into triangles", counted(raw->polygonsSplit, "polygon", "polygons"),
                                  wasOrWere(raw->polygonsSplit)));
  if (said.isRas) {
    // A half turn about z; the orientation of the triangles is unchanged.
    for (Vec3 &v : raw->vertices) v = {-v[0], -v[1], v[2]};
    repairs.push_back("the file states SPACE=RAS: x and y were converted to LPS");
  }
  auto loaded =
      cleanUp({std::move(raw->vertices), std::move(raw->triangles)}, unit, std::move(repairs), name, progress);
  if (loaded && stated && said.unit && *said.unit != *stated)
    loaded->report.warnings.push_back(unitsDiffer(*said.unit, *stated));
  if (loaded && !said.unknownUnit.empty())
    loaded->report.warnings.push_back(
        fmt::format("The unit {} stated in the file is not supported; {} is assumed; accepted: m, cm, mm.",
                    quotedText(said.unknownUnit), unitName(unit)));
  return loaded;
}

std::string unitsDiffer(LengthUnit said, LengthUnit stated) {
  return fmt::format("The file states the unit {}; it was read in {}, as requested.", unitName(said), unitName(stated));
}

Expected<LoadedMesh> buildMesh(TriangleMesh raw, LengthUnit unit, const std::string &origin,
                               std::vector<std::string> notes, const ProgressFn &progress) {
  return cleanUp(std::move(raw), unit, std::move(notes), origin, progress);
}

}  // namespace c3de::geometry
