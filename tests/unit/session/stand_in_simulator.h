// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "c3de/abi/iface/contact.h"
#include "c3de/abi/iface/simulator.h"
#include "c3de/core/parameter.h"
#include "c3de/core/vec.h"

namespace c3de::session::test {

/// Numbers of points, one row after the other. A missing field is refused.
struct StandInField {
  std::string name, unit;
  std::vector<double> numbers;
};
using Fields = std::vector<StandInField>;
std::vector<double> &numbersOf(Fields &fields, const std::string &name);
void eraseField(Fields &fields, const std::string &name);

/// A body reported by the stand-in, in metres.
struct StandInBody {
  std::string name = "body";
  double spacing_m = 0.01;
  std::uint64_t surfacePoints = 0, points = 0;
  Fields skin, inside;
  std::vector<Triangle> triangles;
};
/// A closed cube of eight surface points that has moved. @param edge_m, low_m  in the reference
StandInBody cubeBody(double edge_m, const Vec3 &low_m, const Vec3 &moved_m);

/// The arguments of add_body().
struct AddedBody {
  std::string name;
  std::map<std::string, double> params;
  std::uint64_t fixes = 0;
  bool hasFill = false, hasColour = false;
  std::uint64_t mesh = 0;
};

/// A simulator without physics: returns the values set by the test, records its arguments, fails on request.
class StandInSimulator {
 public:
  StandInSimulator();
  StandInSimulator(const StandInSimulator &) = delete;
  StandInSimulator &operator=(const StandInSimulator &) = delete;

  [[nodiscard]] c3de_object *object() { return &shared_.object; }
  [[nodiscard]] const c3de_simulator_v1 *table();
  [[nodiscard]] int references() const { return references_; }
  /// From now on that function returns an error. Any thread, also while a simulation calls it.
  void fail(const std::string &function, c3de_status with);
  void failNowhere();

  // Returned values:
  std::vector<StandInBody> bodies;
  std::uint32_t tableSize = sizeof(c3de_simulator_v1);
  bool answersInterface = true;
  bool lacksStateHash = false;
  const c3de_contact_v1 *contact = nullptr;          ///< null: iface.contact is not available
  bool hasDisplacement = true, hasInterrupt = true;  ///< those slots are not null
  /// Numbers from -1 to 1e9; gravity, min and max: vectors from -10 to 10; enabled, rigid: switches.
  std::vector<std::string> worldIds, bodyIds;
  std::string report = R"({"bodies": [], "probes": []})";
  std::vector<std::pair<std::string, Vec3>> probes;  ///< name and position, m
  Vec3 displacement_m{};
  double gap_m = 0.0;
  double dt_s = 0.1;
  bool standsStill = false;          ///< a step changes nothing
  std::uint64_t finishesAtStep = 0;  ///< a solution without time; 0: not one
  std::uint32_t plannedSteps = 0;    ///< of that solution
  std::uint32_t stopped = 0;         ///< bodies
  std::uint32_t triangleComponents = 3;
  std::size_t cancelsFrom = 0;  ///< add_body() is cancelled from this body on; 0: never
  // Recorded arguments:
  std::vector<ParameterValue> world;
  std::vector<AddedBody> added;
  std::vector<std::string> obstacles;
  std::vector<double> rims_m;  ///< of the calls of displacement()
  std::vector<c3de_sim_grid> grids;
  std::vector<std::uint32_t> interrupts;
  std::atomic<std::size_t> interruptCalls{0};
  std::atomic<std::uint64_t> steps{0};
  std::atomic<std::uint64_t> attached{0};

 private:
  struct Shared {
    c3de_object object;
    StandInSimulator *owner;
  };
  static StandInSimulator &of(c3de_object *self) { return *reinterpret_cast<Shared *>(self)->owner; }
  static c3de_object_vt makeVt();
  static c3de_simulator_v1 makeTable();
  [[nodiscard]] c3de_status answer(const char *function) const;
  void declare();

  c3de_object_vt vt_ = makeVt();
  c3de_simulator_v1 table_ = makeTable();
  Shared shared_{};
  std::vector<c3de_param_decl> worldDecls_, bodyDecls_;
  mutable std::mutex failingMutex_;
  std::map<std::string, c3de_status> failing_;  ///< by the name of the function
  std::atomic<int> references_{1};
};

}  // namespace c3de::session::test
