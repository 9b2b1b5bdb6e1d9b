// SPDX-License-Identifier: Apache-2.0
// File → body → simulation → exported image → file: left, front and head of the scan are preserved, on any grid.
#include "c3de/imaging/reading.h"
#include "c3de/imaging/sampling.h"
#include "c3de/imaging/writing.h"
#include "program.h"
#include "support/letter_phantom.h"

using namespace c3de;
using namespace c3de::test;

namespace {

/// Fraction of the pixels of a letter that are correct at the body's new position, as seen by a reader.
double readable(const imaging::Volume &volume, const LetterPlace &place, const Vec3 &right, const Vec3 &gone) {
  std::vector<Vec3> points;
  for (int row = 0; row < 7; ++row)
    for (int column = 0; column < 5; ++column)
      points.push_back(gone + place.middle + (kLetterPixel * (column - 2)) * right +
                       (kLetterPixel * (3 - row)) * place.up);
  std::vector<double> values(points.size());
  imaging::sampleLinear(volume, points, -1e9, values);
  int right_ones = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const bool isInk = letterRows(place.letter)[p / 5][p % 5] == '#';
    right_ones += (values[p] > 0.5 * (kBlock + kInk)) == isInk ? 1 : 0;
  }
  return right_ones / 35.0;
}

}  // namespace

TEST_CASE("Letters on a body that has moved read right in the exported image, from any grid and format") {
  for (const LetterGrid &grid : letterGrids())
    for (const char *name : {"phantom.nii.gz", "phantom.nrrd", "phantom.mha"}) {
      // Only NRRD and NIfTI store sheared grids.
      if (std::string(grid.name) == "sheared" && std::string(name) == "phantom.mha") continue;
      CAPTURE(grid.name, name);
      const auto folder = freshFolder("letters");
      const LetterPhantom phantom = letterPhantom(grid.size, grid.worldFromIndex);
      imaging::Volume volume;
      volume.geometry = {phantom.size, phantom.worldFromIndex};
      volume.voxels = phantom.voxels;
      REQUIRE(imaging::writeVolume(folder / name, volume));
      // 1.5 mm to the left, 2 to the front, 1 up, within 0.05 s.
      const Vec3 gone{1.5, -2.0, 1.0};
      const auto scene = writeFile(folder / "scene.toml",
                                   std::string("format = 1\n[image]\nfile = \"") + name +
                                       "\"\nrim = 5\n[world]\ngravity = [0, 0, 0]\n" + "[[body]]\nvolume = \"" + name +
                                       "\"\nthreshold = [" + std::to_string(0.5 * (kAir + kBlock)) +
                                       ", 1e6]\nvelocity = [0.03, -0.04, 0.02]\n" + "sampling = { count = 400 }\n");
      const auto ran =
          runC3de({"run", scene.string(), "--until", "0.05", "--export-image", (folder / "moved.nrrd").string()});
      INFO(ran.errorOutput);
      REQUIRE(ran.exitCode == 0);
      const auto moved = imaging::readVolume(folder / "moved.nrrd");
      REQUIRE(moved);
      for (const LetterPlace &place : kLetterPlaces) {
        CAPTURE(place.letter);
        CHECK(readable(moved->volume, place, place.right, gone) == 1.0);
        LetterPlace turned = place;
        turned.middle = -1.0 * place.middle;
        CHECK(readable(moved->volume, turned, place.right, gone) < 0.9);
        if (place.letter != 'A') CHECK(readable(moved->volume, place, -1.0 * place.right, gone) < 0.9);
      }
    }
}
