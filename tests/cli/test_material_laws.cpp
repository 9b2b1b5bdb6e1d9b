// SPDX-License-Identifier: Apache-2.0
// Material laws of another plugin (plugins/material_law), chosen by a scene and run by the program.
#include <cmath>
#include <sstream>

#include "c3de/core/platform.h"
#include "program.h"
#include "support/folders.h"

namespace {

using Json = nlohmann::json;

constexpr const char *kExponential = R"(law = "org.c3de.exponential/0", density = 1000.0)";

/// A bar of 0.2 x 0.04 x 0.04 m along x, clamped at its left end and pulled at its right one.
std::filesystem::path writeBar(const std::filesystem::path &folder, const std::string &solver,
                               const std::string &material, double pull_Pa) {
  std::ostringstream mesh;
  for (int i = 0; i < 8; ++i)
    mesh << "v " << (i % 4 == 1 || i % 4 == 2 ? 0.2 : 0.0) << ' ' << (i % 4 >= 2 ? 0.02 : -0.02) << ' '
         << (i >= 4 ? 0.02 : -0.02) << '\n';
  mesh << "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  writeFile(folder / "bar.obj", mesh.str());
  std::ostringstream scene;
  scene << "format = 1\n[solver]\n" << solver << "\n";
  for (const double x : {0.08, 0.12})
    scene << "[[probe]]\nname = \"at " << x << "\"\nbody = \"bar\"\nat = [" << x << ", 0, 0]\n";
  scene << "[[body]]\nname = \"bar\"\nmesh = \"bar.obj\"\nmesh_unit = \"m\"\nmaterial = { " << material
        << " }\nsampling = { spacing = 0.008 }\n"
        << "[[fix]]\nregion = { box = { min = [-0.001, -1, -1], max = [0.0, 1, 1] } }\n"
        << "[[load]]\npressure = " << -pull_Pa
        << "\nfollower = false\nregion = { box = { min = [0.2, -1, -1], max = [0.201, 1, 1] } }\n";
  return writeFile(folder / "bar.toml", scene.str());
}

std::string plugin() {
  return (std::filesystem::path(testExampleFolder()) / ("material_law" + std::string(c3de::pluginExtension())))
      .string();
}

Json run(const std::filesystem::path &scene) {
  const auto report = scene.parent_path() / "report.json";
  const auto result = runC3de({"run", scene.string(), "--report", report.string(), "-q", "--plugin", plugin()});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  return readJson(report);
}

double placeOf(const Json &report, std::size_t probe) {
  return report.at("probes").at(probe).at("position_m").at(0).get<double>();
}

// Nominal stress of the exponential law, with its default parameters, in a bar with free lateral contraction.
double uniaxialStress(double stretch) {
  constexpr double mu = 2000.0, b = 2.0, K = 20000.0;
  const auto slopes = [&](double across) {
    const double J = stretch * across * across, scale = std::pow(J, -2.0 / 3.0);
    const double I = scale * (stretch * stretch + 2.0 * across * across);
    const double w = 0.5 * mu * std::exp(b * (I - 3.0)), p = 0.5 * K * (J - 1.0 / J);
    return std::pair(w * (2.0 * scale * stretch - 2.0 / 3.0 * I / stretch) + p * across * across,
                     w * (4.0 * scale * across - 4.0 / 3.0 * I / across) + 2.0 * p * stretch * across);
  };
  double low = 0.5, high = 1.2;  // the lateral stress grows with the width
  for (int i = 0; i < 100; ++i) (slopes(0.5 * (low + high)).second < 0.0 ? low : high) = 0.5 * (low + high);
  return slopes(low).first;
}

}  // namespace

TEST_CASE("A bar of another plugin's law is stretched as its formula says") {
  for (const double pull_Pa : {300.0, 3000.0, 8000.0}) {
    const auto folder = freshFolder("exponential_bar");
    const Json report = run(writeBar(folder, "integrator = \"quasistatic\"", kExponential, pull_Pa));
    const double stretch = (placeOf(report, 1) - placeOf(report, 0)) / 0.04;
    double low = 1.0, high = 3.0;
    for (int i = 0; i < 100; ++i) (uniaxialStress(0.5 * (low + high)) < pull_Pa ? low : high) = 0.5 * (low + high);
    INFO("stretch " << stretch << ", by the formula " << low << " at " << pull_Pa << " Pa");
    CHECK(std::abs(stretch - low) < 0.01 * (low - 1.0));
  }
}

TEST_CASE("The neo-Hookean law of another plugin bends a bar as the built-in one does") {
  for (const std::string solver : {"integrator = \"quasistatic\"", "integrator = \"explicit\"\ndt = 1e-4",
                                   "integrator = \"implicit\"\ndt = 0.01"}) {
    const auto folder = freshFolder("neo_hookean_bar");
    std::vector<double> places;
    for (const std::string law : {"neo_hookean", "org.c3de.neo_hookean/0"}) {
      const auto scene =
          writeBar(folder, solver, "law = \"" + law + "\", youngs_modulus = 1e4, poisson_ratio = 0.3", 2000.0);
      const auto report = folder / "report.json";
      std::vector<std::string> arguments{"run", scene.string(), "--report", report.string(),
                                         "-q",  "--plugin",     plugin()};
      if (solver.find("quasi") == std::string::npos) arguments.insert(arguments.end(), {"--until", "0.1"});
      const auto result = runC3de(arguments);
      INFO(result.errorOutput);
      REQUIRE(result.exitCode == 0);
      places.push_back(placeOf(readJson(report), 1));
    }
    INFO(solver);
    CHECK(places[0] > 0.12 + 1e-3);
    // One formula written twice: round-off of 1e-16 in 1000 steps. Implicit and quasi-static solutions stop at their
    // tolerance, which for a body with self-contact is a tenth of a micrometre.
    CHECK(std::abs(places[1] - places[0]) < (solver.find("implicit") != std::string::npos ? 1e-7 : 1e-9));
  }
}

TEST_CASE("What a scene says wrongly about a law of another plugin is said back") {
  const struct {
    std::string material, said;
  } mistakes[] = {
      {R"(law = "org.c3de.missing/0")",
       "accepted: neo_hookean | stvk | corotated | linear | org.c3de.exponential/0 | org.c3de.neo_hookean/0"},
      {std::string(kExponential) + ", youngs_modulus = 3e3",
       "material.youngs_modulus is not a parameter of material.law"},
      {"exponential.stiffening = 3.0", "material.exponential.stiffening is not a parameter of material.law"},
      {std::string(kExponential) + ", exponential.stiffening = 30.0", "exponential.stiffening = 30"},
      {std::string(kExponential) + ", exponential.stifening = 3.0", "exponential.stifening"},
      {std::string(kExponential) + ", plastic = { yield = 0.1, creep = 1.0 }",
       "law 'org.c3de.exponential/0' of plugin 'org.c3de.material_law' does not combine with Prony terms or "
       "plasticity"}};
  for (const auto &mistake : mistakes) {
    const auto folder = freshFolder("law_mistakes");
    const auto scene = writeBar(folder, "integrator = \"quasistatic\"", mistake.material, 100.0);
    const auto result = runC3de({"run", scene.string(), "-q", "--plugin", plugin()});
    INFO(mistake.material);
    INFO(result.errorOutput);
    CHECK(result.exitCode != 0);
    CHECK(result.errorOutput.find(mistake.said) != std::string::npos);
  }
}
