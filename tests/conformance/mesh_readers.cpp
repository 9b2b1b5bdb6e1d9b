// SPDX-License-Identifier: Apache-2.0
// A plugin with mesh readers, most of them faulty: one per extension.
#include <array>
#include <atomic>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;
using Row = std::array<std::uint32_t, 3>;

const std::vector<sdk::Vec3> kCorners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Row> kFaces{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

class Readers {
 public:
  explicit Readers(sdk::Host host) : files_(host) {
    trySettings(sdk::Settings(host));
    tryCommands(sdk::Commands(host));
    add("good", [](const sdk::MeshSource &source, sdk::Progress, const sdk::MeshSink &sink) -> sdk::Result<void> {
      // Triangles before their vertices, in two parts, and a vertex twice.
      sink.addTriangles(kFaces);
      sink.addVertices(std::span(kCorners).first(1));
      sink.addVertices(std::span(kCorners).subspan(1));
      sink.addVertices(std::span(kCorners).first(1));
      sink.addTriangles(std::vector<Row>{{4, 2, 1}});
      sink.setUnit(C3DE_UNIT_CM);
      sink.note("read " + std::to_string(source.bytes.size()) + " bytes");
      return {};
    });
    add("nan", [](const sdk::MeshSource &, sdk::Progress, const sdk::MeshSink &sink) -> sdk::Result<void> {
      auto corners = kCorners;
      corners[2][1] = std::numeric_limits<double>::quiet_NaN();
      sink.addVertices(corners);
      sink.addTriangles(kFaces);
      return {};
    });
    add("range", [](const sdk::MeshSource &, sdk::Progress, const sdk::MeshSink &sink) -> sdk::Result<void> {
      sink.addVertices(kCorners);
      sink.addTriangles(std::vector<Row>{{0, 2, 1}, {0, 1, 7}});
      return {};
    });
    add("unit", [](const sdk::MeshSource &, sdk::Progress, const sdk::MeshSink &sink) -> sdk::Result<void> {
      try {
        sink.setUnit(17);
      } catch (const sdk::Error &) {
        // Continues as if nothing had been refused.
      }
      sink.addVertices(kCorners);
      sink.addTriangles(kFaces);
      return {};
    });
    add("throws", [](const sdk::MeshSource &, sdk::Progress, const sdk::MeshSink &) -> sdk::Result<void> {
      throw std::runtime_error("line 12: the author did not think of this");
    });
    add("empty", [](const sdk::MeshSource &, sdk::Progress, const sdk::MeshSink &) -> sdk::Result<void> { return {}; });
    add("mute", [](const sdk::MeshSource &, sdk::Progress, const sdk::MeshSink &) -> sdk::Result<void> {
      return sdk::Failure{C3DE_E_IO, ""};
    });
    add("slow", [](const sdk::MeshSource &, sdk::Progress progress, const sdk::MeshSink &) -> sdk::Result<void> {
      for (int i = 0; i < 3000; ++i) {
        if (!progress.update(i / 3000.0, "turning pages")) return sdk::Failure{C3DE_E_CANCELLED, ""};
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      return sdk::Failure{C3DE_E_TIMEOUT, "nobody ended it"};
    });
    add("itself", [this](const sdk::MeshSource &, sdk::Progress, const sdk::MeshSink &) -> sdk::Result<void> {
      const auto *table = files_.table();
      return files_.host().check(table->remove(table->ctx, readers_.back().handle()));
    });
  }
  static constexpr sdk::PluginInfo info{"test.mesh_readers", "1.0.0", "Readers", "", ""};
  static constexpr std::array needs{sdk::required<c3de_files_v1>()};

 private:
  static void expect(bool holds, const char *what) {
    if (!holds) throw sdk::Error(C3DE_E_INTERNAL, what);
  }
  // The wrappers next to those of files; a failure refuses this plugin.
  static void trySettings(const sdk::Settings &settings) {
    expect(!settings.get("colour"), "nothing is set at first");
    sdk::orThrow(settings.set("colour", "blue"));
    expect(settings.get("colour") == "blue", "what was set is got");
    expect(sdk::orThrow(settings.keys()) == std::vector<std::string>{"colour"}, "and is the only key");
    sdk::orThrow(settings.remove("colour"));
    expect(settings.remove("colour").failure().status == C3DE_E_NOT_FOUND, "what is gone is not found");
  }
  static void tryCommands(const sdk::Commands &commands) {
    int runs = 0;
    const sdk::CommandInfo info{.id = "test.run", .title = "Run", .key = 'R', .modifiers = C3DE_MOD_ALT};
    auto command = sdk::orThrow(commands.add(info, [&runs]() -> sdk::Result<void> {
      if (++runs == 2) throw std::runtime_error("the second time is one too many");
      return {};
    }));
    expect(command.hasShortcut(), "the keys are free");
    sdk::orThrow(commands.run("test.run"));
    const auto second = commands.run("test.run");
    expect(!second && second.failure().message.find("one too many") != std::string::npos,
           "the text of what was thrown");
    command.setEnabled(false);
    expect(commands.run("test.run").failure().status == C3DE_E_STATE && runs == 2, "one that is not enabled");
    command = {};
    expect(commands.run("test.run").failure().status == C3DE_E_NOT_FOUND, "one that is gone");
  }
  template <class F>
  void add(std::string_view name, F read) {
    const std::string id = "test." + std::string(name);
    sdk::MeshFormat format;
    format.id = id;
    format.label = name;
    format.extensions = {name};
    // The program's readers have priority over this one.
    if (name == "good") format.extensions.push_back("OBJ");
    if (name == "empty") format.extensions.push_back("good");
    readers_.push_back(sdk::orThrow(files_.addMeshReader(format, read)));
  }
  sdk::Files files_;
  std::vector<sdk::MeshReader> readers_;
};

}  // namespace

C3DE_DEFINE_PLUGIN(Readers)
