// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/errors.h"

#include <algorithm>
#include <cmath>

#include "c3de/core/text.h"
#include "c3de/study/richardson.h"

namespace c3de::study {
namespace {

constexpr double kMillimetres = 1e3;

using Bodies = std::vector<Result::Body>;

double componentOf(const Vec3 &v, std::size_t component) { return component < 3 ? v[component] : norm(v); }

/// One kind of energy, or all of them.
double energyOf(const Bodies &bodies, const std::string &kind) {
  double sum = 0.0;
  for (const Result::Body &body : bodies)
    for (const auto &[name, value] : body.energy_J)
      if (kind.empty() || name == kind) sum += value;
  return sum;
}

Vec3 momentumOf(const Bodies &bodies) {
  Vec3 sum{};
  for (const Result::Body &body : bodies) sum = sum + body.momentum;
  return sum;
}

std::size_t fixOf(const Quantity &quantity) {
  return quantity.kind == Quantity::Kind::reaction || quantity.kind == Quantity::Kind::torque ? quantity.fix : 0;
}

std::optional<Vec3> reactionOf(const Quantity &quantity, const Result &result) {
  const auto reaction = result.reactions.find(fixOf(quantity));
  if (reaction == result.reactions.end()) return std::nullopt;
  return reaction->second.force_N;
}

std::vector<double> flat(const std::vector<Vec3> &vectors, std::size_t begin, std::size_t end) {
  std::vector<double> out;
  for (std::size_t i = begin; i < end; ++i) out.insert(out.end(), vectors[i].begin(), vectors[i].end());
  return out;
}

double relativeL2(const std::vector<Vec3> &u, const std::vector<Vec3> &truth, const Samples &samples) {
  double difference = 0.0, whole = 0.0;
  for (std::size_t i = 0; i < samples.inside; ++i) {
    difference += samples.weights[i] * dot(u[i] - truth[i], u[i] - truth[i]);
    whole += samples.weights[i] * dot(truth[i], truth[i]);
  }
  return std::sqrt(difference / whole);
}

double finiteOrNothing(double value, std::optional<double> &out) {
  if (std::isfinite(value)) out = value;
  return value;
}

/// The limit of one number in three runs, if it converges.
std::optional<double> extrapolated(const std::array<double, 3> &h, const std::array<double, 3> &f) {
  const auto found = extrapolate(h, {std::vector{f[0]}, std::vector{f[1]}, std::vector{f[2]}}, {});
  if (!found) return std::nullopt;
  return found->value.front();
}

/// The limit of a part of the samples of three runs, which is written to `out`.
Expected<Extrapolation> extrapolatedField(const std::array<double, 3> &h, const std::array<std::vector<Vec3>, 3> &u,
                                          std::size_t begin, std::size_t end, const std::vector<double> &weights,
                                          std::vector<Vec3> &out) {
  std::vector<double> each;
  if (!weights.empty())
    for (std::size_t i = begin; i < end; ++i) each.insert(each.end(), 3, weights[i]);
  auto found = extrapolate(h, {flat(u[0], begin, end), flat(u[1], begin, end), flat(u[2], begin, end)}, each);
  if (found)
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t a = 0; a < 3; ++a) out[i][a] = found->value[3 * (i - begin) + a];
  return found;
}

void addFieldErrors(const ReferenceSolution &truth, const Samples &samples, const Result &result, Errors &errors) {
  const std::vector<Vec3> u = displacementsOf(samples, result);
  if (u.empty() || u.size() != truth.displacements_m.size()) return;
  if (samples.inside > 0) finiteOrNothing(relativeL2(u, truth.displacements_m, samples), errors.fieldL2);
  std::vector<double> off;
  for (std::size_t i = samples.skinBegin; i < u.size(); ++i)
    off.push_back(kMillimetres * norm(u[i] - truth.displacements_m[i]));
  std::sort(off.begin(), off.end());
  if (off.empty() || !std::isfinite(off.back())) return;
  errors.surfaceMax_mm = off.back();
  errors.surface95_mm = off[static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(off.size()))) - 1];
}

void addConserved(const Point &point, const Result &result, Errors &errors) {
  const Bodies &bodies = result.bodies, &start = result.start;
  if (start.empty() || !(result.time_s > 0.0)) return;
  const double kinetic = std::max(energyOf(bodies, "kinetic"), energyOf(start, "kinetic"));
  if (point.conservesEnergy && result.peakEnergy_J)
    finiteOrNothing((energyOf(bodies, "") - energyOf(start, "")) / *result.peakEnergy_J / result.time_s,
                    errors.energyDrift_1_s);
  if (point.conservesMomentum) {
    double mass = 0.0;
    for (const Result::Body &body : bodies) mass += body.mass_kg;
    finiteOrNothing(norm(momentumOf(bodies) - momentumOf(start)) / std::sqrt(2.0 * mass * kinetic),
                    errors.momentumRoundOff);
  }
}

}  // namespace

Expected<double> valueOf(const Quantity &quantity, const Result &result) {
  const auto finite = [&](double value) -> Expected<double> {
    if (std::isfinite(value)) return value;
    return fail(ErrorCode::state, quantity.shown() + " is not finite");
  };
  switch (quantity.kind) {
    case Quantity::Kind::probe: {
      const auto probe = result.probes_m.find(quantity.name);
      if (probe == result.probes_m.end())
        return fail(ErrorCode::state, "the report has no probe '" + quantity.name + "'");
      return finite(componentOf(probe->second, quantity.component));
    }
    case Quantity::Kind::reaction:
    case Quantity::Kind::torque: {
      const auto reaction = result.reactions.find(quantity.fix);
      if (reaction == result.reactions.end())
        return fail(ErrorCode::state, "the report has no reaction of support " + std::to_string(quantity.fix));
      const Result::Reaction &is = reaction->second;
      return finite(
          componentOf(quantity.kind == Quantity::Kind::reaction ? is.force_N : is.torque_Nm, quantity.component));
    }
    case Quantity::Kind::frequency:
      if (!result.frequency_Hz) return fail(ErrorCode::state, "the run has no frequency");
      return finite(*result.frequency_Hz);
    case Quantity::Kind::energy: return finite(energyOf(result.bodies, quantity.name));
    case Quantity::Kind::field:
    case Quantity::Kind::surface: break;
  }
  return fail(ErrorCode::state, "a field has no single value");
}

std::vector<Vec3> displacementsOf(const Samples &samples, const Result &result) {
  std::vector<Vec3> out;
  if (result.positions_m.size() != samples.points.size()) return out;
  for (std::size_t i = 0; i < samples.points.size(); ++i) out.push_back(result.positions_m[i] - samples.points[i].at_m);
  return out;
}

Expected<ReferenceSolution> statedReference(const Study &study, const Case &one, Samples &samples) {
  const Reference &reference = one.reference;
  ReferenceSolution truth;
  truth.kind = reference.kind;
  truth.from = reference.from;
  truth.uncertainty = reference.uncertainty;
  if (reference.source == Reference::Source::value) {
    truth.value = reference.value;
    truth.bar = std::abs(reference.uncertainty / reference.value);
    return truth;
  }
  auto points = session::readSamplePoints(reference.file);
  auto displacements = session::readSamplePoints(reference.file, {"ux [m]", "uy [m]", "uz [m]"});
  for (const auto *read : {&points, &displacements})
    if (!*read) return fail(ErrorCode::input, study.where(reference.line) + ": " + read->error().message);
  samples = {std::move(*points), 0, 0, {}};
  samples.inside = samples.points.size();
  samples.weights.assign(samples.inside, 1.0);
  double squares = 0.0;
  for (const session::SamplePoint &u : *displacements) {
    truth.displacements_m.push_back(u.at_m);
    squares += dot(u.at_m, u.at_m);
  }
  truth.bar = one.quantity.kind == Quantity::Kind::surface
                  ? kMillimetres * reference.uncertainty
                  : reference.uncertainty / std::sqrt(squares / static_cast<double>(samples.inside));
  if (!std::isfinite(truth.bar))
    return fail(ErrorCode::input, study.where(reference.line) + ": nothing is displaced in " + reference.file.string());
  return truth;
}

Expected<ReferenceSolution> extrapolatedReference(const Case &one, const Samples &samples,
                                                  const std::array<double, 3> &spacings,
                                                  const std::array<Result, 3> &runs) {
  ReferenceSolution truth;
  truth.kind = one.reference.kind;
  truth.from = one.reference.parameter.name + " " + one.reference.parameter.values[0] + ", " +
               one.reference.parameter.values[1] + ", " + one.reference.parameter.values[2];
  const auto notConverging = [&](const Error &error) {
    return fail(ErrorCode::state, "the reference does not converge: " + error.message);
  };
  std::array<std::vector<Vec3>, 3> u;
  for (std::size_t i = 0; i < 3; ++i) u[i] = displacementsOf(samples, runs[i]);
  if (!u[0].empty() && u[1].size() == u[0].size() && u[2].size() == u[0].size()) {
    truth.displacements_m.resize(u[0].size());
    const auto inside = extrapolatedField(spacings, u, 0, samples.inside, samples.weights, truth.displacements_m);
    std::vector<Vec3> skin = truth.displacements_m;
    const auto onSkin = extrapolatedField(spacings, u, samples.skinBegin, u[0].size(), {}, skin);
    for (std::size_t i = samples.skinBegin; i < skin.size(); ++i) truth.displacements_m[i] = skin[i];
    const bool isField = one.quantity.kind == Quantity::Kind::field;
    if (one.quantity.isField()) {
      const auto &asked = isField ? inside : onSkin;
      if (!asked) return notConverging(asked.error());
      truth.order = asked->order;
      double squares = 0.0;
      for (std::size_t i = 0; i < samples.inside; ++i)
        squares += samples.weights[i] * dot(truth.displacements_m[i], truth.displacements_m[i]);
      truth.bar = isField ? asked->uncertainty / std::sqrt(squares) : kMillimetres * asked->uncertainty;
      truth.uncertainty = truth.bar;
    }
    if (!inside || !onSkin) truth.displacements_m.clear();
  } else if (one.quantity.isField()) {
    return fail(ErrorCode::state, "the runs of the reference have no displacements");
  }
  if (!one.quantity.isField()) {
    std::array<std::vector<double>, 3> values;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto value = valueOf(one.quantity, runs[i]);
      if (!value) return fail(ErrorCode::state, "the reference: " + value.error().message);
      values[i] = {*value};
    }
    const auto found = extrapolate(spacings, values, {});
    if (!found) return notConverging(found.error());
    truth.value = found->value.front();
    truth.order = found->order;
    truth.uncertainty = found->uncertainty;
    truth.bar = std::abs(found->uncertainty / *truth.value);
    if (!std::isfinite(truth.bar)) return fail(ErrorCode::state, "the reference is 0; errors are shares of it");
  }
  std::array<double, 3> elastic{};
  for (std::size_t i = 0; i < 3; ++i) elastic[i] = energyOf(runs[i].bodies, "elastic");
  truth.elastic_J = extrapolated(spacings, elastic);
  std::array<std::optional<Vec3>, 3> forces;
  for (std::size_t i = 0; i < 3; ++i) forces[i] = reactionOf(one.quantity, runs[i]);
  if (forces[0] && forces[1] && forces[2]) {
    const auto found = extrapolate(
        spacings, {flat({*forces[0]}, 0, 1), flat({*forces[1]}, 0, 1), flat({*forces[2]}, 0, 1)}, {1.0, 1.0, 1.0});
    if (found) truth.reaction_N = Vec3{found->value[0], found->value[1], found->value[2]};
  }
  return truth;
}

Errors errorsOf(const Case &one, const Point &point, const ReferenceSolution &truth, const Samples &samples,
                const Result &result) {
  Errors errors;
  if (const auto value = valueOf(one.quantity, result)) {
    errors.value = *value;
    if (truth.value) finiteOrNothing(std::abs(*value / *truth.value - 1.0), errors.quantity);
  }
  addFieldErrors(truth, samples, result, errors);
  if (one.quantity.kind == Quantity::Kind::field) errors.value = errors.quantity = errors.fieldL2;
  if (one.quantity.kind == Quantity::Kind::surface) errors.value = errors.quantity = errors.surfaceMax_mm;
  const bool isElastic = one.quantity.kind == Quantity::Kind::energy && one.quantity.name == "elastic";
  if (const auto truthful = isElastic ? truth.value : truth.elastic_J; truthful && *truthful > 0.0)
    finiteOrNothing(std::sqrt(std::abs(energyOf(result.bodies, "elastic") - *truthful) / *truthful), errors.energyNorm);
  if (one.quantity.kind == Quantity::Kind::reaction) {
    errors.reaction = errors.quantity;
  } else if (const auto force = reactionOf(one.quantity, result); force && truth.reaction_N) {
    finiteOrNothing(norm(*force - *truth.reaction_N) / norm(*truth.reaction_N), errors.reaction);
  }
  if (one.quantity.kind == Quantity::Kind::frequency) errors.frequency = errors.quantity;
  double reference = 0.0, end = 0.0;
  for (const Result::Body &body : result.bodies) {
    reference += body.skinAtStart_m3;
    end += body.skinAtEnd_m3;
  }
  if (reference > 0.0) finiteOrNothing(end / reference - 1.0, errors.volumeChange);
  addConserved(point, result, errors);
  return errors;
}

}  // namespace c3de::study
