// SPDX-License-Identifier: Apache-2.0
#include "commands/topics.h"

namespace c3de::app {
namespace {

constexpr TopicEntry kEnvironment[]{
    {"C3DE_HOME",
     "Folder for all files of the user: data, config and cache are folders in it. Default: the XDG folders, or AppData "
     "on Windows."},
    {"C3DE_PLUGIN_PATH", "Folders that are searched for plugins, with : between them (; on Windows)."},
    {"C3DE_LIBRARY", "Python package: the file of libc3de to load. Default: the one of the installation."},
    {"C3DE_PROGRAM",
     "Python package: the program c3de that draws pictures and opens windows. Default: the one of the installation, "
     "else of PATH."},
    {"NO_COLOR", "If it is not empty, messages have no colours, also on a terminal."},
    {"COLORTERM, TERM", "Whether the terminal has colours. Messages have none where standard error is no terminal."},
    {"DISPLAY, WAYLAND_DISPLAY",
     "The display of the window. If both are empty, `c3de run` works and a window does not."},
    {"XDG_DATA_HOME, XDG_CONFIG_HOME, XDG_CACHE_HOME",
     "Where the folders c3de of the user are, if C3DE_HOME is not set."},
    {"HOME, USERPROFILE",
     "Home folder: the default of the folders above, fonts of the user, file dialogs. Left out of reports about "
     "problems."},
    {"USER, USERNAME, LOGNAME", "Name of the user, which is left out of reports about problems."},
    {"PATH", "Searched for ffmpeg, which makes films."},
    {"OMPI_COMM_WORLD_SIZE, PMI_SIZE, PMIX_RANK",
     "Set by mpirun: `c3de study` shares its points with the other processes."},
    {"PROCESSOR_IDENTIFIER, COMPUTERNAME", "Windows: the machine, as reports name it."}};

constexpr TopicEntry kExitCodes[]{
    {"0", "Done."},
    {"1", "The run failed."},
    {"2", "Usage: a wrong option, value or name."},
    {"3", "An input cannot be read, or is refused."},
    {"4", "A plugin is missing or refused."},
    {"5", "The simulation diverged (the last good state is in the outputs), or a replay differs."},
    {"6", "There is no usable OpenGL or no display."},
    {"7", "An output cannot be written."},
    {"124", "The time limit was reached."},
    {"130", "Interrupted."}};

constexpr TopicEntry kFiles[]{
    {"$XDG_DATA_HOME/c3de, ~/.local/share/c3de", "Plugins of the user (plugins), recent files, unsaved sessions."},
    {"$XDG_CONFIG_HOME/c3de, ~/.config/c3de", "Settings of the window and of plugins."},
    {"$XDG_CACHE_HOME/c3de, ~/.cache/c3de", "Caches."},
    {"PREFIX/share/c3de", "Scenes, meshes, material presets and templates of plugins."},
    {"PREFIX/lib/c3de/plugins", "Plugins of the installation."},
    {"PREFIX/share/doc/c3de", "Guide, licences."}};

}  // namespace

std::span<const TopicEntry> environmentVariables() { return kEnvironment; }
std::span<const TopicEntry> exitCodes() { return kExitCodes; }
std::span<const TopicEntry> userFiles() { return kFiles; }

std::string textOf(std::span<const TopicEntry> entries) {
  constexpr std::size_t kColumn = 30;
  std::string text;
  for (const TopicEntry &entry : entries) {
    std::string line = "  " + std::string(entry.term);
    if (line.size() + 2 > kColumn)
      line += "\n" + std::string(kColumn, ' ');
    else
      line.resize(kColumn, ' ');
    text += line + entry.text + "\n";
  }
  return text;
}

}  // namespace c3de::app
