// SPDX-License-Identifier: Apache-2.0
// Session files that are truncated, damaged or hostile are refused with their name, or read as they were saved.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "files/zip_archive.h"
#include "files/zip_writer.h"
#include "session_sample.h"

using namespace c3de;
using namespace c3de::session;
using namespace c3de::test;
namespace fs = std::filesystem;

namespace {

std::string replaced(std::string bytes, const std::string &from, const std::string &to) {
  REQUIRE(from.size() == to.size());
  std::size_t count = 0;
  for (std::size_t at = bytes.find(from); at != std::string::npos; at = bytes.find(from, at + 1), ++count)
    bytes.replace(at, to.size(), to);
  REQUIRE(count == 2);  // before the member, and in the list at the end
  return bytes;
}

std::string number32(std::uint32_t value) {
  std::string out;
  for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 0xffu);
  return out;
}

/// Where the list at the end describes a member.
std::size_t entryOf(const std::string &bytes, const std::string &name) {
  const std::size_t at = bytes.rfind(name);
  REQUIRE(at != std::string::npos);
  REQUIRE(bytes.substr(at - 46, 4) == "PK\x01\x02");
  return at - 46;
}

struct Saved {
  fs::path file;
  std::string bytes;
};

Saved save(const SessionFile &session) {
  const fs::path file = emptyFolder() / "a.c3de";
  REQUIRE(writeSession(session, file).has_value());
  return {file, textIn(file)};
}

}  // namespace

TEST_CASE("Files that are no sessions are refused") {
  const fs::path folder = emptyFolder();
  CHECK_THAT(refusal(write(folder / "a.c3de", "")), Contains("a.c3de: is no zip archive"));
  CHECK_THAT(refusal(write(folder / "a.c3de", "format = 1\n")), Contains("a.c3de: is no zip archive"));
  CHECK_THAT(refusal(folder / "none.c3de"), Contains("none.c3de: no such file"));
  CHECK_THAT(refusal(folder), Contains("is a folder, not a file"));
  CHECK_THAT(refusal(write(folder / "a.c3de", zipBytes({}).value())), Contains("it has no member session.json"));
  const ZipMember other{"scene.toml", "format = 1"};
  CHECK_THAT(refusal(write(folder / "a.c3de", zipBytes({&other, 1}).value())), Contains("has no member session.json"));
}

TEST_CASE("A session that ends too early is refused wherever it ends") {
  const auto [file, bytes] = save(fullSession());
  for (std::size_t i = 1; i < 20; ++i) {
    INFO("cut at " << i << "/20");
    write(file, bytes.substr(0, bytes.size() * i / 20));
    CHECK_THAT(refusal(file), Contains("is truncated or damaged"));
  }
  for (std::size_t cut = 1; cut < 100; ++cut) {
    write(file, bytes.substr(0, bytes.size() - cut));
    CHECK_FALSE(refusal(file).empty());
  }
}

TEST_CASE("A changed byte in the content of a member is found, and the member named") {
  const auto [file, bytes] = save(fullSession());
  std::vector<std::string> names{"session.json", "scenes/1.toml", "scenes/3.toml", "state.bin"};
  for (const auto &[name, content] : fullSession().members)
    if (!content.empty()) names.push_back(name);
  for (const std::string &name : names) {
    const std::size_t begin = bytes.find(name) + name.size();
    const std::size_t size = std::min(bytes.find("PK\x03\x04", begin), bytes.find("PK\x01\x02", begin)) - begin;
    std::size_t found = 0;
    for (std::size_t at = 0; at < size; at += 1 + size / 16) {
      std::string changed = bytes;
      changed[begin + at] = static_cast<char>(changed[begin + at] ^ 0x10);
      write(file, changed);
      INFO(name << ", byte " << at << " of " << size);
      // The last bits of a packed member have no meaning, and a run of one letter can be packed in several ways.
      if (const auto read = readSession(file); read && *read == fullSession()) continue;
      CHECK_THAT(refusal(file), Contains("member '" + name + "' is damaged"));
      ++found;
    }
    INFO(name);
    CHECK(found > 0);
  }
}

TEST_CASE("Whichever bit of a session changes, it is refused or read as it was saved") {
  SessionFile session = fullSession();
  session.state.resize(40);
  session.members.erase("a member of another program.txt");
  const auto [file, bytes] = save(session);
  std::size_t refused = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ (1 << at % 8));
    write(file, changed);
    const auto read = readSession(file);
    if (!read) ++refused;
    INFO("byte " << at << " of " << bytes.size());
    if (read ? *read != session : read.error().message.empty()) FAIL("read with another content");
  }
  CHECK(refused > bytes.size() / 2);
}

TEST_CASE("Members whose names lead out of the session are refused") {
  SessionFile session;
  session.members["XX/evil"] = "x";
  const auto [file, bytes] = save(session);
  const std::pair<std::string, std::string> names[] = {{"../evil", "has the part '..' in its name"},
                                                       {"/x/evil", "has an absolute name"},
                                                       {"C:/evil", "has an absolute name"},
                                                       {"a\\\\evil", "has a backslash"},
                                                       {"a//evil", "has the part '' in its name"},
                                                       {"x/./evi", "has the part '.' in its name"},
                                                       {std::string("x/\0evil", 7), "has a control character"},
                                                       {"\xff/evil_", "has a name that is not UTF-8"}};
  for (const auto &[name, reason] : names) {
    INFO(name);
    // Only the names in the zip, not the one in session.json.
    write(file, replaced(bytes, "XX/evil", name.substr(0, 7)));
    CHECK_THAT(refusal(file), Contains(reason));
  }
}

TEST_CASE("Two members of one name, encrypted ones and other methods are refused") {
  SessionFile session;
  session.members["m/1"] = session.members["m/2"] = "x";
  const auto [file, bytes] = save(session);
  write(file, replaced(bytes, "m/2", "m/1"));
  CHECK_THAT(refusal(file), Contains("member 'm/1' occurs twice"));
  std::string changed = bytes;
  changed[entryOf(bytes, "m/2") + 8] = 1;
  CHECK_THAT(refusal(write(file, changed)), Contains("member 'm/2' is encrypted"));
  changed = bytes;
  changed[entryOf(bytes, "m/2") + 10] = 93;
  CHECK_THAT(refusal(write(file, changed)), Contains("member 'm/2' is packed by method 93; accepted: 0"));
}

TEST_CASE("A session with more members than are read is not saved, and the former file stays") {
  const fs::path folder = emptyFolder(), file = write(folder / "a.c3de", "former");
  SessionFile session;
  session.scenes = {"format = 1\n"};
  for (std::uint64_t i = 0; i < kMostZipMembers - 2; ++i) session.members[fmt::format("m/{}", i)];
  // session.json, the scene and these: exactly as many as are read.
  const auto most = sessionBytes(session);
  if (!most) FAIL(most.error().message);
  session.members["one too many"];
  const auto refused = writeSession(session, file);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::usage);
  CHECK_THAT(refused.error().message, Contains("a.c3de") && Contains("one too many; accepted: up to 100000"));
  CHECK(textIn(file) == "former");
  session.embedded["files/" + std::string(64, 'a') + "/x"] = write(folder / "x", "x");
  const auto streamed = writeSession(session, file);
  REQUIRE_FALSE(streamed);
  CHECK_THAT(streamed.error().message, Contains("one too many; accepted: up to 100000"));
  CHECK(textIn(file) == "former");
}

TEST_CASE("Sizes that cannot be true or exceed the limit are refused before anything is unpacked") {
  SessionFile session;
  session.members["large"] = std::string(3'000'000, 'x');
  const auto [file, bytes] = save(session);
  CHECK(readSession(file).has_value());
  // Unpacked size in the list at the end.
  std::string changed = bytes;
  changed.replace(entryOf(bytes, "large") + 24, 4, number32(0x7fffffffu));
  CHECK_THAT(refusal(write(file, changed)),
             Contains("member 'large' is damaged: 2147483647 bytes cannot be packed in"));
  changed = bytes;
  changed.replace(entryOf(bytes, "large") + 20, 4, number32(0x7fffffffu));
  CHECK_THAT(refusal(write(file, changed)), Contains("its 2147483647 packed bytes exceed the file"));
  changed = bytes;
  changed.replace(entryOf(bytes, "large") + 24, 4, number32(2'999'999u));
  CHECK_THAT(refusal(write(file, changed)), Contains("member 'large' is damaged"));

  write(file, bytes);
  const auto limited = readZip(file, {1'000'000, 100, {}});
  REQUIRE_FALSE(limited.has_value());
  CHECK_THAT(limited.error().message, Contains("a.c3de: has more than 1000000 bytes when unpacked"));
  const auto few = readZip(file, {10'000'000, 1, {}});
  REQUIRE_FALSE(few.has_value());
  CHECK_THAT(few.error().message, Contains("a.c3de: has more than 1 members"));
}
