// SPDX-License-Identifier: Apache-2.0
#include "simulator/contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "c3de/sdk/structs.hpp"
#include "instruments/probe_tool_mesh.h"

namespace pointbased {
namespace {

using sdk::Error;

constexpr double kMaxFriction = 10.0;
// In spacings of a body: a thinner tool is in contact with only some of its points.
constexpr double kThin = 1.0;

std::string millimetres(double metres) { return shortNumber(1e3 * metres) + " mm"; }

double frictionOrThrow(double friction, const std::string &of) {
  if (friction >= 0.0 && friction <= kMaxFriction) return friction;
  throw Error(C3DE_E_ARG, of + "friction is " + shortNumber(friction) + "; accepted: a number from 0 to 10");
}

ProbeTool readTool(const c3de_sim_probe_tool &in) {
  ProbeTool tool;
  tool.name = std::string(sdk::text(in.name));
  tool.radius = in.radius_m;
  tool.length = in.length_m;
  tool.friction = frictionOrThrow(in.friction, "probe tool '" + tool.name + "': ");
  if (in.path == nullptr) throw Error(C3DE_E_ARG, "probe tool '" + tool.name + "': its path is null");
  Vec3 axis = Vec3::UnitZ();
  for (std::uint64_t k = 0; k < in.path_n; ++k) {
    const auto place = sdk::readElement(in.path, k, in.path_stride, "probe tool '" + tool.name + "': place");
    if (place.flags & C3DE_SIM_PLACE_HAS_AXIS) axis = Vec3(place.axis);
    tool.path.push_back({place.time_s, Vec3(place.at_m), axis});
  }
  return tool;
}

}  // namespace

void Contacts::setPair(const c3de_sim_contact_pair *pair) {
  const c3de_sim_contact_pair in = sdk::readStruct(pair, "pair");
  const bool hasFriction = (in.flags & C3DE_SIM_PAIR_HAS_FRICTION) != 0;
  ContactPairSettings settings;
  if (hasFriction) settings.friction = frictionOrThrow(in.friction, "");
  settings.enabled = (in.flags & C3DE_SIM_PAIR_OFF) == 0;
  settings.fits = (in.flags & C3DE_SIM_PAIR_FITS) != 0;
  const StateLock lock(world_);
  for (const c3de_handle one : {in.first, in.second})
    if (one.v != kWorldBox && !table_.has(one.v))
      throw Error(C3DE_E_STALE, "there is no such body, obstacle or probe tool in this simulation");
  if (in.first.v == in.second.v || (!table_.hasBody(in.first.v) && !table_.hasBody(in.second.v)))
    throw Error(C3DE_E_ARG, "a pair of contact has a body and another body, an obstacle, a probe tool or the walls");
  simulator_.world().setContactPair(in.first.v, in.second.v, settings);
}

void Contacts::addProbeTool(const c3de_sim_probe_tool *tool, c3de_handle *out) {
  ProbeTool read = readTool(sdk::readStruct(tool, "tool"));
  auto built = obstacleOf(read);
  if (!built) throw Error(C3DE_E_ARG, built.error());
  ObstacleRecord record{read.name, meshOf(world_.context.services, read), read.friction, 0.0, built->motion, read};
  const StateLock lock(world_);
  if (table_.hasProbeTool(read.name))
    throw Error(C3DE_E_EXISTS, "probe tool '" + read.name + "': there is one of this name already");
  const std::vector<std::string> warnings = warningsOf(read);
  world_.reset();
  const std::uint64_t id = simulator_.addObstacle(std::move(*built));
  for (const std::string &warning : warnings) simulator_.diagnostics().addWarning(id, warning);
  table_.addObstacle(id, std::move(record));
  if (out) *out = {id};
}

// What contact at points cannot resolve, and a start position inside a body.
std::vector<std::string> Contacts::warningsOf(const ProbeTool &tool) const {
  std::vector<std::string> warnings;
  const std::string which = "probe tool '" + tool.name + "' ";
  for (const auto &[id, record] : table_.bodies()) {
    const RestState &rest = simulator_.body(id)->rest();
    double spacing = rest.spacing;
    for (const double own : rest.contact.spacings) spacing = std::min(spacing, own);
    if (tool.radius < kThin * spacing)
      warnings.push_back(which + "has a radius of " + millimetres(tool.radius) + ", the points of body '" +
                         record.name + "' a spacing of " + millimetres(spacing) +
                         ": contact acts at points half a spacing apart, so the tool sinks in between them; a "
                         "smaller sampling.spacing, or sampling.refine where it touches, helps");
    // Sampled along its line at intervals of its radius.
    const ToolPose &first = tool.path.front();
    const int pieces = std::min(1000, 1 + static_cast<int>(tool.length / tool.radius));
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= (tool.length > 0.0 ? pieces : 0); ++k) {
      const double along = tool.length > 0.0 ? tool.length * (static_cast<double>(k) / pieces - 0.5) : 0.0;
      nearest = std::min(
          nearest, distanceOff(world_.context.services, *record.surface, first.at + along * first.axis.normalized()));
    }
    if (nearest < tool.radius - 0.01 * spacing)
      warnings.push_back(which + "begins " +
                         (nearest > 0.0 ? millimetres(tool.radius - nearest) + " deep in" : "with its middle inside") +
                         " body '" + record.name +
                         "', which will be pushed out; start its path outside the body to begin without force");
  }
  return warnings;
}

c3de_status Contacts::enumProbeTools(void *visitor, Each each) {
  if (!each) throw Error(C3DE_E_ARG, "each is null");
  const std::lock_guard lock(world_.mutex);
  for (const ReportedTool &tool : reported()) {
    c3de_sim_probe_tool_state state{};
    state.size = sizeof state;
    state.points = static_cast<std::uint32_t>(tool.points);
    state.name = sdk::str(tool.name);
    for (int a = 0; a < 3; ++a) {
      state.position_m[a] = tool.position[a];
      state.force_N[a] = tool.force[a];
    }
    state.depth_m = tool.depth;
    if (const c3de_status status = each(visitor, &state); status != C3DE_OK) return status;
  }
  return C3DE_OK;
}

std::vector<ReportedTool> Contacts::reported() const {
  std::vector<ReportedTool> tools;
  const std::vector<ContactSummary> contacts = simulator_.diagnostics().contacts();
  for (const auto &[id, record] : table_.obstacles()) {
    if (!record.tool) continue;
    ReportedTool tool;
    tool.name = record.name;
    const Vec3 &at = record.tool->path.front().at;
    tool.position = at + simulator_.world().obstacleMotion(id).displacementOf(at);
    for (const ContactSummary &contact : contacts) {
      if (contact.second != id) continue;
      tool.force -= contact.force;
      tool.depth = std::max(tool.depth, contact.depth);
      tool.points += contact.points;
    }
    tools.push_back(std::move(tool));
  }
  return tools;
}

}  // namespace pointbased
