// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/recent_files.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/render/png_file.h"
#include "c3de/ui/start_page.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;
namespace fs = std::filesystem;

namespace {

fs::path emptyFolder(const std::string &name) {
  fs::path folder = fs::path(testOutputRoot()) / "recent" / name;
  fs::remove_all(folder);
  fs::create_directories(folder.parent_path());
  return folder;
}

// Entries have absolute paths, which begin with a drive on Windows.
#ifdef _WIN32
constexpr const char *kData = "C:/data";
#else
constexpr const char *kData = "/data";
#endif

RecentFile entry(const std::string &name, std::int64_t openedAt_s = 1'700'000'000) {
  return {{fs::path(kData) / pathFromText(name)}, RecentKind::scan, "", openedAt_s};
}

std::vector<std::string> namesOf(const RecentFiles::Listing &listing) {
  std::vector<std::string> names;
  for (const RecentFile &file : listing.files) names.push_back(nameText(file));
  return names;
}

std::string textOf(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("Recent files are stored, the newest first, and are the same for another process") {
  const fs::path folder = emptyFolder("order");
  RecentFiles files(folder);
  CHECK(files.read().files.empty());
  CHECK_FALSE(files.read().problem);
  CHECK_FALSE(fs::exists(folder));
  RecentFile meshes{
      {fs::path(kData) / "heart.obj", fs::path(kData) / "µ \"x\"\n.stl"}, RecentKind::mesh, "cm", 1'700'000'123};
  REQUIRE_FALSE(files.add(entry("a.nii.gz")).problem);
  REQUIRE_FALSE(files.add(meshes).problem);
  REQUIRE_FALSE(files.add(entry("b.nrrd")).problem);
  CHECK(namesOf(files.add(entry("a.nii.gz", 1'700'000'500))) == Names{"a.nii.gz", "b.nrrd", "heart.obj and 1 more"});
  const RecentFiles::Listing again = RecentFiles(folder).read();
  REQUIRE(again.files.size() == 3);
  CHECK(again.files[0].openedAt_s == 1'700'000'500);
  CHECK(again.files[2].files == meshes.files);
  CHECK(again.files[2].kind == RecentKind::mesh);
  CHECK(again.files[2].meshUnit == "cm");
  CHECK(again.files[2].openedAt_s == meshes.openedAt_s);
  CHECK(namesOf(files.remove(meshes)) == Names{"a.nii.gz", "b.nrrd"});
  CHECK(files.clear().files.empty());
  CHECK(RecentFiles(folder).read().files.empty());
}

TEST_CASE("At most twelve recent files are kept, each with its picture") {
  const fs::path folder = emptyFolder("pictures");
  RecentFiles files(folder);
  const render::Image picture{300, 200, std::vector<std::uint8_t>(3 * 300 * 200, 77)};
  for (int i = 0; i < 14; ++i) {
    (void)files.add(entry(std::to_string(i)));
    CHECK_FALSE(files.setPicture(entry(std::to_string(i)), picture).problem);
  }
  const RecentFiles::Listing listing = files.read();
  REQUIRE(listing.files.size() == kMaxRecentFiles);
  CHECK(nameText(listing.files.front()) == "13");
  CHECK(nameText(listing.files.back()) == "2");
  CHECK_FALSE(fs::exists(files.pictureFile(entry("1"))));
  const auto read = render::readPng(files.pictureFile(entry("2")));
  REQUIRE(read);
  CHECK(read->width == kThumbnailWidth);
  CHECK(read->height == kThumbnailHeight);
  CHECK(read->rgb == std::vector<std::uint8_t>(static_cast<std::size_t>(3 * kThumbnailWidth * kThumbnailHeight), 77));
  // An entry that was removed meanwhile gets none.
  (void)files.remove(entry("2"));
  (void)files.setPicture(entry("2"), picture);
  CHECK_FALSE(fs::exists(files.pictureFile(entry("2"))));
  (void)files.clear();
  CHECK_FALSE(fs::exists(files.pictureFile(entry("13"))));
}

TEST_CASE("Two windows that change the list at the same time lose no entry") {
  const fs::path folder = emptyFolder("two");
  std::vector<std::thread> threads;
  for (int window = 0; window < 2; ++window)
    threads.emplace_back([&folder, window] {
      RecentFiles files(folder);
      for (int i = 0; i < 6; ++i) (void)files.add(entry(std::to_string(window) + "-" + std::to_string(i)));
    });
  for (std::thread &thread : threads) thread.join();
  const RecentFiles::Listing listing = RecentFiles(folder).read();
  CHECK_FALSE(listing.problem);
  CHECK(listing.files.size() == 12);
  for (int window = 0; window < 2; ++window)
    for (int i = 0; i < 6; ++i) {
      const RecentFile wanted = entry(std::to_string(window) + "-" + std::to_string(i));
      CHECK(std::any_of(listing.files.begin(), listing.files.end(),
                        [&](const RecentFile &one) { return one.isSameAs(wanted); }));
    }
}

TEST_CASE("A damaged list that cannot be set aside stays as it is, and that is reported") {
  const fs::path folder = emptyFolder("damaged-stays");
  fs::create_directories(folder / "recent.damaged.json" / "occupied");
  std::ofstream(folder / "recent.json") << "[]";
  RecentFiles files(folder);
  const RecentFiles::Listing added = files.add(entry("b"));
  REQUIRE(added.problem);
  CHECK_THAT(added.problem->message,
             Contains("cannot be kept as recent.damaged.json") && Contains("The list is not written."));
  CHECK(textOf(folder / "recent.json") == "[]");
  fs::remove_all(folder / "recent.damaged.json");
  // The change is not forgotten.
  (void)files.add(entry("c"));
  CHECK(textOf(folder / "recent.damaged.json") == "[]");
  CHECK(RecentFiles(folder).read().files.size() == 2);
}

TEST_CASE("A damaged list is reported and set aside, and readable entries are kept") {
  const fs::path folder = emptyFolder("damaged");
  fs::create_directories(folder);
  const std::string file = R"({"files": [")" + std::string(kData) + R"(/a.nii"], "kind": )";
  const std::string good = file + R"("scan", "opened_at": "2026-11-28T10:00:00Z"})";
  const std::pair<std::string, std::size_t> cases[] = {
      {"{\"format\": 1, \"files\": [" + good, 0},
      {"", 0},
      {"[]", 0},
      {R"({"format": "1"})", 0},
      {R"({"format": 1})", 0},
      {"{\"format\": 1, \"files\": [" + good + ", {\"files\": []}]}", 1},
      {"{\"format\": 1, \"files\": [" + good + R"(, {"files": ["x"], "kind": "scan"}]})", 1},
      {"{\"format\": 1, \"files\": [" + good + ", " + file + R"("film", "opened_at": "2026-11-28T10:00:00Z"}]})", 1},
      {"{\"format\": 1, \"files\": [" + good + ", " + file + R"("scan", "opened_at": "2026-13-28T10:00:00Z"}]})", 1}};
  for (const auto &[text, readable] : cases) {
    CAPTURE(text);
    fs::remove(folder / "recent.damaged.json");
    std::ofstream(folder / "recent.json") << text;
    RecentFiles files(folder);
    const RecentFiles::Listing listing = files.read();
    REQUIRE(listing.problem);
    CHECK_THAT(listing.problem->message, Contains("recent.json") && Contains("damaged"));
    CHECK(listing.files.size() == readable);
    CHECK(textOf(folder / "recent.json") == text);
    const RecentFiles::Listing added = files.add(entry("b"));
    REQUIRE(added.problem);
    CHECK_THAT(added.problem->message, Contains("recent.damaged.json"));
    CHECK(added.files.size() == readable + 1);
    CHECK(textOf(folder / "recent.damaged.json") == text);
    CHECK_FALSE(files.read().problem);
    CHECK(files.read().files.size() == readable + 1);
  }
}

TEST_CASE("A list of a newer format is kept as it is") {
  const fs::path folder = emptyFolder("newer");
  fs::create_directories(folder);
  const std::string text = R"({"format": 2, "entries": []})";
  std::ofstream(folder / "recent.json") << text;
  RecentFiles files(folder);
  const RecentFiles::Listing added = files.add(entry("a"));
  REQUIRE(added.problem);
  CHECK_THAT(added.problem->message, Contains("newer format 2"));
  CHECK(namesOf(added) == Names{"a"});
  CHECK(textOf(folder / "recent.json") == text);
}

TEST_CASE("Where the list cannot be written it lasts as long as the window, and is written later") {
  const fs::path folder = emptyFolder("unwritable");
  std::ofstream(folder) << "a file where the folder would be";
  RecentFiles files(folder);
  const RecentFiles::Listing first = files.add(entry("a"));
  REQUIRE(first.problem);
  CHECK(first.problem->code == ErrorCode::output);
  CHECK_THAT(first.problem->message, Contains(pathText(folder)));
  CHECK(namesOf(files.add(entry("b"))) == Names{"b", "a"});
  CHECK(namesOf(files.remove(entry("b"))) == Names{"a"});
  CHECK(namesOf(files.read()) == Names{"a"});
  fs::remove(folder);
  CHECK_FALSE(files.add(entry("c")).problem);
  CHECK(namesOf(RecentFiles(folder).read()) == Names{"c", "a"});
}

TEST_CASE("A list that another program has locked for long is reported") {
  const fs::path folder = emptyFolder("locked");
  RecentFiles files(folder);
  (void)files.add(entry("a"));
  const auto held = FileLock::take(folder / "recent.lock", "held by a test");
  REQUIRE(held);
  const RecentFiles::Listing listing = files.add(entry("b"));
  REQUIRE(listing.problem);
  CHECK_THAT(listing.problem->message, Contains("recent.lock"));
  CHECK(namesOf(listing) == Names{"b", "a"});
  CHECK(namesOf(RecentFiles(folder).read()) == Names{"a"});
}

TEST_CASE("A picture is reduced from its middle part by averaging") {
  render::Image picture{8, 2, {}};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 8; ++x)
      for (int c = 0; c < 3; ++c) picture.rgb.push_back(static_cast<std::uint8_t>(10 * x + 100 * y));
  // Columns 3 and 4, of both rows.
  const render::Image one = reducedPicture(picture, 1, 1);
  REQUIRE(one.rgb.size() == 3);
  CHECK(one.rgb[0] == (30 + 40 + 130 + 140) / 4);
  const render::Image larger = reducedPicture({1, 1, {1, 2, 3}}, 2, 2);
  CHECK(larger.rgb == std::vector<std::uint8_t>{1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3});
  CHECK(reducedPicture({}, 4, 4).rgb.empty());
}

TEST_CASE("An entry is missing if one of its files is, and its texts name it") {
  const fs::path folder = emptyFolder("texts");
  fs::create_directories(folder);
  std::ofstream(folder / "a.obj") << "x";
  CHECK_FALSE(RecentFile{{folder / "a.obj"}, RecentKind::mesh, "", 0}.isMissing());
  CHECK(RecentFile{{folder / "a.obj", folder / "b.obj"}, RecentKind::mesh, "", 0}.isMissing());
  CHECK(nameText(RecentFile{{"/data/series/"}, RecentKind::dicomFolder, "", 0}) == "series");
  CHECK(nameText(RecentFile{{"/"}, RecentKind::dicomFolder, "", 0}) == "/");
  CHECK(std::string(kindText(RecentKind::dicomFolder)) == "DICOM folder");
  CHECK(dateText(entry("a")).size() == 16);
}

TEST_CASE("Arrow keys move the mark inside the grid") {
  CHECK(nextCell(0, 7, 3, GridStep::left) == 0);
  CHECK(nextCell(0, 7, 3, GridStep::right) == 1);
  CHECK(nextCell(2, 7, 3, GridStep::down) == 5);
  CHECK(nextCell(5, 7, 3, GridStep::down) == 5);
  CHECK(nextCell(5, 7, 3, GridStep::up) == 2);
  CHECK(nextCell(1, 7, 3, GridStep::up) == 1);
  CHECK(nextCell(6, 7, 3, GridStep::right) == 6);
}
