// SPDX-License-Identifier: Apache-2.0
// Recordings: what is written is read; truncated ones are read up to their last complete record, damaged ones refused.
#include "c3de/session/recording_file.h"

#include "recording_sample.h"
#include "support/recording_records.h"

using namespace c3de;
using namespace c3de::session;
using namespace c3de::test;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kSize = kRecordType;  // where it begins

std::vector<RecordedEvent> firstOf(const std::vector<RecordedEvent> &events, std::size_t n) {
  return {events.begin(), events.begin() + static_cast<std::ptrdiff_t>(n)};
}

std::string replacedType(std::string record, const std::string &type) {
  return withChecksums(record.replace(0, kRecordType, type));
}

}  // namespace

TEST_CASE("A recording is read as it was written") {
  const fs::path file = write(emptyFolder() / "a.c3dr", recordedBytes(eventsOfAllTypes()).bytes);
  const auto read = readRecording(file);
  if (!read) FAIL(read.error().message);
  CHECK(read->start == recordingStart());
  CHECK(read->events == eventsOfAllTypes());
  CHECK(read->isComplete());
  CHECK(read->whyIncomplete().empty());
  REQUIRE(read->lastHash() != nullptr);
  CHECK(read->lastHash()->made == 9);
  CHECK(isRecordingPath("folder/a.c3dr"));
  CHECK_FALSE(isRecordingPath("a.c3de"));
}

TEST_CASE("A recording that ends within a record is read up to the record before") {
  const std::vector<RecordedEvent> events = eventsOfAllTypes();
  const auto [bytes, ends] = recordedBytes(events);
  const fs::path file = emptyFolder() / "a.c3dr";
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    INFO(size << " bytes of " << bytes.size());
    write(file, bytes.substr(0, size));
    std::size_t complete = 0;
    while (ends[complete] <= size) ++complete;
    const auto read = readRecording(file);
    if (complete == 0) {
      const std::string refused = refusedRecording(file);
      if (refused.find("is no recording") == std::string::npos) CHECK_THAT(refused, Contains("ends before the state"));
      continue;
    }
    if (!read) FAIL(read.error().message);
    if (read->events != firstOf(events, complete - 1)) FAIL("other events were read");
    CHECK_FALSE(read->isComplete());
  }
  write(file, bytes.substr(0, ends[4]));
  CHECK(readRecording(file)->whyIncomplete() == "ends early, after step 5");
  write(file, bytes.substr(0, ends[0]));
  CHECK(readRecording(file)->whyIncomplete() == "ends early, after step 0");
  // The file system has made the file longer, and the power has failed before the bytes were written.
  write(file, bytes.substr(0, ends[3]) + std::string(100'000, '\0'));
  CHECK(readRecording(file).value().events == firstOf(events, 3));
}

TEST_CASE("Whichever bit of a recording changes, it is refused") {
  const auto [bytes, ends] = recordedBytes(eventsOfAllTypes());
  const fs::path file = emptyFolder() / "a.c3dr";
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ (1 << at % 8));
    write(file, changed);
    INFO("byte " << at << " of " << bytes.size());
    CHECK_FALSE(refusedRecording(file).empty());
  }
  std::string changed = bytes;
  changed[ends[1] + kRecordHeader] = 'x';
  write(file, changed);
  CHECK_THAT(refusedRecording(file),
             Contains("record 3 at byte " + std::to_string(ends[1]) + " (HASH) is damaged: another checksum"));
}

TEST_CASE("A size that cannot be true is refused before anything is read") {
  const auto [bytes, ends] = recordedBytes(eventsOfAllTypes());
  const fs::path file = emptyFolder() / "a.c3dr";
  for (const char most : {'\x7f', '\xff'}) {
    std::string changed = bytes;
    changed[ends[0] + kSize + 7] = most;
    write(file, changed);
    CHECK_THAT(refusedRecording(file), Contains("record 2 at byte") && Contains("header has another checksum"));
    // The same with the checksum of that header: such a record is beyond the end of the file.
    std::string record = replacedType(changed.substr(ends[0], ends[1] - ends[0]), "CHNG");
    write(file, bytes.substr(0, ends[0]) + record);
    CHECK(readRecording(file).value().events.empty());
  }
}

TEST_CASE("Records of an unknown type and newer formats are refused by name") {
  const auto [bytes, ends] = recordedBytes(eventsOfAllTypes());
  const fs::path file = emptyFolder() / "a.c3dr";
  const std::string record = bytes.substr(ends[0], ends[1] - ends[0]);
  write(file, bytes.substr(0, ends[0]) + replacedType(record, "CHNG") + bytes.substr(ends[1]));
  CHECK(refusedRecording(file).empty());
  write(file, bytes.substr(0, ends[0]) + replacedType(record, "NEW!") + bytes.substr(ends[1]));
  CHECK_THAT(refusedRecording(file), Contains("record 2 at byte") && Contains("has the type 'NEW!'") &&
                                         Contains("accepted: STRT, CHNG, RSET, STAT, SCEN, HASH, END."));
  write(file, bytes.substr(0, ends[0]) + replacedType(record, "HASH"));
  CHECK_THAT(refusedRecording(file), Contains("record 2 at byte") && Contains("is too"));
  write(file, bytes.substr(0, 19) + record);
  CHECK_THAT(refusedRecording(file), Contains("has the type 'CHNG'; accepted: STRT"));
  write(file, bytes + record);
  CHECK_THAT(refusedRecording(file), Contains("bytes follow its end"));

  std::string newer = bytes;
  newer[15] = 2;  // behind "C3DE recording\n"
  write(file, newer);
  CHECK_THAT(refusedRecording(file), Contains("a recording of format 2; accepted: up to 1"));
  CHECK_THAT(refusedRecording(write(file, "PK")), Contains("is no recording"));
  CHECK_THAT(refusedRecording(write(file, "")), Contains("is no recording"));
  CHECK_THAT(refusedRecording(file.parent_path()), Contains("is a folder, not a file"));
}

TEST_CASE("A minute of moves of a mouse is less than a megabyte") {
  std::size_t bytes = 0;
  for (std::uint64_t i = 0; i < 60 * 60; ++i) {
    const SimulationChange move{"grab.move", "grab.liver",         "pull on liver", C3DE_SIM_CHANGE_TRANSIENT,
                                i,           std::string(100, 'x')};
    bytes += recordingBytes(RecordedEvent(move)).value().size();
  }
  CHECK(bytes < 1'000'000);
}
