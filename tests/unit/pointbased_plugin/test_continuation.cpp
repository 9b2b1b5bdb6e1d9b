// SPDX-License-Identifier: Apache-2.0
// The loaded plugin continues from the state of another simulation.
#include <nlohmann/json.hpp>

#include "c3de/abi/iface/continuation.h"
#include "changed_simulation.h"

using namespace change_tests;

namespace {

c3de_status C3DE_CALL appendTo(void *text, const void *bytes, std::uint64_t n) {
  static_cast<std::string *>(text)->append(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
  return C3DE_OK;
}

}  // namespace

TEST_CASE("a simulator continues from another one with equal bodies with the same bits", "[continuation]") {
  Host host;
  Simulation before(host), now(host);
  before.step(60);
  REQUIRE(before.hash() != now.hash());
  const auto *table = now.table<c3de_continuation_v0>(C3DE_IFACE_CONTINUATION_ID);
  std::string text;
  now.check(table->continue_from(now.self, before.self, {&text, appendTo}));
  CHECK(now.hash() == before.hash());
  CHECK(now.steps() == 60);
  const auto json = nlohmann::json::parse(text);
  REQUIRE(json["bodies"].size() == 2);
  for (const auto &body : json["bodies"]) {
    CHECK(body["name"] == "cube");
    CHECK(body["same"] == true);
    CHECK(body["energy_after_J"] == body["energy_before_J"]);
    CHECK(body["energy_after_J"] > 0.0);
  }
  now.step(20);
  now.reset();
  CHECK(now.steps() == 0);
}

TEST_CASE("a simulator does not continue from itself, from nothing or from another class", "[continuation]") {
  Host host;
  Simulation now(host);
  now.step(10);
  const std::uint64_t hash = now.hash();
  const auto *table = now.table<c3de_continuation_v0>(C3DE_IFACE_CONTINUATION_ID);
  std::string text;
  for (c3de_object *other : {static_cast<c3de_object *>(nullptr), now.self}) {
    CHECK(table->continue_from(now.self, other, {&text, appendTo}) == C3DE_E_ARG);
    CHECK_THAT(host.host->takeError(), Contains("is not another simulator of this class"));
  }
  CHECK(now.hash() == hash);
}
