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

TEST_CASE("a path that begins with slashes is no option") {
  std::string mesh = (std::filesystem::path(testResourcesFolder()) / "meshes/organ.obj").generic_string();
  mesh = mesh.substr(mesh.find('/'));  // without a drive: of the present one
  const auto result = runC3de({"info", mesh});
  INFO(result.errorOutput);
  CHECK(result.exitCode == 0);
  CHECK_THAT(result.output, Contains("2646"));
}

TEST_CASE("info goes on after a file that is refused, and ends with 3") {
  const auto folder = freshFolder("info-several");
  const auto good = writeFile(folder / "box.obj", boxObj());
  const auto bad = writeFile(folder / "bad.obj", "v 0 0 0\nf 1 2 9\n");
  const auto result = runC3de({"info", (folder / "absent.obj").string(), bad.string(), folder.string(), good.string()});
  CHECK(result.exitCode == 3);
  CHECK_THAT(result.errorOutput,
             Contains("absent.obj: no such file") && Contains("bad.obj") && Contains("holds no DICOM image"));
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

TEST_CASE("info tells what an image is, for people and for programs") {
  const auto folder = freshFolder("info-image");
  const auto image = writeFile(
      folder / "small.nrrd",
      "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 1 3\nspace: RAS\n"
      "space directions: (2,0,0) (0,3,0) (0,0,4.1)\nspace origin: (1,2,3)\nencoding: ascii\n\n-5 -4 1 2 3 40\n");
  writeFile(folder / "small.txt", "1 liver\n");
  const auto text = runC3de({"info", image.string()});
  CHECK(text.exitCode == 0);
  CHECK_THAT(text.output, Contains("int16, 2 x 1 x 3 voxels of 2 x 3 x 4.1 mm") && Contains("axes to R, A, S") &&
                              Contains("values -5 to 40"));
  const auto json = runC3de({"info", image.string(), "--json"});
  const auto parsed = nlohmann::json::parse(json.output);
  CHECK(parsed.at("kind") == "image");
  CHECK(parsed.at("size") == nlohmann::json({2, 1, 3}));
  CHECK(parsed.at("range") == nlohmann::json({-5.0, 40.0}));
  CHECK(parsed.at("index_to_world_mm").at(0) == nlohmann::json({-2.0, 0.0, 0.0, -1.0}));
  CHECK_FALSE(parsed.contains("labels"));  // several negative values: an image
  const auto cut =
      writeFile(folder / "cut.nrrd",
                "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 1 3\nspace: RAS\nencoding: ascii\n\n-5 0 1\n");
  const auto refused = runC3de({"info", cut.string()});
  CHECK(refused.exitCode == 3);
  CHECK_THAT(refused.errorOutput, Contains("cut.nrrd") && Contains("truncated: 3 of 6 voxels"));
}

TEST_CASE("info lists the series of a folder and shows the one that is chosen") {
  C3DE_DATA_OR_SKIP(folder, "dicom/mr_mixed_orientation_4");
  const auto list = runC3de({"info", folder.string(), "--json"});
  CHECK(list.exitCode == 0);
  const auto parsed = nlohmann::json::parse(list.output);
  REQUIRE(parsed.at("series").size() == 2);
  CHECK(parsed.at("series").at(0).at("orientation") == "oblique sagittal");
  CHECK_FALSE(parsed.at("series").at(0).contains("patient_name"));
  const auto one =
      runC3de({"info", folder.string(), "--series", parsed.at("series").at(1).at("id").get<std::string>()});
  CHECK(one.exitCode == 0);
  CHECK_THAT(one.output, Contains("288 x 288 x 2 voxels"));
  CHECK(runC3de({"info", folder.string(), "--series", "none"}).exitCode == 3);
  C3DE_DATA_OR_SKIP(named, "dicom/ct_head_phantom_philips_5mm");
  CHECK_THAT(runC3de({"info", named.string(), "--patient-names"}).output, Contains("patient: HEAD"));
  CHECK_THAT(runC3de({"info", named.string()}).output, !Contains("HEAD"));
}

TEST_CASE("A scene names a part of a series by the text that info prints") {
  C3DE_DATA_OR_SKIP(data, "dicom/mr_mixed_orientation_4");
  const auto list = runC3de({"info", data.string()});
  REQUIRE(list.exitCode == 0);
  const std::string prefix = "in a scene: ";
  const auto at = list.output.rfind(prefix);
  REQUIRE(at != std::string::npos);
  const std::string key = list.output.substr(at + prefix.size(), list.output.find('\n', at) - at - prefix.size());
  CHECK_THAT(key, Contains("series = ") && Contains("#2"));

  const auto folder = freshFolder("info-series");
  const auto described = [&](const std::string &series) {
    const auto scene =
        writeFile(folder / "scene.toml", "format = 1\n[image]\nfile = \"" + data.generic_string() + "\"\n" + series +
                                             "\n[[body]]\nname = \"a\"\nvolume = \"" + data.generic_string() + "\"\n" +
                                             series + "\nthreshold = [100, 100000]\n");
    return runC3de({"info", scene.string(), "--json", "--no-plugins"});
  };
  const auto both = described(key);
  REQUIRE(both.exitCode == 0);
  const auto parsed = nlohmann::json::parse(both.output);
  CHECK(parsed.at("image").at("size") == nlohmann::json({288, 288, 2}));
  CHECK(parsed.at("bodies").at(0).at("volume").at("voxels").get<int>() > 0);
  const auto brief = described("series = \"#2\"");  // the only series that has parts
  REQUIRE(brief.exitCode == 0);
  CHECK(nlohmann::json::parse(brief.output).at("image").at("index_to_world_mm") ==
        parsed.at("image").at("index_to_world_mm"));
  CHECK(nlohmann::json::parse(described("series = \"#1\"").output).at("image").at("index_to_world_mm") !=
        parsed.at("image").at("index_to_world_mm"));
  const auto absent = described("series = 77");
  CHECK(absent.exitCode == 3);
  CHECK_THAT(absent.errorOutput,
             Contains("scene.toml:2: ") && Contains("has no series '77'; there are:") && Contains("oblique axial"));
}
