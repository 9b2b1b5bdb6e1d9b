// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/comparison.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <tuple>

#include "c3de/abi/tools.h"
#include "c3de/registry/edit_list.h"
#include "c3de/registry/text_panel.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/ui/comparison_panel.h"
#include "c3de/ui/comparison_tools.h"
#include "c3de/ui/image_views.h"
#include "c3de/ui/slice_controller.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;
using geometry::RigidPose;

namespace {

/// value = 10 i + j + 100 k on an oblique grid of 12 x 10 x 8 voxels.
std::shared_ptr<scene::StoredImage> image(const Mat4 &place, const std::string &name = "second") {
  auto image = std::make_shared<scene::StoredImage>();
  image->name = name;
  image->volume.geometry = {{12, 10, 8}, place};
  std::vector<std::int16_t> voxels;
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 12; ++i) voxels.push_back(static_cast<std::int16_t>(10 * i + j + 100 * k));
  image->volume.voxels = std::move(voxels);
  image->volume.unit = "HU";
  image->range = imaging::robustRange(image->volume);
  return image;
}

constexpr Mat4 kStraight{2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0, -10, -15, -20, 1};
Mat4 oblique() { return multiply(geometry::matrixOf({{40, -7, 12}, {20, 35, -50}, {}}), kStraight); }

std::vector<NamedPoint> named(const std::vector<Vec3> &points) {
  std::vector<NamedPoint> out;
  for (std::size_t i = 0; i < points.size(); ++i) out.push_back({"p" + std::to_string(i), points[i]});
  return out;
}

const std::vector<Vec3> kPoints{{10, 20, 30}, {-40, 12, 7}, {25, -60, 3}, {4, 5, -70}};

}  // namespace

TEST_CASE("The value of a second scan is that of its voxel there, for an oblique grid in any pose", "[comparison]") {
  Comparison comparison;
  comparison.set(image(oblique()), {});
  const RigidPose pose{{5, -9, 33}, {-15, 40, 70}, comparison.centre_mm()};
  REQUIRE(comparison.assign(pose));
  for (const Vec3 &index : {Vec3{0, 0, 0}, Vec3{11, 9, 7}, Vec3{3, 4, 5}, Vec3{7.3, 1.8, 2.4}}) {
    const Vec3 world = transformPoint(geometry::matrixOf(pose), transformPoint(oblique(), index));
    const auto value = comparison.valueAt(world);
    REQUIRE(value);
    CHECK(*value == 10 * std::round(index[0]) + std::round(index[1]) + 100 * std::round(index[2]));
  }
  CHECK_FALSE(comparison.valueAt(transformPoint(geometry::matrixOf(pose), transformPoint(oblique(), {-0.6, 4, 4}))));
  CHECK_FALSE(comparison.valueAt({1e9, 0, 0}));
  // The read-out of the views has it next to the first scan's, also outside of that.
  ImageViews views;
  views.setImage(image(kStraight, "first"));
  views.setComparison(&comparison);
  const Vec3 inside = transformPoint(geometry::matrixOf(pose), transformPoint(oblique(), {3, 4, 5}));
  CHECK(views.readout(inside).second == comparison.valueAt(inside));
  CHECK_THAT(views.readout(inside).placeText(), Contains("second 534 HU"));
  CHECK(views.look().comparison.worldFromSecond == comparison.worldFromSecond());
  ComparisonOptions options = comparison.options();
  options.isShown = false;
  comparison.setOptions(options);
  CHECK_FALSE(views.readout(inside).second);
  CHECK(views.look().comparison == render::ComparisonDisplay{});
}

TEST_CASE("Changes of the pose are steps of undo, and an undone pose has its residual and revision", "[comparison]") {
  registry::EditList edits;
  Comparison comparison(&edits);
  comparison.set(image(oblique()), {});
  CHECK(comparison.revision() == 0);
  const RigidPose first = comparison.pose();
  CHECK(first == RigidPose{{}, {}, comparison.centre_mm()});

  const RigidPose wanted{{12, -34, 56}, {10, -20, 30}, {}};
  std::vector<Vec3> moving;
  for (const Vec3 &p : kPoints) moving.push_back(transformPoint(geometry::rigidInverse(geometry::matrixOf(wanted)), p));
  const auto alignment = alignByLandmarks(named(kPoints), named(moving), comparison.centre_mm());
  REQUIRE(alignment);
  CHECK(alignment->pairs == 4);
  CHECK(alignment->max_mm < 1e-9);
  REQUIRE(comparison.align(*alignment));
  CHECK(norm(transformPoint(comparison.worldFromSecond(), moving[2]) - kPoints[2]) < 1e-9);
  REQUIRE(comparison.alignment());
  const std::uint64_t aligned = comparison.revision();

  RigidPose dragged = comparison.pose();
  dragged.translation_mm[0] += 3.0;
  comparison.preview(dragged);
  CHECK_FALSE(comparison.alignment());
  comparison.finishPreview("move comparison");
  CHECK(edits.undoLabel() == "move comparison");
  edits.undo();
  CHECK(comparison.pose() == alignment->pose);
  CHECK(comparison.revision() == aligned);
  CHECK(comparison.alignment());
  edits.undo();
  CHECK(comparison.pose() == first);
  CHECK(comparison.revision() == 0);
  edits.redo();
  edits.redo();
  CHECK(comparison.pose() == dragged);
  // A preview that is cancelled leaves nothing, and the same pose is no step.
  const std::uint64_t count = edits.edits();
  comparison.preview(first);
  comparison.cancelPreview();
  CHECK(comparison.pose() == dragged);
  REQUIRE(comparison.edit("nothing", dragged));
  CHECK(edits.edits() == count);
  // With the scan its steps end.
  comparison.clear();
  CHECK(edits.undoLabel().empty());
  CHECK_FALSE(comparison.isShown());
}

TEST_CASE("A pose that is not finite is refused, and options are kept in range", "[comparison]") {
  Comparison comparison;
  comparison.set(image(kStraight), {});
  const RigidPose before = comparison.pose();
  RigidPose bad = before;
  bad.rotation_deg[1] = std::numeric_limits<double>::quiet_NaN();
  const auto refused = comparison.edit("move", bad);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("accepted: finite numbers"));
  CHECK_FALSE(comparison.assign(bad));
  comparison.preview(bad);
  CHECK(comparison.pose() == before);
  ComparisonOptions options = comparison.options();
  options.blend = 7.0;
  options.square_mm = -1.0;
  comparison.setOptions(options);
  CHECK(comparison.options().blend == 1.0);
  CHECK(comparison.options().square_mm == Comparison::kSmallestSquare_mm);
}

TEST_CASE("Landmarks without partners are named when too few are left", "[comparison]") {
  const auto why = [](const std::vector<NamedPoint> &fixed, const std::vector<NamedPoint> &moving) {
    const auto alignment = alignByLandmarks(fixed, moving, {});
    return alignment ? std::string() : alignment.error().message;
  };
  std::vector<NamedPoint> other = named(kPoints);
  other[0].name = "hilum";
  other[3].name = "apex";
  CHECK_THAT(why(named(kPoints), other),
             Contains("2 pairs of points; accepted: at least 3") && Contains("no landmark 'hilum', 'apex'"));
  CHECK_THAT(why({}, named(kPoints)), Contains("0 pairs") && Contains("It has no landmarks at all"));
  const std::vector<NamedPoint> line = named({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}});
  CHECK_THAT(why(line, line), Contains("in a straight line"));
  // Others than the pairs do not matter.
  other[0].name = "p0";
  CHECK(why(named(kPoints), other).empty());
}

TEST_CASE("A drag in a slice moves the second scan in its plane, another tool rotates it about the cross-hair",
          "[comparison]") {
  registry::EditList edits;
  registry::ToolRegistry tools;
  Comparison comparison(&edits);
  ImageViews views;
  views.setImage(image(kStraight, "first"));
  views.setComparison(&comparison);
  for (const Pane pane : kSlicePanes) views.view(pane).setSize(400, 300);
  comparison.set(image(kStraight), {});
  ComparisonTools alignment(tools, views, comparison);
  alignment.offer(true);
  REQUIRE(tools.tools().size() == 2);
  SliceController slices(tools);
  const auto drag = [&](Pane pane, double x0, double y0, double x1, double y1) {
    for (const auto &[kind, x, y] : {std::tuple{ViewInput::Kind::move, x0, y0},
                                     {ViewInput::Kind::press, x0, y0},
                                     {ViewInput::Kind::move, 0.5 * (x0 + x1), 0.5 * (y0 + y1)},
                                     {ViewInput::Kind::move, x1, y1},
                                     {ViewInput::Kind::release, x1, y1}}) {
      ViewInput input;
      input.kind = kind;
      input.x = x;
      input.y = y;
      input.button = kind == ViewInput::Kind::move ? 0 : C3DE_BUTTON_LEFT;
      slices.handle(views, pane, input);
    }
  };
  tools.activate(tools.tools()[0].handle);
  const SliceView &coronal = views.view(Pane::coronal);
  const Vec3 wanted = coronal.worldAt(260, 110) - coronal.worldAt(200, 150);
  drag(Pane::coronal, 200, 150, 260, 110);
  CHECK(norm(comparison.pose().translation_mm - wanted) < 1e-9);
  CHECK(norm(comparison.pose().rotation_deg) < 1e-9);
  CHECK(wanted[1] == 0.0);
  CHECK(edits.undoLabel() == "move comparison");
  edits.undo();
  CHECK(norm(comparison.pose().translation_mm) == 0.0);

  tools.activate(tools.tools()[1].handle);
  // A quarter turn about the cross-hair, seen in the axial slice.
  const SliceView &axial = views.view(Pane::axial);
  const Vec3 pivot = axial.worldAt(200, 150);
  views.setCrossHair(pivot);
  const Vec3 from = axial.worldAt(260, 150), to = axial.worldAt(200, 210);
  drag(Pane::axial, 260, 150, 200, 210);
  CHECK(norm(transformPoint(comparison.worldFromSecond(), from) - to) < 1e-6);
  CHECK(norm(transformPoint(comparison.worldFromSecond(), pivot) - pivot) < 1e-6);
  CHECK(edits.undoLabel() == "rotate comparison");
  // A press without a drag is no step.
  const std::uint64_t count = edits.edits();
  drag(Pane::axial, 230, 150, 230, 150);
  CHECK(edits.edits() == count);
  alignment.offer(false);
  CHECK(tools.tools().empty());
}

TEST_CASE("The panel moves the second scan by numbers, and centres, resets and removes it", "[comparison]") {
  registry::EditList edits;
  registry::PanelRegistry panels;
  Comparison comparison(&edits);
  ImageViews views;
  views.setImage(image(kStraight, "first"));
  views.setComparison(&comparison);
  comparison.set(image(oblique(), "PAT2"), {});
  std::filesystem::path landmarks;
  bool isRemoved = false;
  const ComparisonPanel panel(
      panels, comparison, views,
      {[&](const std::filesystem::path &file) { landmarks = file; }, [&] { isRemoved = true; }});
  registry::TextPanel text(nullptr);
  const auto draw = [&] { return text.draw(*panels.panels().front()); };
  CHECK_THAT(draw(), Contains("PAT2") && Contains("Second scan"));
  text.setNumber("x", 12.5);
  draw();
  text.setNumber("ry", -90.0);
  draw();
  CHECK(comparison.pose().translation_mm == Vec3{12.5, 0, 0});
  CHECK(comparison.pose().rotation_deg == Vec3{0, -90, 0});
  CHECK(edits.undoLabel() == "rotate comparison");
  edits.undo();
  CHECK(edits.undoLabel() == "move comparison");
  text.press("centre");
  draw();
  const Vec3 middle = transformPoint(kStraight, {5.5, 4.5, 3.5});
  CHECK(norm(transformPoint(comparison.worldFromSecond(), comparison.centre_mm()) - middle) < 1e-9);
  text.press("reset");
  draw();
  CHECK(comparison.pose() == RigidPose{{}, {}, comparison.centre_mm()});
  text.setNumber("blend", 80.0);
  draw();
  CHECK_THAT(comparison.options().blend, WithinAbs(0.8, 1e-12));
  text.setText("mode", "checkerboard");
  draw();
  text.setNumber("square", 35.0);
  draw();
  CHECK(comparison.options().isCheckerboard);
  CHECK(comparison.text() == "PAT2 in squares of 35 mm");
  text.setText("align", "points.csv");
  draw();
  CHECK(landmarks == "points.csv");
  text.press("remove");
  draw();
  CHECK(isRemoved);
  CHECK(text.problems().empty());
}
