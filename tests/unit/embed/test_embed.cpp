// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cfenv>
#include <clocale>
#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../../cli/program.h"
#include "open_simulation.h"
#include "support/folders.h"

namespace {

std::string hashText(std::uint64_t hash) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash));
  return text.data();
}

std::string scene(const char *name) { return std::string(C3DE_SCENES) + "/" + name; }

std::string boxScene(const std::string &name, const std::string &more = "") {
  return writeBoxScene(freshFolder(name), more).string();
}

}  // namespace

TEST_CASE("Shipped scenes have the state hash of c3de run after the same steps") {
  struct Shipped {
    const char *name;
    int steps;
    const char *plugin;  // an example that the scene needs
  };
  const auto [name, steps, plugin] =
      GENERATE(Shipped{"cantilever.toml", 10, nullptr}, Shipped{"first_light.toml", 12, nullptr},
               Shipped{"stiffening_organ.toml", 12, "material_law.so"}, Shipped{"springs.toml", 12, "mass_spring.so"});
  const auto out = freshFolder("embed-same-hash") / "report.json";
  std::vector<std::string> arguments{"run",       scene(name), "--steps",  std::to_string(steps), "-q",
                                     "--threads", "1",         "--report", out.string()};
  const std::string file = plugin != nullptr ? testExampleFolder() + ("/" + std::string(plugin)) : std::string();
  if (plugin != nullptr) arguments.insert(arguments.end(), {"--plugin", file});
  const auto ran = runC3de(arguments);
  INFO(ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  const OpenSimulation sim(scene(name), {}, file);
  std::uint64_t done = 0;
  REQUIRE_OK(c3de_embed_step(sim.get(), static_cast<std::uint64_t>(steps), &done));
  CHECK(done == static_cast<std::uint64_t>(steps));
  const auto report = readJson(out);
  CHECK(hashText(hashOf(sim.get())) == report["state_hash"]);
  CHECK(statusOf(sim.get()).time_s == report["time_s"]);
  const char *text = nullptr;
  REQUIRE_OK(c3de_embed_report(sim.get(), &text));
  const auto own = nlohmann::json::parse(text);
  CHECK(own["state_hash"] == report["state_hash"]);
  CHECK(own["steps"] == report["steps"]);
  CHECK(own["bodies"][0]["mass_kg"] == report["bodies"][0]["mass_kg"]);
}

TEST_CASE("A run ends at its time, and at 1 s or full load by itself") {
  const OpenSimulation falling(boxScene("embed-run"));
  c3de_embed_run_options run{};
  run.size = sizeof run;
  run.until_s = 0.05;
  REQUIRE_OK(c3de_embed_run(falling.get(), &run));
  const c3de_embed_status at = statusOf(falling.get());
  CHECK(at.time_s >= 0.05 - 1e-6 * at.dt_s);
  CHECK(at.time_s < 0.05 + at.dt_s);
  CHECK(at.wall_s > 0.0);
  const OpenSimulation loaded(scene("cantilever.toml"));
  REQUIRE_OK(c3de_embed_run(loaded.get(), nullptr));
  const c3de_embed_status end = statusOf(loaded.get());
  CHECK((end.flags & C3DE_EMBED_FINISHED) != 0);
  CHECK((end.flags & C3DE_EMBED_LOAD_STEPS) != 0);
  std::uint64_t more = 1;
  REQUIRE_OK(c3de_embed_step(loaded.get(), 5, &more));
  CHECK(more == 0);
}

TEST_CASE("Parameters are set before and after opening by the same paths, with the same effect") {
  const std::string file = boxScene("embed-parameters");
  const OpenSimulation before(file, {"body.box.material.youngs_modulus=2e4", "world.gravity=[0,-5,0]"});
  const OpenSimulation after(file);
  REQUIRE_OK(c3de_embed_set(after.get(), "body.box.youngs_modulus", "2e4"));
  REQUIRE_OK(c3de_embed_set(after.get(), "world.gravity", "[0,-5,0]"));
  c3de_embed_value value{};
  value.size = sizeof value;
  REQUIRE_OK(c3de_embed_get(after.get(), "body.box.material.youngs_modulus", &value));
  CHECK(value.type == C3DE_EMBED_NUMBER);
  CHECK(value.number == 2e4);
  REQUIRE_OK(c3de_embed_get(after.get(), "world.gravity", &value));
  CHECK(value.type == C3DE_EMBED_VECTOR);
  CHECK(value.vector[1] == -5.0);
  std::uint64_t done = 0;
  REQUIRE_OK(c3de_embed_step(before.get(), 20, &done));
  REQUIRE_OK(c3de_embed_step(after.get(), 20, &done));
  const auto y = [](c3de_sim sim) { return static_cast<const double *>(viewOf(sim, 1, "position").data)[1]; };
  CHECK(y(before.get()) == y(after.get()));
  std::uint64_t n = 0;
  REQUIRE_OK(c3de_embed_parameter_count(after.get(), &n));
  bool isListed = false;
  for (std::uint64_t i = 0; i < n; ++i) {
    c3de_embed_parameter one{};
    one.size = sizeof one;
    REQUIRE_OK(c3de_embed_parameter_at(after.get(), i, &one));
    if (std::string(one.path) != "body.box.material.youngs_modulus") continue;
    isListed = true;
    CHECK(std::string(one.unit) == "Pa");
  }
  CHECK(isListed);
}

TEST_CASE("A view shows the present state without a copy, and its generation ends with the next step") {
  const OpenSimulation sim(boxScene("embed-views"));
  std::uint64_t done = 0;
  REQUIRE_OK(c3de_embed_step(sim.get(), 5, &done));
  const c3de_embed_array u = viewOf(sim.get(), C3DE_EMBED_ON_POINTS, "displacement");
  CHECK(u.dtype == C3DE_F64);
  CHECK(u.rank == 2);
  CHECK(u.shape[1] == 3);
  CHECK(u.strides[0] == 24);
  CHECK(std::string(u.unit) == "m");
  CHECK(u.data == viewOf(sim.get(), C3DE_EMBED_ON_POINTS, "displacement").data);
  const auto *x = static_cast<const double *>(viewOf(sim.get(), C3DE_EMBED_ON_POINTS, "position").data);
  const auto *reference =
      static_cast<const double *>(viewOf(sim.get(), C3DE_EMBED_ON_POINTS, "reference_position").data);
  for (std::uint64_t i = 0; i < 3 * u.shape[0]; ++i)
    REQUIRE(static_cast<const double *>(u.data)[i] == x[i] - reference[i]);
  std::vector<double> copy(3 * u.shape[0]);
  REQUIRE_OK(c3de_embed_read_field(sim.get(), 0, C3DE_EMBED_ON_POINTS, "position", copy.data(), 8 * copy.size()));
  CHECK(std::memcmp(copy.data(), x, 8 * copy.size()) == 0);
  CHECK(u.generation == statusOf(sim.get()).generation);
  REQUIRE_OK(c3de_embed_step(sim.get(), 1, &done));
  CHECK(u.generation != statusOf(sim.get()).generation);
  c3de_embed_array triangles{};
  triangles.size = sizeof triangles;
  REQUIRE_OK(c3de_embed_view_triangles(sim.get(), 0, &triangles));
  const c3de_embed_array skin = viewOf(sim.get(), C3DE_EMBED_ON_SURFACE, "position");
  CHECK(triangles.shape[0] == 12);
  for (std::uint64_t t = 0; t < triangles.shape[0]; ++t)
    for (std::int64_t corner = 0; corner < 3; ++corner) {
      std::uint32_t index = 0;
      std::memcpy(&index,
                  static_cast<const char *>(triangles.data) + static_cast<std::int64_t>(t) * triangles.strides[0] +
                      corner * triangles.strides[1],
                  sizeof index);
      REQUIRE(index < skin.shape[0]);
    }
}

TEST_CASE("Reset, states and sessions return bit for bit") {
  const std::string file = boxScene("embed-states");
  const auto folder = freshFolder("embed-states-out");
  const OpenSimulation sim(file);
  const std::uint64_t initial = hashOf(sim.get());
  std::uint64_t done = 0;
  REQUIRE_OK(c3de_embed_step(sim.get(), 10, &done));
  const std::uint64_t saved = hashOf(sim.get());
  REQUIRE_OK(c3de_embed_save_state(sim.get(), (folder / "a.state").string().c_str()));
  REQUIRE_OK(c3de_embed_save_session(sim.get(), (folder / "a.c3de").string().c_str()));
  REQUIRE_OK(c3de_embed_step(sim.get(), 10, &done));
  const std::uint64_t later = hashOf(sim.get());
  REQUIRE_OK(c3de_embed_load_state(sim.get(), (folder / "a.state").string().c_str()));
  CHECK(hashOf(sim.get()) == saved);
  REQUIRE_OK(c3de_embed_step(sim.get(), 10, &done));
  CHECK(hashOf(sim.get()) == later);
  const OpenSimulation continued((folder / "a.c3de").string());
  CHECK(hashOf(continued.get()) == saved);
  REQUIRE_OK(c3de_embed_step(continued.get(), 10, &done));
  CHECK(hashOf(continued.get()) == later);
  REQUIRE_OK(c3de_embed_reset(sim.get()));
  CHECK(hashOf(sim.get()) == initial);
  CHECK(statusOf(sim.get()).steps == 0);
  writeFile(folder / "broken.state", "no state");
  CHECK(c3de_embed_load_state(sim.get(), (folder / "broken.state").string().c_str()) == C3DE_E_FORMAT);
  CHECK(hashOf(sim.get()) == initial);
}

TEST_CASE("Returned text stays until the next change of the state") {
  const OpenSimulation sim(boxScene("embed-texts"));
  REQUIRE_OK(c3de_embed_step(sim.get(), 2, nullptr));
  const char *events = nullptr, *report = nullptr, *again = nullptr;
  REQUIRE_OK(c3de_embed_events(sim.get(), &events));
  REQUIRE_OK(c3de_embed_report(sim.get(), &report));
  const std::string eventsBefore = events, reportBefore = report;
  REQUIRE_OK(c3de_embed_events(sim.get(), &again));
  CHECK(again == events);
  REQUIRE_OK(c3de_embed_report(sim.get(), &again));
  CHECK(again == report);
  CHECK(events == eventsBefore);
  CHECK(report == reportBefore);
  REQUIRE_OK(c3de_embed_step(sim.get(), 1, nullptr));
  REQUIRE_OK(c3de_embed_report(sim.get(), &again));
  CHECK(nlohmann::json::parse(again)["steps"] == 3);
}

TEST_CASE("A hold pulls a body towards its target") {
  const OpenSimulation sim(boxScene("embed-hold"), {"world.gravity=[0,0,0]"});
  c3de_embed_hold hold{};
  hold.size = sizeof hold;
  hold.at_m[0] = 1.0;
  hold.at_m[1] = hold.at_m[2] = 0.1;
  hold.radius_m = 0.1;
  std::uint64_t held = 0;
  REQUIRE_OK(c3de_embed_hold_body(sim.get(), 0, &hold, &held));
  const std::array<double, 3> target{1.05, 0.1, 0.1};
  REQUIRE_OK(c3de_embed_pull(sim.get(), held, target.data()));
  std::uint64_t done = 0;
  REQUIRE_OK(c3de_embed_step(sim.get(), 20, &done));
  c3de_embed_hold_state state{};
  state.size = sizeof state;
  REQUIRE_OK(c3de_embed_hold_read(sim.get(), held, &state));
  CHECK(state.force_N[0] > 0.0);
  CHECK(state.point_m[0] > 1.0);
  CHECK(state.target_m[0] == 1.05);
  REQUIRE_OK(c3de_embed_release(sim.get(), held));
  CHECK(c3de_embed_release(sim.get(), held) < 0);
}

TEST_CASE("A scene as text finds its meshes in the folder of its name") {
  const std::string file = boxScene("embed-text");
  const std::string text = readFile(file);
  c3de_embed_options options{};
  options.size = sizeof options;
  options.file = file.c_str();
  options.text = text.c_str();
  options.threads = 1;
  c3de_sim sim = 0;
  REQUIRE_OK(c3de_embed_open(&options, &sim));
  const OpenSimulation same(file);
  CHECK(hashOf(sim) == hashOf(same.get()));
  REQUIRE_OK(c3de_embed_close(sim));
}

TEST_CASE("Misuse returns a status whose text states what is accepted") {
  c3de_sim none = 7;
  CHECK(tryOpen("no-such-file.toml", {}, none) == C3DE_E_FORMAT);
  CHECK(none == 0);
  CHECK_THAT(lastError(), Contains("no-such-file.toml"));
  CHECK(c3de_embed_open(nullptr, &none) == C3DE_E_ARG);
  c3de_embed_options empty{};
  CHECK(c3de_embed_open(&empty, &none) == C3DE_E_ARG);
  CHECK_THAT(lastError(), Contains("size"));
  const std::string file = boxScene("embed-misuse");
  CHECK(tryOpen(file, {"body.box.material.youngs=1"}, none) < 0);
  CHECK_THAT(lastError(), Contains("youngs_modulus"));
  CHECK(tryOpen(file, {"body.bux.material.youngs_modulus=1"}, none) == C3DE_E_ARG);

  const OpenSimulation sim(file);
  const std::uint64_t before = hashOf(sim.get());
  CHECK(c3de_embed_set(sim.get(), "body.box.material.poisson_ratio", "0.7") == C3DE_E_ARG);
  CHECK_THAT(lastError(), Contains("accepted"));
  CHECK(c3de_embed_set(sim.get(), "body.box.material.youngs_modulus", "nan") == C3DE_E_ARG);
  CHECK(c3de_embed_set(sim.get(), "body.box.material.youngs_modulu", "1e4") == C3DE_E_ARG);
  CHECK_THAT(lastError(), Contains("did you mean 'body.box.material.youngs_modulus'"));
  CHECK(c3de_embed_set(sim.get(), nullptr, "1") == C3DE_E_ARG);
  double few[3];
  CHECK(c3de_embed_read_field(sim.get(), 0, C3DE_EMBED_ON_POINTS, "position", few, sizeof few) == C3DE_E_ARG);
  CHECK(c3de_embed_read_field(sim.get(), 0, 9, "position", few, sizeof few) == C3DE_E_ARG);
  CHECK(c3de_embed_read_field(sim.get(), 4, C3DE_EMBED_ON_POINTS, "position", few, sizeof few) == C3DE_E_NOT_FOUND);
  c3de_embed_array view{};
  CHECK(c3de_embed_view_field(sim.get(), 0, C3DE_EMBED_ON_POINTS, "position", &view) == C3DE_E_ARG);
  view.size = sizeof view;
  CHECK(c3de_embed_view_field(sim.get(), 0, C3DE_EMBED_ON_POINTS, "colour", &view) == C3DE_E_NOT_FOUND);
  CHECK_THAT(lastError(), Contains("reference_position"));
  std::uint64_t index = 0;
  CHECK(c3de_embed_find_body(sim.get(), "spleen", &index) == C3DE_E_NOT_FOUND);
  CHECK_THAT(lastError(), Contains("box"));
  c3de_embed_run_options run{};
  run.size = sizeof run;
  run.until_s = std::numeric_limits<double>::quiet_NaN();
  CHECK(c3de_embed_run(sim.get(), &run) == C3DE_E_ARG);
  const std::array<double, 3> nowhere{0.0, std::numeric_limits<double>::infinity(), 0.0};
  CHECK(c3de_embed_pull(sim.get(), 1, nowhere.data()) == C3DE_E_ARG);
  CHECK(c3de_embed_save_state(sim.get(), "no/such/folder/a.state") == C3DE_E_IO);
  CHECK(hashOf(sim.get()) == before);

  c3de_sim closed = 0;
  REQUIRE_OK(tryOpen(file, {}, closed));
  REQUIRE_OK(c3de_embed_close(closed));
  CHECK(c3de_embed_step(closed, 1, nullptr) == C3DE_E_STALE);
  CHECK(c3de_embed_close(closed) == C3DE_E_STALE);
  CHECK(c3de_embed_close(0) == C3DE_OK);
  CHECK(c3de_embed_reset(123456) == C3DE_E_STALE);
}

TEST_CASE("A struct of an older caller is written only as far as the caller knows it") {
  const OpenSimulation sim(boxScene("embed-sizes"));
  c3de_embed_status status{};
  std::memset(&status, 0x5a, sizeof status);
  status.size = offsetof(c3de_embed_status, bodies);
  REQUIRE_OK(c3de_embed_get_status(sim.get(), &status));
  CHECK(status.size == offsetof(c3de_embed_status, bodies));
  CHECK(status.steps == 0);
  CHECK(status.bodies == 0x5a5a5a5a5a5a5a5au);
}

TEST_CASE("The library prints nothing and leaves signals, locale and rounding as they were") {
  const auto handlers = [] {
    std::vector<std::string> all;
    for (const int signal : {SIGINT, SIGTERM, SIGSEGV, SIGABRT, SIGFPE}) {
      struct sigaction present {};
      sigaction(signal, nullptr, &present);
      all.emplace_back(reinterpret_cast<const char *>(&present.sa_handler), sizeof present.sa_handler);
    }
    return all;
  };
  const auto before = handlers();
  const std::string file = boxScene("embed-quiet");
  c3de_sim sim = 0;
  REQUIRE(std::setlocale(LC_ALL, "C.UTF-8") != nullptr);
  REQUIRE(std::fesetround(FE_UPWARD) == 0);
  c3de_status opened = C3DE_OK, stepped = C3DE_OK, refused = C3DE_OK;
  std::uint64_t hash = 0;
  std::string printed;
  {
    c3de::ErrorStreamCapture capture;
    opened = tryOpen(file, {}, sim);
    stepped = c3de_embed_step(sim, 5, nullptr);
    (void)c3de_embed_state_hash(sim, &hash);
    refused = c3de_embed_set(sim, "nonsense", "1");
    printed = capture.text();
  }
  const int rounding = std::fegetround();
  std::fesetround(FE_TONEAREST);
  const std::string locale = std::setlocale(LC_ALL, nullptr);
  std::setlocale(LC_ALL, "C");
  CHECK(opened == C3DE_OK);
  CHECK(stepped == C3DE_OK);
  CHECK(refused < 0);
  CHECK(printed.empty());
  CHECK(rounding == FE_UPWARD);
  CHECK(locale == "C.UTF-8");
  CHECK(handlers() == before);
  REQUIRE_OK(c3de_embed_close(sim));
  const OpenSimulation rounded(file);
  REQUIRE_OK(c3de_embed_step(rounded.get(), 5, nullptr));
  CHECK(hashOf(rounded.get()) == hash);
}

TEST_CASE("Only functions of c3de/embed.h are exported, and no library of windows is needed") {
  const auto symbols = c3de::runProcess({"nm", "-D", "--defined-only", C3DE_LIBRARY_FILE}, 60.0);
  if (!symbols || symbols->exitCode != 0) C3DE_SKIP("nm is not installed");
  std::istringstream lines(symbols->output);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) CHECK_THAT(line, Contains(" T c3de_embed_"));
  CHECK(count >= 30);
  const auto needed = c3de::runProcess({"readelf", "-d", C3DE_LIBRARY_FILE}, 60.0);
  REQUIRE(needed);
  for (const char *library : {"libGL", "libEGL", "libglfw", "libX11", "libmpi"})
    CHECK_THAT(needed->output, !Contains(library));
}
