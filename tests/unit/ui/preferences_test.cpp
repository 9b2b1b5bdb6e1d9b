// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/preferences.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include "c3de/core/path_text.h"
#include "logic/config_text.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;
namespace fs = std::filesystem;

namespace {

fs::path freshFile(const std::string &name) {
  const fs::path folder = fs::path(testOutputRoot()) / "preferences" / name;
  std::error_code ignored;
  fs::permissions(folder, fs::perms::owner_all, fs::perm_options::add, ignored);
  fs::remove_all(folder);
  return folder / "config.toml";
}

std::string textOf(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write(const fs::path &file, const std::string &text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

Preferences changed() {
  Preferences one;
  one.theme = ThemeKind::light;
  one.fontSize_px = 17.5;
  one.units = {DisplayUnits::Length::cm, DisplayUnits::Pressure::mmHg, DisplayUnits::Force::mN};
  one.folder = "/data/scans \"A\"\\µ";
  one.bookmarks = {"/data/a", "/data/b, c"};
  one.recentFolders = {"/data/r]"};
  one.autosave_s = 30.0;
  one.windowLevels = {{"CT thorax lung", -600.0, 1500.0}, {"CT", 40.0, 400.0}};
  return one;
}

}  // namespace

TEST_CASE("preferences are written and read again, and a missing file has the usual values") {
  const fs::path file = freshFile("round");
  CHECK(readPreferences(file).values == Preferences());
  CHECK(readPreferences(file).problems.empty());
  CHECK_FALSE(fs::exists(file.parent_path()));
  REQUIRE(writePreferences(file, {}, changed()));
  const ReadPreferences read = readPreferences(file);
  CHECK(read.problems.empty());
  CHECK(read.values == changed());
  CHECK_THAT(textOf(file), Contains("[units]\nlength = \"cm\"\npressure = \"mmHg\"\nforce = \"mN\"\n"));
  REQUIRE(writePreferences(file, changed(), usualPreferences(changed())));
  const Preferences usual = readPreferences(file).values;
  CHECK(usual.bookmarks == changed().bookmarks);
  CHECK(usual.recentFolders == changed().recentFolders);
  CHECK(usual.windowLevels.empty());
  CHECK(usual.theme == ThemeKind::dark);
  CHECK(usual.fontSize_px == Preferences::kUsualFont);
}

TEST_CASE("a change leaves comments, unknown keys and every other line of the file as they are") {
  const fs::path file = freshFile("kept");
  const std::string text =
      "# mine\r\n[appearance]  # how it looks\ntheme = 'light'   # bright room\nsparkle = [1, 2,\n  3]\n\n"
      "[future]\nthing = { a = 1 }\nnonsense\n\n"
      "# for the lungs\n[[window_level]]\nname_contains = \"lung\" # all\ncentre = -600\nwidth = 1_500\nnote = "
      "\"x\"\n\n"
      "# the last\n[[window_level]]\nname_contains = \"liver\"\ncentre = 80\nwidth = 160";
  write(file, text);
  const Preferences before = readPreferences(file).values;
  CHECK(before.theme == ThemeKind::light);
  REQUIRE(before.windowLevels.size() == 2);
  CHECK(before.windowLevels[0] == WindowLevelRule{"lung", -600.0, 1500.0});
  REQUIRE(writePreferences(file, before, before));
  CHECK(textOf(file) == text);

  Preferences after = before;
  after.theme = ThemeKind::dark;
  after.fontSize_px = 20.0;
  after.windowLevels[0].width = 1600.0;
  after.windowLevels.push_back({"bone", 400.0, 2000.0});
  REQUIRE(writePreferences(file, before, after));
  CHECK(readPreferences(file).values == after);
  std::string expected = text + "\n\n[[window_level]]\nname_contains = \"bone\"\ncentre = 400\nwidth = 2000\n";
  expected.replace(expected.find("'light'"), 7, "\"dark\"");
  expected.replace(expected.find("1_500"), 5, "1600");
  expected.insert(expected.find("  3]\n") + 5, "font_size = 20\n");
  CHECK(textOf(file) == expected);

  // The comment above a rule that is removed, and the rule after it, stay.
  Preferences less = after;
  less.windowLevels.erase(less.windowLevels.begin());
  REQUIRE(writePreferences(file, after, less));
  CHECK(readPreferences(file).values == less);
  CHECK_THAT(textOf(file), Contains("# for the lungs") && Contains("# the last\n[[window_level]]") &&
                               Contains("nonsense") && !Contains("1600"));
}

TEST_CASE("what another program has written since is kept where it concerns other keys") {
  const fs::path file = freshFile("other");
  const Preferences mine = readPreferences(file).values;
  Preferences theirs = mine;
  theirs.units.force = DisplayUnits::Force::mN;
  REQUIRE(writePreferences(file, mine, theirs));
  Preferences after = mine;
  after.theme = ThemeKind::light;
  REQUIRE(writePreferences(file, mine, after));
  CHECK(readPreferences(file).values.units.force == DisplayUnits::Force::mN);
  CHECK(readPreferences(file).values.theme == ThemeKind::light);
}

TEST_CASE("a bad line is reported with file, line, value and what is accepted, and the rest applies") {
  const fs::path file = freshFile("bad");
  write(file,
        "theme = \"light\"\n"
        "[appearance]\ntheme = \"lihgt\"\nfont_size = 99\nfont_szie = 12\n"
        "[unit]\nlength = \"cm\"\n"
        "[units]\nforce = \"mN\"\npressure = mmHg\nlength =\nforce = \"N\"\n"
        "[files]\nbookmarks = \"/a\"\nfolder = \"/open\n"
        "[[window_level]]\nname_contains = \"x\"\ncentre = 1\nwidth = 0\n"
        "[[window_level]]\nname_contains = \"y\"\ncentre = 1\n"
        "[broken\n");
  const ReadPreferences read = readPreferences(file);
  Preferences expected;
  expected.units.force = DisplayUnits::Force::mN;
  CHECK(read.values == expected);
  const auto has = [&](int line, const std::vector<std::string> &parts) {
    const std::string begin = pathText(file) + ":" + std::to_string(line) + ": ";
    INFO("line " << line);
    const auto found = std::find_if(read.problems.begin(), read.problems.end(),
                                    [&](const std::string &one) { return one.starts_with(begin); });
    REQUIRE(found != read.problems.end());
    for (const std::string &part : parts) CHECK_THAT(*found, Contains(part));
  };
  has(1, {"theme = \"light\"", "[appearance]"});
  has(3, {"appearance.theme = \"lihgt\"", "\"dark\", \"light\"", "did you mean \"light\"?"});
  has(4, {"appearance.font_size = 99", "10 to 28"});
  has(5, {"font_szie", "did you mean 'font_size'?", "theme, font_size"});
  has(7, {"unit.length", "did you mean 'units'?", "[units]"});
  has(10, {"units.pressure = mmHg", "\"kPa\", \"mmHg\", \"Pa\""});
  has(11, {"length =", "the value is missing"});
  has(12, {"given twice", "line 9"});
  has(14, {"files.bookmarks = \"/a\"", "a list of folders"});
  has(15, {"folder", "a quotation mark or bracket is missing"});
  has(19, {"window_level.width = 0", "above 0"});
  has(20, {"width is missing"});
  has(23, {"[broken", "not a header"});
  CHECK(read.problems.size() == 13);

  // A change of something else leaves all of it; restoring the usual values mends known keys only.
  const std::string text = textOf(file);
  Preferences after = read.values;
  after.autosave_s = 20.0;
  REQUIRE(writePreferences(file, read.values, after));
  CHECK(textOf(file) == text + "\n[autosave]\ninterval_s = 20\n");
  REQUIRE(writePreferences(file, after, usualPreferences(after), true));
  CHECK_THAT(textOf(file), Contains("theme = \"dark\"") && Contains("font_size = 14") && Contains("font_szie = 12") &&
                               Contains("[broken") && Contains("folder = \"/open\n"));
}

TEST_CASE("preferences that cannot be written or read are an error and leave the file") {
  const fs::path file = freshFile("unwritable");
  write(file.parent_path(), "a file where the folder would be");
  const auto refused = writePreferences(file, {}, changed());
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::output);
  CHECK_THAT(refused.error().message, Contains(pathText(file.parent_path())));

  const fs::path folder = freshFile("folder");
  fs::create_directories(folder);
  const ReadPreferences read = readPreferences(folder);
  CHECK(read.values == Preferences());
  REQUIRE(read.problems.size() == 1);
  CHECK_THAT(read.problems[0], Contains(pathText(folder)));
  CHECK_FALSE(writePreferences(folder, {}, changed()));
  CHECK(fs::is_directory(folder));

  const fs::path large = freshFile("large");
  write(large, std::string(std::size_t{2} << 20, '#'));
  CHECK(readPreferences(large).problems.size() == 1);
  CHECK_FALSE(writePreferences(large, {}, changed()));
  CHECK(fs::file_size(large) == std::size_t{2} << 20);
}

TEST_CASE("values are read as they are written, and others are refused") {
  for (const std::string &text : {std::string("a \"b\" \\ µ\t\n"), std::string(), std::string(1, '\x1f')}) {
    CHECK(stringOf(quotedValue(text)) == text);
    CHECK(stringsOf(listValue({text, "second"})) == std::vector<std::string>{text, "second"});
  }
  CHECK(stringOf("\"\\u00B5\\U0001F600\"") == "µ😀");
  CHECK(stringOf("'C:\\new'") == "C:\\new");
  CHECK_FALSE(stringOf("\"\\q\""));
  CHECK_FALSE(stringOf("\"\\uD800\""));
  CHECK_FALSE(stringOf("\"\\u00\""));
  CHECK_FALSE(stringOf("plain"));
  CHECK(numberOf("1_000.5") == 1000.5);
  CHECK(numberOf("+3") == 3.0);
  CHECK_FALSE(numberOf("3 px"));
  CHECK_FALSE(numberOf("inf"));
  CHECK_FALSE(numberOf(""));
  CHECK(stringsOf("[\n  \"a\", # first\n  'b',\n]") == std::vector<std::string>{"a", "b"});
  CHECK(stringsOf("[]")->empty());
  CHECK_FALSE(stringsOf("[\"a\" \"b\"]"));
  CHECK_FALSE(stringsOf("[1]"));
}

TEST_CASE("the first window level rule whose words are in the name of the image applies") {
  const std::vector<WindowLevelRule> rules{{"CT lung", -600.0, 1500.0}, {"CT", 40.0, 400.0}};
  const auto lung = windowLevelFor(rules, "CT Thorax LUNG 1.0 patient.dcm");
  REQUIRE(lung);
  CHECK(lung->window == 1500.0);
  CHECK(lung->level == -600.0);
  CHECK(windowLevelFor(rules, "CT abdomen")->window == 400.0);
  CHECK_FALSE(windowLevelFor(rules, "MR T1"));
}

TEST_CASE("recent folders have the latest first, each once, and an end") {
  Preferences one;
  for (int i = 0; i < 20; ++i) one.addRecentFolder("/" + std::to_string(i));
  one.addRecentFolder("/15");
  REQUIRE(one.recentFolders.size() == Preferences::kMostFolders);
  CHECK(one.recentFolders[0] == "/15");
  CHECK(one.recentFolders[1] == "/19");
  CHECK(std::count(one.recentFolders.begin(), one.recentFolders.end(), "/15") == 1);
}
