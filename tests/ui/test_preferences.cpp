// SPDX-License-Identifier: Apache-2.0
// What the user prefers: applied at once, stored, and the same at the next start. Menus and dialogs by keys.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "support/catch.h"
#include "support/environment.h"
#include "ui/image_window.h"
#include "ui/program_command.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

/// A bar of 0.5 m with a distance of 300 mm.
fs::path measuredBar(const std::string &scenario) {
  return stretchedBar(scenario, 0.5, 13332.2,
                      "[[landmark]]\nname = \"a\"\nat = [0.1, 0.05, 0.05]\n"
                      "[[landmark]]\nname = \"b\"\nat = [0.4, 0.05, 0.05]\n"
                      "[[distance]]\nname = \"length\"\nbetween = [\"a\", \"b\"]\n");
}

std::string fileText(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

fs::path configIn(const fs::path &home) { return home / "config" / "config.toml"; }

std::string preference(const Json &state, const std::string &key) { return textOf(state, "preferences/" + key); }

void openPreferences(WorkstationDriver &window) {
  window.key("ctrl+comma");
  C3DE_WAIT(window, "the preferences are shown", s["widgets"].contains("preferences/restore"));
}

void closeDialog(WorkstationDriver &window) {
  window.click("dialog/close");
  C3DE_WAIT(window, "the dialog is closed", !s["widgets"].contains("dialog/close"));
}

void quit(WorkstationDriver &window) {
  window.key("ctrl+q");
  C3DE_WAIT(window, "it ends or asks", s.value("closing", false) || s["widgets"].contains("quit/quit"));
  if (!window.state().value("closing", false)) window.clickToEnd("quit/quit");
  CHECK(window.waitForExit() == 0);
}

double heightOf(const Json &state, const std::string &widget) {
  const Json rect = state["widgets"][widget];
  return rect[3].get<double>() - rect[1].get<double>();
}

}  // namespace

TEST_CASE("theme, font size and units apply at once, reach the tables, and are the same at the next start",
          "[preferences]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path home = freshHome("preferences"), csv = freshFile("preferences_curves.csv");
  const ScopedEnvironment user("C3DE_HOME", home.string());
  const std::string scene = measuredBar("preferences").string(), modulus = kPanel + "material.youngs_modulus";
  {
    WorkstationDriver window("preferences");
    openOrgan(window, {scene});
    window.click("measurements/header");
    C3DE_WAIT(window, "the distance is listed", textOf(s, "measurements/length.label") == "300.0 mm");
    const Json before = window.state();
    CHECK(textOf(before, modulus).find("kPa") != std::string::npos);
    window.screenshotAtRest("dark");

    openPreferences(window);
    window.choose("preferences/length", "cm");
    window.choose("preferences/pressure", "mmHg");
    window.choose("preferences/force", "mN");
    C3DE_WAIT(window, "the panel and the measurements follow",
              textOf(s, modulus).find("100 mmHg") == 0 && textOf(s, "measurements/length.label") == "30.00 cm");
    window.choose("preferences/theme", "light");
    C3DE_WAIT(window, "it is light", preference(s, "theme") == "light");
    const double usual = heightOf(window.state(), "preferences/restore");
    window.click("preferences/font_size");
    window.key("ctrl+a");
    window.type("99");
    window.key("Tab");
    C3DE_WAIT(window, "99 is refused", preference(s, "problem").find("99: Accepted: 10 to 28") == 0);
    CHECK(preference(window.state(), "font_size") == "14");
    window.screenshot("refused");
    window.click("preferences/font_size");
    window.key("ctrl+a");
    window.type("17");
    window.key("Tab");
    C3DE_WAIT(window, "everything is larger",
              preference(s, "font_size") == "17" && preference(s, "problem").empty() &&
                  s["widgets"].contains("preferences/restore") && heightOf(s, "preferences/restore") > 1.1 * usual);
    window.screenshot("light");
    CHECK(window.differingPixels("dark", "light", "screen") > 200000.0);
    closeDialog(window);

    window.key("ctrl+t");
    C3DE_WAIT(window, "the plots are shown", textOf(s, "plots/shown") == "true");
    // A quasi-static simulation pauses at load factor 1.
    window.key("space");
    C3DE_WAIT(window, "the bar is stretched",
              textOf(s, "measurements/length.label") == "30.00 → 30.60 cm" && s["transport"]["mode"] == "paused");
    window.screenshotAtRest("stretched");
    C3DE_WAIT(window, "the force is in mN", textOf(s, "plots/reactions.support 0.force").find("2666 mN") == 0);
    window.click("plots/csv");
    window.enterFile(csv);
    waitForMessage(window, "preferences_curves.csv");
    CHECK_THAT(fileText(csv), Contains("length [cm]") && Contains("[mN]") && Contains(",2666.4"));
    quit(window);
  }
  CHECK_THAT(fileText(configIn(home)), Contains("theme = \"light\"") && Contains("font_size = 17") &&
                                           Contains("pressure = \"mmHg\"") && Contains("length = \"cm\""));
  // A hand has been at the file.
  std::ofstream(configIn(home), std::ios::app) << "# mine\n[units2]\nx = 1\n";

  WorkstationDriver window("preferences_again");
  openOrgan(window, {scene});
  const Json told = C3DE_WAIT(window, "the unknown key is reported",
                              !notification(s, "Some preferences are not understood").is_null());
  CHECK_THAT(notification(told, "Some preferences are not understood")["text"].get<std::string>(),
             Contains("config.toml:") && Contains("units2.x = 1") && Contains("did you mean 'units'?"));
  C3DE_WAIT(window, "the units are kept", textOf(s, modulus).find("100 mmHg") == 0);
  openPreferences(window);
  const Json kept = window.state();
  CHECK(preference(kept, "theme") == "light");
  CHECK(preference(kept, "font_size") == "17");
  CHECK(preference(kept, "force") == "mN");
  window.click("preferences/restore");
  C3DE_WAIT(window, "the usual values apply",
            preference(s, "theme") == "dark" && preference(s, "font_size") == "14" &&
                textOf(s, modulus).find("kPa") != std::string::npos);
  closeDialog(window);
  CHECK_THAT(fileText(configIn(home)), Contains("# mine\n[units2]\nx = 1\n") && Contains("theme = \"dark\""));
  quit(window);
}

TEST_CASE("folders are remembered and bookmarked, and a rule sets window and level of an image",
          "[preferred_folders]") {
  C3DE_WINDOW_OR_SKIP();
  const fs::path home = freshHome("preferred_folders");
  const ScopedEnvironment user("C3DE_HOME", home.string());
  const fs::path image = imageFile("preferred_folders");
  const fs::path folder = fs::canonical(image.parent_path()) / "preferred";
  fs::create_directories(folder / "deeper");
  fs::copy_file(image, folder / "phantom_lung.nii.gz", fs::copy_options::overwrite_existing);
  {
    WorkstationDriver window("preferred_folders");
    window.start(std::vector<std::string>{});
    openPreferences(window);
    window.click("preferences/add_rule");
    window.click("preferences/rule.0.words");
    window.key("ctrl+a");
    window.type("lung phantom");
    window.key("Tab");
    C3DE_WAIT(window, "it has these words", preference(s, "rule.0.words") == "lung phantom");
    for (const auto &[field, number] : {std::pair{"centre", "-123"}, {"width", "777"}}) {
      window.click(std::string("preferences/rule.0.") + field);
      window.key("ctrl+a");
      window.type(number);
      window.key("Tab");
      C3DE_WAIT(window, "it has the number", preference(s, std::string("rule.0.") + field) == number);
    }
    window.click("preferences/folder");
    window.type((folder / "missing").string());
    window.key("Tab");
    C3DE_WAIT(window, "a missing folder is refused",
              preference(s, "problem").find("there is no such folder") != std::string::npos);
    window.click("preferences/folder");
    window.type(folder.string());
    window.key("Tab");
    C3DE_WAIT(window, "dialogs begin there", fileOfProgram(preference(s, "folder")) == folder);
    window.screenshot("rule");
    closeDialog(window);

    window.key("ctrl+i");
    C3DE_WAIT(window, "the dialog begins there", fileOfProgram(textOf(s, "dialog/folder")) == folder);
    window.click("dialog/bookmark");
    C3DE_WAIT(window, "it is a bookmark", textOf(s, "dialog/bookmarked") == "true");
    window.click("dialog/entry.phantom_lung.nii.gz");
    window.click("dialog/open");
    C3DE_WAIT(window, "the rule applies",
              s["panes"].size() == 4 && imageText(s, "window") == "777" && imageText(s, "level") == "-123");
    quit(window);
  }
  CHECK_THAT(fileText(configIn(home)), Contains("name_contains = \"lung phantom\"") && Contains("bookmarks = [\""));
  WorkstationDriver window("preferred_folders_again");
  window.start(std::vector<std::string>{});
  window.key("ctrl+i");
  C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("dialog/up"));
  window.click("dialog/entry.deeper");
  window.click("dialog/open");
  C3DE_WAIT(window, "another folder is shown", fileOfProgram(textOf(s, "dialog/folder")) == folder / "deeper");
  window.click("dialog/bookmarks");
  window.screenshot("bookmarks");
  window.click("dialog/bookmarks.0");
  C3DE_WAIT(window, "the bookmark is shown", fileOfProgram(textOf(s, "dialog/folder")) == folder);
  window.click("dialog/bookmark");
  C3DE_WAIT(window, "it is no bookmark any more", textOf(s, "dialog/bookmarked") == "false");
  window.click("dialog/up");
  window.click("dialog/recent");
  window.click("dialog/recent.0");
  C3DE_WAIT(window, "the recent folder is shown", fileOfProgram(textOf(s, "dialog/folder")) == folder);
  window.click("dialog/cancel");
  CHECK_THAT(fileText(configIn(home)), Contains("bookmarks = []"));
  quit(window);
}

TEST_CASE("menus open by Alt, arrows and Enter choose, and the list of shortcuts by a question mark", "[keyboard]") {
  C3DE_WINDOW_OR_SKIP();
  const ScopedEnvironment user("C3DE_HOME", freshHome("keyboard").string());
  WorkstationDriver window("keyboard");
  window.start(std::vector<std::string>{});
  window.moveTo(window.inView(0.5, 0.97));
  window.key("question");
  C3DE_WAIT(window, "the shortcuts are shown", s["widgets"].contains("dialog/close"));
  window.screenshotAtRest("shortcuts");
  window.key("Escape");
  C3DE_WAIT(window, "they are closed", !s["widgets"].contains("dialog/close"));

  window.keyDown("alt");
  window.keyUp("alt");
  C3DE_WAIT(window, "the File menu is open", s["widgets"].contains("menu/file.quit"));
  window.screenshotAtRest("file");
  window.key("Right");
  C3DE_WAIT(window, "the Edit menu is open", s["widgets"].contains("menu/edit.preferences"));
  window.key("Up");
  window.screenshotAtRest("edit");
  window.key("Return");
  C3DE_WAIT(window, "its last item has run", s["widgets"].contains("preferences/restore"));
  window.key("Down");
  window.key("Down");
  window.screenshotAtRest("focus_ring");
  window.key("Escape");
  C3DE_WAIT(window, "the dialog is closed", !s["widgets"].contains("preferences/restore"));

  window.key("alt+h");
  C3DE_WAIT(window, "the Help menu is open", s["widgets"].contains("menu/help.about"));
  window.key("Escape");
  C3DE_WAIT(window, "it is closed", !s["widgets"].contains("menu/help.about"));
  // A list in a dialog is closed alone by Escape.
  openPreferences(window);
  window.click("preferences/theme");
  C3DE_WAIT(window, "the list is open", s["widgets"].contains("preferences/theme.option.light"));
  window.key("Escape");
  C3DE_WAIT(window, "the list is closed", !s["widgets"].contains("preferences/theme.option.light"));
  window.waitFrames(3, 0.5);
  CHECK(window.has("preferences/restore"));
  window.click("preferences/theme");
  C3DE_WAIT(window, "the list is open", s["widgets"].contains("preferences/theme.option.light"));
  window.key("Down");
  window.key("Return");
  C3DE_WAIT(window, "arrows and Enter have chosen", preference(s, "theme") == "light");
}

TEST_CASE("Enter on a disabled command keeps the typing and says why it is disabled", "[palette_disabled]") {
  C3DE_WINDOW_OR_SKIP();
  const ScopedEnvironment user("C3DE_HOME", freshHome("palette_disabled").string());
  WorkstationDriver window("palette_disabled");
  window.start(std::vector<std::string>{});
  window.key("ctrl+k");
  C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("palette/words"));
  window.type("export displ");
  C3DE_WAIT(window, "it is found", textOf(s, "palette/chosen") == "file.export_displacement");
  CHECK(textOf(window.state(), "palette/why_not") == "No simulation is open.");
  window.key("Return");
  window.waitFrames(4, 0.5);
  C3DE_WAIT(window, "the field has the keyboard", textOf(s, "palette/typing") == "true");
  window.screenshot("why");
  // What is typed is added to the words.
  window.type("acement voxel");
  C3DE_WAIT(window, "it is still found", textOf(s, "palette/found") == "1");
  window.key("ctrl+a");
  window.type("preferences");
  C3DE_WAIT(window, "another one is found", textOf(s, "palette/chosen") == "edit.preferences");
  window.key("Return");
  C3DE_WAIT(window, "it is run", s["widgets"].contains("preferences/restore"));
}

TEST_CASE("a figure is copied by the program of the desktop, and without one the command says what to install",
          "[copy_figure]") {
  C3DE_WINDOW_OR_SKIP();
  const fs::path home = freshHome("copy_figure");
  const ScopedEnvironment user("C3DE_HOME", home.string()), session("WAYLAND_DISPLAY", "");
  const fs::path image = imageFile("copy_figure"), tools = outputFile("copy_figure_tools");
  fs::remove_all(tools);
  fs::create_directories(tools);
  // In place of xclip: keeps what it is given.
  const fs::path copied = freshFile("copied.png");
  std::ofstream(tools / "xclip")
      << "#!/bin/sh\n[ \"$1 $2 $3 $4 $5\" = \"-selection clipboard -target image/png -in\" ] "
         "|| { echo \"arguments: $*\" >&2; exit 3; }\ncp \"$6\" '"
      << copied.string() << "'\n";
  fs::permissions(tools / "xclip", fs::perms::owner_all);
  {
    const ScopedEnvironment path("PATH", tools.string() + ":" + environmentVariable("PATH"));
    WorkstationDriver window("copy_figure");
    window.start({image.string()});
    C3DE_WAIT(window, "the image is shown", s["panes"].size() == 4 && s["jobs"].empty());
    window.key("ctrl+shift+c");
    waitForMessage(window, "Figure copied");
    const std::string png = fileText(copied);
    CHECK(png.substr(1, 3) == "PNG");
    CHECK(png.find("IEND") == png.size() - 8);
    quit(window);
  }
  if (fs::exists("/usr/bin/xclip")) return;
  WorkstationDriver window("copy_figure_without");
  window.start({image.string()});
  C3DE_WAIT(window, "the image is shown", s["panes"].size() == 4 && s["jobs"].empty());
  window.key("ctrl+k");
  C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("palette/words"));
  window.type("copy figure");
  C3DE_WAIT(window, "it is found", textOf(s, "palette/chosen") == "file.copy_figure");
  CHECK_THAT(textOf(window.state(), "palette/why_not"), Contains("xclip is not installed") && Contains("Save figure"));
  window.screenshot("why");
}
