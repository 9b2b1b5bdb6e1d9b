// SPDX-License-Identifier: Apache-2.0
// `c3de fit`: its options.
#include <memory>

#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/fit_scene.h"
#include "commands/standard_streams.h"

namespace c3de::app {
namespace {

int run(const FitOptions &arguments, const CommandLine &line) {
  FitOptions options = arguments;
  options.run.quiet = line.quiet;
  options.run.session = line.sessionOptions();
  options.run.meshUnit = line.unit;
  StandardOutputFile output;
  if (const auto taken = output.take({{"--report", &options.run.report}, {"--residuals", &options.residuals}}); !taken)
    return reportError(taken.error());
  const int exitCode = fitScene(options);
  if (const auto printed = output.print(); !printed) return reportError(printed.error());
  return exitCode;
}

Handler declareFit(CLI::App &app, CommandLine &line) {
  const auto options = std::make_shared<FitOptions>();
  app.add_option_function<std::string>(
         "SCENE", [options](const std::string &text) { options->run.scene = text; },
         "A scene (.toml) of the experiment: one [[fix]] that moves, or one [[load]] with a force")
      ->required();
  addFile(app, "--curve", options->curve, "FILE.csv",
          "The measured curve: columns displacement_mm (or displacement_m) and force_N, of the loading only")
      ->required();
  app.add_option("--body", options->body, "The body that was measured; default: the only one")->type_name("NAME");
  app.add_option("--probe", options->probe,
                 "With a [[load]]: the probe whose displacement was measured; default: the only one of the body")
      ->type_name("NAME");
  addParsed(app, "--noise", options->noise,
            "Standard deviation of the measurement noise: N, or mm with a [[load]]; default: not known",
            [](const std::string &text) { return parseDecimal(text, 1e-12, 1e6, "N or mm"); })
      ->type_name("N");
  app.add_option("--set", options->run.overrides,
                 "Replace a value of the scene, for example body.liver.sampling.spacing=0.01 (repeatable)")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  addFile(app, "--report", options->run.report, "FILE.json",
          "Write the report as JSON, with `fit`; - prints to standard output");
  addFile(app, "--residuals", options->residuals, "FILE.csv",
          "Write the curve with the values of the fitted model; - prints them");
  addUnit(app, line);
  addSessionOptions(app, line);
  app.footer(
      "Examples:\n"
      "    c3de fit BEAM.toml --curve curve.csv                    # a [[fix]] moves: its reaction was measured\n"
      "    c3de fit BEAM.toml --curve curve.csv --probe tip        # a [[load]] acts: the displacement was measured\n"
      "Not for clinical use.");
  return [options, &line] { return run(*options, line); };
}

}  // namespace

const Command kFitCommand{"fit", "Fit the stiffness of a body to a measured force-displacement curve", declareFit};

}  // namespace c3de::app
