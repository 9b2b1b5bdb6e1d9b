// SPDX-License-Identifier: Apache-2.0
#include "report.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace pointbased {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Vec3 &v) { return {v[0], v[1], v[2]}; }

Json bodyJson(const Simulator &simulator, const ReportedBody &reported) {
  const Body &body = *simulator.body(reported.id);
  const RestState &rest = body.rest();
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero(), centre = Vec3::Zero();
  double mass = 0.0, volume = 0.0;
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    const double m = body.masses()[i];
    const Vec3 x = rest.origin + rest.positions[i] + body.state().displacements[i];
    const Vec3 &v = body.state().velocities[i];
    momentum += m * v;
    angular += m * x.cross(v);
    centre += m * x;
    mass += m;
    volume += rest.volumes[i];
  }
  if (mass > 0.0) centre /= mass;

  double minJ = 1.0, maxStretch = 1.0;
  std::size_t inverted = 0;
  for (const Mat3 &F : body.gradients()) {
    const double J = F.determinant();
    minJ = std::min(minJ, J);
    if (J <= 0.0) ++inverted;
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(F.transpose() * F, Eigen::EigenvaluesOnly);
    maxStretch = std::max(maxStretch, std::sqrt(std::max(0.0, eigen.eigenvalues()[2])));
  }

  const Neighbours neighbours = countNeighbours(rest);
  const Simulator::Energy energy = simulator.energy(reported.id);
  return {{"name", body.name()},
          {"phyxels", rest.phyxelCount()},
          {"surfels", rest.surfels.count()},
          {"spacing_m", rest.spacing},
          {"mass_kg", mass},
          {"volume_m3", volume},
          {"mesh_volume_m3", reported.meshVolume},
          {"neighbours", {{"min", neighbours.min}, {"mean", neighbours.mean}, {"max", neighbours.max}}},
          {"stable_dt_s", body.stableStepAtRest()},
          {"energy_J",
           {{"kinetic", energy.kinetic},
            {"elastic", energy.elastic},
            {"stabilisation", energy.stabilisation},
            {"gravity", energy.gravity},
            {"plastic", 0.0}}},
          {"momentum", json(momentum)},
          {"angular_momentum", json(angular)},
          {"centre_of_mass_m", json(centre)},
          {"min_J", minJ},
          {"max_stretch", maxStretch},
          {"inverted_phyxels", inverted},
          {"deepest_penetration_m", body.contact.deepestEver}};
}

}  // namespace

std::string reportJson(const Simulator &simulator, const std::vector<ReportedBody> &bodies) {
  Json out = {{"bodies", Json::array()}, {"probes", Json::array()}, {"stages", Json::object()}, {"events", Json::array()}};
  for (const ReportedBody &body : bodies) out["bodies"].push_back(bodyJson(simulator, body));
  for (const Probe &probe : simulator.probes()) {
    const Simulator::ProbeState state = simulator.probeState(probe);
    out["probes"].push_back({{"name", probe.name},
                             {"reference_m", json(probe.reference)},
                             {"position_m", json(state.position)},
                             {"velocity_m_s", json(state.velocity)}});
  }
  for (const StageClock::Summary &stage : simulator.stageTimes())
    out["stages"][stage.name] = {{"median_ms", stage.median_ms}, {"p99_ms", stage.p99_ms}, {"calls", stage.calls}};
  for (const SimulationEvent &event : simulator.events())
    out["events"].push_back({{"time_s", event.time}, {"kind", event.kind}, {"text", event.text}});
  return out.dump();
}

}  // namespace pointbased
