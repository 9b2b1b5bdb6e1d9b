// SPDX-License-Identifier: Apache-2.0
// The tool Load with events of the mouse: faces, boxes, arrows that are dragged, nodes of the scene.
#include "plugin_window.h"

using namespace plugin_tests;

namespace {

constexpr double kSide = 10000.0;  // mm², of the cube

/// The tool on the cube of 100 mm; the view looks along -z.
class Loads : public Window {
 public:
  explicit Loads(const std::string &more = {}) : Window("implicit", more) {
    activate("pointbased.load");
    flush();
  }
  void selectWith(const std::string &mode) {
    panel().setText("load_mode", mode);
    flush();
  }
  void box(double x0, double y0, double x1, double y1, std::uint32_t modifiers = 0) {
    REQUIRE(mouse(C3DE_EVENT_PRESS, x0, y0, modifiers));
    mouse(C3DE_EVENT_MOVE, x1, y1, modifiers);
    flush();
    mouse(C3DE_EVENT_RELEASE, x1, y1, modifiers);
    flush();
  }
  void boxInSlice(double x0, double y0, double x1, double y1, double z) {
    REQUIRE(mouseInSlice(C3DE_EVENT_PRESS, x0, y0, z));
    mouseInSlice(C3DE_EVENT_MOVE, x1, y1, z);
    flush();
    mouseInSlice(C3DE_EVENT_RELEASE, x1, y1, z);
    flush();
  }
  void click(double x, double y) {
    REQUIRE(mouse(C3DE_EVENT_PRESS, x, y));
    mouse(C3DE_EVENT_RELEASE, x, y);
    flush();
  }
  [[nodiscard]] std::string row(const std::string &name) { return panel().value(name).value_or(""); }
  /// mm²; 0: nothing.
  [[nodiscard]] double area() {
    const std::string text = row("Selected");
    const std::size_t at = text.find(", ");
    return at == std::string::npos ? 0.0 : std::stod(text.substr(at + 2));
  }
  /// Sets what is selected. @param field  with its value; empty: none
  void set(const std::string &kind, const std::string &field = {}, const std::string &value = {}) {
    panel().setText("load_kind", kind);
    flush();
    if (!field.empty()) panel().setText(field, value);
    flush();
    panel().press("load_add");
    flush();
    flush();
  }
  /// x y z, N, of a force.
  [[nodiscard]] Vec3 force(const std::string &number) {
    const registry::TextPanel::Widget *field = panel().find("load_value_" + number);
    REQUIRE(field);
    Vec3 out{};
    std::istringstream in(field->text);
    in >> out[0] >> out[1] >> out[2];
    return out;
  }
  [[nodiscard]] std::optional<Handle> node(const std::string &name) {
    for (const scene::SceneGraph::Row &row : nodes().rows())
      if (nodes().find(row.node)->name == name) return row.node;
    return {};
  }
};

const char *const kLowBody =
    "[[body]]\nname = \"low\"\nmesh = \"cube.obj\"\nposition = [0.02, 0.0, -0.3]\n"
    "material = { youngs_modulus = 2e4 }\nsampling = { count = 60 }\n";

}  // namespace

TEST_CASE("A click selects a side of a cube, and a support on it balances what presses the cube", "[loads]") {
  Loads window;
  window.selectWith("face");
  window.click(10.0, 20.0);
  CHECK(window.area() == kSide);
  window.set("Fix");
  CHECK(window.row("Fix 1") == "cube, 10000.0 mm²");
  CHECK(window.area() == 0.0);
  CHECK(window.undoCount() == 1);
  // With an angle above 90 degrees nothing would end a face; the accepted range ends there.
  window.key(']');
  window.flush();
  REQUIRE(window.panel().find("load_angle"));
  CHECK(std::stod(window.panel().find("load_angle")->text) == 30.0);
}

TEST_CASE("A box selects what is visible, and through the body what is hidden", "[loads]") {
  Loads window(kLowBody);
  window.selectWith("box");
  window.box(-80.0, -80.0, 80.0, 80.0);
  // The other cube is hidden by this one and the plate.
  CHECK(window.area() == kSide);
  CHECK(window.row("Selected").starts_with("cube"));
  CHECK(window.row("Note").empty());
  window.key('X');
  window.box(-80.0, -80.0, 80.0, 80.0);
  CHECK(window.area() == 6.0 * kSide);
  CHECK(window.row("Note") == "Only 'cube' is selected; the box also meets 'low'");
  // Alt removes; a box that meets nothing states it and changes nothing.
  window.key('X');
  window.box(-80.0, -80.0, 80.0, 80.0, C3DE_MOD_ALT);
  CHECK(window.area() == 5.0 * kSide);
  window.box(300.0, 300.0, 350.0, 350.0);
  CHECK(window.area() == 5.0 * kSide);
  CHECK(window.row("Note") == "The box meets no visible surface");
  window.key(127);
  window.flush();
  CHECK(window.area() == 0.0);
  // Within one triangle, and one of the other body where nothing hides it.
  window.box(-30.0, 5.0, -20.0, 10.0);
  CHECK(window.area() == 0.5 * kSide);
  CHECK(window.undoCount() == 0);
}

TEST_CASE("Escape restores the selection before a box or a stroke", "[loads]") {
  Loads window;
  window.selectWith("face");
  window.click(10.0, 20.0);
  window.selectWith("box");
  window.key('X');
  window.mouse(C3DE_EVENT_PRESS, -80.0, -80.0);
  window.mouse(C3DE_EVENT_MOVE, 80.0, 80.0);
  window.flush();
  CHECK(window.area() == 6.0 * kSide);  // a preview
  window.cancelTool();
  window.flush();
  CHECK(window.area() == kSide);
  // Less than two pixels are no box.
  window.box(0.0, 0.0, 1.0, 0.0, C3DE_MOD_ALT);
  CHECK(window.area() == kSide);
}

TEST_CASE("A box in a slice selects the surface near its plane", "[loads]") {
  Loads window;
  window.selectWith("box");
  window.boxInSlice(45.0, -20.0, 55.0, 20.0, 0.0);
  CHECK(window.area() == kSide);
  window.boxInSlice(-20.0, -20.0, 20.0, 20.0, 30.0);
  CHECK(window.area() == kSide);
  CHECK(window.row("Note") == "The box meets no surface within 2 mm of the slice");
  // The side at z = 50 mm is within 25 mm of the slice.
  window.panel().setNumber("load_depth", 25.0);
  window.flush();
  window.boxInSlice(-20.0, -20.0, 20.0, 20.0, 30.0);
  CHECK(window.area() == 2.0 * kSide);
}

TEST_CASE("A dragged arrow changes a force in one step of undo", "[loads]") {
  Loads window;
  window.selectWith("face");
  window.click(10.0, 20.0);
  window.set("Force", "load_vector", "0 0 -1");
  REQUIRE(window.row("Force 1") == "cube, 10000.0 mm²");
  CHECK(window.undoCount() == 1);
  const std::uint64_t before = window.state().hash;
  // The handle is below the middle of the side; a click chooses the force and leaves its value.
  window.click(0.0, 0.0);
  CHECK(window.undoCount() == 1);
  CHECK(window.panel().find("load_chosen_1")->text == "1");

  REQUIRE(window.mouse(C3DE_EVENT_PRESS, 0.0, 0.0));
  window.mouse(C3DE_EVENT_MOVE, 12.0, 0.0);
  window.mouse(C3DE_EVENT_MOVE, 24.0, 0.0);
  window.flush();
  CHECK_THAT(window.row("Dragged"), Catch::Matchers::StartsWith("Force 1: 1.1"));
  CHECK(window.force("1")[0] == 0.0);
  window.cancelTool();
  window.flush();
  CHECK(window.row("Dragged").empty());
  CHECK(window.undoCount() == 1);

  REQUIRE(window.mouse(C3DE_EVENT_PRESS, 0.0, 0.0));
  window.mouse(C3DE_EVENT_MOVE, 24.0, 0.0);
  window.flush();
  window.mouse(C3DE_EVENT_RELEASE, 24.0, 0.0);
  window.flush();
  // The arrow of 1 N is 0.28 of the diagonal of the cube: 24 mm to the side are 0.495 N.
  CHECK(std::abs(window.force("1")[0] - 0.495) < 0.005);
  CHECK(std::abs(window.force("1")[2] + 1.0) < 0.01);
  CHECK(window.undoCount() == 2);
  CHECK(window.history.undoLabel() == "drag Force 1");
  const auto after = window.state().hash;
  CHECK(window.hashWhenReopened()[0] == after);
  window.undo();
  CHECK(window.force("1") == Vec3{0.0, 0.0, -1.0});
  CHECK(window.state().hash == before);
  window.redo();
  CHECK(std::abs(window.force("1")[0] - 0.495) < 0.005);
  // Delete removes the chosen one.
  window.key(127);
  window.flush();
  CHECK(window.row("Force 1").empty());
  window.undo();
  CHECK(window.row("Force 1") == "cube, 10000.0 mm²");
}

TEST_CASE("A support or load is a node below its body, which hides it", "[loads]") {
  Loads window;
  window.selectWith("face");
  window.click(10.0, 20.0);
  window.set("Pressure", "load_pressure", "2");
  auto node = window.node("Pressure 1");
  REQUIRE(node);
  CHECK(window.nodes().find(window.nodes().find(*node)->parent)->name == "cube");
  CHECK(window.panel().find("load_shown_1")->text == "1");
  window.nodes().find(*node)->visible = false;
  window.nodes().touch();
  window.flush();
  CHECK(window.panel().find("load_shown_1")->text == "0");
  window.panel().check("load_shown_1", true);
  window.flush();
  window.flush();
  CHECK(window.nodes().find(*node)->visible);
  // A hidden body does not change the checkbox of what is below it.
  const Handle body = window.nodes().find(*node)->parent;
  window.nodes().find(body)->visible = false;
  window.flush();
  CHECK(window.panel().find("load_shown_1")->text == "1");
  window.nodes().find(body)->visible = true;
  window.panel().press("load_remove_1");
  window.flush();
  window.flush();
  CHECK_FALSE(window.node("Pressure 1"));
  window.undo();
  window.flush();
  CHECK(window.node("Pressure 1"));
}

TEST_CASE("What the simulation refuses leaves no step of undo", "[loads]") {
  Loads window;
  window.selectWith("face");
  window.click(10.0, 20.0);
  window.set("Fix");
  window.click(10.0, 20.0);
  CHECK(window.area() == kSide);
  window.set("Displace", "load_displacement", "0 0 5");
  window.flush();
  CHECK(window.row("Displace 2").empty());
  CHECK(window.undoCount() == 1);
}
