// SPDX-License-Identifier: Apache-2.0
// Recordings: a replay is the recorded run, and says where it is not.
#include <chrono>
#include <thread>

#include "program.h"
#include "support/environment.h"
#include "support/recording_records.h"

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

/// Runs and records; returns the state hash of the end.
std::string record(const fs::path &scene, const fs::path &recording, std::vector<std::string> more) {
  more.insert(more.end(), {"--record", recording.string(), "-q"});
  return runToReport(scene, more).at("state_hash").get<std::string>();
}

c3de::ProcessResult replay(const fs::path &recording, std::vector<std::string> more = {}) {
  more.insert(more.begin(), {"replay", recording.string()});
  return runC3de(more);
}

json infoOf(const fs::path &file) { return json::parse(runC3de({"info", file.string(), "--json"}).output); }

/// Where the records begin of a type with contents of `size` bytes.
std::vector<std::size_t> recordsOf(const std::string &bytes, const std::string &type, std::size_t size) {
  std::string header = type + static_cast<char>(size) + std::string(7, '\0');
  std::vector<std::size_t> all;
  for (std::size_t at = bytes.find(header); at != std::string::npos; at = bytes.find(header, at + 1)) all.push_back(at);
  return all;
}

constexpr std::size_t kHashBytes = 32;  // steps, steps made, time, hash
constexpr std::size_t kHashRecord = c3de::test::kRecordHeader + kHashBytes + c3de::test::kRecordChecksum;

}  // namespace

TEST_CASE("A replay has the state hashes of the recorded run at any number of threads", "[recording]") {
  const fs::path folder = freshFolder("recordings"), file = folder / "a.c3dr", report = folder / "replay.json";
  const fs::path scenes = fs::path(testResourcesFolder()) / "scenes";
  const fs::path springs = fs::path(testExampleFolder()) / ("mass_spring" + std::string(c3de::pluginExtension()));
  for (const fs::path &scene : {writeBoxScene(folder), scenes / "first_light.toml", scenes / "springs.toml"}) {
    CAPTURE(scene);
    const std::string hash = record(scene, file,
                                    {"--steps", "130", "--record-hash-every", "50", "--set", "world.gravity=[0,-5,1]",
                                     "--plugin", springs.string()});
    for (const char *threads : {"1", "2", "7"}) {
      CAPTURE(threads);
      const auto result =
          replay(file, {"--check", "--threads", threads, "--report", report.string(), "--plugin", springs.string()});
      CHECK(result.exitCode == 0);
      CHECK_THAT(result.output, Contains("up to step 130; 3 state hashes are equal"));
      CHECK(readJson(report).at("state_hash") == hash);
      CHECK(readJson(report).at("outcome") == "done");
    }
    const json info = infoOf(file);
    CHECK(info["kind"] == "recording");
    CHECK(info["complete"] == true);
    CHECK(info["steps"] == 130);
    CHECK(info["hashes"] == 3);
    CHECK(info["hash_every"] == 50);
    CHECK(info["state_hash"] == hash);
    CHECK(info["changes"] == json::object());
  }
}

TEST_CASE("A recording may begin in the middle, and a replay may end early or save a session", "[recording]") {
  const fs::path folder = freshFolder("recording_middle"), file = folder / "a.c3dr", session = folder / "a.c3de";
  const fs::path scene = writeBoxScene(folder);
  (void)runToReport(scene, {"--steps", "40", "--save-session", session.string(), "-q"});
  const std::string hash = record(session, file, {"--steps", "100"});
  const json info = infoOf(file);
  CHECK(info["begins_at"]["steps"] == 40);
  CHECK(info["steps"] == 60);
  CHECK(info["title"] == "Falling box");
  CHECK_THAT(runC3de({"info", file.string()}).output,
             Contains("recording of \"Falling box\"") && Contains("begins at step 40") && Contains("60 steps"));

  const fs::path end = folder / "end.c3de";
  const auto whole = replay(file, {"--check", "--save-session", end.string()});
  CHECK(whole.exitCode == 0);
  CHECK_THAT(whole.output, Contains("1 state hash is equal"));
  CHECK(infoOf(end)["state_hash"] == hash);

  const fs::path report = folder / "until.json";
  const double until_s = infoOf(session)["time_s"].get<double>() * 1.49;
  CHECK(replay(file, {"--until", std::to_string(until_s), "--report", report.string(), "-q"}).exitCode == 0);
  CHECK(readJson(report)["steps"] == 60);
}

TEST_CASE("A recording with its files is replayed where they are missing", "[recording]") {
  const fs::path folder = freshFolder("recording_embedded"), file = folder / "a.c3dr", elsewhere = folder / "elsewhere";
  const ScopedEnvironment home("C3DE_HOME", (folder / "home").string());
  const fs::path scene = writeBoxScene(folder);
  record(scene, file, {"--steps", "30", "--record-hash-every", "10", "--embed"});
  fs::create_directories(elsewhere);
  fs::rename(file, elsewhere / "b.c3dr");
  fs::remove(folder / "box.obj");
  const json info = infoOf(elsewhere / "b.c3dr");
  REQUIRE(info["files"].size() == 1);
  CHECK(info["files"][0]["state"] == "embedded");
  const auto result = replay(elsewhere / "b.c3dr", {"--check"});
  CHECK(result.exitCode == 0);
  CHECK_THAT(result.output, Contains("up to step 30; 4 state hashes are equal"));

  // A recording of a session with its files is independent of the extracted ones.
  const fs::path session = folder / "c.c3de", again = folder / "d.c3dr";
  CHECK(replay(elsewhere / "b.c3dr", {"--save-session", session.string()}).exitCode == 0);
  record(session, again, {"--steps", "5"});
  fs::remove_all(folder / "home");
  fs::remove(session);
  const auto independent = replay(again, {"--check"});
  CHECK(independent.exitCode == 0);
  CHECK(infoOf(again)["files"][0]["state"] == "embedded");
}

TEST_CASE("A replay exports a stretch of the recording for ParaView", "[recording]") {
  const fs::path folder = freshFolder("recording_stretch"), file = folder / "a.c3dr", list = folder / "out.pvd";
  (void)record(writeBoxScene(folder), file, {"--until", "0.1", "--set", "solver.dt=0.001"});
  const std::vector<std::string> wanted{"--export", list.string(), "--export-every", "0.01", "-q"};
  const auto stretch = [&](std::vector<std::string> more) {
    more.insert(more.end(), wanted.begin(), wanted.end());
    return replay(file, more);
  };
  CHECK(stretch({"--from", "0.045", "--until", "0.08"}).exitCode == 0);
  std::vector<double> times;
  const std::string text = readFile(list), key = "timestep=\"";
  for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1))
    if (const double time_s = std::stod(text.substr(at + key.size())); times.empty() || times.back() != time_s)
      times.push_back(time_s);
  REQUIRE(times.size() == 5);  // 0.045, 0.055, 0.065, 0.075, and the end
  constexpr double step_s = 1.5e-3;
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(times[i] > 0.0449 + 0.01 * static_cast<double>(i));
    CHECK(times[i] < 0.045 + 0.01 * static_cast<double>(i) + step_s);
  }

  fs::remove(list);
  const auto late = stretch({"--from", "0.5"});
  CHECK(late.exitCode == 2);
  CHECK_THAT(late.errorOutput, Contains("--from 0.5 s: the replay ends before, at 0.1"));
  CHECK_FALSE(fs::exists(list));
  const auto refused = stretch({"--from", "0.5", "--until", "0.2"});
  CHECK(refused.exitCode == 2);
  CHECK_THAT(refused.errorOutput, Contains("--from 0.5: accepted: up to --until 0.2"));
}

TEST_CASE("A replay that differs ends with 5 and names the first step, the hash and the recorded one", "[recording]") {
  const fs::path folder = freshFolder("recording_differs"), file = folder / "a.c3dr", report = folder / "replay.json";
  (void)record(writeBoxScene(folder), file, {"--steps", "50", "--record-hash-every", "10"});
  std::string bytes = readFile(file);
  const auto hashes = recordsOf(bytes, "HASH", kHashBytes);
  REQUIRE(hashes.size() == 5);
  for (const std::size_t i : {2, 3}) {
    std::string one = bytes.substr(hashes[i], kHashRecord);
    one.replace(c3de::test::kRecordHeader + 24, 8, std::string("\x01\0\0\0\0\0\0\0", 8));
    bytes.replace(hashes[i], kHashRecord, c3de::test::withChecksums(one));
  }
  writeFile(file, bytes);
  const auto result = replay(file, {"--check", "--report", report.string()});
  CHECK(result.exitCode == 5);
  CHECK_THAT(result.errorOutput, Contains("a.c3dr: the replay differs from the recording at step 30, t = ") &&
                                     Contains("and 0000000000000001 was recorded"));
  CHECK(readJson(report)["outcome"] == "differs");
  CHECK(readJson(report)["steps"] == 30);
  CHECK(replay(file, {"-q"}).exitCode == 0);  // nothing is compared

  bytes[hashes[1] + 20] = static_cast<char>(bytes[hashes[1] + 20] ^ 1);
  writeFile(file, bytes);
  const auto damaged = replay(file);
  CHECK(damaged.exitCode == 3);
  CHECK_THAT(damaged.errorOutput, Contains("record 3 at byte ") && Contains("(HASH) is damaged"));
}

TEST_CASE("The recording of a program that was killed is repeated as far as it goes", "[recording]") {
  const fs::path folder = freshFolder("recording_killed"), file = folder / "a.c3dr";
  const fs::path scene = writeBoxScene(folder);
  {
    auto run = c3de::ChildProcess::start({C3DE_PROGRAM, "run", scene.string(), "--until", "1000", "--record",
                                          file.string(), "--record-hash-every", "10"},
                                         folder / "log.txt");
    REQUIRE(run.has_value());
    std::error_code code;
    for (int i = 0; i < 600 && recordsOf(fs::exists(file, code) ? readFile(file) : "", "HASH", kHashBytes).size() < 3;
         ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    run->kill();
  }
  const std::string bytes = readFile(file);
  const auto hashes = recordsOf(bytes, "HASH", kHashBytes);
  REQUIRE(hashes.size() >= 3);
  // Within the third hash.
  writeFile(file, bytes.substr(0, hashes[2] + 30));
  CHECK_THAT(runC3de({"info", file.string()}).output, Contains("ends early, after step 20"));
  const json info = infoOf(file);
  CHECK(info["complete"] == false);
  CHECK(info["steps"] == 20);
  const auto result = replay(file, {"--check"});
  CHECK(result.exitCode == 0);
  CHECK_THAT(result.errorOutput, Contains("a.c3dr: the recording ends early, after step 20"));
  CHECK_THAT(result.output, Contains("up to step 20; 2 state hashes are equal"));
}

TEST_CASE("Recordings and replays that cannot be are refused with what is accepted", "[recording]") {
  const fs::path folder = freshFolder("recording_refused"), file = folder / "a.c3dr";
  const fs::path scene = writeBoxScene(folder);
  (void)record(scene, file, {"--steps", "5"});
  const auto refusal = [](const std::vector<std::string> &arguments, int exitCode) {
    const auto result = runC3de(arguments);
    CHECK(result.exitCode == exitCode);
    return result.errorOutput;
  };
  CHECK_THAT(refusal({"run", file.string()}, 3), Contains("is a recording; `c3de replay` repeats it"));
  CHECK_THAT(refusal({"replay", scene.string()}, 3), Contains("is no recording; accepted: files that `c3de run"));
  CHECK_THAT(refusal({"replay", (folder / "none.c3dr").string()}, 3), Contains("none.c3dr: no such file"));
  CHECK_THAT(refusal({"run", scene.string(), "--record-hash-every", "10"}, 2), Contains("--record"));
  CHECK_THAT(refusal({"run", scene.string(), "--record", (folder / "none" / "a.c3dr").string()}, 7),
             Contains("there is no folder"));
  CHECK_THAT(refusal({"run", scene.string(), "--record", file.string(), "--report", file.string()}, 2),
             Contains("is named for two outputs"));
  CHECK_THAT(refusal({"replay", file.string(), "--report", file.string()}, 2), Contains("is read by this run"));
  CHECK_THAT(refusal({"replay", file.string(), "--no-plugins"}, 4), Contains("no plugin that simulates is loaded"));
  writeFile(folder / "box.obj", boxObj() + "# longer\n");
  CHECK_THAT(refusal({"replay", file.string()}, 3), Contains("a.c3dr: ") && Contains("box.obj: has changed"));
  fs::remove(folder / "box.obj");
  CHECK_THAT(refusal({"replay", file.string()}, 3), Contains("box.obj: is missing"));
}
