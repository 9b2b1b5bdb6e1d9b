// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/plot_quantities.h"

#include <algorithm>
#include <string>

#include "support/catch.h"

using namespace c3de::session;

namespace {

const PlotQuantity *find(const std::vector<PlotQuantity> &all, const std::string &id) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const PlotQuantity &q) { return q.id == id; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace

TEST_CASE("Quantities of a report have names, units and magnitudes") {
  const auto all = plotQuantities(R"({
    "bodies": [{"name": "organ", "energy_J": {"kinetic": 0.5, "gravity": -0.25}, "min_J": 0.9,
                "deepest_penetration_m": 0.002}],
    "probes": [{"name": "rim", "reference_m": [0, 0, 0], "position_m": [0.003, 0, 0.004], "velocity_m_s": [0, 1, 0]}],
    "reactions": [{"fix": 3, "body": "organ", "force_N": [3, 0, 4], "torque_Nm": [0, 0, 1]}],
    "grasps": [{"name": "jaws", "pull_N": [0, 2, 0], "squeeze_N": 1.5}],
    "load_factor": 0.25, "stages": {"contact": {"median_ms": 0.125, "calls": 3}}})");
  const auto check = [&](const std::string &id, double value, const std::string &unit) {
    INFO(id);
    const PlotQuantity *one = find(all, id);
    REQUIRE(one != nullptr);
    CHECK(one->value == Approx(value));
    CHECK(one->unit == unit);
  };
  check("body.organ.energy.kinetic", 0.5, "J");
  check("body.organ.energy.gravity", -0.25, "J");
  check("body.organ.min_J", 0.9, "");
  check("body.organ.penetration", 2.0, "mm");
  check("probe.rim.displacement", 5.0, "mm");
  check("probe.rim.speed", 1000.0, "mm/s");
  check("reactions.support 3.force", 5.0, "N");
  check("grasps.jaws.pull", 2.0, "N");
  check("grasps.jaws.squeeze", 1.5, "N");
  check("load_factor", 0.25, "");
  check("stage.contact", 0.125, "ms");
  CHECK(all.size() == 11);
  CHECK(find(all, "reactions.support 3.force")->label == "support 3 of organ: force");
}

TEST_CASE("Quantities of entries with one name have different ids and labels") {
  const auto all = plotQuantities(R"({
    "bodies": [{"name": "organ", "min_J": 0.9}, {"name": "organ", "min_J": 0.8}],
    "probe_tools": [{"name": "a", "force_N": 1}, {"name": "a 2", "force_N": 2}, {"name": "a", "force_N": 3}],
    "reactions": [{"fix": 0, "force_N": 4}, {"force_N": 5}]})");
  REQUIRE(all.size() == 7);
  CHECK(find(all, "body.organ.min_J")->value == 0.9);
  REQUIRE(find(all, "body.organ 2.min_J") != nullptr);
  CHECK(find(all, "body.organ 2.min_J")->value == 0.8);
  CHECK(find(all, "body.organ 2.min_J")->label == "organ 2: smallest det F");
  REQUIRE(find(all, "probe_tools.a 3.force") != nullptr);
  CHECK(find(all, "probe_tools.a 3.force")->value == 3.0);
  CHECK(find(all, "reactions.support 0.force") != nullptr);
  CHECK(find(all, "reactions.support 2.force") != nullptr);
}

TEST_CASE("What is absent or no number in a report is no quantity, and text that is no report has none") {
  CHECK(plotQuantities("").empty());
  CHECK(plotQuantities("[1, 2]").empty());
  CHECK(plotQuantities("{\"bodies\": 3, \"stages\": [], \"probes\": [7]}").empty());
  const auto all = plotQuantities(R"({"bodies": [{"min_J": "small", "energy_J": {"kinetic": null, "elastic": 1}}],
    "probe_tools": [{"name": "a", "force_N": [1, 2]}, "b"]})");
  REQUIRE(all.size() == 1);
  CHECK(all.front().label == "body 1: elastic energy");
}
