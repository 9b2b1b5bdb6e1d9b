// SPDX-License-Identifier: Apache-2.0
// Good plugins: the order of their life cycle, folders, hello, and one written with the SDK.
#include <chrono>
#include <cmath>
#include <thread>

#include "c3de/registry/text_panel.h"
#include "greeter.h"
#include "host_fixture.h"

using namespace c3de;
using c3de::test::HostFixture;

namespace {

c3de_str str(std::string_view s) { return {s.data(), s.size()}; }

c3de_status C3DE_CALL append(void *self, const void *bytes, std::uint64_t n) {
  static_cast<std::string *>(self)->append(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
  return C3DE_OK;
}

/// Runs frames until the condition holds, at most two seconds.
template <class F>
bool runFramesUntil(HostFixture &f, F &&condition) {
  for (int i = 0; i < 1000; ++i) {
    f.mainQueue.runFrame();
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

}  // namespace

TEST_CASE("plugins are created, started, stopped and destroyed in order, the last loaded goes first") {
  HostFixture f;
  REQUIRE(f.host->load(HostFixture::testPlugin("lifecycle_a")));
  REQUIRE(f.host->load(HostFixture::testPlugin("lifecycle_b")));
  CHECK(f.linesWith("step start").empty());
  f.host->start();
  f.host->start();  // starts no plugin twice
  f.host.reset();
  std::vector<std::string> steps;
  for (const std::string &line : f.linesWith("step ")) steps.push_back(line.substr(line.find("step ") + 5));
  CHECK(steps == std::vector<std::string>{"create a", "create b", "start a", "start b", "stop b", "stop a", "destroy b",
                                          "destroy a"});
  CHECK(f.linesWith("stop failed: C3DE_E_STATE").size() == 2);
}

TEST_CASE("a plugin that was never started is not stopped, but destroyed") {
  HostFixture f;
  REQUIRE(f.host->load(HostFixture::testPlugin("lifecycle_a")));
  f.host.reset();
  CHECK(f.linesWith("step stop").empty());
  CHECK(f.linesWith("step destroy a").size() == 1);
}

TEST_CASE("a folder is loaded in the order of names, what does not fit is listed") {
  const auto folder = std::filesystem::path(testOutputRoot()) / "plugin_folder";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::string ending = pluginExtension();
  std::filesystem::copy_file(HostFixture::testPlugin("lifecycle_b"), folder / ("1_second" + ending));
  std::filesystem::copy_file(HostFixture::testPlugin("lifecycle_a"), folder / ("0_first" + ending));
  std::filesystem::copy_file(HostFixture::testPlugin("lifecycle_a"), folder / ("2_copy" + ending));
  std::ofstream(folder / "readme.txt") << "not looked at";
  std::ofstream(folder / ("3_text" + ending)) << "looked at";
  HostFixture f;
  f.host->loadFolder(folder);
  f.host->loadFolder(folder / "no such folder");
  const auto &plugins = f.host->plugins();
  REQUIRE(plugins.size() == 4);
  CHECK(plugins[0].id == "test.lifecycle.a");
  CHECK(plugins[1].id == "test.lifecycle.b");
  CHECK_THAT(plugins[2].reason, Contains("test.lifecycle.a is loaded already from") && Contains("0_first"));
  CHECK_THAT(plugins[3].reason, Contains("not a shared library"));
}

TEST_CASE("a relative path is loaded as an absolute one") {
  HostFixture f;
  const auto relative = std::filesystem::relative(HostFixture::hello());
  REQUIRE(f.host->load(relative));
  CHECK(f.host->plugins().front().path.is_absolute());
}

TEST_CASE("hello says what it is, greets and counts") {
  HostFixture f;
  REQUIRE(f.refusalOf(HostFixture::hello()).empty());
  const plugin_host::PluginInfo &info = f.host->plugins().front();
  CHECK(info.id == "org.c3de.hello");
  CHECK(info.version == "1.0.0");
  CHECK(info.license == "Apache-2.0");
  CHECK(info.classes == std::vector<std::string>{HELLO_GREETER_CLASS});
  CHECK(f.host->classesWith(HELLO_GREETER_ID) == info.classes);
  CHECK(f.host->classesWith("no.such.iface/0").empty());
  CHECK(f.linesWith("[org.c3de.hello] hello from a plugin").size() == 1);

  const auto object = f.host->createObject(HELLO_GREETER_CLASS);
  REQUIRE(object);
  const void *table = nullptr;
  CHECK((*object)->vt->query(*object, str("other/0"), 1, &table) == C3DE_E_NOT_FOUND);
  CHECK((*object)->vt->query(*object, str(HELLO_GREETER_ID), 2, &table) == C3DE_E_VERSION);
  REQUIRE((*object)->vt->query(*object, str(HELLO_GREETER_ID), 1, &table) == C3DE_OK);
  const auto *greeter = static_cast<const hello_greeter_v0 *>(table);
  std::string text;
  CHECK(greeter->greet(*object, str("Ada"), {&text, &append}) == C3DE_OK);
  CHECK(text == "Hello, Ada!");
  CHECK(greeter->greet(*object, str(""), {&text, &append}) == C3DE_E_ARG);
  CHECK(greeter->greetings(*object) == 1);
  CHECK((*object)->vt->retain(*object) == 2);
  CHECK((*object)->vt->release(*object) == 1);
  CHECK((*object)->vt->release(*object) == 0);
}

TEST_CASE("hello has a panel with a button where there is a window, and does without elsewhere") {
  {
    HostFixture f;
    REQUIRE(f.refusalOf(HostFixture::hello()).empty());
    REQUIRE(f.panels.panels().size() == 1);
    registry::TextPanel panel(&f.parameters);
    (void)panel.draw(*f.panels.panels().front());
    panel.press("hello");
    (void)panel.draw(*f.panels.panels().front());
    CHECK(panel.problems().empty());
    CHECK(f.linesWith("hello again").size() == 1);
  }
  HostFixture f(true);
  REQUIRE(f.refusalOf(HostFixture::hello()).empty());
  CHECK(f.host->classes().size() == 1);
}

TEST_CASE("a plugin written with the SDK has its panel, tool, parameters, job and frames") {
  HostFixture f;
  REQUIRE(f.refusalOf(HostFixture::testPlugin("probe")).empty());
  REQUIRE(f.panels.panels().size() == 1);
  registry::TextPanel panel(&f.parameters);
  CHECK_THAT(panel.draw(*f.panels.panels().front()), Contains("Measure"));
  CHECK(panel.value("Frames").has_value());

  // The job fills the panel's result with the volume of a tetrahedron of 10 mm.
  panel.press("measure");
  (void)panel.draw(*f.panels.panels().front());
  REQUIRE(runFramesUntil(f, [&] {
    (void)panel.draw(*f.panels.panels().front());
    return panel.value("Volume").has_value();
  }));
  CHECK(panel.value("Volume") == "166.667 mm³");

  // The user changes the declared parameter; the plugin is notified and refuses nothing, because the host has checked.
  panel.setNumber("scale", 2.0);
  (void)panel.draw(*f.panels.panels().front());
  (void)panel.draw(*f.panels.panels().front());
  CHECK(panel.problems().empty());
  CHECK(panel.value("Scale is") == "2");

  REQUIRE(f.tools.tools().size() == 1);
  CHECK(f.tools.activate(f.tools.tools().front().handle));
  c3de_event event{};
  event.size = sizeof event;
  event.type = C3DE_EVENT_PRESS;
  CHECK(f.tools.dispatch(event));
  event.type = C3DE_EVENT_MOVE;
  CHECK_FALSE(f.tools.dispatch(event));
  f.host.reset();
  CHECK(f.panels.panels().empty());
  CHECK(f.tools.tools().empty());
}

TEST_CASE("a plugin written with the SDK offers a class and uses that of another plugin") {
  HostFixture f;
  REQUIRE(f.refusalOf(HostFixture::testPlugin("probe")).empty());
  REQUIRE(f.refusalOf(HostFixture::hello()).empty());
  const auto object = f.host->createObject("org.example.Probe/0");
  REQUIRE(object);
  const void *table = nullptr;
  CHECK((*object)->vt->query(*object, str("nothing/0"), 1, &table) == C3DE_E_NOT_FOUND);
  CHECK_THAT(f.host->takeError(), Contains("does not implement nothing/0"));
  CHECK((*object)->vt->release(*object) == 0);
}

TEST_CASE("a class that does not exist is named, with the nearest one") {
  HostFixture f;
  REQUIRE(f.refusalOf(HostFixture::hello()).empty());
  const auto object = f.host->createObject("org.c3de.hello.Greter/0");
  REQUIRE_FALSE(object);
  CHECK_THAT(object.error().message, Contains("did you mean org.c3de.hello.Greeter/0"));
}
