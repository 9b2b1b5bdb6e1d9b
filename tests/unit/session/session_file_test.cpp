// SPDX-License-Identifier: Apache-2.0
// Session files: what is saved is read, equal content gives equal bytes, what cannot be saved changes nothing.
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#ifndef _WIN32
#include <unistd.h>
#endif

#include "files/zip_archive.h"
#include "files/zip_writer.h"
#include "session_sample.h"
#include "support/file_size_limit.h"

using namespace c3de;
using namespace c3de::session;
using namespace c3de::test;
namespace fs = std::filesystem;

namespace {

std::string saved(const SessionFile &session, const fs::path &file) {
  const auto written = writeSession(session, file);
  INFO((written ? "" : written.error().message));
  REQUIRE(written.has_value());
  return textIn(file);
}

SessionFile loaded(const fs::path &file) {
  auto read = readSession(file);
  INFO((read ? "" : read.error().message));
  REQUIRE(read.has_value());
  return std::move(*read);
}

fs::path withJson(const fs::path &file, const std::string &json) {
  const ZipMember member{"session.json", json};
  return write(file, zipBytes({&member, 1}).value());
}

/// Reason of a session that cannot be saved.
std::string refusedToSave(const SessionFile &session, const fs::path &file) {
  const auto written = writeSession(session, file);
  REQUIRE_FALSE(written.has_value());
  CHECK(written.error().code == ErrorCode::usage);
  CHECK_THAT(written.error().message, Contains(file.filename().string() + ": could not be saved: "));
  CHECK_FALSE(fs::exists(file));
  return written.error().message;
}

#ifndef _WIN32
/// Root may write everywhere.
class OrdinaryUser {
 public:
  OrdinaryUser() : before_(geteuid()) { isSet_ = before_ != 0 || seteuid(65534) == 0; }
  ~OrdinaryUser() {
    if (before_ == 0 && isSet_) isSet_ = seteuid(before_) == 0;
  }
  OrdinaryUser(const OrdinaryUser &) = delete;
  OrdinaryUser &operator=(const OrdinaryUser &) = delete;
  [[nodiscard]] bool isSet() const { return isSet_; }

 private:
  uid_t before_;
  bool isSet_ = false;
};
#endif

}  // namespace

TEST_CASE("A session is read as it was saved") {
  const fs::path folder = emptyFolder();
  saved(fullSession(), folder / "full.c3de");
  CHECK(loaded(folder / "full.c3de") == fullSession());
  saved({}, folder / "empty.c3de");
  CHECK(loaded(folder / "empty.c3de") == SessionFile{});
  CHECK(std::distance(fs::directory_iterator(folder), fs::directory_iterator()) == 2);
}

TEST_CASE("A session with many scenes keeps their order") {
  const fs::path folder = emptyFolder();
  SessionFile session;
  for (int i = 0; i < 12; ++i) session.scenes.push_back("# scene " + std::to_string(i));
  saved(session, folder / "a.c3de");
  CHECK(loaded(folder / "a.c3de").scenes == session.scenes);
}

TEST_CASE("Equal sessions have equal bytes, whenever they are saved") {
  const fs::path folder = emptyFolder();
  const std::string first = saved(fullSession(), folder / "a.c3de");
  CHECK(saved(fullSession(), folder / "b.c3de") == first);
  CHECK(saved(loaded(folder / "a.c3de"), folder / "a.c3de") == first);
  // The first member, without a time of its own: 1 January 1980.
  CHECK(first.substr(0, 4) == "PK\x03\x04");
  CHECK(first.substr(10, 4) == std::string("\0\0\x21\0", 4));
  CHECK(first.substr(30, 12) == "session.json");
}

TEST_CASE("Keys and members that this version does not know are saved again") {
  const fs::path folder = emptyFolder();
  saved(fullSession(), folder / "a.c3de");
  auto members = readZip(folder / "a.c3de").value();
  auto json = nlohmann::json::parse(members.at("session.json"));
  json["later"] = {{"a", {1, 2.5, nullptr}}, {"b", "text"}};
  json["a/b~c"] = true;
  json["view"]["zoom"] = 2;
  json["view"]["camera"]["roll_rad"] = 0.25;
  json["files"][0]["modality"] = "CT";
  members.at("session.json") = json.dump();
  members["later/x"] = "not listed in session.json";
  const auto rewrite = [&](const fs::path &file) {
    std::vector<ZipMember> list;
    for (const auto &[name, bytes] : members) list.push_back({name, bytes});
    write(file, zipBytes(list).value());
  };
  rewrite(folder / "later.c3de");

  SessionFile session = loaded(folder / "later.c3de");
  CHECK(session.unknown == std::map<std::string, std::string>{{"/later", R"({"a":[1,2.5,null],"b":"text"})"},
                                                              {"/a~1b~0c", "true"},
                                                              {"/view/zoom", "2"},
                                                              {"/view/camera/roll_rad", "0.25"},
                                                              {"/files/..~1scans~1ct.nii.gz/modality", R"("CT")"}});
  CHECK(session.members.at("later/x") == "not listed in session.json");
  const std::string bytes = saved(session, folder / "again.c3de");
  CHECK(loaded(folder / "again.c3de") == session);
  CHECK(saved(loaded(folder / "again.c3de"), folder / "again.c3de") == bytes);

  // What they described may be gone, and files may have another order.
  session.files.erase(session.files.begin() + 1);
  std::swap(session.files[0], session.files[1]);
  session.view.camera.reset();
  saved(session, folder / "less.c3de");
  SessionFile less = loaded(folder / "less.c3de");
  CHECK(less.unknown.erase("/files/..~1scans~1ct.nii.gz/modality") == 1);
  CHECK(less.unknown.count("/view/camera/roll_rad") == 0);
  CHECK(less.unknown.count("/view/zoom") == 1);
}

TEST_CASE("Keys that are missing have the values of an empty session") {
  const fs::path folder = emptyFolder();
  CHECK(loaded(withJson(folder / "a.c3de", R"({"format": 1})")) == SessionFile{});
}

TEST_CASE("A session of a newer format is refused with both versions") {
  const fs::path folder = emptyFolder();
  CHECK(refusal(withJson(folder / "a.c3de", R"({"format": 2, "scenes": "of another kind"})")) ==
        (folder / "a.c3de").string() +
            ": session.json: was saved by version 2 of the format; this program reads up to 1");
  CHECK_THAT(refusal(withJson(folder / "a.c3de", R"({})")), Contains("the key format is missing"));
  CHECK_THAT(refusal(withJson(folder / "a.c3de", R"({"format": 0})")), Contains("accepted: a whole number, 1 or more"));
  CHECK_THAT(refusal(withJson(folder / "a.c3de", R"({"format": "1"})")), Contains("the key format is a text"));
}

TEST_CASE("A key of the wrong type is named with what is accepted") {
  const fs::path folder = emptyFolder();
  const std::string file = R"({"path": "a", "sha256": ")" + std::string(64, 'a') + R"(", "bytes": 1)";
  const std::pair<std::string, std::string> cases[] = {
      {R"("program": 1)", "the key program is a number: 1; accepted: a text"},
      {R"("saved_at": null)", "the key saved_at is null: null; accepted: a text"},
      {R"("title": ["a"])", "the key title is a list: of 1 entries; accepted: a text"},
      {R"("simulator": true)", "the key simulator is true or false: true; accepted: a text"},
      {R"("scenes": "a")", "the key scenes is a text: \"a\"; accepted: a list of texts"},
      {R"("overrides": ["a", 1])", "the key overrides is a list: of 2 entries; accepted: a list of texts"},
      {R"("files": {})", "the key files is an object: of 0 entries; accepted: a list"},
      {R"("files": [1])", "the key files[0] is a number; accepted: an object"},
      {R"("files": [{"path": "a"}])", "the key files[0].sha256 is missing"},
      {R"("files": [)" + file + "}, " + file + "}]", "the key files[1].path occurs twice: a"},
      {R"("files": [{"path": "a", "sha256": "x", "bytes": 1}])",
       "the key files[0].sha256 is a text: \"x\"; accepted: a text of 64 digits 0 … 9, a … f"},
      {R"("files": [)" + file + R"(, "embedded": 1}])", "the key files[0].embedded is a number: 1; accepted: true or"},
      {R"("view": [])", "the key view is a list: of 0 entries; accepted: an object"},
      {R"("view": {"image": 1})", "the key view.image is a number: 1; accepted: a text"},
      {R"("view": {"labels": [1]})", "the key view.labels is a list: of 1 entries; accepted: a list of texts"},
      {R"("view": {"cross_hair_mm": [1, 2]})",
       "the key view.cross_hair_mm is a list: of 2 entries; accepted: a list of three"},
      {R"("view": {"window": "1"})", "the key view.window is a text: \"1\"; accepted: a number"},
      {R"("view": {"camera": 1})", "the key view.camera is a number: 1; accepted: an object"},
      {R"("view": {"camera": {"yaw_rad": 1}})", "the key view.camera.focus_mm is missing"},
      {R"("view": {"comparison": 1})", "the key view.comparison is a number: 1; accepted: an object"},
      {R"("view": {"comparison": {"blend": 0.5}})", "the key view.comparison.image is missing"},
      {R"("view": {"comparison": {"image": ""}})", "the key view.comparison.image is empty"},
      {R"("view": {"comparison": {"image": "a", "blend": 2}})", "the key view.comparison.blend is 2; accepted: 0 to 1"},
      {R"("view": {"comparison": {"image": "a", "square_mm": 0}})",
       "the key view.comparison.square_mm is 0; accepted: above 0"},
      {R"("view": {"match": 1})", "the key view.match is a number: 1; accepted: an object"},
      {R"("view": {"match": {"source": "cloud"}})",
       "the key view.match.source is 'cloud'; accepted: points, surface, labels"},
      {R"("view": {"match": {"unit": "km"}})", "the key view.match.unit is 'km'; accepted: m, mm, cm"},
      {R"("view": {"match": {"noise_mm": 0}})", "the key view.match.noise_mm is 0; accepted: above 0"},
      {R"("view": {"comparison": {"image": "a", "rotation_deg": [1, 2, "x"]}})",
       "the key view.comparison.rotation_deg is a list: of 3 entries; accepted: a list of three numbers"},
      {R"("steps": -1)", "the key steps is a number: -1; accepted: a whole number, 0 or more"},
      {R"("steps": 1.5)", "the key steps is a number: 1.5; accepted: a whole number, 0 or more"},
      {R"("time_s": "0")", "the key time_s is a text: \"0\"; accepted: a number"},
      {R"("state_hash": "0x1")", "the key state_hash is a text: \"0x1\"; accepted: a text of 16 digits"},
      {R"("state": 1)", "the key state is a number: 1; accepted: a text"},
      {R"("members": 1)", "the key members is a number: 1; accepted: a list of texts"},
      {R"("time_s": 1e999)", "is no JSON object"},
      {R"("title": "a)", "is no JSON object"},
      {R"("scenes": ["scenes/1.toml"])", "is damaged: the member 'scenes/1.toml' is missing"},
      {R"("state": "state.bin")", "is damaged: the member 'state.bin' is missing"},
      {R"("members": ["session.json"])", "is damaged: the member 'session.json' is missing"},
      {R"("files": [)" + file + R"(, "embedded": true}])",
       "the file a is embedded, but there is no member files/aaaa"}};
  for (const auto &[key, message] : cases) {
    INFO(key);
    CHECK_THAT(refusal(withJson(folder / "a.c3de", R"({"format": 1, )" + key + "}")), Contains(message));
  }
}

TEST_CASE("JSON that is nested very deeply is refused, very many keys are read") {
  const fs::path folder = emptyFolder();
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  CHECK_THAT(refusal(withJson(folder / "a.c3de", R"({"format": 1, "x": )" + deep + "}")),
             Contains("session.json: is nested more than 64 times"));
  CHECK(loaded(withJson(folder / "a.c3de", R"({"format": 1, "title": "[\"[[)" + std::string(100, '[') + "\"}")).title ==
        "[\"[[" + std::string(100, '['));
  // In quadratic time the time limit of the test would end it.
  std::string many = R"({"format": 1)";
  for (int i = 0; i < 50'000; ++i) many += ", \"" + std::to_string(i) + "\": 0";
  CHECK(loaded(withJson(folder / "b.c3de", many + "}")).unknown.size() == 50'000);
  CHECK_THAT(refusal(withJson(folder / "c.c3de", std::string((1 << 24) + 1, ' '))),
             Contains("accepted: up to 16777216"));
}

TEST_CASE("What a session cannot contain is named, and nothing is written") {
  const fs::path file = emptyFolder() / "a.c3de";
  const auto refused = [&](const std::function<void(SessionFile &)> &change) {
    SessionFile session = fullSession();
    change(session);
    return refusedToSave(session, file);
  };
  CHECK_THAT(refused([](SessionFile &s) { s.members["session.json"] = ""; }),
             Contains("the name session.json is that"));
  CHECK_THAT(refused([](SessionFile &s) { s.members["state.bin"] = ""; }), Contains("the name state.bin is that"));
  CHECK_THAT(refused([](SessionFile &s) { s.members["scenes/1.toml"] = ""; }), Contains("scenes/1.toml is that"));
  for (const char *name :
       {"", "/etc/passwd", "../x", "a/../../x", "a//b", "a/", "./a", "C:/x", "a\\b", "a\nb", "\xff"}) {
    INFO(name);
    CHECK_THAT(refused([&](SessionFile &s) { s.members[name] = ""; }), Contains("name"));
  }
  CHECK_THAT(refused([](SessionFile &s) { s.members[std::string(1025, 'x')] = ""; }), Contains("more than 1024 bytes"));
  CHECK_THAT(refused([](SessionFile &s) { s.title = "\xc3\x28"; }), Contains("title is not UTF-8"));
  CHECK_THAT(refused([](SessionFile &s) { s.files[1].path = "\xff"; }), Contains("files.1.path is not UTF-8"));
  CHECK_THAT(refused([](SessionFile &s) { s.time_s = std::numeric_limits<double>::infinity(); }),
             Contains("time_s is not a finite number"));
  CHECK_THAT(refused([](SessionFile &s) { s.view.camera->focus_mm[1] = std::nan(""); }),
             Contains("view.camera.focus_mm.1 is not a finite number"));
  CHECK_THAT(refused([](SessionFile &s) { s.files[0].sha256 = "AB"; }), Contains("the SHA-256 of ../scans/ct.nii.gz"));
  CHECK_THAT(refused([](SessionFile &s) { s.files[1].path = s.files[0].path; }), Contains("occurs twice"));
  CHECK_THAT(refused([](SessionFile &s) { s.members.erase(embeddedName(s.files[2])); }),
             Contains("the file meshes/liver.obj is embedded, but there is no member files/eeee"));
  CHECK_THAT(refused([](SessionFile &s) { s.unknown["/later"] = "{"; }),
             Contains("the unknown key '/later' cannot be"));
  CHECK_THAT(refused([](SessionFile &s) { s.unknown["/title"] = "1"; }),
             Contains("the unknown key '/title' cannot be"));
  CHECK_THAT(refused([](SessionFile &s) { s.unknown["later"] = "1"; }), Contains("the unknown key 'later' cannot be"));
  CHECK_THAT(refused([](SessionFile &s) { s.unknown["/steps/x"] = "1"; }),
             Contains("the unknown key '/steps/x' cannot"));
}

TEST_CASE("A disk that is full leaves the former session") {
  const fs::path folder = emptyFolder(), file = folder / "a.c3de";
  const std::string before = saved({}, file);
  SessionFile large;
  for (std::uint64_t i = 0, x = 1; i < 100'000; ++i)
    large.state += static_cast<char>((x = x * 6364136223846793005ull + 1442695040888963407ull) >> 56);
  {
    const FileSizeLimit limit(50'000);
    if (!limit.isSet()) C3DE_SKIP("the size of files cannot be limited here");
    const auto written = writeSession(large, file);
    REQUIRE_FALSE(written.has_value());
    CHECK(written.error().code == ErrorCode::output);
    CHECK_THAT(written.error().message, Contains("a.c3de: could not be written: File too large"));
  }
  CHECK(textIn(file) == before);
  CHECK(std::distance(fs::directory_iterator(folder), fs::directory_iterator()) == 1);
  CHECK(writeSession(large, file).has_value());
}

TEST_CASE("A device that is full, a folder that is missing and a folder as the name are named") {
  const fs::path folder = emptyFolder();
  const auto reason = [](const fs::path &file) {
    const auto written = writeSession({}, file);
    REQUIRE_FALSE(written.has_value());
    CHECK(written.error().code == ErrorCode::output);
    return written.error().message;
  };
  CHECK_THAT(reason(folder / "none" / "a.c3de"), Contains("cannot be written: there is no folder"));
  CHECK_THAT(reason(folder), Contains("is a folder; accepted: a file name"));
  if (!fs::exists("/dev/full")) C3DE_SKIP("there is no /dev/full");
  CHECK_THAT(reason("/dev/full"), Contains("/dev/full: could not be written: No space left on device"));
}

TEST_CASE("A folder without permission to write is named, and its session stays") {
#ifdef _WIN32
  C3DE_SKIP("folders without permission are those of POSIX");
#else
  // Reachable for every user, unlike the folder of the tests.
  std::string name = (fs::temp_directory_path() / "c3de-sessions-XXXXXX").string();
  REQUIRE(mkdtemp(name.data()) != nullptr);
  const fs::path folder = name, file = folder / "a.c3de";
  const std::string before = saved({}, file);
  fs::permissions(file, fs::perms::all);
  fs::permissions(folder,
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  bool isTried = false;
  Expected<void> written;
  {
    const OrdinaryUser user;
    isTried = user.isSet();
    if (isTried) written = writeSession(fullSession(), file);
  }
  const std::string after = textIn(file);
  fs::permissions(folder, fs::perms::owner_all);
  fs::remove_all(folder);
  if (!isTried) C3DE_SKIP("the test cannot become a user without the rights of root");
  REQUIRE_FALSE(written.has_value());
  CHECK(written.error().code == ErrorCode::output);
  CHECK_THAT(written.error().message, Contains("a.c3de: could not be written: Permission denied"));
  CHECK(after == before);
#endif
}
