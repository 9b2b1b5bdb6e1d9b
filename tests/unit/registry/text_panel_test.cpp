// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/text_panel.h"

#include <array>
#include <cstring>

#include "c3de/core/text.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::registry;

namespace {

struct Controller {
  int pressed = 0;
  std::uint32_t checked = 0, law = 0, sliderResult = 0;
  double spacing = 0.01;
  char name[8] = "liver";
  c3de_handle set{};

  Panel asPanel() {
    Panel panel;
    panel.id = "test";
    panel.self = this;
    panel.onUi = [](void *self, const c3de_ui_v1 *ui) { static_cast<Controller *>(self)->draw(ui); };
    return panel;
  }
  void draw(const c3de_ui_v1 *ui) {
    void *c = ui->ctx;
    ui->heading(c, toAbi("Organ"));
    if (ui->button(c, toAbi("start"), toAbi("Start"), 1) & C3DE_UI_COMMITTED) ++pressed;
    if (ui->button(c, toAbi("off"), toAbi("Off"), 0) & C3DE_UI_COMMITTED) pressed += 100;
    ui->checkbox(c, toAbi("check"), toAbi("Transparent"), &checked);
    sliderResult = ui->slider(c, toAbi("spacing"), toAbi("Spacing"), toAbi("m"), &spacing, 0.001, 0.1);
    const c3de_str names[] = {toAbi("linear"), toAbi("stvk")};
    ui->choice(c, toAbi("law"), toAbi("Law"), &law, names, 2);
    ui->input_text(c, toAbi("name"), toAbi("Name"), name, sizeof name);
    ui->value(c, toAbi("Mass"), toAbi("0.32 kg"));
    ui->tooltip(c, toAbi("of all bodies"));
    ui->params(c, set, {nullptr, 0});
  }
};

}  // namespace

TEST_CASE("a panel is dumped as text") {
  Controller controller;
  TextPanel text(nullptr);
  const std::string shown = text.draw(controller.asPanel());
  CHECK_THAT(shown, Contains("# Organ") && Contains("[button: Start] (start)") && Contains("[ ] Transparent (check)"));
  CHECK_THAT(shown,
             Contains("Spacing = 0.01 m (spacing)") && Contains("Law = linear (law)") && Contains("Mass: 0.32 kg"));
  CHECK_THAT(shown, Contains("| of all bodies"));
  CHECK(text.value("Mass") == "0.32 kg");
  REQUIRE(text.find("off"));
  CHECK_FALSE(text.find("off")->enabled);
}

TEST_CASE("patches of colour and lists stand where the panel puts them") {
  Panel panel;
  panel.onUi = [](void *, const c3de_ui_v1 *ui) {
    REQUIRE(ui->rev >= 3);
    ui->list_begin(ui->ctx, toAbi(std::string_view("labels")), 5);
    ui->swatch(ui->ctx, 1.0f, 0.5f, -3.0f);
    ui->same_line(ui->ctx);
    ui->text(ui->ctx, toAbi(std::string_view("liver")));
    ui->list_end(ui->ctx);
    ui->text(ui->ctx, toAbi(std::string_view("after")));
  };
  TextPanel text(nullptr);
  CHECK(text.draw(panel) == "[#ff8000]  liver\nafter");
  std::string kinds;
  for (const TextPanel::Widget &widget : text.widgets()) kinds += widget.kind + ";";
  CHECK(kinds == "list;swatch;text;list end;text;");
  REQUIRE(text.find("labels"));
  CHECK(text.find("labels")->text == "5");
}

TEST_CASE("a curve tells its latest value") {
  Panel panel;
  panel.onUi = [](void *, const c3de_ui_v1 *ui) {
    REQUIRE(ui->rev >= 4);
    const std::array values{0.0, 1.5, 2.25};
    const auto abi = [](std::string_view text) { return toAbi(text); };
    ui->curve(ui->ctx, abi("force"), abi("Force"), abi("N"), values.data(), values.size());
    ui->curve(ui->ctx, abi("none"), abi("Nothing"), abi("N"), nullptr, 0);
  };
  TextPanel text(nullptr);
  CHECK(text.draw(panel) == "Force: curve of 3, 2.25 N (force)\nNothing: curve of 0, no value N (none)");
  REQUIRE(text.find("force"));
  CHECK(text.find("force")->text == "2.25");
}

TEST_CASE("widgets of a text panel act in the next draw and only once") {
  Controller controller;
  TextPanel text(nullptr);
  text.press("start");
  text.check("check", true);
  text.setNumber("spacing", 0.02);
  text.setText("law", "stvk");
  text.setText("name", "spleen");
  text.draw(controller.asPanel());
  CHECK(text.problems().empty());
  CHECK(controller.pressed == 1);
  CHECK(controller.checked == 1);
  CHECK(controller.spacing == 0.02);
  CHECK(controller.sliderResult == (C3DE_UI_CHANGED | C3DE_UI_COMMITTED));
  CHECK(controller.law == 1);
  CHECK(std::string(controller.name) == "spleen");
  text.draw(controller.asPanel());
  CHECK(controller.pressed == 1);
  CHECK(controller.sliderResult == 0);
}

TEST_CASE("what a text panel cannot do is a problem, not silence") {
  Controller controller;
  TextPanel text(nullptr);
  text.press("off");
  text.press("nothing");
  text.setNumber("spacing", 5.0);
  text.setText("law", "magic");
  text.setText("name", "a name that is too long");
  text.draw(controller.asPanel());
  CHECK(text.problems().size() == 5);
  CHECK(controller.pressed == 0);
  CHECK(controller.spacing == 0.01);
  CHECK(controller.law == 0);
  CHECK(std::string(controller.name) == "a name ");
}

TEST_CASE("parameters of a text panel are checked and reach the listener") {
  int heard = 0;
  ParameterRegistry registry;
  ParameterSet set;
  ParameterDecl decl;
  decl.id = "solver.dt";
  decl.label = "Time step";
  decl.unit = "s";
  decl.min = 0.0;
  decl.max = 1.0;
  decl.fallbackText = "auto";
  decl.flags = C3DE_PARAM_AUTO;
  set.decls = {decl};
  set.listener.self = &heard;
  set.listener.changed = [](void *self, const c3de_param_value *) { ++*static_cast<int *>(self); };
  Controller controller;
  controller.set = {registry.declare(set).bits()};

  TextPanel text(&registry);
  CHECK_THAT(text.draw(controller.asPanel()), Contains("Time step = auto (solver.dt)"));
  text.setNumber("solver.dt", 0.001);
  CHECK_THAT(text.draw(controller.asPanel()), Contains("Time step = 0.001 s (solver.dt)"));
  CHECK(heard == 1);
  text.setNumber("solver.dt", 7.0);
  text.draw(controller.asPanel());
  REQUIRE(text.problems().size() == 1);
  CHECK_THAT(text.problems()[0], Contains("solver.dt"));
  text.setText("solver.dt", "auto");
  CHECK_THAT(text.draw(controller.asPanel()), Contains("Time step = auto (solver.dt)"));
  CHECK(heard == 2);
}
