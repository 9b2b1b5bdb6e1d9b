// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <set>

#include "c3de/abi/tools.h"
#include "c3de/ui/commands.h"
#include "c3de/ui/file_browser.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;
namespace fs = std::filesystem;

TEST_CASE("no two commands share a key, and every key leads to its command") {
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  std::set<std::string> ids;
  for (const CommandInfo &info : commands()) {
    CHECK(ids.insert(info.id).second);
    CHECK_FALSE(std::string(info.label).empty());
    if (info.key == 0) continue;
    CHECK(seen.insert({info.key, info.modifiers}).second);
    CHECK(commandOfKey(info.key, info.modifiers) == info.command);
    if (info.alternativeKey != 0) CHECK(seen.insert({info.alternativeKey, info.alternativeModifiers}).second);
  }
  CHECK(commandOfKey('Q', 0) == Command::none);
  CHECK(commandOfKey(keyF1, 0) == Command::showShortcuts);
  CHECK(keyText('Q', C3DE_MOD_CTRL) == "Ctrl+Q");
  CHECK(keyText(' ', 0) == "Space");
  CHECK_FALSE(isFreeForTools('F'));
  CHECK_FALSE(isFreeForTools(0));
  CHECK(isFreeForTools('P'));
}

TEST_CASE("the file browser lists folders first and only the files that are accepted") {
  const fs::path root = fs::path(testOutputRoot()) / "browser";
  fs::remove_all(root);
  fs::create_directories(root / "zebra");
  for (const char *name : {"b.obj", "A.STL", "notes.txt", ".hidden.obj"}) std::ofstream(root / name) << "x";
  FileBrowser browser;
  browser.setExtensions("obj; *.stl");
  REQUIRE(browser.open(root));
  REQUIRE(browser.entries().size() == 3);
  CHECK(browser.entries()[0].name == "zebra");
  CHECK(browser.entries()[0].isFolder);
  CHECK(browser.entries()[1].name == "A.STL");
  CHECK(browser.entries()[2].name == "b.obj");
  CHECK(browser.entries()[2].bytes == 1);

  REQUIRE(browser.open(root / "zebra"));
  CHECK(browser.entries().empty());
  REQUIRE(browser.openParent());
  CHECK(browser.entries().size() == 3);
}

TEST_CASE("a file to be written may be new, gets an extension, and needs a folder") {
  const fs::path root = fs::path(testOutputRoot()) / "browser-new";
  fs::create_directories(root / "sub");
  std::ofstream(root / "there.ply") << "x";
  FileBrowser browser;
  browser.setExtensions("obj;stl;ply");
  REQUIRE(browser.open(root));
  const auto created = browser.resolveNew("sub/new.stl");
  REQUIRE(created);
  CHECK_FALSE(created->isFolder);
  CHECK(created->path == fs::weakly_canonical(root / "sub") / "new.stl");
  REQUIRE(browser.resolveNew("plain"));
  CHECK(browser.resolveNew("plain")->path.filename() == "plain.obj");
  CHECK(browser.resolveNew("there.ply"));
  REQUIRE(browser.resolveNew("sub"));
  CHECK(browser.resolveNew("sub")->isFolder);
  const auto other = browser.resolveNew("liver.3ds");
  REQUIRE_FALSE(other);
  CHECK_THAT(other.error().message, Contains("liver.3ds") && Contains(".obj, .stl, .ply"));
  const auto nowhere = browser.resolveNew("absent/liver.obj");
  REQUIRE_FALSE(nowhere);
  CHECK_THAT(nowhere.error().message, Contains("absent"));
  CHECK_FALSE(browser.resolveNew(""));
}

TEST_CASE("a folder that cannot be shown leaves the one that is shown") {
  FileBrowser browser;
  REQUIRE(browser.open(fs::temp_directory_path()));
  const fs::path before = browser.folder();
  const auto refused = browser.open("/nowhere/at/all");
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("/nowhere/at/all"));
  CHECK(browser.folder() == before);
}

TEST_CASE("a typed path is a file, a folder, or an error that says why") {
  const fs::path root = fs::path(testOutputRoot()) / "browser-typed";
  fs::create_directories(root / "sub");
  std::ofstream(root / "sub" / "liver.obj") << "x";
  std::ofstream(root / "notes.txt") << "x";
  FileBrowser browser;
  browser.setExtensions("obj");
  REQUIRE(browser.open(root));
  const auto file = browser.resolve("sub/liver.obj");
  REQUIRE(file);
  CHECK_FALSE(file->isFolder);
  CHECK(fs::equivalent(file->path, root / "sub" / "liver.obj"));
  REQUIRE(browser.resolve("sub"));
  CHECK(browser.resolve("sub")->isFolder);
  CHECK(browser.resolve((root / "sub" / "liver.obj").string()));

  const auto missing = browser.resolve("spleen.obj");
  REQUIRE_FALSE(missing);
  CHECK_THAT(missing.error().message, Contains("spleen.obj"));
  const auto wrongKind = browser.resolve("notes.txt");
  REQUIRE_FALSE(wrongKind);
  CHECK_THAT(wrongKind.error().message, Contains(".obj"));
  CHECK_FALSE(browser.resolve(""));
}

TEST_CASE("sizes are written for people") {
  CHECK(sizeText(0) == "0 B");
  CHECK(sizeText(999) == "999 B");
  CHECK(sizeText(1400) == "1.4 kB");
  CHECK(sizeText(2500000) == "2.5 MB");
  CHECK(sizeText(123456789) == "123 MB");
}

TEST_CASE("Names that are proposed for files take nothing that is there, and are names of files") {
  const fs::path folder = testOutputFolder() / "proposed";
  fs::remove_all(folder);
  fs::create_directories(folder);
  CHECK(freeName(folder, "heart.nrrd") == "heart.nrrd");
  for (const char *name : {"heart.nrrd", "heart-2.nrrd", "u.nii.gz", "plain"}) std::ofstream(folder / name) << 1;
  CHECK(freeName(folder, "heart.nrrd") == "heart-3.nrrd");
  CHECK(freeName(folder, "u.nii.gz") == "u-2.nii.gz");
  CHECK(freeName(folder, "plain") == "plain-2");
  CHECK(freeName(folder, "t-0.400s.stl") == "t-0.400s.stl");
  CHECK(fileNamePart("liver, spleen and stomach") == "liver-spleen-and-stomach");
  CHECK(fileNamePart("../a/b: c?.") == "a-b-c");
  CHECK(fileNamePart("Leber größer") == "Leber-größer");
  CHECK(fileNamePart("///").empty());
}
