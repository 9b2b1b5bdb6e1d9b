// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/stretch.h"

#include <filesystem>
#include <fstream>

#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;
namespace fs = std::filesystem;

namespace {

using Positions = std::vector<std::uint64_t>;

TimeAt steps(double step_s) {
  return [step_s](std::uint64_t at) { return step_s * static_cast<double>(at); };
}

fs::path emptyFolder(const std::string &name) {
  fs::path folder = fs::path(testOutputRoot()) / "stretch" / name;
  fs::remove_all(folder);
  fs::create_directories(folder);
  return fs::absolute(folder);
}

StretchExport allOf(const fs::path &folder) {
  StretchExport wanted;
  wanted.hasFrames = wanted.hasProbes = wanted.hasPictures = wanted.hasFilm = true;
  wanted.folder = folder;
  wanted.name = "pull";
  return wanted;
}

bool contains(const std::string &text, const std::string &part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("Begin and end of a stretch stay in order") {
  Stretch stretch{0, 100};
  stretch.setBegin(30, 100);
  stretch.setEnd(60, 100);
  CHECK((stretch.begin == 30 && stretch.end == 60));
  stretch.setBegin(80, 100);
  CHECK((stretch.begin == 80 && stretch.end == 100));
  stretch.setEnd(40, 100);
  CHECK((stretch.begin == 0 && stretch.end == 40));
  stretch.setBegin(100, 100);
  CHECK((stretch.begin == 99 && stretch.end == 100));
  stretch.setEnd(0, 100);
  CHECK((stretch.begin == 0 && stretch.end == 1));
  stretch.setBegin(0, 0);
  stretch.setEnd(0, 0);
  CHECK((stretch.begin == 0 && stretch.end == 0));
}

TEST_CASE("A frame of a stretch is the last step that is not after its time") {
  // Times begin with the stretch, also where that is no multiple of the interval.
  CHECK(framePositions({3, 14}, steps(0.01), 0.04) == Positions{3, 7, 11});
  CHECK(framePositions({0, 10}, steps(0.003), 0.01) == Positions{0, 3, 6, 10});
  CHECK(framePositions({0, 3}, steps(0.1), 0.05) == Positions{0, 0, 1, 1, 2, 2, 3});
  // Sums of steps are not exact.
  const Positions many = framePositions({0, 3000}, steps(0.001), 0.04);
  REQUIRE(many.size() == 76);
  for (std::size_t k = 0; k < many.size(); ++k) CHECK(many[k] == 40 * k);
  CHECK(frameCount(3.0, 0.04) == 76.0);
  CHECK(framePositions({0, 4}, steps(0.1), 1.0) == Positions{0});
  // Steps of different lengths.
  const TimeAt uneven = [](std::uint64_t at) { return at < 5 ? 0.01 * double(at) : 0.04 + 0.02 * double(at - 4); };
  CHECK(framePositions({0, 8}, uneven, 0.03) == Positions{0, 3, 5, 6, 8});
}

TEST_CASE("Every load step is a frame where steps have no duration") {
  CHECK(framePositions(
            {2, 5}, [](std::uint64_t) { return 0.0; }, 0.04) == Positions{2, 3, 4, 5});
}

TEST_CASE("Values that cannot be exported are named with what is accepted") {
  const StretchExport good = allOf(emptyFolder("problems"));
  CHECK(problemOf(good, 2.0).empty());
  const auto problem = [&](const auto &change, double duration_s = 2.0) {
    StretchExport wanted = good;
    change(wanted);
    return problemOf(wanted, duration_s);
  };
  CHECK(contains(problem([](StretchExport &e) { e.hasFrames = e.hasProbes = e.hasPictures = e.hasFilm = false; }),
                 "Nothing is chosen"));
  CHECK(contains(problem([](StretchExport &e) { e.frameEvery_ms = 0.0; }), "accepted: 0.001 to 1000000 ms"));
  CHECK(contains(problem([](StretchExport &e) { e.pictureRate = -25.0; }), "-25; accepted: 0.001 to 10000"));
  CHECK(contains(problem([](StretchExport &e) { e.width = 10; }), "10; accepted: 16 to 8192 pixels"));
  CHECK(contains(problem([](StretchExport &e) { e.height = 721; }), "1280 × 721; accepted: even numbers"));
  CHECK(problem([](StretchExport &e) { e.height = 721, e.hasFilm = false; }).empty());
  CHECK(contains(problem([](StretchExport &e) { e.name.clear(); }), "no name"));
  CHECK(contains(problem([](StretchExport &e) { e.name = "a/b"; }), "Name 'a/b'"));
  CHECK(contains(problem([](StretchExport &e) { e.folder = "relative"; }), "Folder 'relative'"));
  CHECK(contains(problem([](StretchExport &e) { e.folder /= "missing"; }), "a folder that exists"));
  CHECK(contains(problem([](StretchExport &) {}, 1e5), "accepted: 1 to 999999"));
}

TEST_CASE("Files of an export that exist are found, if they are wanted") {
  StretchExport wanted = allOf(emptyFolder("existing"));
  const StretchFiles files = filesOf(wanted);
  CHECK(existingFiles(wanted).empty());
  std::ofstream(files.probes) << "time [s]\n";
  fs::create_directories(files.picturesFolder);
  CHECK(existingFiles(wanted) == std::vector<fs::path>{files.probes, files.picturesFolder});
  wanted.hasProbes = false;
  CHECK(existingFiles(wanted) == std::vector<fs::path>{files.picturesFolder});
  CHECK(files.frames.filename() == "pull.pvd");
  CHECK(files.film.filename() == "pull.mp4");
  CHECK(pictureName(12) == "picture_000012.png");
}

TEST_CASE("A program is found in the folders of PATH, if it can be run") {
  if (pathListSeparator() != ':') return;
  const fs::path a = emptyFolder("path_a"), b = emptyFolder("path_b");
  std::ofstream(a / "tool") << "text";
  const std::string folders = "relative::" + pathText(a) + ":" + pathText(b);
  CHECK(findProgram("tool", folders).empty());
  std::ofstream(b / "tool") << "#!/bin/sh\n";
  fs::permissions(b / "tool", fs::perms::owner_exec, fs::perm_options::add);
  CHECK(findProgram("tool", folders) == b / "tool");
  CHECK(findProgram("tool", "").empty());
}
