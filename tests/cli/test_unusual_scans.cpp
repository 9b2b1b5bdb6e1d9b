// SPDX-License-Identifier: Apache-2.0
// Bodies of many tissues with unusual label maps and images.
#include <cmath>
#include <functional>
#include <limits>

#include "c3de/imaging/writing.h"
#include "program.h"
#include "support/catch.h"

using namespace c3de;
using Catch::Matchers::Contains;

namespace {

using Place = std::function<std::uint16_t(std::size_t, std::size_t, std::size_t)>;

Mat4 steps(double edge_mm) {
  Mat4 m{};
  m[0] = m[5] = m[10] = edge_mm;
  m[15] = 1.0;
  return m;
}

void writeLabels(const std::filesystem::path &file, const imaging::VolumeGeometry &grid, const Place &labelAt,
                 const std::vector<std::string> &names) {
  imaging::LabelMap map;
  map.geometry = grid;
  for (std::size_t k = 0; k < grid.size[2]; ++k)
    for (std::size_t j = 0; j < grid.size[1]; ++j)
      for (std::size_t i = 0; i < grid.size[0]; ++i) map.voxels.push_back(labelAt(i, j, k));
  for (std::size_t n = 0; n < names.size(); ++n)
    map.labels.push_back({static_cast<std::uint16_t>(n + 1), names[n], {0.5F, 0.5F, 0.5F}});
  REQUIRE(imaging::writeLabelMap(file, map));
}

void writeImage(const std::filesystem::path &file, const imaging::VolumeGeometry &grid,
                const std::function<float(std::size_t, std::size_t, std::size_t)> &valueAt) {
  imaging::Volume image;
  image.geometry = grid;
  std::vector<float> values;
  for (std::size_t k = 0; k < grid.size[2]; ++k)
    for (std::size_t j = 0; j < grid.size[1]; ++j)
      for (std::size_t i = 0; i < grid.size[0]; ++i) values.push_back(valueAt(i, j, k));
  image.voxels = std::move(values);
  REQUIRE(imaging::writeVolume(file, image));
}

bool isIn(std::size_t i, std::size_t from, std::size_t to) { return i >= from && i < to; }

/// Liver and spleen of 4 x 8 x 8 voxels with four in between, in 24 x 12 x 12.
std::uint16_t twoOrgans(std::size_t i, std::size_t j, std::size_t k) {
  if (!isIn(j, 2, 10) || !isIn(k, 2, 10)) return 0;
  return isIn(i, 6, 10) ? 1 : isIn(i, 14, 18) ? 2 : 0;
}

std::string sceneOf(const std::string &more, const std::string &volume = "labels.nrrd") {
  return "format = 1\n[[body]]\nname = \"scan\"\nvolume = \"" + volume +
         "\"\ntissues = \"known\"\nsampling = { spacing = 0.008 }\n" + more;
}

std::string backgroundOf(const std::string &from = "-150", const std::string &to = "250") {
  return "background = { material = \"fat\", image = \"ct.nrrd\", from = " + from + ", to = " + to + " }\n";
}

ProcessResult info(const std::filesystem::path &folder, const std::string &scene) {
  return runC3de({"info", "--json", writeFile(folder / "scene.toml", scene).string()});
}

nlohmann::json tissuesOf(const ProcessResult &run) {
  INFO(run.errorOutput);
  REQUIRE(run.exitCode == 0);
  return nlohmann::json::parse(run.output)["bodies"][0]["volume"]["tissues"];
}

}  // namespace

TEST_CASE("A background is found in an image of any grid, and what of it is empty is told", "[tissues]") {
  const auto folder = freshFolder("unusual-background");
  const imaging::VolumeGeometry grid{{24, 12, 12}, steps(4.0)};
  writeLabels(folder / "labels.nrrd", grid, twoOrgans, {"liver", "spleen"});
  const auto tissue = [](std::size_t i, std::size_t, std::size_t) { return isIn(i, 2, 22) ? 40.0F : -1000.0F; };
  writeImage(folder / "ct.nrrd", grid, tissue);
  const auto usual = info(folder, sceneOf(backgroundOf()));
  const auto usualTissues = tissuesOf(usual);
  REQUIRE(usualTissues.size() == 3);
  CHECK(usualTissues[2]["voxels"] == 20 * 12 * 12 - 512);
  CHECK_THAT(usual.errorOutput, !Contains("Background"));

  // Permuted axes: the image runs along z, against x and against y.
  imaging::VolumeGeometry turned{{12, 24, 12}, {}};
  turned.indexToWorld = {0, 0, 4, 0, -4, 0, 0, 0, 0, -4, 0, 0, 92, 44, 0, 1};
  writeImage(folder / "ct.nrrd", turned,
             [](std::size_t, std::size_t j, std::size_t) { return isIn(23 - j, 2, 22) ? 40.0F : -1000.0F; });
  CHECK(tissuesOf(info(folder, sceneOf(backgroundOf())))[2]["voxels"] == 20 * 12 * 12 - 512);

  imaging::VolumeGeometry aside = grid;
  aside.indexToWorld[12] = 48.0;
  writeImage(folder / "ct.nrrd", aside, [](std::size_t, std::size_t, std::size_t) { return 40.0F; });
  const auto half = info(folder, sceneOf(backgroundOf()));
  CHECK(tissuesOf(half)[2]["voxels"] == 12 * 12 * 12 - 256);
  CHECK_THAT(half.errorOutput, Contains("50 % of the voxels without a label lie beyond ct.nrrd"));

  aside.indexToWorld[12] = 480.0;
  writeImage(folder / "ct.nrrd", aside, tissue);
  const auto apart = info(folder, sceneOf(backgroundOf()));
  CHECK(apart.exitCode == 3);
  CHECK_THAT(apart.errorOutput, Contains("scene.toml:2") && Contains("lies beside") && Contains("accepted"));

  writeImage(folder / "ct.nrrd", grid, [&](std::size_t i, std::size_t j, std::size_t k) {
    return i == 3   ? std::numeric_limits<float>::quiet_NaN()
           : i == 4 ? std::numeric_limits<float>::infinity()
                    : tissue(i, j, k);
  });
  const auto holes = info(folder, sceneOf(backgroundOf()));
  CHECK_THAT(holes.errorOutput, Contains("288 voxels of ct.nrrd are not finite"));
  CHECK(tissuesOf(holes)[2]["voxels"] == 18 * 12 * 12 - 512);
  const auto nothing = info(folder, sceneOf(backgroundOf("500", "600")));
  CHECK_THAT(nothing.errorOutput, Contains("no value from -1000 to 40 that ct.nrrd has there is from 500 to 600"));
  CHECK(tissuesOf(nothing)[2]["voxels"] == 0);
}

TEST_CASE("A folder of masks is a label map, and what overlaps is told", "[tissues]") {
  const auto folder = freshFolder("unusual-masks");
  const auto masks = folder / "masks";
  std::filesystem::create_directories(masks);
  const imaging::VolumeGeometry grid{{24, 12, 12}, steps(4.0)};
  const auto box = [](std::size_t from, std::size_t to) {
    return [=](std::size_t i, std::size_t j, std::size_t k) {
      return static_cast<std::uint16_t>(isIn(i, from, to) && isIn(j, 2, 10) && isIn(k, 2, 10) ? 1 : 0);
    };
  };
  writeLabels(masks / "liver.nii.gz", grid, box(4, 12), {});
  writeLabels(masks / "pancreas.nii.gz", grid, box(0, 0), {});
  writeLabels(masks / "spleen.nii.gz", grid, box(10, 18), {});
  const auto run = info(folder, sceneOf("", "masks"));
  const auto tissues = tissuesOf(run);
  REQUIRE(tissues.size() == 2);
  CHECK(tissues[0]["label"] == "liver");
  CHECK(tissues[0]["voxels"] == 6 * 64);
  CHECK(tissues[1]["voxels"] == 8 * 64);
  CHECK_THAT(run.errorOutput, Contains("3 masks of the folder are labels") && Contains("share 128 voxels") &&
                                  Contains("Masks without a voxel: pancreas") &&
                                  Contains("spleen over liver (128 voxels)"));

  writeLabels(masks / "stomach.nii.gz", {{24, 12, 11}, steps(4.0)}, box(18, 20), {});
  const auto other = info(folder, sceneOf("", "masks"));
  CHECK(other.exitCode == 3);
  CHECK_THAT(other.errorOutput, Contains("stomach.nii.gz") && Contains("another grid (24 x 12 x 11 voxels)"));
  writeLabels(masks / "stomach.nii.gz", grid, twoOrgans, {});
  const auto several = info(folder, sceneOf("", "masks"));
  CHECK(several.exitCode == 3);
  CHECK_THAT(several.errorOutput, Contains("stomach.nii.gz") && Contains("holds 2 labels") && Contains("accepted"));
}

TEST_CASE("A name without a voxel, an empty map and bodies of the same labels are told", "[tissues]") {
  const auto folder = freshFolder("unusual-names");
  const imaging::VolumeGeometry grid{{24, 12, 12}, steps(4.0)};
  writeLabels(folder / "labels.nrrd", grid, twoOrgans, {"liver", "spleen", "pancreas"});
  CHECK_THAT(info(folder, sceneOf("")).errorOutput, Contains("named and have no voxel: pancreas"));
  const std::string again =
      "[[body]]\nname = \"other\"\nvolume = \"labels.nrrd\"\ntissues = [ { label = \"spleen\" } ]\n";
  CHECK_THAT(info(folder, sceneOf(again)).errorOutput,
             Contains("'scan' and 'other' lie in the same voxels") && Contains("both have: spleen"));
  CHECK_THAT(info(folder, sceneOf(again + "position = [1, 0, 0]\n")).errorOutput, !Contains("same voxels"));
  writeLabels(folder / "labels.nrrd", grid, [](std::size_t, std::size_t, std::size_t) { return std::uint16_t{0}; }, {});
  const auto empty = info(folder, sceneOf(""));
  CHECK(empty.exitCode == 3);
  CHECK_THAT(empty.errorOutput, Contains("all its voxels are 0"));
}

TEST_CASE("Organs of an oblique, sheared or mirrored scan lie where its axes say, with their volume", "[tissues]") {
  const auto folder = freshFolder("unusual-axes");
  const double c = std::cos(0.4), s = std::sin(0.4), t = std::sin(0.35);
  const Mat4 oblique{4 * c,     4 * s,      0,     0, -4 * s * c, 4 * c * c, 4 * s, 0,
                     4 * s * s, -4 * c * s, 4 * c, 0, 10,         -20,       30,    1};
  const Mat4 sheared{4, 0, 0, 0, 0, 4, 0, 0, 0, 4 * t, 4 * std::sqrt(1 - t * t), 0, 0, -40, 0, 1};
  const Mat4 mirrored{-4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0, 90, 0, 0, 1};
  for (const Mat4 &axes : {steps(4.0), oblique, sheared, mirrored}) {
    const imaging::VolumeGeometry grid{{24, 12, 12}, axes};
    CAPTURE(axes[0], axes[9]);
    writeLabels(folder / "labels.nrrd", grid, twoOrgans, {"liver", "spleen"});
    writeImage(folder / "ct.nrrd", grid, [](std::size_t i, std::size_t j, std::size_t k) {
      return isIn(i, 2, 22) && isIn(j, 1, 11) && isIn(k, 1, 11) ? 40.0F : -1000.0F;
    });
    const auto report =
        runToReport(writeFile(folder / "scene.toml", sceneOf(backgroundOf())), {"--steps", "1"})["bodies"][0];
    const double volume = 1e-9 * 2000 * grid.voxelVolume();
    CHECK(report["volume_m3"].get<double>() == Approx(volume).epsilon(1e-6));
    const Vec3 middle = grid.worldAt({11.5, 5.5, 5.5});
    Vec3 found{};
    for (std::size_t a = 0; a < 3; ++a) found[a] = 1e3 * report["centre_of_mass_m"][a].get<double>();
    // The organs differ by 3 % in density, which moves it by a fiftieth of a voxel towards the spleen.
    CHECK(norm(found - middle) < 0.4);
  }
}

TEST_CASE("Organs on both sides of a gap of one voxel part, and the table says which has gone", "[tissues]") {
  const auto folder = freshFolder("unusual-gap");
  const auto halves = [](std::size_t n, std::size_t gap) {
    return [=](std::size_t i, std::size_t j, std::size_t k) {
      const bool isInside = isIn(i, 1, n - 1) && isIn(j, 1, n / 2 - 1) && isIn(k, 1, n / 2 - 1);
      return static_cast<std::uint16_t>(!isInside || i == gap ? 0 : i < gap ? 1 : 2);
    };
  };
  const std::string pulled =
      "[[fix]]\nbody = \"scan\"\nregion = { box = { min = [-1, -1, -1], max = [0.006, 1, 1] } }\n"
      "[[load]]\nbody = \"scan\"\nregion = { box = { min = [0.0725, -1, -1], max = [1, 1, 1] } }\nforce = [0.2, 0, "
      "0]\n";
  writeLabels(folder / "labels.nrrd", {{40, 20, 20}, steps(2.0)}, halves(40, 20), {"liver", "spleen"});
  const auto scene = writeFile(folder / "scene.toml", sceneOf(pulled));
  const auto report = runToReport(scene, {"--until", "0.2"})["bodies"][0];
  CHECK(report["components"] == 2);
  // Half a F/m t² = 79 mm.
  CHECK(report["tissues"][0]["displacement_m"]["max"].get<double>() < 1e-4);
  CHECK(report["tissues"][1]["displacement_m"]["mean"].get<double>() == Approx(0.079).epsilon(0.05));

  // A gap of a thirtieth of a cell: it closes, and this is reported.
  writeLabels(folder / "labels.nrrd", {{160, 80, 80}, steps(0.5)}, halves(160, 81), {"liver", "spleen"});
  const auto glued = runC3de({"run", writeFile(folder / "fine.toml", sceneOf("")).string(), "--steps", "1", "--set",
                              "body.scan.sampling.spacing=0.016"});
  INFO(glued.errorOutput);
  CHECK(glued.exitCode == 0);
  CHECK_THAT(glued.errorOutput + glued.output, Contains("2 pieces that lie apart") && Contains("make 1"));
}

TEST_CASE("What is thinner than a cell is told, and a stiff vessel of that kind is felt", "[tissues]") {
  const auto folder = freshFolder("unusual-vessel");
  writeLabels(folder / "labels.nrrd", {{40, 20, 20}, steps(2.0)},
              [](std::size_t i, std::size_t j, std::size_t k) {
                if (!isIn(i, 1, 39) || !isIn(j, 1, 19) || !isIn(k, 1, 19)) return std::uint16_t{0};
                return static_cast<std::uint16_t>(isIn(j, 9, 11) && isIn(k, 9, 11) ? 2 : 1);
              },
              {"liver", "aorta"});
  const std::string pulled =
      "[[fix]]\nbody = \"scan\"\nregion = { box = { min = [-1, -1, -1], max = [0.006, 1, 1] } }\n"
      "[[load]]\nbody = \"scan\"\nregion = { box = { min = [0.0725, -1, -1], max = [1, 1, 1] } }\nforce = [0.2, 0, "
      "0]\n";
  const auto scene =
      writeFile(folder / "scene.toml", "format = 1\n[solver]\ndamping = 20\n" + sceneOf(pulled).substr(11));
  const auto way = [&](const std::vector<std::string> &more) {
    std::vector<std::string> arguments{"--until", "0.6", "--set", "body.scan.sampling.spacing=0.0187"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runToReport(scene, arguments)["bodies"][0]["centre_of_mass_m"][0].get<double>() - 0.039;
  };
  // 170 kPa in 1.2 % of the section of 6 kPa, a quarter less if all of it were carried at the cut ends.
  const double with = way({}), without = way({"--set", "body.scan.parts.1.material.youngs_modulus=6e3"});
  CHECK(with < 0.85 * without);
  CHECK(with > 0.7 * without);
  const auto run = runC3de({"run", scene.string(), "--steps", "1", "--set", "body.scan.sampling.spacing=0.0187"});
  CHECK_THAT(run.errorOutput, Contains("thinner than the spacing of 18.7 mm: artery"));
}
