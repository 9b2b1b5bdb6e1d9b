// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/tool_registry.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::registry;

namespace {

/// A tool that counts, and modifies the registry as the test requests.
struct CountingTool {
  int activated = 0, cancelled = 0, events = 0;
  bool refuses = false, consumes = true;
  ToolRegistry *removesItselfFrom = nullptr;
  Handle handle;

  Tool asTool(const std::string &id) {
    Tool tool;
    tool.owner = "test.plugin";
    tool.id = id;
    tool.self = this;
    tool.activate = [](void *self) -> c3de_status {
      auto &t = *static_cast<CountingTool *>(self);
      ++t.activated;
      return t.refuses ? C3DE_E_STATE : C3DE_OK;
    };
    tool.cancel = [](void *self) { ++static_cast<CountingTool *>(self)->cancelled; };
    tool.onEvent = [](void *self, const c3de_event *, std::uint32_t *consumed) -> c3de_status {
      auto &t = *static_cast<CountingTool *>(self);
      ++t.events;
      *consumed = t.consumes;
      if (t.removesItselfFrom) t.removesItselfFrom->remove(t.handle);
      return C3DE_OK;
    };
    return tool;
  }
};

Panel panel(const std::string &owner, const std::string &id) {
  Panel p;
  p.owner = owner;
  p.id = id;
  return p;
}

ParameterDecl number(const std::string &id, double min, double max, double fallback) {
  ParameterDecl decl;
  decl.id = id;
  decl.min = min;
  decl.max = max;
  decl.fallback = fallback;
  return decl;
}

ParameterValue numberValue(const std::string &id, double value) {
  ParameterValue v;
  v.id = id;
  v.num = value;
  return v;
}

}  // namespace

TEST_CASE("panels are listed in the order they were added, and go with their plugin") {
  PanelRegistry registry;
  registry.add(panel("a", "one"));
  const Handle two = registry.add(panel("b", "two"));
  registry.add(panel("a", "three"));
  REQUIRE(registry.panels().size() == 3);
  CHECK(registry.panels()[1]->id == "two");
  registry.removeOwnedBy("a");
  REQUIRE(registry.panels().size() == 1);
  CHECK(registry.handles().front() == two);
  CHECK(registry.remove(two));
  CHECK_FALSE(registry.remove(two));
  CHECK(registry.find(two) == nullptr);
}

TEST_CASE("a message replaces the earlier one of the same title and stands last") {
  PanelRegistry registry;
  registry.notify(1, "A", "first");
  registry.notify(2, "B", "other");
  registry.notify(3, "A", "second");
  REQUIRE(registry.notifications().size() == 2);
  CHECK(registry.notifications()[1].text == "second");
  CHECK(registry.notifications()[1].serial > registry.notifications()[0].serial);
  registry.dismiss(registry.notifications()[0].serial);
  REQUIRE(registry.notifications().size() == 1);
  CHECK(registry.notifications()[0].title == "A");
}

TEST_CASE("activating a tool cancels the one before") {
  ToolRegistry registry;
  CountingTool first, second;
  const Handle a = registry.add(first.asTool("a")), b = registry.add(second.asTool("b"));
  CHECK(registry.activate(a));
  CHECK(registry.activate(b));
  CHECK(first.cancelled == 1);
  CHECK(registry.active() == b);
  CHECK(registry.activate({}));
  CHECK(second.cancelled == 1);
  CHECK(registry.active().isNull());
}

TEST_CASE("a tool that refuses leaves no tool active") {
  ToolRegistry registry;
  CountingTool first, refusing;
  refusing.refuses = true;
  const Handle a = registry.add(first.asTool("a")), b = registry.add(refusing.asTool("b"));
  registry.activate(a);
  CHECK_FALSE(registry.activate(b));
  CHECK(registry.active().isNull());
  CHECK(first.cancelled == 1);
}

TEST_CASE("a stale tool cannot be activated and the active one stays") {
  ToolRegistry registry;
  CountingTool first, gone;
  const Handle a = registry.add(first.asTool("a")), b = registry.add(gone.asTool("b"));
  registry.activate(a);
  registry.remove(b);
  CHECK_FALSE(registry.activate(b));
  CHECK(registry.active() == a);
  CHECK(first.cancelled == 0);
}

TEST_CASE("only the active tool gets events, and says whether it wants them") {
  ToolRegistry registry;
  CountingTool active, other;
  const Handle a = registry.add(active.asTool("a"));
  registry.add(other.asTool("b"));
  c3de_event event{};
  CHECK_FALSE(registry.dispatch(event));
  registry.activate(a);
  CHECK(registry.dispatch(event));
  active.consumes = false;
  CHECK_FALSE(registry.dispatch(event));
  CHECK(active.events == 2);
  CHECK(other.events == 0);
}

TEST_CASE("events of slices reach a tool that asks for them and no other") {
  ToolRegistry registry;
  CountingTool ofSpace, ofSlices;
  Tool asking = ofSlices.asTool("b");
  asking.inSlices = true;
  const Handle a = registry.add(ofSpace.asTool("a")), b = registry.add(asking);
  c3de_event event{};
  event.where = C3DE_IN_CORONAL;
  CHECK_FALSE(registry.worksInSlices());
  registry.activate(a);
  CHECK_FALSE(registry.worksInSlices());
  CHECK_FALSE(registry.dispatch(event));
  CHECK(ofSpace.events == 0);
  registry.activate(b);
  CHECK(registry.worksInSlices());
  CHECK(registry.dispatch(event));
  CHECK(ofSlices.events == 1);
}

TEST_CASE("a tool may remove itself while it handles an event") {
  ToolRegistry registry;
  CountingTool tool;
  tool.removesItselfFrom = &registry;
  tool.handle = registry.add(tool.asTool("a"));
  registry.activate(tool.handle);
  CHECK(registry.dispatch(c3de_event{}));
  CHECK(registry.tools().empty());
  CHECK(registry.active().isNull());
  CHECK(tool.cancelled == 1);
}

TEST_CASE("the tools of a plugin that goes are cancelled and removed") {
  ToolRegistry registry;
  CountingTool tool;
  registry.activate(registry.add(tool.asTool("a")));
  registry.removeOwnedBy("test.plugin");
  CHECK(tool.cancelled == 1);
  CHECK(registry.tools().empty());
}

TEST_CASE("parameters start at their defaults and keep what is accepted") {
  ParameterRegistry registry;
  ParameterSet set;
  set.decls = {number("a", 0, 10, 3), number("b", 0, 1, 0.5)};
  const Handle handle = registry.declare(set);
  REQUIRE(registry.find(handle)->values.size() == 2);
  CHECK(registry.find(handle)->values[0].num == 3);
  CHECK(registry.set(handle, numberValue("b", 0.75), false));
  CHECK(registry.find(handle)->values[1].num == 0.75);

  const auto refused = registry.set(handle, numberValue("b", 2), false);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("b") && Contains("2"));
  CHECK(registry.find(handle)->values[1].num == 0.75);
  CHECK_FALSE(registry.set(handle, numberValue("nothing", 1), false));
  CHECK(registry.remove(handle));
  CHECK_FALSE(registry.set(handle, numberValue("b", 0.75), false));
}

TEST_CASE("the listener hears of a person's change, not of the owner's") {
  struct Heard {
    int count = 0;
    double last = 0.0;
  } heard;
  ParameterRegistry registry;
  ParameterSet set;
  set.decls = {number("a", 0, 10, 3)};
  set.listener.self = &heard;
  set.listener.changed = [](void *self, const c3de_param_value *value) {
    ++static_cast<Heard *>(self)->count;
    static_cast<Heard *>(self)->last = value->num;
  };
  const Handle handle = registry.declare(set);
  CHECK(registry.set(handle, numberValue("a", 4), false));
  CHECK(heard.count == 0);
  CHECK(registry.set(handle, numberValue("a", 5), true));
  CHECK(heard.count == 1);
  CHECK(heard.last == 5);
  CHECK_FALSE(registry.set(handle, numberValue("a", 50), true));
  CHECK(heard.count == 1);
}

TEST_CASE("a listener may remove its own set") {
  struct Context {
    ParameterRegistry registry;
    Handle handle;
  } context;
  ParameterSet set;
  set.decls = {number("a", 0, 10, 3)};
  set.listener.self = &context;
  set.listener.changed = [](void *self, const c3de_param_value *) {
    auto &c = *static_cast<Context *>(self);
    c.registry.remove(c.handle);
  };
  context.handle = context.registry.declare(set);
  CHECK(context.registry.set(context.handle, numberValue("a", 4), true));
  CHECK(context.registry.find(context.handle) == nullptr);
}
