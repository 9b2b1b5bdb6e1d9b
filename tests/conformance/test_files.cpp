// SPDX-License-Identifier: Apache-2.0
// The output of plugin readers becomes a mesh like any other, or is refused with file, reader and plugin.
#include <atomic>
#include <fstream>
#include <thread>

#include "c3de/geometry/mesh_formats.h"
#include "host_fixture.h"
#include "support/folders.h"

using namespace c3de;

namespace {

struct ReadersHost : test::HostFixture {
  ReadersHost() {
    std::filesystem::create_directories(folder);
    CHECK(refusalOf(testPlugin("mesh_readers")) == "");
  }
  std::filesystem::path file(const std::string &name, const std::string &text = "something") const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }
  std::string errorOf(const std::string &name) {
    const auto loaded = meshFormats.load(file(name), std::nullopt);
    REQUIRE_FALSE(loaded);
    CHECK_THAT(loaded.error().message, Contains(name) && Contains("test.mesh_readers"));
    return loaded.error().message;
  }
  std::filesystem::path folder = std::filesystem::path(testOutputRoot()) / "mesh_readers";
};

}  // namespace

TEST_CASE("what a reader of a plugin gives is welded, oriented and reported, in the unit that the file says") {
  ReadersHost f;
  const auto path = f.file("a.good");
  CHECK(f.meshFormats.isMeshFile(path));
  CHECK(f.meshFormats.unitInFile(path) == geometry::LengthUnit::centimetre);
  std::vector<double> told;
  const auto loaded = f.meshFormats.load(path, std::nullopt, [&](double fraction, const std::string &) {
    told.push_back(fraction);
    return true;
  });
  REQUIRE(loaded);
  CHECK(loaded->mesh.vertices.size() == 4);
  CHECK(loaded->report.closed);
  CHECK_THAT(loaded->report.volume_mm3, WithinRel(1000.0 / 6.0, 1e-9));
  CHECK_THAT(loaded->report.text(), Contains("read 9 bytes") && Contains("1 copy of another triangle was dropped"));
  CHECK(told.size() >= 4);

  const auto asked = f.meshFormats.load(path, geometry::LengthUnit::millimetre);
  REQUIRE(asked);
  CHECK_THAT(asked->report.volume_mm3, WithinRel(1.0 / 6.0, 1e-9));
  CHECK_THAT(asked->report.text(), Contains("it was read in mm, as requested"));
}

TEST_CASE("malformed output of a reader is refused with what, where and who") {
  ReadersHost f;
  CHECK_THAT(f.errorOf("a.nan"), Contains("row 2") && Contains("nan"));
  CHECK_THAT(f.errorOf("a.range"), Contains("vertex index 7") && Contains("there are 4"));
  CHECK_THAT(f.errorOf("a.unit"), Contains("unit is 17"));
  CHECK_THAT(f.errorOf("a.throws"), Contains("line 12: the author did not think of this"));
  CHECK_THAT(f.errorOf("a.empty"), Contains("no faces"));
  CHECK_THAT(f.errorOf("a.mute"), Contains("C3DE_E_IO"));
  CHECK_THAT(f.errorOf("a.itself"), Contains("cannot be removed while it works"));
  const auto absent = f.meshFormats.load(f.folder / "absent.good", std::nullopt);
  REQUIRE_FALSE(absent);
  CHECK_THAT(absent.error().message, Contains("absent.good"));
}

TEST_CASE("an extension stays with who had it first, the other reader is had by its id") {
  ReadersHost f;
  CHECK(f.linesWith(".obj is read by the program itself, by the reader 'test.good' of test.mesh_readers").size() == 1);
  CHECK(f.linesWith(".good is read by the reader 'test.good'").size() == 1);
  const std::string quad = "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const auto path = f.file("a.obj", quad);
  const auto own = f.meshFormats.load(path, std::nullopt);
  REQUIRE(own);
  CHECK_THAT(own->report.volume_mm3, WithinRel(8.0 / 6.0, 1e-9));
  const auto asked = f.meshFormats.load(path, std::nullopt, {}, "test.good");
  REQUIRE(asked);
  CHECK_THAT(asked->report.volume_mm3, WithinRel(1000.0 / 6.0, 1e-9));
  const auto nobody = f.meshFormats.load(path, std::nullopt, {}, "test.god");
  REQUIRE_FALSE(nobody);
  CHECK_THAT(nobody.error().message, Contains("'test.god'") && Contains("test.good"));
}

TEST_CASE("a read is cancelled, and ends with its plugin") {
  ReadersHost f;
  const auto path = f.file("a.slow");
  int asked = 0;
  const auto cancelled =
      f.meshFormats.load(path, std::nullopt, [&](double, const std::string &) { return ++asked < 5; });
  REQUIRE_FALSE(cancelled);
  CHECK(cancelled.error().code == ErrorCode::cancelled);
  CHECK(asked == 5);

  std::atomic<bool> isReading{false};
  Expected<geometry::LoadedMesh> read = fail(ErrorCode::internal, "not read");
  std::thread reader([&] {
    read = f.meshFormats.load(path, std::nullopt, [&](double fraction, const std::string &) {
      if (fraction > 0.0) isReading = true;
      return true;
    });
  });
  while (!isReading) std::this_thread::yield();
  f.host.reset();
  reader.join();
  CHECK_FALSE(read);
  CHECK_FALSE(f.meshFormats.isMeshFile(path));
  CHECK(f.meshFormats.readers().empty());
}
