// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "c3de/core/platform.h"
#include "c3de/plugin_host/plugin_host.h"
#include "support/catch.h"
#include "support/environment.h"

using namespace c3de;

TEST_CASE("plugins are looked for in the given folders, the user's, and beside the program") {
  const auto first = std::filesystem::absolute("first"), second = std::filesystem::absolute("second");
  const std::string separator(1, pathListSeparator());
  auto path =
      std::make_unique<ScopedEnvironment>("C3DE_PLUGIN_PATH", first.string() + separator + separator + second.string() +
                                                                  separator + first.string() + separator);
  const auto folders = plugin_host::defaultPluginFolders();
  path.reset();
  REQUIRE(folders.size() == 4);
  CHECK(folders[0] == first);
  CHECK(folders[1] == second);
  CHECK(folders[2] == (userDataDirectory() / "plugins").lexically_normal());
  CHECK(folders[3] == (executablePath().parent_path().parent_path() / "lib/c3de/plugins").lexically_normal());
  CHECK(plugin_host::defaultPluginFolders().size() == 2);
}
