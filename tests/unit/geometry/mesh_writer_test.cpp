// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/mesh_writer.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "c3de/geometry/mesh_io.h"
#include "c3de/geometry/vtk_writer.h"
#include "shapes.h"
#include "support/catch.h"
#include "test_files.h"

using namespace c3de;
using namespace c3de::geometry;

namespace {

/// No symmetry: mirroring or a swapped axis would be visible.
TriangleMesh lopsided() {
  TriangleMesh mesh = shapes::sphere({120.5, -33.25, 700.125}, 40.0, 3);
  for (Vec3 &v : mesh.vertices) v = {v[0] + 0.1 * v[1], 1.5 * v[1], v[2] + 0.3 * v[0]};
  return mesh;
}

std::string readAll(const std::filesystem::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// Corners of the triangles in their order, so that welding may renumber the vertices.
std::vector<Vec3> corners(const TriangleMesh &mesh) {
  std::vector<Vec3> out;
  for (const Triangle &t : mesh.triangles)
    for (const unsigned v : t) out.push_back(mesh.vertices[v]);
  return out;
}

double largestDifference(const TriangleMesh &a, const TriangleMesh &b) {
  const auto ca = corners(a), cb = corners(b);
  if (ca.size() != cb.size()) return std::numeric_limits<double>::infinity();
  double largest = 0.0;
  for (std::size_t i = 0; i < ca.size(); ++i) largest = std::max(largest, norm(ca[i] - cb[i]));
  return largest;
}

}  // namespace

TEST_CASE("A written surface is read again as it was, in millimetres without being told") {
  const TriangleMesh mesh = lopsided();
  const auto folder = testOutputFolder();
  for (const std::string extension : {".obj", ".stl", ".ply", ".vtp", ".STL"}) {
    INFO(extension);
    const auto path = folder / ("out" + extension);
    const auto written = writeMesh(path, mesh, {{}, "a liver -- with < and \n in its title"});
    if (!written) FAIL(written.error().message);
    CHECK(unitInFile(path) == LengthUnit::millimetre);
    CHECK_THAT(readAll(path).substr(0, 400), Contains("SPACE=LPS UNITS=mm"));
    CHECK_FALSE(std::filesystem::exists(path.string() + ".part"));
    const auto loaded = loadMesh(path, std::nullopt);
    if (!loaded) FAIL(loaded.error().message);
    CHECK(loaded->report.unit == LengthUnit::millimetre);
    CHECK(loaded->report.vertices == mesh.vertices.size());
    CHECK(loaded->report.closed);
    CHECK(loaded->report.oriented);
    // 32-bit coordinates up to 1000 mm (STL writes them, the reader of PLY retains them) are exact to 2^-15 mm an axis.
    // The error of the OBJ parser is some roundings of a double.
    const double exactness = extension == ".vtp" ? 0.0 : extension == ".obj" ? 1e-11 : 6e-5;
    CHECK(largestDifference(loaded->mesh, mesh) <= exactness);
    CHECK_THAT(signedVolume(loaded->mesh), WithinRel(signedVolume(mesh), 1e-5));
    CHECK(signedVolume(mesh) > 0.0);
  }
}

TEST_CASE("A stated unit wins over that of the file, and the report says so") {
  const TriangleMesh mesh = lopsided();
  const auto path = testOutputFolder() / "out.stl";
  REQUIRE(writeMesh(path, mesh));
  const auto asMetres = loadMesh(path, LengthUnit::metre);
  REQUIRE(asMetres);
  CHECK_THAT(asMetres->report.volume_mm3, WithinRel(1e9 * signedVolume(mesh), 1e-5));
  CHECK(test_files::contains(asMetres->report.warnings, "The file states the unit mm; it was read in m,"));
  const auto asMillimetres = loadMesh(path, LengthUnit::millimetre);
  REQUIRE(asMillimetres);
  CHECK_FALSE(test_files::contains(asMillimetres->report.warnings, "The file states"));
}

TEST_CASE("Units and RAS are found in the comments of every format, and nowhere else") {
  const std::string obj(test_files::kTetrahedronObj);
  CHECK(unitInFile(test_files::write("cm.obj", "# UNITS=cm\n" + obj)) == LengthUnit::centimetre);
  CHECK(unitInFile(test_files::write("m.obj", "# unit: m\n" + obj)) == LengthUnit::metre);
  CHECK_FALSE(unitInFile(test_files::write("none.obj", obj + "g UNITS=cm\n")));
  CHECK_FALSE(unitInFile(test_files::write("other.obj", "# UNITS=inch BUNITS=cm\n" + obj)));
  CHECK(unitInFile(test_files::write("a.stl", "solid part UNITS=cm\nfacet\n")) == LengthUnit::centimetre);
  CHECK(unitInFile(test_files::write("a.vtk", "# vtk DataFile Version 4.2\ntitle SPACE=RAS;UNITS=cm\nASCII\n")) ==
        LengthUnit::centimetre);
  CHECK_FALSE(unitInFile("nowhere/absent.obj"));
  const auto ras = loadMesh(test_files::write("ras.obj", "# SPACE=RAS\n" + obj), std::nullopt);
  REQUIRE(ras);
  CHECK(ras->report.box.min[0] == -10.0);
  CHECK(ras->report.box.min[1] == -10.0);
  CHECK(ras->report.box.max[2] == 10.0);
  CHECK(ras->report.volume_mm3 > 0.0);
  CHECK(test_files::contains(ras->report.repairs, "SPACE=RAS"));
}

TEST_CASE("PLY keeps arrays per vertex under names of one word") {
  const TriangleMesh mesh = shapes::box({0, 0, 0}, {1, 2, 3});
  PointArray shift{"displacement [mm]", 3, std::vector<double>(24, 0.25)},
      part{"body", 1, std::vector<double>(8, 7.0), PointArray::Type::whole};
  const auto path = testOutputFolder() / "box.ply";
  REQUIRE(writeMesh(path, mesh, {{shift, part}, ""}));
  const std::string bytes = readAll(path);
  CHECK_THAT(bytes, Contains("property float displacement_mm_x\nproperty float displacement_mm_y\nproperty float "
                             "displacement_mm_z\nproperty int body\n"));
  const std::size_t begin = bytes.find("end_header\n") + 11;
  CHECK(bytes.size() - begin == 8 * (24 + 12 + 4) + 12 * 13);
  CHECK(bytes.substr(begin + 24, 4) == std::string("\0\0\x80\x3e", 4));  // 0.25f
  CHECK(bytes[begin + 36] == 7);
  REQUIRE(loadMesh(path, std::nullopt));
}

TEST_CASE("What should not be written is refused by name and leaves nothing behind") {
  const TriangleMesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const auto folder = testOutputFolder();
  const auto refused = [&](const std::string &name, const TriangleMesh &what, const MeshWriteOptions &options = {}) {
    const auto written = writeMesh(folder / name, what, options);
    REQUIRE_FALSE(written);
    CHECK_THAT(written.error().message, Contains(name));
    CHECK_FALSE(std::filesystem::exists(folder / name));
    CHECK_FALSE(std::filesystem::exists(folder / (name + ".part")));
    return written.error();
  };
  CHECK_THAT(refused("a.3ds", mesh).message, Contains("'.3ds'") && Contains("accepted: .obj, .stl, .ply, .vtp"));
  CHECK(refused("a.3ds", mesh).code == ErrorCode::usage);
  CHECK_THAT(refused("noextension", mesh).message, Contains("(none)"));
  CHECK_THAT(refused("empty.obj", {}).message, Contains("no triangles"));
  TriangleMesh bad = mesh;
  bad.triangles[3][1] = 8;
  CHECK_THAT(refused("index.vtp", bad).message, Contains("triangle 3 names vertex 8 of 8"));
  bad = mesh;
  bad.vertices[2][1] = std::nan("");
  for (const char *name : {"nan.obj", "nan.stl", "nan.ply", "nan.vtp"})
    CHECK_THAT(refused(name, bad).message, Contains("y coordinate nan of point 2"));
  CHECK_THAT(refused("rows.vtp", mesh, {{{"a", 2, {1.0}}}, ""}).message, Contains("1 numbers for 8 points"));
  const std::vector<double> eight(8, 0.0);
  CHECK_THAT(refused("twice.ply", mesh, {{{"a", 1, eight}, {"a", 1, eight}}, ""}).message, Contains("'a'"));
  const auto absent = writeMesh(folder / "absent" / "a.obj", mesh);
  REQUIRE_FALSE(absent);
  CHECK(absent.error().code == ErrorCode::output);
  CHECK_THAT(absent.error().message, Contains("absent"));
  // A folder at its path: it remains.
  std::filesystem::create_directories(folder / "folder.obj");
  const auto onFolder = writeMesh(folder / "folder.obj", mesh);
  REQUIRE_FALSE(onFolder);
  CHECK(onFolder.error().code == ErrorCode::output);
}

TEST_CASE("VTP of other programs is read: text and inline base64, strips, several pieces, old headers") {
  const std::string head =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n";
  const std::string points =
      "<PointData><DataArray type=\"Float32\" Name=\"x\" format=\"ascii\">1 2 3 4</DataArray></PointData>"
      "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0  10 0 0\n 0 10 0  0 0 "
      "10</DataArray></Points>\n";
  const std::string tail = "</Piece></PolyData></VTKFile>";
  const std::string piece = "<Piece NumberOfPoints=\"4\" NumberOfPolys=\"4\">";
  const std::string polys =
      "<Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 2 1 0 1 3 0 3 2 1 2 3</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6 9 12</DataArray></Polys>";
  const auto volume = [](const std::string &name, const std::string &text) {
    const auto loaded = loadMesh(test_files::write(name, text), std::nullopt);
    if (!loaded) FAIL(loaded.error().message);
    CHECK(loaded->report.closed);
    return loaded->report.volume_mm3;
  };
  const double expected = 1000.0 / 6.0;
  CHECK_THAT(volume("ascii.vtp", head + piece + points + polys + tail), WithinRel(expected, 1e-6));
  // 4-byte header (48 bytes of Int32) in a block with the data: written out by hand with python's base64 module.
  const std::string inlined =
      "<Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"binary\">\n"
      "MAAAAAAAAAACAAAAAQAAAAAAAAABAAAAAwAAAAAAAAADAAAAAgAAAAEAAAACAAAAAwAAAA==\n</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6 9 12</DataArray></Polys>";
  CHECK_THAT(volume("inline.vtp", head + piece + points + inlined + tail), WithinRel(expected, 1e-6));
  // The same with the header as a separate block.
  std::string two = inlined;
  two.replace(two.find("MAAAAAAA"), 72, "MAAAAA==AAAAAAIAAAABAAAAAAAAAAEAAAADAAAAAAAAAAMAAAACAAAAAQAAAAIAAAADAAAA");
  CHECK_THAT(volume("two.vtp", head + piece + points + two + tail), WithinRel(expected, 1e-6));
  const std::string strip =
      "<Strips><DataArray type=\"UInt8\" Name=\"connectivity\" format=\"ascii\">0 1 3 2 0 1</DataArray>"
      "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">6</DataArray></Strips>";
  CHECK_THAT(volume("strip.vtp", head + piece + points + strip + tail), WithinRel(expected, 1e-6));
}

TEST_CASE("Broken VTP files are refused with the reason") {
  const TriangleMesh mesh = shapes::box({0, 0, 0}, {10, 10, 10});
  const auto path = testOutputFolder() / "whole.vtp";
  REQUIRE(writeMesh(path, mesh));
  const std::string whole = readAll(path);
  const auto refusal = [](const std::string &text) {
    const auto loaded = loadMesh(test_files::write("bad.vtp", text), std::nullopt);
    if (loaded) return std::string("was accepted");
    CHECK(loaded.error().code == ErrorCode::input);
    CHECK_THAT(loaded.error().message, Contains("bad.vtp"));
    return loaded.error().message;
  };
  const std::size_t end = whole.find("</AppendedData>") - 1;
  for (std::size_t length = 1; length < end; length += 7) {
    INFO(length);
    CHECK_THAT(refusal(whole.substr(0, length)), !Contains("was accepted"));
  }
  const auto with = [&](const std::string &from, const std::string &to) {
    std::string text = whole;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  CHECK_THAT(refusal(with("\"PolyData\"", "\"ImageData\"")), Contains("'ImageData'") && Contains("PolyData"));
  CHECK_THAT(refusal(with("NumberOfPoints=\"8\"", "NumberOfPoints=\"4000000000\"")),
             Contains("24 coordinates for 4000000000 points"));
  CHECK_THAT(refusal(with("NumberOfPoints=\"8\"", "NumberOfPoints=\"-8\"")), Contains("'-8'"));
  CHECK_THAT(refusal("<VTKFile type=\"PolyData\"><Piece NumberOfPoints=\"0\"/></VTKFile>"), Contains("no faces"));
  CHECK_THAT(refusal("hello"), Contains("VTKFile"));
}
