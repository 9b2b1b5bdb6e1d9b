// SPDX-License-Identifier: Apache-2.0
// The outer surface of meshes of cells, in legacy VTK and in VTU.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <sstream>

#include "c3de/geometry/mesh_io.h"
#include "support/catch.h"
#include "test_files.h"

using namespace c3de;
using namespace c3de::geometry;

namespace {

struct Cells {
  std::vector<Vec3> points;
  std::vector<std::vector<int>> cells;
  std::vector<int> types;
};

/// A box of 10 x 20 x 30 mm by its corners, x fastest.
std::vector<Vec3> box() {
  std::vector<Vec3> points;
  for (int v = 0; v < 8; ++v) points.push_back({v & 1 ? 10.0 : 0.0, v & 2 ? 20.0 : 0.0, v & 4 ? 30.0 : 0.0});
  return points;
}
const std::vector<std::vector<int>> kFive{{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}, {1, 2, 4, 7}};

Cells tetrahedra() { return {box(), kFive, {10, 10, 10, 10, 10}}; }

/// With a point at the centre of each edge; none of them is at its proper position on the surface of the box.
Cells secondOrder() {
  Cells all = tetrahedra();
  all.types.assign(5, 24);
  for (auto &cell : all.cells)
    for (const auto &[a, b] : {std::pair{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}) {
      all.points.push_back(0.5 * (all.points[static_cast<std::size_t>(cell[static_cast<std::size_t>(a)])] +
                                  all.points[static_cast<std::size_t>(cell[static_cast<std::size_t>(b)])]) +
                           Vec3{0.1, 0.2, 0.3});
      cell.push_back(static_cast<int>(all.points.size() - 1));
    }
  return all;
}

/// Each cell has its own points.
Cells apart() {
  Cells all;
  const auto points = box();
  all.types.assign(5, 10);
  for (const auto &cell : kFive) {
    all.cells.emplace_back();
    for (const int v : cell) {
      all.cells.back().push_back(static_cast<int>(all.points.size()));
      all.points.push_back(points[static_cast<std::size_t>(v)]);
    }
  }
  return all;
}

template <class T>
std::string bigEndian(T value) {
  std::array<char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), &value, sizeof(T));
  if constexpr (std::endian::native == std::endian::little) std::reverse(bytes.begin(), bytes.end());
  return {bytes.data(), bytes.size()};
}

std::string vtk(const Cells &all, bool isNew, bool isBinary) {
  std::ostringstream out;
  const auto put = [&](auto value) {
    if (isBinary)
      out << bigEndian(value);
    else
      out << value << "\n";
  };
  out << "# vtk DataFile Version " << (isNew ? "5.1" : "3.0") << "\nmade\n"
      << (isBinary ? "BINARY" : "ASCII") << "\nDATASET UNSTRUCTURED_GRID\nPOINTS " << all.points.size() << " double\n";
  for (const Vec3 &p : all.points)
    for (const double x : p) put(x);
  std::size_t corners = 0;
  for (const auto &cell : all.cells) corners += cell.size();
  out << "\nCELLS " << all.cells.size() + (isNew ? 1 : 0) << " " << corners + (isNew ? 0 : all.cells.size()) << "\n";
  if (isNew) {
    out << "OFFSETS vtktypeint64\n";
    std::int64_t at = 0;
    put(at);
    for (const auto &cell : all.cells) put(at += static_cast<std::int64_t>(cell.size()));
    out << "\nCONNECTIVITY vtktypeint64\n";
    for (const auto &cell : all.cells)
      for (const int v : cell) put(std::int64_t{v});
  } else {
    for (const auto &cell : all.cells) {
      put(static_cast<std::int32_t>(cell.size()));
      for (const int v : cell) put(std::int32_t{v});
    }
  }
  out << "\nCELL_TYPES " << all.types.size() << "\n";
  for (const int type : all.types) put(std::int32_t{type});
  out << "\nCELL_DATA " << all.cells.size() << "\nSCALARS part int\nLOOKUP_TABLE default\n";
  return out.str();
}

std::string vtu(const Cells &all) {
  std::ostringstream out;
  out << "<?xml version=\"1.0\"?><VTKFile type=\"UnstructuredGrid\" version=\"0.1\"><UnstructuredGrid>"
      << "<Piece NumberOfPoints=\"" << all.points.size() << "\" NumberOfCells=\"" << all.cells.size()
      << "\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">";
  for (const Vec3 &p : all.points) out << p[0] << " " << p[1] << " " << p[2] << "\n";
  out << "</DataArray></Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">";
  for (const auto &cell : all.cells)
    for (const int v : cell) out << v << " ";
  out << "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">";
  std::size_t at = 0;
  for (const auto &cell : all.cells) out << (at += cell.size()) << " ";
  out << "</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">";
  for (const int type : all.types) out << type << " ";
  out << "</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
  return out.str();
}

void checkBox(const std::string &name, const std::string &bytes, const char *note = "outer surface of") {
  INFO(name);
  const auto loaded = loadMesh(test_files::write(name, bytes), LengthUnit::millimetre);
  if (!loaded) {
    FAIL_CHECK(loaded.error().message);
    return;
  }
  INFO(loaded->report.text());
  CHECK(loaded->report.vertices == 8);
  CHECK(loaded->report.triangles == 12);
  CHECK(loaded->report.closed);
  CHECK(loaded->report.oriented);
  CHECK_THAT(loaded->report.volume_mm3, WithinRel(6000.0, 1e-9));
  CHECK(test_files::contains(loaded->report.repairs, note));
}

}  // namespace

TEST_CASE("Of cells with a volume the outer surface is read") {
  checkBox("new.vtk", vtk(tetrahedra(), true, false));
  checkBox("old.vtk", vtk(tetrahedra(), false, false));
  checkBox("new-binary.vtk", vtk(tetrahedra(), true, true));
  checkBox("old-binary.vtk", vtk(tetrahedra(), false, true));
  checkBox("tetrahedra.vtu", vtu(tetrahedra()));

  Cells turned = tetrahedra();
  for (auto &cell : turned.cells) std::swap(cell[0], cell[1]);
  checkBox("turned.vtk", vtk(turned, false, false));
  checkBox("apart.vtk", vtk(apart(), true, false));
  checkBox("second-order.vtk", vtk(secondOrder(), true, false), "with straight edges");
  checkBox("second-order.vtu", vtu(secondOrder()), "with straight edges");

  checkBox("voxel.vtk", vtk({box(), {{0, 1, 2, 3, 4, 5, 6, 7}}, {11}}, false, false));
  checkBox("hexahedron.vtk", vtk({box(), {{0, 1, 3, 2, 4, 5, 7, 6}}, {12}}, false, false));
  checkBox("wedges.vtk", vtk({box(), {{0, 1, 2, 4, 5, 6}, {1, 3, 2, 5, 7, 6}}, {13, 13}}, false, false));
  Cells pyramids{box(), {}, {}};
  pyramids.points.push_back({5, 10, 15});
  for (const auto &face : std::vector<std::vector<int>>{
           {0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}) {
    pyramids.cells.push_back(face);
    pyramids.cells.back().push_back(8);
    pyramids.types.push_back(14);
  }
  checkBox("pyramids.vtk", vtk(pyramids, false, false));

  Cells mixed = tetrahedra();  // as from mesh generators: the boundary as triangles and edges next to the cells
  mixed.cells.insert(mixed.cells.begin(), {{0}, {0, 1}, {0, 2, 1}, {4, 5, 7}});
  mixed.types.insert(mixed.types.begin(), {1, 3, 5, 5});
  checkBox("mixed.vtk", vtk(mixed, true, false), "2 polygons besides the volume cells were ignored");
}

TEST_CASE("A cavity inside of cells stays a cavity") {
  // A block of 3 x 3 x 3 voxels without the one in the middle.
  Cells all;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) all.points.push_back({10.0 * i, 10.0 * j, 10.0 * k});
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        if (i == 1 && j == 1 && k == 1) continue;
        const int v = i + 4 * (j + 4 * k);
        all.cells.push_back({v, v + 1, v + 4, v + 5, v + 16, v + 17, v + 20, v + 21});
        all.types.push_back(11);
      }
  const auto loaded = loadMesh(test_files::write("hollow.vtk", vtk(all, false, false)), LengthUnit::millimetre);
  REQUIRE(loaded);
  CHECK(loaded->report.components == 2);
  CHECK(loaded->report.closed);
  CHECK_THAT(loaded->report.volume_mm3, WithinRel(26000.0, 1e-9));
}

TEST_CASE("Cells that are faces are a surface") {
  const Cells faces{box(),
                    {{0, 2, 3, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {3, 7, 5}, {3, 5, 1}},
                    {9, 8, 7, 9, 9, 5, 5}};
  const auto loaded = loadMesh(test_files::write("faces.vtk", vtk(faces, true, false)), LengthUnit::millimetre);
  if (!loaded) FAIL(loaded.error().message);
  CHECK(loaded->report.closed);
  CHECK_THAT(loaded->report.volume_mm3, WithinRel(6000.0, 1e-9));
}

TEST_CASE("Cells that cannot be read are refused with what is wrong") {
  const auto refusal = [](const std::string &name, const std::string &bytes) {
    const auto loaded = loadMesh(test_files::write(name, bytes), LengthUnit::millimetre);
    return loaded ? std::string("was accepted") : loaded.error().message;
  };
  CHECK_THAT(refusal("type.vtk", vtk({box(), kFive, {10, 10, 42, 10, 10}}, true, false)),
             Contains("type.vtk") && Contains("cells of type 42"));
  CHECK_THAT(refusal("type.vtu", vtu({box(), kFive, {10, 10, 99, 10, 10}})), Contains("cells of type 99"));
  CHECK_THAT(refusal("short.vtk", vtk({box(), {{0, 1, 2}}, {10}}, true, false)), Contains("has 3 corners; it needs 4"));
  CHECK_THAT(refusal("types.vtk", vtk({box(), kFive, {10, 10}}, true, false)), Contains("5 CELLS with 2 CELL_TYPES"));
  CHECK_THAT(refusal("types.vtu", vtu({box(), kFive, {10, 10}})), Contains("5 cells with 2 types"));
  CHECK_THAT(refusal("far.vtk", vtk({box(), {{0, 1, 2, 8}}, {10}}, true, false)), Contains("point index 8"));
  CHECK_THAT(refusal("points.vtk", vtk({box(), {{0}, {1}}, {1, 1}}, true, false)), Contains("no cells with a surface"));
  const std::string whole = vtk(tetrahedra(), true, true);
  for (std::size_t length = 60; length + 60 < whole.size(); length += 7)
    CHECK_THAT(refusal("cut.vtk", whole.substr(0, length)), !Contains("was accepted"));
}
