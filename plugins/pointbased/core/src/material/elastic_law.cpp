// SPDX-License-Identifier: Apache-2.0
#include "pointbased/elastic_law.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <limits>

#include "base/number_text.h"
#include "base/symmetric_eigen.h"

namespace pointbased {

using detail::number;

namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string shown(const Mat3 &F) {
  std::string text = "[";
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) text += (c > 0 ? " " : r > 0 ? "; " : "") + number(F(r, c));
  return text + "]";
}

// dP/dF; column c is the response to the unit matrix with a one at component c (column-major).
Result<void> tangentAt(const ElasticLaw &law, const Mat3 &F, Matrix9 &C) {
  std::array<Mat3, 9> at, units, answers;
  at.fill(F);
  for (int c = 0; c < 9; ++c) {
    units[static_cast<std::size_t>(c)].setZero();
    units[static_cast<std::size_t>(c)](c % 3, c / 3) = 1.0;
  }
  if (auto done = law.differentials(at, units, answers); !done) return done;
  for (int c = 0; c < 9; ++c)
    C.col(c) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(answers[static_cast<std::size_t>(c)].data());
  return {};
}

// Largest a⊗n : C : a⊗n by one iteration in a and one in n, started from the principal directions of F, along which the
// fastest waves of an isotropic law propagate. A lower bound that is almost always exact.
double waveModulus(const Matrix9 &C, const Mat3 &F) {
  double largest = -std::numeric_limits<double>::infinity();
  const Mat3 directions = detail::symmetricEigen(F.transpose() * F).vectors;
  for (int start = 0; start < 3; ++start) {
    const Vec3 n = directions.col(start);
    Mat3 ofA = Mat3::Zero(), ofN = Mat3::Zero();
    for (int J = 0; J < 3; ++J)
      for (int L = 0; L < 3; ++L) ofA += n[J] * n[L] * C.block<3, 3>(3 * J, 3 * L);
    const detail::SymmetricEigen left = detail::symmetricEigen(0.5 * (ofA + ofA.transpose()));
    const Vec3 a = left.vectors.col(2);
    for (int J = 0; J < 3; ++J)
      for (int L = 0; L < 3; ++L) ofN(J, L) = a.dot(C.block<3, 3>(3 * J, 3 * L) * a);
    largest = std::max({largest, left.values[2], detail::symmetricEigenvalues(0.5 * (ofN + ofN.transpose()))[2]});
  }
  return largest;
}

// Both norms bound every eigenvalue; the row norm is exact for an isotropic law at rest.
TangentBound boundOf(const Matrix9 &C, const Mat3 &F) {
  if (!C.allFinite()) return {kNone, kNone};
  return {waveModulus(C, F), std::min(C.cwiseAbs().rowwise().sum().maxCoeff(), C.norm())};
}

bool isNumber(double value) { return std::isfinite(value); }
bool isNumber(const Mat3 &value) { return value.allFinite(); }
bool isNumber(const TangentBound &bound) { return std::isfinite(bound.wave) && std::isfinite(bound.all); }
void makeNone(double &value) { value = kNone; }
void makeNone(Mat3 &value) { value.setConstant(kNone); }
void makeNone(TangentBound &bound) { bound = {kNone, kNone}; }

}  // namespace

Result<void> ElasticLaw::bounds(std::span<const Mat3> F, std::span<TangentBound> out) const {
  for (std::size_t i = 0; i < F.size(); ++i) {
    Matrix9 C;
    if (auto done = tangentAt(*this, F[i], C); !done) return done;
    out[i] = boundOf(C, F[i]);
  }
  return {};
}

void CheckedLaw::recordError(std::string text) const {
  const std::lock_guard lock(mutex_);
  lastError_ = law_->name() + ": " + std::move(text);
}

std::string CheckedLaw::consumeError() const {
  const std::lock_guard lock(mutex_);
  return std::exchange(lastError_, {});
}

template <class T>
void CheckedLaw::checkResult(const Result<void> &answered, const char *what, std::span<const Mat3> F,
                             std::span<T> values) const {
  if (!answered) {
    for (T &value : values) makeNone(value);
    return recordError(std::string(what) + ": " + answered.error());
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (isNumber(values[i]) || !F[i].allFinite()) continue;
    return recordError(std::string(what) + " is no number at F = " + shown(F[i]));
  }
}

void CheckedLaw::energies(std::span<const Mat3> F, std::span<double> W) const {
  checkResult(law_->energies(F, W), "the energy", F, W);
}
void CheckedLaw::stresses(std::span<const Mat3> F, std::span<Mat3> P) const {
  checkResult(law_->stresses(F, P), "the stress", F, P);
}
void CheckedLaw::differentials(std::span<const Mat3> F, std::span<const Mat3> dF, std::span<Mat3> dP) const {
  checkResult(law_->differentials(F, dF, dP), "the differential of the stress", F, dP);
}
void CheckedLaw::bounds(std::span<const Mat3> F, std::span<TangentBound> out) const {
  checkResult(law_->bounds(F, out), "the bound of the stiffness", F, out);
}

namespace {

// Fixed deformations at which a law is tested, so that a law always passes or fails in the same way.
class Trials {
 public:
  Trials() {
    std::uint64_t state = 0x9e3779b97f4a7c15ull;
    const auto next = [&state] {  // in (-1, 1)
      state = state * 6364136223846793005ull + 1442695040888963407ull;
      return static_cast<double>(state >> 40) / static_cast<double>(1u << 23) - 1.0;
    };
    const auto anyMatrix = [&] {
      Mat3 m;
      for (int c = 0; c < 9; ++c) m(c % 3, c / 3) = next();
      return m;
    };
    const auto rotation = [&] { return Mat3(Eigen::Quaterniond{next(), next(), next(), next()}.normalized()); };
    for (int i = 0; i < kCount; ++i) {
      const Mat3 frame = rotation();
      const double size = i % 3 == 0 ? 1e-3 : std::log(1.25);
      const Vec3 stretches{std::exp(size * next()), std::exp(size * next()), std::exp(size * next())};
      F.emplace_back(rotation() * frame * stretches.asDiagonal() * frame.transpose());
      turns.push_back(rotation());
      changes.push_back(anyMatrix());
    }
  }
  static constexpr int kCount = 24;
  std::vector<Mat3> F, turns, changes;
};

// Tests a law and stops at the first violation.
class Examination {
 public:
  explicit Examination(const ElasticLaw &law) : law_(law) {}

  Result<void> atRest(double &lambda, double &mu, TangentBound &rest) {
    const Mat3 I = Mat3::Identity();
    Matrix9 C;
    if (auto done = tangentAt(law_, I, C); !done) return failed("its differential at F = I: " + done.error());
    if (!C.allFinite()) return failed("its differential at F = I is no number");
    const double volume = I.reshaped().dot(C * I.reshaped()) / 9.0;
    double pairs = 0.0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) pairs += 0.5 * (C(i + 3 * j, i + 3 * j) + C(i + 3 * j, j + 3 * i));
    mu = 0.1 * (pairs - 3.0 * volume);
    lambda = volume - 2.0 / 3.0 * mu;
    const Eigen::SelfAdjointEigenSolver<Matrix9> eigen(0.5 * (C + C.transpose()), Eigen::EigenvaluesOnly);
    rest = {waveModulus(C, I), eigen.eigenvalues()[8]};
    // Three of the nine modes are rotations, without energy.
    const double softest = eigen.eigenvalues()[3];
    if (!(volume > 0.0) || !(mu > 0.0) || !(softest > 1e-9 * rest.all))
      return failed("it is not stiff at rest: bulk modulus " + number(volume) + " Pa, shear modulus " + number(mu) +
                    " Pa, softest strain " + number(softest) + " Pa; accepted: all > 0");
    for (int i = 0; i < 3; ++i)
      if (!(std::abs(eigen.eigenvalues()[i]) <= kExact * rest.all))
        return failed("a small rotation from rest is answered by " + number(eigen.eigenvalues()[i]) +
                      " Pa; accepted: none");
    double W = kNone;
    Mat3 P = Mat3::Constant(kNone);
    if (auto done = law_.energies({&I, 1}, {&W, 1}); !done) return failed("its energy at F = I: " + done.error());
    if (!(std::abs(W) <= kExact * rest.all)) return failed("W(I) = " + number(W) + " J/m³; accepted: 0");
    if (auto done = law_.stresses({&I, 1}, {&P, 1}); !done) return failed("its stress at F = I: " + done.error());
    if (!(P.norm() <= kExact * rest.all)) return failed("|P(I)| = " + number(P.norm()) + " Pa; accepted: 0");
    return {};
  }

  Result<void> deformed() {
    const Trials trials;
    const std::size_t n = trials.F.size();
    std::vector<double> W(n), turned(n), before(n), up(n), down(n);
    std::vector<Mat3> P(n), dP(n), higher(n), lower(n);
    std::vector<Mat3> QF(n), FQ(n), plus(n), minus(n);
    for (std::size_t i = 0; i < n; ++i) {
      QF[i] = trials.turns[i] * trials.F[i];
      FQ[i] = trials.F[i] * trials.turns[i];
      plus[i] = trials.F[i] + kStep * trials.changes[i];
      minus[i] = trials.F[i] - kStep * trials.changes[i];
    }
    std::vector<TangentBound> bounds(n);
    for (const auto &done :
         {law_.energies(trials.F, W), law_.energies(QF, turned), law_.energies(FQ, before), law_.energies(plus, up),
          law_.energies(minus, down), law_.stresses(trials.F, P), law_.stresses(plus, higher),
          law_.stresses(minus, lower), law_.differentials(trials.F, trials.changes, dP), law_.bounds(trials.F, bounds)})
      if (!done) return failed(done.error());
    for (std::size_t i = 0; i < n; ++i) {
      const Mat3 &F = trials.F[i], &D = trials.changes[i];
      const std::string at = " at F = " + shown(F);
      Matrix9 C;
      if (auto done = tangentAt(law_, F, C); !done) return failed("its differential" + at + ": " + done.error());
      const double stiff = C.norm(), size = D.norm();
      if (!std::isfinite(stiff) || !P[i].allFinite() || !std::isfinite(W[i])) return failed("it is no number" + at);
      const auto off = [&](double difference, double tolerance) {
        return !(std::abs(difference) <= tolerance * stiff);
      };
      if (off(turned[i] - W[i], kExact))
        return failed("W(QF) = " + number(turned[i]) + " J/m³ but W(F) = " + number(W[i]) + " J/m³" + at +
                      ", Q = " + shown(trials.turns[i]) + ": it is not objective");
      if (off(before[i] - W[i], kExact))
        return failed("W(FQ) = " + number(before[i]) + " J/m³ but W(F) = " + number(W[i]) + " J/m³" + at +
                      ", Q = " + shown(trials.turns[i]) + ": it is not isotropic, as a law has to be here");
      if (const double slope = (up[i] - down[i]) / (2.0 * kStep), said = P[i].cwiseProduct(D).sum();
          off(slope - said, kByDifferences * size))
        return failed("P : D = " + number(said) + " Pa but W changes by " + number(slope) + " Pa" + at);
      if (const Mat3 change = (higher[i] - lower[i]) / (2.0 * kStep);
          off((change - dP[i]).norm(), kByDifferences * size))
        return failed("the differential differs from the differences of P by " + number((change - dP[i]).norm()) +
                      " Pa of " + number(dP[i].norm()) + " Pa" + at);
      if (const double bent = (C * D.reshaped() - dP[i].reshaped()).norm(); off(bent, kExact * size))
        return failed("the differential is not linear: off by " + number(bent) + " Pa" + at);
      if (const double skew = (C - C.transpose()).norm(); off(skew, kExact))
        return failed("the differential is not symmetric: off by " + number(skew) + " Pa" + at);
      const double all =
          Eigen::SelfAdjointEigenSolver<Matrix9>(0.5 * (C + C.transpose()), Eigen::EigenvaluesOnly).eigenvalues()[8];
      const double wave = waveModulus(C, F);
      if (!(bounds[i].all >= all - kExact * stiff) || !(bounds[i].wave >= wave - kExact * stiff))
        return failed("its bounds of the stiffness, " + number(bounds[i].wave) + " Pa and " + number(bounds[i].all) +
                      " Pa, are below what is: " + number(wave) + " Pa for waves, " + number(all) + " Pa in all" + at);
      if (auto alone = sameAlone(F, D, W[i], P[i], dP[i]); !alone) return failed(alone.error() + at);
    }
    return {};
  }

 private:
  static constexpr double kExact = 1e-9, kByDifferences = 1e-5, kStep = 1e-5;

  // Batches depend on how threads are scheduled, so a point evaluated alone must have the same result.
  [[nodiscard]] Result<void> sameAlone(const Mat3 &F, const Mat3 &D, double W, const Mat3 &P, const Mat3 &dP) const {
    double w = kNone;
    Mat3 p = Mat3::Constant(kNone), dp = p;
    for (const auto &done : {law_.energies({&F, 1}, {&w, 1}), law_.stresses({&F, 1}, {&p, 1}),
                             law_.differentials({&F, 1}, {&D, 1}, {&dp, 1})})
      if (!done) return done;
    if (w == W && p == P && dp == dP) return {};
    return tl::unexpected<std::string>("a point alone is answered otherwise than in a batch");
  }

  [[nodiscard]] Result<void> failed(const std::string &what) const {
    return tl::unexpected<std::string>(law_.name() + " is not accepted: " + what);
  }

  const ElasticLaw &law_;
};

}  // namespace

Result<std::shared_ptr<const CheckedLaw>> checked(std::shared_ptr<const ElasticLaw> law) {
  Examination examination(*law);
  const std::shared_ptr<CheckedLaw> out(new CheckedLaw(std::move(law)));
  if (auto done = examination.atRest(out->lambda_, out->mu_, out->atRest_); !done)
    return tl::unexpected<std::string>(done.error());
  if (auto done = examination.deformed(); !done) return tl::unexpected<std::string>(done.error());
  return std::shared_ptr<const CheckedLaw>(out);
}

}  // namespace pointbased
