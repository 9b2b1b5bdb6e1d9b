// SPDX-License-Identifier: Apache-2.0
// Plugin settings persist after the program ends; a damaged file is reported and preserved.
#include <fstream>
#include <iterator>

#include "c3de/registry/settings_store.h"
#include "host_fixture.h"

using namespace c3de;
using registry::SettingsStore;

namespace {

std::string contentOf(const std::filesystem::path &file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("what a plugin sets is there in the next run, and is its own") {
  test::HostFixture f;
  {
    SettingsStore store(f.settingsFolder);
    REQUIRE(store.set("org.a", "name", "Grüße\n\"quoted\""));
    REQUIRE(store.set("org.a", "gone", "x"));
    REQUIRE(store.remove("org.a", "gone").value_or(false));
    REQUIRE(store.set("org.b", "name", "other"));
  }
  SettingsStore store(f.settingsFolder);
  CHECK(store.get("org.a", "name") == "Grüße\n\"quoted\"");
  CHECK(store.get("org.b", "name") == "other");
  CHECK_FALSE(store.get("org.a", "gone"));
  CHECK(store.keys("org.a") == std::vector<std::string>{"name"});
  CHECK(store.fileOf("..").parent_path() == f.settingsFolder);
  CHECK(store.fileOf("../../etc").parent_path() == f.settingsFolder);
}

TEST_CASE("a damaged settings file is told, kept beside, and costs nothing that was loaded") {
  test::HostFixture f;
  setLogThreshold(LogLevel::warn);
  {
    SettingsStore store(f.settingsFolder);
    REQUIRE(store.set("org.a", "name", "kept"));
    REQUIRE(store.set("org.b", "name", "other"));
  }
  SettingsStore store(f.settingsFolder);
  CHECK(store.get("org.b", "name") == "other");
  const std::string damaged = GENERATE(as<std::string>{}, "{\"name\": \"ke", "", "[1, 2]", "{\"name\": 3}");
  std::ofstream(store.fileOf("org.a"), std::ios::binary) << damaged;
  std::ofstream(store.fileOf("org.b"), std::ios::binary) << damaged;
  CHECK_FALSE(store.get("org.a", "name"));
  CHECK(f.linesWith("org.a.json: is damaged").size() == 1);
  CHECK(store.get("org.b", "name") == "other");
  REQUIRE(store.set("org.a", "name", "new"));
  CHECK(contentOf(store.fileOf("org.a").string() + ".damaged") == damaged);
  REQUIRE(store.set("org.b", "second", "too"));
  SettingsStore after(f.settingsFolder);
  CHECK(after.get("org.a", "name") == "new");
  CHECK(after.get("org.b", "name") == "other");
}

TEST_CASE("what cannot be written is said, and holds for this run") {
  test::HostFixture f;
  std::filesystem::create_directories(f.settingsFolder.parent_path());
  std::ofstream(f.settingsFolder) << "a file where the folder should be";
  SettingsStore store(f.settingsFolder);
  const auto written = store.set("org.a", "name", "value");
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ErrorCode::output);
  CHECK(written.error().message.find(f.settingsFolder.filename().string()) != std::string::npos);
  CHECK(store.get("org.a", "name") == "value");
  CHECK_FALSE(store.set("org.a", "long", std::string(SettingsStore::kLongestValue + 1, 'x')));
}
