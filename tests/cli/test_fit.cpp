// SPDX-License-Identifier: Apache-2.0
// `c3de fit`: the stiffness of a body from a measured curve, and what is refused.
#include <cmath>
#include <random>
#include <sstream>

#include "json_schema.h"
#include "program.h"

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr double kModulus = 2e4;

/// A beam of 100 x 20 x 20 mm that is held at one end.
fs::path writeBeam(const fs::path &folder, const std::string &more) {
  writeFile(folder / "box.obj", boxObj());
  return writeFile(folder / "beam.toml",
                   "format = 1\ntitle = \"Beam\"\n[solver]\nintegrator = \"quasistatic\"\n"
                   "[[body]]\nname = \"beam\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\nscale = 0.1\n"
                   "material = { law = \"neo_hookean\", youngs_modulus = 20000, poisson_ratio = 0.4, density = 1000 }\n"
                   "sampling = { spacing = 0.01 }\n"
                   "[[fix]]\nbody = \"beam\"\nregion = { box = { min = [-1, -1, -1], max = [0.001, 1, 1] } }\n" +
                       more);
}

std::string movedEnd(double displacement_m) {
  std::ostringstream out;
  out << "[[fix]]\nbody = \"beam\"\nregion = { box = { min = [0.099, -1, -1], max = [1, 1, 1] } }\ndisplacement = [0, "
      << -displacement_m << ", 0]\n";
  return out.str();
}

std::string loadedEnd(double force_N) {
  std::ostringstream out;
  out << "[[load]]\nbody = \"beam\"\nregion = { box = { min = [0.099, -1, -1], max = [1, 1, 1] } }\nforce = [0, "
      << -force_N << ", 0]\n[[probe]]\nname = \"tip\"\nbody = \"beam\"\nat = [0.1, 0.01, 0.01]\n";
  return out.str();
}

/// Values of `c3de run`, each a simulation of its own.
struct Curve {
  std::vector<double> displacement_mm, force_N;
  [[nodiscard]] std::string csv(double scale = 1.0, const std::string &header = "displacement_mm,force_N") const {
    std::ostringstream out;
    out.precision(9);
    out << header << "\n";
    for (std::size_t i = 0; i < force_N.size(); ++i) out << scale * displacement_mm[i] << "," << force_N[i] << "\n";
    return out.str();
  }
};

Curve movedCurve(const fs::path &folder) {
  Curve out;
  for (const double mm : {2.0, 4.0, 6.0, 8.0, 10.0, 12.0}) {
    const json report = runToReport(writeBeam(folder, movedEnd(1e-3 * mm)));
    out.displacement_mm.push_back(mm);
    out.force_N.push_back(-report["reactions"][1]["force_N"][1].get<double>());
  }
  return out;
}

struct Answer {
  c3de::ProcessResult result;
  json report;
};

Answer fitted(const fs::path &folder, const fs::path &scene, const std::string &csv,
              std::vector<std::string> more = {}) {
  const fs::path curve = writeFile(folder / "curve.csv", csv), report = folder / "fit.json";
  fs::remove(report);
  std::vector<std::string> arguments{"fit", scene.string(), "--curve", curve.string(), "--report", report.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  Answer out{runC3de(arguments), {}};
  if (fs::exists(report)) out.report = readJson(report);
  return out;
}

}  // namespace

TEST_CASE("A modulus is fitted to reactions of runs, and the report fits the schema") {
  const fs::path folder = freshFolder("fit_moved");
  const Curve curve = movedCurve(folder);
  const fs::path scene = writeBeam(folder, movedEnd(0.001));
  const Answer out =
      fitted(folder, scene, curve.csv(),
             {"--set", "body.beam.material.youngs_modulus=3e3", "--residuals", (folder / "r.csv").string()});
  INFO(out.result.errorOutput << out.result.output);
  REQUIRE(out.result.exitCode == 0);
  CHECK_THAT(out.result.output, Contains("Young's modulus") && Contains("not for clinical use"));
  const json schema = readJson(fs::path(testResourcesFolder()) / "schemas/report.schema.json");
  for (const std::string &departure : departuresFrom(schema, out.report)) FAIL_CHECK(departure);
  const json &fit = out.report["fit"];
  CHECK(fit["verdict"] == "found");
  CHECK(fit["prescribed"] == "displacement");
  CHECK(fit["unit"] == "N");
  REQUIRE(fit["moduli"].size() == 1);
  CHECK(fit["moduli"][0]["material"] == "beam");
  CHECK_THAT(fit["moduli"][0]["youngs_modulus_Pa"].get<double>(), WithinAbs(kModulus, 1e-3 * kModulus));
  CHECK(fit["curve_points"].size() == 6);
  CHECK_THAT(fit["curve_points"][5]["predicted"].get<double>(), WithinAbs(curve.force_N[5], 1e-3 * curve.force_N[5]));
  CHECK_THAT(readFile(folder / "r.csv"), Contains("displacement_mm,force_N,predicted_N"));
  CHECK(out.report["steps"] == 0);
  // The column names the unit.
  const Answer metres = fitted(folder, scene, curve.csv(1e-3, "displacement_m,force_N"));
  CHECK(metres.report["fit"]["moduli"] == fitted(folder, scene, curve.csv()).report["fit"]["moduli"]);
}

TEST_CASE("A modulus is fitted to displacements of a probe under a force, with noise") {
  const fs::path folder = freshFolder("fit_loaded");
  Curve curve;
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0.0, 0.05);
  for (int i = 1; i <= 8; ++i) {
    const double force = 0.002 * i;
    const json report = runToReport(writeBeam(folder, loadedEnd(force)));
    curve.force_N.push_back(force);
    curve.displacement_mm.push_back(-1e3 * (report["probes"][0]["position_m"][1].get<double>() - 0.01) + noise(random));
  }
  const fs::path scene = writeBeam(folder, loadedEnd(1.0));
  const Answer out =
      fitted(folder, scene, curve.csv(), {"--set", "body.beam.material.youngs_modulus=5e4", "--noise", "0.05"});
  INFO(out.result.errorOutput << out.result.output);
  REQUIRE(out.result.exitCode == 0);
  const json &fit = out.report["fit"];
  CHECK(fit["prescribed"] == "force");
  CHECK(fit["unit"] == "mm");
  CHECK(fit["noise"] == 0.05);
  CHECK(fit["verdict"] == "found");
  const json &modulus = fit["moduli"][0];
  CHECK(modulus["low_Pa"].get<double>() < kModulus);
  CHECK(modulus["high_Pa"].get<double>() > kModulus);
  CHECK_THAT(modulus["youngs_modulus_Pa"].get<double>(), WithinAbs(kModulus, 0.02 * kModulus));
  // The same with a noise that is much smaller than the residual.
  const Answer strict = fitted(folder, scene, curve.csv(), {"--noise", "1e-4"});
  CHECK(strict.report["fit"]["verdict"] == "unexplained");
  CHECK_THAT(strict.result.output, Contains("times the noise"));
}

TEST_CASE("Curves and scenes that cannot be fitted are refused with the reason") {
  const fs::path folder = freshFolder("fit_refused");
  const fs::path scene = writeBeam(folder, movedEnd(0.001));
  const auto refusal = [&](const std::string &csv, int exitCode, std::vector<std::string> more = {}) {
    const Answer out = fitted(folder, scene, csv, std::move(more));
    INFO(out.result.errorOutput);
    CHECK(out.result.exitCode == exitCode);
    return out.result.errorOutput;
  };
  const std::string head = "displacement_mm,force_N\n";
  CHECK_THAT(refusal(head + "1,0.1\n2,0.2\n3,0.3\n", 3), Contains("3 different displacements above 0; accepted: 4"));
  CHECK_THAT(refusal(head + "1,0.1\nnan,0.2\n", 3), Contains("curve.csv:3: displacement_mm is 'nan'"));
  CHECK_THAT(refusal(head + "1,0.1\n2,0.2\n1.5,0.3\n4,0.4\n", 3),
             Contains("curve.csv:4: the displacement decreases from 2 to 1.5 mm"));
  CHECK_THAT(refusal(head + "0,0\n0,0.2\n0,0.3\n0,0.4\n", 3), Contains("every displacement is 0"));
  CHECK_THAT(refusal(head + "0.001,0.1\n0.002,0.2\n0.003,0.3\n0.004,0.4\n", 3), Contains("displacement_m"));
  CHECK_THAT(refusal(head + "1000,1\n2000,2\n3000,3\n4000,4\n", 3), Contains("times the extent of the body"));
  CHECK_THAT(refusal(head + "1,-0.1\n2,-0.2\n3,-0.3\n4,-0.4\n", 3), Contains("against the displacement"));
  CHECK_THAT(refusal("mm,force_N\n1,2\n", 3), Contains("the column 'displacement_mm' is missing"));
  CHECK_THAT(refusal(head, 3), Contains("contains no points"));
  CHECK_THAT(refusal(head + "1,0.1\n", 2, {"--probe", "tip"}), Contains("--probe is for a force"));
  CHECK_THAT(refusal(head + "1,0.1\n", 2, {"--body", "bean"}), Contains("accepted: beam"));
  const auto still = runC3de({"fit", writeBeam(folder, "").string(), "--curve", (folder / "curve.csv").string()});
  CHECK(still.exitCode == 3);
  const Answer none = fitted(folder, writeBeam(folder, ""), head + "1,0.1\n2,0.2\n3,0.3\n4,0.4\n");
  CHECK(none.result.exitCode == 3);
  CHECK_THAT(none.result.errorOutput, Contains("0 supports move and 0 forces act"));
}

TEST_CASE("A curve of another shape is unexplained, and one of much noise undetermined") {
  const fs::path folder = freshFolder("fit_shape");
  const fs::path scene = writeBeam(folder, movedEnd(0.001));
  const std::string head = "displacement_mm,force_N\n";
  const Answer stiffening =
      fitted(folder, scene, head + "2,0.01\n4,0.04\n6,0.09\n8,0.16\n10,0.25\n12,0.36\n14,0.49\n16,0.64\n");
  CHECK(stiffening.result.exitCode == 0);
  CHECK(stiffening.report["fit"]["verdict"] == "unexplained");
  CHECK(stiffening.report["fit"]["warnings"].size() == 1);
}
