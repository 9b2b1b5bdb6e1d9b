// SPDX-License-Identifier: Apache-2.0
#include "program.h"

TEST_CASE("info tells what a mesh is, for people and for programs") {
  const auto folder = freshFolder("info-mesh");
  const auto mesh = writeFile(folder / "box.obj", boxObj());
  const auto text = runC3de({"info", mesh.string(), "--unit", "m"});
  CHECK(text.exitCode == 0);
  CHECK_THAT(text.output, Contains("box.obj") && Contains("12"));

  const auto json = runC3de({"info", mesh.string(), "--unit", "m", "--json"});
  CHECK(json.exitCode == 0);
  const auto parsed = nlohmann::json::parse(json.output);
  CHECK(parsed.at("kind") == "mesh");
  CHECK(parsed.at("vertices") == 8);
  CHECK(parsed.at("triangles") == 12);
  CHECK(parsed.at("closed") == true);
  CHECK(parsed.at("fillable") == true);
}

TEST_CASE("info goes on after a file that is refused, and ends with 3") {
  const auto folder = freshFolder("info-several");
  const auto good = writeFile(folder / "box.obj", boxObj());
  const auto bad = writeFile(folder / "bad.obj", "v 0 0 0\nf 1 2 9\n");
  const auto result = runC3de({"info", (folder / "absent.obj").string(), bad.string(), folder.string(), good.string()});
  CHECK(result.exitCode == 3);
  CHECK_THAT(result.errorOutput, Contains("absent.obj: no such file") && Contains("bad.obj") && Contains("is a folder"));
  CHECK_THAT(result.output, Contains("box.obj"));

  const auto json = runC3de({"info", "--json", bad.string(), good.string()});
  CHECK(json.exitCode == 3);
  const auto parsed = nlohmann::json::parse(json.output);
  REQUIRE(parsed.size() == 2);
  CHECK(parsed.at(0).contains("error"));
  CHECK(parsed.at(1).at("vertices") == 8);
}

TEST_CASE("info checks a scene: its meshes, and its keys with the simulator") {
  const auto folder = freshFolder("info-scene");
  const auto scene = writeBoxScene(folder);
  const auto json = runC3de({"info", scene.string(), "--json"});
  INFO(json.errorOutput);
  CHECK(json.exitCode == 0);
  const auto parsed = nlohmann::json::parse(json.output);
  CHECK(parsed.at("title") == "Falling box");
  CHECK(parsed.at("checked_by_simulator") == true);
  CHECK(parsed.at("bodies").at(0).at("params").at("material.youngs_modulus") == 1e4);

  const auto typo = writeFile(folder / "typo.toml", R"(format = 1
[[body]]
mesh = "box.obj"
mesh_unit = "m"
material = { yungs_modulus = 1e4 }
)");
  const auto refused = runC3de({"info", typo.string()});
  CHECK(refused.exitCode == 3);
  CHECK_THAT(refused.errorOutput, Contains("typo.toml:5: ") && Contains("did you mean 'material.youngs_modulus'?"));

  const auto unchecked = runC3de({"info", typo.string(), "--no-plugins"});
  CHECK(unchecked.exitCode == 0);
  CHECK_THAT(unchecked.output, Contains("not checked"));
}
