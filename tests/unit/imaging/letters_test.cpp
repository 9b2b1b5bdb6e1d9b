// SPDX-License-Identifier: Apache-2.0
// From a file to a surface and back: left, front and head of the scan are those of the mesh, for any voxel orientation.
#include <cmath>
#include <stdexcept>

#include "c3de/geometry/mesh_io.h"
#include "c3de/geometry/mesh_writer.h"
#include "c3de/geometry/winding_number.h"
#include "c3de/imaging/masks.h"
#include "c3de/imaging/surface.h"
#include "c3de/imaging/writing.h"
#include "images.h"
#include "support/dicom_series.h"
#include "support/letter_phantom.h"

using namespace images;
using namespace c3de::test;

namespace {

Volume volumeOf(const LetterGrid &grid) {
  LetterPhantom phantom = letterPhantom(grid.size, grid.worldFromIndex);
  Volume volume;
  volume.geometry = {phantom.size, phantom.worldFromIndex};
  volume.voxels = std::move(phantom.voxels);
  return volume;
}

/// Whether a reader at the letter's side sees the letter in the mesh.
/// @param right  of the reader
bool reads(const geometry::WindingNumber &mesh, const LetterPlace &place, const Vec3 &right) {
  for (int row = 0; row < 7; ++row)
    for (int column = 0; column < 5; ++column) {
      const Vec3 at = place.middle + (kLetterPixel * (column - 2)) * right + (kLetterPixel * (3 - row)) * place.up;
      const auto pixels = letterRows(place.letter)[static_cast<std::size_t>(row)];
      const bool isInk = pixels[static_cast<std::size_t>(column)] == '#';
      if ((mesh.at(at) > 0.5) != isInk) return false;
    }
  return true;
}

void checkLetters(const geometry::TriangleMesh &mesh) {
  const geometry::WindingNumber inside(mesh);
  for (const LetterPlace &place : kLetterPlaces) {
    CAPTURE(place.letter);
    CHECK(reads(inside, place, place.right));
    LetterPlace turned = place;
    turned.up = -1.0 * place.up;
    CHECK_FALSE(reads(inside, turned, place.right));
    turned = place;
    turned.middle = -1.0 * place.middle;
    CHECK_FALSE(reads(inside, turned, place.right));
    if (place.letter != 'A') CHECK_FALSE(reads(inside, place, -1.0 * place.right));  // A is its mirror image
  }
}

/// The surface of the region brighter than halfway between two values of the phantom.
geometry::TriangleMesh surfaceAbove(const Volume &volume, int low, int high) {
  const auto mask = threshold(volume, 0.5 * (low + high), 1e9);
  if (!mask) throw std::runtime_error(mask.error().message);
  auto surface = surfaceOf(*mask);
  if (!surface) throw std::runtime_error(surface.error().message);
  return std::move(*surface);
}

/// The scan as a user receives it, to the surface, to a mesh file and back.
void checkScan(const Volume &volume) {
  const geometry::TriangleMesh letters = surfaceAbove(volume, kBlock, kInk);
  checkLetters(letters);
  const auto file = testOutputFolder() / "letters.obj";
  const auto saved = geometry::writeMesh(file, letters);
  REQUIRE(saved);
  const auto again = geometry::loadMesh(file, geometry::LengthUnit::millimetre);
  REQUIRE(again);
  CHECK(again->report.closed);
  CHECK_FALSE(again->report.insideOut);
  checkLetters(again->mesh);
}

}  // namespace

TEST_CASE("Letters of a phantom are on their sides after NIfTI, NRRD and MetaImage", "[imaging][letters]") {
  for (const LetterGrid &grid : letterGrids())
    for (const char *format : {"nii.gz", "nrrd", "mha"}) {
      CAPTURE(grid.name, format);
      const auto file = testOutputFolder() / (std::string(grid.name) + "." + format);
      const Volume phantom = volumeOf(grid);
      REQUIRE(writeVolume(file, phantom));
      const auto loaded = readVolume(file);
      REQUIRE(loaded);
      CHECK(loaded->volume.voxels == phantom.voxels);
      CHECK(sameGrid(loaded->volume.geometry, phantom.geometry));
      checkScan(loaded->volume);
    }
}

TEST_CASE("Letters of a phantom are on their sides after a DICOM series", "[imaging][letters]") {
  for (const LetterGrid &grid : letterGrids()) {
    CAPTURE(grid.name);
    const Volume phantom = volumeOf(grid);
    const auto folder = emptyFolder(grid.name);
    writeDicomSeries(folder, grid.size, grid.worldFromIndex, std::get<std::vector<std::int16_t>>(phantom.voxels));
    const auto loaded = readVolume(folder);
    if (!loaded) FAIL(loaded.error().message);
    const Volume &volume = loaded->volume;
    CHECK(volume.unit == "HU");
    // The reader may reverse the order of the slices: the same values at the same world positions.
    const Mat4 indexOf = affineInverse(phantom.geometry.indexToWorld);
    REQUIRE(volume.geometry.size == phantom.geometry.size);
    std::size_t different = 0;
    double off = 0.0;
    for (std::size_t k = 0; k < volume.geometry.size[2]; k += 3)
      for (std::size_t j = 0; j < volume.geometry.size[1]; j += 3)
        for (std::size_t i = 0; i < volume.geometry.size[0]; ++i) {
          const Vec3 index = transformPoint(indexOf, volume.geometry.worldAt({double(i), double(j), double(k)}));
          const Vec3 whole{std::round(index[0]), std::round(index[1]), std::round(index[2])};
          off = std::max(off, norm(phantom.geometry.worldAt(index) - phantom.geometry.worldAt(whole)));
          std::array<std::size_t, 3> at{};
          for (std::size_t a = 0; a < 3; ++a) at[a] = static_cast<std::size_t>(whole[a]);
          different += volume.value(i, j, k) != phantom.value(at[0], at[1], at[2]);
        }
    CHECK(different == 0);
    CHECK(off < 1e-3);
    checkScan(volume);
  }
}

TEST_CASE("The label of the letters makes the same letters", "[imaging][letters]") {
  const LetterGrid grid = letterGrids().back();
  const LetterPhantom phantom = letterPhantom(grid.size, grid.worldFromIndex);
  const LabelMap labels{{grid.size, grid.worldFromIndex}, phantom.labels, {{1, "block", {}}, {2, "letters", {}}}};
  for (const char *name : {"labels.nii.gz", "labels.nrrd"}) {
    CAPTURE(name);
    REQUIRE(writeLabelMap(testOutputFolder() / name, labels));
    const auto loaded = readLabelMap(testOutputFolder() / name);
    REQUIRE(loaded);
    const auto surface = surfaceOf(maskOf(loaded->labels, 2));
    REQUIRE(surface);
    checkLetters(*surface);
  }
}

TEST_CASE("The block of the phantom has its sides where they are in the world", "[imaging][letters]") {
  for (const LetterGrid &grid : letterGrids()) {
    CAPTURE(grid.name);
    const auto report = geometry::inspect(surfaceAbove(volumeOf(grid), kAir, kBlock), geometry::LengthUnit::millimetre);
    CHECK(report.closed);
    for (std::size_t a = 0; a < 3; ++a) {  // within a voxel
      CHECK_THAT(report.box.min[a], WithinAbs(-kHalfBlock, 1.0));
      CHECK_THAT(report.box.max[a], WithinAbs(kHalfBlock, 1.0));
    }
    CHECK_THAT(report.volume_mm3, WithinRel(8.0 * kHalfBlock * kHalfBlock * kHalfBlock, 0.02));
  }
}
