// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/mesh_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clean_up.h"
#include "mesh_edges.h"
#include "size_limits.h"

namespace c3de::geometry {
namespace {

bool isFinite(const TriangleMesh &mesh) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                     [](const Vec3 &v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); });
}

bool indicesInRange(const TriangleMesh &mesh) {
  const std::size_t n = mesh.vertices.size();
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(),
                     [n](const Triangle &t) { return t[0] < n && t[1] < n && t[2] < n; });
}

std::string unitHint(LengthUnit unit) {
  return fmt::format("It was read in {}; if that is not its unit, set mesh_unit (m, cm or mm)", unitName(unit));
}

void warnAboutSize(const MeshReport &report, std::vector<std::string> &warnings) {
  const double diagonal = norm(report.box.max - report.box.min);
  if (diagonal > kWarnDiagonal_mm)
    warnings.push_back(
        fmt::format("The mesh is {:.3g} m from corner to corner: larger than a person. Is the unit right? {}.",
                    diagonal / 1000.0, unitHint(report.unit)));
  else if (diagonal < kSmallDiagonal_mm)
    warnings.push_back(
        fmt::format("The mesh is {:.3g} mm from corner to corner: smaller than any organ. Is the unit right? {}.",
                    diagonal, unitHint(report.unit)));
  if (isFlat(report.volume_mm3, diagonal))
    warnings.push_back(fmt::format("The volume is about zero ({:.3g} mm³): the surface is flat or encloses nothing.",
                                   report.volume_mm3));
}

void warnAboutEdges(const TriangleMesh &mesh, const std::vector<TriangleSide> &sides, const MeshReport &report,
                    std::vector<std::string> &warnings) {
  if (report.boundaryEdges > 0) {
    const std::vector<Hole> holes = findHoles(mesh, sides);
    const Hole &h = holes.front();
    warnings.push_back(fmt::format(
        "The surface is not closed: {} boundary edge{} in {} place{}, the largest around ({:.4g}, {:.4g}, {:.4g}) mm "
        "with {} edges and {:.3g} mm of rim.",
        report.boundaryEdges, report.boundaryEdges == 1 ? "" : "s", holes.size(), holes.size() == 1 ? "" : "s",
        h.centre[0], h.centre[1], h.centre[2], h.edges, h.perimeter_mm));
  }
  if (report.nonManifoldEdges > 0) {
    Vec3 where{};
    forEachEdge(sides, [&, seen = false](std::span<const TriangleSide> edge) mutable {
      if (seen || edge.size() <= 2) return;
      seen = true;
      where = 0.5 * (mesh.vertices[edge[0].low] + mesh.vertices[edge[0].high]);
    });
    warnings.push_back(fmt::format(
        "{} edge{} more than two triangles (non-manifold), the first near ({:.4g}, {:.4g}, {:.4g}) mm.",
        report.nonManifoldEdges, report.nonManifoldEdges == 1 ? " has" : "s have", where[0], where[1], where[2]));
  }
  if (report.misorientedEdges > 0)
    warnings.push_back(fmt::format("{} edge{} inconsistently oriented neighbours.", report.misorientedEdges,
                                   report.misorientedEdges == 1 ? " has" : "s have"));
}

void judgeEdges(const TriangleMesh &mesh, std::span<const TriangleSide> sides, MeshReport &report) {
  forEachEdge(sides, [&](std::span<const TriangleSide> edge) {
    if (edge.size() == 1)
      ++report.boundaryEdges;
    else if (edge.size() > 2)
      ++report.nonManifoldEdges;
    else if (edge[0].forward == edge[1].forward)
      ++report.misorientedEdges;
  });
  report.closed = report.boundaryEdges == 0 && !mesh.triangles.empty();
  report.manifold = report.nonManifoldEdges == 0;
  report.oriented = report.misorientedEdges == 0;
}

std::size_t countComponents(const TriangleMesh &mesh) {
  DisjointSets sets(mesh.vertices.size());
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const Triangle &t : mesh.triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
    for (unsigned v : t) used[v] = 1;
  }
  // The root of a group is one of its members, so a group with a triangle has a used root.
  std::size_t count = 0;
  for (unsigned v = 0; v < used.size(); ++v) count += used[v] && sets.find(v) == v;
  return count;
}

}  // namespace

MeshReport inspect(const TriangleMesh &original, LengthUnit unit) {
  MeshReport report;
  report.unit = unit;
  report.vertices = original.vertices.size();
  report.triangles = original.triangles.size();
  if (!indicesInRange(original)) {
    report.warnings.push_back("Some triangles name vertices that do not exist; no further checks were made.");
    return report;
  }
  if (!isFinite(original)) {
    report.warnings.push_back("Some coordinates are not finite; no further checks were made.");
    return report;
  }
  report.box = boundingBox(original);
  report.area_mm2 = surfaceArea(original);
  report.volume_mm3 = signedVolume(original);

  // Edges and components by position, so that a mesh split at texture seams is treated as one surface.
  TriangleMesh mesh = original;
  const std::vector<unsigned> first = firstAtSamePosition(mesh.vertices);
  for (Triangle &t : mesh.triangles)
    for (unsigned &v : t) v = first[v];
  const double diagonal = norm(report.box.max - report.box.min);
  for (const Triangle &t : mesh.triangles) report.degenerateTriangles += isDegenerate(mesh, t, diagonal);

  const std::vector<TriangleSide> sides = sortedSides(mesh.triangles);
  judgeEdges(mesh, sides, report);
  report.insideOut =
      report.closed && report.oriented && report.volume_mm3 < 0.0 && !isFlat(report.volume_mm3, diagonal);

  report.components = countComponents(mesh);
  if (mesh.triangles.empty()) {
    report.warnings.push_back("The mesh has no triangles.");
    return report;
  }
  warnAboutEdges(mesh, sides, report, report.warnings);
  if (report.components > 1)
    report.warnings.push_back(fmt::format("The surface consists of {} separate parts.", report.components));
  if (report.insideOut) report.warnings.push_back("The surface is inside out (its volume is negative).");
  warnAboutSize(report, report.warnings);
  return report;
}

}  // namespace c3de::geometry
