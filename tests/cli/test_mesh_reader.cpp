// SPDX-License-Identifier: Apache-2.0
// The example plugins/mesh_reader in the program: its files are opened like all others, broken ones are refused with
// the line.
#include "program.h"

namespace {

std::string reader() {
  return (std::filesystem::path(testExampleFolder()) / (std::string("mesh_reader") + c3de::pluginExtension())).string();
}

/// A box of 4 x 1 x 1 in the unit.
std::string boxTri(const std::string &unit) {
  std::string text = "trimesh 1\r\n# a box\nunit " + unit + "\n\n";
  for (int corner = 0; corner < 8; ++corner)
    text += std::string("v ") + (corner & 1 ? "4" : "0") + (corner & 2 ? " 1.0" : " 0") + (corner & 4 ? " 1e0" : " 0") +
            "\n";
  for (const char *t :
       {"0 4 6", "0 6 2", "1 3 7", "1 7 5", "0 1 5", "0 5 4", "2 6 7", "2 7 3", "0 2 3", "0 3 1", "4 5 7", "4 7 6"})
    text += std::string("t ") + t + "\n";
  return text + "end\n";
}

std::string replaced(std::string text, const std::string &what, const std::string &with) {
  return text.replace(text.find(what), what.size(), with);
}

}  // namespace

TEST_CASE("A format that a plugin brings is read by info, with its unit and report") {
  const auto folder = freshFolder("mesh-reader-info");
  const auto file = writeFile(folder / "box.tri", boxTri("cm")).string();
  const auto without = runC3de({"info", file, "--no-plugins"});
  CHECK(without.exitCode == 3);
  CHECK_THAT(without.errorOutput, Contains("box.tri") && Contains(".obj"));
  const auto with = runC3de({"info", file, "--json", "--no-plugins", "--plugin", reader()});
  REQUIRE(with.exitCode == 0);
  const auto json = nlohmann::json::parse(with.output);
  CHECK(json.at("kind") == "mesh");
  CHECK(json.at("fillable") == true);
  CHECK(json.at("closed") == true);
  CHECK_THAT(json.at("volume_mm3").get<double>(), WithinRel(4000.0, 1e-9));
  // Selected by its id for a file of another name; and for a file that is not of its format.
  const auto other = writeFile(folder / "box.obj", boxTri("mm")).string();
  const auto asked =
      runC3de({"info", other, "--json", "--no-plugins", "--plugin", reader(), "--reader", "org.c3de.trimesh"});
  REQUIRE(asked.exitCode == 0);
  CHECK_THAT(nlohmann::json::parse(asked.output).at("volume_mm3").get<double>(), WithinRel(4.0, 1e-9));
  const auto unknown = runC3de({"info", other, "--no-plugins", "--plugin", reader(), "--reader", "org.c3de.trymesh"});
  CHECK(unknown.exitCode == 2);
  CHECK_THAT(unknown.errorOutput, Contains("org.c3de.trymesh") && Contains("org.c3de.trimesh"));
}

TEST_CASE("A format that a plugin brings is simulated, by itself and as body and obstacle of a scene") {
  const auto folder = freshFolder("mesh-reader-run");
  const auto file = writeFile(folder / "box.tri", boxTri("cm"));
  const auto report = folder / "report.json";
  const auto alone = runC3de({"run", file.string(), "--steps", "2", "--plugin", reader(), "--report", report.string()});
  INFO(alone.errorOutput);
  REQUIRE(alone.exitCode == 0);
  CHECK_THAT(readJson(report).at("bodies").at(0).at("mesh_volume_m3").get<double>(), WithinRel(4e-6, 1e-6));
  const auto scene = writeFile(folder / "scene.toml",
                               "format = 1\n[[body]]\nname = \"box\"\nmesh = \"box.tri\"\nmesh_unit = \"cm\"\n"
                               "[[obstacle]]\nname = \"table\"\nmesh = \"box.tri\"\nmesh_unit = \"cm\"\n"
                               "position = [0.0, -0.2, 0.0]\n");
  const auto run = runC3de({"run", scene.string(), "--steps", "2", "--plugin", reader()});
  INFO(run.errorOutput);
  CHECK(run.exitCode == 0);
  const auto refused = runC3de({"run", scene.string(), "--steps", "2"});
  CHECK(refused.exitCode == 3);
  CHECK_THAT(refused.errorOutput, Contains("scene.toml:") && Contains("box.tri"));
}

TEST_CASE("A scene need not say the unit that a file of a plugin's format says") {
  const auto folder = freshFolder("mesh-reader-unit");
  (void)writeFile(folder / "box.tri", boxTri("cm"));
  const auto scene = writeFile(folder / "scene.toml", "format = 1\n[[body]]\nname = \"box\"\nmesh = \"box.tri\"\n");
  const auto report = folder / "report.json";
  const auto run = runC3de({"run", scene.string(), "--steps", "1", "--plugin", reader(), "--report", report.string()});
  INFO(run.errorOutput);
  REQUIRE(run.exitCode == 0);
  CHECK_THAT(readJson(report).at("bodies").at(0).at("mesh_volume_m3").get<double>(), WithinRel(4e-6, 1e-6));
  const auto without = runC3de({"run", scene.string(), "--steps", "1"});
  CHECK(without.exitCode == 3);
  CHECK_THAT(without.errorOutput, Contains("scene.toml:2") && Contains("formats of plugins (--plugin)"));
}

TEST_CASE("A surface is exported in a format that a plugin brings, and read again") {
  const auto folder = freshFolder("mesh-writer");
  const auto scene =
      writeFile(folder / "scene.toml",
                "format = 1\n[world]\ngravity = [0.0, 0.0, 0.0]\n[[body]]\nname = \"box\"\nmesh = \"box.tri\"\n"
                "mesh_unit = \"cm\"\n");
  (void)writeFile(folder / "box.tri", boxTri("cm"));
  const auto out = folder / "deformed.tri";
  const auto run =
      runC3de({"run", scene.string(), "--steps", "1", "--plugin", reader(), "--export-surface", out.string()});
  INFO(run.errorOutput);
  REQUIRE(run.exitCode == 0);
  const auto info = runC3de({"info", out.string(), "--json", "--plugin", reader()});
  INFO(info.errorOutput);
  REQUIRE(info.exitCode == 0);
  CHECK_THAT(nlohmann::json::parse(info.output).at("volume_mm3").get<double>(), WithinRel(4000.0, 1e-9));
  const auto without = runC3de({"run", scene.string(), "--steps", "1", "--export-surface", out.string()});
  CHECK(without.exitCode != 0);
  // Before anything is built.
  const auto unknown =
      runC3de({"run", scene.string(), "--plugin", reader(), "--export-surface", (folder / "deformed.trx").string()});
  CHECK(unknown.exitCode == 2);
  CHECK_THAT(unknown.errorOutput, Contains("'.trx' cannot be written; accepted: .obj, .stl, .ply, .vtp, .tri"));
  CHECK_FALSE(std::filesystem::exists(folder / "deformed.trx"));
}

TEST_CASE("Broken files of a plugin's format are refused with file, line, reader and plugin") {
  const auto folder = freshFolder("mesh-reader-broken");
  const std::string whole = boxTri("mm");
  struct Broken {
    std::string text, says;
  };
  const std::vector<Broken> all{
      {replaced(whole, "trimesh 1", "trimesh 2"), "does not have the signature of any .tri reader"},
      {replaced(whole, "unit mm", "unit inch"), "line 3: unit 'inch'; accepted: mm, cm, m"},
      {replaced(whole, "unit mm", "unit mm\nunit cm"), "line 4: a second unit"},
      {replaced(whole, "unit mm", ""), "line 5: a vertex before 'unit'"},
      {replaced(whole, "1e0", "nan"), "line 9: a coordinate that is not finite"},
      {replaced(whole, "1e0", "one"), "line 9: 'one' where a coordinate is expected"},
      {replaced(whole, "t 0 4 6", "t 0 4"), "line 13: '' where the number of a vertex"},
      {replaced(whole, "t 0 4 6", "t 0 4 6 9"), "line 13: '9' after three numbers"},
      {replaced(whole, "t 0 4 6", "t 0 4 8"), "a triangle has vertex 8, there are 8"},
      {replaced(whole, "t 0 4 6", "f 0 4 6"), "line 13: 'f'; accepted"},
      {replaced(whole, "end\n", ""), "line 24: the file ends without 'end'"},
      {whole + "v 1 2 3\n", "follows after 'end'"},
      {"trimesh 1\nunit mm\nend\n", "no faces"},
      {"", "empty"}};
  for (std::size_t i = 0; i < all.size(); ++i) {
    INFO(all[i].says);
    const auto file = writeFile(folder / (std::to_string(i) + ".tri"), all[i].text);
    const auto result = runC3de({"info", file.string(), "--no-plugins", "--plugin", reader()});
    CHECK(result.exitCode == 3);
    CHECK_THAT(result.errorOutput, Contains(all[i].says) && Contains(std::to_string(i) + ".tri"));
    if (i > 0 && i + 1 < all.size())
      CHECK_THAT(result.errorOutput, Contains("reader 'org.c3de.trimesh' of org.c3de.mesh_reader"));
  }
}
