// SPDX-License-Identifier: Apache-2.0
#include "c3de/segmentation/segmentation_workflow.h"

#include "c3de/imaging/masks.h"
#include "workflow_fixture.h"

using namespace c3de;
using namespace c3de::segmentation;
using namespace c3de::segmentation::test;

TEST_CASE("An organ is picked by threshold, part and filled holes, and each step is undone", "[organ]") {
  Fixture f;
  f.guide.setLow(60.0);
  f.guide.keepComponentAt({25, 25, 30});  // waits for the threshold
  f.guide.applyStep(Kind::fillHoles);
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
  f.guide.applyStep(Kind::largest);
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
  f.guide.applyStep(Kind::fillHoles);  // not carried out after a failed step
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
  f.guide.toggleLabelAt({50, 50, 50});
  CHECK_THAT(f.guide.maskProblem(), Contains("50.0, 50.0, 50.0 mm is on no label"));
  CHECK_FALSE(f.guide.mask().mask());
  f.guide.toggleLabelAt({70, 65, 61});
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

TEST_CASE("A body is requested of what was picked and chosen", "[organ]") {
  Fixture f;
  CHECK_THAT(f.guide.blockingReason(), Contains("nothing is picked"));
  f.guide.setLow(60.0);
  CHECK_THAT(f.guide.blockingReason(), Contains("being computed"));
  f.settle();
  f.guide.setName("liver");
  f.guide.setSampling({false, 750.0, false, 3.5});
  f.guide.setHolding(Held::lowestPart, 2e5);
  CHECK(f.guide.blockingReason().empty());
  f.guide.createBodies();
  REQUIRE(f.made.size() == 1);
  CHECK(f.made[0].name == "liver");
  CHECK(f.made[0].material == "liver");
  CHECK(f.made[0].points == 750);
  CHECK(f.made[0].edge_mm == 3.5);
  CHECK(f.made[0].held == Held::lowestPart);
  CHECK(imaging::voxelCount(*f.made[0].mask) == Fixture::kLarge + Fixture::kSmall);
  f.guide.setSampling({true, 750.0, true, 3.5});
  f.guide.createBodies();
  CHECK(f.made[1].edge_mm == 0.0);
  CHECK(f.made[1].points == 0);
}

TEST_CASE("An organ is held by its surroundings unless a person says otherwise, and bone is proposed as rigid",
          "[organ]") {
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
  // Another label: from its material again.
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
  f.guide.setLabelPicked(8, true);
  f.guide.setLabelPicked(3, true);  // the mask of the first is still being computed
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
  f.guide.setMending({.largest = true, .fillHoles = true});
  f.guide.setSampling({false, 640.0, true, 3.5});
  f.guide.setHolding(Held::lowestPart, 2e5);
  f.guide.createBodies();
  REQUIRE(f.made.size() == 2);
  CHECK((f.made[0].name == "thing" && f.made[0].material == "fat" && f.made[0].label == 8));
  CHECK((f.made[1].name == "kidney_left" && f.made[1].material == "kidney_cortex" && f.made[1].label == 3));
  for (const BodyRequest &request : f.made)
    CHECK((request.points == 640 && request.edge_mm == 0.0 && request.held == Held::lowestPart &&
           request.mend.fillHoles && request.mend.largest));
  const auto mask = maskOf(f.made[0]);
  REQUIRE(mask);
  CHECK(imaging::voxelCount(*mask) == Fixture::kSmall);
}

TEST_CASE("What has become a body is picked no more, what could not stays", "[organ]") {
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
  f.guide.applyStep(Kind::largest);
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
  f.guide.applyStep(Kind::fillHoles);
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge + 1);
  CHECK_FALSE(f.guide.mask().canRedo());
}

TEST_CASE("A stored selection is selected again, and undo does not go beyond it", "[organ]") {
  Fixture f;
  f.guide.setSources(f.sources);
  f.guide.chooseLabel(3);
  f.settle();
  f.guide.applyStep(Kind::fillHoles);
  f.settle();
  f.guide.setName("left kidney");
  const Selection stored = f.guide.selection();
  CHECK(stored.labels == std::vector<std::uint16_t>{3});

  Fixture other;
  other.guide.setSources(other.sources);
  other.guide.restore(stored);
  other.settle();
  REQUIRE(other.guide.mask().mask());
  CHECK(other.guide.mask().mask()->voxels == stored.mask->voxels);
  CHECK(other.guide.pickedLabels() == stored.labels);
  CHECK(other.guide.settings().isFromLabel);
  CHECK(other.guide.settings().name == "left kidney");
  CHECK(other.guide.blockingReason().empty());
  CHECK_FALSE(other.guide.mask().canUndo());
  const std::uint64_t revision = other.guide.mask().revision();
  other.guide.applyStep(Kind::largest);
  other.settle();
  CHECK(other.guide.mask().revision() != revision);
  other.guide.undo();
  other.settle();
  CHECK(other.voxels() == f.voxels());
  CHECK(other.guide.settings().isFromLabel);
  CHECK_FALSE(other.guide.mask().canUndo());

  // Limits of a threshold; and several labels, of which there is no mask.
  f.guide.setLow(60.0);
  f.settle();
  other.guide.restore(f.guide.selection());
  other.settle();
  CHECK_FALSE(other.guide.settings().isFromLabel);
  CHECK(other.guide.settings().low == 60.0);
  CHECK(other.voxels() == Fixture::kLarge + Fixture::kSmall);
  f.guide.chooseLabels({8, 3});
  other.guide.restore(f.guide.selection());
  other.settle();
  CHECK(other.guide.pickedLabels() == std::vector<std::uint16_t>{8, 3});
  CHECK_FALSE(other.guide.mask().mask());
}

TEST_CASE("The mask of a body is edited, and the body follows on request or with every change", "[organ]") {
  Fixture f;
  f.guide.setLow(60.0);
  f.settle();
  const auto mask = f.guide.mask().mask();
  CHECK(f.guide.bodies().empty());
  f.guide.editBody("spleen");  // there is none
  CHECK(f.guide.presentBody() == nullptr);
  f.guide.setBodies({{"spleen", mask}});
  f.guide.setName("spleen");
  REQUIRE(f.guide.presentBody() != nullptr);
  CHECK_THAT(f.guide.updateReason(), Contains("that of the body"));
  f.guide.updateBody();
  CHECK(f.updated.empty());

  // A mask that was picked otherwise is not followed.
  f.guide.setUpdatedLive(true);
  f.guide.applyStep(Kind::largest);
  f.settle();
  CHECK(f.guide.updateReason().empty());
  CHECK_FALSE(f.guide.isEditingBody());
  CHECK(f.updated.empty());
  f.guide.updateBody();
  REQUIRE(f.updated.size() == 1);
  CHECK(f.updated.front().first == "spleen");
  CHECK(f.updated.front().second == f.guide.mask().mask());
  CHECK(f.range.from == f.range.to);
  f.guide.setBodies({{"spleen", f.guide.mask().mask()}});

  f.guide.editBody("spleen");
  f.settle();
  CHECK(f.guide.isEditingBody());
  CHECK(f.voxels() == Fixture::kLarge);
  CHECK(f.updated.size() == 1);
  f.guide.applyStep(Kind::fillHoles);
  f.settle();
  REQUIRE(f.updated.size() == 2);
  CHECK(f.range.to == f.range.from + 1);
  const auto filled = f.range;
  // Refused, or waiting: not again without a change.
  f.guide.setName("spleen");
  f.guide.setLow(60.0);
  f.settle();
  CHECK_FALSE(f.guide.isEditingBody());
  f.guide.undo();
  f.settle();
  CHECK(f.guide.isEditingBody());
  // Undo makes another object with equal voxels: the body is up to date.
  REQUIRE(f.guide.undoUpdate(filled));
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge);
  CHECK_THAT(f.guide.updateReason(), Contains("that of the body"));
  REQUIRE(f.guide.redoUpdate(filled));
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge + 1);
  CHECK_FALSE(f.guide.redoUpdate(filled));
  // Two changes at once.
  f.guide.setUpdatedLive(false);
  f.guide.setBodies({{"spleen", f.guide.mask().mask()}});
  f.guide.onBodyUpdated(filled);
  f.guide.paint({{0, 0, 0}}, {0, 0, 1});
  f.guide.paint({{95, 0, 0}}, {0, 0, 1});
  f.settle();
  f.guide.updateBody();
  REQUIRE(f.range.to == f.range.from + 2);
  REQUIRE(f.guide.undoUpdate(f.range));
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge + 1);
  f.guide.editBody("spleen");
  f.settle();
  CHECK_FALSE(f.guide.undoUpdate(filled));  // another history
}

TEST_CASE("Another image starts anew, also while a step runs", "[organ]") {
  Fixture f;
  f.guide.setLow(60.0);
  f.guide.applyStep(Kind::close);
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
  second.applyStep(Kind::largest);
  jobs.reset();
  queue.runFrame();
  CHECK_FALSE(second.mask().isBusy());
}
