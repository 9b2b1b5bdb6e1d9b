// SPDX-License-Identifier: Apache-2.0
#include "deck.h"

#include <algorithm>
#include <map>
#include <ostream>

namespace peers {

void writeDeck(const TetraMesh &mesh, const Solid &solid, std::ostream &out) {
  out.precision(12);
  out << "*HEADING\nhanging organ\n*NODE, NSET=NALL\n";
  const auto node = [&](std::size_t number, const Vec3 &x) {
    out << number << ", " << x[0] << ", " << x[1] << ", " << x[2] << '\n';
  };
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) node(i + 1, mesh.nodes[i]);
  // CalculiX's order: corners, then the midpoints of 12 23 31 14 24 34.
  static constexpr std::size_t kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  std::map<std::pair<int, int>, std::size_t> middles;
  for (const auto &t : mesh.tetrahedra)
    for (const auto &edge : kEdges) {
      const auto key = std::minmax(t[edge[0]], t[edge[1]]);
      const std::size_t number = mesh.nodes.size() + middles.size() + 1;
      if (middles.emplace(key, number).second)
        node(number, 0.5 * (mesh.nodes[static_cast<std::size_t>(key.first)] +
                            mesh.nodes[static_cast<std::size_t>(key.second)]));
    }
  out << "*ELEMENT, TYPE=C3D10, ELSET=EALL\n";
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    out << e + 1;
    for (const int corner : mesh.tetrahedra[e]) out << ", " << corner + 1;
    for (const auto &edge : kEdges)
      out << ", " << middles.at(std::minmax(mesh.tetrahedra[e][edge[0]], mesh.tetrahedra[e][edge[1]]));
    out << '\n';
  }
  out << "*MATERIAL, NAME=M\n*ELASTIC\n"
      << solid.youngsModulus << ", " << solid.poissonRatio << "\n*DENSITY\n"
      << solid.density
      << "\n*SOLID SECTION, ELSET=EALL, MATERIAL=M\n*STEP, NLGEOM, INC=100\n*STATIC\n1.0, 1.0\n*BOUNDARY\n";
  const auto held = [&](int i) { return static_cast<std::size_t>(i) >= mesh.freeNodes; };
  for (std::size_t i = mesh.freeNodes; i < mesh.nodes.size(); ++i) out << i + 1 << ", 1, 3\n";
  for (const auto &[ends, number] : middles)
    if (held(ends.first) && held(ends.second)) out << number << ", 1, 3\n";
  out << "*DLOAD\nEALL, GRAV, " << kGravity.norm()
      << ", 0, 0, -1\n*NODE PRINT, NSET=NALL, FREQUENCY=1000\nU\n*END STEP\n";
}

}  // namespace peers
