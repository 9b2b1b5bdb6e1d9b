// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/tissues.h"

#include <algorithm>
#include <numeric>

#include "c3de/imaging/writing.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/tissue_motion.h"
#include "loading/body_geometry.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using c3de::test::cubeBody;
using c3de::test::RecordingSimulator;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

const scene::MaterialLibrary &presets() {
  static const auto library = scene::MaterialLibrary::load(fs::path(testResourcesFolder()) / "materials.toml");
  return library.value();
}

/// 20 x 4 x 4 voxels of 2 mm, four labels of five slices each.
fs::path writtenMap() {
  imaging::LabelMap map;
  map.geometry = {{20, 4, 4}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 1, 1, 1}};
  map.voxels.resize(320);
  for (std::size_t v = 0; v < 320; ++v) map.voxels[v] = static_cast<std::uint16_t>(1 + v % 20 / 5);
  map.labels = {{1, "liver", {}}, {2, "TRACHEA", {}}, {3, "rib left 3", {}}, {4, "gizmo", {}}};
  const fs::path file = testOutputFolder() / "tissues.nrrd";
  REQUIRE(imaging::writeLabelMap(file, map));
  return file;
}

/// Air in the slices from 7 on, tissue before.
fs::path writtenImage() {
  imaging::Volume image;
  image.geometry = {{20, 4, 4}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 1, 1, 1}};
  std::vector<float> values(320);
  for (std::size_t v = 0; v < 320; ++v) values[v] = v % 20 < 7 ? 0.0F : -1000.0F;
  image.voxels = std::move(values);
  const fs::path file = testOutputFolder() / "tissues-ct.nrrd";
  REQUIRE(imaging::writeVolume(file, image));
  return file;
}

scene::SceneFile sceneOf(const std::string &more) {
  (void)writtenMap();
  auto parsed = scene::parseScene("format = 1\n[[body]]\nname = \"scan\"\nvolume = \"tissues.nrrd\"\n" + more,
                                  testOutputFolder() / "tissues.toml", &presets());
  if (!parsed) FAIL(parsed.error().message);
  return std::move(*parsed);
}

std::size_t countOf(const imaging::LabelMap &map, std::uint16_t value) {
  return static_cast<std::size_t>(std::count(map.voxels.begin(), map.voxels.end(), value));
}

}  // namespace

TEST_CASE("Known tissues are settled once, with their labels and parts", "[tissues]") {
  scene::SceneFile scene = sceneOf("tissues = \"known\"\n");
  BodySources sources;
  Preparation took;
  REQUIRE(scene::applyOverride(scene, "body.scan.parts.0.material.youngs_modulus=1e4", &presets()));
  REQUIRE(resolveTissues(scene, presets(), sources, {}, took));
  const scene::SceneBody &body = scene.bodies.front();
  REQUIRE(body.volume.tissues.size() == 3);
  CHECK(body.volume.tissues[1].isEmpty);
  CHECK(body.volume.tissues[2].isRigid);
  CHECK(body.volume.tissues[2].labels.front().value == 3);
  REQUIRE(body.parts.size() == 1);
  const auto stiffness = std::find_if(body.parts[0].params.begin(), body.parts[0].params.end(),
                                      [](const auto &value) { return value.value.id == "material.youngs_modulus"; });
  CHECK(stiffness->value.num == 1e4);
  CHECK(took.reading_s > 0.0);
  REQUIRE(resolveTissues(scene, presets(), sources, {}, took));
  CHECK(body.parts.size() == 1);
  CHECK(body.volume.tissues.size() == 3);
}

TEST_CASE("Airways are of the background where the image shows tissue, and labels of no tissue everywhere",
          "[tissues]") {
  (void)writtenImage();
  scene::SceneFile scene = sceneOf(
      "tissues = \"known\"\nbackground = { material = \"fat\", image = \"tissues-ct.nrrd\", from = -150, to = "
      "250 }\n");
  BodySources sources;
  Preparation took;
  CHECK_FALSE(sources.pick(scene.bodies[0].volume, {}, took));  // not settled
  REQUIRE(resolveTissues(scene, presets(), sources, {}, took));
  const auto picked = sources.pick(scene.bodies[0].volume, {}, took);
  REQUIRE(picked);
  // Slices of 16 voxels: 5 of liver, 2 of 5 of the trachea, 5 of bone, 5 of an unknown tissue.
  CHECK(countOf(*picked->tissues, 1) == 80);
  CHECK(countOf(*picked->tissues, 2) == 0);
  CHECK(countOf(*picked->tissues, 3) == 80);
  CHECK(countOf(*picked->tissues, 4) == 2 * 16 + 80);
  CHECK(countOf(*picked->tissues, 0) == 3 * 16);
  const auto places = sources.placesOf(scene.bodies[0], *picked);
  REQUIRE(places);
  REQUIRE(places->labels.size() == 4);
  CHECK(places->labels[0].voxels == 80);
  CHECK(places->labels[0].sample.size() == 80);
  CHECK(norm(places->labels[0].sample[0] - Vec3{1, 1, 1}) < 1e-9);
  CHECK(places->labels[2].name == "gizmo");
  CHECK(places->labels[2].tissue == 3);
  CHECK(places->labels[3].value == 0);
  CHECK(places->labels[3].voxels == 2 * 16);
  CHECK(places->tissueAt(3).label == "background");
}

TEST_CASE("What mending takes away is of no tissue, and a known tissue without a voxel has no part", "[tissues]") {
  scene::SceneFile scene =
      sceneOf("tissues = [ { label = 1 }, { label = 4, material = \"fat\" } ]\nmend = { largest = true }\n");
  BodySources sources;
  Preparation took;
  REQUIRE(resolveTissues(scene, presets(), sources, {}, took));
  auto picked = sources.pick(scene.bodies[0].volume, {}, took);
  REQUIRE(picked);
  CHECK(countOf(*picked->tissues, 1) == 80);
  CHECK(countOf(*picked->tissues, 2) == 0);
  BodyGeometry geometry;
  geometry.volume_mm3 = 640.0;
  auto added = addTissues(scene.bodies[0].volume, *picked->tissues, 100.0, geometry);
  REQUIRE_FALSE(added);
  CHECK_THAT(added.error().message, Contains("tissue '4' has no voxel of its own"));
  geometry.tissues.clear();
  scene.bodies[0].volume.usesKnownTissues = true;
  REQUIRE(addTissues(scene.bodies[0].volume, *picked->tissues, 100.0, geometry));
  REQUIRE(geometry.tissues.size() == 2);
  CHECK(geometry.tissues[0]);
  CHECK_FALSE(geometry.tissues[1]);
}

TEST_CASE("Labels are followed by what the simulator says, and it may not say", "[tissues]") {
  scene::SceneFile scene = sceneOf("tissues = \"known\"\n");
  BodySources sources;
  Preparation took;
  REQUIRE(resolveTissues(scene, presets(), sources, {}, took));
  const auto picked = sources.pick(scene.bodies[0].volume, {}, took);
  REQUIRE(picked);
  const auto places = sources.placesOf(scene.bodies[0], *picked);
  REQUIRE(places);
  RecordingSimulator simulator;
  simulator.bodies = {cubeBody(0.04, {0, 0, 0}, {0.003, 0, 0.004})};
  simulator.displacement_m = {0.003, 0, 0.004};
  auto motions = tissueMotions(simulator.table(), simulator.object(), {*places});
  REQUIRE(motions);
  REQUIRE(motions->size() == 1);
  const LabelMotion liver = motions->front().ofTissue(0), bone = motions->front().ofTissue(2);
  CHECK(liver.followed == 80);
  CHECK(liver.reference_m3 == Approx(80 * 8e-9));
  CHECK(liver.end_m3 == Approx(80 * 8e-9));
  CHECK(liver.meanDisplacement_m() == Approx(0.005));
  CHECK(liver.largestDisplacement_m == Approx(0.005));
  CHECK(liver.minJ == Approx(1.0));
  CHECK(bone.largestDisplacement_m == 0.0);
  simulator.fail("displacement", -1);
  motions = tissueMotions(simulator.table(), simulator.object(), {*places});
  REQUIRE_FALSE(motions);
  CHECK_THAT(motions.error().message, Contains("does not say how far"));
  CHECK(tissueMotions(simulator.table(), simulator.object(), {})->empty());
}

TEST_CASE("Labels of one tissue add up by their volumes") {
  TissueMotion motion;
  motion.places.labels.resize(2);
  motion.labels = {{3.0, 6.0, 10.0, 2.0, 0.9, 10, 10}, {1.0, 1.0, 20.0, 7.0, 0.8, 4, 10}};
  const LabelMotion all = motion.ofTissue(0);
  CHECK(all.reference_m3 == 4.0);
  CHECK(all.end_m3 == 7.0);
  CHECK(all.meanDisplacement_m() == Approx((3.0 * 1.0 + 1.0 * 5.0) / 4.0));
  CHECK(all.largestDisplacement_m == 7.0);
  CHECK(all.minJ == 0.8);
  CHECK_FALSE(motion.ofTissue(1).isKnown());
}

namespace {

/// Liver from x = 0 to 10 mm, bone from 20 to 30, a gizmo of fat from 30 to 40; 8 x 8 mm across.
const std::string kThree = "tissues = [ { label = 1 }, { label = 3 }, { label = 4, material = \"fat\" } ]\n";

}  // namespace

TEST_CASE("A label that slides becomes a body of its own, and what acts on the body acts on its pieces", "[tissues]") {
  scene::SceneFile scene = sceneOf(
      kThree +
      "slides = [\"gizmo\"]\nsampling = { count = 3000 }\nangular_velocity = [0, 0, 2]\nposition = [0.1, 0, 0]\n"
      "[[body]]\nname = \"other\"\nvolume = \"tissues.nrrd\"\nlabel = 1\n"
      "[[fix]]\nbody = \"scan\"\nname = \"all\"\nregion = { half_space = { point = [0.139, 0, 0], normal = [1, 0, 0] } "
      "}\n"
      "[[fix]]\nbody = \"scan\"\nname = \"end\"\nregion = { box = { min = [0.14, -1, -1], max = [1, 1, 1] } }\n"
      "[[load]]\nbody = \"scan\"\nregion = { half_space = { point = [0.136, 0, 0], normal = [1, 0, 0] } }\nforce = [0, "
      "13, 0]\n"
      "[[probe]]\nname = \"in\"\nbody = \"scan\"\nat = [0.135, 0, 0]\n"
      "[[probe]]\nname = \"out\"\nbody = \"scan\"\nat = [0.101, 0, 0]\n"
      "[[contact.pair]]\nbodies = [\"other\", \"scan\"]\nfriction = 0.7\n");
  BodySources sources;
  Preparation took;
  REQUIRE(resolveTissues(scene, presets(), sources, {}, took));
  REQUIRE(scene.bodies.size() == 3);
  const scene::SceneBody &rest = scene.bodies[0], &gizmo = scene.bodies[1];
  CHECK(rest.name == "scan");
  CHECK(gizmo.name == "scan.gizmo");
  CHECK(scene.bodies[2].name == "other");
  const auto countSaid = [](const scene::SceneBody &body) {
    return std::find_if(body.params.begin(), body.params.end(),
                        [](const auto &value) { return value.value.id == "sampling.count"; })
        ->value.num;
  };
  // 160 and 80 voxels.
  CHECK(countSaid(rest) == 2000.0);
  CHECK(countSaid(gizmo) == 1000.0);
  const auto piece = sources.pick(gizmo.volume, {}, took);
  REQUIRE(piece);
  CHECK(countOf(*piece->tissues, 3) == 80);
  CHECK(countOf(*piece->tissues, 0) == 240);
  CHECK(std::count(piece->mask.voxels.begin(), piece->mask.voxels.end(), 1) == 80);
  CHECK(countOf(*sources.pick(rest.volume, {}, took)->tissues, 3) == 0);
  CHECK(sources.placesOf(gizmo, *piece)->labels.size() == 1);
  CHECK(sources.placesOf(rest, *sources.pick(rest.volume, {}, took))->labels.size() == 2);
  BodyGeometry geometry;
  geometry.volume_mm3 = 640.0;
  REQUIRE(addTissues(gizmo.volume, *piece->tissues, 100.0, geometry));
  REQUIRE(geometry.tissues.size() == 2);
  CHECK_FALSE(geometry.tissues[0]);
  CHECK(geometry.tissues[1]);
  // Centroids of 15 and 35 mm rotate about that of all, 21.7 mm, at 2 rad/s.
  CHECK(rest.velocity_m_s[1] == Approx(-2.0 * 0.020 / 3.0));
  CHECK(gizmo.velocity_m_s[1] == Approx(2.0 * 0.040 / 3.0));
  REQUIRE(scene.fixes.size() == 3);
  CHECK(scene.fixes[0].body == "scan");
  CHECK(scene.fixes[1].body == "scan.gizmo");  // thinner than a voxel: the face
  CHECK(scene.fixes[2].body == "scan.gizmo");
  CHECK(scene.fixes[2].name == "all");
  CHECK(scene.fixes[0].motion.centre_m == scene.fixes[2].motion.centre_m);
  REQUIRE(scene.loads.size() == 2);
  CHECK((*scene.loads[0].force_N)[1] == Approx(10.0));
  CHECK((*scene.loads[1].force_N)[1] == Approx(3.0));
  CHECK(scene.probes[0].body == "scan.gizmo");
  CHECK(scene.probes[1].body == "scan");
  REQUIRE(scene.contactPairs.size() == 3);
  CHECK(scene.contactPairs[1].names == std::array<std::string, 2>{"scan.gizmo", "other"});
  CHECK(scene.contactPairs[1].friction == 0.7);
  CHECK_FALSE(scene.contactPairs[1].fits);
  CHECK(scene.contactPairs[2].names == std::array<std::string, 2>{"scan", "scan.gizmo"});
  CHECK(scene.contactPairs[2].friction == scene::kSlideFriction);
  CHECK(scene.contactPairs[2].fits);
  // Cut once.
  REQUIRE(resolveTissues(scene, presets(), sources, {}, took));
  CHECK(scene.bodies.size() == 3);
}

TEST_CASE("What is said of a piece alone is that of its body, and of no other", "[tissues]") {
  scene::SceneFile scene = sceneOf(kThree + "slides = [\"gizmo\"]\nsampling = { count = 3000 }\n");
  for (const char *assignment : {"body.scan.gizmo.sampling.count=70", "body.scan.gizmo.material.youngs_modulus=123",
                                 "body.scan.parts.1.material.youngs_modulus=456"})
    REQUIRE(scene::applyOverride(scene, assignment, &presets()));
  BodySources sources;
  Preparation took;
  REQUIRE(resolveTissues(scene, presets(), sources, {}, took));
  REQUIRE(scene.bodies.size() == 2);
  const auto said = [](const std::vector<scene::SceneValue> &values, const std::string &id) {
    const auto found = std::find_if(values.begin(), values.end(), [&](const auto &one) { return one.value.id == id; });
    REQUIRE(found != values.end());
    return found->value.num;
  };
  const scene::SceneBody &rest = scene.bodies[0], &gizmo = scene.bodies[1];
  CHECK(said(rest.params, "sampling.count") == 2000.0);
  CHECK(said(gizmo.params, "sampling.count") == 70.0);  // not a share of it
  REQUIRE(gizmo.parts.size() == 2);
  CHECK(said(gizmo.parts[1].params, "material.youngs_modulus") == 123.0);
  CHECK(said(rest.parts[1].params, "material.youngs_modulus") == 456.0);
  CHECK(said(rest.parts[0].params, "material.youngs_modulus") > 456.0);
}

TEST_CASE("What cannot slide is an error that says why and what is accepted", "[tissues]") {
  const auto refusal = [](const std::string &tissues, const std::string &slides) {
    scene::SceneFile scene = sceneOf(tissues + "slides = " + slides + "\n");
    BodySources sources;
    Preparation took;
    const auto settled = resolveTissues(scene, presets(), sources, {}, took);
    REQUIRE_FALSE(settled);
    CHECK_THAT(settled.error().message, Contains("tissues.toml:2: slides: "));
    return settled.error().message;
  };
  CHECK_THAT(refusal(kThree, "[\"livr\"]"), Contains("has no label 'livr'; did you mean 'liver'? there are: liver, "));
  CHECK_THAT(refusal(kThree, "[\"lung*\"]"), Contains("has no label 'lung*'; there are: liver, TRACHEA"));
  CHECK_THAT(refusal(kThree, "[\"rib*\"]"),
             Contains("label 'rib left 3' is rigid and does not move; accepted: labels of a tissue with a material"));
  CHECK_THAT(refusal(kThree, "[\"TRACHEA\"]"), Contains("label 'TRACHEA' is not of the body"));
  CHECK_THAT(refusal(kThree, "[\"gizmo\", 4]"), Contains("the labels of '4' are of names before it; accepted"));
  CHECK_THAT(refusal(kThree, "[\"liver\", \"gizmo\"]"),
             Contains("all that can move of 'scan' slides") && Contains("accepted: labels, or a 'background'"));
  CHECK_THAT(refusal(kThree + "mend = { largest = true }\n", "[\"liver\"]"),
             Contains("nothing of 'liver' is of the body") && Contains("'mend' has taken it away"));
}

TEST_CASE("Listed labels are one tissue, called what their names are known as", "[tissues]") {
  scene::SceneFile scene =
      sceneOf("tissues = [ { label = [\"gizmo\", 1], material = \"fat\" }, { label = [\"rib left 3\", 3] } ]\n");
  BodySources sources;
  Preparation took;
  REQUIRE(resolveTissues(scene, presets(), sources, {}, took));
  const std::vector<scene::SceneTissue> &tissues = scene.bodies.front().volume.tissues;
  CHECK(tissues[0].labels.size() == 2);
  CHECK(tissues[0].label == "gizmo, 1");
  CHECK(tissues[1].label == "bone");
  CHECK(tissues[1].isRigid);
  scene::SceneFile wrong = sceneOf("tissues = [ { label = [\"gizmo\", \"glzmo\"], material = \"fat\" } ]\n");
  const auto settled = resolveTissues(wrong, presets(), sources, {}, took);
  REQUIRE_FALSE(settled);
  CHECK_THAT(settled.error().message, Contains("has no label 'glzmo'; did you mean 'gizmo'?"));
}

TEST_CASE("What lies outside of the region is not of the body", "[tissues]") {
  // Voxels 2 mm apart from 1 mm on: 6 columns of the first two labels, 3 x 4 rows of each.
  const std::string box = "region = { box = { min = [0.005, -1, -1], max = [0.0165, 1, 0.006] } }\n";
  scene::SceneFile scene =
      sceneOf("tissues = [ { label = [\"liver\", 2], material = \"fat\" }, { label = 4, rigid = true } ]\n" + box);
  BodySources sources;
  Preparation took;
  REQUIRE(resolveTissues(scene, presets(), sources, {}, took));
  const auto picked = sources.pick(scene.bodies.front().volume, {}, took);
  REQUIRE(picked);
  CHECK(countOf(*picked->tissues, 1) == 6 * 4 * 3);
  CHECK(countOf(*picked->tissues, 2) == 0);
  scene::SceneFile empty = sceneOf("label = 1\nregion = { sphere = { centre = [1, 0, 0], radius = 0.1 } }\n");
  const auto none = sources.pick(empty.bodies.front().volume, {}, took);
  REQUIRE_FALSE(none);
  CHECK_THAT(none.error().message, Contains("within the region"));
}
