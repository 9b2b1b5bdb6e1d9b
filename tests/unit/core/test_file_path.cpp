// SPDX-License-Identifier: Apache-2.0
// UNC paths, which only Windows has.
#include <filesystem>
#include <string>

#include "c3de/core/file_path.h"
#include "c3de/core/platform.h"
#include "support/catch.h"

using namespace c3de;

namespace fs = std::filesystem;

namespace {

bool isWindows() { return pathListSeparator() == ';'; }

}  // namespace

TEST_CASE("the root of a share is recognised") {
  CHECK(uncRootLength(L"\\\\server\\share\\dir\\a.toml") == 14);
  CHECK(uncRootLength(L"//server/share/dir") == 14);
  CHECK(uncRootLength(L"\\\\server\\share") == 14);
  CHECK(uncRootLength(L"\\\\?\\UNC\\server\\share\\dir") == 20);
  CHECK(uncRootLength(L"\\\\?\\unc\\server\\share\\dir") == 20);
  CHECK(uncRootLength(L"\\\\?\\C:\\dir\\a.toml") == 6);
  for (const wchar_t *none : {L"", L"\\", L"\\\\", L"\\\\server", L"\\\\server\\", L"\\\\server\\\\share", L"\\dir\\a",
                              L"C:\\dir", L"dir\\\\a", L"\\\\\\server\\share", L"\\\\?\\", L"\\\\?\\UNC\\server"}) {
    INFO(fs::path(none).string());
    CHECK(uncRootLength(none) == 0);
  }
}

TEST_CASE("paths of drives and folders are those of std::filesystem") {
  const fs::path root = fs::current_path().root_path(), folder = root / "one" / "two";
  CHECK(isAbsolutePath(folder));
  CHECK_FALSE(isAbsolutePath("two/a.toml"));
  CHECK(joinedPath(folder, "a.toml") == folder / "a.toml");
  CHECK(joinedPath(folder, root / "b.toml") == root / "b.toml");
  CHECK(normalPath(folder / ".." / "." / "a.toml") == root / "one" / "a.toml");
  CHECK(absolutePath("a.toml") == fs::current_path() / "a.toml");
  std::error_code code;
  CHECK(canonicalPath(folder / ".." / "a.toml", code) == fs::weakly_canonical(root / "one" / "a.toml"));
  CHECK_FALSE(code);
  CHECK(relativePath(folder / "a.toml", root / "one").generic_string() == "two/a.toml");
  CHECK(relativePath(root / "a.toml", folder).generic_string() == "../../a.toml");
  CHECK(genericPathText(folder) == folder.generic_string());
}

TEST_CASE("paths of shares keep their root on Windows") {
  const fs::path scene = "\\\\server\\share\\dir\\a.toml", folder = "\\\\server\\share\\dir";
  if (!isWindows()) {
    // A backslash is a character of a name.
    CHECK_FALSE(isAbsolutePath(scene));
    CHECK(joinedPath("/x", scene) == fs::path("/x") / scene);
    CHECK(isAbsolutePath("//server/share"));
    return;
  }
  std::error_code code;
  for (const char *root : {"\\\\server\\share", "\\\\?\\UNC\\server\\share", "\\\\?\\C:"}) {
    INFO(root);
    const fs::path whole = std::string(root) + "\\dir\\a.toml";
    CHECK(isAbsolutePath(whole));
    CHECK(joinedPath("C:\\x", whole) == whole);
    CHECK(joinedPath(whole.parent_path(), "b.obj").string() == std::string(root) + "\\dir\\b.obj");
    CHECK(normalPath(std::string(root) + "\\dir\\..\\.\\b.obj").string() == std::string(root) + "\\b.obj");
    CHECK(normalPath(root).string() == root);
    CHECK(absolutePath(whole, code).string() == whole.string());
    CHECK(canonicalPath(whole, code).string() == whole.string());
    CHECK_FALSE(code);
    CHECK(relativePath(whole, std::string(root) + "\\dir").string() == "a.toml");
    CHECK(genericPathText(whole).substr(genericPathText(whole).size() - 11) == "/dir/a.toml");
    CHECK(relativePath(whole, root).string() == "dir\\a.toml");
    CHECK(relativePath(root, root).string() == ".");
    CHECK(relativePath(whole, std::string(root) + "\\other").string() == "..\\dir\\a.toml");
    CHECK(relativePath(whole, "\\\\other\\share\\dir").empty());
    CHECK(relativePath(whole, "D:\\dir").empty());
    CHECK(relativePath("D:\\dir\\a.toml", whole).empty());
  }
  CHECK(normalPath("//server/share/dir/a.toml").string() == scene.string());
  CHECK(genericPathText(scene) == "//server/share/dir/a.toml");
  CHECK(relativePath("\\\\SERVER\\Share\\dir\\a.toml", folder).string() == "a.toml");
}
