// SPDX-License-Identifier: Apache-2.0
#include "c3de/segmentation/scan_body.h"

#include <algorithm>
#include <fstream>

#include "c3de/scene/scene_file.h"
#include "workflow_fixture.h"

using namespace c3de;
using namespace c3de::segmentation;
using namespace c3de::segmentation::test;
using Catch::Matchers::Contains;

namespace {

using LabelKind = LabelUse::Kind;

/// The scan of the fixture with labels of these names, a voxel each; the last one does not occur.
struct Scan : Fixture {
  std::shared_ptr<scene::StoredLabels> labels = std::make_shared<scene::StoredLabels>();
  std::filesystem::path folder = testOutputFolder() / "scan-body";

  explicit Scan(const std::vector<std::string> &names) {
    std::filesystem::create_directories(folder);
    for (const char *file : {"ct.nii.gz", "labels.nii.gz"}) std::ofstream(folder / file) << "not read here";
    labels->map.geometry = sources.labels->map.geometry;
    labels->map.voxels.resize(8000);
    for (std::size_t i = 0; i < names.size(); ++i) {
      labels->map.labels.push_back({static_cast<std::uint16_t>(i + 1), names[i], {}});
      labels->map.voxels[i] = static_cast<std::uint16_t>(i + 1);
    }
    labels->map.labels.push_back({900, "spleen", {}});
    scan.setSources({sources.image, folder / "ct.nii.gz", "", folder / "labels.nii.gz", {labels}});
    scan.show(true);
    settle();
  }
  void use(const std::string &name, LabelKind kind, const std::string &preset = "") {
    const auto row = std::find_if(scan.rows().begin(), scan.rows().end(),
                                  [&](const ScanBody::Row &one) { return one.name == name; });
    REQUIRE(row != scan.rows().end());
    scan.setUse({static_cast<std::size_t>(row - scan.rows().begin())}, {kind, preset});
  }
  void settings(const std::function<void(ScanBodySettings &)> &change) {
    ScanBodySettings s = scan.settings();
    change(s);
    scan.setSettings(s);
  }
  [[nodiscard]] scene::SceneFile read() const {
    auto parsed = scene::parseScene(scan.sceneText(), {}, &materials);
    if (!parsed) FAIL(parsed.error().message + "\n" + scan.sceneText());
    return std::move(*parsed);
  }
};

}  // namespace

TEST_CASE("Labels are what their names are known as, with stiffness and volume", "[scan_body]") {
  Scan f({"liver", "kidney_left", "vertebrae_L1", "trachea", "gizmo"});
  const auto &rows = f.scan.rows();
  REQUIRE(rows.size() == 6);
  CHECK(rows[0].known == "liver");
  CHECK(rows[0].volume_ml == 0.125);
  CHECK(rows[1].material == f.materials.find("kidney_cortex"));
  CHECK(rows[2].use.kind == LabelKind::rigid);
  CHECK(rows[2].known == "bone");
  CHECK(rows[3].use.kind == LabelKind::air);
  CHECK(rows[4].known.empty());
  CHECK(rows[4].use.kind == LabelKind::none);
  CHECK(rows[5].volume_ml == 0.0);
  CHECK(f.scan.blockingReason().empty());
}

TEST_CASE("The scene of a scan says all that was chosen, and the reader takes it", "[scan_body]") {
  Scan f({"kidney_left", "kidney_right", "liver", "rib_left_1", "rib_left_2", "aorta", "gizmo", "thing \"x\""});
  f.use("liver", LabelKind::material, "spleen");
  f.use("gizmo", LabelKind::material, "spleen");
  f.use("rib_left_2", LabelKind::none);
  f.use("aorta", LabelKind::rigid);
  f.use("thing \"x\"", LabelKind::rigid);
  f.settings([](ScanBodySettings &s) {
    s.background = "muscle_skeletal_rest";
    s.hasBackground = true;
    s.from = -30.0;
    s.to = 90.0;
    s.points = 1234.0;
    s.posture = Posture::prone;
    s.region = {{{-10.0, 0.0, 5.0}, {40.0, 60.0, 80.0}}};
  });
  const scene::SceneFile scene = f.read();
  REQUIRE(scene.bodies.size() == 1);
  const scene::SceneVolume &volume = scene.bodies[0].volume;
  CHECK(volume.file == f.folder / "labels.nii.gz");
  REQUIRE(volume.tissues.size() == 4);
  CHECK(volume.tissues[0].wanted == std::vector<std::string>{"kidney_left", "kidney_right"});
  CHECK(volume.tissues[0].isMaterialByName);
  CHECK(volume.tissues[1].wanted == std::vector<std::string>{"liver", "gizmo"});
  CHECK(volume.tissues[1].preset == "spleen");
  CHECK(volume.tissues[2].wanted == std::vector<std::string>{"rib_left_1"});
  CHECK(volume.tissues[3].wanted == std::vector<std::string>{"aorta", "thing \"x\""});
  CHECK(volume.tissues[3].isRigid);
  REQUIRE(volume.background);
  CHECK(volume.background->from == -30.0);
  CHECK(volume.background->to == 90.0);
  CHECK(volume.mend.largest);
  REQUIRE(volume.region);
  CHECK(volume.region->b[1] == Approx(0.06));
  REQUIRE(scene.image);
  CHECK(scene.image->file == f.folder / "ct.nii.gz");
  const auto world = [&](const std::string &id) {
    const auto found = std::find_if(scene.world.begin(), scene.world.end(),
                                    [&](const scene::SceneValue &value) { return value.value.id == id; });
    return found == scene.world.end() ? Vec3{} : found->value.vec;
  };
  CHECK(world("world.gravity") == Vec3{0, -9.81, 0});
  CHECK(world("world.scan_gravity") == world("world.gravity"));
}

TEST_CASE("What the image contradicts is found before the body is made, and follows the choices", "[scan_body]") {
  // The image shows 0 HU where the labels are: no bone.
  Scan f({"liver", "vertebrae_L1", "rib_left_1"});
  const auto isRigid = [](const LabelFinding &one) { return one.kind == LabelFinding::Kind::rigid; };
  const auto found = [&] {
    f.settle();
    CHECK_FALSE(f.scan.isChecking());
    const auto &all = f.scan.findings();
    const auto one = std::find_if(all.begin(), all.end(), isRigid);
    return one == all.end() ? std::string() : one->text;
  };
  CHECK_THAT(found(), Contains("2 of 2 rigid labels") && Contains("vertebrae_L1") && Contains("rib_left_1"));
  f.use("rib_left_1", LabelKind::material, "liver");
  CHECK_THAT(found(), Contains("1 of 1 rigid label") && !Contains("rib_left_1"));
  f.use("vertebrae_L1", LabelKind::none);
  CHECK(found().empty());
  f.scan.undo();
  f.scan.undo();
  CHECK_THAT(found(), Contains("2 of 2 rigid labels"));
  // Nothing outside of the region belongs to the body.
  f.settings([](ScanBodySettings &s) { s.region = {{{40.0, 40.0, 40.0}, {90.0, 90.0, 90.0}}}; });
  CHECK(found().empty());
  CHECK(f.scan.blockingReason().empty());
}

TEST_CASE("A scene that is kept names the files beside it from there", "[scan_body]") {
  const Scan f({"liver"});
  CHECK_THAT(f.scan.sceneText(f.folder), Contains("file = \"ct.nii.gz\"") && Contains("volume = \"labels.nii.gz\""));
  CHECK_THAT(f.scan.sceneText(f.folder / "elsewhere"), !Contains("file = \"ct.nii.gz\""));
}

TEST_CASE("A label whose name says not it alone goes by its number", "[scan_body]") {
  Scan f({"liver", "liver", "12", "*", ""});
  f.scan.setUse({2, 3, 4}, {LabelKind::rigid, ""});
  const scene::SceneFile scene = f.read();
  CHECK(scene.bodies[0].volume.tissues[0].wanted == std::vector<std::string>{"1", "2"});
  CHECK(scene.bodies[0].volume.tissues[1].wanted == std::vector<std::string>{"3", "4", "5"});
}

TEST_CASE("What labels are of is chosen for many at once and taken back step by step", "[scan_body]") {
  Scan f({"liver", "gizmo", "thing"});
  CHECK_FALSE(f.scan.canUndo());
  f.scan.setUse({1, 2, 77}, {LabelKind::material, "spleen"});
  f.use("thing", LabelKind::rigid);
  CHECK(f.scan.rows()[1].material == f.materials.find("spleen"));
  CHECK(f.scan.rows()[2].use.kind == LabelKind::rigid);
  f.scan.undo();
  CHECK(f.scan.rows()[2].material == f.materials.find("spleen"));
  f.scan.undo();
  for (const std::size_t row : {1, 2}) {
    CHECK(f.scan.rows()[row].use == LabelUse{});
    CHECK(f.scan.rows()[row].material == nullptr);
  }
  CHECK(f.scan.rows()[0].material == f.materials.find("liver"));
  CHECK_FALSE(f.scan.canUndo());
  f.scan.undo();
  // The region as well; numbers typed in sequence are one step.
  const auto setRegion = [&](double low, double high) {
    f.settings([&](ScanBodySettings &s) { s.region = {{{low, 0.0, 0.0}, {high, 50.0, 50.0}}}; });
  };
  setRegion(1, 9);
  for (const double typed : {2.0, 20.0, 23.0}) setRegion(typed, 90);
  setRegion(23, 91);
  f.scan.setRegion(std::array<Vec3, 2>{{{5.0, 0.0, 0.0}, {6.0, 50.0, 50.0}}});
  f.use("gizmo", LabelKind::rigid);
  f.scan.undo();
  CHECK(f.scan.settings().region->at(0)[0] == 5.0);
  f.scan.undo();
  CHECK(f.scan.settings().region->at(1)[0] == 91.0);
  f.scan.undo();
  CHECK(f.scan.settings().region->at(0)[0] == 1.0);
  f.scan.undo();
  CHECK_FALSE(f.scan.settings().region);
  CHECK_FALSE(f.scan.canUndo());
  // Other labels start a new history.
  f.use("gizmo", LabelKind::rigid);
  f.scan.setSources({});
  CHECK_FALSE(f.scan.canUndo());
}

TEST_CASE("Of a CT what has no label is fat by its values, of another image it is left out", "[scan_body]") {
  Scan f({"liver"});
  CHECK(f.scan.settings().hasBackground);
  CHECK(f.scan.settings().from == -150.0);
  CHECK(f.scan.settings().to == 250.0);
  CHECK(f.scan.settings().largestOnly);
  CHECK(f.scan.unit() == "HU");
  auto other = std::make_shared<scene::StoredImage>(*f.sources.image);
  other->volume.unit = "";
  f.scan.setSources({other, f.folder / "mr.nii.gz", "", f.folder / "labels.nii.gz", {f.labels}});
  CHECK_FALSE(f.scan.settings().hasBackground);
  CHECK_FALSE(f.scan.settings().largestOnly);
  CHECK(f.scan.unit().empty());
  // A file without this information, with the values of a CT.
  std::vector<std::int16_t> voxels(8000, -1000);
  std::fill(voxels.begin(), voxels.begin() + 4000, std::int16_t{40});
  auto unsaid = std::make_shared<scene::StoredImage>(*other);
  unsaid->volume.voxels = voxels;
  f.scan.setSources({unsaid, f.folder / "unsaid.nii.gz", "", f.folder / "labels.nii.gz", {f.labels}});
  CHECK(f.scan.settings().hasBackground);
  CHECK(f.scan.unit() == "HU");
}

TEST_CASE("What cannot become a body says why", "[scan_body]") {
  Scan unknown({"gizmo", "thing"});
  CHECK_THAT(unknown.scan.blockingReason(), Contains("no label is known by its name"));
  unknown.scan.make();
  CHECK(unknown.scene.empty());
  unknown.use("gizmo", LabelKind::material, "fat");
  CHECK(unknown.scan.blockingReason().empty());
  Scan rigid({"vertebrae_L1", "trachea"});
  CHECK(rigid.scan.blockingReason().empty());  // the background moves
  rigid.settings([](ScanBodySettings &s) { s.hasBackground = false; });
  CHECK_THAT(rigid.scan.blockingReason(), Contains("nothing could move"));
  rigid.settings([](ScanBodySettings &s) {
    s.hasBackground = true;
    s.from = 300.0;
  });
  CHECK_THAT(rigid.scan.blockingReason(), Contains("from 300 to 250"));
  rigid.settings([](ScanBodySettings &s) {
    s.from = 0.0;
    s.region = {{{0.0, 0.0, 9.0}, {1.0, 1.0, 9.0}}};
  });
  CHECK_THAT(rigid.scan.blockingReason(), Contains("from 9 to 9 mm along z"));
}

TEST_CASE("A try that failed comes back with its reason and what was chosen", "[scan_body]") {
  Scan f({"liver", "gizmo"});
  f.use("gizmo", LabelKind::rigid);
  f.scan.make();
  CHECK(f.scene == f.scan.sceneText());
  CHECK_FALSE(f.scan.isShown());
  CHECK_THAT(f.scan.blockingReason(), Contains("is being made"));
  CHECK(f.scan.sceneReason().empty());  // and can be saved
  CHECK(f.scan.finished(fail(ErrorCode::input, "no voxel is left")));
  CHECK(f.scan.isShown());
  CHECK(f.scan.problem() == "no voxel is left");
  CHECK(f.scan.rows()[1].use.kind == LabelKind::rigid);
  CHECK(f.scan.blockingReason().empty());
  f.scan.make();
  CHECK_FALSE(f.scan.finished(fail(ErrorCode::cancelled, "cancelled")));
  CHECK_FALSE(f.scan.isShown());
  CHECK(f.scan.problem().empty());
}

TEST_CASE("What went wrong with a scan is not told of another one", "[scan_body]") {
  Scan f({"liver"});
  f.scan.make();
  CHECK(f.scan.finished(fail(ErrorCode::input, "no voxel is left")));
  ScanBody::Sources other = f.scan.sources();
  other.imageFile = f.folder / "other.nii.gz";
  f.scan.setSources(other);
  CHECK(f.scan.problem().empty());
  // Nor when it ends after the other one has been opened.
  f.scan.show(false);
  f.scan.make();
  f.scan.setSources({});
  other.imageFile = f.folder / "third.nii.gz";
  f.scan.setSources(other);
  f.scan.show(true);
  f.settle();
  CHECK_FALSE(f.scan.finished(fail(ErrorCode::input, "no voxel is left")));
  CHECK(f.scan.problem().empty());
  CHECK(f.scan.blockingReason().empty());
}

TEST_CASE("Choices outlive another time point and end with other labels", "[scan_body]") {
  Scan f({"liver", "gizmo"});
  f.use("gizmo", LabelKind::rigid);
  f.settings([](ScanBodySettings &s) { s.points = 777.0; });
  auto later = std::make_shared<scene::StoredImage>(*f.sources.image);
  later->time = 2;
  ScanBody::Sources sources = f.scan.sources();
  sources.image = later;
  f.scan.setSources(sources);
  CHECK(f.scan.rows()[1].use.kind == LabelKind::rigid);
  CHECK(f.scan.settings().points == 777.0);
  CHECK_THAT(f.scan.sceneText(), Contains("time = 2,") && Contains("\ntime = 2\n"));
  sources.layers = {f.sources.labels};
  f.scan.setSources(sources);
  CHECK(f.scan.rows()[1].name == "thing");
  CHECK(f.scan.rows()[1].use.kind == LabelKind::none);
  f.scan.setSources({});
  CHECK_FALSE(f.scan.isPossible());
  f.scan.show(true);
  CHECK_FALSE(f.scan.isShown());
}
