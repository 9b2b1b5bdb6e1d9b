// SPDX-License-Identifier: Apache-2.0
// `c3de run`: its options.
#include <memory>
#include <utility>
#include <vector>

#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/run_scene.h"
#include "commands/standard_streams.h"
#include "commands/window_program.h"

namespace c3de::app {
namespace {

struct RunArguments {
  RunOptions options;
  std::string view;
  std::string overlay;
  std::optional<CameraAngles> angles;
  std::string up;
};

Expected<void> readCamera(const RunArguments &arguments, RunOptions &options) {
  if (!arguments.angles && arguments.up.empty()) return {};
  const std::string name = arguments.angles ? "--camera" : "--up";
  if (options.screenshot.empty()) return fail(ErrorCode::usage, name + " is for --screenshot");
  if (options.view && *options.view != PictureView::space && *options.view != PictureView::four)
    return fail(ErrorCode::usage, name + " is for the 3D view, and --view " + nameOf(*options.view) +
                                      " is a slice; accepted: 3d, four-up");
  if (arguments.angles) {
    options.camera.azimuth_deg = arguments.angles->azimuth_deg;
    options.camera.elevation_deg = arguments.angles->elevation_deg;
  }
  if (!arguments.up.empty()) options.camera.isZUp = arguments.up == "z";
  return {};
}

int run(const RunArguments &arguments, const CommandLine &line) {
  RunOptions options = arguments.options;
  options.quiet = line.quiet;
  if (!options.screenshot.empty() && !line.openWindow && hasWindowProgram())
    return continueInWindowProgram(line.argc, line.argv);
  options.session = line.sessionOptions();
  options.meshUnit = line.unit;
  if (line.size) {
    if (options.screenshot.empty()) return reportError({ErrorCode::usage, "--size is for --screenshot"});
    options.width = line.size->width;
    options.height = line.size->height;
  }
  if (!arguments.view.empty()) {
    if (options.screenshot.empty()) return reportError({ErrorCode::usage, "--view is for --screenshot"});
    options.view = pictureViewOf(arguments.view);
    if (!options.view)
      return reportError(
          {ErrorCode::usage, "--view " + arguments.view + ": accepted: 3d, axial, sagittal, coronal, four-up"});
  }
  if (const auto good = readCamera(arguments, options); !good) return reportError(good.error());
  if (!arguments.overlay.empty()) {
    if (options.screenshot.empty()) return reportError({ErrorCode::usage, "--overlay is for --screenshot"});
    options.overlay = pictureOverlayOf(arguments.overlay);
  }
  if (options.scene == kStandardStream) {
    auto text = readSceneFromInput();
    if (!text) return reportError(text.error());
    options.scene = kStandardInput;
    options.sceneText = std::move(*text);
  }
  StandardOutputFile output;
  if (const auto taken = output.take({{"--report", &options.report},
                                      {"--probes", &options.probes},
                                      {"--energies", &options.energies},
                                      {"--tissues", &options.tissues},
                                      {"--sampled", &options.sampled}});
      !taken)
    return reportError(taken.error());
  const int exitCode = runScene(options);
  if (const auto printed = output.print(); !printed) return reportError(printed.error());
  return exitCode;
}

/// Material points and landmarks.
void declarePoints(CLI::App &app, RunOptions &options) {
  CLI::Option *samplePoints = addFile(app, "--sample-points", options.samplePoints, "FILE.csv",
                                      "Material points to follow: a table with body, x [m], y [m], z [m]");
  CLI::Option *sampled =
      addFile(app, "--sampled", options.sampled, "FILE.csv", "Write where these points are at the end");
  samplePoints->needs(sampled);
  sampled->needs(samplePoints);
  addFiles(app, "--landmarks", options.landmarks, "FILE",
           "Landmarks in addition to those of the scene: a table with name,x_mm,y_mm,z_mm (LPS), or fiducials of 3D "
           "Slicer, .fcsv or .mrk.json (repeatable)");
  addFiles(app, "--target-landmarks", options.targetLandmarks, "FILE",
           "Where the landmarks of the same names should be at the end: the report has their errors (repeatable)");
  addFile(app, "--export-landmarks", options.exportLandmarks, "FILE",
          "Write where the landmarks are at the end: .csv, .fcsv or .mrk.json");
}

/// What is written at the end, and for ParaView over time.
void addExports(CLI::App &app, CommandLine &line, RunArguments &arguments) {
  RunOptions &options = arguments.options;
  addFile(app, "--screenshot", options.screenshot, "FILE.png",
          "Draw the end state as PNG; with the extension .jpg as JPEG, with .ppm as uncompressed PPM");
  addSize(app, line, "Size of the screenshot; default: 1280x720");
  app.add_option(
         "--view", arguments.view,
         "What the screenshot shows: 3d, axial, sagittal, coronal or four-up; default: four-up where the scene has an "
         "image, else 3d")
      ->type_name("VIEW")
      ->check(listOfChoices("3d,axial,sagittal,coronal,four-up"));
  addParsed(app, "--camera", arguments.angles,
            "Where the 3D view is seen from, in degrees: azimuth about the up axis (0: from +z, or from -y where z is "
            "up; 90: from +x), elevation; default: 34,20",
            [](const std::string &text) { return parseCameraAngles(text); })
      ->type_name("AZIMUTH,ELEVATION");
  app.add_option("--up", arguments.up, "The axis that points upwards in the 3D view; default: z beside slices, else y")
      ->check(CLI::IsMember({"y", "z"}))
      ->type_name("AXIS");
  app.add_option(
         "--overlay", arguments.overlay,
         "What slices of the screenshot show in colours: none, displacement, volume_change, or a field that the "
         "simulator has at its points, for example contact_pressure; default: displacement")
      ->type_name("NAME");
  CLI::Option *exportList = addFile(app, "--export", options.exportList, "FILE.pvd",
                                    "Write the simulation for ParaView: points and skins over time");
  addSeconds(app, "--export-every", options.exportEvery_s, 1e-9, "Simulated time between two frames of --export")
      ->default_str(formatNumber(kDefaultExportEvery_s))
      ->needs(exportList);
  addFile(app, "--export-image", options.exportImage.image, "FILE",
          "Write the scene's image as the tissue lies at the end (nrrd, nii, nii.gz, mha)");
  addFile(app, "--export-labels", options.exportImage.labels, "FILE",
          "Write the deformed label map of the end: the nearest label at each voxel of the image");
  addFile(app, "--export-displacement", options.exportImage.displacement, "FILE",
          "Write the displacement of the tissue at the voxels of the image, mm");
  addFile(app, "--export-surface", options.exportSurface, "FILE",
          "Write the skin of the end state (obj, stl, ply, vtp); of several bodies FILE-NAME each");
}

constexpr const char *kExamples =
    "Examples:\n"
    "    c3de run SCENE.toml --until 2 --report r.json --screenshot end.png\n"
    "    c3de run SCENE.toml --set body.organ.material.youngs_modulus=2e4 --probes p.csv\n"
    "    c3de run organ.stl --unit mm --until 0.5            # a mesh as one falling body\n"
    "    c3de run - --steps 100 --report - -q <SCENE.toml    # as a filter\n"
    "    c3de run SCENE.toml --save-session day.c3de && c3de run day.c3de --until 4\n"
    "What --set accepts: c3de parameters. Tissues: c3de materials.";

/// The help has many options; titles separate them.
void groupOptions(CLI::App &app) {
  const std::vector<std::pair<const char *, std::vector<const char *>>> groups{
      {"Simulation", {"--until", "--steps", "--time-limit", "--set", "--unit", "--from-state", "--verify", "--seed"}},
      {"Results",
       {"--report", "--probes", "--probes-every", "--energies", "--tissues", "--sample-points", "--sampled",
        "--landmarks", "--target-landmarks", "--export-landmarks"}},
      {"Picture", {"--screenshot", "--size", "--view", "--camera", "--up", "--overlay"}},
      {"Export",
       {"--export", "--export-every", "--export-image", "--export-labels", "--export-displacement",
        "--export-surface"}},
      {"States, sessions and recordings",
       {"--save-state", "--save-session", "--search", "--record", "--record-hash-every", "--embed"}}};
  for (const auto &[title, names] : groups)
    for (const char *name : names) app.get_option(name)->group(title);
}

Handler declareRun(CLI::App &app, CommandLine &line) {
  const auto arguments = std::make_shared<RunArguments>();
  RunOptions &options = arguments->options;
  app.add_option_function<std::string>(
         "SCENE", [&options](const std::string &text) { options.scene = text; },
         "A scene (.toml), a session (.c3de) to continue, or a mesh as one body; - reads a scene from standard input")
      ->required();
  CLI::Option *until = addSeconds(app, "--until", options.until_s, 0.0,
                                  "Simulated time to reach; default: 1 s (a quasi-static solution: its full load)");
  addCount(app, "--steps", options.steps, 0, 1000000000000LL, "Steps to make, instead of --until")->excludes(until);
  addSeconds(app, "--time-limit", options.timeLimit_s, 0.0,
             "Wall-clock time after which the run stops between two steps, writes its outputs and ends with 124");
  app.add_option("--set", options.overrides,
                 "Replace a value of the scene, for example body.liver.material.youngs_modulus=6e3 (repeatable)")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  addFile(app, "--report", options.report, "FILE.json",
          "Write the report as JSON; - prints to standard output, as for every table");
  addFile(app, "--probes", options.probes, "FILE.csv", "Write the probes over time as CSV");
  addCount(app, "--probes-every", options.probesEvery, 1, 1000000000LL, "Steps between two rows of --probes")
      ->default_str("1");
  addFile(app, "--energies", options.energies, "FILE.csv", "Write the energies of all bodies over time as CSV");
  addFile(app, "--tissues", options.tissues, "FILE.csv",
          "Write what each label of bodies of many tissues has done at the end as CSV: volume, displacement, smallest "
          "det F");
  declarePoints(app, options);
  addExports(app, line, *arguments);
  addFile(app, "--from-state", options.fromState, "FILE",
          "Begin at a state that was saved of this scene; --until and --steps count from the scene's beginning");
  app.add_flag(
      "--verify", options.verify,
      "At the end, solve the state once more with half the spacing: its error goes to the report (verification) "
      "and is printed");
  addFile(app, "--save-state", options.saveState, "FILE", "Write the state of the end, for --from-state");
  CLI::Option *saveSession =
      addFile(app, "--save-session", options.saveSession, "FILE.c3de",
              "Write scene, state and the names and hashes of all files at the end; `c3de run FILE.c3de` resumes it");
  addSearch(app, options.search);
  CLI::Option *record = addFile(app, "--record", options.record, "FILE.c3dr",
                                "Write the state before the first step, every change, and hashes of the state, for "
                                "`c3de replay`");
  app.add_flag("--embed", options.embed,
               "Store all images and meshes in the session and in the recording, so that they open elsewhere")
      ->check([saveSession, record](const std::string &) {
        return saveSession->count() + record->count() > 0 ? std::string() : "requires --save-session or --record";
      });
  addCount(app, "--record-hash-every", options.recordHashEvery, 1, 1000000000LL,
           "Steps between two state hashes of --record")
      ->default_str(std::to_string(kDefaultHashEvery))
      ->needs(record);
  addCount(app, "--seed", options.seed, 0, 9223372036854775807LL,
           "Kept in the report; nothing in this version is random");
  // For commands that start runs: no run stays behind after a signal that cannot be caught.
  app.add_flag_function("--end-with-parent", [](std::int64_t) { endWithParent(); })->group("");
  addUnit(app, line);
  addSessionOptions(app, line);
  groupOptions(app);
  app.footer(kExamples);
  return [arguments, &line] { return run(*arguments, line); };
}

}  // namespace

const Command kRunCommand{"run", "Simulate without a window", declareRun};

}  // namespace c3de::app
