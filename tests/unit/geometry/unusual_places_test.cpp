// SPDX-License-Identifier: Apache-2.0
// Meshes in other units, in several files, and paths without a regular file.
#include "c3de/geometry/mesh_formats.h"
#include "c3de/geometry/mesh_io.h"
#include "support/catch.h"
#include "support/gltf.h"
#include "support/pipes.h"
#include "test_files.h"

using namespace c3de;
using namespace c3de::geometry;

namespace {

double edge_mm(const std::filesystem::path &file, std::optional<LengthUnit> stated = std::nullopt) {
  const auto loaded = loadMesh(file, stated);
  if (!loaded) {
    FAIL_CHECK(loaded.error().message);
    return 0.0;
  }
  CHECK(loaded->report.closed);
  return loaded->report.box.max[0] - loaded->report.box.min[0];
}

}  // namespace

TEST_CASE("glTF is read in metres, unless another unit is asked for") {
  const auto file = test_files::write("m.glb", test::glb()), upper = test_files::write("UPPER.GLB", test::glb());
  CHECK_THAT(edge_mm(file), WithinRel(100.0, 1e-5));
  CHECK_THAT(edge_mm(upper), WithinRel(100.0, 1e-5));
  CHECK(unitInFile(file) == LengthUnit::metre);
  CHECK(MeshFormats().unitInFile(file) == LengthUnit::metre);
  CHECK_THAT(edge_mm(file, LengthUnit::centimetre), WithinRel(1.0, 1e-5));
  const auto asked = loadMesh(file, LengthUnit::millimetre);
  REQUIRE(asked);
  CHECK(test_files::contains(asked->report.warnings, "states the unit m; it was read in mm"));
}

TEST_CASE("A unit is taken from comments in the spellings of many programs") {
  const std::string obj(test_files::kTetrahedronObj);
  for (const auto &[comment, unit] : {std::pair{"# UNITS=m", LengthUnit::metre},
                                      {"# Units: Meters", LengthUnit::metre},
                                      {"#units = metres", LengthUnit::metre},
                                      {"# Unit : M", LengthUnit::metre},
                                      {"# unit=\"cm\"", LengthUnit::centimetre},
                                      {"# Unit: centimeter", LengthUnit::centimetre},
                                      {"# File units = centimetres", LengthUnit::centimetre},
                                      {"# exported, UNITS=mm", LengthUnit::millimetre},
                                      {"# units: millimeters", LengthUnit::millimetre},
                                      {"# Unit:MM", LengthUnit::millimetre}}) {
    INFO(comment);
    CHECK(unitInFile(test_files::write("unit.obj", std::string(comment) + "\n" + obj)) == unit);
  }
  CHECK(unitInFile(test_files::write("a.stl", "SOLID part UNITS=cm\nFACET\n")) == LengthUnit::centimetre);
  CHECK(unitInFile(test_files::write("a.ply", "ply\ncomment Units: meters\nend_header\n")) == LengthUnit::metre);
  for (const char *none : {"# unit: m/s", "# the units are mm", "# BUNIT=cm"}) {
    INFO(none);
    CHECK_FALSE(unitInFile(test_files::write("unit.obj", std::string(none) + "\n" + obj)));
  }
  for (const char *other : {"# UNITS=inch", "# Units: feet", "# unit = um"}) {
    INFO(other);
    const auto loaded = loadMesh(test_files::write("unit.obj", std::string(other) + "\n" + obj), std::nullopt);
    REQUIRE(loaded);
    CHECK(test_files::contains(loaded->report.warnings, "is not supported; mm is assumed"));
  }
}

TEST_CASE("Files that a glTF names are found by their URIs") {
  const auto folder = testOutputFolder();
  std::filesystem::create_directories(folder / "sub folder");
  test_files::write("plain.bin", test::gltfBuffer());
  test_files::write("with blank.bin", test::gltfBuffer());
  test_files::write("100%25.bin", test::gltfBuffer());
  test_files::write("h\xc3\xa9.bin", test::gltfBuffer());
  test_files::write("sub folder/in.bin", test::gltfBuffer());
  const std::string whole = std::filesystem::absolute(folder).generic_string();
  const std::string fileUri = (whole.starts_with('/') ? "file://" : "file:///") + whole;
  int n = 0;
  for (const std::string &uri :
       {std::string("plain.bin"), std::string("./plain.bin"), std::string("with%20blank.bin"),
        std::string("with blank.bin"), std::string("100%25.bin"), std::string("h%C3%A9.bin"),
        std::string("sub%20folder/in.bin"), std::string("sub folder\\\\in.bin"), std::string("sub%20folder%2Fin.bin"),
        fileUri + "/plain.bin", fileUri + "/with%20blank.bin",
        std::string(
            "data:application/octet-stream;base64,"
            "AAAAAAAAAAAAAAAAzczMPQAAAAAAAAAAAAAAAM3MzD0AAAAAAAAAAAAAAADNzMw9AAACAAEAAAABAAMAAAADAAIAAQACAAMA")}) {
    INFO(uri);
    CHECK_THAT(edge_mm(test_files::write("named" + std::to_string(n++) + ".gltf", test::gltf(uri))),
               WithinRel(100.0, 1e-5));
  }
  for (const char *uri : {"absent.bin", "absent%20too.bin", "sub%20folder"}) {
    INFO(uri);
    const auto loaded = loadMesh(test_files::write("absent.gltf", test::gltf(uri)), std::nullopt);
    REQUIRE_FALSE(loaded);
    CHECK_THAT(loaded.error().message, Contains("absent.gltf"));
    CHECK_THAT(loaded.error().message, Contains("no such file") || Contains("is a folder"));
  }
}

TEST_CASE("Messages name the file as it was asked for") {
  const std::string json = test::gltf(""), whole = test::glb();
  for (const auto &[name, bytes] :
       {std::pair<const char *, std::string>{"a.glb", "glTF"},
        {"b.glb", whole.substr(0, 200)},
        {"c.glb", json},
        {"d.glb", std::string(60, 'x')},
        {"a.gltf", "{"},
        {"b.gltf", json},
        {"c.gltf", "{\"asset\":{\"version\":\"9\"}}"},
        {"a.off", "OFF\n4 4 6\n0 0"},
        {"b.off", "nothing"},
        {"a.ply", "ply\nformat ascii 1.0\nend_header\n"},
        {"b.ply", "ply\nformat strange 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"}}) {
    const auto loaded = loadMesh(test_files::write(name, bytes), std::nullopt);
    REQUIRE_FALSE(loaded);
    INFO(loaded.error().message);
    CHECK_THAT(loaded.error().message, Contains(name) && !Contains("magic") && !Contains("$$$"));
  }
}

#if !defined(_WIN32)
TEST_CASE("A pipe, a device and a folder in place of a mesh are refused at once, by name") {
  for (const char *name : {"a.obj", "a.stl", "a.ply", "a.vtk", "a.vtp", "a.vtu", "a.off", "a.glb", "a.gltf"}) {
    INFO(name);
    const auto pipe = test::pipeAt(testOutputFolder() / name);
    const auto loaded = loadMesh(pipe, std::nullopt);
    REQUIRE_FALSE(loaded);
    CHECK_THAT(loaded.error().message, Contains(name) && Contains("is a pipe (FIFO), not a file"));
    (void)unitInFile(pipe);
  }
  const auto pipe = test::pipeAt(testOutputFolder() / "pipe.bin");
  const auto named = loadMesh(test_files::write("named.gltf", test::gltf("pipe.bin")), std::nullopt);
  REQUIRE_FALSE(named);
  CHECK_THAT(named.error().message, Contains("pipe.bin") && Contains("is a pipe"));
  const auto link = testOutputFolder() / "zero.stl";
  std::filesystem::remove(link);
  std::filesystem::create_symlink("/dev/zero", link);
  const auto device = loadMesh(link, std::nullopt);
  REQUIRE_FALSE(device);
  CHECK_THAT(device.error().message, Contains("zero.stl: is a device, not a file"));
}
#endif
