// SPDX-License-Identifier: Apache-2.0
// Every bad plugin gets the intended verdict and leaves nothing behind, and a good one loads after it.
#include <cstring>

#include "c3de/registry/text_panel.h"
#include "host_fixture.h"

using namespace c3de;
using c3de::test::HostFixture;

namespace {

struct BadCase {
  const char *plugin;
  std::vector<std::string> reason;  ///< parts of it
};

const std::vector<BadCase> kBadPlugins {
  {"wrong_abi_major", {"built for plugin ABI 7", "this host serves 1", "get a newer host"}},
      {"declines", {"the plugin declines: needs a licence key"}},
      {"no_entry", {"not a plugin: no symbol c3de_plugin_query"}},
      {"null_plugin", {"bad descriptor", "plugin is null"}}, {"null_create", {"bad descriptor", "create is null"}},
      {"null_start", {"bad descriptor", "start is null"}}, {"null_stop", {"bad descriptor", "stop is null"}},
      {"null_destroy", {"bad descriptor", "destroy is null"}}, {"size_four", {"bad descriptor", "size is 4"}},
      {"why_not_rubbish", {"the plugin declines: no \\x1b[2J way\\xff\\xff"}},
      {"empty_id", {"bad descriptor", "id: is empty"}}, {"id_not_utf8", {"bad descriptor", "id: is not UTF-8"}},
      {"size_zero", {"bad descriptor", "size is 0"}}, {"size_huge", {"bad descriptor", "size is 2147483648"}},
      {"huge_needs", {"bad descriptor", "needs_n is 9223372036854775807", "at most 256"}},
      {"unknown_service", {"needs c3de.lag/1, which this host does not have", "did you mean c3de.log/1?"}},
      {"too_new_revision", {"needs c3de.collision/1 rev >= 3, host has 2", "get a newer host"}},
      {"class_twice", {"create failed", "class test.First/0 is registered by plugin test.class_twice already"}},
      {"throws_in_query", {"an exception left c3de_plugin_query: thrown in query"}},
      {"throws_in_create", {"an exception left create: thrown in create"}},
      {"sdk_throws", {"create failed: the presets cannot be read (C3DE_E_IO)"}},
      {"fails_in_create", {"create failed: the moon is in the wrong phase (C3DE_E_STATE)"}},
      {"fails_in_start", {"start failed: the moon is in the wrong phase (C3DE_E_STATE)"}},
#if !defined(_WIN32)
      {"missing_library", {"cannot be loaded", "c3de_test_gone"}},
      {"undefined_symbol", {"cannot be loaded", "a_function_that_nobody_has"}},
#endif
};

void writeFile(const std::filesystem::path &path, const std::string &content) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << content;
}

std::string readFile(const std::filesystem::path &path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::filesystem::path scratch(const std::string &name) {
  return std::filesystem::path(testOutputRoot()) / "plugins" / (name + pluginExtension());
}

}  // namespace

TEST_CASE("each bad plugin is refused with its reason and leaves nothing behind") {
  for (const BadCase &bad : kBadPlugins) {
    INFO(bad.plugin);
    HostFixture f;
    const std::string reason = f.refusalOf(HostFixture::testPlugin(bad.plugin));
    for (const std::string &part : bad.reason) CHECK_THAT(reason, Contains(part));
    CHECK(reason.find('\n') == std::string::npos);
    CHECK(f.warnings() == 1);
    CHECK(f.linesWith(" refused: " + reason).size() == 1);
    CHECK(f.nothingIsRegistered());

    CHECK(f.refusalOf(HostFixture::hello()).empty());
    CHECK(f.host->classes().size() == 1);
    f.mainQueue.runFrame();
  }
}

TEST_CASE("all bad plugins one after the other do not disturb a good one") {
  HostFixture f;
  REQUIRE(f.refusalOf(HostFixture::hello()).empty());
  for (const BadCase &bad : kBadPlugins) CHECK_FALSE(f.refusalOf(HostFixture::testPlugin(bad.plugin)).empty());
  REQUIRE(f.host->classes().size() == 1);
  CHECK(f.host->classes().front().plugin == "org.c3de.hello");
  CHECK(f.panels.panels().size() == 1);
  CHECK(f.host->plugins().size() == 1 + kBadPlugins.size());
}

TEST_CASE("what a plugin has registered before it fails is taken back, whatever it is") {
  const bool inStart = GENERATE(false, true);
  HostFixture f;
  CHECK_FALSE(f.refusalOf(HostFixture::testPlugin(inStart ? "fails_in_start" : "fails_in_create")).empty());
  REQUIRE_FALSE(f.madeBy("params").isNull());
  CHECK(f.parameters.find(f.madeBy("params")) == nullptr);
  CHECK(f.sceneGraph.find(f.madeBy("node")) == nullptr);
  CHECK(f.meshes.find(f.madeBy("mesh")) == nullptr);
  // The first proxy of a fresh renderer.
  CHECK_FALSE(f.renderer->setVisible(Handle{0, 1}, true));
  f.mainQueue.runFrame();
  CHECK(f.linesWith("called: frame").empty());
  CHECK(f.linesWith("called: panel").empty());
  // destroy belongs to a create that succeeded; so do the tool's cancel, the job's end and the posted function.
  CHECK(f.linesWith("called: cancel").size() == (inStart ? 1u : 0u));
  CHECK(f.linesWith("called: destroy").size() == (inStart ? 1u : 0u));
  CHECK(f.linesWith("called: done").size() == (inStart ? 1u : 0u));
  CHECK(f.linesWith("called: posted").size() == (inStart ? 1u : 0u));
}

TEST_CASE("a class that another plugin has is refused with the other's name") {
  HostFixture f;
  REQUIRE(f.refusalOf(HostFixture::hello()).empty());
  CHECK_THAT(f.refusalOf(HostFixture::testPlugin("class_of_another")),
             Contains("class org.c3de.hello.Greeter/0 is registered by plugin org.c3de.hello already"));
  CHECK(f.host->classesWith("").size() == 1);
}

TEST_CASE("a second plugin of the same id is shadowed, with both paths") {
  HostFixture f;
  REQUIRE(f.refusalOf(HostFixture::hello()).empty());
  const auto second = HostFixture::testPlugin("same_id");
  const auto result = f.host->load(second);
  REQUIRE_FALSE(result);
  CHECK_THAT(result.error().message, Contains("shadowed") && Contains(second.lexically_normal().string()) &&
                                         Contains(HostFixture::hello().lexically_normal().string()));
}

TEST_CASE("a plugin that needs a window is refused in a run without one and loads with one") {
  {
    HostFixture f(true);
    CHECK_THAT(f.refusalOf(HostFixture::testPlugin("needs_window")),
               Contains("needs c3de.panels/1, which is not available in this run (it needs a window)"));
  }
  HostFixture f;
  CHECK(f.refusalOf(HostFixture::testPlugin("needs_window")).empty());
}

TEST_CASE("files that are no plugins are refused before the loader sees them") {
  HostFixture f;
  CHECK_THAT(f.refusalOf(scratch("no_such_file")), Contains("there is no such file"));

  const auto textFile = scratch("text_file");
  writeFile(textFile, "#!/bin/sh\necho this is a script\n");
  CHECK_THAT(f.refusalOf(textFile), Contains("not a plugin: not a shared library"));

  const auto empty = scratch("empty");
  writeFile(empty, "");
  CHECK_THAT(f.refusalOf(empty), Contains("not a plugin: not a shared library"));

  const auto wrongEnding = std::filesystem::path(testOutputRoot()) / "plugins" / "hello.txt";
  writeFile(wrongEnding, "text");
  CHECK_THAT(f.refusalOf(wrongEnding), Contains("the name ends in '.txt'"));

  const auto folder = scratch("folder");
  std::filesystem::create_directories(folder);
  CHECK_THAT(f.refusalOf(folder), Contains("not a plugin: not a file"));
  CHECK(f.nothingIsRegistered());
}

TEST_CASE("a truncated library is refused, wherever it was cut") {
  const std::string whole = readFile(HostFixture::hello());
  REQUIRE(whole.size() > 4096);
  HostFixture f;
  for (const std::size_t kept :
       {std::size_t{5}, std::size_t{100}, whole.size() / 4, whole.size() / 2, whole.size() - 1}) {
    const auto file = scratch("truncated_" + std::to_string(kept));
    writeFile(file, whole.substr(0, kept));
    INFO(kept);
    CHECK_THAT(f.refusalOf(file), Contains("truncated"));
  }
}

TEST_CASE("a library for another processor or system is named as such") {
  std::string library = readFile(HostFixture::hello());
#if defined(_WIN32)
  const auto header = static_cast<unsigned char>(library[60]) + 256u * static_cast<unsigned char>(library[61]);
  library[header + 4] = 0x4c;
  library[header + 5] = 0x01;
#else
  library[18] = 20;  // PowerPC
#endif
  const auto file = scratch("other_processor");
  writeFile(file, library);
  HostFixture f;
  CHECK_THAT(f.refusalOf(file), Contains("built for another processor"));
#if defined(_WIN32)
  library =
      "\x7f"
      "ELF";
#else
  library = "MZ and so on";
#endif
  writeFile(file, library);
  CHECK_THAT(f.refusalOf(file), Contains("a library for another system"));
}

TEST_CASE("callbacks of a plugin of the SDK that throw again and again are switched off, too") {
  HostFixture f;
  REQUIRE(f.refusalOf(HostFixture::testPlugin("sdk_callbacks_throw")).empty());
  f.host->start();
  const c3de_sim_status status{};
  registry::TextPanel text(nullptr);
  for (int i = 0; i < 10; ++i) {
    f.simulations.stepped({1, 1}, status);
    (void)text.draw(*f.panels.panels().front());
    f.mainQueue.runFrame();
  }
  for (const char *thrown : {"thrown after a step", "thrown in a frame", "thrown in a panel"}) {
    INFO(thrown);
    CHECK(f.linesWith(thrown).size() == 3);
  }
  CHECK(f.linesWith("is switched off, because it failed 3 times in a row").size() == 3);
  CHECK(f.linesWith("plugin test.sdk_callbacks_throw: stepped of a simulation watch failed: thrown after a step")
            .size() == 3);
}

TEST_CASE("exceptions that leave callbacks become lines in the log and do not end the program") {
  HostFixture f;
  REQUIRE(f.refusalOf(HostFixture::testPlugin("throws_later")).empty());
  f.mainQueue.runFrame();
  f.mainQueue.runFrame();
  CHECK(f.linesWith("thrown in a frame").size() == 2);
  CHECK(f.linesWith("thrown in a posted function").size() == 1);
  REQUIRE(f.panels.panels().size() == 1);
  registry::TextPanel text(&f.parameters);
  (void)text.draw(*f.panels.panels().front());
  CHECK(f.linesWith("thrown in a panel").size() == 1);
  REQUIRE(f.tools.tools().size() == 1);
  CHECK_FALSE(f.tools.activate(f.tools.tools().front().handle));
  CHECK(f.linesWith("thrown in a tool").size() == 1);
  const auto object = f.host->createObject("test.Thrower/0");
  REQUIRE_FALSE(object);
  CHECK_THAT(object.error().message, Contains("thrown in a class"));
  f.host.reset();
  CHECK(f.linesWith("thrown in a job").size() == 1);
  CHECK(f.linesWith("thrown in done").size() == 1);
  CHECK(f.linesWith("thrown in destroy").size() == 1);
}
