// SPDX-License-Identifier: Apache-2.0
#include "window/execute_command.h"

#include "c3de/abi/log.h"
#include "c3de/core/platform.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/segmentation/scan_body.h"
#include "frame/file_dialog.h"
#include "frame/guide.h"

namespace c3de::ui {
namespace {

constexpr const char *kFrameExtensions = "pvd", *kStateExtensions = "c3dstate", *kSessionExtensions = "c3de",
                     *kRecordingExtensions = "c3dr";
constexpr const char *kImageExtensions = "nrrd;nii;gz;mha";

void openGuide(FrameContext &frame) {
  const auto opened = showInBrowser(findGuide(executablePath().parent_path()));
  if (!frame.services.panels) return;
  if (opened)
    frame.services.panels->notify(C3DE_LOG_INFO, "User guide", "Opened in your browser: " + opened->string());
  else
    frame.services.panels->notify(C3DE_LOG_WARN, "User guide", opened.error().message);
}

void openDialog(FrameContext &frame, bool isMesh) {
  const WindowServices &services = frame.services;
  FileDialog::Request request;
  request.title = isMesh ? "Open mesh" : "Open scene";
  request.extensions = !isMesh ? "toml" : services.meshExtensions ? services.meshExtensions() : std::string();
  request.asksMeshUnit = isMesh;
  request.chosen = [open = frame.actions.open](const std::filesystem::path &file, const std::string &unit) {
    if (open) open({{file}, unit, false});
  };
  frame.fileDialog.open(std::move(request));
}

void openImageDialog(FrameContext &frame, bool areLabels) {
  FileDialog::Request request;
  request.title = areLabels ? "Open label map" : "Open image: a file, or any file of a DICOM series";
  request.chosen = [open = frame.actions.open, areLabels](const std::filesystem::path &file, const std::string &) {
    if (open) open({{file}, "mm", areLabels});
  };
  frame.fileDialog.open(std::move(request));
}

void openComparisonDialog(FrameContext &frame) {
  FileDialog::Request request;
  request.title = "Open as comparison: a file, or any file of a DICOM series";
  request.chosen = [open = frame.actions.openComparison](const std::filesystem::path &file, const std::string &) {
    if (open) open(file);
  };
  frame.fileDialog.open(std::move(request));
}

void openFolderDialog(FrameContext &frame) {
  FileDialog::Request request;
  request.title = "Open DICOM folder";
  request.folders = FileDialog::Folders::only;
  request.chosen = [open = frame.actions.open](const std::filesystem::path &folder, const std::string &) {
    if (open) open({{folder}, {}, false});
  };
  frame.fileDialog.open(std::move(request));
}

void openSessionDialog(FrameContext &frame, bool isRecording) {
  FileDialog::Request request;
  request.title = isRecording ? "Open recording" : "Open session";
  request.extensions = isRecording ? kRecordingExtensions : kSessionExtensions;
  request.chosen = [open = frame.actions.open](const std::filesystem::path &file, const std::string &) {
    if (open) open({{file}, {}, false});
  };
  frame.fileDialog.open(std::move(request));
}

void openStateDialog(FrameContext &frame) {
  FileDialog::Request request;
  request.title = "Load state";
  request.extensions = kStateExtensions;
  request.chosen = [load = frame.actions.loadState](const std::filesystem::path &file, const std::string &) {
    if (load) load(file);
  };
  frame.fileDialog.open(std::move(request));
}

void openExportDialog(FrameContext &frame, Command command) {
  const WindowActions &actions = frame.actions;
  FileDialog::Request request;
  request.isSaving = true;
  std::function<void(const std::filesystem::path &)> action;
  const auto set = [&](const char *title, const std::string &extensions, const auto &wanted) {
    request.title = title;
    request.extensions = extensions;
    const std::string name = actions.proposeName ? actions.proposeName(command) : std::string();
    if (!name.empty()) request.proposed = name + "." + extensions.substr(0, extensions.find(';'));
    action = wanted;
  };
  switch (command) {
    case Command::exportFrame: set("Export simulation frame", kFrameExtensions, actions.exportFrame); break;
    case Command::exportImage: set("Export deformed image", kImageExtensions, actions.exportImage); break;
    case Command::saveLabels: set("Save label map", kImageExtensions, actions.saveLabels); break;
    case Command::saveStatistics: set("Save region statistics", "csv", actions.saveStatistics); break;
    case Command::exportLabels: set("Export deformed labels", kImageExtensions, actions.exportLabels); break;
    case Command::exportDisplacement: set("Export displacement", kImageExtensions, actions.exportDisplacement); break;
    case Command::exportTissues: set("Export tissue table", "csv", actions.exportTissues); break;
    case Command::exportResiduals: set("Export residuals of the match", "csv", actions.exportResiduals); break;
    case Command::startRecording: set("Record", kRecordingExtensions, actions.startRecording); break;
    case Command::saveState: set("Save state", kStateExtensions, actions.saveState); break;
    default:
      set("Export surface", actions.surfaceExtensions ? actions.surfaceExtensions() : "obj", actions.exportSurface);
      break;
  }
  request.chosen = [action](const std::filesystem::path &file, const std::string &) {
    if (action) action(file);
  };
  frame.fileDialog.open(std::move(request));
}

void lookFrom(FrameContext &frame, const Vec3 &meshDirection, const Vec3 &patientDirection) {
  lookAlong(frame.camera, frame.camera.upAxis == render::UpAxis::z ? patientDirection : meshDirection);
}

/// None: resets all views.
void resetView(FrameContext &frame, std::optional<Pane> pane) {
  ImageViews *images = frame.shownImages();
  for (const Pane slice : kSlicePanes)
    if (images && pane.value_or(slice) == slice) images->view(slice).reset();
  if (pane.value_or(Pane::space) != Pane::space) return;
  resetCamera(frame.camera);
  frame.state.framesToFit = 1;
}

bool hasComparison(const FrameContext &frame) {
  const ImageViews *images = frame.shownImages();
  return images && images->comparison() && images->comparison()->image();
}

bool hasContent(const FrameContext &frame) { return frame.simulation.exists || frame.shownImages(); }

void quitOrAsk(FrameContext &frame) {
  const std::string toLose = frame.actions.unsaved ? frame.actions.unsaved() : std::string();
  if (toLose.empty()) {
    frame.state.answer = kQuit;
    return;
  }
  std::vector<Question::Answer> answers{{kQuit.second, "Quit"}, {"stay", "Stay"}};
  if (hasContent(frame) && frame.actions.saveSession && !frame.simulation.replay) {
    answers.front().label = "Quit, do not save";
    answers.insert(answers.begin(), {kSaveAndQuit.second, "Save"});
  }
  frame.state.question = {kQuit.first, "Quit C3DE?", toLose, std::move(answers)};
}

void resetLayout(FrameContext &frame) {
  frame.state.layout = {};
  frame.state.layout.resetSections = true;
  frame.state.plots.height = PlotStrip().height;
  if (ImageViews *images = frame.shownImages()) images->setMaximised({});
}

void showPlots(FrameContext &frame, bool isShown) {
  frame.state.plots.isShown = isShown;
  if (frame.actions.plots.show) frame.actions.plots.show(isShown);
}

void transport(FrameContext &frame, std::uint32_t action) {
  if (frame.actions.transport) frame.actions.transport(action);
}

}  // namespace

void saveSession(FrameContext &frame, bool asksForFile, std::function<void()> saved) {
  const WindowActions &actions = frame.actions;
  if (!actions.saveSession) return;
  const std::filesystem::path present = actions.sessionFile ? actions.sessionFile() : std::filesystem::path();
  if (!present.empty() && !asksForFile) return actions.saveSession(present, std::move(saved));
  FileDialog::Request request;
  request.isSaving = true;
  request.title = "Save session";
  request.extensions = kSessionExtensions;
  const std::string name = actions.proposeName ? actions.proposeName(Command::saveSessionAs) : std::string();
  if (!name.empty()) request.proposed = name + "." + kSessionExtensions;
  request.chosen = [save = actions.saveSession, saved](const std::filesystem::path &file, const std::string &) {
    save(file, saved);
  };
  frame.fileDialog.open(std::move(request));
}

void openSceneOrSession(FrameContext &frame) {
  FileDialog::Request request;
  request.title = "Open scene or session";
  request.extensions = std::string("toml;") + kSessionExtensions;
  request.chosen = [open = frame.actions.open](const std::filesystem::path &file, const std::string &) {
    if (open) open({{file}, {}, false});
  };
  frame.fileDialog.open(std::move(request));
}

void saveSessionWithFiles(FrameContext &frame) {
  const WindowActions &actions = frame.actions;
  if (!actions.saveSessionWithFiles || !actions.measureSession) return;
  FileDialog::Request request;
  request.isSaving = true;
  request.title = "Save session with its files";
  request.extensions = kSessionExtensions;
  const std::string name = actions.proposeName ? actions.proposeName(Command::saveSessionAs) : std::string();
  if (!name.empty()) request.proposed = name + "." + kSessionExtensions;
  request.chosen = [save = actions.saveSessionWithFiles](const std::filesystem::path &file, const std::string &) {
    save(file);
  };
  // The dialog exists as long as the window.
  actions.measureSession([&dialog = frame.fileDialog, request](const std::string &size) mutable {
    request.note = size;
    if (!dialog.isOpen()) dialog.open(std::move(request));
  });
}

bool isEnabled(const FrameContext &frame, const CommandInfo &info) { return whyDisabled(frame, info).empty(); }

std::string whyDisabled(const FrameContext &frame, const CommandInfo &info) {
  const auto needs = [&](CommandFlag flag) { return (info.flags & flag) != 0; };
  const WindowServices &services = frame.services;
  const SimulationView &simulation = frame.simulation;
  if (needs(needsNoReplay) && simulation.replay) return kReplayLocks;
  if (needs(needsSimulation) && !simulation.exists) return "No simulation is open.";
  if (needs(needsContent) && !hasContent(frame)) return "No simulation and no image is open.";
  if (needs(needsImage) && !frame.shownImages()) return "No image is open.";
  if (needs(needsComparison) && !hasComparison(frame)) return "No second scan is open.";
  if (needs(needsLabels) && !(services.scanBody && services.scanBody->isPossible()))
    return "No image with a label map over it is open.";
  if (needs(needsTissues) && !(services.tissues && !services.tissues->rows.empty()))
    return "The simulation has no body of many tissues.";
  if (needs(needsRecording) && simulation.recording.empty()) return "The simulation is not being recorded.";
  if (needs(needsNoRecording) && !simulation.recording.empty()) return "The simulation is being recorded already.";
  if (needs(needsTimeline) && !simulation.hasTimeline) return "The simulation was not recorded.";
  if (info.command == Command::exportResiduals && frame.actions.whyNoResiduals) return frame.actions.whyNoResiduals();
  if (info.command == Command::copyFigure && frame.actions.figures.whyNoCopy) return frame.actions.figures.whyNoCopy();
  return {};
}

void executeCommand(FrameContext &frame, Command command) {
  // What a tool holds is lost with the state.
  if (command == Command::reset || command == Command::stop) frame.modes.cancelTool();
  // Its key reads a file again that could not be opened, too.
  if (command != Command::reload && !isEnabled(frame, commandInfo(command))) return;
  const auto call = [](const std::function<void()> &action) {
    if (action) action();
  };
  ImageViews *images = frame.shownImages();
  const auto toggle = [images](bool ImageOptions::*flag) {
    ImageOptions options = images->options();
    options.*flag = !(options.*flag);
    images->setOptions(options);
  };
  switch (command) {
    case Command::none: break;
    case Command::openMesh: openDialog(frame, true); break;
    case Command::openScene: openDialog(frame, false); break;
    case Command::openSession: openSessionDialog(frame, false); break;
    case Command::openRecording: openSessionDialog(frame, true); break;
    case Command::saveSession: saveSession(frame, false); break;
    case Command::saveSessionAs: saveSession(frame, true); break;
    case Command::saveSessionWithFiles: saveSessionWithFiles(frame); break;
    case Command::openImage: openImageDialog(frame, false); break;
    case Command::openFolder: openFolderDialog(frame); break;
    case Command::openLabels: openImageDialog(frame, true); break;
    case Command::createScanBody: frame.services.scanBody->show(true); break;
    case Command::openComparison: openComparisonDialog(frame); break;
    case Command::closeComparison: call(frame.actions.closeComparison); break;
    case Command::closeImage: call(frame.actions.closeImage); break;
    case Command::closeSimulation: call(frame.actions.closeSimulation); break;
    case Command::reload: call(frame.actions.reload); break;
    case Command::saveLabels:
    case Command::saveStatistics:
    case Command::exportSurface:
    case Command::exportFrame:
    case Command::exportImage:
    case Command::exportLabels:
    case Command::exportDisplacement:
    case Command::exportTissues:
    case Command::exportResiduals:
    case Command::startRecording:
    case Command::saveState: openExportDialog(frame, command); break;
    case Command::stopRecording: call(frame.actions.stopRecording); break;
    case Command::showTimeline: call(frame.actions.showTimeline); break;
    case Command::saveFigure:
      frame.state.figure.isShown = true;
      frame.state.figure.isFilled = false;
      break;
    case Command::copyFigure: call(frame.actions.figures.copy); break;
    case Command::screenshot: call(frame.actions.screenshot); break;
    case Command::quit: quitOrAsk(frame); break;
    case Command::undo: frame.modes.undo(frame.above()); break;
    case Command::redo: frame.modes.redo(); break;
    case Command::fitView: frame.state.framesToFit = 1; break;
    case Command::resetView: resetView(frame, frame.modes.paneAt(frame.mouseX, frame.mouseY, frame.above())); break;
    case Command::viewFront: lookFrom(frame, {0, 0, -1}, {0, 1, 0}); break;
    case Command::viewBack: lookFrom(frame, {0, 0, 1}, {0, -1, 0}); break;
    case Command::viewLeft: lookFrom(frame, {1, 0, 0}, {-1, 0, 0}); break;
    case Command::viewRight: lookFrom(frame, {-1, 0, 0}, {1, 0, 0}); break;
    case Command::viewTop: lookFrom(frame, {0, -1, 0}, {0, 0, -1}); break;
    case Command::viewBottom: lookFrom(frame, {0, 1, 0}, {0, 0, 1}); break;
    case Command::fourViews: images->setMaximised({}); break;
    case Command::onlySpace: images->setMaximised(Pane::space); break;
    case Command::resetSlices: images->resetViews(); break;
    case Command::crossHair: toggle(&ImageOptions::showsCrossHair); break;
    case Command::windowLevelMode: toggle(&ImageOptions::isWindowLevelMode); break;
    case Command::cutAxial: images->cycleCut(Pane::axial); break;
    case Command::cutSagittal: images->cycleCut(Pane::sagittal); break;
    case Command::cutCoronal: images->cycleCut(Pane::coronal); break;
    case Command::searchPanel: frame.state.isSearchWanted = true; break;
    case Command::preferences:
      frame.state.preferencesDialog = {};
      frame.state.preferencesDialog.isShown = true;
      break;
    case Command::showPlots: showPlots(frame, !frame.state.plots.isShown); break;
    case Command::resetLayout: resetLayout(frame); break;
    case Command::playPause:
      transport(frame,
                frame.simulation.transport.mode == C3DE_SIM_PLAYING ? C3DE_TRANSPORT_PAUSE : C3DE_TRANSPORT_PLAY);
      break;
    case Command::step: transport(frame, C3DE_TRANSPORT_STEP); break;
    case Command::reset: transport(frame, C3DE_TRANSPORT_RESET); break;
    case Command::stop: transport(frame, C3DE_TRANSPORT_STOP); break;
    case Command::loadState: openStateDialog(frame); break;
    case Command::matchBody: call(frame.actions.matchBody); break;
    case Command::orbitTool:
      if (frame.services.tools) frame.services.tools->activate({});
      break;
    case Command::openGuide: openGuide(frame); break;
    case Command::findCommand: frame.state.palette = {.isShown = true}; break;
    case Command::showShortcuts: frame.state.showShortcuts = true; break;
    case Command::showMessages: frame.state.showMessages = true; break;
    case Command::managePlugins: frame.state.showPlugins = true; break;
    case Command::saveReport:
      frame.state.report.isShown = true;
      frame.state.report.isMeasured = false;
      break;
    case Command::showAbout: frame.state.showAbout = true; break;
  }
}

}  // namespace c3de::ui
