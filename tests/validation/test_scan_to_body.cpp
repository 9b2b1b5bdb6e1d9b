// SPDX-License-Identifier: Apache-2.0
// Organs of a real scan, from the files to the simulated body: closed surfaces and fills with the volume of their
// voxels, and the time of each stage.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "c3de/geometry/mesh_report.h"
#include "c3de/imaging/masks.h"
#include "c3de/imaging/reading.h"
#include "c3de/imaging/surface.h"
#include "pointbased/lattice.h"
#include "pointbased/occupancy.h"
#include "support/catch.h"
#include "validation_table.h"

using namespace c3de::imaging;
using validation::judge;
using validation::Stopwatch;

namespace {

constexpr double kMost = 0.01;                       // of a volume, required of surfaces and fills
constexpr double kMetre = 1e-3, kCubicMetre = 1e-9;  // of millimetres

pointbased::Vec3 metres(const c3de::Vec3 &mm) { return kMetre * pointbased::Vec3(mm[0], mm[1], mm[2]); }

pointbased::Surface skinOf(const c3de::geometry::TriangleMesh &mesh) {
  pointbased::Surface skin;
  for (const c3de::Vec3 &v : mesh.vertices) skin.positions.push_back(metres(v));
  for (const c3de::Triangle &t : mesh.triangles) skin.triangles.push_back({t[0], t[1], t[2]});
  return skin;
}

const LabelMap::Label &labelNamed(const LabelMap &labels, const std::string &name) {
  const auto found = std::find_if(labels.labels.begin(), labels.labels.end(),
                                  [&](const LabelMap::Label &label) { return label.name == name; });
  if (found == labels.labels.end()) throw std::runtime_error("no label " + name);
  return *found;
}

/// One organ, 1 000 phyxels.
/// @return milliseconds of all of its stages
double makeBody(const LabelMap &labels, const std::string &organ, const std::string &from) {
  const std::string body = organ + ", " + from;
  const Mask mask = maskOf(labels, labelNamed(labels, organ).value);
  const double wanted = static_cast<double>(voxelCount(mask)) * labels.geometry.voxelVolume();

  const Stopwatch surfaceWatch;
  const auto surface = surfaceOf(mask);
  const double surfaceTime = surfaceWatch.milliseconds();
  REQUIRE(surface);
  const auto report = c3de::geometry::inspect(*surface, c3de::geometry::LengthUnit::millimetre);
  CHECK(report.closed);
  CHECK(report.manifold);
  CHECK(report.oriented);
  CHECK_FALSE(report.insideOut);
  judge(body, "volume of surface, mm3", {wanted, 0.0, report.volume_mm3, kMost, surfaceTime});

  const Stopwatch fillWatch;
  const auto fill = fillOf(mask);
  REQUIRE(fill);
  double sum = 0.0;
  for (const float part : fill->values) sum += static_cast<double>(part);
  const double fillTime = fillWatch.milliseconds();
  judge(body, "volume of fill, mm3", {wanted, 0.0, sum * fill->geometry.voxelVolume(), kMost, fillTime});

  const Stopwatch bodyWatch;
  const VolumeGeometry &g = fill->geometry;
  pointbased::Occupancy occupancy{g.size, fill->values, metres(g.worldAt({0, 0, 0})), {}};
  for (int a = 0; a < 3; ++a) {
    c3de::Vec3 next{};
    next[static_cast<std::size_t>(a)] = 1.0;
    occupancy.steps.col(a) = metres(g.worldAt(next)) - occupancy.origin;
  }
  const auto shape = pointbased::shapeOf(occupancy, skinOf(*surface));
  if (!shape) FAIL(shape.error());
  pointbased::LatticeSampling sampling;
  const auto lattice = pointbased::fillLattice(*shape, sampling, pointbased::serialFor());
  if (!lattice) FAIL(lattice.error());
  const double bodyTime = bodyWatch.milliseconds();
  double phyxels = 0.0;
  for (const double v : lattice->volumes) phyxels += v;
  // The volume found inside the cells, before scaling; and the simulated one.
  judge(body, "volume in cells, mm3", {wanted, 0.0, lattice->countedVolume / kCubicMetre, kMost, bodyTime});
  judge(body, "volume of phyxels, mm3", {wanted, 0.0, phyxels / kCubicMetre, kMost, 0.0});
  CHECK(lattice->positions.size() > 700);
  CHECK(lattice->positions.size() < 1400);
  return surfaceTime + fillTime + bodyTime;
}

constexpr const char *kOrgans[] = {"liver", "kidney_right", "kidney_left", "spleen"};

}  // namespace

TEST_CASE("Liver, kidneys and spleen of a CT become bodies with the volumes of their voxels", "[scan]") {
  // Labels and the image they were made from: 30 slices, with the liver cut at the border; 112 slices.
  for (const auto &[file, scanFile] :
       {std::pair{"example_seg", "example_ct_sm"}, std::pair{"example_seg_fast_force_split", "example_ct"}}) {
    C3DE_DATA_OR_SKIP(image, "volume/totalseg/" + std::string(scanFile) + ".nii.gz");
    C3DE_DATA_OR_SKIP(path, "volume/totalseg/" + std::string(file) + ".nii.gz");
    const Stopwatch imageWatch;
    const auto scan = readVolume(image);
    const double imageTime = imageWatch.milliseconds();
    const Stopwatch labelWatch;
    const auto labels = readLabelMap(path);
    const double labelTime = labelWatch.milliseconds();
    REQUIRE((scan && labels));

    // The organs are inside the image: their centre is tissue, not air or bone.
    for (const char *organ : kOrgans) {
      CAPTURE(file, organ);
      const auto onImage = resampled(labels->labels, scan->volume.geometry);
      REQUIRE(onImage);
      const std::uint16_t value = labelNamed(labels->labels, organ).value;
      const Mask there = maskOf(*onImage, value);
      CHECK(voxelCount(there) == voxelCount(maskOf(labels->labels, value)));
      double mean = 0.0;
      std::size_t at = 0;
      for (std::size_t k = 0; k < there.geometry.size[2]; ++k)
        for (std::size_t j = 0; j < there.geometry.size[1]; ++j)
          for (std::size_t i = 0; i < there.geometry.size[0]; ++i)
            if (there.voxels[at++] != 0) mean += scan->volume.value(i, j, k);
      mean /= static_cast<double>(voxelCount(there));
      CHECK(mean > -20.0);  // HU, between fat (-100) and bone; lungs and air around are far below
      CHECK(mean < 250.0);
    }

    double bodies = 0.0;
    for (const char *organ : kOrgans) bodies += makeBody(labels->labels, organ, file);
    char words[200];
    std::snprintf(words, sizeof words, "image %.0f ms, labels %.0f ms, four bodies %.0f ms; %.2f s in all", imageTime,
                  labelTime, bodies, 1e-3 * (imageTime + labelTime + bodies));
    validation::remark(std::string("scan to bodies, ") + file, words);
    CHECK(imageTime + labelTime + bodies < 10e3);  // from file to the first step, without window: below 10 s
  }
}
