// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace c3de::ui {

enum class Command {
  none,
  openMesh,
  openScene,
  openSession,
  openRecording,
  openImage,
  openFolder,
  openLabels,
  openComparison,
  createScanBody,
  closeComparison,
  closeImage,
  closeSimulation,
  reload,
  saveSession,
  saveSessionAs,
  saveSessionWithFiles,
  saveLabels,
  saveStatistics,
  exportSurface,
  exportFrame,
  exportImage,
  exportLabels,
  exportDisplacement,
  exportTissues,
  exportResiduals,
  saveFigure,
  copyFigure,
  screenshot,
  quit,
  undo,
  redo,
  searchPanel,
  preferences,
  fitView,
  resetView,
  viewFront,
  viewBack,
  viewLeft,
  viewRight,
  viewTop,
  viewBottom,
  fourViews,
  onlySpace,
  resetSlices,
  crossHair,
  windowLevelMode,
  cutAxial,
  cutSagittal,
  cutCoronal,
  showPlots,
  resetLayout,
  playPause,
  step,
  reset,
  stop,
  startRecording,
  stopRecording,
  showTimeline,
  saveState,
  loadState,
  matchBody,
  orbitTool,
  managePlugins,
  openGuide,
  findCommand,
  showShortcuts,
  showMessages,
  saveReport,
  showAbout
};

/// Keys without a character; other keys are identified by their ASCII upper-case character.
enum Key : std::uint32_t {
  keyEscape = 27,
  keyDelete = 127,
  keyRight = 0x100,
  keyF1 = 0x101,
  keyF5 = 0x105,
  keyF12 = 0x10c,
  keyLeft = 0x110,
  keyUp = 0x111,
  keyDown = 0x112
};

/// What a command needs to be enabled, and how its menu shows it.
enum CommandFlag : std::uint32_t {
  needsSimulation = 1,
  needsImage = 2,
  needsLabels = 4,      ///< an image with a label map over it
  needsTissues = 8,     ///< a body of many tissues
  beginsGroup = 16,     ///< a line separates it from the entry above
  needsContent = 32,    ///< a simulation or an image
  needsRecording = 64,  ///< the simulation is being recorded
  needsNoRecording = 128,
  needsTimeline = 512,    ///< the simulation is being recorded, or was
  needsNoReplay = 256,    ///< it changes the simulation, or stores its state
  needsComparison = 1024  ///< a second scan over the image
};

/// A command as menus, keyboard, list of shortcuts and automation use it. executeCommand() executes it.
struct CommandInfo {
  Command command;
  const char *id;  ///< dotted: menu, then entry
  const char *label;
  const char *doc;              ///< one line
  std::uint32_t flags = 0;      ///< CommandFlag
  std::uint32_t key = 0;        ///< 0: none
  std::uint32_t modifiers = 0;  ///< C3DE_MOD_*
  std::uint32_t alternativeKey = 0;
  std::uint32_t alternativeModifiers = 0;
  const char *patientLabel = nullptr;  ///< replaces the label where the patient's z points up; null: the same
};

/// In the order of the menus.
[[nodiscard]] std::span<const CommandInfo> commands();
[[nodiscard]] const CommandInfo &commandInfo(Command command);
/// Command::none if nothing is bound to the key.
[[nodiscard]] Command commandOfKey(std::uint32_t key, std::uint32_t modifiers);
/// For example "Ctrl+Q"; empty for key 0.
[[nodiscard]] std::string keyText(std::uint32_t key, std::uint32_t modifiers);
/// "'Quit' of the program" if the program uses these keys, otherwise empty: CommandRegistry::setProgramKeys.
[[nodiscard]] std::string programCommandOf(std::uint32_t key, std::uint32_t modifiers);
/// A tool's shortcut is honoured if no command uses it.
[[nodiscard]] bool isFreeForTools(std::uint32_t key);

}  // namespace c3de::ui
