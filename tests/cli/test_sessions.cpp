// SPDX-License-Identifier: Apache-2.0
// Session files: a run that goes on from one is the run that was not interrupted.
#include <regex>

#include "program.h"
#include "support/environment.h"

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

/// The hash after so many steps, counted from the beginning of the scene.
std::string hashAfter(const fs::path &file, const std::string &steps, std::vector<std::string> more = {}) {
  more.insert(more.end(), {"--steps", steps});
  return runToReport(file, more).at("state_hash").get<std::string>();
}

std::string refusal(const fs::path &file, std::vector<std::string> more = {}) {
  more.insert(more.begin(), {"run", file.string()});
  const auto result = runC3de(more);
  CHECK(result.exitCode == 3);
  return result.errorOutput;
}

}  // namespace

TEST_CASE("A run that goes on from a session is the uninterrupted run, bit for bit", "[session][slow]") {
  const fs::path folder = freshFolder("sessions"), scenes = fs::path(testResourcesFolder()) / "scenes";
  const std::string springs =
      (fs::path(testExampleFolder()) / ("mass_spring" + std::string(c3de::pluginExtension()))).string();
  const std::string material = "[[body]]\nname = \"bar\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\nmaterial = { ";
  writeFile(folder / "box.obj", boxObj());
  const std::string supported =
      "\n[[fix]]\nbody = \"bar\"\nregion = { half_space = { point = [0.01, 0, 0], normal = [1, 0, 0] } }\n";
  struct Case {
    fs::path scene;
    std::string half, whole;
    std::vector<std::string> options;  ///< of the scene
    std::vector<std::string> plugins{};
    bool isIterative = false;  ///< solvers start anew when a state is stored
  };
  const std::vector<Case> cases{
      {scenes / "first_light.toml", "300", "500", {}},                                   // contact with an obstacle
      {scenes / "first_light.toml", "100", "150", {"--set", "world.gravity=[0,-3,0]"}},  // an override
      {scenes / "cantilever.toml", "4", "8", {}, {}, true},
      {scenes / "springs.toml", "100", "200", {}, {"--plugin", springs}},  // another simulator
      {writeFile(folder / "implicit.toml",
                 "format = 1\n[world]\ngravity = [0, -9.81, 0]\n[solver]\nintegrator = \"implicit\"\ndt = 0.01\n" +
                     material + "youngs_modulus = 1e4 }" + supported),
       "5",
       "10",
       {},
       {},
       true},
      {writeFile(folder / "static.toml",
                 "format = 1\n[world]\ngravity = [0, -9.81, 0]\n[solver]\nintegrator = \"quasistatic\"\n" + material +
                     "youngs_modulus = 1e4 }" + supported),
       "1",
       "2",
       {},
       {},
       true},
      {writeFile(folder / "plastic.toml", "format = 1\n[world]\ngravity = [0, -9.81, 0]\n" + material +
                                              "youngs_modulus = 1e4, plastic = { yield = 0.01, creep = 0.5 } }" +
                                              supported),
       "60",
       "120",
       {}},
      // Jaws that close, lift and turn.
      {writeFile(folder / "jaws.toml",
                 "format = 1\n[solver]\ndamping = 10\n" + material +
                     "youngs_modulus = 2e4 }\nsampling = { spacing = 0.05 }\n[[fix]]\nbody = \"bar\"\nregion = { "
                     "half_space = { point = [0, 0, 0], normal = [0, 1, 0] } }\n[[grasp]]\nat = [0.5, 0.2, 0.1]\n"
                     "axis = [1, 0, 0]\njaw_mm = 100\nopening_mm = 200\nclosed_mm = 180\npath = [ { time = 0, at = "
                     "[0.5, 0.2, 0.1] }, { time = 1, at = [0.5, 0.24, 0.1], turn_deg = [0, 20, 0] } ]\n"),
       "80",
       "160",
       {}}};
  for (const Case &one : cases) {
    CAPTURE(one.scene, one.half);
    const fs::path session = folder / "saved.c3de";
    std::vector<std::string> options = one.options;
    options.insert(options.end(), one.plugins.begin(), one.plugins.end());
    std::vector<std::string> saving = options;
    saving.insert(saving.end(), {"--save-session", session.string()});
    const std::string half = hashAfter(one.scene, one.half, saving);
    const json info = json::parse(runC3de({"info", session.string(), "--json"}).output);
    CHECK(info["state_hash"] == half);
    CHECK(std::to_string(info["steps"].get<int>()) == one.half);
    const std::string whole = hashAfter(one.scene, one.whole, options);
    const std::string resumed = hashAfter(session, one.whole, one.plugins);
    CHECK((resumed == whole || one.isIterative));
    std::vector<std::string> threads = one.plugins;
    threads.insert(threads.end(), {"--threads", "7"});
    CHECK(hashAfter(session, one.whole, threads) == resumed);
    CHECK(whole != half);
  }
}

TEST_CASE("A session finds files that have moved with it, and names those that are missing or have changed",
          "[session]") {
  const fs::path folder = freshFolder("session_files");
  const fs::path scene = writeBoxScene(folder), session = folder / "a.c3de";
  const std::string half = hashAfter(scene, "10", {"--save-session", session.string()});
  const fs::path elsewhere = folder / "elsewhere";
  fs::create_directories(elsewhere);
  fs::copy_file(session, elsewhere / "b.c3de");
  CHECK_THAT(refusal(elsewhere / "b.c3de"), Contains("box.obj: is missing"));
  CHECK_THAT(runC3de({"info", (elsewhere / "b.c3de").string()}).output, Contains("box.obj: missing"));
  fs::copy_file(folder / "box.obj", elsewhere / "box.obj");
  CHECK(hashAfter(elsewhere / "b.c3de", "10") == half);
  writeFile(elsewhere / "box.obj", boxObj() + "# longer\n");
  CHECK_THAT(refusal(elsewhere / "b.c3de"), Contains("box.obj: has changed"));

  // Named by another folder, and found beside the session.
  fs::create_directories(folder / "away");
  fs::rename(folder / "box.obj", folder / "away" / "box.obj");
  writeFile(folder / "away.toml", std::regex_replace(readFile(scene), std::regex("box.obj"), "away/box.obj"));
  const fs::path other = folder / "other.c3de";
  const std::string moved = hashAfter(folder / "away.toml", "10", {"--save-session", other.string()});
  fs::rename(folder / "away" / "box.obj", folder / "box.obj");
  CHECK(hashAfter(other, "10") == moved);

  // The state belongs to the scene as it was saved.
  CHECK_THAT(refusal(session, {"--set", "world.gravity=[0,0,-1]"}), Contains("belongs to another scene"));
  const auto twice = runC3de({"run", session.string(), "--from-state", "x"});
  CHECK(twice.exitCode == 2);
  CHECK_THAT(twice.errorOutput, Contains("a session has its own state"));
}

TEST_CASE("A session with its files runs where they are missing, and keeps them", "[session]") {
  const fs::path folder = freshFolder("session_embedded");
  const ScopedEnvironment home("C3DE_HOME", (folder / "home").string());
  const fs::path scene = writeBoxScene(folder), first = folder / "a.c3de", elsewhere = folder / "elsewhere";
  const std::string half = hashAfter(scene, "10", {"--save-session", first.string(), "--embed"});
  fs::create_directories(elsewhere);
  fs::rename(first, elsewhere / "b.c3de");
  fs::remove(folder / "box.obj");
  const json info = json::parse(runC3de({"info", (elsewhere / "b.c3de").string(), "--json"}).output);
  REQUIRE(info["files"].size() == 1);
  CHECK(info["files"][0]["state"] == "embedded");
  CHECK_THAT(info["files"][0]["path"].get<std::string>(), Contains("/box.obj"));
  CHECK(hashAfter(elsewhere / "b.c3de", "10") == half);
  // Saved again without the option; the extracted files are not needed.
  CHECK(hashAfter(elsewhere / "b.c3de", "10", {"--save-session", (elsewhere / "c.c3de").string()}) == half);
  fs::remove_all(folder / "home");
  fs::remove(elsewhere / "b.c3de");
  CHECK(hashAfter(elsewhere / "c.c3de", "10") == half);
  // Programs that have ended use nothing.
  for (const auto &entry : fs::recursive_directory_iterator(folder / "home" / "cache" / "embedded"))
    CHECK(entry.path().extension() != ".lock");

  const auto alone = runC3de({"run", scene.string(), "--embed"});
  CHECK(alone.exitCode == 2);
  CHECK_THAT(alone.errorOutput, Contains("--save-session"));
}

TEST_CASE("Folders are searched for files of a session that have moved", "[session]") {
  const fs::path folder = freshFolder("session_searched");
  const fs::path scene = writeBoxScene(folder), session = folder / "case" / "a.c3de", disk = folder / "disk" / "deep";
  fs::create_directories(session.parent_path());
  fs::create_directories(disk);
  const std::string half = hashAfter(scene, "10", {"--save-session", session.string()});
  fs::rename(folder / "box.obj", disk / "other_name.obj");
  CHECK_THAT(refusal(session), Contains("box.obj: is missing") && Contains("--search FOLDER"));
  const std::vector<std::string> search{"--search", session.parent_path().string(), "--search",
                                        disk.parent_path().string()};
  std::vector<std::string> info{"info", session.string(), "--json"};
  info.insert(info.end(), search.begin(), search.end());
  const json described = json::parse(runC3de(info).output);
  CHECK(described["files"][0]["state"] == "same");
  CHECK(fs::path(described["files"][0]["at"].get<std::string>()) == disk / "other_name.obj");
  std::vector<std::string> saving = search;
  saving.insert(saving.end(), {"--save-session", (folder / "b.c3de").string()});
  CHECK(hashAfter(session, "10", saving) == half);
  // The place is stored.
  CHECK(hashAfter(folder / "b.c3de", "10") == half);
  const json found = json::parse(runC3de({"info", (folder / "b.c3de").string(), "--json"}).output);
  CHECK(found["files"][0]["path"] == "disk/deep/other_name.obj");
  CHECK_THAT(refusal(session, {"--search", (folder / "none").string()}), Contains("none: there is no such folder"));
  CHECK(runC3de({"run", scene.string(), "--search", folder.string()}).exitCode == 2);
}

TEST_CASE("A session of the first format is opened by every later version", "[session]") {
  const fs::path folder = freshFolder("session_kept"), file = folder / "a.c3de";
  const ScopedEnvironment home("C3DE_HOME", (folder / "home").string());
  fs::copy_file(fs::path(C3DE_KEPT_SESSIONS) / "box-1.c3de", file);
  const json info = json::parse(runC3de({"info", file.string(), "--json"}).output);
  CHECK(info["title"] == "Falling box");
  CHECK(info["files"][0]["state"] == "embedded");
  // The same as the scene.
  CHECK(hashAfter(file, "10") == hashAfter(writeBoxScene(folder), "10"));
}

TEST_CASE("Saving a session that was opened changes nothing in it but its time", "[session]") {
  const fs::path folder = freshFolder("session_again");
  const fs::path scene = writeBoxScene(folder), first = folder / "a.c3de", second = folder / "b.c3de";
  (void)hashAfter(scene, "10", {"--save-session", first.string()});
  (void)hashAfter(first, "10", {"--save-session", second.string()});
  const auto described = [](const fs::path &file) {
    json info = json::parse(runC3de({"info", file.string(), "--json"}).output);
    info.erase("saved");
    info.erase("file");
    return info;
  };
  CHECK(described(first) == described(second));
  const auto onto = runC3de({"run", first.string(), "--save-session", first.string()});
  CHECK(onto.exitCode == 2);
  CHECK_THAT(onto.errorOutput, Contains("a.c3de"));
}
