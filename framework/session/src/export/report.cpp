// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/report.h"

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "c3de/core/platform.h"

namespace c3de::session {
namespace {

using Json = nlohmann::ordered_json;

Expected<Json> parseSimulatorReport(const std::string &text) {
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object())
    return fail(ErrorCode::plugin,
                "the simulator's report is not a JSON object; it begins with: " + text.substr(0, 60));
  return json;
}

std::string hexadecimal(std::uint64_t value) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
  return text.data();
}

/// The simulator's coverage refers to the geometry it received, which is less than what was requested.
void addCoverage(const std::vector<Coverage> &coverage, Json &report) {
  for (const Coverage &one : coverage) {
    for (Json &body : report["bodies"]) {
      if (!body.is_object() || body.value("name", "") != one.body) continue;
      const double own = body.contains("represented_part") && body["represented_part"].is_number()
                             ? body["represented_part"].get<double>()
                             : 1.0;
      body["represented_part"] = own * one.part();
      body["not_represented_ml"] = 1e-3 * one.missing_mm3;
    }
    if (const std::string text = sentenceOf(one); !text.empty())
      report["events"].push_back(Json{{"time_s", 0.0}, {"kind", "not_represented"}, {"text", text}});
  }
}

/// The conserved quantities before the first step. Their drift can be interpreted only with knowledge of the loads.
Json startOf(const Json &simulator) {
  Json start = Json::array();
  for (const Json &body : simulator.value("bodies", Json::array())) {
    Json one = Json::object();
    for (const char *key : {"name", "energy_J", "momentum", "angular_momentum"})
      if (body.is_object() && body.contains(key)) one[key] = body[key];
    start.push_back(std::move(one));
  }
  return start;
}

void addSkinVolumes(const std::vector<SkinVolume> &volumes, Json &report) {
  for (std::size_t i = 0; i < volumes.size() && i < report["bodies"].size(); ++i)
    if (report["bodies"][i].is_object())
      report["bodies"][i]["skin_volume_m3"] = Json{{"reference", volumes[i].reference_m3}, {"end", volumes[i].end_m3}};
}

/// Displacement and deformation of each tissue of a body.
void addTissues(const std::vector<TissueMotion> &bodies, Json &report) {
  for (const TissueMotion &one : bodies)
    for (Json &body : report["bodies"]) {
      if (!body.is_object() || body.value("name", "") != one.places.body) continue;
      body["tissues"] = Json::array();
      for (std::size_t t = 0; t <= one.places.tissues.size(); ++t) {
        const scene::SceneTissue tissue = one.places.tissueAt(t);
        std::size_t voxels = 0;
        Json labels = Json::array();
        for (const LabelVoxels &label : one.places.labels) {
          if (label.tissue != t) continue;
          voxels += label.voxels;
          if (label.value != 0) labels.push_back(label.name);
        }
        if (voxels == 0) continue;
        const LabelMotion motion = one.ofTissue(t);
        const auto number = [&](double x) { return motion.isKnown() ? Json(x) : Json(); };
        body["tissues"].push_back(
            Json{{"name", tissue.label},
                 {"labels", std::move(labels)},
                 {"material", tissue.preset.empty() ? Json() : Json(tissue.preset)},
                 {"rigid", tissue.isRigid},
                 {"voxels", voxels},
                 {"volume_m3", {{"reference", motion.reference_m3}, {"end", number(motion.end_m3)}}},
                 {"displacement_m",
                  {{"mean", number(motion.meanDisplacement_m())}, {"max", number(motion.largestDisplacement_m)}}},
                 {"min_J", number(motion.minJ)},
                 {"followed_part", static_cast<double>(motion.followed) / static_cast<double>(motion.sample)}});
      }
    }
}

/// Landmarks, and what is measured between them, in LPS mm and degrees.
void addMeasurements(const Measurements &measurements, Json &report) {
  report["landmarks"] = Json::array();
  for (const MeasuredLandmark &one : measurements.landmarks) {
    Json json{{"name", one.landmark.name},
              {"body", one.landmark.body.empty() ? Json() : Json(one.landmark.body)},
              {"reference_mm", one.landmark.reference_mm},
              {"position_mm", one.position_mm},
              {"displacement_mm", one.position_mm - one.landmark.reference_mm}};
    if (one.landmark.target_mm) {
      json["target_mm"] = *one.landmark.target_mm;
      json["error_mm"] = Json{{"before", one.errorBefore_mm()}, {"after", one.errorAfter_mm()}};
    }
    report["landmarks"].push_back(std::move(json));
  }
  if (const auto errors = landmarkErrors(measurements)) {
    const auto jsonOf = [](const ErrorSummary &of) {
      return Json{{"mean", of.mean_mm}, {"sd", of.sd_mm ? Json(*of.sd_mm) : Json()}, {"max", of.max_mm}};
    };
    report["landmark_error_mm"] = Json{{"before", jsonOf((*errors)[0])}, {"after", jsonOf((*errors)[1])}};
  }
  report["distances"] = Json::array();
  for (const MeasuredDistance &one : measurements.distances)
    report["distances"].push_back(
        Json{{"name", one.name}, {"between", one.between}, {"reference_mm", one.reference_mm}, {"now_mm", one.now_mm}});
  report["angles"] = Json::array();
  for (const MeasuredAngle &one : measurements.angles) {
    const auto degrees = [](const std::optional<double> &angle) { return angle ? Json(*angle) : Json(); };
    report["angles"].push_back(Json{{"name", one.name},
                                    {"at", one.at},
                                    {"reference_deg", degrees(one.reference_deg)},
                                    {"now_deg", degrees(one.now_deg)}});
  }
}

/// Adds the verification to each body; time and duration are omitted.
void addVerification(const std::string &text, Json &report) {
  const Json verification = Json::parse(text, nullptr, false);
  if (!verification.is_object()) return;
  const Json bodies = verification.value("bodies", Json::array());
  for (std::size_t i = 0; i < bodies.size() && i < report["bodies"].size(); ++i) {
    if (!report["bodies"][i].is_object() || !bodies[i].is_object()) continue;
    Json one = bodies[i];
    one.erase("name");
    report["bodies"][i]["verification"] = std::move(one);
  }
}

}  // namespace

Expected<std::string> reportJson(const RunFacts &facts, const std::string &simulatorJson) {
  const auto simulator = parseSimulatorReport(simulatorJson);
  if (!simulator) return tl::unexpected(simulator.error());
  Json report;
  report["format"] = 1;
  report["scene"] = facts.scene;
  report["source"] = facts.source;
  report["version"] = C3DE_VERSION;
  report["machine"] = Json{{"cpu", cpuName()}, {"threads", facts.threads}};
  report["outcome"] = facts.outcome;
  if (!facts.failure.empty()) report["failure"] = facts.failure;
  report["steps"] = facts.steps;
  report["time_s"] = facts.time_s;
  report["wall_s"] = facts.wall_s;
  report["real_time_factor"] = facts.wall_s > 0.0 ? facts.time_s / facts.wall_s : 0.0;
  report["cpu_s"] = facts.cpu_s;
  const StepTimes::Summary stepTimes = facts.stepTimes.summary();
  report["step_ms"] = Json{{"median", stepTimes.median}, {"p99", stepTimes.p99}, {"max", stepTimes.max}};
  const Preparation &took = facts.prepared.took;
  report["preparation"] = Json{{"reading_s", took.reading_s},
                               {"masks_s", took.masks_s},
                               {"surfaces_s", took.surfaces_s},
                               {"fills_s", took.fills_s},
                               {"bodies_s", took.bodies_s},
                               {"first_step_s", facts.firstStep_s},
                               {"to_first_step_s", facts.toFirstStep_s}};
  report["dt_s"] = facts.dt_s;
  if (!facts.simulator.classId.empty())
    report["simulator"] = Json{
        {"class", facts.simulator.classId}, {"plugin", facts.simulator.plugin}, {"version", facts.simulator.version}};
  report["integrator"] =
      simulator->contains("integrator") ? simulator->at("integrator") : Json(facts.isLoadStepped ? "quasistatic" : "");
  if (facts.seed) report["seed"] = *facts.seed;
  // The simulator's entries are copied unchanged; missing ones are empty rather than absent.
  for (const char *key : {"bodies", "probes"})
    report[key] = simulator->contains(key) ? simulator->at(key) : Json::array();
  addMeasurements(facts.measurements, report);
  if (const auto start = parseSimulatorReport(facts.startReport.empty() ? "{}" : facts.startReport); start)
    report["start"] = startOf(*start);
  if (simulator->contains("accuracy")) report["accuracy"] = simulator->at("accuracy");
  if (simulator->contains("load_factor")) report["load_factor"] = simulator->at("load_factor");
  report["reactions"] = simulator->contains("reactions") ? simulator->at("reactions") : Json::array();
  report["attachments"] = simulator->contains("attachments") ? simulator->at("attachments") : Json::array();
  for (const char *key : {"contacts", "probe_tools", "grasps"})
    report[key] = simulator->contains(key) ? simulator->at(key) : Json::array();
  if (simulator->contains("conditions")) report["conditions"] = simulator->at("conditions");
  report["stages"] = simulator->contains("stages") ? simulator->at("stages") : Json::object();
  if (simulator->contains("composition")) report["composition"] = simulator->at("composition");
  report["events"] = simulator->contains("events") ? simulator->at("events") : Json::array();
  if (simulator->contains("notices")) report["notices"] = simulator->at("notices");
  for (const std::string &notice : facts.prepared.notices)
    report["events"].push_back(Json{{"time_s", 0.0}, {"kind", "input"}, {"text", notice}});
  addCoverage(facts.prepared.coverage, report);
  addSkinVolumes(facts.skinVolumes, report);
  addTissues(facts.tissues, report);
  if (!facts.verification.empty()) addVerification(facts.verification, report);
  if (!facts.match.empty()) report["match"] = Json::parse(facts.match, nullptr, false);
  if (!facts.fit.empty()) report["fit"] = Json::parse(facts.fit, nullptr, false);
  report["state_hash"] = hexadecimal(facts.stateHash);
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Expected<std::vector<std::string>> noticesOf(const std::string &simulatorJson) {
  const auto simulator = parseSimulatorReport(simulatorJson);
  if (!simulator) return tl::unexpected(simulator.error());
  std::vector<std::string> lines;
  const auto notices = simulator->find("notices");
  if (notices == simulator->end() || !notices->is_array()) return lines;
  for (const Json &notice : *notices)
    if (notice.is_string()) lines.push_back(notice.get<std::string>());
  return lines;
}

std::vector<std::string> eventsOf(const std::string &simulatorJson, const std::string &kind) {
  std::vector<std::string> texts;
  const auto simulator = parseSimulatorReport(simulatorJson);
  if (!simulator) return texts;
  for (const Json &event : simulator->value("events", Json::array()))
    if (event.is_object() && event.value("kind", "") == kind) texts.push_back(event.value("text", ""));
  return texts;
}

}  // namespace c3de::session
