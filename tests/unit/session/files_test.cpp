// SPDX-License-Identifier: Apache-2.0
// Interpretation of files and of words of the command line.
#include <fstream>

#include "c3de/session/file_kind.h"
#include "c3de/session/picture_view.h"
#include "c3de/session/resources.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::session;
namespace fs = std::filesystem;

TEST_CASE("Files are scenes, meshes or images by their names and first bytes, folders are images") {
  const fs::path folder = testOutputFolder();
  CHECK(kindOf("a.toml") == FileKind::scene);
  CHECK(kindOf("a.obj") == FileKind::mesh);
  CHECK(kindOf(folder) == FileKind::image);
  CHECK(kindOf("a.docx") == FileKind::unknown);
  std::ofstream(folder / "IM0001", std::ios::binary) << std::string(128, '\0') << "DICM" << std::string(64, '\0');
  std::ofstream(folder / "notes", std::ios::binary) << std::string(200, 'x');
  std::ofstream(folder / "a.nrrd", std::ios::binary) << "NRRD0004\n";
  CHECK(kindOf(folder / "IM0001") == FileKind::image);
  CHECK(kindOf(folder / "a.nrrd") == FileKind::image);
  CHECK(kindOf(folder / "none.nrrd") == FileKind::unknown);
  CHECK(kindOf(folder / "notes") == FileKind::unknown);
}

TEST_CASE("A file of no kind is named with all that is accepted") {
  const Error error = unknownKind("a.docx");
  CHECK(error.code == ErrorCode::input);
  CHECK_THAT(error.message, Contains("a.docx: is not a supported file") && Contains("scenes (.toml)") &&
                                Contains("DICOM") && Contains("meshes (.obj, ") && Contains(".vtp"));
}

TEST_CASE("A folder of plugins that is none is told apart from one that is not there") {
  const fs::path folder = testOutputFolder();
  std::ofstream(folder / "file") << "x";
  CHECK(notAFolder(folder / "file") ==
        (folder / "file").string() + ": is a file, not a folder; accepted: a folder of plugins");
  CHECK(notAFolder(folder / "none") == (folder / "none").string() + ": no such folder; accepted: a folder of plugins");
}

TEST_CASE("An image is called after its file or folder") {
  CHECK(imageName("scans/ct.nii.gz") == "ct.nii.gz");
  CHECK(imageName("scans/series 3/") == "series 3");
  CHECK(imageName("scans/a/../b") == "b");
}

TEST_CASE("Views have the names of the command line") {
  const std::pair<PictureView, std::string> names[] = {{PictureView::space, "3d"},
                                                       {PictureView::axial, "axial"},
                                                       {PictureView::sagittal, "sagittal"},
                                                       {PictureView::coronal, "coronal"},
                                                       {PictureView::four, "four-up"}};
  for (const auto &[view, name] : names) {
    CHECK(nameOf(view) == name);
    CHECK(pictureViewOf(name) == view);
  }
  CHECK_FALSE(pictureViewOf("top"));
  CHECK_FALSE(pictureViewOf(""));
}

TEST_CASE("Resources are found from the program, and one that is missing is told with where it was looked for") {
  const auto scene = findResource("scenes/first_light.toml");
  REQUIRE(scene);
  CHECK(fs::equivalent(*scene, fs::path(testResourcesFolder()) / "scenes" / "first_light.toml"));
  const auto none = findResource("scenes/none.toml");
  REQUIRE_FALSE(none);
  CHECK(none.error().code == ErrorCode::input);
  CHECK_THAT(none.error().message,
             Contains("'scenes/none.toml' is missing") && Contains("share") && Contains("none.toml, "));
}

TEST_CASE("The default scene is the head where its scan is installed, else an organ with the reason") {
  const auto scene = findDefaultScene();
  REQUIRE(scene);
  INFO(scene->notice);
  if (fs::exists("/usr/share/mricron/templates/ch2.nii.gz")) {
    CHECK(scene->file.filename() == "brain_living.toml");
    CHECK(scene->notice.empty());
  } else {
    CHECK(scene->file.filename() == "first_light.toml");
    CHECK_THAT(scene->notice, Contains("does not exist") && Contains("mricron-data"));
  }
}
