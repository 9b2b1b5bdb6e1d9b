// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "c3de/core/plugin_table.h"
#include "c3de/core/text.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/simulator_access.h"
#include "loading/part_progress.h"

namespace c3de {

template <>
struct TableSlots<c3de_identification_v0> {
  using Table = c3de_identification_v0;
  static constexpr const char *name = C3DE_IFACE_IDENTIFICATION_ID;
  static constexpr std::array slots = {TableSlot{"fit", offsetof(Table, fit), 1},
                                       TableSlot{"sensitivity", offsetof(Table, sensitivity), 1}};
};

}  // namespace c3de

namespace c3de::session {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char *kNotClinical = "not for clinical use";

/// A body of the simulator with the size that it has at rest.
struct NamedBody {
  c3de_handle handle{};
  double extent_m = 0.0;
};

Expected<NamedBody> bodyNamed(c3de_object *simulator, const std::string &name) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  NamedBody out;
  c3de_sim_body_info info{};
  info.size = sizeof info;
  for (std::uint64_t i = 0; (*table)->body_at(simulator, i, &out.handle) >= 0; ++i) {
    if ((*table)->body_info(simulator, out.handle, &info) < 0 || fromAbi(info.name) != name) continue;
    const std::vector<Vec3> skin = surfacePositions(simulator, out.handle);
    if (skin.empty()) return out;
    Vec3 low = skin.front(), high = low;
    for (const Vec3 &x : skin)
      for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], x[a]), high[a] = std::max(high[a], x[a]);
    out.extent_m = norm(high - low);
    return out;
  }
  return fail(ErrorCode::plugin, "the simulator has no body '" + name + "'");
}

std::optional<double> numberAt(const Json &object, const char *key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

std::string textAt(const Json &object, const char *key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

Json listAt(const Json &object, const char *key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_array() ? *found : Json::array();
}

Expected<BodyFit> fitOf(const c3de_fit_result &result, const std::string &text, std::size_t points) {
  const Json details = Json::parse(text, nullptr, false);
  const auto unreadable = [] {
    return fail(ErrorCode::plugin, "the details of the fit do not have the form of the interface");
  };
  if (!details.is_object() || result.verdict > C3DE_FIT_UNDETERMINED) return unreadable();
  BodyFit out;
  out.verdict = static_cast<FitVerdict>(result.verdict);
  out.reason = textAt(details, "reason");
  out.hasConverged = (result.flags & C3DE_FIT_CONVERGED) != 0;
  out.isLoaded = (result.flags & C3DE_FIT_LOADED) != 0;
  out.iterations = result.iterations;
  out.solutions = result.solutions;
  out.residual = result.residual;
  out.measured = result.measured;
  for (const Json &one : listAt(details, "moduli")) {
    if (!one.is_object()) return unreadable();
    const auto value = numberAt(one, "value_Pa");
    if (!value) return unreadable();
    const auto own = one.find("own");
    out.moduli.push_back({textAt(one, "material"), *value, numberAt(one, "low_Pa").value_or(0.0),
                          numberAt(one, "high_Pa"), own != one.end() && *own == true});
  }
  for (const Json &one : listAt(details, "predicted"))
    out.predicted.push_back(one.is_number() ? one.get<double>() : 0.0);
  if (out.moduli.empty() || out.predicted.size() != points) return unreadable();
  return out;
}

/// N, or mm where a force is prescribed.
double shownScale(const BodyFit &fit) { return fit.isLoaded ? 1e3 : 1.0; }
const char *shownUnit(const BodyFit &fit) { return fit.isLoaded ? "mm" : "N"; }

/// Why the fit should not be trusted. A curve that does not begin at the value of the model has an offset (a weight, a
/// preload), which no modulus explains.
std::vector<std::string> warningsOf(const BodyFit &fit, const ForceCurve &curve) {
  constexpr double kLargeOffset = 0.02;  // of the largest measured value
  std::vector<std::string> out;
  if (!fit.reason.empty()) out.push_back(fit.reason);
  const std::vector<double> &prescribed = fit.isLoaded ? curve.force_N : curve.displacement_m;
  const std::vector<double> &measured = fit.isLoaded ? curve.displacement_m : curve.force_N;
  if (prescribed.empty() || prescribed.front() != 0.0) return out;
  double largest = 0.0;
  for (const double value : measured) largest = std::max(largest, std::abs(value));
  const double offset = measured.front() - fit.predicted.front();
  if (std::abs(offset) > kLargeOffset * largest)
    out.push_back(
        fmt::format("the curve begins with {0:.3g} {1}, the model with {2:.3g} {1}: an offset of {3:.2g} % of "
                    "the largest value; subtract it if it is a weight or a preload",
                    shownScale(fit) * measured.front(), shownUnit(fit), shownScale(fit) * fit.predicted.front(),
                    100.0 * std::abs(offset) / largest));
  return out;
}

}  // namespace

const char *nameOf(FitVerdict verdict) {
  switch (verdict) {
    case FitVerdict::found: return "found";
    case FitVerdict::unexplained: return "unexplained";
    case FitVerdict::undetermined: return "undetermined";
  }
  return "";
}

Expected<const c3de_identification_v0 *> identificationTable(c3de_object *simulator) {
  const auto found = queryObject(simulator, C3DE_IFACE_IDENTIFICATION_ID, 1);
  if (!found) return nullptr;
  const auto *table = static_cast<const c3de_identification_v0 *>(*found);
  if (std::string problem = tableProblem(table); !problem.empty())
    return fail(ErrorCode::plugin, "the simulator's table of " + std::move(problem));
  return table;
}

Expected<BodyFit> fitBody(c3de_object *simulator, const std::string &body, const ForceCurve &curve,
                          const BodyFitOptions &options, const char *owner,
                          const std::function<std::string()> &takeError, const ProgressFn &progress) {
  const auto table = identificationTable(simulator);
  if (!table) return tl::unexpected(table.error());
  if (*table == nullptr) return fail(ErrorCode::plugin, "the simulator does not fit the stiffness of bodies");
  const auto found = bodyNamed(simulator, body);
  if (!found) return tl::unexpected(found.error());
  if (auto good = checkForceCurve(curve, options.watched_m.has_value(), found->extent_m); !good)
    return tl::unexpected(good.error());
  c3de_fit_request request{};
  request.size = sizeof request;
  request.body = found->handle;
  request.displacements_m = curve.displacement_m.data();
  request.forces_N = curve.force_N.data();
  request.points_n = curve.force_N.size();
  request.noise = options.noise;
  if (options.watched_m) {
    request.flags = C3DE_FIT_WATCHED;
    std::copy_n(options.watched_m->data(), 3, request.watched_m);
  }
  c3de_fit_result result{};
  result.size = sizeof result;
  PartProgress part(progress, "fit", 0, 1);
  std::string text;
  const c3de_status code = part.call(
      owner, "a fit", [&] { return (*table)->fit(simulator, &request, part.abi(), &result, scene::sinkInto(text)); });
  if (code < 0) {
    const std::string reason = takeError ? takeError() : std::string();
    if (code == C3DE_E_CANCELLED) return fail(ErrorCode::cancelled, "the fit was cancelled");
    return fail(code == C3DE_E_ARG || code == C3DE_E_STATE ? ErrorCode::input : ErrorCode::plugin,
                reason.empty() ? "status " + std::to_string(code) : reason);
  }
  return fitOf(result, text, curve.force_N.size());
}

std::string fitJson(const BodyFit &fit, const ForceCurve &curve, const FitFacts &facts) {
  const double scale = shownScale(fit);
  Json json{{"notice", kNotClinical},
            {"body", facts.body},
            {"curve", facts.curve},
            {"points", curve.force_N.size()},
            {"prescribed", fit.isLoaded ? "force" : "displacement"},
            {"verdict", nameOf(fit.verdict)},
            {"converged", fit.hasConverged},
            {"iterations", fit.iterations},
            {"solutions", fit.solutions},
            {"wall_s", facts.wall_s},
            {"unit", shownUnit(fit)},
            {"noise", facts.noise > 0.0 ? Json(scale * facts.noise) : Json()},
            {"residual", scale * fit.residual},
            {"measured", scale * fit.measured}};
  json["moduli"] = Json::array();
  for (const FittedMaterial &one : fit.moduli)
    json["moduli"].push_back(Json{{"material", one.material},
                                  {"youngs_modulus_Pa", one.value_Pa},
                                  {"low_Pa", one.low_Pa},
                                  {"high_Pa", one.high_Pa ? Json(*one.high_Pa) : Json()},
                                  {"own", one.isOwn}});
  json["curve_points"] = Json::array();
  for (std::size_t i = 0; i < curve.force_N.size(); ++i)
    json["curve_points"].push_back(Json{{"displacement_mm", 1e3 * curve.displacement_m[i]},
                                        {"force_N", curve.force_N[i]},
                                        {"predicted", scale * fit.predicted[i]}});
  json["warnings"] = warningsOf(fit, curve);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::vector<std::string> fitLines(const BodyFit &fit, const ForceCurve &curve, const FitFacts &facts) {
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{}: stiffness {}, {} points, {} static solutions in {:.3g} s; {}", facts.body,
                              nameOf(fit.verdict), curve.force_N.size(), fit.solutions, facts.wall_s, kNotClinical));
  const bool isCommon = fit.moduli.size() > 1 && !fit.moduli.front().isOwn;
  for (const FittedMaterial &one : fit.moduli)
    lines.push_back(fmt::format(
        "{}: Young's modulus {:.5g} Pa, 95 % confidence interval {:.5g} … {} Pa{}", one.material, one.value_Pa,
        one.low_Pa, one.high_Pa ? fmt::format("{:.5g}", *one.high_Pa) : "∞", one.isOwn ? "" : ", by a common factor"));
  if (isCommon)
    lines.emplace_back("the curve does not determine the moduli individually: their ratios are those of the scene");
  lines.push_back(fmt::format("residual {:.3g} {}, {:.2g} % of the measured values", shownScale(fit) * fit.residual,
                              shownUnit(fit), 100.0 * fit.residual / fit.measured));
  for (const std::string &warning : warningsOf(fit, curve)) lines.push_back("  warning: " + warning);
  return lines;
}

std::string fitTable(const BodyFit &fit, const ForceCurve &curve) {
  std::string text = fit.isLoaded ? "displacement_mm,force_N,predicted_mm\n" : "displacement_mm,force_N,predicted_N\n";
  for (std::size_t i = 0; i < curve.force_N.size(); ++i)
    text += fmt::format("{:.6g},{:.6g},{:.6g}\n", 1e3 * curve.displacement_m[i], curve.force_N[i],
                        shownScale(fit) * fit.predicted[i]);
  return text;
}

}  // namespace c3de::session
