// SPDX-License-Identifier: Apache-2.0
// Reports about problems: what is in them, and what is not.
#include "c3de/session/problem_report.h"

#include <algorithm>

#include "files/archive_stream.h"
#include "files/zip_archive.h"
#include "recording_sample.h"
#include "support/environment.h"

using namespace c3de;
using namespace c3de::session;
using namespace c3de::test;
namespace fs = std::filesystem;

namespace {

/// A home folder with a mesh, and the past of a simulation of it.
struct Reported {
  fs::path folder = emptyFolder(), home = folder / "anne.example", mesh = home / "box.obj", file = folder / "r.c3dr";
  ScopedEnvironment homeVariable{"HOME", home.string()}, user{"USER", "anne.example"};
  ProblemReport report;

  Reported() {
    fs::create_directories(home);
    write(mesh, "v 1 2 3\n");
    scene::SceneFile scene;
    scene.title = "box of anne.example";
    scene::SceneBody body;
    body.name = "box";
    body.mesh = mesh;
    scene.bodies.push_back(body);
    report.description = "It fell through " + home.string() + "/floor";
    report.versions = "{\"program\": \"C3DE\"}";
    report.values = "gravity = 9.81";
    report.log = "error: " + mesh.string() + ": anne.example cannot read it\n";
    ReportedPast past;
    past.start.source = {std::make_shared<const scene::SceneFile>(scene)};
    past.start.identity = recordingStart().simulator;
    past.recording = write(folder / "past.c3dr", recordedBytes(events()).bytes);
    report.past = past;
  }
  static std::vector<RecordedEvent> events() {
    return {SimulationChange{"test.add", "", "add plate", 0, 1, "plate"}, RecordedHash{2, 2, 0.2, 1},
            SimulationChange{"test.add", "", "add plate", 0, 3, "plate"}, RecordedHash{4, 4, 0.4, 2}};
  }
  void save() const {
    const auto written = writeProblemReport(report, file);
    if (!written) FAIL(written.error().message);
  }
  /// All members, unpacked, and the bytes of all records after the first.
  [[nodiscard]] std::string content() const {
    auto archive = openArchive(file).value();
    std::string all = textIn(file);
    const auto members = readZip(archive->stream(), "r").value();
    for (const auto &[name, bytes] : members) all += name + "\n" + bytes;
    return all;
  }
};

}  // namespace

TEST_CASE("A report is a complete recording with its files, a text, values, versions and the log") {
  const Reported one;
  one.save();
  const auto read = readRecording(one.file);
  if (!read) FAIL(read.error().message);
  CHECK(read->isComplete());
  REQUIRE(read->events.size() == 4);
  CHECK(std::get<SimulationChange>(read->events[0]).bytes == "plate");
  REQUIRE(std::holds_alternative<RecordedEnd>(read->events[3]));
  CHECK(std::get<RecordedEnd>(read->events[3]).hash == 2);
  const SessionFile &session = read->start.session;
  REQUIRE(session.files.size() == 1);
  CHECK(session.files[0].isEmbedded);
  CHECK(session.members.at(kReportText) == "It fell through ~/floor");
  CHECK(session.members.at(kReportValues) == "gravity = 9.81");
  CHECK(session.members.at(kReportLog) == "error: " + (fs::path("~") / "box.obj").string() + ": USER cannot read it\n");
  CHECK(session.title == "box of USER");
}

TEST_CASE("Nothing in a report names the home folder or the user") {
  const Reported one;
  one.save();
  const std::string all = one.content();
  CHECK_THAT(all, Contains("v 1 2 3"));  // members are unpacked here
  CHECK(all.find(one.home.string()) == std::string::npos);
  CHECK(all.find("anne.example") == std::string::npos);
}

TEST_CASE("A change whose data name the home folder is refused by its text, and no file is written") {
  Reported one;
  write(one.report.past->recording,
        recordedBytes({SimulationChange{"test.add", "", "add plate", 0, 1, one.mesh.string()}}).bytes);
  const auto written = writeProblemReport(one.report, one.file);
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ErrorCode::state);
  CHECK_THAT(written.error().message, Contains("the change 'add plate' names a file in your home folder"));
  CHECK_FALSE(fs::exists(one.file));
}

TEST_CASE("Without the image it is not in a report, and bodies that are made from it are refused") {
  Reported one;
  auto scene = *std::get<SharedScene>(one.report.past->start.source.front());
  write(one.home / "scan.dcm", "PATIENT^NAME");
  scene.image.emplace();
  scene.image->file = one.home / "scan.dcm";
  one.report.past->start.source.front() = std::make_shared<const scene::SceneFile>(scene);
  CHECK_FALSE(needsImage(one.report.past->start.source));
  one.save();
  CHECK_THAT(one.content(), !Contains("PATIENT^NAME") && !Contains("scan.dcm"));
  one.report.hasImage = true;
  one.save();
  CHECK_THAT(one.content(), Contains("PATIENT^NAME"));

  one.report.hasImage = false;
  scene.bodies[0].mesh.clear();
  scene.bodies[0].volume.file = one.home / "scan.dcm";
  scene.bodies[0].volume.threshold = {100.0, 200.0};
  one.report.past->start.source.front() = std::make_shared<const scene::SceneFile>(scene);
  CHECK(needsImage(one.report.past->start.source));
  const auto refused = writeProblemReport(one.report, one.file);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("the bodies are made from the image"));
}

TEST_CASE("A report without a simulation has no scene, and cancelling leaves the former file") {
  Reported one;
  one.save();
  const std::string before = textIn(one.file);
  const auto cancelled = writeProblemReport(one.report, one.file, [](double, const std::string &) { return false; });
  REQUIRE_FALSE(cancelled);
  CHECK(cancelled.error().code == ErrorCode::cancelled);
  CHECK(textIn(one.file) == before);
  one.report.past.reset();
  one.save();
  const Recording read = readRecording(one.file).value();
  CHECK(read.start.session.scenes.empty());
  CHECK(read.events.empty());
  CHECK(read.start.session.members.at(kReportValues) == "gravity = 9.81");
}
