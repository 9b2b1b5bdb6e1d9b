// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <thread>

#include "c3de/plugin_host/plugin_host.h"
#include "class_registry.h"
#include "collision_trees.h"
#include "long_calls.h"
#include "scene_proxies.h"

namespace c3de::plugin_host {

/// State shared by the plugins of one host.
struct HostState {
  explicit HostState(const Services &s)
      : services(s), mainThread(std::this_thread::get_id()), proxies(s.renderer, s.sceneGraph),
        watchdog(s.callLimits, [this](const LongCall &call) { reportLongCall(services, call); }) {}

  Services services;
  std::thread::id mainThread;
  ClassRegistry classes;
  CollisionTrees trees;
  SceneProxies proxies;
  CallWatchdog watchdog;
};

}  // namespace c3de::plugin_host
