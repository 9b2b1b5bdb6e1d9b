// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/accuracy_target.h"
#include "base/services.h"
#include "simulator/material_laws.h"

namespace pointbased {

class WorldSimulator;

/// Notified when simulators are attached to and detached from a scene node: implemented for the controller and the
/// views.
class SimulatorListener {
 public:
  virtual ~SimulatorListener() = default;
  virtual void attached(WorldSimulator &simulator, c3de_handle node) = 0;  // [main]
  virtual void detached(WorldSimulator &simulator) = 0;                    // [main]
};

/// Shared by the objects of the plugin.
struct PluginContext {
  explicit PluginContext(sdk::Host host, SimulatorListener *l)
      : services(host), listener(l), laws(services), speed(host, services) {}

  Services services;
  SimulatorListener *listener = nullptr;
  bool hasWindow = false;  // a user waits for steps
  MaterialLaws laws;
  MachineSpeedCache speed;
};

}  // namespace pointbased
