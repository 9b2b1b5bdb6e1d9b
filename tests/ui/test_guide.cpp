// SPDX-License-Identifier: Apache-2.0
// Help opens the guide in the browser of the user.
#include <filesystem>
#include <fstream>

#include "support/catch.h"
#include "support/environment.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace fs = std::filesystem;

TEST_CASE("the guide opens in the browser, and its file is named where none is installed", "[guide_opens]") {
  C3DE_WINDOW_OR_SKIP();
  const fs::path folder = outputFile("guide_browser"), said = outputFile("guide_opened.txt");
  fs::remove_all(folder);
  fs::remove(said);
  fs::create_directories(folder);
  std::ofstream(folder / "xdg-open") << "#!/bin/sh\nprintf '%s' \"$1\" > '" << said.string() << ".part'\nmv '"
                                     << said.string() << ".part' '" << said.string() << "'\n";
  fs::permissions(folder / "xdg-open", fs::perms::owner_all);
  const ScopedEnvironment path("PATH", folder.string() + ":" + environmentVariable("PATH"));
  WorkstationDriver window("guide_opens");
  window.start(std::vector<std::string>{});
  window.clickMenu("help.guide");
  C3DE_WAIT(window, "the browser is started", !s["notifications"].empty() && fs::exists(said));
  const Json message = window.state()["notifications"].back();
  CHECK(message["severity"] == "info");
  std::ifstream in(said);
  const std::string file{std::istreambuf_iterator<char>(in), {}};
  INFO(file);
  CHECK(fs::is_regular_file(file));
  CHECK((file.ends_with("reference/index.html") || file.ends_with("docs/user/index.md")));
  CHECK_THAT(message["text"].get<std::string>(), Contains(file));
}
