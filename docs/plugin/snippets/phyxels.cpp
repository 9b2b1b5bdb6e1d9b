// SPDX-License-Identifier: Apache-2.0
// Reads the phyxels of bodies that the point-based plugin simulates: after the first step of each simulation it logs, per
// body, how many there are, their volume, and how far they are strained.
#include <c3de/pointbased/point_sets.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

class Phyxels {
 public:
  static constexpr sdk::PluginInfo info{
      .id = "org.example.phyxels", .version = "1.0.0", .displayName = "Phyxels", .vendor = "You", .license = "MIT"};
  static constexpr std::array needs{sdk::required<c3de_simulation_v1>(2)};

  explicit Phyxels(sdk::Host host) : simulations_(host), log_(host) {
    watch_ = sdk::orThrow(simulations_.watch({}, {}, [this](c3de_handle node, std::uint64_t steps, double) {
      if (steps == 1) report(sdk::orThrow(simulations_.find(node)));
    }));
  }
  void stop() { watch_ = {}; }

 private:
  // Between two steps, on the simulation's thread: a set of a simulator is read there alone.
  void report(const sdk::Ref<> &object) {
    const auto *sets = object.query<c3de_pointbased_bodies_v1>();
    if (sets == nullptr) return;  // somebody else simulates
    const sdk::RunningSimulator simulator(object);
    for (const c3de_handle body : sdk::orThrow(simulator.bodies())) {
      c3de_object *given = nullptr;
      if (sets->phyxels(object.get(), body, &given) < 0) continue;  // it was removed, for example
      const auto phyxels = sdk::Ref<>::adopt(given);
      const auto *table = phyxels.query<c3de_phyxel_set_v1>();
      if (table == nullptr) continue;

      const std::uint64_t count = table->count(phyxels.get());
      std::vector<double> volumes_m3(count), strains(9 * count);
      const c3de_mview volumeRows{volumes_m3.data(), count, 1, C3DE_F64, 0},
          strainRows{strains.data(), count, 9, C3DE_F64, 0};
      if (table->read(phyxels.get(), C3DE_FIELD_VOLUME, volumeRows) < 0 ||
          table->read(phyxels.get(), C3DE_FIELD_STRAIN, strainRows) < 0)
        continue;
      double volume_m3 = 0.0, largest = 0.0;
      for (const double v : volumes_m3) volume_m3 += v;
      for (const double e : strains) largest = std::max(largest, std::abs(e));
      log_.info(std::string(sdk::text(sdk::orThrow(simulator.info(body)).name)) + ": " + std::to_string(count) +
                " phyxels, " + std::to_string(1e6 * volume_m3) + " cm³, largest Green strain " +
                std::to_string(largest));
    }
  }

  sdk::Simulation simulations_;
  sdk::Log log_;
  sdk::SimulationWatch watch_;
};

}  // namespace

C3DE_DEFINE_PLUGIN(Phyxels)
