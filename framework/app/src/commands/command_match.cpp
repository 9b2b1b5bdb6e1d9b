// SPDX-License-Identifier: Apache-2.0
// `c3de match`: its options.
#include <memory>
#include <utility>

#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/match_frames.h"
#include "commands/match_scene.h"
#include "commands/standard_streams.h"

namespace c3de::app {
namespace {

int run(const MatchOptions &arguments, const CommandLine &line) {
  MatchOptions options = arguments;
  options.run.quiet = line.quiet;
  options.run.session = line.sessionOptions();
  options.run.meshUnit = line.unit;
  StandardOutputFile output;
  if (const auto taken = output.take({{"--report", &options.run.report},
                                      {"--residuals", &options.residuals},
                                      {"--frame-table", &options.frameTable}});
      !taken)
    return reportError(taken.error());
  const bool isSequence = !options.frames.empty() || !options.stream.empty();
  if (!isSequence && !(options.frameTable.empty() && options.run.exportList.empty()))
    return reportError({ErrorCode::usage, std::string(options.frameTable.empty() ? "--timeline" : "--frame-table") +
                                              " is for sequences; accepted: with --frames or --stream"});
  const int exitCode = isSequence ? matchFrames(options) : matchScene(options);
  if (const auto printed = output.print(); !printed) return reportError(printed.error());
  return exitCode;
}

CLI::Option *addPositive(CLI::App &app, const std::string &name, std::optional<double> &value, const std::string &unit,
                         const std::string &help) {
  return addParsed(app, name, value, help,
                   [unit](const std::string &text) { return parseDecimal(text, 1e-6, 1e6, unit.c_str()); });
}

void declareMeasured(CLI::App &app, MatchOptions &options) {
  app.add_option("--body", options.body, "The body that was measured; default: that of [match], or the only one")
      ->type_name("NAME");
  CLI::Option *surface = addFile(app, "--surface", options.surface, "FILE",
                                 "What was measured: a surface or a part of it (stl, obj, ply, vtk, vtp, off, glTF)");
  CLI::Option *points =
      addFile(app, "--points", options.points, "FILE",
              "What was measured: points on the surface, LPS mm: a table x,y,z, or fiducials of 3D Slicer");
  CLI::Option *labels =
      addFile(app, "--labels", options.labels, "FILE",
              "What was measured: a label map of the body in the other position (nii, nrrd, mha, DICOM)");
  surface->excludes(points)->excludes(labels);
  points->excludes(labels);
  app.add_option("--label", options.label, "Number or name of the label of --labels")->type_name("LABEL");
  app.add_option("--measured-unit", options.unit,
                 "Unit of --surface, --points or --frames; default: that in the file, or mm")
      ->type_name("UNIT");
  app.add_flag("--rigid", options.isRigid, "Find the rigid motion only; default: the body deforms as well");
  addPositive(app, "--noise", options.noise_mm, "mm", "Standard deviation of the measurement noise, mm; default: 1")
      ->type_name("MM");
  addFiles(app, "--landmarks", options.run.landmarks, "FILE",
           "Landmarks of the body at rest in addition to those of the scene: name,x_mm,y_mm,z_mm (LPS), .fcsv or "
           ".mrk.json (repeatable)");
  addFile(app, "--target-landmarks", options.landmarks, "FILE", "Where landmarks of the same names were measured");
  app.add_option("--use", options.use, "Whether landmarks are fitted or only evaluate the result; default: judge")
      ->check(CLI::IsMember({"fit", "judge"}))
      ->type_name("USE");
  addPositive(app, "--weight", options.weight, "points",
              "Measured points that one fitted landmark counts as; default: 10")
      ->type_name("N");
}

void declareMatchedState(CLI::App &app, MatchOptions &options) {
  RunOptions &run = options.run;
  addFile(app, "--export-image", run.exportImage.image, "FILE",
          "Write the scene's image as the tissue is deformed, without the rigid motion (nrrd, nii, nii.gz, mha)");
  addFile(app, "--export-labels", run.exportImage.labels, "FILE", "Write the deformed label map");
  addFile(app, "--export-displacement", run.exportImage.displacement, "FILE",
          "Write the displacement of the tissue at the voxels of the image, mm");
  addFile(app, "--save-state", run.saveState, "FILE", "Write the matched state, for `c3de run --from-state`");
  addFile(app, "--save-session", run.saveSession, "FILE.c3de",
          "Write scene and matched state; the window and `c3de run FILE.c3de` continue from it");
}

/// A sequence of frames, after everything else has been declared.
void declareFrames(CLI::App &app, MatchOptions &options) {
  CLI::Option *frames = addFile(
      app, "--frames", options.frames, "PATH",
      "A sequence of points: a folder of tables in the order of their names, or a CSV with the columns frame or "
      "time_s, and x, y, z. A row with a name in the column landmark states the measured position of that landmark. "
      "Each frame starts from the one before");
  CLI::Option *stream =
      app.add_option("--stream", options.stream,
                     "Points that a tracking system sends: the address of an OpenIGTLink server. Each POINT message is "
                     "a frame; points with the name of a landmark are that landmark. Sends C3DE_Motion and "
                     "C3DE_Landmarks after each frame. Ctrl+C ends it");
  stream->type_name("HOST[:PORT]");
  addParsed(app, "--stream-frames", options.streamFrames, "With --stream: end after N frames; default: Ctrl+C",
            [](const std::string &text) { return parseWhole(text, 1, 100000); })
      ->type_name("N")
      ->needs(stream);
  addPositive(app, "--stream-timeout", options.streamTimeout_s, "s",
              "With --stream: end after S seconds without points; default: 10")
      ->type_name("S")
      ->needs(stream);
  CLI::Option *tool = app.add_option("--stream-tool", options.streamTool,
                                     "With --stream: collect positions of the tip of this tool, from its TRANSFORM or "
                                     "POSITION messages, instead of POINT messages")
                          ->check([](const std::string &name) {
                            return name.empty() ? std::string("the name is empty; accepted: the name of a tool") : "";
                          })
                          ->type_name("NAME")
                          ->needs(stream);
  addParsed(app, "--stream-tool-points", options.streamToolPoints,
            "With --stream-tool: points of a frame, 2 mm apart or more; default: 200",
            [](const std::string &text) { return parseWhole(text, 12, 2000); })
      ->type_name("N")
      ->needs(tool);
  app.add_flag("--stream-slice", options.sendsSlice,
               "With --stream: send C3DE_Slice, the slice of the deformed image through the middle of the body")
      ->needs(stream);
  addFile(app, "--frame-table", options.frameTable, "FILE.csv",
          "With --frames or --stream: write residual, motion and time of each frame; - prints them");
  addFile(app, "--timeline", options.run.exportList, "FILE.pvd",
          "With --frames or --stream: write the body at each frame for ParaView, without the rigid motion");
  frames->excludes(stream);
  for (const char *other : {"--surface", "--points", "--labels", "--label", "--target-landmarks", "--residuals",
                            "--export-surface", "--export-image", "--export-labels", "--export-displacement"})
    for (CLI::Option *sequence : {frames, stream}) sequence->excludes(app.get_option(other));
}

Handler declareMatch(CLI::App &app, CommandLine &line) {
  const auto options = std::make_shared<MatchOptions>();
  app.add_option_function<std::string>(
         "SCENE", [options](const std::string &text) { options->run.scene = text; },
         "A scene (.toml) or a mesh as one body; options replace keys of its [match]")
      ->required();
  declareMeasured(app, *options);
  app.add_option("--set", options->run.overrides,
                 "Replace a value of the scene, for example body.liver.sampling.spacing=0.01 (repeatable)")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  addFile(app, "--report", options->run.report, "FILE.json",
          "Write the report as JSON, with `match`; - prints to standard output");
  addFile(app, "--residuals", options->residuals, "FILE.csv",
          "Write the distance of each measured point to the surface: before, after the rigid motion and after the "
          "deformation; - prints them");
  addFile(app, "--export-surface", options->run.exportSurface, "FILE",
          "Write the skin of the matched body where it was measured (obj, stl, ply, vtp)");
  declareMatchedState(app, *options);
  declareFrames(app, *options);
  addUnit(app, line);
  addSessionOptions(app, line);
  app.footer(
      "Examples:\n"
      "    c3de match SCENE.toml --report r.json                  # a scene with [match]\n"
      "    c3de match SCENE.toml --points points.csv --noise 2\n"
      "    c3de match SCENE.toml --frames points --frame-table -  # a folder of frames, one table each\n"
      "    c3de match SCENE.toml --stream localhost:18944         # frames of a tracking system\n"
      "    c3de match SCENE.toml --labels followup.nii.gz --label 1 --target-landmarks targets.csv\n"
      "Not for clinical use.");
  return [options, &line] { return run(*options, line); };
}

}  // namespace

const Command kMatchCommand{"match", "Register a body to measured points, a surface or a label", declareMatch};

}  // namespace c3de::app
