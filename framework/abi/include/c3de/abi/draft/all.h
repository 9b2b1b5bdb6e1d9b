/* SPDX-License-Identifier: Apache-2.0 */
/* Every service and interface, all of them still drafts. */
#ifndef C3DE_ABI_DRAFT_ALL_H
#define C3DE_ABI_DRAFT_ALL_H

#include "../c3de.h"
#include "collision.h"
#include "commands.h"
#include "files.h"
#include "forces.h"
#include "history.h"
#include "iface/parameter_ids.h"
#include "iface/simulator.h"
#include "imaging.h"
#include "render.h"
#include "scene.h"
#include "settings.h"
#include "simulation.h"
#include "time.h"
#include "tools.h"

#endif
