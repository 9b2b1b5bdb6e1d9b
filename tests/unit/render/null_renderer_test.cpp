// SPDX-License-Identifier: Apache-2.0
#include "c3de/render/image_renderer.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::render;

TEST_CASE("The null renderer's image has the asked size and the background's colour") {
  const auto renderer = createNullRenderer();
  renderer->setBackground({{1.0f, 0.5f, 0.0f, 1.0f}, {1.0f, 0.5f, 0.0f, 1.0f}});
  const auto image = renderer->drawToImage(Camera{}, 8, 5);
  REQUIRE(image.has_value());
  CHECK(image->width == 8);
  CHECK(image->height == 5);
  REQUIRE(image->rgb.size() == 8u * 5u * 3u);
  CHECK(image->rgb[0] == 255);
  CHECK(image->rgb[1] == 128);
  CHECK(image->rgb[2] == 0);
}

TEST_CASE("An image without size is a usage error that names the size") {
  const auto renderer = createNullRenderer();
  const auto image = renderer->drawToImage(Camera{}, 0, 5);
  REQUIRE(!image.has_value());
  CHECK(image.error().code == ErrorCode::usage);
  CHECK_THAT(image.error().message, Contains("0 x 5"));
}

TEST_CASE("Without graphics images are kept and refused as with them") {
  const auto renderer = createNullRenderer();
  ImageRenderer *images = renderer->images();
  REQUIRE(images);
  const std::vector<std::uint8_t> voxels(8, 1);
  const GridPlace place{{2, 2, 2}, kIdentity4};
  const auto image = images->addImage({place, VoxelType::uint8, voxels.data()});
  REQUIRE(image);
  const auto labels = images->addLabels(place, std::vector<std::uint16_t>(8, 1));
  REQUIRE(labels);
  CHECK_FALSE(images->addLabels(place, std::vector<std::uint16_t>(7, 1)).has_value());
  CHECK_FALSE(images->setLabelColours(*image, {}));  // an image has none
  CHECK(images->setLabelColours(*labels, {}));
  const auto u = images->addDisplacement(place, std::vector<float>(24, 0.0f));
  REQUIRE(u);
  CHECK(images->setDisplacement(*u, std::vector<float>(24, 1.0f)));
  CHECK_FALSE(images->setDisplacement(*u, std::vector<float>(23, 1.0f)));
  CHECK_FALSE(images->setShiftColours(std::vector<Colour>(1)));
  CHECK(images->remove(*labels));
  CHECK_FALSE(images->setLabelColours(*labels, {}));
}

TEST_CASE("Every visible mesh can be looked at where it is drawn") {
  const auto renderer = createNullRenderer();
  const std::vector<Vec3f> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangles{{0, 1, 2}};
  const Handle shown = renderer->createMesh(corners, triangles, {}), hidden = renderer->createMesh(corners, triangles, {});
  (void)renderer->createSpheres(corners, 1.0f, {});
  Mat4 moved = kIdentity4;
  moved[12] = 5.0;
  renderer->setTransform(shown, moved);
  renderer->setVisible(hidden, false);
  int count = 0;
  renderer->forEachMesh([&](const MeshView &mesh) {
    ++count;
    CHECK(mesh.positions.size() == 3);
    CHECK(mesh.triangles.size() == 1);
    CHECK(mesh.worldFromProxy == moved);
  });
  CHECK(count == 1);
}
