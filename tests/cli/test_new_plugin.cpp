// SPDX-License-Identifier: Apache-2.0
// Output and refusals of new-plugin; ctest -R sdk checks that the output builds and loads.
#include "program.h"

TEST_CASE("new-plugin writes source, build file and README in the name of the plugin") {
  const auto folder = freshFolder("new-plugin");
  const struct {
    std::string name, language, kind, file, cls, title;
  } all[] = {{"heart_beat", "c++", "panel", "heart_beat.cpp", "class HeartBeat", "Heart beat"},
             {"pointer2", "c++", "tool", "pointer2.cpp", "class Pointer2", "Pointer2"},
             {"wind", "c++", "force-field", "wind.cpp", "class Wind", "Wind"},
             {"fall", "c++", "simulator", "fall.cpp", "class FallSimulator", "Fall"},
             {"soft_law", "c++", "material-law", "soft_law.cpp", "class SoftLawLaw", "Soft law"},
             {"two_lists", "c++", "mesh-format", "two_lists.cpp", "class TwoLists", "Two lists"},
             {"c_panel", "c", "panel", "c_panel.c", "c3de_plugin_query", "C panel"},
             {"c_wind", "c", "force-field", "c_wind.c", "c3de_plugin_query", "C wind"}};
  for (const auto &one : all) {
    INFO(one.name);
    const auto result =
        runC3de({"new-plugin", one.name, "--language", one.language, "--kind", one.kind, "--folder", folder.string()});
    CHECK(result.exitCode == 0);
    CHECK_THAT(result.output, Contains("cmake --build") && Contains(one.name));
    const std::string source = readFile(folder / one.name / one.file);
    CHECK_THAT(source, Contains(one.cls) && Contains("org.example." + one.name) && Contains("\"" + one.title + "\""));
    const std::string build = readFile(folder / one.name / "CMakeLists.txt");
    CHECK_THAT(build, Contains("c3de_add_plugin(" + one.name + " SOURCES " + one.file));
    const std::string readme = readFile(folder / one.name / "README.md");
    CHECK_THAT(readme, Contains("# " + one.title) && Contains("build/" + one.name + ".so"));
    for (const std::string &text : {source, build, readme})
      for (const char *left : {"my_plugin", "MyPlugin", "My plugin", "MySimulator"})
        CHECK(text.find(left) == std::string::npos);
  }
}

TEST_CASE("new-plugin refuses bad names, what it has no template for, and folders that are there") {
  const auto folder = freshFolder("new-plugin-refused");
  for (const char *name : {"", "x", "Heart", "heart beat", "2hearts", "heart_", "../heart", "herz-schlag", "häuser"}) {
    INFO(name);
    const auto result = runC3de({"new-plugin", name, "--folder", folder.string()});
    CHECK(result.exitCode == 2);
    CHECK_THAT(result.errorOutput, Contains("lower-case letters, digits and _") || Contains("NAME"));
  }
  CHECK_THAT(runC3de({"new-plugin", "test", "--folder", folder.string()}).errorOutput, Contains("taken by CMake"));
  const auto kind =
      runC3de({"new-plugin", "heart", "--language", "c", "--kind", "simulator", "--folder", folder.string()});
  CHECK(kind.exitCode == 2);
  CHECK_THAT(kind.errorOutput,
             Contains("--language c --kind simulator") && Contains("--language c++ --kind simulator"));
  CHECK(std::filesystem::is_empty(folder));

  std::filesystem::create_directories(folder / "heart");
  const auto kept = writeFile(folder / "heart" / "notes.txt", "mine");
  const auto there = runC3de({"new-plugin", "heart", "--folder", folder.string()});
  CHECK(there.exitCode != 0);
  CHECK_THAT(there.errorOutput, Contains("heart") && Contains("already exists"));
  CHECK(readFile(kept) == "mine");
  CHECK_FALSE(std::filesystem::exists(folder / "heart" / "CMakeLists.txt"));
}
