// SPDX-License-Identifier: Apache-2.0
// Sessions that contain their files: written and read in pieces, extracted once, checked, removed when unused.
#include "c3de/session/embedded_files.h"

#include <algorithm>
#include <chrono>

#include "c3de/session/saved_session.h"
#include "files/zip_archive.h"
#include "files/zip_writer.h"
#include "recording_sample.h"
#include "support/dicom_series.h"
#include "support/environment.h"

using namespace c3de;
using namespace c3de::session;
using namespace c3de::test;
namespace fs = std::filesystem;

namespace {

/// A mesh, a folder of an image and a header with its voxels, embedded in a session.
struct Embedded {
  fs::path folder = emptyFolder();
  ScopedEnvironment home{"C3DE_HOME", (folder / "home").string()};
  fs::path file = folder / "a.c3de", mesh = folder / "data" / "box.obj", series = folder / "data" / "series",
           header = folder / "data" / "ct.mhd", voxels = folder / "data" / "ct.raw";
  SessionFile session;
  std::vector<std::string> paths;  ///< of mesh, series and header in the session

  Embedded() {
    fs::create_directories(series / "b");
    write(mesh, "v 1 2 3\n");
    write(series / "1", std::string(100'000, 'x'));
    write(series / "b" / "2", "two");
    write(header,
          "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = ct.raw\n");
    write(voxels, "12345678");
    FileReferences references;
    for (const fs::path &one : {mesh, series, header}) {
      const auto path = addFile(one, folder, references, {}, Embedding::all, session);
      if (!path) FAIL(path.error().message);
      paths.push_back(*path);
    }
    const auto written = writeSession(session, file);
    if (!written) FAIL(written.error().message);
  }
  [[nodiscard]] SessionFile read() const {
    auto opened = readSession(file, EmbeddedContent::stays);
    if (!opened) FAIL(opened.error().message);
    return std::move(*opened);
  }
  [[nodiscard]] Expected<std::vector<FoundFile>> located() const { return locateFiles(read(), file); }
};

fs::path placeOf(const std::vector<FoundFile> &files, const std::string &path) {
  const auto found =
      std::find_if(files.begin(), files.end(), [&](const FoundFile &one) { return one.file.path == path; });
  REQUIRE(found != files.end());
  CHECK(found->state == FoundFile::State::same);
  return found->at;
}

std::size_t countBelow(const fs::path &folder, const std::string &ending = "") {
  std::size_t count = 0;
  for (const auto &entry : fs::recursive_directory_iterator(folder))
    count += entry.is_regular_file() && entry.path().string().ends_with(ending) ? 1 : 0;
  return count;
}

/// The archive with another content of a member, and a valid checksum.
void replaceMember(const fs::path &file, const std::string &name, const std::string &content) {
  auto members = readZip(file).value();
  REQUIRE(members.contains(name));
  members[name] = content;
  std::vector<ZipMember> list;
  for (const auto &[member, bytes] : members) list.push_back({member, bytes});
  write(file, zipBytes(list).value());
}

void writeDicomSlice(const fs::path &file, const std::string &series, int slice) {
  DicomElements elements;
  elements.add(0x0008, 0x0018, "UI", "2.25.3104.1." + series + "." + std::to_string(slice));
  elements.add(0x0008, 0x0060, "CS", "CT");
  elements.add(0x0020, 0x000e, "UI", "2.25.3104.1." + series);
  elements.add(0x0020, 0x0013, "IS", std::to_string(slice));
  elements.add(0x0020, 0x0032, {0.0, 0.0, 2.0 * slice});
  elements.add(0x0020, 0x0037, {1.0, 0.0, 0.0, 0.0, 1.0, 0.0});
  elements.add(0x0028, 0x0002, std::uint16_t{1});
  elements.add(0x0028, 0x0004, "CS", "MONOCHROME2");
  for (const std::uint16_t size : {std::uint16_t{0x0010}, std::uint16_t{0x0011}})
    elements.add(0x0028, size, std::uint16_t{2});
  elements.add(0x0028, 0x0030, {1.0, 1.0});
  for (const auto &[element, bits] : {std::pair<std::uint16_t, std::uint16_t>{0x0100, 16}, {0x0101, 16}, {0x0102, 15}})
    elements.add(0x0028, element, bits);
  elements.add(0x0028, 0x0103, std::uint16_t{0});
  elements.add(0x7fe0, 0x0010, "OW", std::string(8, '\1'));
  write(file, dicomFile(elements.bytes()));
}

}  // namespace

TEST_CASE("A session contains files, folders and the voxels that a header names") {
  const Embedded one;
  const SessionFile read = one.read();
  CHECK(read.files == one.session.files);
  CHECK(read.members.empty());
  CHECK(read.embedded.size() == 5);
  CHECK(std::all_of(read.embedded.begin(), read.embedded.end(),
                    [](const auto &member) { return member.second.empty(); }));
  for (const ReferencedFile &file : read.files) CHECK(file.isEmbedded);
  CHECK(one.paths[0] == "files/" + sha256Of(one.mesh).value() + "/box.obj");
  // The whole archive is one that minizip reads, and is the same when it is written again.
  const auto whole = readSession(one.file);
  REQUIRE(whole);
  CHECK(whole->members.at(one.paths[0]) == "v 1 2 3\n");
  CHECK(whole->members.at(one.paths[1] + "/b/2") == "two");
  const std::string bytes = textIn(one.file);
  REQUIRE(writeSession(one.session, one.file));
  CHECK(textIn(one.file) == bytes);

  const auto files = one.located();
  if (!files) FAIL(files.error().message);
  CHECK(textIn(placeOf(*files, one.paths[0])) == "v 1 2 3\n");
  CHECK(sha256Of(placeOf(*files, one.paths[1])).value() == sha256Of(one.series).value());
  const fs::path header = placeOf(*files, one.paths[2]);
  CHECK(textIn(header) == textIn(one.header));
  CHECK(textIn(header.parent_path() / "ct.raw") == "12345678");
  CHECK(isExtracted(header));
  CHECK_FALSE(isExtracted(one.header));
  CHECK_FALSE(isExtracted(extractionFolder() / ".." / "x"));
}

TEST_CASE("Embedded files are extracted once, and again after they were changed") {
  const Embedded one;
  const auto first = one.located();
  REQUIRE(first);
  const fs::path mesh = placeOf(*first, one.paths[0]);
  const auto written = fs::last_write_time(mesh);
  const auto second = one.located();
  REQUIRE(second);
  CHECK(placeOf(*second, one.paths[0]) == mesh);
  CHECK(fs::last_write_time(mesh) == written);
  write(mesh, "v 1 2 4\n");
  REQUIRE(one.located());
  CHECK(textIn(mesh) == "v 1 2 3\n");
  // A link instead of the file is not followed.
  write(one.folder / "other.obj", "v 1 2 3\n");
  fs::remove(mesh);
  std::error_code noLinks;  // with mingw-w64; then the file is missing
  fs::create_symlink(one.folder / "other.obj", mesh, noLinks);
  REQUIRE(one.located());
  CHECK_FALSE(fs::is_symlink(fs::symlink_status(mesh)));
  CHECK(textIn(one.folder / "other.obj") == "v 1 2 3\n");
}

TEST_CASE("Extracted files stay while they are used, and for a week") {
  const Embedded one;
  auto files = one.located();
  REQUIRE(files);
  const fs::path mesh = placeOf(*files, one.paths[0]);
  const auto now = fs::file_time_type::clock::now();
  using std::chrono::hours;
  removeUnusedExtractions(now + hours(24 * 30));
  CHECK(fs::exists(mesh));
  CHECK(countBelow(extractionFolder(), ".lock") == 3);
  files->clear();
  CHECK(countBelow(extractionFolder(), ".lock") == 0);
  removeUnusedExtractions(now + hours(24 * 6));
  CHECK(fs::exists(mesh));
  removeUnusedExtractions(now + hours(24 * 8));
  CHECK(countBelow(extractionFolder()) == 0);
}

TEST_CASE("A damaged embedded file is an error that names its member, and leaves nothing") {
  const Embedded one;
  replaceMember(one.file, one.paths[0], "v 1 2 9\n");
  const auto other = one.located();
  REQUIRE_FALSE(other);
  CHECK(other.error().code == ErrorCode::input);
  CHECK_THAT(other.error().message, Contains("a.c3de: member '" + one.paths[0] + "' is damaged: its SHA-256 is "));
  CHECK(countBelow(extractionFolder()) == 0);

  // More than the session states: extraction ends there.
  replaceMember(one.file, one.paths[0], std::string(1'000'000, 'v'));
  const auto larger = one.located();
  REQUIRE_FALSE(larger);
  CHECK_THAT(larger.error().message, Contains("it has more than the 8 bytes that the session states"));
  CHECK(countBelow(extractionFolder()) == 0);

  REQUIRE(writeSession(one.session, one.file));
  std::string bytes = textIn(one.file);
  const std::size_t header = bytes.find(one.paths[0]);
  REQUIRE(header != std::string::npos);
  bytes[header + one.paths[0].size() + 3] ^= 0x10;
  write(one.file, bytes);
  const auto damaged = one.located();
  REQUIRE_FALSE(damaged);
  CHECK_THAT(damaged.error().message, Contains("member '" + one.paths[0] + "' is damaged"));
  CHECK(countBelow(extractionFolder()) == 0);
}

TEST_CASE("Members and names that lead out of the archive are refused") {
  const fs::path folder = emptyFolder();
  const ScopedEnvironment home("C3DE_HOME", (folder / "home").string());
  const std::string hash(64, 'a');
  for (const char *name : {"..", "../x", "/etc/x", "a/../../x", "C:/x", "a\\x", ""}) {
    CAPTURE(name);
    ReferencedFile file{"files/" + hash + "/" + name, hash, 1, true};
    std::vector<FoundFile> files{{file, {}, FoundFile::State::same, nullptr}};
    write(folder / "a.c3de", zipBytes({}).value());
    const auto extracted = extractEmbedded(folder / "a.c3de", files);
    REQUIRE_FALSE(extracted);
    CHECK(extracted.error().code == ErrorCode::input);
  }
  CHECK_FALSE(fs::exists(folder / "x"));
  CHECK_FALSE(fs::exists(folder / "home" / "x"));
}

TEST_CASE("A file that changes while it is saved, and cancelling, leave the former session") {
  const Embedded one;
  const std::string bytes = textIn(one.file);
  write(one.mesh, "v 3 2 1\n");
  const auto changed = writeSession(one.session, one.file);
  REQUIRE_FALSE(changed);
  CHECK_THAT(changed.error().message, Contains(one.paths[0] + ": has changed while it was saved"));
  const auto cancelled = writeSession(one.session, one.file, [](double, const std::string &) { return false; });
  REQUIRE_FALSE(cancelled);
  CHECK(cancelled.error().code == ErrorCode::cancelled);
  CHECK(textIn(one.file) == bytes);
  fs::remove(one.mesh);
  CHECK_THAT(writeSession(one.session, one.file).error().message, Contains("box.obj"));
  const auto stopped = extractEmbedded(one.file, *std::make_unique<std::vector<FoundFile>>(one.located().value()),
                                       [](double, const std::string &) { return false; });
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::cancelled);
}

TEST_CASE("Files that were extracted are embedded again, without being asked for") {
  const Embedded one;
  const auto files = one.located();
  REQUIRE(files);
  FileReferences references;
  SessionFile again;
  for (const std::string &path : one.paths)
    CHECK(addFile(placeOf(*files, path), one.folder, references, {}, Embedding::extracted, again).value() == path);
  CHECK(again.files == one.session.files);
  REQUIRE(writeSession(again, one.folder / "b.c3de"));
  CHECK(textIn(one.folder / "b.c3de") == textIn(one.file));
  SessionFile none;
  CHECK(addFile(one.mesh, one.folder, references, {}, Embedding::extracted, none).value() == "data/box.obj");
  CHECK(none.embedded.empty());
}

TEST_CASE("A session that refers to extracted files finds them in their archive after the cache is gone") {
  const Embedded one;
  auto files = one.located();
  REQUIRE(files);
  FileReferences references;
  SessionFile recovery;
  for (const std::string &path : one.paths)
    REQUIRE(addFile(placeOf(*files, path), one.folder, references, {}, Embedding::none, recovery));
  CHECK(recovery.embedded.empty());
  nameArchives(one.folder, recovery);
  REQUIRE(writeSession(recovery, one.folder / "recovery.c3de"));
  files->clear();
  fs::remove_all(one.folder / "home");
  const SessionFile read = readSession(one.folder / "recovery.c3de").value();
  {
    const auto again = filesOfSession(read, one.folder / "recovery.c3de");
    if (!again) FAIL(again.error().message);
    for (const FoundFile &file : *again) {
      CHECK(sha256Of(file.at).value() == file.file.sha256);
      CHECK(file.use != nullptr);
    }
  }
  fs::remove_all(one.folder / "home");
  fs::remove(one.file);
  const auto gone = filesOfSession(read, one.folder / "recovery.c3de");
  REQUIRE_FALSE(gone);
  CHECK_THAT(gone.error().message, Contains("is missing"));
}

TEST_CASE("A recording contains files, which are extracted from it elsewhere") {
  const Embedded one;
  RecordingStart start = recordingStart();
  start.session.files = one.session.files;
  start.session.embedded = one.session.embedded;
  const std::string bytes = recordingBytes(start).value();
  const std::vector<RecordedEvent> events = eventsOfAllTypes();
  const fs::path file =
      write(one.folder / "a.c3dr", bytes + recordedBytes(events).bytes.substr(recordedBytes({}).bytes.size()));
  fs::create_directories(one.folder / "elsewhere");
  const fs::path moved = one.folder / "elsewhere" / "b.c3dr";
  fs::rename(file, moved);
  fs::remove_all(one.folder / "data");

  const auto read = readRecording(moved);
  if (!read) FAIL(read.error().message);
  CHECK(read->isComplete());
  CHECK(read->events == events);
  CHECK(read->start.session.files == one.session.files);
  CHECK(read->start.session.members.empty());  // of 100 kB nothing is in memory
  CHECK(read->start.session.embedded.size() == 5);
  const auto files = locateFiles(read->start.session, moved);
  if (!files) FAIL(files.error().message);
  CHECK(textIn(placeOf(*files, one.paths[0])) == "v 1 2 3\n");
  CHECK(textIn(placeOf(*files, one.paths[1]) / "1") == std::string(100'000, 'x'));
  CHECK(textIn(placeOf(*files, one.paths[2]).parent_path() / "ct.raw") == "12345678");
}

TEST_CASE("A damaged embedded file of a recording is refused, also with a valid checksum of its record") {
  const Embedded one;
  RecordingStart start = recordingStart();
  start.session.files = one.session.files;
  start.session.embedded = one.session.embedded;
  const fs::path file = one.folder / "a.c3dr";
  std::string bytes = recordingBytes(start).value();
  const std::size_t name = bytes.find(one.paths[0]);
  REQUIRE(name != std::string::npos);
  bytes[name + one.paths[0].size() + 3] ^= 0x10;
  write(file, bytes);
  CHECK_THAT(refusedRecording(file), Contains("record 1 at byte 19 (STRT) is damaged: another checksum"));
  // The archive is damaged before its record was written.
  ReferencedFile other = one.session.files.front();
  start.session.files = {other};
  start.session.embedded.clear();
  start.session.members[embeddedName(other)] = "v 9 9 9\n";
  write(file, recordingBytes(start).value());
  const auto read = readRecording(file);
  REQUIRE(read);
  const auto located = locateFiles(read->start.session, file);
  REQUIRE_FALSE(located);
  CHECK(located.error().code == ErrorCode::input);
  CHECK_THAT(located.error().message,
             Contains("a.c3dr: member '" + embeddedName(other) + "' is damaged: its SHA-256 is "));
  CHECK(countBelow(extractionFolder()) == 0);
}

TEST_CASE("A file that changes while a recording begins, and cancelling, are errors") {
  const Embedded one;
  RecordingStart start = recordingStart();
  start.session.files = one.session.files;
  start.session.embedded = one.session.embedded;
  const auto cancelled = writeRecordingStart(
      start, [](std::string_view) { return Expected<void>(); }, [](double, const std::string &) { return false; });
  REQUIRE_FALSE(cancelled);
  CHECK(cancelled.error().code == ErrorCode::cancelled);
  write(one.mesh, "v 3 2 1\n");
  const auto changed = recordingBytes(start);
  REQUIRE_FALSE(changed);
  CHECK_THAT(changed.error().message, Contains(one.paths[0] + ": has changed while it was saved"));
}

TEST_CASE("Files are found in a folder by their content, folders by name and content") {
  const fs::path folder = emptyFolder();
  fs::create_directories(folder / "old" / "series");
  write(folder / "old" / "box.obj", "v 1 2 3\n");
  write(folder / "old" / "series" / "1", "one");
  write(folder / "old" / "other.obj", "v 7\n");
  SessionFile session;
  for (const char *name : {"box.obj", "series", "other.obj"})
    session.files.push_back(referenceTo(folder / "old" / name, folder / "case").value());
  fs::rename(folder / "old", folder / "disk");
  fs::create_directories(folder / "disk" / "deep");
  fs::rename(folder / "disk" / "box.obj", folder / "disk" / "deep" / "renamed.obj");
  fs::rename(folder / "disk" / "series", folder / "disk" / "deep" / "series");
  write(folder / "disk" / "other.obj", "v 8\n");
  std::error_code noLinks;  // with mingw-w64
  fs::create_directory_symlink(folder / "disk", folder / "disk" / "deep" / "loop", noLinks);

  const auto find = [&](const FileSearch &search) {
    auto files = locateFiles(session, folder / "case" / "a.c3de", {}, search);
    if (!files) FAIL(files.error().message);
    return std::move(*files);
  };
  for (const FoundFile &one : find({})) CHECK(one.state == FoundFile::State::missing);
  const auto files = find({{}, {folder / "disk"}});
  CHECK(files[0].at == folder / "disk" / "deep" / "renamed.obj");
  CHECK(files[1].at == folder / "disk" / "deep" / "series");
  CHECK(files[1].state == FoundFile::State::same);
  CHECK(files[2].at == folder / "disk" / "other.obj");
  CHECK(files[2].state == FoundFile::State::changed);
  // The folder itself.
  CHECK(find({{}, {folder / "disk" / "deep" / "series"}})[1].state == FoundFile::State::same);
  const auto refused = filesOfSession(session, folder / "case" / "a.c3de", {}, {{}, {folder / "disk"}});
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("other.obj: has changed since") && Contains("--search FOLDER"));

  const auto none = locateFiles(session, folder / "case" / "a.c3de", {}, {{}, {folder / "nowhere"}});
  REQUIRE_FALSE(none);
  CHECK_THAT(none.error().message, Contains("nowhere: there is no such folder"));
  auto missing = find({});
  const auto cancelled = searchFolder(folder, missing, [](double, const std::string &) { return false; });
  REQUIRE_FALSE(cancelled);
  CHECK(cancelled.error().code == ErrorCode::cancelled);
}

TEST_CASE("Headers of equal text with different voxels keep their own voxels") {
  const fs::path folder = emptyFolder();
  const ScopedEnvironment home{"C3DE_HOME", (folder / "home").string()};
  const std::string header =
      "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = ct.raw\n";
  SessionFile session;
  FileReferences references;
  std::vector<std::string> paths;
  for (const char *patient : {"a", "b", "same"}) {
    fs::create_directories(folder / patient);
    const fs::path file = write(folder / patient / "ct.mhd", header);
    write(folder / patient / "ct.raw", *patient == 'b' ? "bbbbbbbb" : "aaaaaaaa");
    const auto path = addFile(file, folder, references, {}, Embedding::all, session);
    if (!path) FAIL(path.error().message);
    paths.push_back(*path);
  }
  CHECK(paths[0] != paths[1]);
  CHECK(paths[0] == paths[2]);  // equal contents are stored once
  CHECK(session.embedded.size() == 4);
  const fs::path file = folder / "pairs.c3de";
  if (const auto written = writeSession(session, file); !written) FAIL(written.error().message);
  for (const char *patient : {"a", "b", "same"}) fs::remove_all(folder / patient);
  const auto read = readSession(file, EmbeddedContent::stays);
  if (!read) FAIL(read.error().message);
  const auto files = locateFiles(*read, file);
  if (!files) FAIL(files.error().message);
  CHECK(textIn(placeOf(*files, paths[0]).parent_path() / "ct.raw") == "aaaaaaaa");
  CHECK(textIn(placeOf(*files, paths[1]).parent_path() / "ct.raw") == "bbbbbbbb");
  CHECK(textIn(placeOf(*files, paths[1])) == header);
}

TEST_CASE("A folder that cannot be read is reported by the search, and the others are searched") {
  const fs::path folder = emptyFolder(), locked = folder / "disk" / "a" / "locked", other = folder / "disk" / "z";
  fs::create_directories(locked);
  fs::create_directories(other);
  const fs::path file = write(folder / "box.obj", "v 1 2 3\n");
  const auto reference = referenceTo(file, folder);
  REQUIRE(reference);
  fs::rename(file, other / "renamed.obj");
  fs::permissions(locked, fs::perms::none);
  std::error_code code;
  const bool isLocked = fs::directory_iterator(locked, code) == fs::directory_iterator() && code;
  std::vector<FoundFile> files{{*reference, {}, FoundFile::State::missing, nullptr}};
  std::vector<std::string> unread;
  const auto searched = searchFolder(folder / "disk", files, {}, &unread);
  fs::permissions(locked, fs::perms::owner_all);
  REQUIRE(searched);
  CHECK(files.front().state == FoundFile::State::same);
  CHECK(files.front().at == other / "renamed.obj");
  if (!isLocked) C3DE_SKIP("this user reads every folder");
  REQUIRE(unread.size() == 1);
  CHECK_THAT(unread.front(), Contains("locked"));
}

TEST_CASE("Zip members are written in pieces, with headers for 4 GiB and more") {
  const fs::path file = emptyFolder() / "a.zip";
  const std::string long_(3'000'000, 'z');
  std::string bytes;
  ZipWriter zip([&bytes](std::string_view piece) { bytes += piece; });
  REQUIRE(zip.begin("small", 2));
  REQUIRE(zip.add("a"));
  REQUIRE(zip.add("b"));
  REQUIRE(zip.end());
  REQUIRE(zip.begin("folder/large", std::uint64_t{1} << 33));
  REQUIRE(zip.add(long_));
  REQUIRE(zip.end());
  REQUIRE(zip.begin("empty", 0));
  REQUIRE(zip.end());
  CHECK_FALSE(zip.begin("small", 1));
  CHECK_FALSE(zip.begin("../x", 1));
  zip.finish();
  const auto members = readZip(write(file, bytes));
  if (!members) FAIL(members.error().message);
  CHECK(*members == std::map<std::string, std::string>{{"small", "ab"}, {"folder/large", long_}, {"empty", ""}});
}

TEST_CASE("The files of the series of a DICOM file belong to it, those of other series do not") {
  const fs::path folder = emptyFolder();
  for (const std::string series : {"1", "2"})
    for (int slice = 1; slice <= 3; ++slice)
      writeDicomSlice(folder / (series + "-" + std::to_string(slice) + ".dcm"), series, slice);
  const auto files = filesBelongingTo(folder / "1-2.dcm");
  if (!files) FAIL(files.error().message);
  CHECK(*files == std::vector<fs::path>{folder / "1-1.dcm", folder / "1-3.dcm"});
  CHECK(filesBelongingTo(folder).value().empty());
}

TEST_CASE("The buffers of a glTF mesh belong to it") {
  const fs::path folder = emptyFolder();
  write(folder / "a.bin", "1234");
  write(folder / "a.gltf", R"({"buffers": [{"uri": "a.bin"}, {"uri": "data:;base64,AA=="}]})");
  CHECK(filesBelongingTo(folder / "a.gltf").value() == std::vector<fs::path>{folder / "a.bin"});
  write(folder / "b.gltf", R"({"buffers": [{"uri": "b.bin"}]})");
  const auto refused = filesBelongingTo(folder / "b.gltf");
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("b.gltf: names the file b.bin"));
}

// Several minutes and 10 GB of disk.
TEST_CASE("A file of more than 4 GiB is embedded and extracted", "[.large]") {
  const fs::path folder = emptyFolder();
  const ScopedEnvironment home("C3DE_HOME", (folder / "home").string());
  const fs::path large = write(folder / "large.raw", "begin"), small = write(folder / "small.raw", "small");
  const std::uint64_t size = (std::uint64_t{1} << 32) + 5;
  fs::resize_file(large, size);
  FileReferences references;
  SessionFile session;
  for (const fs::path &file : {large, small})
    if (const auto path = addFile(file, folder, references, {}, Embedding::all, session); !path)
      FAIL(path.error().message);
  if (const auto written = writeSession(session, folder / "a.c3de"); !written) FAIL(written.error().message);
  const auto read = readSession(folder / "a.c3de", EmbeddedContent::stays);
  if (!read) FAIL(read.error().message);
  const auto files = locateFiles(*read, folder / "a.c3de");
  if (!files) FAIL(files.error().message);
  for (const FoundFile &one : *files) CHECK(fs::file_size(one.at) == one.file.bytes);
  fs::remove_all(folder);
}
