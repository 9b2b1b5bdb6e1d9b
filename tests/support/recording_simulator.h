// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "c3de/abi/iface/changes.h"
#include "c3de/abi/iface/contact.h"
#include "c3de/core/parameter.h"
#include "c3de/core/vec.h"
#include "c3de/sdk/simulator.hpp"

namespace c3de::test {

/// Numbers of points, one row after the other. A missing field is refused.
struct RecordedField {
  std::string name, unit;
  std::vector<double> numbers;
};
using Fields = std::vector<RecordedField>;
std::vector<double> &numbersOf(Fields &fields, const std::string &name);
void eraseField(Fields &fields, const std::string &name);

/// A body reported by the simulator, in metres.
struct ReportedBody {
  std::string name = "body";
  double spacing_m = 0.01;
  std::uint64_t surfacePoints = 0, points = 0;
  Fields skin, inside;
  std::vector<Triangle> triangles;
  std::vector<double> forces_N;  ///< three of each point that points() lends
};
/// A closed cube of eight surface points that has moved. @param edge_m, low_m  in the reference
ReportedBody cubeBody(double edge_m, const Vec3 &low_m, const Vec3 &moved_m);

/// A body that lends `points` points, at most four, to those who add forces.
ReportedBody pointBody(const std::string &name, std::size_t points);

/// The arguments of add_body().
struct AddedBody {
  std::string name;
  std::map<std::string, double> params;
  std::uint64_t fixes = 0;
  bool hasFill = false, hasColour = false;
  std::uint64_t mesh = 0;
};

/// A simulator without physics: returns the values set by the test, records its arguments and calls, fails on request.
/// What is atomic may be used while a simulation calls it.
class RecordingSimulator : public sdk::Object<RecordingSimulator> {
 public:
  RecordingSimulator();
  static std::array<sdk::Interface, 1> interfaces() { return {}; }  // the query of the object finds the table

  [[nodiscard]] c3de_object *object() { return abi(); }
  [[nodiscard]] const c3de_simulator_v1 *table();
  [[nodiscard]] std::uint32_t references();
  /// From now on that function returns an error. Any thread, also while a simulation calls it.
  void fail(const std::string &function, c3de_status with);
  void failNowhere();

  // Returned values:
  std::vector<ReportedBody> bodies;
  std::uint32_t tableSize = sizeof(c3de_simulator_v1);
  bool answersInterface = true;
  bool lacksStateHash = false;
  const c3de_contact_v1 *contact = nullptr;  ///< null: iface.contact is not available
  bool hasChanges = false;                   ///< iface.changes is available
  bool hasStates = false;                    ///< the slots for states are not null
  bool hashesState = false;                  ///< the state hash follows from steps and changes; false: a constant
  bool hasWarmStart = false;                 ///< steps depend on those since the state was last stored, as in a solver
  std::string holding = "hold";              ///< no state is stored while this is the last text of `changed`
  bool hasDisplacement = true, hasInterrupt = true, hasPoints = true;  ///< those slots are not null
  /// Numbers from -1 to 1e9; gravity, min and max: vectors from -10 to 10; enabled, rigid: switches.
  std::vector<std::string> worldIds, bodyIds;
  std::string reportText = R"({"bodies": [], "probes": []})";
  std::vector<std::pair<std::string, Vec3>> probes;  ///< name and position, m
  Vec3 displacement_m{};
  double gap_m = 0.0;
  std::atomic<double> dt_s{1e-3};
  std::atomic<std::int64_t> stepCost_us{0};              ///< duration of a step that is not interrupted
  std::atomic<std::uint64_t> failAtStep{0};              ///< 1: the first; 0: never
  std::atomic<c3de_status> failStatus{C3DE_E_DIVERGED};  ///< of that step
  std::atomic<bool> standsStill{false};                  ///< a step changes nothing
  std::atomic<std::uint64_t> finishesAtStep{0};          ///< a solution without time; 0: not one
  std::uint32_t plannedSteps = 0;                        ///< of that solution
  std::uint32_t stopped = 0;                             ///< bodies
  std::uint32_t triangleComponents = 3;
  std::size_t cancelsFrom = 0;  ///< add_body() is cancelled from this body on; 0: never
  // Recorded arguments and calls:
  std::vector<ParameterValue> world;
  std::vector<AddedBody> added;
  std::vector<std::string> obstacles;
  std::vector<double> rims_m;  ///< of the calls of displacement()
  std::vector<c3de_sim_grid> grids;
  std::vector<std::uint32_t> interrupts;
  std::atomic<std::size_t> interruptCalls{0};
  std::atomic<bool> interrupted{false};
  std::atomic<std::uint64_t> steps{0}, totalSteps{0}, endedSteps{0};  ///< since reset; in all; interrupted
  std::atomic<std::uint64_t> resets{0}, publishes{0}, publishedStep{0};
  std::atomic<std::uint64_t> attached{0};

  /// A change as by a tool: it adds a text, which is part of the state, and is reported to the observer.
  void change(const std::string &text, std::uint32_t flags = 0, const std::string &key = {});
  std::vector<std::string> changed;  ///< those texts; a reset removes those of transient changes

  // The interface:
  void attach(c3de_handle node);
  c3de_status declarations(std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n, std::uint64_t *stride);
  void setWorld(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride);
  void addBody(const c3de_sim_body *in, c3de_handle *out);
  void addObstacle(const c3de_sim_obstacle *in, c3de_handle *out);
  c3de_status addProbe(c3de_str, c3de_handle, const double *, c3de_handle *) { return answer("add_probe"); }
  void setBodyParam(c3de_handle, const c3de_param_value *) {}
  c3de_status getBodyParam(c3de_handle, c3de_str, c3de_param_value *) { return C3DE_E_NOT_FOUND; }
  c3de_status remove(c3de_handle) { return C3DE_E_NOT_FOUND; }
  void clear() {}
  void step();
  void reset();
  void publish();
  c3de_status status(c3de_sim_status *out) const;
  c3de_status stateHash(std::uint64_t *out) const;
  c3de_status report(c3de_sink json) const;
  void bodyAt(std::uint64_t index, c3de_handle *out) const;
  c3de_status bodyInfo(c3de_handle body, c3de_sim_body_info *out) const;
  c3de_status enumFields(c3de_handle body, void *visitor,
                         c3de_status(C3DE_CALL *each)(void *, const c3de_sim_field *)) const;
  c3de_status readField(c3de_handle body, std::uint32_t on, c3de_str name, c3de_mview out) const;
  void triangles(c3de_handle body, c3de_view *out) const;
  c3de_status enumProbes(void *visitor, c3de_status(C3DE_CALL *each)(void *, const c3de_sim_probe *)) const;
  void displacement(const c3de_sim_grid *grid, double rim_m, float *xyz_m, float *gaps_m);
  void interrupt(std::uint32_t raised);
  c3de_status activity(c3de_sink text) const { return sdk::put(text, "a heavy body: less of it would help"); }
  void points(c3de_handle body, c3de_sim_points *out);
  c3de_status saveState(c3de_sink state);
  void loadState(const void *bytes, std::uint64_t n);

 private:
  static c3de_status observe(c3de_object *self, void *observer, void(C3DE_CALL *call)(void *, const c3de_sim_change *));
  static c3de_status applyChange(c3de_object *self, const c3de_sim_change *change);
  [[nodiscard]] c3de_status answer(const char *function) const;
  void check(const char *function) const;  ///< throws where the function fails on request

  c3de_object_vt vt_;
  c3de_simulator_v1 table_;
  std::array<std::vector<c3de_param_decl>, 2> decls_;  ///< of the world, of a body
  mutable std::mutex mutex_;
  std::map<std::string, c3de_status> failing_;  ///< by the name of the function
  c3de_changes_v1 changesTable_{sizeof(c3de_changes_v1), 1, &observe, &applyChange};
  void *observer_ = nullptr;
  void(C3DE_CALL *observed_)(void *, const c3de_sim_change *) = nullptr;
  void notify(const char *id, const std::string &text, const std::string &bytes, std::uint32_t flags,
              const std::string &key, std::uint64_t before);
  std::uint64_t warm_ = 0, path_ = 0;  ///< steps since the state was stored; what steps found, part of the state
  std::size_t lasting_ = 0;            ///< the first texts of `changed` that a reset retains
};

}  // namespace c3de::test
