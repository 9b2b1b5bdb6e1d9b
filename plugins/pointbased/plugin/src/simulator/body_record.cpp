// SPDX-License-Identifier: Apache-2.0
#include "simulator/body_record.h"

namespace pointbased {
namespace {

using sdk::Error;

std::string millimetres(double metres) { return shortNumber(1e3 * metres) + " mm"; }

std::string metres(const Vec3 &at) {
  return "(" + shortNumber(at[0]) + ", " + shortNumber(at[1]) + ", " + shortNumber(at[2]) + ")";
}

}  // namespace

c3de_sim_body_info BodyRecord::info(const Body &body) const {
  c3de_sim_body_info info{};
  info.name = sdk::str(name);
  info.points = body.rest().phyxelCount();
  info.surface_points = body.rest().surfels.count();
  info.mass_kg = body.totalMass();
  for (const double v : body.rest().volumes) info.volume_m3 += v;
  info.mesh_volume_m3 = surface->volume;
  info.spacing_m = body.rest().spacing;
  info.stable_dt_s = body.stableStepAtRest();
  return info;
}

void BodyRecord::assignBuilt(BuiltBody &built) {
  surface = std::move(built.surface);
  promise = built.promise ? std::make_shared<const AccuracyPrediction>(std::move(*built.promise)) : nullptr;
  trials = promise
               ? std::make_shared<const DisplacementTrials>(DisplacementTrials{promise->survey, promise->unpredicted})
               : nullptr;
  adaptive = built.adaptive ? std::make_shared<const AdaptiveSampling>(std::move(*built.adaptive)) : nullptr;
}

void BodyRecord::checkRigid() const {
  if (!isRigid(*values) || isFree(*values)) return;
  const std::string text = "the body is rigid and fixed; accepted: rigid = false, or no fix, no load and no velocity";
  if (!source.fixes.empty()) throw Error(C3DE_E_ARG, text, {"fix", source.fixNumbers.front(), {}});
  if (!source.loads.empty()) throw Error(C3DE_E_ARG, text, {"load", source.loadNumbers.front(), {}});
  if (!source.velocity.isZero(0.0) || !source.angularVelocity.isZero(0.0)) throw Error(C3DE_E_ARG, name + ": " + text);
}

// A static solution has no motion, and a fix on any part of a rigid body fixes all of it.
void BodyRecord::checkFree(const ParameterValues &with, bool quasiStatic) const {
  if (!isFree(with)) return;
  if (!source.fixes.empty())
    throw Error(C3DE_E_ARG,
                "body '" + name +
                    "' is rigid and free, so nothing of it is fixed; accepted: free = false "
                    "and no fix, which holds it wholly, or rigid = false",
                {"fix", source.fixNumbers.empty() ? 0 : source.fixNumbers.front(), {}});
  if (quasiStatic)
    throw Error(C3DE_E_UNSUPPORTED,
                "body '" + name +
                    "' is rigid and free, and a quasi-static solution moves no rigid body; accepted: "
                    "free = false, or solver.integrator = \"auto\", \"explicit\" or \"implicit\"");
}

// A body may initially be slightly inside a wall or an obstacle: contact pushes it out. A body outside the walls is an
// error.
void BodyRecord::checkInsideWalls(const WorldBox &box, double spacing) const {
  if (!box.enabled) return;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) {
      const double beyond = upper ? surface->max[axis] - box.max[axis] : box.min[axis] - surface->min[axis];
      if (beyond <= 0.5 * spacing) continue;
      throw Error(C3DE_E_ARG, "body '" + name + "' reaches " + millimetres(beyond) + " beyond world.box." +
                                  (upper ? "max" : "min") + " on the " + "xyz"[axis] + " axis (" +
                                  shortNumber(upper ? surface->max[axis] : surface->min[axis]) + " m against " +
                                  shortNumber(upper ? box.max[axis] : box.min[axis]) +
                                  " m); accepted: inside, or up to half a spacing (" + millimetres(0.5 * spacing) +
                                  ") beyond");
    }
}

void BodyRecord::checkNearBody(const Services &services, const Vec3 &at, double spacing,
                               const std::string &which) const {
  const double tolerance = 0.5 * spacing;
  const double off = distanceOff(services, *surface, at);
  if (off <= tolerance) return;
  throw Error(C3DE_E_ARG, which + metres(at) + " m lies " + millimetres(off) + " off body '" + name +
                              "', which spans " + metres(surface->min) + " … " + metres(surface->max) +
                              " m; accepted: inside, or up to half a spacing (" + millimetres(tolerance) +
                              ") off its surface");
}

}  // namespace pointbased
