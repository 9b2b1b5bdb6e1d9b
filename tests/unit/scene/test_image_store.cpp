// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/image_store.h"
#include "support/catch.h"

using namespace c3de;

TEST_CASE("Images and label maps are found by their own handles until they are removed", "[image_store]") {
  scene::ImageStore store;
  auto image = std::make_shared<scene::StoredImage>();
  image->name = "head";
  const Handle head = store.add(std::shared_ptr<const scene::StoredImage>(image));
  const Handle labels = store.add(std::make_shared<const scene::StoredLabels>());
  REQUIRE(store.image(head));
  CHECK(store.image(head)->name == "head");
  CHECK(store.labels(labels));
  const Handle knee = store.add(std::make_shared<const scene::StoredImage>());
  CHECK(store.allImages() == std::vector<Handle>{head, knee});
  CHECK(store.allLabels() == std::vector<Handle>{labels});
  CHECK(store.removeImage(head));
  CHECK(store.allImages() == std::vector<Handle>{knee});
  CHECK_FALSE(store.removeImage(head));
  CHECK_FALSE(store.image(head));
  CHECK(store.labels(labels));
  CHECK(store.removeLabels(labels));
  CHECK_FALSE(store.labels(labels));
}

TEST_CASE("A label is that of the nearest voxel, on the map's own grid", "[image_store]") {
  scene::StoredLabels labels;
  labels.map.geometry.size = {2, 1, 1};
  // Stored from left to right.
  labels.map.geometry.indexToWorld = {-10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, 10, 0, 0, 1};
  labels.map.voxels = {3, 7};
  labels.map.labels = {{3, "liver", {}}, {7, "spleen", {}}};
  CHECK(labels.at({14.9, 0, 0}) == 3);
  CHECK(labels.at({5.1, 4.9, -4.9}) == 3);
  CHECK(labels.at({4.9, 0, 0}) == 7);
  CHECK(labels.at({15.1, 0, 0}) == 0);
  CHECK(labels.at({0, 5.1, 0}) == 0);
  CHECK(labels.nameOf(7) == "spleen");
  CHECK(labels.nameOf(1).empty());
}
