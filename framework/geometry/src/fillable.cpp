// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "c3de/geometry/mesh_report.h"
#include "c3de/geometry/winding_number.h"
#include "mesh_edges.h"
#include "size_limits.h"

namespace c3de::geometry {
namespace {

struct Probes {
  std::size_t inside = 0, undecided = 0;
};

/// Winding numbers on a coarse grid inside the box.
Probes probeInside(const TriangleMesh &mesh, const Box &box) {
  constexpr int kPerAxis = 16;
  const WindingNumber winding(mesh);
  const Vec3 size = box.max - box.min;
  Probes probes;
  for (int i = 0; i < kPerAxis; ++i)
    for (int j = 0; j < kPerAxis; ++j)
      for (int k = 0; k < kPerAxis; ++k) {
        const double w =
            winding.at({box.min[0] + (i + 0.5) / kPerAxis * size[0], box.min[1] + (j + 0.5) / kPerAxis * size[1],
                        box.min[2] + (k + 0.5) / kPerAxis * size[2]});
        probes.inside += w > 0.5;
        probes.undecided += std::abs(w - 0.5) < 0.25;
      }
  return probes;
}

tl::unexpected<Error> refuse(const std::string &why) {
  return fail(ErrorCode::input, "the mesh cannot be filled: " + why);
}

Expected<void> checkNumbers(const TriangleMesh &mesh) {
  if (mesh.triangles.size() < 4)
    return refuse(fmt::format("it has {} triangles; a closed surface has at least 4", mesh.triangles.size()));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (unsigned v : mesh.triangles[t])
      if (v >= mesh.vertices.size())
        return refuse(fmt::format("triangle {} names vertex {}, there are {}", t, v, mesh.vertices.size()));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    for (double x : mesh.vertices[v])
      if (!std::isfinite(x)) return refuse(fmt::format("coordinate {} of vertex {} is not finite", x, v));
  return {};
}

Expected<void> checkSize(const MeshReport &report) {
  const Vec3 size = report.box.max - report.box.min;
  const double diagonal = norm(size);
  if (diagonal > kMaxDiagonal_mm)
    return refuse(fmt::format(
        "it is {:.4g} m from corner to corner, but no organ or object next to a patient is larger than 10 m. "
        "It was read in {}; if its numbers are millimetres, set mesh_unit = \"mm\"",
        diagonal / 1000.0, unitName(report.unit)));
  if (isFlat(report.volume_mm3, diagonal))
    return refuse(fmt::format(
        "its volume is {:.3g} mm³ at a size of {:.3g} x {:.3g} x {:.3g} mm: it is flat or encloses nothing; "
        "a surface around a volume is expected",
        report.volume_mm3, size[0], size[1], size[2]));
  return {};
}

/// Where edges do not match, only sampling shows whether there is an inside.
Expected<void> checkInside(const TriangleMesh &mesh, const Box &box) {
  constexpr double kMaxUndecidedShare = 0.2;
  const Probes probes = probeInside(mesh, box);
  if (probes.inside == 0)
    return refuse(
        "no point of a 16 x 16 x 16 grid over its box lies inside (winding number above 0.5); is it inside out or "
        "open?");
  if (static_cast<double>(probes.undecided) > kMaxUndecidedShare * static_cast<double>(probes.inside))
    return refuse(
        fmt::format("inside and outside cannot be told apart: of a 16 x 16 x 16 grid over its box {} points lie "
                    "inside, and {} are undecided "
                    "(winding number 0.25 to 0.75); up to {:.0f} % are accepted. Its triangles face inconsistent ways "
                    "or leave gaps",
                    probes.inside, probes.undecided, 100.0 * kMaxUndecidedShare));
  return {};
}

}  // namespace

Expected<void> checkFillable(const TriangleMesh &mesh, const MeshReport &report) {
  if (auto good = checkNumbers(mesh); !good) return good;
  if (auto good = checkSize(report); !good) return good;
  const std::vector<TriangleSide> sides = sortedSides(mesh.triangles);
  bool balanced = true;
  forEachEdge(sides, [&](std::span<const TriangleSide> edge) { balanced = balanced && isBalanced(edge); });
  const std::vector<Hole> holes = findHoles(mesh, sides);
  const double share = holeShare(holes, report.area_mm2);
  if (share > kMaxHoleShare) {
    const Hole &h = holes.front();
    return refuse(fmt::format(
        "the surface is open: lids over its {} boundary edges would make up {:.3g} % of the surface, up to {:.0f} % is "
        "accepted. "
        "The largest opening is around ({:.4g}, {:.4g}, {:.4g}) mm with {:.3g} mm of rim; close it in a mesh editor",
        report.boundaryEdges, 100.0 * share, 100.0 * kMaxHoleShare, h.centre[0], h.centre[1], h.centre[2],
        h.perimeter_mm));
  }
  if (!balanced) return checkInside(mesh, report.box);
  if (report.volume_mm3 < 0.0)
    return refuse(fmt::format("it is inside out (volume {:.4g} mm³); flip its triangles, as loading from a file does",
                              report.volume_mm3));
  return {};
}

}  // namespace c3de::geometry
