// SPDX-License-Identifier: Apache-2.0
// Third-party meshes, with their known counts and defects.
#include "c3de/geometry/mesh_io.h"
#include "support/catch.h"
#include "test_files.h"

using namespace c3de;
using namespace c3de::geometry;
using test_files::contains;

namespace {

struct Known {
  const char *file;
  std::size_t vertices, triangles, components;
  double volume_mm3;
};

}  // namespace

TEST_CASE("Every mesh made by others loads, or is refused with a reason") {
  C3DE_DATA_OR_SKIP(folder, "mesh");
  std::size_t files = 0, fillable = 0;
  for (const auto &entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || !isMeshFile(entry.path())) continue;
    ++files;
    INFO(entry.path());
    const auto loaded = loadMesh(entry.path(), LengthUnit::millimetre);
    if (!loaded) {
      CHECK(loaded.error().message.size() > 20);
      continue;
    }
    CHECK(loaded->report.triangles == loaded->mesh.triangles.size());
    CHECK(loaded->report.degenerateTriangles == 0);
    CHECK_FALSE(loaded->report.insideOut);
    CHECK_FALSE(loaded->report.text().empty());
    fillable += checkFillable(loaded->mesh, loaded->report).has_value();
  }
  CHECK(files >= 31);
  CHECK(fillable + 1 >= files);  // all but the flat logo without a front and back
}

TEST_CASE("Closed organs have their known counts and volumes") {
  for (const Known &known :
       {Known{"sofa/liver.obj", 139, 274, 1, 36.57}, Known{"sofa/liver2.obj", 1170, 2336, 1, 1.147},
        Known{"sofa/liver-smooth.obj", 2194, 4384, 1, 39.27}, Known{"sofa/torus.obj", 800, 1600, 1, 8.745},
        Known{"sofa/SimpleThinCube.obj", 8, 12, 1, 136.5}, Known{"sofa/cubeQuad.obj", 1538, 3072, 1, 8.0},
        Known{"sofa/smCube27.obj", 26, 48, 1, 343.0}, Known{"sofa/n0.obj", 2011, 4022, 1, 0.1838},
        Known{"sofa/frog_quads.obj", 2397, 4790, 1, 156.3}, Known{"openhelp/Liver.stl", 15365, 30726, 1, 1.818e6},
        Known{"openhelp/Kidney_left.stl", 3287, 6570, 1, 1.916e5},
        Known{"openhelp/Pancreas.stl", 3099, 6190, 2, 8.581e4},
        Known{"gca/small_intestine_20k.vtk", 10002, 20000, 1, 1.062e6},
        Known{"ssvtk_liver_patient/liver.vtk", 10012, 20000, 6, 2.316e6},
        Known{"ssvtk_liver_patient/portal_vein.vtk", 4994, 9980, 2, 2.726e4},
        Known{"ssvtk_liver_patient/gallbladder.vtk", 1467, 2930, 1, 1.517e4},
        Known{"ssvtk_liver_patient/liver_tumours.vtk", 2028, 4052, 1, 9.668e4},
        Known{"beamadapter/aneurysm3d_collis.obj", 3204, 6404, 1, 65.04}}) {
    C3DE_DATA_OR_SKIP(path, std::string("mesh/") + known.file);
    INFO(known.file);
    const auto loaded = loadMesh(path, LengthUnit::millimetre);
    REQUIRE(loaded);
    CHECK(loaded->report.vertices == known.vertices);
    CHECK(loaded->report.triangles == known.triangles);
    CHECK(loaded->report.components == known.components);
    CHECK(loaded->report.closed);
    CHECK(loaded->report.manifold);
    CHECK(loaded->report.oriented);
    // The volumes are known to four figures; that of quadrilaterals that are not flat depends on their diagonals.
    CHECK_THAT(loaded->report.volume_mm3, WithinRel(known.volume_mm3, 2e-3));
    CHECK(checkFillable(loaded->mesh, loaded->report));
  }
}

TEST_CASE("The inside-out aneurysm is turned") {
  C3DE_DATA_OR_SKIP(path, "mesh/beamadapter/aneurysm3d_collis.obj");
  const auto loaded = loadMesh(path, LengthUnit::millimetre);
  REQUIRE(loaded);
  CHECK(contains(loaded->report.repairs, "inside out"));
}

TEST_CASE("Faulty organs are described by their faults and can be filled all the same") {
  struct Faulty {
    const char *file, *warning, *repair;
  };
  for (const Faulty &faulty :
       {Faulty{"sofa_env_nasty/grasp/liver_collision.stl", "16 separate parts", "oriented opposite to"},
        Faulty{"sofa_env_nasty/grasp/liver_collision.stl", "not closed", "coincident triangles"},
        Faulty{"sofa_env_nasty/liver_collision.stl", "15 edges have more than two triangles", "welded"},
        Faulty{"ssvtk_kidney/kidney.vtk", "5 boundary edges", ""},
        Faulty{"beamadapter/carotids.stl", "41 boundary edges", "inside out"},
        Faulty{"sofa/c_open.obj", "20 boundary edges", "200 copies"}}) {
    C3DE_DATA_OR_SKIP(path, std::string("mesh/") + faulty.file);
    INFO(faulty.file);
    const auto loaded = loadMesh(path, LengthUnit::millimetre);
    REQUIRE(loaded);
    CHECK(contains(loaded->report.warnings, faulty.warning));
    CHECK((*faulty.repair == '\0' || contains(loaded->report.repairs, faulty.repair)));
    CHECK(checkFillable(loaded->mesh, loaded->report));
  }
}

TEST_CASE("An outline without front and back is refused as open") {
  C3DE_DATA_OR_SKIP(path, "mesh/sofa/SOFA_collision_no_face.obj");
  const auto loaded = loadMesh(path, LengthUnit::millimetre);
  REQUIRE(loaded);
  const auto fill = checkFillable(loaded->mesh, loaded->report);
  REQUIRE_FALSE(fill);
  CHECK_THAT(fill.error().message, Contains("open"));
}

TEST_CASE("Livers of a few units can be filled when read in metres, a liver in millimetres cannot") {
  C3DE_DATA_OR_SKIP(small, "mesh/sofa/liver.obj");
  const auto sofa = loadMesh(small, LengthUnit::metre);
  REQUIRE(sofa);
  CHECK(contains(sofa->report.warnings, "larger than a person"));
  CHECK(checkFillable(sofa->mesh, sofa->report));
  C3DE_DATA_OR_SKIP(large, "mesh/openhelp/Liver.stl");
  const auto real = loadMesh(large, LengthUnit::metre);
  REQUIRE(real);
  const auto fill = checkFillable(real->mesh, real->report);
  REQUIRE_FALSE(fill);
  CHECK_THAT(fill.error().message, Contains("mesh_unit = \"mm\""));
}
