// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/edit_list.h"

#include "c3de/registry/parameter_registry.h"
#include "c3de/ui/edit_history.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;

namespace {

/// A number that is incremented by the step, and the recorded calls.
struct Counter {
  int value = 1, released = 0;
  bool fails = false;
  registry::EditList *removesItselfFrom = nullptr;
  Handle handle;

  registry::Edit edit(const std::string &label, const std::string &owner = "test.plugin") {
    registry::Edit made;
    made.owner = owner;
    made.label = label;
    made.self = this;
    made.undo = [](void *self) -> c3de_status { return static_cast<Counter *>(self)->change(-1); };
    made.redo = [](void *self) -> c3de_status { return static_cast<Counter *>(self)->change(+1); };
    made.release = [](void *self) { ++static_cast<Counter *>(self)->released; };
    return made;
  }
  c3de_status change(int by) {
    if (removesItselfFrom) removesItselfFrom->remove(handle);
    if (fails) return C3DE_E_STALE;
    value += by;
    return C3DE_OK;
  }
};

}  // namespace

TEST_CASE("steps of plugins are undone and redone in order") {
  registry::EditList list;
  Counter a, b;
  CHECK(list.undoLabel().empty());
  list.undo();
  list.redo();
  list.add(a.edit("pull on liver"));
  list.add(b.edit("pull on spleen"));
  CHECK(list.edits() == 2);
  CHECK(list.undoLabel() == "pull on spleen");
  CHECK(list.redoLabel().empty());
  list.undo();
  CHECK(b.value == 0);
  CHECK(a.value == 1);
  CHECK(list.undoLabel() == "pull on liver");
  CHECK(list.redoLabel() == "pull on spleen");
  list.undo();
  CHECK(a.value == 0);
  list.redo();
  CHECK(a.value == 1);
  CHECK(b.value == 0);
  // The next step clears the redo history.
  Counter c;
  list.add(c.edit("cut"));
  CHECK(b.released == 1);
  CHECK(list.redoLabel().empty());
  CHECK(list.undoLabel() == "cut");
  CHECK(a.released + c.released == 0);
}

TEST_CASE("a step that fails is forgotten, and one may remove itself") {
  registry::EditList list;
  Counter a, b, c;
  list.add(a.edit("a"));
  b.handle = list.add(b.edit("b"));
  list.add(c.edit("c"));
  c.fails = true;
  list.undo();
  CHECK(c.released == 1);
  CHECK(list.undoLabel() == "b");
  CHECK(list.redoLabel().empty());
  b.removesItselfFrom = &list;
  list.undo();
  CHECK(b.released == 1);
  CHECK(list.undoLabel() == "a");
  CHECK_FALSE(list.remove(b.handle));
}

TEST_CASE("an undo or redo that was not made is taken back") {
  registry::EditList list;
  Counter a, b;
  list.add(a.edit("a"));
  const Handle handle = list.add(b.edit("b"));
  list.undo();
  list.undo();
  list.takeBack(handle, true);
  CHECK(list.undoLabel() == "b");
  CHECK(list.redoLabel().empty());
  list.undo();
  list.redo();
  list.takeBack(handle, false);
  CHECK(list.undoLabel() == "a");
  CHECK(list.redoLabel() == "b");
  list.remove(handle);
  list.takeBack(handle, true);
  CHECK(list.undoLabel() == "a");
}

TEST_CASE("the oldest steps, and those of a plugin that goes, are forgotten") {
  registry::EditList list;
  Counter old, many, other;
  const std::string longLabel(std::size_t{64} << 10, 'm');
  list.add(old.edit(longLabel));
  std::size_t added = 0;
  for (; old.released == 0; ++added) {
    REQUIRE(added < 1000);
    list.add(many.edit(longLabel));
    CHECK(list.bytes() <= registry::EditList::kBudget);
  }
  // The first that is not kept is the oldest one, and only that.
  CHECK(added * longLabel.size() > registry::EditList::kBudget * 9 / 10);
  CHECK(many.released == 0);
  list.undo();
  list.add(other.edit("other", "test.other"));
  CHECK(many.released == 1);
  list.undo();
  list.removeOwnedBy("test.plugin");
  CHECK(many.released == static_cast<int>(added));
  CHECK(list.undoLabel().empty());
  CHECK(list.redoLabel() == "other");
  list.removeOwnedBy("test.other");
  CHECK(other.released == 1);
}

TEST_CASE("a list that goes lets go of its steps") {
  Counter a;
  {
    registry::EditList list;
    list.add(a.edit("a"));
  }
  CHECK(a.released == 1);
}

TEST_CASE("steps of plugins are a part of the window's history") {
  registry::EditList list;
  EditHistory history;
  Counter a;
  history.follow(nullptr, nullptr, &list);
  CHECK(history.undoLabel().empty());
  history.undo();
  list.add(a.edit("pull on liver"));
  history.follow(nullptr, nullptr, &list);
  CHECK(history.undoLabel() == "pull on liver");
  history.undo();
  CHECK(a.value == 0);
  CHECK(history.redoLabel() == "pull on liver");
  history.redo();
  CHECK(a.value == 1);
}

TEST_CASE("parameters and steps of plugins are undone and redone in the order in which they were made") {
  registry::ParameterRegistry parameters;
  registry::ParameterSet declared;
  ParameterDecl decl;
  decl.id = "stiffness";
  decl.label = "Stiffness";
  decl.max = 100.0;
  decl.fallback = 1.0;
  declared.decls.push_back(decl);
  declared.listener.changed = [](void *, const c3de_param_value *) {};
  const Handle set = parameters.declare(std::move(declared));
  registry::EditList list;
  EditHistory history;
  Counter pull;
  const auto follow = [&] { history.follow(&parameters, nullptr, &list); };
  const auto stiffness = [&] { return parameters.find(set)->values[0].num; };
  const auto edit = [&](double x) {
    ParameterValue value;
    value.id = "stiffness";
    value.num = x;
    REQUIRE(parameters.edit(set, value));
    parameters.history().endGesture();
    follow();
  };
  const auto makePull = [&] {
    ++pull.value;
    list.add(pull.edit("pull"));
    follow();
  };
  edit(2.0);
  makePull();
  edit(3.0);
  makePull();
  std::vector<std::string> labels;
  for (; !history.undoLabel().empty(); history.undo()) labels.push_back(history.undoLabel());
  CHECK(labels == std::vector<std::string>{"pull", "Stiffness", "pull", "Stiffness"});
  CHECK(pull.value == 1);
  CHECK(stiffness() == 1.0);
  history.redo();
  CHECK(stiffness() == 2.0);
  CHECK(pull.value == 1);
  history.redo();
  CHECK(pull.value == 2);
  history.redo();
  CHECK(stiffness() == 3.0);
  history.redo();
  CHECK(pull.value == 3);
  CHECK(history.redoLabel().empty());
  // An edit after an undo removes what was undone, also of the other kind.
  history.undo();
  CHECK(history.redoLabel() == "pull");
  edit(4.0);
  CHECK(history.redoLabel().empty());
  CHECK(history.undoLabel() == "Stiffness");
  history.undo();
  CHECK(stiffness() == 3.0);
  makePull();
  CHECK(history.redoLabel().empty());
}
