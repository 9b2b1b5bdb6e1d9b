// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/edit_list.h"

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

TEST_CASE("the oldest steps, and those of a plugin that goes, are forgotten") {
  registry::EditList list;
  Counter old, many, other;
  list.add(old.edit("old"));
  for (std::size_t i = 0; i < registry::EditList::kMost; ++i) list.add(many.edit("many"));
  CHECK(old.released == 1);
  CHECK(many.released == 0);
  list.undo();
  list.add(other.edit("other", "test.other"));
  CHECK(many.released == 1);
  list.undo();
  list.removeOwnedBy("test.plugin");
  CHECK(many.released == static_cast<int>(registry::EditList::kMost));
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
