// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "c3de/core/text.h"
#include "c3de/session/live_parameters.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using c3de::test::cubeBody;
using c3de::test::RecordingSimulator;

namespace {

/// A simulator whose body keeps values, and refuses one of them.
struct Keeping {
  RecordingSimulator simulator;
  std::unique_ptr<Session> session;
  static inline std::map<std::string, double> values;
  static inline std::string refused;
  static inline std::vector<std::string> calls;
  static inline c3de_simulator_v1 table;
  static inline c3de_object_vt vt;

  Keeping() {
    SessionOptions without;
    without.searchPlugins = false;
    without.threads = 1;
    session = std::move(*Session::create(without));
    simulator.bodies = {cubeBody(0.1, {0, 0, 0}, {0, 0, 0})};
    simulator.bodyIds = {"material.preset", "material.density", "material.youngs_modulus", "material.poisson_ratio"};
    values = {{"material.density", 1000.0}, {"material.youngs_modulus", 1e4}, {"material.poisson_ratio", 0.3}};
    refused.clear();
    calls.clear();
    table = *simulator.table();
    table.get_body_param = [](c3de_object *, c3de_handle, c3de_str id, c3de_param_value *out) -> c3de_status {
      const auto found = values.find(std::string(fromAbi(id)));
      if (found == values.end()) return C3DE_E_NOT_FOUND;
      *out = {sizeof *out, C3DE_PARAM_F64, id, found->second, {}, {}};
      return C3DE_OK;
    };
    table.set_body_param = [](c3de_object *, c3de_handle, const c3de_param_value *value) -> c3de_status {
      const std::string id(fromAbi(value->id));
      calls.push_back(id);
      if (id == refused) return C3DE_E_ARG;
      values[id] = value->num;
      return C3DE_OK;
    };
    vt = *simulator.object()->vt;
    vt.query = [](c3de_object *, c3de_str, std::uint32_t, const void **out) -> c3de_status {
      *out = &table;
      return C3DE_OK;
    };
    simulator.object()->vt = &vt;
  }
  Expected<LiveParameters> parameters() { return LiveParameters::create(*session, simulator.object(), {}); }
};

}  // namespace

TEST_CASE("A preset sets several values of a body, or none where one of them is refused") {
  Keeping of;
  auto live = of.parameters();
  REQUIRE(live);
  const auto before = Keeping::values;
  Keeping::refused = "material.poisson_ratio";
  const auto refused = live->set("body.body.material.preset", "liver");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::usage);
  CHECK_THAT(refused.error().message, Contains("body.body.material.preset"));
  // Others were set before it, and set back in the reverse order.
  REQUIRE(Keeping::calls.size() >= 3);
  CHECK(Keeping::calls.front() == Keeping::calls.back());
  CHECK(Keeping::values == before);
  Keeping::refused.clear();
  REQUIRE(live->set("body.body.material.preset", "liver"));
  CHECK(Keeping::values != before);
  const auto modulus = live->get("body.body.youngs_modulus");
  REQUIRE(modulus);
  CHECK(modulus->num == Keeping::values.at("material.youngs_modulus"));
}

TEST_CASE("An unknown path of a running simulation names the nearest and the bodies") {
  Keeping of;
  auto live = of.parameters();
  REQUIRE(live);
  for (const char *path : {"body.body.youngs_modulos", "body.other.youngs_modulus", "body.body", "body.bodyyoungs"}) {
    const auto found = live->get(path);
    REQUIRE_FALSE(found);
    CHECK_THAT(found.error().message, Contains(path) && Contains("bodies: body"));
  }
  CHECK_THAT(live->get("body.body.youngs_modulos").error().message, Contains("youngs_modulus"));
}
