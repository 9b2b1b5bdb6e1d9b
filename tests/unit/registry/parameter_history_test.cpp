// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/parameter_history.h"

#include "c3de/registry/parameter_registry.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::registry;

namespace {

struct Fixture {
  ParameterRegistry registry;
  Handle set;
  std::vector<double> told;

  Fixture() {
    ParameterSet declared;
    for (const char *id : {"stiffness", "density"}) {
      ParameterDecl decl;
      decl.id = id;
      decl.label = id;
      decl.max = 100.0;
      decl.fallback = 1.0;
      declared.decls.push_back(decl);
    }
    declared.listener.self = this;
    declared.listener.changed = [](void *self, const c3de_param_value *value) {
      static_cast<Fixture *>(self)->told.push_back(value->num);
    };
    set = registry.declare(std::move(declared));
  }
  void edit(const char *id, double x) {
    ParameterValue value;
    value.id = id;
    value.num = x;
    REQUIRE(registry.edit(set, value));
  }
  double stiffness() { return registry.find(set)->values[0].num; }
};

}  // namespace

TEST_CASE("an edit is undone and redone, and the listener hears of both") {
  Fixture f;
  f.edit("stiffness", 5.0);
  CHECK(f.registry.history().undoLabel() == "stiffness");
  f.registry.history().undo(f.registry);
  CHECK(f.stiffness() == 1.0);
  f.registry.history().redo(f.registry);
  CHECK(f.stiffness() == 5.0);
  CHECK(f.told == std::vector<double>{5.0, 1.0, 5.0});
  CHECK_FALSE(f.registry.history().canRedo());
}

TEST_CASE("one drag of a slider is one entry, two drags are two") {
  Fixture f;
  for (const double x : {2.0, 3.0, 4.0}) f.edit("stiffness", x);
  f.registry.history().endGesture();
  for (const double x : {5.0, 6.0}) f.edit("stiffness", x);
  f.registry.history().undo(f.registry);
  CHECK(f.stiffness() == 4.0);
  f.registry.history().undo(f.registry);
  CHECK(f.stiffness() == 1.0);
  CHECK_FALSE(f.registry.history().canUndo());
}

TEST_CASE("a new edit ends what could be redone") {
  Fixture f;
  f.edit("stiffness", 5.0);
  f.registry.history().undo(f.registry);
  f.edit("density", 7.0);
  CHECK_FALSE(f.registry.history().canRedo());
  f.registry.history().undo(f.registry);
  CHECK(f.registry.find(f.set)->values[1].num == 1.0);
}

TEST_CASE("a refused edit leaves no entry") {
  Fixture f;
  ParameterValue value;
  value.id = "stiffness";
  value.num = 1e9;
  CHECK_FALSE(f.registry.edit(f.set, value));
  CHECK_FALSE(f.registry.history().canUndo());
}

TEST_CASE("when the owner shows other values, or goes, its history goes too") {
  Fixture f;
  f.edit("stiffness", 5.0);
  ParameterValue shown;
  shown.id = "density";
  shown.num = 2.0;
  REQUIRE(f.registry.set(f.set, shown, false));
  CHECK_FALSE(f.registry.history().canUndo());
  f.edit("stiffness", 6.0);
  f.registry.remove(f.set);
  f.registry.history().undo(f.registry);
  CHECK_FALSE(f.registry.history().canUndo());
}

TEST_CASE("1000 changes are all undone and redone, and the oldest are removed by memory") {
  Fixture f;
  ParameterHistory &history = f.registry.history();
  for (int i = 0; i < 1000; ++i) {
    f.edit("stiffness", 2.0 + i % 90);
    history.endGesture();
  }
  CHECK(history.undoCount() == 1000);
  CHECK(history.bytes() <= ParameterHistory::kBudget);
  for (int i = 0; i < 1000; ++i) history.undo(f.registry);
  CHECK_FALSE(history.canUndo());
  CHECK(f.stiffness() == 1.0);
  while (history.canRedo()) history.redo(f.registry);
  CHECK(f.stiffness() == 2.0 + 999 % 90);
  while (history.undoCount() == history.edits()) {
    REQUIRE(history.edits() < 1000000);
    f.edit("stiffness", 2.0 + static_cast<double>(history.edits() % 90));
    history.endGesture();
  }
  CHECK(history.undoCount() == history.edits() - 1);
  CHECK(history.bytes() <= ParameterHistory::kBudget);
  CHECK(history.bytes() > ParameterHistory::kBudget * 9 / 10);
  while (history.canUndo()) history.undo(f.registry);
  CHECK(history.bytes() <= ParameterHistory::kBudget);
  CHECK(f.stiffness() == 2.0);  // the value before the oldest change that is left
}

TEST_CASE("values that are edited together are one step, and none is set if one is refused") {
  Fixture f;
  const auto values = [](double stiffness, double density) {
    ParameterValue first, second;
    first.id = "stiffness";
    first.num = stiffness;
    second.id = "density";
    second.num = density;
    return std::vector<ParameterValue>{first, second};
  };
  f.edit("stiffness", 2.0);
  REQUIRE(f.registry.edit(f.set, "Both", values(5.0, 7.0)));
  CHECK(f.told == std::vector<double>{2.0, 5.0, 7.0});
  f.edit("stiffness", 6.0);
  ParameterHistory &history = f.registry.history();
  CHECK_FALSE(f.registry.edit(f.set, "Refused", values(8.0, 1e9)));
  CHECK(f.stiffness() == 6.0);
  CHECK(history.undoLabel() == "stiffness");
  history.undo(f.registry);
  CHECK(history.undoLabel() == "Both");
  history.undo(f.registry);
  CHECK(f.stiffness() == 2.0);
  CHECK(f.registry.find(f.set)->values[1].num == 1.0);
  CHECK(history.redoLabel() == "Both");
  history.redo(f.registry);
  CHECK(f.stiffness() == 5.0);
  CHECK(f.registry.find(f.set)->values[1].num == 7.0);
  CHECK(history.redoLabel() == "stiffness");

  // Equal values are no change.
  REQUIRE(f.registry.edit(f.set, "Again", values(5.0, 7.0)));
  CHECK(history.undoLabel() == "Both");
}
