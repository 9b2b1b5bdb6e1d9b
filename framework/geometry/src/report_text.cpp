// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "c3de/geometry/mesh_report.h"

namespace c3de::geometry {
namespace {

std::string volumeText(double volume_mm3) {
  const double magnitude = volume_mm3 < 0.0 ? -volume_mm3 : volume_mm3;
  if (magnitude >= 1e9) return fmt::format("{:.4g} L", volume_mm3 / 1e6);
  if (magnitude >= 10.0) return fmt::format("{:.4g} cm³ (mL)", volume_mm3 / 1e3);
  return fmt::format("{:.4g} mm³", volume_mm3);
}

const char *yesNo(bool value) { return value ? "yes" : "no"; }

}  // namespace

std::string MeshReport::text() const {
  const Vec3 size = box.max - box.min;
  std::string out;
  out += fmt::format("vertices     {}\n", vertices);
  out += fmt::format("triangles    {}{}\n", triangles,
                     degenerateTriangles ? fmt::format(" ({} without area)", degenerateTriangles) : "");
  out += fmt::format("parts        {}\n", components);
  out +=
      fmt::format("size         {:.4g} x {:.4g} x {:.4g} mm (read in {})\n", size[0], size[1], size[2], unitName(unit));
  out += fmt::format("box          ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) mm\n", box.min[0], box.min[1],
                     box.min[2], box.max[0], box.max[1], box.max[2]);
  out += fmt::format("area         {:.4g} cm²\n", area_mm2 / 100.0);
  out += fmt::format("volume       {}\n", volumeText(volume_mm3));
  out += fmt::format("closed       {}{}\n", yesNo(closed),
                     boundaryEdges ? fmt::format(" ({} boundary edges)", boundaryEdges) : "");
  out += fmt::format("manifold     {}{}\n", yesNo(manifold),
                     nonManifoldEdges ? fmt::format(" ({} non-manifold edges)", nonManifoldEdges) : "");
  out += fmt::format("oriented     {}{}\n", yesNo(oriented),
                     misorientedEdges ? fmt::format(" ({} misoriented edges)", misorientedEdges) : "");
  for (const std::string &repair : repairs) out += "repaired: " + repair + "\n";
  for (const std::string &warning : warnings) out += "warning: " + warning + "\n";
  return out;
}

std::string MeshReport::json() const {
  const nlohmann::ordered_json document{
      {"kind", "mesh"},
      {"vertices", vertices},
      {"triangles", triangles},
      {"components", components},
      {"boundary_edges", boundaryEdges},
      {"non_manifold_edges", nonManifoldEdges},
      {"misoriented_edges", misorientedEdges},
      {"degenerate_triangles", degenerateTriangles},
      {"closed", closed},
      {"manifold", manifold},
      {"oriented", oriented},
      {"inside_out", insideOut},
      {"volume_mm3", volume_mm3},
      {"area_mm2", area_mm2},
      {"box_min_mm", box.min},
      {"box_max_mm", box.max},
      {"unit", unitName(unit)},
      {"repairs", repairs},
      {"warnings", warnings},
  };
  // File names from other systems may not be UTF-8: replace rather than throw.
  return document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace c3de::geometry
