// SPDX-License-Identifier: Apache-2.0
#include "simulator/continuation.h"

#include <nlohmann/json.hpp>

#include "c3de/sdk/structs.hpp"
#include "simulator/world_simulator.h"

namespace pointbased {

using sdk::Error;

void Continuation::continueFrom(c3de_object *other, c3de_sink json) {
  WorldSimulator *simulator = WorldSimulator::fromAbi(other);
  if (!simulator || &simulator->parts().world == &world_)
    throw Error(C3DE_E_ARG, "other: is not another simulator of this class");
  SimulatedWorld &before = simulator->parts().world;
  const StepInterrupt::Waiting waiting(before.request);
  const std::scoped_lock lock(before.mutex, world_.mutex);
  for (SimulatedWorld *world : {&before, &world_}) (void)world->restoreState();
  conditions_.update();
  simulator->parts().conditions.update();
  const std::vector<SavedCondition> own = conditions_.saved();
  // Their ramps have begun before.
  conditions_.restore(simulator->parts().conditions.saved());
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const std::uint64_t id : world_.table.bodiesInOrder())
    for (const std::uint64_t theirs : before.table.bodiesInOrder())
      if (world_.table.body(id)->identity() == before.table.body(theirs)->identity()) pairs.emplace_back(theirs, id);
  const auto continued = world_.simulator.archive().continueFrom(before.simulator.archive(), pairs);
  if (!continued) {
    conditions_.restore(own);
    throw Error(C3DE_E_STATE, continued.error());
  }
  nlohmann::json bodies = nlohmann::json::array();
  for (const ContinuedBody &body : *continued)
    bodies.push_back({{"name", world_.table.nameOf(body.id)},
                      {"same", body.isSame},
                      {"energy_before_J", body.energyBefore},
                      {"energy_after_J", body.energyAfter}});
  if (const c3de_status status = sdk::put(json, nlohmann::json{{"bodies", bodies}}.dump()); status < 0)
    throw Error(status, "the text was not accepted");
}

}  // namespace pointbased
