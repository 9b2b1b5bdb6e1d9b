// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "c3de/geometry/mesh_io.h"
#include "support/catch.h"
#include "test_files.h"

using namespace c3de;
using namespace c3de::geometry;

namespace {

std::string refusal(std::string_view content, const std::string &name) {
  const auto loaded = loadMesh(test_files::write(name, content), LengthUnit::millimetre);
  if (loaded) return "was accepted";
  CHECK(loaded.error().code == ErrorCode::input);
  CHECK_THAT(loaded.error().message, Contains(name));
  return loaded.error().message;
}

void checkTetrahedron(std::string_view content, const std::string &name) {
  INFO(name);
  const auto loaded = loadMesh(test_files::write(name, content), LengthUnit::millimetre);
  if (!loaded) FAIL(loaded.error().message);
  CHECK(loaded->report.vertices == 4);
  CHECK(loaded->report.triangles == 4);
  CHECK(loaded->report.closed);
  CHECK(loaded->report.oriented);
  CHECK_THAT(loaded->report.volume_mm3, WithinRel(1000.0 / 6.0, 1e-6));
}

template <class T>
std::string bigEndian(std::initializer_list<T> values) {
  std::string out;
  for (T value : values) {
    std::array<unsigned char, sizeof(T)> bytes{};
    std::memcpy(bytes.data(), &value, sizeof(T));
    if constexpr (std::endian::native == std::endian::little) std::reverse(bytes.begin(), bytes.end());
    out.append(reinterpret_cast<const char *>(bytes.data()), sizeof(T));
  }
  return out;
}

const std::string kHead = "# vtk DataFile Version 4.2\ntitle\n";
const std::string kPoints = "DATASET POLYDATA\nPOINTS 4 float\n0 0 0 10 0 0\n0 10 0\n0 0 10\n";

}  // namespace

TEST_CASE("ASCII VTK in the classic layout is read") {
  checkTetrahedron(kHead + "ASCII\n" + kPoints + "POLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n", "classic.vtk");
}

TEST_CASE("ASCII VTK with lines, metadata and point data around the surface is read") {
  checkTetrahedron(
      kHead + "ASCII\n" + kPoints +
          "METADATA\nINFORMATION 0\n\nLINES 1 3\n2 0 1\nPOLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n\n"
          "POINT_DATA 4\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3 4\n",
      "around.vtk");
}

TEST_CASE("ASCII VTK in the layout of version 5.1 is read") {
  checkTetrahedron(
      "# vtk DataFile Version 5.1\ntitle\nASCII\n" + kPoints +
          "POLYGONS 5 12\nOFFSETS vtktypeint64\n0 3 6 9 12\nCONNECTIVITY vtktypeint64\n0 2 1 0 1 3 0 3 2\n1 2 3\n",
      "new.vtk");
}

TEST_CASE("Triangle strips in VTK are read with their alternating sense") {
  checkTetrahedron(kHead + "ASCII\n" + kPoints + "TRIANGLE_STRIPS 1 7\n6 0 1 3 2 0 1\n", "strips.vtk");
}

TEST_CASE("Binary VTK is read, float and double, both layouts") {
  const std::string floats =
      "DATASET POLYDATA\nPOINTS 4 float\n" + bigEndian<float>({0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10}) + "\n";
  const std::string doubles =
      "DATASET POLYDATA\nPOINTS 4 double\n" + bigEndian<double>({0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10}) + "\n";
  checkTetrahedron(kHead + "BINARY\n" + floats + "POLYGONS 4 16\n" +
                       bigEndian<std::int32_t>({3, 0, 2, 1, 3, 0, 1, 3, 3, 0, 3, 2, 3, 1, 2, 3}) + "\n",
                   "float.vtk");
  checkTetrahedron("# vtk DataFile Version 5.1\ntitle\nBINARY\n" + doubles + "POLYGONS 5 12\nOFFSETS vtktypeint64\n" +
                       bigEndian<std::int64_t>({0, 3, 6, 9, 12}) + "\nCONNECTIVITY vtktypeint64\n" +
                       bigEndian<std::int64_t>({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}) + "\n",
                   "double.vtk");
}

TEST_CASE("Broken VTK files are refused with the place and the value") {
  CHECK_THAT(refusal("hello\n", "bad.vtk"), Contains("bad.vtk:1") && Contains("legacy VTK"));
  CHECK_THAT(refusal(kHead + "ASCII\nDATASET STRUCTURED_GRID\n", "bad.vtk"),
             Contains("bad.vtk:4") && Contains("'STRUCTURED_GRID'") && Contains("POLYDATA"));
  CHECK_THAT(refusal(kHead + "ASCII\n" + kPoints, "bad.vtk"), Contains("4 points but no faces"));
  CHECK_THAT(refusal(kHead + "ASCII\n" + kPoints + "POLYGONS 1 4\n3 0 1 4\n", "bad.vtk"),
             Contains("point index 4") && Contains("0 to 3"));
  CHECK_THAT(refusal(kHead + "ASCII\n" + kPoints + "POLYGONS 1 4\n3 0 1 -1\n", "bad.vtk"), Contains("point index -1"));
  CHECK_THAT(refusal(kHead + "ASCII\n" + kPoints + "POLYGONS 1 4\n9 0 1 2\n", "bad.vtk"), Contains("9 corners"));
  CHECK_THAT(refusal(kHead + "ASCII\n" + kPoints + "POLYGONS 1 4\n3 0 1\n", "bad.vtk"), Contains("ends after"));
  CHECK_THAT(refusal(kHead + "ASCII\n" + kPoints +
                         "POLYGONS 2 3\nOFFSETS vtktypeint64\n0 9\nCONNECTIVITY vtktypeint64\n0 1 2\n",
                     "bad.vtk"),
             Contains("offset 9"));
  CHECK_THAT(refusal(kHead + "ASCII\nDATASET POLYDATA\nPOINTS 4000000000 float\n0 0 0\n", "bad.vtk"),
             Contains("4000000000"));
  CHECK_THAT(refusal(kHead + "ASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 nan 0\nPOLYGONS 0 0\n", "bad.vtk"),
             Contains("bad.vtk:6") && Contains("'nan'"));
  CHECK_THAT(refusal(kHead + "BINARY\nDATASET POLYDATA\nPOINTS 4 float\n12345", "bad.vtk"),
             Contains("ends before its 12 coordinates"));
  const std::string notFinite = "DATASET POLYDATA\nPOINTS 4 float\n" +
                                bigEndian<float>({0, 0, 0, std::nanf(""), 0, 0, 0, 10, 0, 0, 0, 10}) + "\n";
  CHECK_THAT(
      refusal(kHead + "BINARY\n" + notFinite + "POLYGONS 1 4\n" + bigEndian<std::int32_t>({3, 0, 1, 2}), "bad.vtk"),
      Contains("x coordinate nan of vertex 1"));
}

TEST_CASE("A truncated VTK file is refused wherever it ends") {
  const std::string whole = kHead + "ASCII\n" + kPoints + "POLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3";
  for (std::size_t length = 1; length < whole.size(); ++length) {
    INFO(whole.substr(0, length));
    CHECK_THAT(refusal(whole.substr(0, length), "cut.vtk"), !Contains("was accepted"));
  }
}

TEST_CASE("STL, PLY and OFF are read and welded") {
  checkTetrahedron(
      "solid t\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 10 0\nvertex 10 0 0\nendloop\nendfacet\n"
      "facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 10 0 0\nvertex 0 0 10\nendloop\nendfacet\n"
      "facet normal -1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 10\nvertex 0 10 0\nendloop\nendfacet\n"
      "facet normal 1 1 1\nouter loop\nvertex 10 0 0\nvertex 0 10 0\nvertex 0 0 10\nendloop\nendfacet\nendsolid t\n",
      "ascii.stl");
  checkTetrahedron(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n10 0 0\n0 10 0\n0 0 10\n3 0 2 1\n3 0 1 3\n3 0 3 2\n"
      "3 1 2 3\n",
      "ascii.ply");
  checkTetrahedron("OFF\n4 4 6\n0 0 0\n10 0 0\n0 10 0\n0 0 10\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n", "ascii.off");
}

TEST_CASE("Faces with fewer than three different corners are dropped and counted, in every format") {
  const std::string tetrahedron = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n", points = "0 0 0\n10 0 0\n0 10 0\n0 0 10\n";
  const std::string plyHead =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face ";
  const std::string plyTail = "\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string vtp =
      "<VTKFile type=\"PolyData\" version=\"1.0\"><PolyData><Piece NumberOfPoints=\"4\" NumberOfPolys=\"6\">"
      "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">" +
      points +
      "</DataArray></Points>"
      "<Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 2 1 0 1 3 0 3 2 "
      "1 2 3 0 1 2 3 2</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">"
      "3 6 9 12 14 17</DataArray></Polys></Piece></PolyData></VTKFile>";
  const std::string facet = "facet normal 0 0 1\nouter loop\n";
  const auto triangle = [&](const char *a, const char *b, const char *c) {
    return facet + "vertex " + a + "\nvertex " + b + "\nvertex " + c + "\nendloop\nendfacet\n";
  };
  const char *const o = "0 0 0", *const x = "10 0 0", *const y = "0 10 0", *const z = "0 0 10";
  const struct {
    const char *name;
    std::string text;
    const char *told;
  } cases[] = {
      {"short.obj", std::string(test_files::kTetrahedronObj) + "f 1 2\nf 3 4 3\n",
       "2 faces with fewer than three different corners were dropped"},
      {"none.obj", std::string(test_files::kTetrahedronObj) + "f\nf 1\n", "2 faces with fewer"},
      {"long.obj", std::string(test_files::kTetrahedronObj) + "f 1 2 1 2 1\n",
       "1 face with fewer than three different corners was dropped"},
      {"short.vtk", kHead + "ASCII\n" + kPoints + "POLYGONS 6 23\n" + tetrahedron + "2 0 1\n3 2 3 2\n",
       "2 faces with fewer"},
      {"short.vtp", vtp, "2 faces with fewer"},
      {"short.ply", plyHead + "6" + plyTail + points + tetrahedron + "2 0 1\n3 2 3 2\n", "2 faces with fewer"},
      {"short.off", "OFF\n4 6 6\n" + points + tetrahedron + "2 0 1\n3 2 3 2\n", "2 faces with fewer"},
      {"short.stl",
       "solid t\n" + triangle(o, y, x) + triangle(o, x, z) + triangle(o, z, y) + triangle(x, y, z) + triangle(o, x, o) +
           "endsolid t\n",
       "1 triangle that names a corner twice was dropped"},
  };
  for (const auto &one : cases) {
    INFO(one.name);
    const auto loaded = loadMesh(test_files::write(one.name, one.text), LengthUnit::millimetre);
    if (!loaded) FAIL(loaded.error().message);
    CHECK(loaded->mesh.triangles.size() == 4);
    CHECK(loaded->report.closed);
    INFO(loaded->report.text());
    CHECK(test_files::contains(loaded->report.repairs, one.told));
  }
  // Repeated consecutive corners do not change the face.
  const auto quad =
      loadMesh(test_files::write("quad.obj",
                                 "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 3 2\nf 1 2 4 4\nf 1 4 3\nf 2 3 4 2\n"),
               LengthUnit::millimetre);
  REQUIRE(quad);
  CHECK(quad->mesh.triangles.size() == 4);
  CHECK(quad->report.repairs.empty());
  // Nothing remains.
  const auto empty =
      loadMesh(test_files::write("empty.obj", "v 0 0 0\nv 10 0 0\nv 0 10 0\nf 1 2\n"), LengthUnit::millimetre);
  REQUIRE_FALSE(empty);
  CHECK_THAT(empty.error().message, Contains("no faces"));
}

TEST_CASE("Extensions are recognised in any case") {
  checkTetrahedron(test_files::kTetrahedronObj, "UPPER.OBJ");
  CHECK(isMeshFile("liver.STL"));
  CHECK_FALSE(isMeshFile("liver.nii.gz"));
}

TEST_CASE("Broken STL and PLY files are refused") {
  CHECK_THAT(refusal("solid nothing\nendsolid nothing\n", "bad.stl"), !Contains("was accepted"));
  CHECK_THAT(refusal(std::string(200, '\x55'), "bad.stl"), !Contains("was accepted"));
  // Binary: one triangle with a coordinate that is not a number.
  std::string binary(80, ' ');
  binary += std::string("\x01\0\0\0", 4);
  for (float value : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, std::nanf(""), 0.f, 0.f, 0.f, 1.f, 0.f}) {
    const std::string bytes = bigEndian<float>({value});
    binary.append(bytes.rbegin(), bytes.rend());
  }
  binary += std::string(2, '\0');
  CHECK_THAT(refusal(binary, "nan.stl"), Contains("x coordinate nan of vertex 1"));
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  CHECK_THAT(
      refusal(
          head + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n",
          "bad.ply"),
      !Contains("was accepted"));
  CHECK_THAT(refusal(head + "end_header\n0 0 0\n1 0 0\n0 1 0\n", "bad.ply"), !Contains("was accepted"));
  CHECK_THAT(refusal(head + "end_header\n0 0 0\n1 0 0\n0 1 0\n", "bad.ply"),
             Contains("bad.ply:7") && Contains("no faces"));
  // Headers on which assimp would not terminate.
  CHECK_THAT(refusal("ply\n", "bad.ply"), Contains("end_header"));
  CHECK_THAT(refusal(head + "element face 1\nproperty list uchar int", "bad.ply"), Contains("bad.ply:8"));
  CHECK_THAT(refusal(head + "element face 1\nproperty list uchar int vertex_indices\nproperty float nd_header\n0 0 0\n",
                     "bad.ply"),
             Contains("bad.ply:10"));
  CHECK_THAT(refusal("ply\nformat ascii 1.0\nelement vertex 4000000000\n", "bad.ply"), Contains("4000000000 elements"));
}
