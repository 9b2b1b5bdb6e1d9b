// SPDX-License-Identifier: Apache-2.0
// The three lines that state the accuracy of a result, in summary and report.
#include <cmath>

#include "program.h"
#include "support/folders.h"

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

/// A bar of 1 x 0.2 x 0.2 m, held at x = 0 and bent by a force at its end.
std::string bentBar(const std::string &more = "") {
  return "format = 1\n[solver]\nintegrator = \"quasistatic\"\nload_steps = 1\n[[body]]\nname = \"bar\"\nmesh = "
         "\"box.obj\"\nmesh_unit = \"m\"\nmaterial = { youngs_modulus = 1e4, poisson_ratio = 0.3 }\nsampling = { "
         "spacing = 0.0667 }\n[[fix]]\nname = \"wall\"\nbody = \"bar\"\nregion = { box = { min = [-0.01, -1, -1], max "
         "= [0.0001, 1, 1] } }\n[[load]]\nbody = \"bar\"\nregion = { box = { min = [0.9999, -1, -1], max = [1.1, 1, 1] "
         "} }\nforce = [0, 0, -0.04]\n" +
         more;
}

struct Run {
  std::string output;
  Json body, report;
  [[nodiscard]] const Json &statement() const { return body["accuracy_statement"]; }
  [[nodiscard]] std::string line(std::size_t i) const { return statement()["lines"][i].get<std::string>(); }
};

Run run(const fs::path &folder, const std::string &scene, std::vector<std::string> more = {}) {
  writeFile(folder / "box.obj", boxObj());
  const fs::path file = writeFile(folder / "scene.toml", scene), report = folder / "report.json";
  std::vector<std::string> arguments{"run", file.string(), "--report", report.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const auto ran = runC3de(arguments);
  INFO(ran.output << ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  Run out{ran.output, {}, readJson(report)};
  out.body = out.report["bodies"][0];
  return out;
}

std::size_t count(const std::string &text, const std::string &what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

}  // namespace

TEST_CASE("The summary says in three lines how accurate a result is, and the report has the same", "[statement]") {
  const Run ran = run(freshFolder("statement"), bentBar());
  INFO(ran.output);
  for (std::size_t i = 0; i < 3; ++i) CHECK(count(ran.output, "bar: " + ran.line(i) + "\n") == 1);
  CHECK_THAT(ran.line(0), Contains("Displacement: ± ") && Contains("estimated by two coarser solutions") &&
                              Contains(", largest at x "));
  CHECK_THAT(ran.line(1), Contains("Stress and strain: ± ") && Contains("outside singular regions"));
  CHECK_THAT(ran.line(2), Contains("edge of support 'wall'") && Contains("of the volume"));
  const Json &statement = ran.statement();
  CHECK(statement["basis"] == "estimated");
  CHECK(statement["displacement_error_m"].get<double>() > 0.0);
  CHECK(statement["displacement_error_m"].get<double>() < 0.1 * statement["largest_displacement_m"].get<double>());
  // The figure excludes the estimate of the whole body at the clamp.
  CHECK(statement["stress_error"].get<double>() < ran.body["error_estimate"].get<double>());
  CHECK(ran.body.contains("stabilisation_share"));
  // One figure for each: nothing else in the summary is an error.
  CHECK(count(ran.output, "±") == 2);
  for (const char *old : {"error_estimate", "is expected", "off by", "no count up to"})
    CHECK(ran.output.find(old) == std::string::npos);
}

TEST_CASE("A verification takes the place of the estimate in the same line", "[statement]") {
  const Run plain = run(freshFolder("statement_plain"), bentBar());
  const Run ran = run(freshFolder("statement_verified"), bentBar(), {"--verify"});
  INFO(ran.output);
  CHECK_THAT(ran.line(0), Contains("(verified with ") && Contains("times the points)"));
  CHECK(count(ran.output, "±") == 2);
  CHECK(ran.statement()["basis"] == "verified");
  const double verified = ran.statement()["displacement_error_m"].get<double>();
  CHECK(verified == ran.body["verification"]["error_95_m"].get<double>());
  // The estimate bounds the error measured afterwards, by no more than a factor of ten.
  const double estimated = plain.statement()["displacement_error_m"].get<double>();
  CHECK(verified < estimated);
  CHECK(verified > 0.1 * estimated);
  CHECK(ran.line(1) == plain.line(1));
}

TEST_CASE("A figure that has no basis is none, with the reason", "[statement]") {
  const auto folder = freshFolder("statement_falls");
  const std::string falling =
      "format = 1\n[world]\ngravity = [0, 0, -9.81]\n[[body]]\nname = \"bar\"\nmesh = \"box.obj\"\nmesh_unit = "
      "\"m\"\nmaterial = { youngs_modulus = 1e4 }\nsampling = { count = 150 }\n";
  const Run ran = run(folder, falling, {"--until", "0.05", "--verify"});
  INFO(ran.output);
  // It has only moved: the displacement error found by a verification is rounding.
  CHECK(ran.body["verification"]["largest_displacement_m"] == 0.0);
  CHECK(ran.body["verification"]["error_95_percent"] == 0.0);
  CHECK_THAT(ran.line(0), Contains("no error beyond rounding"));
  CHECK_THAT(ran.line(2), Contains("none found"));
  CHECK(ran.output.find("e-1") == std::string::npos);

  const Run unverified = run(folder, falling, {"--until", "0.05"});
  CHECK_THAT(unverified.line(0),
             Contains("not estimated: ") && Contains("nothing holds it but contact, attachments or inertia"));
  CHECK(unverified.statement()["basis"] == "none");
  CHECK(unverified.statement()["displacement_error_m"].is_null());
}

TEST_CASE("The edge of contact is a singular place, with what it touches", "[statement]") {
  const auto folder = freshFolder("statement_contact");
  writeFile(folder / "box.obj", boxObj());
  const Run ran =
      run(folder,
          "format = 1\n[world]\ngravity = [0, 0, -9.81]\n[solver]\ndamping = 20\n[[body]]\nname = \"bar\"\n"
          "mesh = \"box.obj\"\nmesh_unit = \"m\"\nmaterial = { youngs_modulus = 1e5 }\nsampling = { spacing "
          "= 0.05 }\n[[obstacle]]\nname = \"plate\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\nposition = "
          "[0.4, 0, -0.2005]\n",
          {"--until", "0.3"});
  INFO(ran.output);
  CHECK_THAT(ran.line(2), Contains("edge of contact with 'plate'"));
  CHECK(ran.statement()["left_out_part"].get<double>() > 0.0);
}

TEST_CASE("A body that is attached to a rigid one is told one integrator, not two", "[statement]") {
  const auto folder = freshFolder("one_integrator");
  writeFile(folder / "box.obj", boxObj());
  // Alone, the stiff bar would use implicit steps; next to a free rigid body both use explicit ones.
  const Run ran =
      run(folder,
          "format = 1\n[world]\ngravity = [0, 0, -9.81]\n[[body]]\nname = \"bar\"\nmesh = \"box.obj\"\n"
          "mesh_unit = \"m\"\nmaterial = { youngs_modulus = 1e8, viscosity = 5e4 }\nsampling = { count = 150 "
          "}\n[[body]]\nname = \"weight\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\nposition = [1, 0, "
          "0]\nrigid = true\nfree = true\nmaterial = { density = 1000 }\nsampling = { count = 100 }\n[[fix]]\n"
          "body = \"bar\"\nregion = { box = { min = [-1, -1, -1], max = [0.0001, 1, 1] } }\n[[attachment]]\n"
          "bodies = [\"bar\", \"weight\"]\nwithin_mm = 1\nstiffness = 1e8\n",
          {"--steps", "2"});
  std::size_t told = 0;
  for (const Json &event : ran.report["events"]) {
    const std::string kind = event["kind"], text = event["text"];
    if (kind != "chosen" && kind != "switched") continue;
    INFO(text);
    CHECK(text.find("implicitly") == std::string::npos);
    ++told;
  }
  CHECK(told == 1);
}
