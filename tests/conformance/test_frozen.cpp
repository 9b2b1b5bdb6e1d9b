// SPDX-License-Identifier: Apache-2.0
// The meaning of frozen: old plugins load in the current host, and current plugins in an old host.
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/abi/c3de.h"
#include "host_fixture.h"
#include "support/catch.h"
#include "support/folders.h"

#if defined(__linux__) && defined(__x86_64__)
#include <dlfcn.h>
#endif

using namespace c3de;
using c3de::test::HostFixture;
using Catch::Matchers::Contains;

#if defined(__linux__) && defined(__x86_64__)

TEST_CASE("plugins that were built of earlier headers load and act in this host") {
  // Each with its source and its build command: kept/README.md.
  for (const char *name : {"hello_of_draft_0.so", "hello_of_1.so"}) {
    HostFixture f;
    INFO(name);
    CHECK(f.refusalOf(std::filesystem::path(C3DE_KEPT_PLUGINS) / "linux-x86_64" / name) == "");
    REQUIRE(f.host->plugins().size() == 1);
    CHECK(f.host->plugins()[0].id == "org.c3de.hello");
    CHECK_FALSE(f.host->plugins()[0].classes.empty());
    auto greeter = f.host->createObject(f.host->plugins()[0].classes[0]);
    REQUIRE(greeter);
    CHECK((*greeter)->vt->release(*greeter) == 0);
  }
}

namespace {

/// A host with only the first frozen interfaces: the host's table without set_error_at, services of revision 1 in their
/// first sizes.
struct FirstHost {
  std::vector<std::string> lines, classes, asked;

  static FirstHost &of(void *ctx) { return *static_cast<FirstHost *>(ctx); }
  static std::string textOf(c3de_str text) { return {text.ptr, static_cast<std::size_t>(text.len)}; }

  c3de_log_v1 log{sizeof(c3de_log_v1), 1, this,
                  [](void *ctx, std::uint32_t, c3de_str text) { of(ctx).lines.push_back(textOf(text)); }};
  c3de_registry_v1 registry{
      sizeof(c3de_registry_v1),
      1,
      this,
      [](void *ctx, const c3de_class *cls) -> c3de_status {
        of(ctx).classes.push_back(textOf(cls->id));
        return C3DE_OK;
      },
      [](void *, c3de_str) -> c3de_status { return C3DE_OK; },
      [](void *, c3de_str, void *, c3de_status(C3DE_CALL *)(void *, const c3de_class_info *)) -> c3de_status {
        return C3DE_OK;
      },
      [](void *, c3de_str, c3de_object **) -> c3de_status { return C3DE_E_NOT_FOUND; }};
  c3de_host host{offsetof(c3de_host, set_error_at),
                 1,
                 this,
                 [](void *ctx, c3de_str id, std::uint32_t minRev, const void **table) -> c3de_status {
                   FirstHost &self = of(ctx);
                   self.asked.push_back(textOf(id));
                   *table = nullptr;
                   if (minRev > 1) return C3DE_E_VERSION;
                   if (self.asked.back() == C3DE_LOG_ID) *table = &self.log;
                   if (self.asked.back() == C3DE_REGISTRY_ID) *table = &self.registry;
                   return *table ? C3DE_OK : C3DE_E_UNSUPPORTED;
                 },
                 [](void *, c3de_status, c3de_str) {},
                 [](void *, c3de_sink) -> c3de_status { return C3DE_OK; },
                 nullptr,
                 nullptr};
};

}  // namespace

TEST_CASE("today's hello loads in a host that has what was frozen first and nothing more") {
  const auto file = std::filesystem::path(testPluginFolder()).parent_path() / "examples/hello.so";
  void *library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  REQUIRE(library != nullptr);
  c3de_plugin_query_fn query = nullptr;
  void *symbol = dlsym(library, C3DE_PLUGIN_QUERY_SYMBOL);
  REQUIRE(symbol != nullptr);
  std::memcpy(&query, &symbol, sizeof query);
  c3de_offer offer{};
  offer.size = sizeof offer;
  offer.abi_min = offer.abi_max = 1;
  c3de_answer answer{};
  answer.size = sizeof answer;
  REQUIRE(query(&offer, &answer) == C3DE_OK);
  REQUIRE(answer.plugin != nullptr);
  CHECK(answer.abi_major == 1);
  FirstHost first;
  void *self = nullptr;
  REQUIRE(answer.plugin->create(&first.host, &self) == C3DE_OK);
  CHECK(first.classes.size() == 1);
  CHECK(answer.plugin->start(self) == C3DE_OK);
  CHECK(answer.plugin->stop(self) == C3DE_OK);
  answer.plugin->destroy(self);
  CHECK_FALSE(first.lines.empty());
  dlclose(library);
}

#else

TEST_CASE("plugins that were built of earlier headers load and act in this host") {
  WARN("skipped: the kept plugins are of Linux on x86-64");
}

#endif
