/* SPDX-License-Identifier: Apache-2.0 */
/* What is frozen: a plugin that uses nothing else goes on working with every later host of ABI 1. */
#ifndef C3DE_ABI_C3DE_H
#define C3DE_ABI_C3DE_H

#include "collision.h"
#include "commands.h"
#include "entry.h"
#include "files.h"
#include "forces.h"
#include "history.h"
#include "iface/attachment.h"
#include "iface/changes.h"
#include "iface/contact.h"
#include "iface/grasp.h"
#include "iface/parameter_ids.h"
#include "iface/simulator.h"
#include "imaging.h"
#include "jobs.h"
#include "log.h"
#include "mesh.h"
#include "object.h"
#include "panels.h"
#include "params.h"
#include "registry.h"
#include "render.h"
#include "scene.h"
#include "settings.h"
#include "simulation.h"
#include "time.h"
#include "tools.h"

#endif
