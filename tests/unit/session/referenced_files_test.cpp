// SPDX-License-Identifier: Apache-2.0
// Files that a session refers to: their hashes, and finding them again.
#include <algorithm>
#include <vector>

#include "session_sample.h"

using namespace c3de;
using namespace c3de::session;
using namespace c3de::test;
namespace fs = std::filesystem;
using State = FoundFile::State;

namespace {

std::string hashOf(const fs::path &path) {
  const auto hash = sha256Of(path);
  INFO((hash ? "" : hash.error().message));
  REQUIRE(hash.has_value());
  return *hash;
}

/// A folder with a session's folder `case` and an image beside it.
struct Case {
  fs::path folder = emptyFolder() / "case", image = folder.parent_path() / "scans" / "ct.nii";
  SessionFile session;
  Case() {
    fs::create_directories(folder);
    fs::create_directories(image.parent_path());
    write(image, "voxels");
    session.files.push_back(referenceTo(image, folder).value());
  }
  [[nodiscard]] FoundFile found() const {
    const auto files = findFiles(session, folder);
    REQUIRE(files.has_value());
    REQUIRE(files->size() == 1);
    CHECK(files->front().file == session.files.front());
    return files->front();
  }
};

}  // namespace

TEST_CASE("SHA-256 is that of FIPS 180-4") {
  const fs::path folder = emptyFolder();
  CHECK(hashOf(write(folder / "empty", "")) == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(hashOf(write(folder / "abc", "abc")) == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(hashOf(write(folder / "two blocks", "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")) ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  CHECK(hashOf(write(folder / "million", std::string(1'000'000, 'a'))) ==
        "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("The hash of a folder is that of the list of its files, as sha256sum prints it") {
  const fs::path folder = emptyFolder() / "series";
  fs::create_directories(folder / "b");
  write(folder / "c", "abc");
  write(folder / "b" / "a", "");
  // printf '%s\n' "e3b0…b855  b/a" "ba78…15ad  c" | sha256sum
  const std::string list =
      "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  b/a\n"
      "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  c\n";
  CHECK(hashOf(folder) == hashOf(write(folder.parent_path() / "list", list)));
  const std::string before = hashOf(folder);
  fs::rename(folder / "c", folder / "d");
  CHECK(hashOf(folder) != before);
}

TEST_CASE("A file that cannot be hashed is named") {
  const fs::path folder = emptyFolder();
  const auto hash = sha256Of(folder / "none");
  REQUIRE_FALSE(hash.has_value());
  CHECK(hash.error().code == ErrorCode::input);
  CHECK_THAT(hash.error().message, Contains("none: no such file"));
  if (!fs::exists("/dev/zero")) C3DE_SKIP("there is no /dev/zero");
  CHECK_THAT(sha256Of("/dev/zero").error().message, Contains("is a device, not a file"));
}

TEST_CASE("Hashing reports its progress and can be cancelled") {
  const fs::path file = write(emptyFolder() / "large", std::string(5'000'000, 'x'));
  std::vector<double> fractions;
  REQUIRE(sha256Of(file, [&](double fraction, const std::string &what) {
            CHECK(what == "Checking large");
            fractions.push_back(fraction);
            return true;
          }).has_value());
  CHECK(fractions.size() >= 5);
  CHECK(std::is_sorted(fractions.begin(), fractions.end()));
  CHECK(fractions.back() == 1.0);
  const auto cancelled = sha256Of(file, [](double, const std::string &) { return false; });
  REQUIRE_FALSE(cancelled.has_value());
  CHECK(cancelled.error().code == ErrorCode::cancelled);
}

TEST_CASE("References are relative to the folder of the session, with forward slashes") {
  const Case one;
  CHECK(one.session.files.front() == ReferencedFile{"../scans/ct.nii", hashOf(one.image), 6, false});
  CHECK(referenceTo(one.image.parent_path() / "", one.folder)->path == "../scans");
  CHECK(referenceTo(one.image.parent_path(), one.folder)->bytes == 6);
  CHECK_FALSE(referenceTo(one.folder / "none", one.folder).has_value());
}

TEST_CASE("A file is found by its path while it is the same") {
  const Case one;
  CHECK(one.found().state == State::same);
  CHECK(fs::equivalent(one.found().at, one.image));
  // Both moved together.
  fs::rename(one.folder.parent_path() / "scans", one.folder / "scans");
  fs::create_directories(one.folder / "case");
  CHECK(findFiles(one.session, one.folder / "case")->front().state == State::same);
}

TEST_CASE("A file that has moved beside the session is found by its name") {
  const Case one;
  fs::rename(one.image, one.folder / "ct.nii");
  CHECK(one.found().state == State::same);
  CHECK(fs::equivalent(one.found().at, one.folder / "ct.nii"));
  // One with another content at the former place does not hide it.
  write(one.image, "others");
  CHECK(fs::equivalent(one.found().at, one.folder / "ct.nii"));
}

TEST_CASE("A file that has changed or is missing is reported") {
  const Case one;
  for (const char *content : {"voxelz", "longer voxels", ""}) {
    write(one.image, content);
    CHECK(one.found().state == State::changed);
    CHECK(fs::equivalent(one.found().at, one.image));
  }
  write(one.folder / "ct.nii", "another");
  CHECK(fs::equivalent(one.found().at, one.image));
  fs::remove(one.image);
  CHECK(one.found().state == State::changed);
  CHECK(fs::equivalent(one.found().at, one.folder / "ct.nii"));
  fs::remove(one.folder / "ct.nii");
  CHECK(one.found().state == State::missing);
  CHECK(one.found().at.empty());
}

TEST_CASE("A folder of an image is found, and a changed file in it noticed") {
  Case one;
  fs::create_directories(one.folder / "series");
  write(one.folder / "series" / "IM0001", "slice");
  one.session.files = {referenceTo(one.folder / "series", one.folder).value()};
  CHECK(one.session.files.front().path == "series");
  CHECK(one.found().state == State::same);
  write(one.folder / "series" / "IM0001", "sliCe");
  CHECK(one.found().state == State::changed);
  write(one.folder / "series" / "IM0002", "slice");
  CHECK(one.found().state == State::changed);
}

TEST_CASE("An embedded file is the same without a file, and finding files can be cancelled") {
  Case one;
  one.session.files.push_back({"gone.obj", std::string(64, 'a'), 1, true});
  const auto files = findFiles(one.session, one.folder);
  REQUIRE(files.has_value());
  REQUIRE(files->size() == 2);
  CHECK(files->at(1).state == State::same);
  CHECK(files->at(1).at.empty());
  const auto cancelled = findFiles(one.session, one.folder, [](double, const std::string &) { return false; });
  REQUIRE_FALSE(cancelled.has_value());
  CHECK(cancelled.error().code == ErrorCode::cancelled);
}
