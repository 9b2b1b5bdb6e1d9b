// SPDX-License-Identifier: Apache-2.0
// A report about a problem is saved in the window and replayed elsewhere.
#include <filesystem>

#include "support/catch.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

/// Saves a report by the dialog; what is typed is its text.
void saveReport(WorkstationDriver &window, const fs::path &file) {
  window.clickMenu("help.save_report");
  C3DE_WAIT(window, "the files are counted", !textOf(s, "report/size").empty());
  window.click("report/description");
  window.type("it trembles");
  C3DE_WAIT(window, "the text is there", textOf(s, "report/description") == "it trembles");
  window.screenshot("dialog");
  window.click("report/save");
  window.enterFile(file);
  waitForMessage(window, "Report saved");
}

}  // namespace

TEST_CASE("A report of a pulled organ is replayed in another folder, without the mesh", "[report]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path file = freshFile("report.c3dr");
  WorkstationDriver window("report");
  startOrgan(window);
  playAndPull(window);
  pause(window);
  saveReport(window, file);
  const fs::path elsewhere = outputFile("elsewhere");
  fs::create_directories(elsewhere);
  fs::copy_file(file, elsewhere / "r.c3dr", fs::copy_options::overwrite_existing);
  checkReplays(elsewhere / "r.c3dr");
  const Json info = describe(elsewhere / "r.c3dr");
  CHECK(info["report"]["description"] == "it trembles");
  CHECK(info["report"]["versions"]["program"].get<std::string>().starts_with("C3DE "));
  CHECK_FALSE(info["report"]["versions"]["plugins"].empty());
  for (const Json &one : info["files"]) CHECK(one["state"] == "embedded");
}
