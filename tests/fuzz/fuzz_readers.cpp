// SPDX-License-Identifier: Apache-2.0
// Reads texts with changed lines, tokens and bytes: scenes, overrides, material presets, settings of plugins and of the
// program, saved states, session files, recordings. Each is read or refused, in time, with a printable message; a
// refused state has changed nothing.
#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "c3de/core/crash_journal.h"
#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/plugin_host/plugin_records.h"
#include "c3de/registry/settings_store.h"
#include "c3de/scene/materials.h"
#include "c3de/scene/scene_file.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/recording_file.h"
#include "c3de/session/session_file.h"
#include "simulator_session.h"
#include "support/recording_records.h"

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

class Mutations {
 public:
  explicit Mutations(std::uint64_t seed) : engine_(seed) {}
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }

  /// Lines and tokens of one text are omitted, duplicated, moved, or replaced by odd ones; bytes are changed.
  std::string text(const std::string &original, const std::string &other) {
    std::vector<std::string> lines = linesOf(original);
    const std::vector<std::string> foreign = linesOf(other);
    for (std::size_t i = 0, n = 1 + below(4); i < n && !lines.empty(); ++i) {
      std::string &line = lines[below(lines.size())];
      switch (below(8)) {
        case 0: line.clear(); break;
        case 1: line += "\n" + line; break;
        case 2: line = foreign.empty() ? "" : foreign[below(foreign.size())]; break;
        case 3: std::swap(line, lines[below(lines.size())]); break;
        case 4: line = line.substr(0, line.find('=') + 1) + " " + oddValue(); break;
        case 5: line = oddValue() + " = " + oddValue(); break;
        case 6: line.insert(below(line.size() + 1), oddValue()); break;
        default: line = "[[" + line + "]]"; break;
      }
    }
    std::string out;
    for (const std::string &line : lines) out += line + "\n";
    return below(3) == 0 ? bytes(out) : out;
  }

  std::string bytes(std::string original) {
    for (std::size_t i = 0, n = 1 + below(6); i < n && !original.empty(); ++i) {
      const std::size_t at = below(original.size());
      switch (below(5)) {
        case 0: original[at] = static_cast<char>(below(256)); break;
        case 1: original[at] = static_cast<char>(original[at] ^ (1 << below(8))); break;
        case 2: original.resize(at); break;
        case 3: original.insert(at, original, below(original.size()), below(64)); break;
        default: original.erase(at, below(64)); break;
      }
    }
    return original;
  }

  std::string oddValue() {
    static const std::vector<std::string> all{"nan",
                                              "inf",
                                              "-inf",
                                              "0",
                                              "-0.0",
                                              "-1",
                                              "1e308",
                                              "1e-320",
                                              "1e999",
                                              "9223372036854775807",
                                              "-9223372036854775808",
                                              "99999999999999999999",
                                              "0x7fffffff",
                                              "true",
                                              "\"\"",
                                              "\"auto\"",
                                              "\"none\"",
                                              "[]",
                                              "{}",
                                              "[nan, inf, -inf]",
                                              "[1, 2]",
                                              "[1.0, \"x\", true]",
                                              "[[1, 2, 3], [4, 5, 6]]",
                                              "{box = [[0, 0, 0], [1, 1, 1]]}",
                                              "{sphere = {center = [0, 0, 0], radius = -1}}",
                                              "1979-05-27T07:32:00Z",
                                              "\"\xc3\x28\"",
                                              "\"\\u0000\"",
                                              "\"\x1b[31m\"",
                                              "\"../../../../dev/zero\"",
                                              "\"/dev/full\"",
                                              "\"a\\nb\"",
                                              "#",
                                              "[[",
                                              "]]",
                                              "\"",
                                              "'''",
                                              "\xef\xbb\xbf",
                                              "= =",
                                              "\xf0\x9f\xab\x80"};
    const std::size_t i = below(all.size() + 2);
    if (i == all.size()) return std::string(1 + below(20'000), '[');
    if (i == all.size() + 1) return "\"" + std::string(below(100'000), 'x') + "\"";
    return all[i];
  }

 private:
  static std::vector<std::string> linesOf(const std::string &text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }
  std::mt19937_64 engine_;
};

std::string fileText(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}
void write(const fs::path &file, const std::string &text) { std::ofstream(file, std::ios::binary) << text; }

/// The current input, for the analysis of failures.
std::string present;

[[noreturn]] void found(const std::string &what, const std::string &message) {
  write("fuzz-readers-input", present);
  std::fprintf(stderr, "fuzz_readers: %s\n  %s\n  the input is in fuzz-readers-input\n", what.c_str(), message.c_str());
  std::exit(1);
}

/// A refusal is one line of plain text, of limited length, and informative.
void checkMessage(const std::string &subject, const std::string &message) {
  if (message.empty()) found(subject + ": refused without a word", "");
  if (message.size() > 4000) found(subject + ": a message of many characters", message.substr(0, 300));
  for (const char c : message)
    if (static_cast<unsigned char>(c) < 0x20 && c != '\n') found(subject + ": a control character in", message);
  if (!c3de::isUtf8(message)) found(subject + ": a message that is not UTF-8", message);
}

struct Subject {
  std::string name;
  std::function<bool(Mutations &)> once;  ///< whether it was read
};

/// The record with a changed content.
std::string withContent(std::string record, Mutations &m) {
  using namespace c3de::test;
  const std::string content = m.bytes(record.substr(kRecordHeader, record.size() - kRecordHeader - kRecordChecksum));
  record = record.substr(0, kRecordHeader) + content + std::string(kRecordChecksum, '\0');
  for (std::size_t i = 0; i < 8; ++i) record[kRecordType + i] = static_cast<char>(content.size() >> (8 * i) & 0xffu);
  return withChecksums(record);
}

/// A recording with changed bytes, or with a changed content of a record whose checksums are right.
Subject recordingSubject(const fs::path &folder) {
  using namespace c3de::session;
  RecordingStart start;
  start.simulator = {"a.test.Simulator/1", "", "test", "1.0.0"};
  start.session.scenes = {"format = 1\n"};
  RecordedScene scene;
  scene.session = start.session;
  std::vector<std::string> records{*recordingBytes(start)};
  for (const RecordedEvent &event :
       {RecordedEvent(SimulationChange{"set", "set.gravity", "set gravity", 0, 1, "-9.81"}), RecordedEvent(scene),
        RecordedEvent(RecordedState{2, "state"}), RecordedEvent(RecordedReset{2}),
        RecordedEvent(RecordedHash{1, 3, 0.1, 7}), RecordedEvent(RecordedEnd{{2, 4, 0.2, 9}})})
    records.push_back(*recordingBytes(event));
  return {"recording", [records, file = folder / "a.c3dr"](Mutations &m) {
            const bool areChecksumsRight = m.below(2) == 0;
            const std::size_t chosen = 1 + m.below(records.size() - 1);
            present.clear();
            for (std::size_t i = 0; i < records.size(); ++i)
              present += areChecksumsRight && i == chosen ? withContent(records[i], m) : records[i];
            if (!areChecksumsRight) present = m.bytes(present);
            write(file, present);
            const auto read = readRecording(file);
            if (!read) {
              checkMessage("recording", read.error().message);
              return false;
            }
            for (const RecordedEvent &event : read->events)
              if (const auto again = recordingBytes(event); !again)
                found("recording: read, and cannot be written", again.error().message);
            return true;
          }};
}

std::vector<Subject> subjects(const fs::path &resources, const fs::path &folder) {
  std::vector<std::string> scenes;
  for (const auto &entry : fs::directory_iterator(resources / "scenes"))
    if (entry.path().extension() == ".toml") scenes.push_back(fileText(entry.path()));
  std::sort(scenes.begin(), scenes.end());  // the same seed, the same run
  const fs::path materialsFile = resources / "materials.toml";
  auto materials = std::make_shared<c3de::scene::MaterialLibrary>(*c3de::scene::MaterialLibrary::load(materialsFile));
  const std::string presets = fileText(materialsFile);
  std::vector<Subject> all;

  all.push_back({"scene", [scenes, materials, resources](Mutations &m) {
                   present = m.text(scenes[m.below(scenes.size())], scenes[m.below(scenes.size())]);
                   const auto read =
                       c3de::scene::parseScene(present, resources / "scenes" / "scene.toml", materials.get());
                   if (!read) checkMessage("scene", read.error().message);
                   return static_cast<bool>(read);
                 }});
  all.push_back({"override", [scenes, materials, resources](Mutations &m) {
                   static const std::array<std::string, 10> paths{"solver.dt",
                                                                  "body.organ.material.youngs_modulus",
                                                                  "body.0.name",
                                                                  "world.gravity",
                                                                  "fix.0.displacement",
                                                                  "load.press.pressure",
                                                                  "obstacle.floor.friction",
                                                                  "simulator.class",
                                                                  "body..",
                                                                  "probe.tip.at"};
                   auto read = c3de::scene::parseScene(scenes[m.below(scenes.size())],
                                                       resources / "scenes" / "scene.toml", materials.get());
                   if (!read) found("a shipped scene is refused", read.error().message);
                   present = m.below(4) == 0 ? m.oddValue() : m.bytes(paths[m.below(paths.size())]);
                   present += (m.below(10) == 0 ? "" : "=") + m.oddValue();
                   const auto applied = c3de::scene::applyOverride(*read, present, materials.get());
                   if (!applied) checkMessage("override", applied.error().message);
                   return static_cast<bool>(applied);
                 }});
  all.push_back({"presets", [presets, folder](Mutations &m) {
                   present = m.text(presets, presets);
                   write(folder / "materials.toml", present);
                   const auto read = c3de::scene::MaterialLibrary::load(folder / "materials.toml");
                   if (!read) checkMessage("presets", read.error().message);
                   return static_cast<bool>(read);
                 }});
  all.push_back({"settings", [folder](Mutations &m) {
                   c3de::registry::SettingsStore whole(folder / "settings");
                   for (const char *key : {"a", "b.c", "d/e"}) (void)whole.set("org.example.x", key, m.oddValue());
                   const fs::path file = whole.fileOf("org.example.x");
                   const std::string kept = fileText(file);
                   present = m.below(2) == 0 ? m.text(kept, kept) : m.bytes(kept);
                   write(file, present);
                   c3de::registry::SettingsStore store(folder / "settings");
                   bool isRead = false;
                   for (const std::string &key : store.keys("org.example.x"))
                     isRead = store.get("org.example.x", key).has_value() || isRead;
                   // A damaged file can be written again.
                   if (const auto set = store.set("org.example.x", "a", "1"); !set)
                     found("settings", set.error().message);
                   if (c3de::registry::SettingsStore(folder / "settings").get("org.example.x", "a") != "1")
                     found("settings: what was set is not there", "");
                   return isRead;
                 }});
  all.push_back({"records", [folder](Mutations &m) {
                   const fs::path choices = folder / "choices", cache = folder / "cache";
                   {
                     c3de::plugin_host::PluginRecords records(choices, cache);
                     (void)records.setOff("org.example.a", true);
                     records.noteCrash({c3de::CrashRecord::Place::call, "SIGSEGV", "org.example.b", "step"});
                     records.keepFirstUse(folder / "materials.toml", folder / "materials.toml", true, {"no"});
                   }
                   std::vector<fs::path> files;
                   for (const auto &entry : fs::recursive_directory_iterator(folder))
                     if (entry.path().string().find("choices") != std::string::npos ||
                         entry.path().string().find("cache") != std::string::npos)
                       if (entry.is_regular_file()) files.push_back(entry.path());
                   if (files.empty()) found("records: nothing was written", "");
                   const fs::path &file = files[m.below(files.size())];
                   const std::string kept = fileText(file);
                   present = m.below(2) == 0 ? m.text(kept, kept) : m.bytes(kept);
                   write(file, present);
                   const c3de::plugin_host::PluginRecords records(choices, cache);
                   (void)records.firstUseOf(folder / "materials.toml", folder / "materials.toml", true);
                   const bool isRead = records.isOff("org.example.a") && records.crashes().size() == 1;
                   for (const fs::path &one : files) fs::remove(one);
                   return isRead;
                 }});
  all.push_back({"journal", [folder](Mutations &m) {
                   const std::string kept = "call\nSIGSEGV, an invalid access to memory\norg.example.x\nstep\n";
                   present = m.below(2) == 0 ? m.text(kept, kept) : m.bytes(kept);
                   write(folder / "journal" / "1.run", present);
                   const auto records = c3de::CrashJournal::popCrashRecords(folder / "journal");
                   for (const auto &record : records) checkMessage("journal", record.cause());
                   return !records.empty();
                 }});

  // What is read of a changed session can be saved.
  c3de::session::SessionFile original;
  original.title = "a session";
  original.scenes = {scenes.front()};
  original.files = {{"ct.nii", std::string(64, 'a'), 3, false}};
  original.view.camera.emplace();
  original.state = std::string(1000, 's');
  original.members["plugins/org.example.x"] = "private";
  original.unknown["/later"] = "[1,{}]";
  const fs::path sessionFile = folder / "a.c3de";
  if (const auto written = c3de::session::writeSession(original, sessionFile); !written)
    found("session", written.error().message);
  all.push_back({"session", [whole = fileText(sessionFile), original, sessionFile](Mutations &m) {
                   present = m.bytes(whole);
                   write(sessionFile, present);
                   const auto read = c3de::session::readSession(sessionFile);
                   if (!read) {
                     checkMessage("session", read.error().message);
                     return false;
                   }
                   if (*read != original) found("session: read with another content", "");
                   if (const auto again = c3de::session::writeSession(*read, sessionFile); !again)
                     found("session: read, and cannot be saved", again.error().message);
                   return true;
                 }});

  all.push_back(recordingSubject(folder));

  // A body of some hundred points, and a state of it after some steps.
  struct Kept {
    c3de::test::SimulatorSession session{1};
    std::string bytes;
    std::uint64_t hash = 0;
  };
  auto kept = std::make_shared<Kept>();
  const auto mesh = c3de::geometry::loadMesh(resources / "meshes/organ.obj", c3de::geometry::LengthUnit::millimetre);
  if (!mesh) found("the shipped organ is refused", mesh.error().message);
  (void)kept->session.addBody(*mesh, {}, {c3de::test::SimulatorSession::number("sampling.count", 200.0)});
  for (int i = 0; i < 5; ++i) kept->session.step();
  kept->hash = kept->session.stateHash();
  if (kept->session.table()->save_state(kept->session.object(), c3de::scene::sinkInto(kept->bytes)) < 0)
    found("a state is not saved", kept->session.takeError());
  all.push_back({"state", [kept](Mutations &m) {
                   auto &[session, bytes, hash] = *kept;
                   present = m.bytes(bytes);
                   if (session.table()->load_state(session.object(), present.data(), present.size()) < 0) {
                     checkMessage("state", session.takeError());
                     if (session.stateHash() != hash) found("state: refused, and something has changed", "");
                     return false;
                   }
                   // Numbers may differ now; the next step succeeds or fails with a reason.
                   if (session.table()->step(session.object()) < 0) checkMessage("state", session.takeError());
                   session.reset();  // of a body that has stopped
                   if (session.table()->load_state(session.object(), bytes.data(), bytes.size()) < 0)
                     found("state: the whole one is refused", session.takeError());
                   if (session.stateHash() != hash) found("state: gone to, and not as it was", "");
                   return true;
                 }});
  return all;
}

}  // namespace

int main(int argc, char **argv) {
  double seconds = 10.0;
  std::uint64_t seed = 1;
  std::string only;
  CLI::App app("Reads changed scenes, presets, settings and states");
  app.add_option("--seconds", seconds, "for all subjects together");
  app.add_option("--seed", seed);
  app.add_option("--only", only, "one subject");
  CLI11_PARSE(app, argc, argv);

  const fs::path folder = fs::temp_directory_path() / ("fuzz-readers-" + std::to_string(seed));
  fs::remove_all(folder);
  fs::create_directories(folder / "settings");
  fs::create_directories(folder / "journal");
  c3de::setLogThreshold(c3de::LogLevel::error);
  Mutations mutations(seed);
  auto all = subjects(C3DE_RESOURCES, folder);
  std::erase_if(all, [&](const Subject &one) { return !only.empty() && one.name != only; });
  constexpr double kMaxSeconds = 5.0;  // of one input, on a busy machine with sanitizers
  for (const Subject &one : all) {
    const auto begin = Clock::now();
    const double share = seconds / static_cast<double>(all.size());
    std::size_t count = 0, read = 0;
    double slowest = 0.0;
    for (double now = 0.0; now < share; ++count) {
      if (one.once(mutations)) ++read;
      const double then = std::chrono::duration<double>(Clock::now() - begin).count();
      slowest = std::max(slowest, then - now);
      if (then - now > kMaxSeconds) found(one.name + " took " + std::to_string(then - now) + " s", "");
      now = then;
    }
    std::printf("%-9s %9zu inputs, %9zu read, the slowest in %.3f s\n", one.name.c_str(), count, read, slowest);
  }
  fs::remove_all(folder);
  std::printf("seed %llu: no finding\n", static_cast<unsigned long long>(seed));
  return 0;
}
