// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/output_file.h"

#ifdef __linux__
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

#include <array>
#include <fstream>
#include <iterator>
#include <string>

#include "support/catch.h"
#include "support/file_size_limit.h"

namespace {

namespace fs = std::filesystem;
using namespace c3de;

std::string textIn(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

fs::path write(const fs::path &file, const std::string &text) {
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

std::size_t filesIn(const fs::path &folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

fs::path emptyFolder() {
  const fs::path folder = testOutputFolder();
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

Expected<void> check(const std::vector<fs::path> &outputs, const std::vector<fs::path> &inputs = {}) {
  return checkOutputs(outputs, inputs);
}

}  // namespace

TEST_CASE("A file takes its place when it is whole, and leaves nothing else behind") {
  const fs::path folder = emptyFolder(), file = write(folder / "a.json", "before");
  {
    auto out = OutputFile::open(file);
    REQUIRE(out.has_value());
    out->write("half");
    CHECK(textIn(file) == "before");
    CHECK(filesIn(folder) <= 2);
  }
  CHECK(textIn(file) == "before");
  CHECK(filesIn(folder) == 1);
  // A file of that name may belong to the user.
  write(folder / "a.json.part", "mine");
  REQUIRE(writeWholeFile(file, "after").has_value());
  CHECK(textIn(file) == "after");
  CHECK(textIn(folder / "a.json.part") == "mine");
  CHECK(filesIn(folder) == 2);
}

TEST_CASE("What is written when the program is killed leaves nothing behind") {
#ifdef __linux__
  const fs::path folder = emptyFolder(), file = write(folder / "a.json", "before");
  const int unnamed = open(folder.c_str(), O_TMPFILE | O_WRONLY, 0600);
  if (unnamed < 0) C3DE_SKIP("this disk has no files without a name");
  close(unnamed);
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    auto out = OutputFile::open(file);
    if (out) out->write(std::string(100000, 'x'));
    raise(SIGKILL);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  CHECK(textIn(file) == "before");
  CHECK(filesIn(folder) == 1);
#else
  C3DE_SKIP("files without a name are those of Linux");
#endif
}

TEST_CASE("A disk that is full is named as the reason, and what was there stays") {
  const fs::path folder = emptyFolder(), file = write(folder / "a.png", "before");
  const std::string large(100000, 'x');
  {
    const FileSizeLimit limit(50000);
    if (!limit.isSet()) C3DE_SKIP("the size of files cannot be limited here");
    const auto written = writeWholeFile(file, large);
    REQUIRE_FALSE(written.has_value());
    CHECK(written.error().code == ErrorCode::output);
    CHECK_THAT(written.error().message, Contains("a.png: could not be written: File too large"));
  }
  CHECK(textIn(file) == "before");
  CHECK(filesIn(folder) == 1);
  CHECK(writeWholeFile(file, large).has_value());
}

TEST_CASE("A device that is full is named as the reason, and is not replaced by a file") {
  if (!fs::exists("/dev/full")) C3DE_SKIP("there is no /dev/full");
  const auto written = writeWholeFile("/dev/full", "text");
  REQUIRE_FALSE(written.has_value());
  CHECK_THAT(written.error().message, Contains("/dev/full: could not be written: No space left on device"));
  CHECK(fs::is_character_file("/dev/full"));
}

TEST_CASE("Rows are whole whatever happens") {
  const fs::path folder = emptyFolder(), file = folder / "rows.csv";
  const std::string row = "0.123456789,1,2,3\n";
  {
    const FileSizeLimit limit(1000);
    if (!limit.isSet()) C3DE_SKIP("the size of files cannot be limited here");
    auto rows = OutputRows::open(file);
    REQUIRE(rows.has_value());
    Expected<void> added;
    while (added && fs::file_size(file) <= 1000) added = rows->add(row);
    REQUIRE_FALSE(added.has_value());
    CHECK_THAT(added.error().message, Contains("File too large"));
    CHECK_FALSE(rows->add(row).has_value());
  }
  CHECK(fs::file_size(file) == 1000 / row.size() * row.size());
  auto rows = OutputRows::open(file);
  REQUIRE(rows.has_value());
  REQUIRE(rows->add(row).has_value());
  CHECK(textIn(file) == row);  // before it is closed
  CHECK(rows->close().has_value());
}

TEST_CASE("A link is followed, and stays a link") {
  const fs::path folder = emptyFolder();
  std::error_code code;
  fs::create_symlink("target.json", folder / "link.json", code);
  if (code) C3DE_SKIP("links cannot be made here: " + code.message());
  REQUIRE(writeWholeFile(folder / "link.json", "text").has_value());
  CHECK(fs::is_symlink(folder / "link.json"));
  CHECK(textIn(folder / "target.json") == "text");
}

TEST_CASE("Two names of one file are refused however they are spelt") {
  const fs::path folder = emptyFolder(), input = write(folder / "scene.toml", "format = 1");
  fs::create_directories(folder / "sub");
  CHECK(check({folder / "a", {}, folder / "b"}, {input, {}}).has_value());
  std::vector<std::array<fs::path, 2>> same{{folder / "a", folder / "." / "a"},
                                            {folder / "a", folder / "sub" / ".." / "a"}};
  std::error_code code;
  fs::create_symlink("nowhere", folder / "link", code);
  if (!code) same.push_back({folder / "nowhere", folder / "link"});
  fs::create_directory_symlink("sub", folder / "folder-link", code);
  if (!code) same.push_back({folder / "sub" / "x", folder / "folder-link" / "x"});
  write(folder / "one", "");
  fs::create_hard_link(folder / "one", folder / "two", code);
  if (!code) same.push_back({folder / "one", folder / "two"});
  // On file systems that ignore case, the system reports the conflict.
  write(folder / "capital", "");
  if (fs::exists(folder / "CAPITAL")) same.push_back({folder / "new", folder / "NEW"});
  for (const auto &pair : same) {
    const auto result = check({pair[0], pair[1]});
    INFO(pair[0] << " and " << pair[1]);
    REQUIRE_FALSE(result.has_value());
    CHECK(result.error().code == ErrorCode::usage);
    CHECK_THAT(result.error().message, Contains("is named for two outputs"));
  }
  fs::create_symlink("scene.toml", folder / "scene-link", code);
  for (const fs::path &output : {input, folder / "sub" / ".." / "scene.toml", folder / "scene-link"}) {
    if (!fs::exists(output)) continue;
    const auto result = check({output}, {input});
    REQUIRE_FALSE(result.has_value());
    CHECK_THAT(result.error().message, Contains("is read by this run") && Contains("would be lost"));
  }
  CHECK(textIn(input) == "format = 1");
  CHECK_FALSE(fs::exists(folder / "nowhere"));
  CHECK_FALSE(fs::exists(folder / "a"));
}

TEST_CASE("What lies in a folder that is read is kept, and a new file may be beside it") {
  const fs::path folder = emptyFolder();
  write(folder / "IM0001", "slice");
  const auto result = check({folder / "IM0001"}, {folder});
  REQUIRE_FALSE(result.has_value());
  CHECK_THAT(result.error().message, Contains("in the folder"));
  CHECK(check({folder / "report.json"}, {folder}).has_value());
  CHECK(filesIn(folder) == 1);
}

TEST_CASE("Folders and files in no folder are refused with the reason") {
  const fs::path folder = emptyFolder();
  const auto absent = check({folder / "absent" / "a.json"}), isFolder = check({folder});
  REQUIRE_FALSE(absent.has_value());
  REQUIRE_FALSE(isFolder.has_value());
  CHECK(absent.error().code == ErrorCode::output);
  CHECK_THAT(absent.error().message, Contains("there is no folder"));
  CHECK_THAT(isFolder.error().message, Contains("is a folder; accepted: a file name"));
  CHECK_FALSE(OutputFile::open(folder).has_value());
  CHECK_FALSE(writeWholeFile(folder / "absent" / "a.json", "").has_value());
}
