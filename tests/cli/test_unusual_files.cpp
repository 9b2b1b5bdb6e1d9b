// SPDX-License-Identifier: Apache-2.0
// Paths without a regular file, meshes in several units, terminals that close.
#include <algorithm>

#include "c3de/core/path_text.h"
#include "program.h"
#include "support/gltf.h"
#include "support/pipes.h"

using namespace c3de;

TEST_CASE("A glTF is in metres for info, run and scenes alike") {
  const auto folder = freshFolder("gltf-units");
  const auto mesh = writeFile(folder / "m.glb", test::glb());
  const auto edgeOf = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"info", "--json", mesh.string()});
    const auto told = runC3de(options);
    INFO(told.errorOutput);
    REQUIRE(told.exitCode == 0);
    const auto report = nlohmann::json::parse(told.output);
    return report["box_max_mm"][0].get<double>() - report["box_min_mm"][0].get<double>();
  };
  CHECK_THAT(edgeOf({}), WithinRel(100.0, 1e-5));
  CHECK_THAT(edgeOf({"--unit", "cm"}), WithinRel(1.0, 1e-5));
  const auto scene = writeFile(folder / "scene.toml", "format = 1\n[[body]]\nmesh = \"m.glb\"\n");
  const auto massOf = [&](const std::filesystem::path &file, const std::vector<std::string> &more = {}) {
    std::vector<std::string> options{
        "run", file.string(), "--steps", "1", "-q", "--report", (folder / "r.json").string()};
    options.insert(options.end(), more.begin(), more.end());
    const auto ran = runC3de(options);
    INFO(ran.errorOutput);
    REQUIRE(ran.exitCode == 0);
    return readJson(folder / "r.json")["bodies"][0]["mass_kg"].get<double>();
  };
  const double mass = massOf(scene);
  CHECK_THAT(massOf(mesh), WithinRel(mass, 1e-9));
  CHECK_THAT(massOf(mesh, {"--unit", "m"}), WithinRel(mass, 1e-9));
}

TEST_CASE("Names in any script, and long ones, are read and written") {
  auto folder = freshFolder("any-script") / pathFromText("Größe 肝臓 😀");
  // Together beyond the 260 characters that Windows has allowed for long.
  for (const char letter : {'a', 'b', 'c'}) folder /= std::string(90, letter);
  std::filesystem::create_directories(folder);
  writeBoxScene(folder);
  const auto mesh = folder / pathFromText("Körper é.obj"), scene = folder / pathFromText("場面.toml");
  std::filesystem::rename(folder / "box.obj", mesh);
  writeFile(scene, "format = 1\n[[body]]\nmesh = \"Körper é.obj\"\nmesh_unit = \"m\"\n");
  const auto info = runC3de({"info", pathText(mesh)});
  INFO(info.errorOutput);
  CHECK(info.exitCode == 0);
  CHECK_THAT(info.output, Contains(pathText(mesh.filename())));
  const auto report = folder / pathFromText("отчёт 😀.json"), session = folder / pathFromText("sitzung ß.c3de");
  const auto ran = runC3de({"run", pathText(scene), "--steps", "2", "-q", "--report", pathText(report),
                            "--save-session", pathText(session)});
  INFO(ran.errorOutput);
  CHECK(ran.exitCode == 0);
  CHECK(readJson(report)["bodies"].size() == 1);
  CHECK(runC3de({"info", pathText(session)}).exitCode == 0);
}

TEST_CASE("A scene names its mesh with backslashes") {
  const auto folder = freshFolder("backslashes");
  std::filesystem::create_directories(folder / "meshes");
  writeFile(folder / "meshes" / "box.obj", boxObj());
  const auto told =
      runC3de({"info", "--quick",
               writeFile(folder / "scene.toml", "format = 1\n[[body]]\nmesh = 'meshes\\box.obj'\nmesh_unit = \"m\"\n")
                   .string()});
  INFO(told.errorOutput);
  CHECK(told.exitCode == 0);
}

#if !defined(_WIN32)
TEST_CASE("A pipe in place of any input is refused at once, by name") {
  const auto folder = freshFolder("pipes");
  const auto pipe = [&](const char *name) { return test::pipeAt(folder / name).string(); };
  const auto scene = writeBoxScene(folder).string();
  const auto sceneWith = [&](const char *name, const std::string &text) {
    return writeFile(folder / name, "format = 1\n" + text).string();
  };
  pipe("mesh.obj");
  pipe("image.nrrd");
  pipe("image.mha");
  const std::vector<std::vector<std::string>> commands{
      {"info", pipe("a.obj")},
      {"info", pipe("a.glb")},
      {"info", pipe("a.nii.gz")},
      {"info", pipe("a.toml")},
      {"info", pipe("a.xyz")},
      {"run", pipe("b.stl")},
      {"run", pipe("b.toml")},
      {"run", sceneWith("s1.toml", "[[body]]\nmesh = \"mesh.obj\"\n")},
      {"run", sceneWith("s2.toml", "[[body]]\nvolume = \"image.nrrd\"\nlabel = 1\n")},
      {"run", sceneWith("s3.toml", "[[body]]\nmesh = \"box.obj\"\nmesh_unit = \"m\"\n[image]\nfile = \"image.mha\"\n")},
      {"run", scene, "--steps", "1", "--from-state", pipe("c.state")},
      {"run", scene, "--steps", "1", "--sample-points", pipe("c.csv"), "--sampled", (folder / "out.csv").string()},
      {"run", scene, "--steps", "1", "--plugin", pipe("c.so")},
      {"study", pipe("study.toml"), "--out", (folder / "study").string()},
  };
  for (const auto &command : commands) {
    std::string shown;
    for (const std::string &word : command) shown += word + " ";
    INFO(shown);
    const auto answered = runC3de(command);  // which fails where it hangs
    INFO(answered.errorOutput);
    CHECK(answered.exitCode != 0);
    CHECK(answered.exitCode < 128);
    CHECK_THAT(answered.errorOutput, Contains("pipe") || Contains("not a file"));
  }
}

namespace {

/// Starts a long run in a shell, sends it signals once it steps, and returns its exit code.
int exitCodeAfter(const std::filesystem::path &folder, const std::string &signals, const std::string &before = "",
                  const std::string &until = "1000") {
  const auto scene = writeBoxScene(folder);
  const std::string script =
      before + "'" C3DE_PROGRAM "' run '" + scene.string() + "' -q --until " + until + " --report '" +
      (folder / "report.json").string() + "' --export '" + (folder / "all.pvd").string() +
      "' --export-every 0.01 >/dev/null 2>&1 & pid=$!\n"
      "n=0; while [ -z \"$(find '" +
      folder.string() + "' -name '*.vtp')\" ] && [ $n -lt 1200 ]; do sleep 0.1; n=$((n+1)); done\n" + signals +
      "wait $pid\n";
  const auto ran = runProcess({"sh", "-c", script}, 280.0);
  REQUIRE(ran);
  CHECK_FALSE(ran->timedOut);
  return ran->exitCode;
}

}  // namespace

TEST_CASE("A run whose terminal closes ends with its report") {
  const auto once = freshFolder("hang-up");
  CHECK(exitCodeAfter(once, "kill -HUP $pid\n") == 130);
  CHECK(readJson(once / "report.json")["outcome"] == "interrupted");
  // Shell and kernel send one each.
  const auto twice = freshFolder("hang-up-twice");
  CHECK(exitCodeAfter(twice, "kill -HUP $pid; kill -HUP $pid; kill -CONT $pid; kill -HUP $pid\n") == 130);
  CHECK(readJson(twice / "report.json")["outcome"] == "interrupted");
}

TEST_CASE("A run that is to outlive its terminal goes on when it closes") {
  const auto folder = freshFolder("nohup");
  CHECK(exitCodeAfter(folder, "kill -HUP $pid\n", "trap '' HUP\n", "0.1") == 0);
  CHECK(readJson(folder / "report.json")["outcome"] == "done");
}
#endif
