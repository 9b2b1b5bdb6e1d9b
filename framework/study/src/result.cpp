// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/result.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace c3de::study {

// Found by the library by their names.
void to_json(nlohmann::json &json, const Result::Body &body) {
  json = {
      {"name", body.name},         {"spacing_m", body.spacing_m},
      {"mass_kg", body.mass_kg},   {"skin_volume_m3", {{"reference", body.skinAtStart_m3}, {"end", body.skinAtEnd_m3}}},
      {"energy_J", body.energy_J}, {"momentum", body.momentum}};
}

namespace {

using Json = nlohmann::json;

/// A number that is not finite is null in JSON.
double numberAt(const Json &json, const char *key) {
  const auto found = json.find(key);
  if (found == json.end()) return 0.0;
  return found->is_number() ? found->get<double>() : NAN;
}

Vec3 vectorAt(const Json &json, const char *key) {
  Vec3 out{};
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->size() != 3) return out;
  for (std::size_t a = 0; a < 3; ++a) out[a] = (*found)[a].is_number() ? (*found)[a].get<double>() : NAN;
  return out;
}

std::vector<Result::Body> bodiesIn(const Json &json, const char *key) {
  std::vector<Result::Body> out;
  for (const Json &from : json.value(key, Json::array())) {
    Result::Body body;
    body.name = from.value("name", "");
    body.spacing_m = numberAt(from, "spacing_m");
    body.mass_kg = numberAt(from, "mass_kg");
    body.momentum = vectorAt(from, "momentum");
    const Json skin = from.value("skin_volume_m3", Json::object()), energy = from.value("energy_J", Json::object());
    body.skinAtStart_m3 = numberAt(skin, "reference");
    body.skinAtEnd_m3 = numberAt(skin, "end");
    for (const auto &[name, value] : energy.items())
      body.energy_J[name] = value.is_number() ? value.get<double>() : NAN;
    out.push_back(std::move(body));
  }
  return out;
}

/// Reads the part that reports and texts of results have in common.
void readReport(const Json &json, Result &out) {
  out.steps = json.value("steps", std::uint64_t{0});
  out.time_s = numberAt(json, "time_s");
  out.dt_s = numberAt(json, "dt_s");
  out.integrator = json.value("integrator", "");
  out.stateHash = json.value("state_hash", "");
  out.bodies = bodiesIn(json, "bodies");
  out.start = bodiesIn(json, "start");
  for (const Json &probe : json.value("probes", Json::array()))
    out.probes_m[probe.value("name", "")] = vectorAt(probe, "position_m") - vectorAt(probe, "reference_m");
  for (const Json &reaction : json.value("reactions", Json::array()))
    out.reactions[reaction.value("fix", std::size_t{0})] = {vectorAt(reaction, "force_N"),
                                                            vectorAt(reaction, "torque_Nm")};
}

Json jsonOf(const Result::Run &run) {
  return {{"wall_s", run.wall_s},
          {"cpu_s", run.cpu_s},
          {"to_first_step_s", run.toFirstStep_s},
          {"step_ms", {{"median", run.stepMedian_ms}, {"p99", run.step99_ms}, {"max", run.stepMax_ms}}}};
}

Result::Run runIn(const Json &json) {
  const Json steps = json.value("step_ms", Json::object());
  return {numberAt(json, "wall_s"),  numberAt(json, "cpu_s"), numberAt(json, "to_first_step_s"),
          numberAt(steps, "median"), numberAt(steps, "p99"),  numberAt(steps, "max")};
}

}  // namespace

Result Result::failed(const std::string &id, const std::string &kind, const std::string &reason) {
  Result out;
  out.id = id;
  out.failure = kind;
  out.reason = reason;
  return out;
}

std::string Result::text() const {
  Json json{{"format", 1}, {"id", id}};
  if (!failure.empty()) {
    json["failure"] = {{"kind", failure}, {"reason", reason}};
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  json["steps"] = steps;
  json["time_s"] = time_s;
  json["dt_s"] = dt_s;
  json["integrator"] = integrator;
  json["state_hash"] = stateHash;
  json["bodies"] = bodies;
  json["start"] = start;
  json["probes"] = json["reactions"] = json["runs"] = Json::array();
  for (const auto &[name, u] : probes_m)
    json["probes"].push_back({{"name", name}, {"reference_m", Vec3{}}, {"position_m", u}});
  for (const auto &[fix, reaction] : reactions)
    json["reactions"].push_back({{"fix", fix}, {"force_N", reaction.force_N}, {"torque_Nm", reaction.torque_Nm}});
  for (const Run &run : runs) json["runs"].push_back(jsonOf(run));
  json["positions"] = positions_m;
  if (frequency_Hz) json["frequency_Hz"] = *frequency_Hz;
  if (peakEnergy_J) json["energy_in_play_J"] = *peakEnergy_J;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Expected<Result> Result::fromText(const std::string &text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return fail(ErrorCode::input, "a result that is no JSON");
  try {
    if (json.at("format") != 1) return fail(ErrorCode::input, "a result of another format");
    if (json.contains("failure"))
      return failed(json.at("id"), json.at("failure").at("kind"), json.at("failure").at("reason"));
    Result out;
    out.id = json.at("id");
    readReport(json, out);
    for (const Json &run : json.at("runs")) out.runs.push_back(runIn(run));
    if (out.runs.empty()) return fail(ErrorCode::input, "a result without runs");
    out.positions_m = json.at("positions").get<std::vector<Vec3>>();
    if (json.contains("energy_in_play_J")) out.peakEnergy_J = json["energy_in_play_J"].get<double>();
    if (json.contains("frequency_Hz")) out.frequency_Hz = json["frequency_Hz"].get<double>();
    return out;
  } catch (const Json::exception &error) {
    return fail(ErrorCode::input, std::string("a damaged result: ") + error.what());
  }
}

Expected<Result> Result::fromReport(const std::string &id, const std::string &report) {
  const Json json = Json::parse(report, nullptr, false);
  if (!json.is_object()) return fail(ErrorCode::input, "its report cannot be read");
  try {
    Result out;
    out.id = id;
    readReport(json, out);
    out.runs.push_back(runIn(json));
    out.runs.back().toFirstStep_s = numberAt(json.value("preparation", Json::object()), "to_first_step_s");
    // The cause of the failure, for display.
    out.reason = json.value("failure", "");
    return out;
  } catch (const Json::exception &error) {
    return fail(ErrorCode::input, std::string("its report is damaged: ") + error.what());
  }
}

}  // namespace c3de::study
