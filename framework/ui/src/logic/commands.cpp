// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/commands.h"

#include "c3de/abi/tools.h"

namespace c3de::ui {
namespace {

constexpr CommandInfo kCommands[] = {
    {Command::none, "", "", ""},
    {Command::openMesh, "file.open_mesh", "Open mesh…", "Show a mesh file as a deformable body", 0, 'M', C3DE_MOD_CTRL},
    {Command::openScene, "file.open_scene", "Open scene…", "Open a scene file (TOML)", 0, 'O', C3DE_MOD_CTRL},
    {Command::openSession, "file.open_session", "Open session…", "Continue a saved session (.c3de)", 0, 'O',
     C3DE_MOD_CTRL | C3DE_MOD_SHIFT},
    {Command::openRecording, "file.open_recording", "Open recording…", "Replay a recording (.c3dr), with a timeline"},
    {Command::openImage, "file.open_image", "Open image…", "Show a medical image: DICOM, NIfTI, NRRD, MetaImage", 0,
     'I', C3DE_MOD_CTRL},
    {Command::openFolder, "file.open_folder", "Open DICOM folder…", "Show the series of a folder"},
    {Command::openLabels, "file.open_labels", "Open label map…", "Overlay labels on the image", needsImage, 'L',
     C3DE_MOD_CTRL},
    {Command::openComparison, "file.open_comparison", "Open as comparison…",
     "Show a second scan over the image: blended or as a checkerboard, aligned by landmarks or by hand", needsImage},
    {Command::createScanBody, "file.create_scan_body", "Create body from scan…",
     "Create one body from all labels and the tissue between them", needsLabels | needsNoReplay},
    {Command::closeComparison, "file.close_comparison", "Remove comparison",
     "Close the second scan; the image stays as it is", needsComparison},
    {Command::closeImage, "file.close_image", "Close image", "Close image and labels", needsImage},
    {Command::closeSimulation, "file.close_simulation", "Close simulation",
     "Remove the bodies and obstacles; image and labels stay as they are", needsSimulation},
    {Command::reload, "file.reload", "Reload from file", "Read the opened files again", needsSimulation, keyF5},
    {Command::saveSession, "file.save_session", "Save session",
     "Save state, changes, image and camera to the session's file", beginsGroup | needsContent | needsNoReplay, 'S',
     C3DE_MOD_CTRL},
    {Command::saveSessionAs, "file.save_session_as", "Save session as…", "Write the session to another file",
     needsContent | needsNoReplay, 'S', C3DE_MOD_CTRL | C3DE_MOD_SHIFT},
    {Command::saveSessionWithFiles, "file.save_session_with_files", "Save session with its files…",
     "Write a session that contains its images and meshes and opens on another computer", needsContent | needsNoReplay},
    {Command::saveLabels, "file.save_labels", "Save label map…",
     "Write what is picked or painted, with the labels of the open map: NRRD, NIfTI, MetaImage",
     beginsGroup | needsImage},
    {Command::saveStatistics, "file.save_statistics", "Save region statistics…",
     "Write volume, mean and standard deviation of what is picked and of each label: CSV", needsImage},
    {Command::exportSurface, "file.export_surface", "Export surface…",
     "Write the surfaces of the bodies in their present shape: OBJ, STL, PLY, VTP", beginsGroup | needsSimulation, 'E',
     C3DE_MOD_CTRL},
    {Command::exportFrame, "file.export_frame", "Export simulation frame…",
     "Write points and skins as they are now, for ParaView", needsSimulation},
    {Command::exportImage, "file.export_image", "Export deformed image…",
     "Write the deformed image: NRRD, NIfTI, MetaImage", needsSimulation | needsImage},
    {Command::exportLabels, "file.export_labels", "Export deformed labels…",
     "Write the deformed label map, the nearest label at each voxel: NRRD, NIfTI, MetaImage",
     needsSimulation | needsImage | needsLabels},
    {Command::exportDisplacement, "file.export_displacement", "Export displacement…",
     "Write how far the tissue has moved at each voxel, mm: NRRD, NIfTI, MetaImage", needsSimulation | needsImage},
    {Command::exportTissues, "file.export_tissues", "Export tissue table…",
     "Write volume, displacement and smallest det F of each label as they are now: CSV",
     needsSimulation | needsTissues},
    {Command::exportResiduals, "file.export_residuals", "Export residuals of the match…",
     "Write each measured point with its distance before, after the rigid motion and after the deformation: CSV",
     needsSimulation},
    {Command::saveFigure, "file.save_figure", "Save figure…",
     "Write the views for a paper: PNG with a size in mm, legend and scale bar", beginsGroup | needsContent, keyF12,
     C3DE_MOD_SHIFT},
    {Command::copyFigure, "file.copy_figure", "Copy figure",
     "Copy the views to the clipboard as PNG, with the settings of the last figure", needsContent, 'C',
     C3DE_MOD_CTRL | C3DE_MOD_SHIFT},
    {Command::screenshot, "file.screenshot", "Save screenshot", "Write a PNG in the size chosen under Screenshot size",
     0, keyF12},
    {Command::quit, "file.quit", "Quit", "Close the program", beginsGroup, 'Q', C3DE_MOD_CTRL},
    {Command::undo, "edit.undo", "Undo", "Undo the last parameter change or organ selection step", needsNoReplay, 'Z',
     C3DE_MOD_CTRL},
    {Command::redo, "edit.redo", "Redo", "Redo the change that was undone", needsNoReplay, 'Y', C3DE_MOD_CTRL, 'Z',
     C3DE_MOD_CTRL | C3DE_MOD_SHIFT},
    {Command::searchPanel, "edit.search", "Search the panel", "Show only rows that match the search text", 0, 'F',
     C3DE_MOD_CTRL},
    {Command::preferences, "edit.preferences", "Preferences…",
     "Theme, font size, units, folders, window and level at opening, autosave", beginsGroup, ',', C3DE_MOD_CTRL},
    {Command::fitView, "view.fit", "Fit view", "Fit everything visible into the view", 0, 'F'},
    {Command::resetView, "view.reset", "Reset view",
     "The view under the mouse as at the start: the middle slice, or all of the 3D view from the front; "
     "beside the views, all",
     0, 'R'},
    {Command::viewFront, "view.front", "Front (along −z)", "Look along −z", beginsGroup, '1', 0, 0, 0,
     "Anterior (along +y)"},
    {Command::viewBack, "view.back", "Back (along +z)", "Look along +z", 0, '2', 0, 0, 0, "Posterior (along −y)"},
    {Command::viewLeft, "view.left", "Left (along +x)", "Look along +x", 0, '3', 0, 0, 0,
     "Left of the patient (along −x)"},
    {Command::viewRight, "view.right", "Right (along −x)", "Look along −x", 0, '4', 0, 0, 0,
     "Right of the patient (along +x)"},
    {Command::viewTop, "view.top", "Top (along −y)", "Look along −y", 0, '5', 0, 0, 0, "Superior (along −z)"},
    {Command::viewBottom, "view.bottom", "Bottom (along +y)", "Look along +y", 0, '6', 0, 0, 0, "Inferior (along +z)"},
    {Command::fourViews, "view.four", "Four views", "Axial, sagittal, coronal and 3D beside each other",
     beginsGroup | needsImage},
    {Command::onlySpace, "view.only_3d", "3D view only", "The 3D view fills the window", needsImage},
    {Command::resetSlices, "view.reset_slices", "Reset slice views", "Middle slices, the whole image in view",
     needsImage},
    {Command::crossHair, "view.cross_hair", "Cross-hair", "Show or hide the cross-hair of all views", needsImage, 'C'},
    {Command::windowLevelMode, "view.window_level", "Window/level mode",
     "A left drag in a slice changes window (sideways) and level (upwards)", needsImage, 'W'},
    {Command::cutAxial, "view.cut_axial", "Cut at the axial slice",
     "3D view: cycle through hiding the part above the slice, the part below, and nothing", beginsGroup | needsImage,
     'A', C3DE_MOD_SHIFT},
    {Command::cutSagittal, "view.cut_sagittal", "Cut at the sagittal slice",
     "3D view: cycle through hiding the part left of the slice, the right part, and nothing", needsImage, 'S',
     C3DE_MOD_SHIFT},
    {Command::cutCoronal, "view.cut_coronal", "Cut at the coronal slice",
     "3D view: cycle through hiding the part in front of the slice, the part behind, and nothing", needsImage, 'C',
     C3DE_MOD_SHIFT},
    {Command::showPlots, "view.plots", "Plots", "Show or hide curves over simulated time, below the views", beginsGroup,
     'T', C3DE_MOD_CTRL},
    {Command::resetLayout, "view.reset_layout", "Reset layout", "Side panel and sections as at the start"},
    {Command::playPause, "simulation.play", "Play / Pause", "Start, pause or continue", needsSimulation, ' '},
    {Command::step, "simulation.step", "Step", "One step of the solver, then pause", needsSimulation, keyRight},
    {Command::reset, "simulation.reset", "Reset",
     "Return exactly to the initial state; continues playing if it was playing", needsSimulation, 'R', C3DE_MOD_CTRL},
    {Command::stop, "simulation.stop", "Stop", "End and go back to the initial state", needsSimulation},
    {Command::startRecording, "simulation.start_recording", "Record…",
     "Record all changes from now on, for c3de replay",
     beginsGroup | needsSimulation | needsNoRecording | needsNoReplay},
    {Command::stopRecording, "simulation.stop_recording", "Stop recording", "Finish and close the recording",
     needsSimulation | needsRecording},
    {Command::showTimeline, "simulation.show_timeline", "Show timeline",
     "Finish the recording and show the past of the simulation; Return to now restores the present",
     needsSimulation | needsTimeline | needsNoReplay},
    {Command::saveState, "simulation.save_state", "Save state…",
     "Write the state of the simulation, to go back to it exactly", beginsGroup | needsSimulation | needsNoReplay},
    {Command::loadState, "simulation.load_state", "Load state…", "Restore a saved state of this scene",
     needsSimulation | needsNoReplay},
    {Command::matchBody, "simulation.match", "Match to measurements…",
     "Bring a body to measured points, a surface or a label: rigid motion, then deformation",
     beginsGroup | needsSimulation | needsNoReplay, 'M', C3DE_MOD_CTRL | C3DE_MOD_SHIFT},
    {Command::orbitTool, "tools.orbit", "Orbit", "The left button turns the camera", 0, 'O'},
    {Command::managePlugins, "plugins.manage", "Manage plugins…", "What was loaded, refused and switched off, and why",
     0, 'P', C3DE_MOD_CTRL | C3DE_MOD_SHIFT},
    {Command::openGuide, "help.guide", "User guide",
     "Open the guide of this version in your browser; it needs no network"},
    {Command::findCommand, "help.find_command", "Find a command…", "Find commands and tools by name or description", 0,
     'K', C3DE_MOD_CTRL},
    {Command::showShortcuts, "help.shortcuts", "Shortcuts", "Keyboard and mouse (also: ?)", 0, 'H', 0, keyF1},
    {Command::showMessages, "help.messages", "Messages", "All messages since the start"},
    {Command::saveReport, "help.save_report", "Save a report…",
     "Write recording, log and versions to one file, to report a problem"},
    {Command::showAbout, "help.about", "About", "Versions and graphics"},
};

}  // namespace

std::span<const CommandInfo> commands() { return std::span<const CommandInfo>(kCommands).subspan(1); }

const CommandInfo &commandInfo(Command command) {
  for (const CommandInfo &info : kCommands)
    if (info.command == command) return info;
  return kCommands[0];
}

Command commandOfKey(std::uint32_t key, std::uint32_t modifiers) {
  if (key == 0) return Command::none;
  for (const CommandInfo &info : kCommands) {
    if (info.key == key && info.modifiers == modifiers) return info.command;
    if (info.alternativeKey == key && modifiers == info.alternativeModifiers) return info.command;
  }
  return Command::none;
}

std::string keyText(std::uint32_t key, std::uint32_t modifiers) {
  if (key == 0) return {};
  std::string text;
  if (modifiers & C3DE_MOD_CTRL) text += "Ctrl+";
  if (modifiers & C3DE_MOD_SHIFT) text += "Shift+";
  if (modifiers & C3DE_MOD_ALT) text += "Alt+";
  switch (key) {
    case ' ': return text + "Space";
    case keyEscape: return text + "Esc";
    case keyRight: return text + "Right";
    case keyLeft: return text + "Left";
    case keyUp: return text + "Up";
    case keyDown: return text + "Down";
    case keyF1: return text + "F1";
    case keyF5: return text + "F5";
    case keyF12: return text + "F12";
    default: return text + static_cast<char>(key);
  }
}

std::string programCommandOf(std::uint32_t key, std::uint32_t modifiers) {
  const Command command = commandOfKey(key, modifiers);
  return command == Command::none ? std::string() : "'" + std::string(commandInfo(command).label) + "' of the program";
}

bool isFreeForTools(std::uint32_t key) { return key != 0 && key != keyEscape && commandOfKey(key, 0) == Command::none; }

}  // namespace c3de::ui
