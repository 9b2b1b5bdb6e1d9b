// SPDX-License-Identifier: Apache-2.0
// Files of sessions in the window: embedded ones, and those that have moved or changed.
#include <filesystem>
#include <fstream>

#include "support/catch.h"
#include "ui/program_command.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

/// A closed box of 60 mm.
constexpr const char *kBox =
    "v 0 0 0\nv 60 0 0\nv 60 60 0\nv 0 60 0\nv 0 0 60\nv 60 0 60\nv 60 60 60\nv 0 60 60\n"
    "f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 4 7 3\nf 4 8 7\nf 1 5 8\nf 1 8 4\nf 2 3 7\nf 2 7 6\n";

std::string textOfFile(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The floating organ with its mesh in a folder of its own, and a session after some steps.
struct MovableOrgan {
  fs::path folder, mesh, session;

  explicit MovableOrgan(const std::string &name) : folder(outputFile(name)) {
    fs::remove_all(folder);
    fs::create_directories(folder / "data");
    mesh = folder / "data" / organMesh().filename();
    session = folder / "case" / "organ.c3de";
    fs::create_directories(session.parent_path());
    fs::copy_file(organMesh(), mesh);
    const fs::path scene = folder / "organ.toml";
    const std::string text = textOfFile(floatingOrgan());
    const std::size_t at = text.find(organMesh().generic_string());
    REQUIRE(at != std::string::npos);
    std::ofstream(scene) << std::string(text).replace(at, organMesh().generic_string().size(), mesh.generic_string());
    const auto ran = runProcess(
        programCommand({"run", scene.string(), "--steps", "30", "--save-session", session.string(), "-q"}), 120.0);
    REQUIRE(ran);
    INFO(ran->errorOutput);
    REQUIRE(ran->exitCode == 0);
  }
};

bool cannotOpen(const Json &state) { return state["disabled"].dump().find("\"missing/open\"") != std::string::npos; }

void waitForDialog(WorkstationDriver &window) {
  C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("missing/locate.0"));
}

}  // namespace

TEST_CASE("a mesh that has moved is located, and the session opens with its state", "[session_file_located]") {
  C3DE_ORGAN_OR_SKIP();
  const MovableOrgan organ("session_file_located_files");
  const fs::path moved = organ.folder / "elsewhere" / "renamed.obj", wrong = organ.folder / "wrong.obj";
  fs::create_directories(moved.parent_path());
  fs::rename(organ.mesh, moved);
  std::ofstream(wrong) << textOfFile(moved) << "# longer\n";
  WorkstationDriver window("session_file_located");
  window.start({organ.session.string()});
  waitForDialog(window);
  CHECK(window.value("missing/why.0") == "It is missing.");
  CHECK(window.value("missing/name.0") == organ.mesh.filename().string());
  CHECK(cannotOpen(window.state()));
  window.screenshotAtRest("missing");

  // Another file is refused with both hashes.
  window.click("missing/locate.0");
  window.openFile(wrong);
  C3DE_WAIT(window, "it is refused", textOf(s, "missing/refusal.0").find("SHA-256") != std::string::npos);
  const std::string hash = describe(organ.session)["files"][0]["sha256"];
  CHECK_THAT(window.value("missing/refusal.0"), Contains(hash + " in the session"));
  CHECK(cannotOpen(window.state()));
  window.screenshotAtRest("refused");

  window.click("missing/locate.0");
  window.openFile(moved);
  C3DE_WAIT(window, "it is found", textOf(s, "missing/found.0").find("renamed.obj") != std::string::npos);
  window.screenshotAtRest("found");
  window.click("missing/open");
  C3DE_WAIT(window, "it is opened", s["jobs"].empty() && s["transport"]["steps"] == 30);
  // The new path is stored.
  window.key("ctrl+s");
  waitForMessage(window, "Session saved");
  CHECK(describe(organ.session)["files"][0]["path"] == "../elsewhere/renamed.obj");
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);
}

TEST_CASE("a folder is searched for files, a changed file may be used anyway", "[session_file_searched]") {
  C3DE_ORGAN_OR_SKIP();
  const MovableOrgan organ("session_file_searched_files");
  const fs::path moved = organ.folder / "disk" / "deep" / "mesh.obj";
  fs::create_directories(moved.parent_path());
  fs::rename(organ.mesh, moved);
  {
    WorkstationDriver window("session_file_searched");
    window.start({organ.session.string()});
    waitForDialog(window);
    window.click("missing/search");
    C3DE_WAIT(window, "a folder is asked for", s["widgets"].contains("dialog/use_folder"));
    window.type((organ.folder / "disk").string());
    window.key("Return");
    C3DE_WAIT(window, "the folder is shown",
              fileOfProgram(s["values"].value("dialog/folder", "")) == organ.folder / "disk");
    window.screenshotAtRest("folder");
    window.click("dialog/use_folder");
    C3DE_WAIT(window, "it is found", textOf(s, "missing/found.0").find("mesh.obj") != std::string::npos);
    window.screenshotAtRest("searched");
    window.click("missing/open");
    C3DE_WAIT(window, "it is opened", s["jobs"].empty() && s["transport"]["steps"] == 30);
    window.key("ctrl+q");
    CHECK(window.waitForExit() == 0);
  }
  // Another body, which the state does not fit.
  std::ofstream(organ.mesh) << kBox;
  fs::remove(moved);
  WorkstationDriver window("session_file_used_anyway");
  window.start({organ.session.string()});
  waitForDialog(window);
  CHECK_THAT(window.value("missing/why.0"), Contains("It has changed"));
  window.click("missing/use.0");
  window.click("missing/open");
  waitForMessage(window, "The state was not restored");
  C3DE_WAIT(window, "it begins at the initial state", s["jobs"].empty() && s["transport"]["steps"] == 0);
  window.screenshotAtRest("initial");
  window.key("ctrl+q");
  C3DE_WAIT(window, "it asks", s["values"].contains("quit/text"));
  window.clickToEnd("quit/quit");
  CHECK(window.waitForExit() == 0);
}

TEST_CASE("a session is saved with its files and opens without them", "[session_with_files]") {
  C3DE_ORGAN_OR_SKIP();
  const MovableOrgan organ("session_with_files_files");
  const fs::path whole = organ.folder / "whole.c3de";
  {
    WorkstationDriver window("session_with_files");
    window.start({organ.session.string()});
    C3DE_WAIT(window, "it is opened", s["jobs"].empty() && s["transport"]["steps"] == 30);
    window.clickMenu("file.save_session_with_files");
    C3DE_WAIT(window, "the size is shown", textOf(s, "dialog/note").find("1 file, ") == 0);
    window.screenshot("size");  // a cursor blinks in it
    window.enterFile(whole);
    waitForMessage(window, "Session saved");
    window.key("ctrl+q");
    CHECK(window.waitForExit() == 0);
  }
  CHECK(describe(whole)["files"][0]["state"] == "embedded");
  fs::remove_all(organ.folder / "data");
  WorkstationDriver window("session_with_files_opened");
  window.start({whole.string()});
  C3DE_WAIT(window, "it is opened", s["jobs"].empty() && s["transport"]["steps"] == 30);
  window.key("space");
  C3DE_WAIT(window, "it continues", s["transport"]["steps"].get<int>() > 40);
  window.key("space");
  window.key("ctrl+s");
  waitForMessage(window, "Session saved");
  CHECK(describe(whole)["files"][0]["state"] == "embedded");
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);
}
