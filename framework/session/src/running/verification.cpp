// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "c3de/core/plugin_call.h"
#include "c3de/scene/text_sink.h"

namespace c3de::session {
namespace {

using Json = nlohmann::json;

struct Asked {
  const std::function<bool(double, const std::string &)> &isWanted;
  static c3de_status C3DE_CALL update(void *self, double fraction, c3de_str what) noexcept {
    const auto &asked = *static_cast<const Asked *>(self);
    return asked.isWanted(fraction, std::string(what.ptr, what.len)) ? C3DE_OK : C3DE_E_CANCELLED;
  }
};

double numberOf(const Json &body, const char *key) {
  const auto found = body.find(key);
  return found != body.end() && found->is_number() ? found->get<double>() : 0.0;
}

Json bodiesOf(const std::string &text) {
  const Json json = Json::parse(text, nullptr, false);
  return json.is_object() ? json.value("bodies", Json::array()) : Json::array();
}

/// The simulator's own accuracy statement for a body.
std::vector<std::string> statementOf(const Json &body) {
  std::vector<std::string> lines;
  if (!body.is_object()) return lines;
  const Json statement = body.value("accuracy_statement", Json::object());
  const Json reported = statement.is_object() ? statement.value("lines", Json::array()) : Json::array();
  for (const Json &line : reported)
    if (line.is_string()) lines.push_back(fmt::format("{}: {}", body.value("name", ""), line.get<std::string>()));
  return lines;
}

/// @param hasStatement  the figures have been stated already
void addVerified(const Json &body, bool hasStatement, std::vector<std::string> &lines) {
  const std::string name = body.value("name", "");
  if (body.contains("refused")) {
    lines.push_back(fmt::format("{}: not verified: {}", name, body.value("refused", "")));
    return;
  }
  const double error = numberOf(body, "error_95_m"), largest = numberOf(body, "largest_displacement_m");
  if (!hasStatement)
    lines.push_back(
        largest > 0.0
            ? fmt::format("{}: verified, error {:.3g} mm ({:.3g} % of {:.3g} mm) at 95 % of its skin, {:.3g} mm "
                          "at most",
                          name, 1e3 * error, 100.0 * error / largest, 1e3 * largest,
                          1e3 * numberOf(body, "error_max_m"))
            : fmt::format("{}: verified, nothing is deformed", name));
  if (const auto limits = body.find("limits"); limits != body.end() && limits->is_array())
    for (const Json &limit : *limits)
      if (limit.is_string()) lines.push_back("  " + limit.get<std::string>());
}

}  // namespace

bool verifiesStates(const c3de_simulator_v1 *table) {
  return C3DE_HAS(c3de_simulator_v1, table, verify) && table->verify != nullptr;
}

Expected<void> checkVerifies(const c3de_simulator_v1 *table, const SimulatorIdentity &identity) {
  if (verifiesStates(table)) return {};
  return fail(ErrorCode::plugin, fmt::format("--verify: simulator {} of {} does not verify its states",
                                             identity.classId, identity.plugin));
}

Expected<std::string> verification(Session &session, c3de_object *simulator, const c3de_simulator_v1 *table,
                                   const std::function<bool(double, const std::string &)> &isWanted) {
  Asked asked{isWanted};
  const c3de_progress progress{sizeof(c3de_progress), 0, &asked, &Asked::update};
  std::string text;
  const c3de_status code =
      callPluginFunction(session.plugins().ownerOf(simulator), "a verification", CallKind::job,
                         [&] { return table->verify(simulator, &progress, scene::sinkInto(text)); });
  if (code >= 0 && Json::parse(text, nullptr, false).is_object()) return text;
  const std::string reason = session.plugins().takeError();
  if (code == C3DE_E_CANCELLED) return fail(ErrorCode::cancelled, "the verification was cancelled");
  return fail(ErrorCode::plugin,
              code >= 0 ? "the simulator's verification is not a JSON object"
                        : "the verification failed: " + (reason.empty() ? "status " + std::to_string(code) : reason));
}

std::vector<std::string> verificationLines(const std::string &verificationJson) {
  std::vector<std::string> lines;
  for (const Json &body : bodiesOf(verificationJson))
    if (body.is_object()) addVerified(body, false, lines);
  return lines;
}

std::vector<std::string> accuracyLines(const std::string &simulatorJson, const std::string &verificationJson) {
  std::vector<std::string> lines;
  const Json bodies = bodiesOf(simulatorJson), verified = bodiesOf(verificationJson);
  for (std::size_t i = 0; i < std::max(bodies.size(), verified.size()); ++i) {
    const std::vector<std::string> statement = i < bodies.size() ? statementOf(bodies[i]) : std::vector<std::string>();
    lines.insert(lines.end(), statement.begin(), statement.end());
    if (i < verified.size() && verified[i].is_object()) addVerified(verified[i], !statement.empty(), lines);
  }
  return lines;
}

}  // namespace c3de::session
