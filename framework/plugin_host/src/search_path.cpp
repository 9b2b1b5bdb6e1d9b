// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "c3de/core/embedding.h"
#include "c3de/core/file_path.h"
#include "c3de/core/platform.h"
#include "c3de/plugin_host/load_rules.h"
#include "c3de/plugin_host/plugin_host.h"

namespace c3de::plugin_host {

std::filesystem::path ownPluginFolder() {
  return normalPath(modulePath().parent_path() / ".." / "lib" / "c3de" / "plugins");
}

std::vector<std::filesystem::path> defaultPluginFolders() {
  std::vector<std::filesystem::path> folders;
  const auto add = [&](std::filesystem::path folder) {
    folder = normalPath(absolutePath(folder));
    if (std::find(folders.begin(), folders.end(), folder) == folders.end()) folders.push_back(std::move(folder));
  };
  const std::string list = environmentVariable("C3DE_PLUGIN_PATH");
  for (std::size_t begin = 0; begin < list.size();) {
    const std::size_t end = std::min(list.find(pathListSeparator(), begin), list.size());
    if (end > begin) add(list.substr(begin, end - begin));
    begin = end + 1;
  }
  add(userDataDirectory() / "plugins");
  add(ownPluginFolder());
  return folders;
}

}  // namespace c3de::plugin_host
