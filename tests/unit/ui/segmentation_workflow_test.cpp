// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/segmentation_workflow.h"

#include <chrono>
#include <thread>

#include "c3de/core/background_jobs.h"
#include "c3de/core/main_queue.h"
#include "c3de/imaging/masks.h"
#include "c3de/ui/edit_history.h"
#include "c3de/ui/segmentation_panel.h"
#include "c3de/ui/parameter_registry.h"
#include "c3de/ui/text_panel.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;

namespace {

using Kind = MaskStep::Kind;

/// 20 x 20 x 20 voxels of 5 mm (an eighth of a millilitre). A box of value 100 with a hole of one voxel, and another
/// one apart; a label map with both.
struct Fixture {
  MainQueue queue;
  BackgroundJobs jobs{queue};
  scene::MaterialLibrary materials = [] {
    auto loaded = scene::MaterialLibrary::load(std::filesystem::path(testResourcesFolder()) / "materials.toml");
    if (!loaded) FAIL(loaded.error().message);
    return std::move(*loaded);
  }();
  std::vector<BodyRequest> made;
  int changes = 0;
  SegmentationWorkflow guide{
      jobs, "test", materials, {[this] { ++changes; }, [this](std::vector<BodyRequest> r) { made.insert(made.end(), r.begin(), r.end()); }}};
  MaskSources sources;

  static constexpr std::size_t kLarge = 6 * 6 * 6 - 1, kSmall = 4 * 4 * 4;

  Fixture() {
    auto image = std::make_shared<scene::StoredImage>();
    auto labels = std::make_shared<scene::StoredLabels>();
    image->volume.geometry = {{20, 20, 20}, {5, 0, 0, 0, 0, 5, 0, 0, 0, 0, 5, 0, 0, 0, 0, 1}};
    image->volume.unit = "HU";
    std::vector<std::int16_t> voxels(8000, 0);
    labels->map.geometry = image->volume.geometry;
    labels->map.voxels.resize(8000);
    labels->map.labels = {{3, "kidney_left", {1, 0, 0}}, {8, "thing", {0, 1, 0}}};
    const auto box = [&](std::size_t from, std::size_t to, std::uint16_t label) {
      for (std::size_t k = from; k < to; ++k)
        for (std::size_t j = from; j < to; ++j)
          for (std::size_t i = from; i < to; ++i) {
            voxels[i + 20 * (j + 20 * k)] = 100;
            labels->map.voxels[i + 20 * (j + 20 * k)] = label;
          }
    };
    box(2, 8, 3);
    box(12, 16, 8);
    voxels[4 + 20 * (4 + 20 * 4)] = 0;
    image->volume.voxels = voxels;
    image->range = imaging::robustRange(image->volume, 0.0);
    sources = {image, labels};
    guide.setSources({image, nullptr});
  }

  void settle() {
    const auto start = std::chrono::steady_clock::now();
    while (!jobs.running().empty()) {
      queue.runFrame();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      REQUIRE(std::chrono::steady_clock::now() - start < std::chrono::seconds(20));
    }
  }
  [[nodiscard]] std::size_t voxels() const { return guide.mask().voxels(); }
};

}  // namespace

TEST_CASE("An organ is picked by threshold, part and filled holes, and each step is undone", "[organ]") {
  Fixture f;
  f.guide.setLow(60.0);
  f.guide.keepComponentAt({25, 25, 30});  // waits for the threshold
  f.guide.carryOut(Kind::fillHoles);
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge + 1);
  CHECK(f.guide.mask().volume_ml() == Approx(216 * 0.125));
  f.guide.undo();
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge);
  f.guide.undo();
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge + Fixture::kSmall);
  REQUIRE(f.guide.mask().preview());
  CHECK(f.guide.mask().preview()->geometry.size == std::array<std::size_t, 3>{14, 14, 14});
  f.guide.undo();
  f.settle();
  CHECK_FALSE(f.guide.mask().mask());
  CHECK_FALSE(f.guide.mask().preview());
  CHECK_FALSE(f.guide.mask().canUndo());
}

TEST_CASE("Many thresholds of a dragged slider are few jobs and one step", "[organ]") {
  Fixture f;
  f.guide.setLow(1000.0);  // nothing
  for (int i = 0; i < 50; ++i) f.guide.setLow(99.0 - i);
  CHECK(f.jobs.running().size() == 1);
  const int before = f.changes;
  f.settle();
  CHECK(f.changes - before <= 3);  // the first one, the last one; none in between
  CHECK(f.voxels() == Fixture::kLarge + Fixture::kSmall);
  REQUIRE(f.guide.mask().steps().size() == 1);
  CHECK(f.guide.mask().steps()[0].low == 50.0);
}

TEST_CASE("Undo gives the limits of the threshold back that the mask was made with", "[organ]") {
  Fixture f;
  f.guide.setSources(f.sources);
  f.guide.setLow(60.0);
  f.settle();
  f.guide.carryOut(Kind::largest);
  f.settle();
  f.guide.setLow(90.0);
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge + Fixture::kSmall);
  f.guide.chooseLabel(8);
  f.settle();
  CHECK(f.voxels() == Fixture::kSmall);
  f.guide.undo();
  f.settle();
  CHECK(f.guide.settings().low == 90.0);
  CHECK_FALSE(f.guide.settings().isFromLabel);
  f.guide.undo();
  f.settle();
  CHECK(f.guide.settings().low == 60.0);
  CHECK(f.voxels() == Fixture::kLarge);
}

TEST_CASE("Problems with the mask are said and leave it as it was", "[organ]") {
  Fixture f;
  f.guide.setLow(60.0);
  f.settle();
  f.guide.keepComponentAt({0, 0, 0});
  f.guide.carryOut(Kind::fillHoles);  // not carried out after a step that failed
  f.settle();
  CHECK_THAT(f.guide.maskProblem(), Contains("outside of the mask"));
  CHECK(f.voxels() == Fixture::kLarge + Fixture::kSmall);
  CHECK(f.guide.mask().steps().size() == 1);
  f.guide.setLow(200.0);
  f.settle();
  CHECK_THAT(f.guide.maskProblem(), Contains("empty") && Contains("from 200 to 200 HU"));
  CHECK_THAT(f.guide.blockingReason(), Contains("empty"));
  f.guide.createBodies();
  CHECK(f.made.empty());
  f.guide.setLow(60.0);
  f.settle();
  CHECK(f.guide.maskProblem().empty());
}

TEST_CASE("A label brings its name, colour, volume and material along", "[organ]") {
  Fixture f;
  f.guide.setSources(f.sources);
  f.settle();
  const auto rows = f.guide.labels();
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].volume_ml == Approx(216 * 0.125));
  CHECK(rows[1].volume_ml == Approx(64 * 0.125));
  CHECK(f.guide.settings().isFromLabel);
  f.guide.chooseLabel(3);
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge + 1);
  CHECK(f.guide.settings().name == "kidney_left");
  REQUIRE(f.guide.material());
  CHECK(f.guide.material()->name == "kidney_cortex");
  CHECK(f.guide.colour() == rows[0].colour);
  CHECK(f.guide.labels()[0].isChosen);
  CHECK_FALSE(f.guide.labels()[1].isChosen);
  f.guide.chooseLabel(8);
  f.settle();
  CHECK_FALSE(f.guide.material());
  CHECK_THAT(f.guide.blockingReason(), Contains("no material"));
}

TEST_CASE("A label is chosen by a click on it", "[organ]") {
  Fixture f;
  f.guide.setSources(f.sources);
  f.settle();
  f.guide.tickLabelAt({50, 50, 50});
  CHECK_THAT(f.guide.maskProblem(), Contains("50.0, 50.0, 50.0 mm is on no label"));
  CHECK_FALSE(f.guide.mask().mask());
  f.guide.tickLabelAt({70, 65, 61});
  f.settle();
  CHECK(f.voxels() == Fixture::kSmall);
  CHECK(f.guide.settings().name == "thing");
  CHECK(f.guide.maskProblem().empty());
}

TEST_CASE("A chosen material stays when the name changes", "[organ]") {
  Fixture f;
  f.guide.setName("spleen");
  CHECK(f.guide.settings().material == "spleen");
  f.guide.setName("left lung");
  CHECK(f.guide.settings().material == "lung_inflated");
  f.guide.chooseMaterial("fat");
  f.guide.setName("liver");
  CHECK(f.guide.settings().material == "fat");
}

TEST_CASE("What is made alive is what was picked and chosen", "[organ]") {
  Fixture f;
  CHECK_THAT(f.guide.blockingReason(), Contains("nothing is picked"));
  f.guide.setLow(60.0);
  CHECK_THAT(f.guide.blockingReason(), Contains("being computed"));
  f.settle();
  f.guide.setName("liver");
  f.guide.setSampling(750.0, false, 3.5);
  f.guide.setHolding(Held::lowestPart, 2e5);
  CHECK(f.guide.blockingReason().empty());
  f.guide.createBodies();
  REQUIRE(f.made.size() == 1);
  CHECK(f.made[0].name == "liver");
  CHECK(f.made[0].material == "liver");
  CHECK(f.made[0].phyxels == 750);
  CHECK(f.made[0].edge_mm == 3.5);
  CHECK(f.made[0].held == Held::lowestPart);
  CHECK(imaging::voxelCount(*f.made[0].mask) == Fixture::kLarge + Fixture::kSmall);
  f.guide.setSampling(750.0, true, 3.5);
  f.guide.createBodies();
  CHECK(f.made[1].edge_mm == 0.0);
}

TEST_CASE("An organ is held by its surroundings unless a person says otherwise, and bone is proposed as rigid", "[organ]") {
  Fixture f;
  f.guide.setLow(60.0);
  f.settle();
  f.guide.setName("liver");
  f.guide.createBodies();
  REQUIRE(f.made.size() == 1);
  CHECK(f.made[0].held == Held::surroundings);
  CHECK(f.made[0].surroundings_Pa_m == kSurroundingsStiffness);
  CHECK_FALSE(f.made[0].isRigid);
  f.guide.setHolding(Held::nothing, 2e4);
  f.guide.setName("vertebrae_L1");
  CHECK(f.guide.settings().material == "bone_cortical");
  CHECK(f.guide.isRigid());
  f.guide.createBodies();
  CHECK(f.made[1].isRigid);
  CHECK(f.made[1].held == Held::nothing);
  f.guide.setRigid(false);
  f.guide.createBodies();
  CHECK_FALSE(f.made[2].isRigid);
  // Another label: as its material says, again.
  f.guide.setSources(f.sources);
  f.settle();
  f.guide.chooseLabels({3, 8});
  f.settle();
  f.guide.chooseMaterialOf(8, "bone_cortical");
  CHECK(f.guide.isRigid(8));
  CHECK_FALSE(f.guide.isRigid(3));
  f.guide.setRigid(3, true);
  f.guide.createBodies();
  REQUIRE(f.made.size() == 5);
  CHECK((f.made[3].isRigid && f.made[4].isRigid));
}

TEST_CASE("Several ticked labels become a request each, with the material of their names", "[organ]") {
  Fixture f;
  f.guide.setSources(f.sources);
  f.settle();
  f.guide.tickLabel(8, true);
  f.guide.tickLabel(3, true);  // the mask of the first is still being made
  CHECK(f.guide.isSeveral());
  CHECK(f.guide.pickedLabels() == std::vector<std::uint16_t>{8, 3});
  f.settle();
  CHECK(f.guide.isSeveral());
  CHECK_FALSE(f.guide.mask().mask());
  CHECK(f.guide.materialOf(3)->name == "kidney_cortex");
  CHECK_THAT(f.guide.blockingReason(), Contains("no material is chosen for thing"));
  f.guide.createBodies();
  CHECK(f.made.empty());
  f.guide.chooseMaterialOf(8, "fat");
  f.guide.setMending(true, true);
  f.guide.setSampling(640.0, true, 3.5);
  f.guide.setHolding(Held::lowestPart, 2e5);
  f.guide.createBodies();
  REQUIRE(f.made.size() == 2);
  CHECK((f.made[0].name == "thing" && f.made[0].material == "fat" && f.made[0].label == 8));
  CHECK((f.made[1].name == "kidney_left" && f.made[1].material == "kidney_cortex" && f.made[1].label == 3));
  for (const BodyRequest &request : f.made)
    CHECK((request.phyxels == 640 && request.edge_mm == 0.0 && request.held == Held::lowestPart && request.fillsHoles &&
           request.keepsLargest));
  const auto mask = maskOf(f.made[0]);
  REQUIRE(mask);
  CHECK(imaging::voxelCount(*mask) == Fixture::kSmall);
}

TEST_CASE("What has been made is picked no more, what could not be made stays", "[organ]") {
  Fixture f;
  f.guide.setSources(f.sources);
  f.guide.chooseLabels({8, 3});
  f.guide.chooseMaterialOf(8, "fat");
  f.guide.createBodies();
  REQUIRE(f.made.size() == 2);
  f.guide.onBodiesCreated({f.made[1]});
  f.settle();
  CHECK(f.guide.pickedLabels() == std::vector<std::uint16_t>{8});
  CHECK(f.voxels() == Fixture::kSmall);
  f.guide.chooseMaterial("fat");
  f.guide.createBodies();
  REQUIRE(f.made.size() == 3);
  CHECK((f.made[2].label == 8 && f.made[2].mask));
  f.guide.onBodiesCreated({f.made[2]});
  CHECK(f.guide.pickedLabels().empty());
  CHECK_FALSE(f.guide.mask().mask());
  f.guide.undo();
  f.settle();
  CHECK(f.voxels() == Fixture::kSmall);
}

TEST_CASE("A label without voxels names itself", "[organ]") {
  Fixture f;
  BodyRequest request;
  request.name = "ghost";
  auto labels = std::make_shared<scene::StoredLabels>(*f.sources.labels);
  labels->name = "map.nrrd";
  request.labels = labels;
  request.label = 77;
  const auto mask = maskOf(request);
  REQUIRE_FALSE(mask);
  CHECK_THAT(mask.error().message, Contains("map.nrrd has label 77"));
}

TEST_CASE("Steps that were undone are redone, until another one is made", "[organ]") {
  Fixture f;
  f.guide.setSources(f.sources);
  f.guide.setLow(60.0);
  f.settle();
  f.guide.carryOut(Kind::largest);
  f.settle();
  f.guide.chooseLabels({3, 8});
  CHECK_FALSE(f.guide.mask().canRedo());
  f.guide.undo();
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge);
  f.guide.undo();
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge + Fixture::kSmall);
  CHECK(f.guide.mask().undoLabel() == "threshold 60 … 100");
  CHECK(f.guide.mask().redoLabel() == "the largest part");
  f.guide.redo();
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge);
  f.guide.redo();
  CHECK(f.guide.isSeveral());
  CHECK(f.guide.settings().isFromLabel);
  CHECK_FALSE(f.guide.mask().canRedo());
  f.guide.undo();
  f.settle();
  f.guide.carryOut(Kind::fillHoles);
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge + 1);
  CHECK_FALSE(f.guide.mask().canRedo());
}

TEST_CASE("Undo takes back what was edited last, of the parameters or of the organ", "[organ]") {
  Fixture f;
  ParameterRegistry parameters;
  ParameterSet set;
  set.decls.emplace_back();
  set.decls[0].id = "x";
  set.decls[0].label = "X";
  set.decls[0].max = 100.0;
  const Handle handle = parameters.declare(set);
  const auto setX = [&](double to) {
    ParameterValue value = parameters.find(handle)->values[0];
    value.num = to;
    REQUIRE(parameters.edit(handle, value));
    parameters.history().endGesture();
  };
  const auto x = [&] { return parameters.find(handle)->values[0].num; };
  EditHistory history;
  const auto follow = [&] { history.follow(&parameters, &f.guide); };
  follow();
  CHECK(history.undoLabel().empty());
  f.guide.setLow(60.0);
  follow();
  CHECK(history.undoLabel().empty());  // it is being computed
  f.settle();
  setX(2.0);
  follow();
  CHECK(history.undoLabel() == "X");
  f.guide.carryOut(Kind::largest);
  f.settle();
  follow();
  CHECK(history.undoLabel() == "the largest part");
  history.undo();
  CHECK(history.undoLabel().empty());  // not the parameter, while the organ goes back
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge + Fixture::kSmall);
  CHECK(x() == 2.0);
  CHECK(history.redoLabel() == "the largest part");
  setX(3.0);
  follow();
  history.undo();
  CHECK(x() == 2.0);
  history.undo();
  CHECK(x() == 0.0);
  CHECK(history.undoLabel() == "threshold 60 … 100");  // the parameters have nothing more
  history.undo();
  CHECK_FALSE(f.guide.mask().mask());
  follow();
  history.redo();
  f.settle();
  CHECK(f.guide.mask().mask());
}

TEST_CASE("Undo does not lay what a living organ was made of over it, whatever else is still picked", "[organ]") {
  Fixture f;
  EditHistory history;
  const auto undoLabel = [&] {
    history.follow(nullptr, &f.guide);
    return history.undoLabel();
  };
  const auto make = [&] {
    REQUIRE(f.guide.blockingReason() == "");
    f.guide.createBodies();
    const std::vector<BodyRequest> made = std::move(f.made);
    f.made.clear();
    return made;
  };
  f.guide.setSources(f.sources);
  f.settle();
  f.guide.chooseLabels({3, 8});
  f.guide.chooseMaterialOf(8, "liver");
  CHECK_FALSE(undoLabel().empty());
  std::vector<BodyRequest> made = make();
  REQUIRE(made.size() == 2);
  made.pop_back();  // the other one could not be made
  f.guide.onBodiesCreated(made);
  f.settle();
  CHECK(f.guide.pickedLabels() == std::vector<std::uint16_t>{8});
  CHECK(undoLabel() == "");
  history.undo();
  f.settle();
  CHECK(f.guide.pickedLabels() == std::vector<std::uint16_t>{8});
  // What is picked after that can be undone, so far and no farther.
  f.guide.carryOut(Kind::fillHoles);
  f.settle();
  CHECK(undoLabel() == "holes filled");
  history.undo();
  f.settle();
  CHECK(undoLabel() == "");
  // A threshold likewise.
  f.guide.setFromLabel(false);
  f.guide.setLow(60.0);
  f.settle();
  f.guide.setName("box");
  f.guide.chooseMaterial("liver");
  f.guide.onBodiesCreated(make());
  CHECK_FALSE(f.guide.mask().mask());
  CHECK(undoLabel() == "");
}

TEST_CASE("A map of many labels has a filter, and several are ticked at once", "[organ]") {
  Fixture f;
  auto labels = std::make_shared<scene::StoredLabels>(*f.sources.labels);
  for (std::uint16_t value = 20; value < 40; ++value)
    labels->map.labels.push_back({value, "Rib_left_" + std::to_string(value), {0, 0, 1}});
  PanelRegistry panels;
  ImageViews views;
  views.setImage(f.sources.image);
  const SegmentationPanel panel(panels, views, f.guide);
  TextPanel text(nullptr);
  const auto draw = [&] {
    const std::string shown = text.draw(*panels.panels().front());
    f.settle();
    return shown;
  };
  f.guide.setSources({f.sources.image, labels});
  f.settle();
  CHECK_THAT(draw(), Contains("label.8") && Contains("label.39"));
  REQUIRE(text.find("labels"));
  text.setText("label_filter", "left RIB 3");
  draw();
  CHECK_THAT(draw(), !Contains("label.8") && !Contains("label.29") && Contains("label.30") && Contains("label.39"));
  text.setText("label_filter", "nothing of the kind");
  draw();
  CHECK_THAT(draw(), Contains("No label is called so.") && Contains("[disabled button: Tick the listed]"));
  text.setText("label_filter", "KIDNEY left");
  text.press("tick_listed");
  draw();
  draw();
  text.press("tick_listed");
  draw();
  CHECK(f.guide.pickedLabels() == std::vector<std::uint16_t>{3});
  text.setText("label_filter", "thing");
  draw();
  text.press("tick_listed");
  draw();
  CHECK_THAT(draw(), Contains("Ticked: kidney_left, thing") && Contains("Picked: 2 labels, 35.0 ml") &&
                         Contains("Source: PMID 21862792") && Contains("Young's modulus: 5 kPa (2 kPa … 15 kPa)") &&
                         Contains("[disabled button: Make 2 organs alive]") && Contains("no material is chosen for thing"));
  text.setText("material.8", "fat");
  draw();
  text.press("make");
  draw();
  REQUIRE(f.made.size() == 2);
  CHECK(f.made[1].material == "fat");
  text.press("untick");
  draw();
  CHECK(f.guide.pickedLabels().empty());
}

TEST_CASE("Another image starts anew, also while a step runs", "[organ]") {
  Fixture f;
  f.guide.setLow(60.0);
  f.guide.carryOut(Kind::close);
  f.guide.setSources({});
  f.settle();
  CHECK_FALSE(f.guide.mask().mask());
  CHECK(f.guide.mask().steps().empty());
  CHECK(f.guide.maskProblem().empty());
}

TEST_CASE("The guide may go while its jobs run, and the jobs may go first", "[organ]") {
  MainQueue queue;
  const scene::MaterialLibrary none;
  auto jobs = std::make_unique<BackgroundJobs>(queue);
  const Fixture f;
  {
    SegmentationWorkflow first(*jobs, "test", none, {});
    first.setSources(f.sources);
    first.setLow(60.0);
  }
  SegmentationWorkflow second(*jobs, "test", none, {});
  second.setSources(f.sources);
  second.setLow(60.0);
  second.carryOut(Kind::largest);
  jobs.reset();
  queue.runFrame();
  CHECK_FALSE(second.mask().isBusy());
}

TEST_CASE("The panel leads from labels to the button", "[organ]") {
  Fixture f;
  PanelRegistry panels;
  ImageViews views;
  views.setImage(f.sources.image);
  const SegmentationPanel panel(panels, views, f.guide);
  TextPanel text(nullptr);
  const auto draw = [&] {
    const std::string shown = text.draw(*panels.panels().front());
    f.settle();
    return shown;
  };
  f.guide.setSources(f.sources);
  f.settle();
  CHECK_THAT(draw(), Contains("[#ff0000]  [ ] kidney_left   27.0 ml (label.3)") && Contains("Picked: nothing yet") &&
                         !Contains("Make it alive"));
  text.check("label.3", true);
  draw();
  CHECK_THAT(draw(), Contains("[x] kidney_left") && Contains("Picked: 27.0 ml, 216 voxels") &&
                         Contains("Material = kidney_cortex") && Contains("Young's modulus: 5 kPa (2 kPa … 15 kPa)") &&
                         Contains("Source: PMID 21862792"));
  text.setText("source", "values between");
  draw();
  text.setNumber("low", 60.0);
  draw();
  text.press("component");
  draw();
  REQUIRE(views.isPicking());
  CHECK_THAT(draw(), Contains("Click it in a slice…"));
  text.press("component");
  draw();
  CHECK_FALSE(views.isPicking());
  text.setNumber("radius", 6.0);
  text.press("close");
  draw();
  text.press("make");
  draw();
  CHECK(text.problems().empty());
  REQUIRE(f.made.size() == 1);
  CHECK(imaging::voxelCount(*f.made[0].mask) == 216 + 64);
}

TEST_CASE("A click in a slice that picks does not move the cross-hair, and Escape ends it", "[organ]") {
  const Fixture f;
  ImageViews views;
  views.setImage(f.sources.image);
  for (const Pane pane : kSlicePanes) views.view(pane).setSize(200, 200);
  const Vec3 cross = views.crossHair();
  std::vector<Vec3> picked;
  ViewInput press;
  press.kind = ViewInput::Kind::press;
  press.button = C3DE_BUTTON_LEFT;
  press.x = 30;
  press.y = 40;
  ViewInput release = press;
  release.kind = ViewInput::Kind::release;
  views.pickNext([&](const Vec3 &at) { picked.push_back(at); });
  views.handle(Pane::axial, press);
  views.handle(Pane::axial, release);
  REQUIRE(picked.size() == 1);
  CHECK(norm(picked[0] - views.view(Pane::axial).worldAt(30, 40)) < 1e-12);
  CHECK(norm(views.crossHair() - cross) == 0.0);
  views.handle(Pane::axial, press);
  views.handle(Pane::axial, release);
  CHECK(picked.size() == 1);
  CHECK(norm(views.crossHair() - cross) > 1.0);

  // The image is shown 10 mm further left: what is picked is the tissue that is shown there.
  auto shift = std::make_shared<imaging::DisplacementGrid>();
  shift->geometry = f.sources.image->volume.geometry;
  for (std::size_t v = 0; v < 8000; ++v) shift->xyz_mm.insert(shift->xyz_mm.end(), {10.0f, 0.0f, 0.0f});
  views.setDisplacement(shift);
  press.x = press.y = 100;
  views.pickNext([&](const Vec3 &at) { picked.push_back(at); });
  views.handle(Pane::axial, press);
  REQUIRE(picked.size() == 2);
  CHECK(norm(picked[1] + Vec3{10, 0, 0} - views.view(Pane::axial).worldAt(100, 100)) < 1e-9);
}
