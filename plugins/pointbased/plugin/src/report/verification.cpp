// SPDX-License-Identifier: Apache-2.0
#include "report/verification.h"

#include <nlohmann/json.hpp>

namespace pointbased {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Vec3 &v) { return {v[0], v[1], v[2]}; }

Json bodyJson(const BodyVerification &body) {
  if (!body.refused.empty()) return {{"name", body.name}, {"refused", body.refused}};
  const Verification &v = body.result;
  Json out = {{"name", body.name},
              {"error_95_m", v.error95},
              {"error_max_m", v.errorMax},
              {"error_rms_m", v.errorRms},
              {"error_95_percent", v.percent(v.error95)},
              {"largest_displacement_m", v.largestDisplacement},
              {"worst_m", json(v.worst)},
              {"spacing_m", v.spacing},
              {"phyxels", v.phyxels},
              {"shadow_spacing_m", v.fineReferenceSpacing},
              {"shadow_phyxels", v.fineReferencePhyxels},
              {"elastic_energy_J", v.elasticEnergy},
              {"shadow_elastic_energy_J", v.fineReferenceElasticEnergy},
              {"reactions", Json::array()},
              {"limits", v.limits},
              {"seconds", v.seconds}};
  for (std::size_t f = 0; f < v.reactions.size() && f < v.fineReferenceReactions.size(); ++f)
    out["reactions"].push_back({{"fix", f < body.fixNumbers.size() ? body.fixNumbers[f] : f},
                                {"force_N", json(v.reactions[f].force)},
                                {"shadow_force_N", json(v.fineReferenceReactions[f].force)}});
  return out;
}

}  // namespace

std::string verificationJson(const WorldVerification &verification) {
  Json out;
  out[verification.quasiStatic ? "load_factor" : "time_s"] = verification.clock;
  out["seconds"] = verification.seconds;
  out["bodies"] = Json::array();
  for (const BodyVerification &body : verification.bodies) out["bodies"].push_back(bodyJson(body));
  return out.dump();
}

}  // namespace pointbased
