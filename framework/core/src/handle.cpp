// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/handle.h"

namespace c3de {

const char *nameOf(HandleKind kind) {
  switch (kind) {
    case HandleKind::node: return "scene node";
    case HandleKind::mesh: return "mesh";
    case HandleKind::image: return "image";
    case HandleKind::labelMap: return "label map";
    case HandleKind::tree: return "collision tree";
    case HandleKind::proxy: return "proxy";
    case HandleKind::panel: return "panel";
    case HandleKind::tool: return "tool";
    case HandleKind::parameterSet: return "parameter set";
    case HandleKind::job: return "job";
    case HandleKind::frameCallback: return "frame callback";
    case HandleKind::edit: return "undo step";
    case HandleKind::forceField: return "force field";
    case HandleKind::simulationWatch: return "simulation watch";
    case HandleKind::meshReader: return "mesh reader";
    case HandleKind::command: return "command";
    case HandleKind::other: break;
  }
  return "";
}

}  // namespace c3de
