// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <string>

#include "c3de/abi/iface/parameter_ids.h"
#include "simulator.h"

namespace mass_spring {
namespace {

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    char escaped[8];
    if (c == '"' || c == '\\')
      (out += '\\') += c;
    else if (static_cast<unsigned char>(c) < 0x20) {
      std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c));
      out += escaped;
    } else
      out += c;
  }
  return out + '"';
}

std::string json(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}
std::string json(const Vec3 &v) { return "[" + json(v[0]) + "," + json(v[1]) + "," + json(v[2]) + "]"; }

}  // namespace

c3de_status Simulator::report(c3de_sink sink) {
  const std::lock_guard lock(mutex_);
  std::string bodies, probes, reactions;
  // Of a load step that is done.
  const double part = isQuasiStatic() ? static_cast<double>(steps_) / static_cast<double>(loadSteps()) : 1.0;
  const Vec3 gravity = part * world_.vector(C3DE_PARAM_ID_GRAVITY);
  const auto separate = [](std::string &list) { list += list.empty() ? "" : ","; };
  for (const auto &[id, body] : bodies_) {
    const PointBody &p = *body.physics;
    separate(bodies);
    bodies += "{\"name\":" + quoted(body.name) + ",\"masses\":" + std::to_string(p.masses().size()) + ",\"" +
              std::string(p.elements().name) + "\":" + std::to_string(p.elements().count) +
              ",\"surface_points\":" + std::to_string(p.skin().vertices.size()) +
              ",\"spacing_m\":" + json(p.lattice().spacing()) + ",\"mass_kg\":" + json(p.mass_kg()) +
              ",\"volume_m3\":" + json(p.volume_m3()) + ",\"mesh_volume_m3\":" + json(body.meshVolume_m3) +
              ",\"stable_dt_s\":" + json(p.stableStep_s()) + ",\"energy_J\":{\"kinetic\":" + json(p.kineticEnergy_J()) +
              ",\"elastic\":" + json(p.elasticEnergy_J()) +
              ",\"gravity\":" + json(-p.mass_kg() * dot(gravity, p.centre())) + "},\"momentum\":" + json(p.momentum()) +
              ",\"angular_momentum\":" + json(p.angularMomentum()) + ",\"centre_of_mass_m\":" + json(p.centre()) + "}";
    for (const Support &support : p.supports()) {
      separate(reactions);
      const PointBody::Reaction reaction = p.reaction(support, gravity);
      reactions += "{\"body\":" + quoted(body.name) + ",\"fix\":" + std::to_string(support.number) +
                   ",\"force_N\":" + json(reaction.force_N) + ",\"torque_Nm\":" + json(reaction.torque_Nm) + "}";
    }
  }
  for (const Probe &probe : probes_) {
    separate(probes);
    probes += "{\"name\":" + quoted(probe.name) + ",\"reference_m\":" + json(probe.reference) +
              ",\"position_m\":" + json(probe.bound.of(bodies_.at(probe.body).physics->state().positions)) + "}";
  }
  return sdk::put(sink, "{\"bodies\":[" + bodies + "],\"probes\":[" + probes + "],\"reactions\":[" + reactions +
                            "],\"stages\":[],\"events\":[]}");
}

}  // namespace mass_spring
