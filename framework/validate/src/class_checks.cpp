// SPDX-License-Identifier: Apache-2.0
// Objects of the plugin's classes; for simulators, with a small body.
#include <fmt/format.h>

#include <array>
#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/first_size.h"
#include "c3de/core/plugin_table.h"
#include "c3de/core/text.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/build_scene.h"
#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/verification.h"
#include "check.h"
#include "simulated.h"
#include "trial.h"

namespace c3de::validate {
namespace {

using Clock = std::chrono::steady_clock;

c3de_str text(const std::string &s) { return {s.data(), s.size()}; }

/// The problem with one object; empty if there is none.
std::string problemOf(c3de_object *object, const plugin_host::ClassInfo &cls) {
  const c3de_object_vt &vt = *object->vt;
  const std::uint32_t two = vt.retain(object), one = vt.release(object);
  if (two != 2 || one != 1)
    return fmt::format("retain of a new object answers {}, release after it {}; they must be 2 and 1", two, one);
  const void *untouched = &vt, *table = untouched;
  const auto refuses = [&](const std::string &id, std::uint32_t revision) {
    table = untouched;
    return vt.query(object, text(id), revision, &table) < 0;
  };
  if (!refuses("no.such.iface/1", 0)) return "answers an interface that does not exist, no.such.iface/1";
  if (!refuses("", 0)) return "answers an interface without an id";
  if (!refuses(std::string(100000, 'x'), 0)) return "answers an interface with an id of 100000 characters";
  for (const std::string &id : cls.interfaces) {
    table = nullptr;
    if (const c3de_status status = vt.query(object, text(id), 0, &table); status < 0 || table == nullptr)
      return fmt::format("does not implement {} (status {}), which its class lists", id, status);
    std::uint32_t size = 0;
    std::memcpy(&size, table, sizeof size);
    if (size < 2 * sizeof(std::uint32_t)) return fmt::format("answers {} with a table of size {}", id, size);
    const void *again = nullptr;
    if (vt.query(object, text(id), 0, &again) < 0 || again != table)
      return fmt::format("answers {} with another table each time", id);
    if (!refuses(id, 0xffffffffu)) return fmt::format("claims to have revision {} of {}", 0xffffffffu, id);
  }
  return {};
}

Verdict classes(const Trial &trial) {
  constexpr int kTimes = 200;
  const LoadedPlugin loaded(trial, TrialHost::Serves::all);
  if (!loaded.refusal.empty()) return fail(loaded.refusal);
  int made = 0;
  for (const plugin_host::ClassInfo &cls : loaded.host->host->classes()) {
    if (cls.plugin != loaded.id()) continue;
    if (cls.label.empty()) return warn("the class " + cls.id + " has no label");
    for (int i = 0; i < kTimes; ++i, ++made) {
      const auto object = loaded.host->host->createObject(cls.id);
      if (!object) return fail(fmt::format("object {} of {}: {}", i + 1, cls.id, object.error().message));
      if (const std::string problem = problemOf(*object, cls); !problem.empty()) return fail(cls.id + ": " + problem);
      if (const std::uint32_t left = (*object)->vt->release(*object); left != 0)
        return fail(fmt::format("{}: the last release answers {} instead of 0", cls.id, left));
    }
  }
  if (made == 0) return skip("it has no classes");
  const Verdict said = loaded.complaints();
  return said.result == Result::pass ? pass(fmt::format("{} objects", made)) : said;
}

constexpr std::uint32_t kSharers = 4, kRetains = 20000;

void inThreads(const std::function<void()> &work) {
  std::vector<std::thread> threads;
  for (std::uint32_t i = 0; i < kSharers; ++i) threads.emplace_back(work);
  for (std::thread &thread : threads) thread.join();
}

/// The problem with one object shared by several threads; empty if there is none.
std::string sharedProblemOf(c3de_object *object, const plugin_host::ClassInfo &cls) {
  const c3de_object_vt &vt = *object->vt;
  const auto count = [&] {
    vt.retain(object);
    return vt.release(object);
  };
  // All retain before any releases: a wrong count then frees nothing too early.
  inThreads([&] {
    for (std::uint32_t i = 0; i < kRetains; ++i) vt.retain(object);
  });
  if (const std::uint32_t all = count(); all != 1 + kSharers * kRetains)
    return fmt::format("{} threads retain {} times each, and the count is {} instead of {}; it must be atomic",
                       kSharers, kRetains, all, 1 + kSharers * kRetains);
  std::atomic<int> refused{0};
  inThreads([&] {
    for (std::uint32_t i = 0; i < kRetains; ++i) {
      const void *table = nullptr;
      if (i < 500)
        for (const std::string &id : cls.interfaces)
          if (vt.query(object, text(id), 0, &table) < 0 || table == nullptr) ++refused;
      vt.release(object);
    }
  });
  if (const std::uint32_t left = count(); left != 1)
    return fmt::format(
        "{} threads release what they have retained, and the count is {} instead of 1; it must be atomic", kSharers,
        left);
  if (refused > 0) return fmt::format("{} queries of several threads at once are refused", refused.load());
  return {};
}

Verdict sharedObjects(const Trial &trial) {
  const LoadedPlugin loaded(trial, TrialHost::Serves::all);
  if (!loaded.refusal.empty()) return fail(loaded.refusal);
  int made = 0;
  for (const plugin_host::ClassInfo &cls : loaded.host->host->classes()) {
    if (cls.plugin != loaded.id()) continue;
    recordAction("shares an object of " + cls.id);
    const auto object = loaded.host->host->createObject(cls.id);
    if (!object) return fail(cls.id + ": " + object.error().message);
    ++made;
    if (const std::string problem = sharedProblemOf(*object, cls); !problem.empty())
      return fail(cls.id + ": " + problem);
    (*object)->vt->release(*object);
  }
  if (made == 0) return skip("it has no classes");
  return loaded.complaints();
}

Verdict simulators(const Trial &trial) {
  const std::vector<std::string> ids = simulatorClasses(trial);
  if (ids.empty()) return skip("no class of it simulates");
  constexpr int kSteps = 20;
  for (const std::string &id : ids) {
    const Simulated first(trial, id);
    if (!first.refusal.empty()) return fail(id + " refuses a cube of 10 cm: " + first.refusal);
    const std::vector<Vec3> atRest = first.surface();
    if (atRest.empty()) return warn(id + " shows no surface of a body");
    const std::uint64_t hashAtRest = first.hash();
    if (const std::string bad = first.step(kSteps); !bad.empty()) return fail(id + ": " + bad);
    const std::vector<Vec3> moved = first.surface();
    if (moved.size() != atRest.size()) return fail(id + ": the surface has another number of points after some steps");
    for (const Vec3 &point : moved)
      for (const double x : point)
        if (!std::isfinite(x)) return fail(id + ": a point of the surface is not finite after some steps");
    if (first.hasGravity && moved == atRest)
      return warn(
          id +
          ": a cube of 10 cm around the origin, under gravity and held by nothing, does not move with the defaults of "
          "the parameters");
    const std::uint64_t hashMoved = first.hash();
    if (moved != atRest && hashMoved == hashAtRest)
      return fail(id + ": state_hash stays the same while the surface moves");
    if (first.table->reset(first.object()) < 0) return fail(id + ": reset fails: " + first.errorText());
    if (first.surface() != atRest)
      return fail(id + ": reset does not lead back to the state at the beginning, exactly");
    if (first.hash() != hashAtRest) return fail(id + ": state_hash after a reset is not that of the beginning");
    if (const std::string bad = first.step(kSteps); !bad.empty()) return fail(id + ", after a reset: " + bad);
    if (first.surface() != moved) return fail(id + ": the same steps after a reset lead to another state");
    const Simulated second(trial, id);
    if (const std::string bad = second.step(kSteps); !bad.empty()) return fail(id + ", a second one: " + bad);
    if (second.surface() != moved || second.hash() != hashMoved)
      return fail(id + ": two simulators of the same scene differ");
  }
  return pass(fmt::format("{} class{}", ids.size(), ids.size() == 1 ? "" : "es"));
}

/// The problem when a step is interrupted; empty if there is none.
std::string interruptProblemOf(const Simulated &one) {
  constexpr double kMost_s = 3.0;  // "within a second or so"
  const c3de_simulator_v1 *table = one.table;
  c3de_object *self = one.object();
  const std::uint64_t before = one.hash();
  table->interrupt(self, 1);
  const c3de_status refused = table->step(self);
  if (refused != C3DE_E_CANCELLED)
    return fmt::format("a step after interrupt(1) answers {} instead of {} (C3DE_E_CANCELLED)", refused,
                       C3DE_E_CANCELLED);
  if (one.hash() != before) return "a step that was interrupted leaves another state than the one before it";
  table->interrupt(self, 0);
  if (const std::string bad = one.step(1); !bad.empty()) return "after interrupt(0), " + bad;

  std::atomic<Clock::rep> raisedAt{0};
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    raisedAt = Clock::now().time_since_epoch().count();
    table->interrupt(self, 1);
  });
  c3de_status status = C3DE_OK;
  double waited_s = 0.0;
  std::uint64_t lastGood = one.hash();
  while (status >= 0 && waited_s < kMost_s) {
    lastGood = one.hash();
    status = table->step(self);
    if (const Clock::rep raised = raisedAt; raised != 0)
      waited_s = std::chrono::duration<double>(Clock::now().time_since_epoch() - Clock::duration(raised)).count();
  }
  other.join();
  if (status != C3DE_E_CANCELLED)
    return fmt::format("interrupt(1) of another thread: a step answers {} instead of {} (C3DE_E_CANCELLED)", status,
                       C3DE_E_CANCELLED);
  if (waited_s > kMost_s) return fmt::format("interrupt(1) of another thread ends the step after {:.1f} s", waited_s);
  if (one.hash() != lastGood) return "interrupt(1) of another thread leaves another state than the one before the step";
  table->interrupt(self, 0);
  if (const std::string bad = one.step(3); !bad.empty()) return "after it was interrupted, " + bad;
  return {};
}

Verdict interrupts(const Trial &trial) {
  const std::vector<std::string> ids = simulatorClasses(trial);
  if (ids.empty()) return skip("no class of it simulates");
  int served = 0;
  for (const std::string &id : ids) {
    const Simulated one(trial, id);
    if (!one.refusal.empty()) return fail(id + ": " + one.refusal);
    if (!session::endsSteps(one.table)) continue;
    ++served;
    recordAction("interrupts " + id);
    if (const std::string problem = interruptProblemOf(one); !problem.empty()) return fail(id + ": " + problem);
  }
  return served > 0 ? pass() : skip("its steps run to their end (no interrupt)");
}

Verdict states(const Trial &trial) {
  constexpr int kSteps = 7;
  int keeping = 0;
  for (const std::string &id : simulatorClasses(trial)) {
    const Simulated one(trial, id);
    if (!one.refusal.empty()) return fail(id + ": " + one.refusal);
    if (one.table->save_state == nullptr) continue;
    ++keeping;
    if (one.table->load_state == nullptr) return fail(id + " saves states, but does not load them");
    std::string state;
    if (const std::string bad = one.step(kSteps); !bad.empty()) return fail(id + ": " + bad);
    if (one.table->save_state(one.object(), scene::sinkInto(state)) < 0)
      return fail(id + ": a state cannot be saved: " + one.errorText());
    if (const std::string bad = one.step(kSteps); !bad.empty()) return fail(id + ": " + bad);
    const std::uint64_t hash = one.hash();
    const auto load = [&](const Simulated &into, const std::string &bytes) {
      return into.table->load_state(into.object(), bytes.data(), bytes.size()) >= 0;
    };
    // Into the same one, and into a new one of the same scene.
    const Simulated other(trial, id);
    for (const Simulated *into : {&one, &other}) {
      if (!load(*into, state)) return fail(id + ": its own state is refused: " + into->errorText());
      if (const std::string bad = into->step(kSteps); !bad.empty()) return fail(id + ", from a state: " + bad);
      if (into->hash() != hash) return fail(id + ": the steps after a loaded state are not those after the saved one");
    }
    // The host has checked the checksum; a plugin may still receive such bytes, from another version of itself.
    Random random(trial.seed);
    for (int i = 0; i < 200; ++i) {
      std::string cut = state.substr(0, random.below(state.size()));
      if (load(one, cut))
        return fail(fmt::format("{}: {} of {} bytes of a state are accepted", id, cut.size(), state.size()));
      if (one.hash() != hash) return fail(id + ": a state that was refused has changed something");
    }
    // Random numbers may be a valid state; they must not end the process, and a reset must restore the start.
    std::string rubbish(state.size(), '\0');
    for (int i = 0; i < 50; ++i) {
      for (char &byte : rubbish) byte = static_cast<char>(random.below(256));
      if (load(one, rubbish)) (void)one.table->step(one.object());
    }
    if (one.table->reset(one.object()) < 0) return fail(id + ": reset after states fails: " + one.errorText());
    if (const std::string bad = one.step(2 * kSteps); !bad.empty()) return fail(id + ", after states: " + bad);
    if (one.hash() != hash) return fail(id + ": after states and a reset, the same steps give another result");
  }
  return keeping == 0 ? skip("no simulator of it keeps states") : pass();
}

/// A change that a simulator has reported.
struct ReportedChange {
  std::string id, bytes;
  [[nodiscard]] c3de_sim_change abi() const {
    c3de_sim_change change{};
    change.size = sizeof change;
    change.id = text(id);
    change.bytes = bytes.data();
    change.n = bytes.size();
    return change;
  }
};

void C3DE_CALL recordChange(void *observer, const c3de_sim_change *change) noexcept {
  static_cast<std::vector<ReportedChange> *>(observer)->push_back(
      {std::string(fromAbi(change->id)),
       std::string(static_cast<const char *>(change->bytes), static_cast<std::size_t>(change->n))});
}

/// Sets a parameter of the world: gravity, or the first number.
std::string changeWorld(const Simulated &one) {
  const auto declared = session::simulatorDeclarations(one.object(), C3DE_SIM_SCOPE_WORLD);
  if (!declared) return declared.error().message;
  c3de_param_value value{};
  value.size = sizeof value;
  for (const auto &decl : *declared) {
    if (one.hasGravity ? decl.id != "world.gravity" : decl.type != C3DE_PARAM_F64) continue;
    value.type = one.hasGravity ? C3DE_PARAM_VEC3 : C3DE_PARAM_F64;
    value.id = text(decl.id);
    value.num = decl.fallback;
    value.vec[2] = -1.0;
    if (one.table->set_world(one.object(), &value, 1, sizeof value) < 0)
      return "set_world refuses a value that is declared: " + one.errorText();
    break;
  }
  return {};
}

/// The problem with the changes of two simulators of the same scene; empty if there is none.
std::string changesProblemOf(const c3de_changes_v1 &changes, const Simulated &first, const Simulated &second) {
  constexpr int kSteps = 3;
  std::vector<ReportedChange> reported;
  if (changes.apply(first.object(), nullptr) >= 0) return "apply(null) is accepted";
  if (changes.observe(first.object(), &reported, recordChange) < 0) return "observe is refused: " + first.errorText();
  for (const Simulated *one : {&first, &second})
    if (const std::string bad = one->step(kSteps); !bad.empty()) return bad;
  if (const std::string bad = changeWorld(first); !bad.empty()) return bad;
  if (changes.observe(first.object(), nullptr, nullptr) < 0) return "observe(null) is refused: " + first.errorText();
  const std::size_t count = reported.size();
  if (const std::string bad = changeWorld(first); !bad.empty()) return bad;
  if (reported.size() != count) return "an observer is called after observe(null)";
  const std::uint64_t before = second.hash();
  c3de_sim_change unknown = ReportedChange{"no.such.change", "bytes"}.abi();
  if (changes.apply(second.object(), &unknown) != C3DE_E_FORMAT)
    return fmt::format("a change of an unknown kind is not refused with {} (C3DE_E_FORMAT)", C3DE_E_FORMAT);
  for (const ReportedChange &change : reported) {
    if (change.id.empty()) return "a change is reported without an id";
    for (std::size_t n = 0; n < change.bytes.size(); ++n) {
      c3de_sim_change cut = change.abi();
      cut.n = n;
      if (changes.apply(second.object(), &cut) >= 0)
        return fmt::format("{} is accepted with {} of its {} bytes", change.id, n, change.bytes.size());
    }
    if (second.hash() != before) return "a change that was refused has changed the state";
    const c3de_sim_change whole = change.abi();
    if (changes.apply(second.object(), &whole) < 0)
      return change.id + " is reported, and refused by apply: " + second.errorText();
  }
  for (const Simulated *one : {&first, &second})
    if (const std::string bad = one->step(kSteps); !bad.empty()) return "after a change, " + bad;
  if (first.hash() != second.hash()) return "a repeated change leads to another state";
  return {};
}

Verdict repeatsChanges(const Trial &trial) {
  int serving = 0;
  for (const std::string &id : simulatorClasses(trial)) {
    const Simulated first(trial, id), second(trial, id);
    if (!first.refusal.empty()) return fail(id + ": " + first.refusal);
    if (!second.refusal.empty()) return fail(id + ": " + second.refusal);
    const auto changes = session::changesTable(first.object());
    if (!changes) return fail(id + ": " + changes.error().message);
    if (*changes == nullptr) continue;
    ++serving;
    recordAction("changes " + id);
    if (const std::string problem = changesProblemOf(**changes, first, second); !problem.empty())
      return fail(id + ": " + problem);
  }
  return serving == 0 ? skip("no simulator of it reports its changes") : pass();
}

c3de_status C3DE_CALL unwanted(void *, double, c3de_str) noexcept { return C3DE_E_CANCELLED; }

Verdict verifies(const Trial &trial) {
  int serving = 0;
  for (const std::string &id : simulatorClasses(trial)) {
    const Simulated one(trial, id);
    if (!one.refusal.empty()) return fail(id + ": " + one.refusal);
    if (!session::verifiesStates(one.table)) continue;
    ++serving;
    if (const std::string bad = one.step(3); !bad.empty()) return fail(id + ": " + bad);
    const std::uint64_t before = one.hash();
    std::string said;
    if (one.table->verify(one.object(), nullptr, scene::sinkInto(said)) < 0)
      return fail(id + ": its state cannot be verified: " + one.errorText());
    if (session::verificationLines(said).empty())
      return fail(id + ": a verification says nothing of any body: " + said);
    const c3de_progress nobody{sizeof(c3de_progress), 0, nullptr, unwanted};
    if (const c3de_status status = one.table->verify(one.object(), &nobody, scene::sinkInto(said));
        status != C3DE_E_CANCELLED)
      return fail(fmt::format("{}: a cancelled verification answers {} instead of {} (C3DE_E_CANCELLED)", id, status,
                              C3DE_E_CANCELLED));
    if (one.hash() != before) return fail(id + ": a verification has changed the state");
  }
  return serving == 0 ? skip("no simulator of it verifies its states") : pass();
}

/// Invalid pairs and probe tools. @param refuse(what, status)
template <class Refuse>
void refuseContact(const c3de_contact_v1 &contact, c3de_object *self, c3de_handle nobody, const Refuse &refuse) {
  refuse("set_pair(null)", contact.set_pair(self, nullptr));
  c3de_sim_contact_pair pair{};
  pair.size = sizeof pair;
  refuse("set_pair of the walls with themselves", contact.set_pair(self, &pair));
  pair.first = nobody;
  refuse("set_pair of nobody", contact.set_pair(self, &pair));
  if (contact.add_probe_tool == nullptr) return;
  c3de_handle handle{};
  refuse("add_probe_tool(null)", contact.add_probe_tool(self, nullptr, &handle));
  c3de_sim_tool_place path[2]{};
  for (c3de_sim_tool_place &place : path) place.size = sizeof place;
  path[1].time_s = 1.0;
  c3de_sim_probe_tool tool{};
  tool.size = sizeof tool;
  tool.path_stride = sizeof path[0];
  tool.name = {"tool", 4};
  tool.radius_m = 0.001;
  tool.path_n = 2;
  refuse("add_probe_tool without a path", contact.add_probe_tool(self, &tool, &handle));
  tool.path = path;
  tool.path_n = 1;
  refuse("add_probe_tool with one place", contact.add_probe_tool(self, &tool, &handle));
  tool.path_n = 2;
  for (const double radius : {0.0, -1.0, std::nan("")}) {
    tool.radius_m = radius;
    refuse("add_probe_tool without a radius", contact.add_probe_tool(self, &tool, &handle));
  }
  tool.radius_m = 0.001;
  path[1].time_s = 0.0;
  refuse("add_probe_tool with times that do not ascend", contact.add_probe_tool(self, &tool, &handle));
  path[1].time_s = 1.0;
  path[1].at_m[1] = std::nan("");
  refuse("add_probe_tool with a place that is not finite", contact.add_probe_tool(self, &tool, &handle));
  refuse("enum_probe_tools(null)", contact.enum_probe_tools(self, nullptr, nullptr));
}

/// Invalid attachments. @param refuse(what, status)
template <class Refuse>
void refuseAttachments(const c3de_attachment_v1 &attachments, c3de_object *self, c3de_handle nobody,
                       const Refuse &refuse) {
  c3de_handle handle{};
  refuse("add attachment(null)", attachments.add(self, nullptr, &handle));
  c3de_sim_attachment attachment{};
  attachment.size = sizeof attachment;
  attachment.name = {"layer", 5};
  attachment.stiffness_Pa_m = attachment.tangential_Pa_m = 1.0;
  refuse("an attachment of no body", attachments.add(self, &attachment, &handle));
  attachment.first = nobody;
  refuse("an attachment of nobody", attachments.add(self, &attachment, &handle));
  for (const double stiffness : {-1.0, std::nan("")}) {
    attachment.stiffness_Pa_m = stiffness;
    refuse("an attachment of no stiffness", attachments.add(self, &attachment, &handle));
  }
  refuse("enumerate attachments(null)", attachments.enumerate(self, nullptr, nullptr));
}

/// Invalid grasps. @param refuse(what, status)
template <class Refuse>
void refuseGrasps(const c3de_grasp_v1 &grasps, c3de_object *self, c3de_handle nobody, const Refuse &refuse) {
  c3de_handle handle{};
  refuse("add grasp(null)", grasps.add(self, nullptr, &handle));
  c3de_sim_grasp grasp{};
  grasp.size = sizeof grasp;
  grasp.path_stride = sizeof(c3de_sim_grasp_place);
  grasp.name = {"jaws", 4};
  grasp.body = nobody;
  grasp.axis[0] = 1.0;
  grasp.jaw_m = 0.01;
  grasp.opening_m = 0.02;
  refuse("a grasp of nobody", grasps.add(self, &grasp, &handle));
  for (const double jaw : {0.0, 0.03, std::nan("")}) {
    grasp.jaw_m = jaw;
    refuse("a grasp with jaws that do not stand in their opening", grasps.add(self, &grasp, &handle));
  }
  grasp.jaw_m = 0.01;
  grasp.path_n = 1;
  refuse("a grasp without its path", grasps.add(self, &grasp, &handle));
}

/// Structs smaller than their first revision. @param refuse(what, status)
template <class T, class Call, class Refuse>
void refuseSmall(const char *what, T given, const Refuse &refuse, const Call &call) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{4}, MinimumSize<T>::value - 1}) {
    given.size = static_cast<std::uint32_t>(size);
    refuse(fmt::format("{} with a {} of size {}", what, MinimumSize<T>::name, size).c_str(), call(&given));
  }
}

template <class Refuse>
void refuseSmallStructs(const c3de_simulator_v1 &table, c3de_object *self, const Refuse &refuse) {
  c3de_handle body{}, handle{};
  if (table.body_at(self, 0, &body) < 0) return;
  refuseSmall("status", c3de_sim_status{}, refuse, [&](auto *out) { return table.status(self, out); });
  refuseSmall("body_info", c3de_sim_body_info{}, refuse, [&](auto *out) { return table.body_info(self, body, out); });
  refuseSmall("add_body", c3de_sim_body{}, refuse, [&](auto *in) { return table.add_body(self, in, &handle); });
  refuseSmall("add_obstacle", c3de_sim_obstacle{}, refuse,
              [&](auto *in) { return table.add_obstacle(self, in, &handle); });
  if (table.points != nullptr)
    refuseSmall("points", c3de_sim_points{}, refuse, [&](auto *out) { return table.points(self, body, out); });
  if (table.add_load != nullptr)
    refuseSmall("add_load", c3de_sim_load{}, refuse, [&](auto *in) { return table.add_load(self, body, in, &handle); });
  if (table.hold != nullptr)
    refuseSmall("hold", c3de_sim_hold{}, refuse, [&](auto *in) { return table.hold(self, body, in, &handle); });
}

Verdict simulatorArguments(const Trial &trial) {
  const std::vector<std::string> ids = simulatorClasses(trial);
  if (ids.empty()) return skip("no class of it simulates");
  for (const std::string &id : ids) {
    const Simulated one(trial, id);
    if (!one.refusal.empty()) return fail(id + ": " + one.refusal);
    const c3de_simulator_v1 *table = one.table;
    c3de_object *self = one.object();
    std::string accepted;
    const auto refuse = [&](const char *what, c3de_status status) {
      if (status >= 0) accepted += (accepted.empty() ? "" : ", ") + std::string(what);
    };
    c3de_handle handle{}, nobody{0x1234567890abcdefu};
    refuse("add_body(null)", table->add_body(self, nullptr, &handle));
    c3de_sim_body body{};
    body.size = sizeof body;
    refuse("add_body without a mesh", table->add_body(self, &body, &handle));
    body.size = 0;
    refuse("add_body of size 0", table->add_body(self, &body, &handle));
    refuse("remove of what is not there", table->remove(self, nobody));
    refuse("status(null)", table->status(self, nullptr));
    c3de_sim_status status{};
    refuse("status of size 0", table->status(self, &status));
    refuseSmallStructs(*table, self, refuse);
    refuse("declarations of a scope that nobody has",
           table->declarations(self, 0xffffffffu, nullptr, nullptr, nullptr));
    c3de_param_value unknown{};
    unknown.size = sizeof unknown;
    unknown.type = C3DE_PARAM_F64;
    unknown.id = {"no.such.key", 11};
    refuse("set_world of a key that it has not declared", table->set_world(self, &unknown, 1, sizeof unknown));
    refuse("body_info of nobody", table->body_info(self, nobody, nullptr));
    refuse("read_field of nobody", table->read_field(self, nobody, 0, {"position", 8}, {}));
    const auto contact = session::contactTable(self);
    if (!contact) return fail(id + ": " + contact.error().message);
    if (*contact != nullptr) refuseContact(**contact, self, nobody, refuse);
    const auto attachments = session::attachmentTable(self);
    if (!attachments) return fail(id + ": " + attachments.error().message);
    if (*attachments != nullptr) refuseAttachments(**attachments, self, nobody, refuse);
    const auto grasps = session::graspTable(self);
    if (!grasps) return fail(id + ": " + grasps.error().message);
    if (*grasps != nullptr) refuseGrasps(**grasps, self, nobody, refuse);
    if (!accepted.empty()) return fail(id + " accepts what it must refuse: " + accepted);
    if (const std::string bad = one.step(3); !bad.empty()) return fail(id + ", after calls it has refused: " + bad);
  }
  return pass();
}

constexpr std::array kChecks{
    Check{"classes", "200 objects of each class: counts, interfaces, and what is asked of them in vain", &classes},
    Check{"classes.shared", "One object of each class, retained, asked and released by 4 threads at once",
          &sharedObjects},
    Check{"simulators", "A cube falls, comes back by reset, and falls again, to the bit", &simulators},
    Check{"simulators.interrupt", "A step is interrupted, also by another thread, and leaves the state before it",
          &interrupts},
    Check{"simulators.states",
          "A saved state goes on to the bit, here and in another one; cut ones are refused, random ones harmless",
          &states},
    Check{"simulators.verify", "A verification says how far its bodies are off, can be cancelled, and changes nothing",
          &verifies},
    Check{"simulators.changes",
          "A change is reported, repeated by another simulator to the bit, and refused with cut bytes",
          &repeatsChanges},
    Check{"simulators.arguments", "Null, empty, foreign and non-finite arguments are refused, and it goes on",
          &simulatorArguments}};

}  // namespace

std::span<const Check> classChecks() { return kChecks; }

}  // namespace c3de::validate
