// SPDX-License-Identifier: Apache-2.0
// Misbehaves in the mode that C3DE_TEST_MODE names, and is correct otherwise: c3de-validate must detect it.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cfenv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <locale>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

bool is(const char *mode) {
  const char *wanted = std::getenv("C3DE_TEST_MODE");
  return wanted != nullptr && std::strcmp(wanted, mode) == 0;
}

void crash() {
  volatile std::uintptr_t nowhere = 8;
  *reinterpret_cast<volatile int *>(nowhere) = 1;
}

void sleepLong() { std::this_thread::sleep_for(std::chrono::minutes(10)); }

// An object whose table is not one of the SDK's, so that each function can be wrong.
struct Odd {
  c3de_object object;
  std::atomic<std::uint32_t> count = 1;
};
struct OddTable {
  std::uint32_t size, rev;
};
constexpr std::array<OddTable, 2> kOddTables{OddTable{sizeof(OddTable), 1}, OddTable{sizeof(OddTable), 1}};
constexpr std::string_view kOddId = "test.odd/1";

std::uint32_t C3DE_CALL oddRetain(c3de_object *self) {
  auto *odd = reinterpret_cast<Odd *>(self);
  static const bool isTorn = is("retain_is_not_atomic"), isMute = is("retain_says_nothing");
  if (isTorn) {
    const std::uint32_t before = odd->count;
    if (before % 1000 == 999) std::this_thread::yield();
    return odd->count = before + 1;
  }
  const std::uint32_t now = ++odd->count;
  return isMute ? 0 : now;
}
std::uint32_t C3DE_CALL oddRelease(c3de_object *self) {
  auto *odd = reinterpret_cast<Odd *>(self);
  static const bool isTorn = is("release_is_not_atomic");
  if (isTorn) {
    const std::uint32_t before = odd->count;
    if (before % 1000 == 999) std::this_thread::yield();
    return odd->count = std::max(before, 2u) - 1;  // never freed: only the count is wrong
  }
  if (const std::uint32_t now = --odd->count; now > 0) return now;
  delete odd;
  return is("release_keeps_one") ? 1 : 0;
}
c3de_status C3DE_CALL oddQuery(c3de_object *, c3de_str id, std::uint32_t minRev, const void **table) {
  static std::atomic<unsigned> calls{0};
  static std::atomic<int> within{0};
  const int others = within++;
  std::this_thread::yield();
  --within;
  if (is("query_is_for_one_at_a_time") && others > 0) return C3DE_E_STATE;
  if (is("query_of_object_crashes_on_long_ids") && id.len > 1000) crash();
  const bool isOurs = sdk::text(id) == kOddId;
  if (!isOurs && !is("answers_everything")) return C3DE_E_NOT_FOUND;
  if (minRev > 1 && !is("claims_every_revision")) return C3DE_E_VERSION;
  if (is("lists_what_it_does_not_answer")) return C3DE_E_NOT_FOUND;
  *table = is("answers_null") ? nullptr : &kOddTables[is("another_table_each_time") ? calls++ % 2 : 0];
  return C3DE_OK;
}
constexpr c3de_object_vt kOddVt{sizeof(c3de_object_vt), 1, oddRetain, oddRelease, oddQuery};

c3de_status C3DE_CALL makeOdd(void *, c3de_object **out) {
  static int made = 0;
  if (is("fails_at_the_hundredth_object") && ++made >= 100) return C3DE_E_NOMEM;
  *out = is("makes_null") ? nullptr : &(new Odd{{&kOddVt}})->object;
  return C3DE_OK;
}

constexpr std::array kWorld{
    sdk::vec3Param({.id = "world.gravity", .label = "Gravity", .unit = "m/s²", .doc = "Of everything."},
                   {.min = -100.0, .max = 100.0, .softMin = -10.0, .softMax = 10.0}, {0.0, -9.81, 0.0})};

/// Drops three points of each body.
class Faller : public sdk::Object<Faller> {
 public:
  template <class Factory>
  explicit Faller(Factory &) {}
  static std::array<sdk::Interface, 1> interfaces();

  void attach(c3de_handle) {}
  c3de_status declarations(std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n,
                           std::uint64_t *stride) {
    if (is("simulator_crashes_on_null") || decls) {
      *decls = kWorld.data();
      *n = scope == C3DE_SIM_SCOPE_WORLD ? kWorld.size() : 0;
      *stride = sizeof kWorld[0];
    }
    if (scope > 3 && !is("simulator_takes_everything")) return C3DE_E_ARG;
    return decls || is("simulator_takes_everything") ? C3DE_OK : C3DE_E_ARG;
  }
  void setWorld(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride) {
    if (is("simulator_takes_everything")) return;
    for (std::uint64_t i = 0; i < n; ++i)
      if (sdk::text(sdk::strided(values, i, stride).id) != "world.gravity")
        throw sdk::Error(C3DE_E_ARG, "unknown key " + std::string(sdk::text(sdk::strided(values, i, stride).id)));
  }
  void addBody(const c3de_sim_body *body, c3de_handle *out) {
    if (!is("simulator_takes_everything") && sdk::readStruct(body, "body").mesh.v == 0)
      throw sdk::Error(C3DE_E_ARG, "no mesh");
    if (is("simulator_refuses_bodies")) throw sdk::Error(C3DE_E_ARG, "I do not like this body");
    hasBody_ = true;
    *out = {1};
  }
  void addObstacle(const c3de_sim_obstacle *, c3de_handle *) { throw sdk::Error(C3DE_E_UNSUPPORTED, "no obstacles"); }
  void addProbe(c3de_str, c3de_handle, const double *, c3de_handle *) {}
  void setBodyParam(c3de_handle, const c3de_param_value *) {}
  void getBodyParam(c3de_handle, c3de_str, c3de_param_value *) {}
  void remove(c3de_handle body) { need(body); }
  void clear() { hasBody_ = false; }
  void interrupt(std::uint32_t raised) { isInterrupted_ = raised != 0 && !is("simulator_ignores_interrupt"); }
  void step() {
    if (is("simulator_is_interrupted_half_way") && isInterrupted_) ++steps_;
    if (is("simulator_ends_with_another_status") && isInterrupted_) throw sdk::Error(C3DE_E_STATE, "interrupted");
    if (isInterrupted_) {
      if (is("simulator_stays_interrupted")) isBroken_ = true;
      throw sdk::Error(C3DE_E_CANCELLED, "interrupted");
    }
    if (isBroken_) throw sdk::Error(C3DE_E_STATE, "broken");
    if (is("simulator_fails") && steps_ == 7) throw sdk::Error(C3DE_E_DIVERGED, "left the finite numbers");
    if (is("simulator_aborts") && steps_ == 7) std::abort();
    if (is("simulator_hangs") && steps_ == 7) sleepLong();
    ++steps_;
    if (is("simulator_rounds_upward")) std::fesetround(FE_UPWARD);
    if (is("simulator_stands_still")) return;
    y_ -= 1e-3;
    if (is("simulator_is_random")) y_ += 1e-12 * static_cast<double>(std::random_device()());
    if (is("simulator_gives_nan") && steps_ == 7) y_ = std::numeric_limits<double>::quiet_NaN();
  }
  void reset() {
    if (is("simulator_cannot_reset")) throw sdk::Error(C3DE_E_STATE, "not now");
    steps_ = 0;
    y_ = is("simulator_resets_nearly") ? 1e-15 : 0.0;
    if (is("simulator_remembers_beyond_reset")) drift_ += 1e-9;
  }
  void publish() {}
  void status(c3de_sim_status *out) {
    if (is("simulator_takes_everything") && (!out || out->size == 0)) return;
    c3de_sim_status s{};
    s.steps = steps_;
    s.time_s = 1e-3 * static_cast<double>(steps_);
    s.dt_s = 1e-3;
    s.bodies = hasBody_ ? 1 : 0;
    sdk::writeStruct(out, s, "out");
  }
  void stateHash(std::uint64_t *out) {
    static std::uint64_t calls = 0;
    *out = is("simulator_hash_is_constant")    ? 1
           : is("simulator_hash_counts_calls") ? ++calls
                                               : steps_ + std::bit_cast<std::uint64_t>(y_);
  }
  c3de_status report(c3de_sink sink) { return sdk::put(sink, "{}"); }
  void bodyAt(std::uint64_t index, c3de_handle *out) {
    if (index > 0 || !hasBody_) throw sdk::Error(C3DE_E_NOT_FOUND, "no such body");
    *out = {1};
  }
  void bodyInfo(c3de_handle body, c3de_sim_body_info *out) {
    need(body);
    if (is("simulator_takes_small_structs") && out->size == 4) return;
    c3de_sim_body_info info{};
    info.name = sdk::str("cube");
    info.surface_points = is("simulator_has_no_surface") ? 0 : 3;
    sdk::writeStruct(out, info, "out");
  }
  c3de_status enumFields(c3de_handle, void *, c3de_status(C3DE_CALL *)(void *, const c3de_sim_field *)) {
    return C3DE_OK;
  }
  void readField(c3de_handle body, std::uint32_t on, c3de_str name, c3de_mview out) {
    need(body);
    if (on != C3DE_SIM_ON_SURFACE || sdk::text(name) != C3DE_SIM_FIELD_POSITION)
      throw sdk::Error(C3DE_E_NOT_FOUND, "no such field");
    for (std::uint64_t i = 0; i < out.count; ++i) {
      auto *row = reinterpret_cast<double *>(static_cast<char *>(out.data) + i * out.stride);
      row[0] = static_cast<double>(i);
      row[1] = y_ + (steps_ > 0 ? drift_ : 0.0);
      row[2] = 0.0;
    }
  }
  c3de_status saveState(c3de_sink sink) {
    double numbers[2]{static_cast<double>(steps_), y_};
    if (is("state_forgets")) numbers[1] = 0.0;
    return sink.put(sink.self, numbers, sizeof numbers);
  }
  void loadState(const void *bytes, std::uint64_t n) {
    double numbers[2]{};
    if (is("state_crashes_on_cut_bytes") && n < 8) crash();
    if (n != sizeof numbers && !is("state_takes_everything")) {
      if (is("state_changes_and_refuses")) y_ += 1.0;
      throw sdk::Error(C3DE_E_FORMAT, "not a state");
    }
    std::memcpy(numbers, bytes, std::min<std::size_t>(n, sizeof numbers));
    if (!(numbers[0] >= 0.0 && numbers[0] < 1e9) || !(std::abs(numbers[1]) < 1e3))
      throw sdk::Error(C3DE_E_FORMAT, "not a state");
    steps_ = static_cast<std::uint64_t>(numbers[0]);
    y_ = numbers[1];
  }
  c3de_status triangles(c3de_handle, c3de_view *) { return C3DE_E_NOT_FOUND; }
  c3de_status enumProbes(void *, c3de_status(C3DE_CALL *)(void *, const c3de_sim_probe *)) { return C3DE_OK; }

 private:
  void need(c3de_handle body) const {
    if (body.v != 1 && !is("simulator_takes_everything")) throw sdk::Error(C3DE_E_NOT_FOUND, "no such body");
  }
  bool hasBody_ = false, isBroken_ = false;
  std::atomic<bool> isInterrupted_{false};
  std::uint64_t steps_ = 0;
  double y_ = 0.0, drift_ = 0.0;
};

constexpr const c3de_simulator_v1 &kTable = sdk::kSimulatorTable<Faller>;
std::array<sdk::Interface, 1> Faller::interfaces() { return {sdk::interfaceOf(kTable)}; }

constexpr std::array kParams{sdk::numberParam({.id = "size", .label = "Size", .unit = "m", .doc = "How large."},
                                              {.min = 0.0, .max = 1.0, .softMin = 0.0, .softMax = 1.0}, 0.5),
                             sdk::numberParam({.id = "age", .label = "", .unit = "s", .doc = "How old."},
                                              {.min = 0.0, .max = 1.0, .softMin = 0.0, .softMax = 1.0}, 0.5)};

struct Comma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

struct OddTool : sdk::Tool {
  void cancel() override {
    if (is("tool_dies_in_cancel")) crash();
  }
  bool onEvent(const c3de_event &event) override {
    if (is("tool_throws")) throw std::runtime_error("of an event");
    if (is("tool_dies_of_the_wheel") && event.type == C3DE_EVENT_WHEEL) crash();
    if (is("tool_hangs") && event.type == C3DE_EVENT_KEY) sleepLong();
    return true;
  }
};

std::vector<std::unique_ptr<std::array<char, 100000>>> leaked;

class Modes : public sdk::Panel {
 public:
  static constexpr sdk::PluginInfo info{
      .id = "test.modes", .version = "1.0.0", .displayName = "Modes", .vendor = "C3DE", .license = "Apache-2.0"};
  static constexpr std::array needs{sdk::required<c3de_registry_v1>(), sdk::optional<c3de_panels_v1>(),
                                    sdk::optional<c3de_params_v1>(),   sdk::optional<c3de_tools_v1>(),
                                    sdk::optional<c3de_files_v1>(),    sdk::optional<c3de_commands_v1>()};

  explicit Modes(sdk::Host host) {
    if (is("create_leaks")) {
      leaked.push_back(std::make_unique<std::array<char, 100000>>());
      leaked.back()->fill('x');
    }
    if (is("needs_a_window")) {
      if (!host.service<c3de_panels_v1>()) crash();
    }
    if (is("dies_without_tools") && !host.service<c3de_tools_v1>() && host.service<c3de_panels_v1>()) crash();
    if (is("refuses_without_tools")) (void)sdk::orThrow(host.require<c3de_tools_v1>());
    const c3de_str odd = sdk::str(kOddId);
    const c3de_class cls{sizeof(c3de_class),
                         1,
                         sdk::str("test.modes.Odd"),
                         sdk::str(is("no_label") ? "" : "Odd"),
                         sdk::str("An object."),
                         &odd,
                         1,
                         nullptr,
                         makeOdd};
    const auto *registry = sdk::orThrow(host.require<c3de_registry_v1>());
    sdk::orThrow(host.check(registry->add_class(registry->ctx, &cls)));
    sdk::orThrow(sdk::Registry(host).add<Faller>("test.modes.Faller", "Faller", "Drops bodies.", *this));
    if (const sdk::Params params(host); params)
      params_ = sdk::orThrow(params.declare("Modes", std::span(kParams).first(is("parameter_without_label") ? 2 : 1),
                                            [](const c3de_param_value &value) {
                                              if (is("parameter_throws")) throw std::runtime_error("of a value");
                                              if (is("parameter_dies_at_the_end") && value.num == 1.0) crash();
                                            }));
    if (host.service<c3de_panels_v1>()) sdk::orThrow(show(host, "test.modes.panel", "Modes"));
    if (host.service<c3de_tools_v1>()) sdk::orThrow(tool_.add(host, {.id = "test.modes.tool", .label = "Odd"}));
    if (const sdk::Files files(host); files)
      reader_ = sdk::orThrow(files.addMeshReader(
          {.id = "test.modes.reader", .label = "Odd", .extensions = {"odd"}},
          [](const sdk::MeshSource &source, sdk::Progress, const sdk::MeshSink &) -> sdk::Result<void> {
            if (is("reader_dies_of_little") && source.bytes.size() < 50) crash();
            if (is("reader_hangs")) sleepLong();
            if (is("reader_writes_to_its_file") && !source.bytes.empty())
              ++const_cast<char &>(reinterpret_cast<const char &>(source.bytes.front()));
            return sdk::Failure{C3DE_E_ARG, "no such file is accepted"};
          }));
    if (const sdk::Files files(host); files)
      writer_ = sdk::orThrow(
          files.addMeshWriter({.id = "test.modes.writer", .label = "Odd", .extensions = {"odd"}},
                              [](const sdk::MeshContents &mesh, sdk::Progress, c3de_sink bytes) -> sdk::Result<void> {
                                if (is("writer_dies_of_much") && mesh.positions.size() > 10'000) crash();
                                if (is("writer_hangs")) sleepLong();
                                if (is("writer_writes_to_its_mesh"))
                                  const_cast<double &>(mesh.positions.front()[0]) += 1.0;
                                if (is("writer_throws")) throw std::runtime_error("of a writer");
                                if (is("writer_puts_nowhere")) bytes.put(bytes.self, nullptr, 100);
                                (void)sdk::put(bytes, "odd");
                                return {};
                              }));
    if (const sdk::Forces forces(host); forces)
      field_ = sdk::orThrow(forces.add("odd", [](const c3de_force_call &call) -> sdk::Result<void> {
        for (std::uint64_t k = 0; is("field_divides_by_zero") && k < call.count; ++k)
          call.forces_N[3 * k] += 1.0 / call.positions_m[3 * k];
        if (call.count > 0) {
          if (is("field_writes_to_positions")) const_cast<double *>(call.positions_m)[0] += 1.0;
          if (is("field_writes_to_velocities")) const_cast<double *>(call.velocities_m_s)[0] += 1.0;
          if (is("field_writes_to_masses")) const_cast<double *>(call.masses_kg)[0] += 1.0;
          if (is("field_writes_beyond_its_forces")) call.forces_N[3 * call.count] = 0.0;
        }
        if (is("field_rounds_upward")) std::fesetround(FE_UPWARD);
        if (is("field_dies_of_little") && call.count < 5) crash();
        if (is("field_throws")) throw std::runtime_error("of a field");
        return {};
      }));
    if (const sdk::Simulation simulations(host); simulations)
      watch_ = sdk::orThrow(simulations.watch({}, {}, [simulations](c3de_handle node, std::uint64_t, double) {
        if (is("stepped_throws")) throw std::runtime_error("of a watch");
        if (const auto object = simulations.find(node)) {
          const sdk::RunningSimulator simulator(*object);
          if (is("stepped_clears_the_simulation")) simulator.table()->clear(simulator.abi());
          if (is("stepped_removes_a_body")) (void)simulator.remove({1});
          if (is("stepped_resets_the_simulation")) simulator.table()->reset(simulator.abi());
        }
      }));
    if (const sdk::Commands commands(host); commands)
      command_ = sdk::orThrow(commands.add({.id = "test.modes.command", .title = "Odd"}, []() -> sdk::Result<void> {
        if (is("command_dies")) crash();
        return {};
      }));
  }
  ~Modes() override {
    if (is("destroy_dies")) crash();
  }

  void start() {
    if (is("start_prints_without_end"))
      for (;;) std::fputs("I am alive, I am alive, I am alive, I am alive, I am alive, I am alive\n", stdout);
    if (is("start_fails")) throw sdk::Error(C3DE_E_STATE, "not today");
    if (is("start_hangs")) sleepLong();
    if (is("start_ends_the_program")) std::exit(0);
    if (is("thread_throws")) {
      std::thread([] { throw std::runtime_error("of a thread"); }).detach();
      std::this_thread::sleep_for(std::chrono::seconds(5));
    }
    if (is("thread_stays")) std::thread(sleepLong).detach();
  }
  void stop() {
    if (is("stop_throws")) throw std::runtime_error("of the end");
    if (is("stop_hangs")) sleepLong();
  }
  void draw(sdk::Ui &ui) override {
    if (is("panel_throws")) throw std::runtime_error("of a panel");
    if (is("panel_dies")) crash();
    if (is("panel_changes_the_locale")) std::locale::global(std::locale(std::locale(), new Comma));
    if (is("panel_hangs")) sleepLong();
    if (is("panel_ends_no_list")) ui.listBegin("list");
    static bool isOn = false;
    (void)ui.checkbox("box", "Box", isOn);
    if (is("panel_dies_of_its_box") && isOn) crash();
  }

 private:
  sdk::ParameterSet params_;
  OddTool tool_;
  sdk::MeshReader reader_;
  sdk::MeshWriter writer_;
  sdk::ForceField field_;
  sdk::SimulationWatch watch_;
  sdk::Command command_;
};

}  // namespace

C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer) {
  if (is("entry_dies")) crash();
  if (is("entry_is_slow")) std::this_thread::sleep_for(std::chrono::milliseconds(15));
  const c3de_status status = sdk::detail::PluginEntry<Modes>::query(offer, answer);
  static std::array<c3de_plugin, 2> copies{};
  static unsigned calls = 0;
  if (is("entry_changes") && answer->plugin) {
    copies[++calls % 2] = *answer->plugin;
    answer->plugin = &copies[calls % 2];
  }
  if (is("entry_takes_every_host") && status < 0)
    return sdk::detail::PluginEntry<Modes>::query(
        std::array{c3de_offer{sizeof(c3de_offer), C3DE_ABI_MAJOR, C3DE_ABI_MAJOR, 0, {}, {}, 0}}.data(), answer);
  if (is("entry_says_no_reason") && status < 0) answer->why_not[0] = '\0';
  if (is("entry_writes_behind")) std::memset(reinterpret_cast<char *>(answer) + sizeof *answer, 0, 8);
  return status;
}
