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
  const GridGeometry place{{2, 2, 2}, kIdentity4};
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
  CHECK_FALSE(images->setOverlayColours(std::vector<Colour>(1)));
  CHECK(images->remove(*labels));
  CHECK_FALSE(images->setLabelColours(*labels, {}));
}

TEST_CASE("Every visible mesh can be looked at where it is drawn") {
  const auto renderer = createNullRenderer();
  const std::vector<Vec3f> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangles{{0, 1, 2}};
  const Handle shown = renderer->createMesh(corners, triangles, {}),
               hidden = renderer->createMesh(corners, triangles, {});
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

TEST_CASE("What is marked for slices can be looked at where it is drawn, and nothing else") {
  const auto renderer = createNullRenderer();
  const std::vector<Vec3f> points{{0, 0, 0}, {1, 0, 0}};
  Material mark;
  mark.inSlices = true;
  const Handle spheres = renderer->createSpheres(points, 0.5f, mark), lines = renderer->createLines(points, 3.0f, mark),
               label = renderer->createLabel({1, 2, 3}, "2 N", mark);
  (void)renderer->createLines(points, 1.0f, {});
  (void)renderer->createMesh(std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::vector<Triangle>{{0, 1, 2}},
                             mark);
  const auto seen = [&] {
    std::vector<std::string> all;
    renderer->forEachMark([&](const MarkView &view) {
      switch (view.kind) {
        case MarkView::Kind::spheres: all.push_back("spheres " + std::to_string(view.positions.size())); break;
        case MarkView::Kind::lines: all.push_back("lines " + std::to_string(static_cast<int>(view.width_px))); break;
        case MarkView::Kind::label: all.push_back("label " + view.text); break;
      }
    });
    return all;
  };
  CHECK(seen() == std::vector<std::string>{"spheres 2", "lines 3", "label 2 N"});
  renderer->setVisible(spheres, false);
  renderer->setMaterial(lines, {});
  renderer->setLabel(label, {0, 0, 0}, "3 N");
  CHECK(seen() == std::vector<std::string>{"label 3 N"});
}

TEST_CASE("Whatever changes the picture counts as a change, and what is set again does not") {
  const auto renderer = createNullRenderer();
  ImageRenderer *images = renderer->images();
  REQUIRE(images);
  const std::vector<Vec3f> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangle{{0, 1, 2}};
  const std::vector<std::uint8_t> voxels(8, 1);
  const GridGeometry place{{2, 2, 2}, kIdentity4};
  std::uint64_t all = renderer->changes(), ofImages = images->changes();
  const auto counts = [&](const char *what, bool isOfImages, auto &&change) {
    INFO(what);
    change();
    CHECK(renderer->changes() > all);
    CHECK((images->changes() > ofImages) == isOfImages);
    all = renderer->changes();
    ofImages = images->changes();
  };
  Handle mesh{}, spheres{}, label{}, legend{}, image{}, labels{}, shift{};
  Mat4 moved = kIdentity4;
  moved[12] = 1.0;
  const Legend scale{"|u|", "mm", "", 0.0, 1.0, {{0, 0, 0, 1}, {1, 1, 1, 1}}};
  counts("createMesh", false, [&] { mesh = renderer->createMesh(corners, triangle, {}); });
  counts("createSpheres", false, [&] { spheres = renderer->createSpheres(corners, 1.0f, {}); });
  counts("createLines", false, [&] { renderer->createLines(std::span(corners).first(2), 1.0f, {}); });
  counts("createLabel", false, [&] { label = renderer->createLabel({0, 0, 0}, "a", {}); });
  counts("createLegend", false, [&] { legend = renderer->createLegend(scale); });
  counts("setPositions", false, [&] { renderer->setPositions(mesh, corners); });
  counts("setNormals", false, [&] { renderer->setNormals(mesh, corners); });
  counts("setColours", false, [&] { renderer->setColours(mesh, std::vector<Colour>(3)); });
  counts("setRadii", false, [&] { renderer->setRadii(spheres, std::vector<float>(3, 2.0f)); });
  counts("setLabel", false, [&] { renderer->setLabel(label, {0, 0, 0}, "b"); });
  counts("setLegend", false, [&] { renderer->setLegend(legend, scale); });
  counts("setMaterial", false, [&] { renderer->setMaterial(mesh, {}); });
  counts("setTransform", false, [&] { renderer->setTransform(mesh, moved); });
  counts("setVisible", false, [&] { renderer->setVisible(mesh, false); });
  counts("setBackground", false, [&] { renderer->setBackground({}); });
  counts("destroy", false, [&] { renderer->destroy(spheres); });
  counts("addImage", true, [&] { image = *images->addImage({place, VoxelType::uint8, voxels.data()}); });
  counts("addLabels", true, [&] { labels = *images->addLabels(place, std::vector<std::uint16_t>(8, 1)); });
  const std::vector<std::pair<std::uint16_t, Colour>> colours{{std::uint16_t{1}, Colour{1, 0, 0, 1}}};
  counts("setLabelColours", true, [&] { images->setLabelColours(labels, colours); });
  counts("addDisplacement", true, [&] { shift = *images->addDisplacement(place, std::vector<float>(24)); });
  counts("setDisplacement", true, [&] { images->setDisplacement(shift, std::vector<float>(24, 1.0f)); });
  counts("setField", true, [&] { CHECK(images->setField(shift, std::vector<float>(8, 2.0f))); });
  CHECK_FALSE(images->setField(shift, std::vector<float>(7)));
  CHECK_FALSE(images->setField(image, std::vector<float>(8)));
  counts("setField of none", true, [&] { CHECK(images->setField(shift, {})); });
  CHECK(images->setField(shift, {}));
  counts("setOverlayColours", true, [&] { images->setOverlayColours(std::vector<Colour>(2)); });
  ImageScene scene;
  scene.look.image = image;
  counts("setScene", false, [&] { images->setScene(scene); });  // slices are drawn by their own looks
  counts("remove", true, [&] { images->remove(labels); });

  images->setScene(scene);
  renderer->setTransform(mesh, moved);
  renderer->setVisible(mesh, false);
  CHECK(renderer->changes() == all);
}
