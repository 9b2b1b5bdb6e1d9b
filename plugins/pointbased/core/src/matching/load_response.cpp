// SPDX-License-Identifier: Apache-2.0
#include "matching/load_response.h"

#include <algorithm>
#include <cmath>

#include "sensitivity/equilibrium_tangent.h"
#include "stepping/implicit/stage_problem.h"

namespace pointbased::detail {
namespace {

constexpr double kTolerance = 1e-3;  // of responses
constexpr int kMaxIterations = 2000;
constexpr std::size_t kGrain = 64;
// rad: relative errors of rotated derivatives are some half of the angle.
constexpr double kReuseAngle = 0.05;

}  // namespace

Result<std::unique_ptr<LoadResponse>> LoadResponse::create(Body &body, const LoadPatterns &patterns,
                                                           const Environment &environment) {
  std::unique_ptr<LoadResponse> out(new LoadResponse(body));
  ImplicitStage stage;
  stage.end = 1.0;
  StageProblem problem(body, environment, stage);
  const std::vector<Vec3> at = body.state().displacements;
  if (!problem.setState(at)) return tl::unexpected(std::string("the state of the body is not finite"));
  TangentSolver tangent;
  std::vector<Vec3> forces(at.size());
  std::vector<Vec3> response(at.size());
  const auto count = static_cast<Eigen::Index>(patterns.count());
  ResponseMatrix responses(static_cast<Eigen::Index>(at.size()), 3 * count);
  for (Eigen::Index p = 0; p < count; ++p) {
    patterns.forces(static_cast<std::size_t>(p), forces);
    std::fill(response.begin(), response.end(), Vec3(Vec3::Zero()));
    if (auto done = tangent.solve(problem, forces, response, kTolerance, kMaxIterations, Preconditioner::automatic,
                                  environment.stop);
        !done)
      return tl::unexpected(done.error());
    for (std::size_t i = 0; i < response.size(); ++i)
      for (Eigen::Index c = 0; c < 3; ++c)
        responses(static_cast<Eigen::Index>(i), c * count + p) = static_cast<float>(response[i][c]);
  }
  out->warped_.setResponses(responses, *environment.parallelFor);
  std::vector<Vec3> u = at;
  out->deform(Eigen::VectorXd::Zero(count), u, *environment.parallelFor);
  return out;
}

std::vector<Vec3> LoadResponse::sum(const Eigen::VectorXd &amplitudes, const ParallelFor &parallelFor) const {
  const ResponseMatrix &all = warped_.responses();
  std::vector<Vec3> out(static_cast<std::size_t>(all.rows()));
  const Eigen::Index n = amplitudes.size(), third = all.cols() / 3;
  const Eigen::RowVectorXd transposed = amplitudes.transpose();
  parallelFor(out.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (Eigen::Index c = 0; c < 3; ++c)
        out[i][c] = all.row(static_cast<Eigen::Index>(i)).segment(c * third, n).cast<double>().dot(transposed);
  });
  return out;
}

void LoadResponse::deform(const Eigen::VectorXd &amplitudes, std::span<Vec3> u, const ParallelFor &parallelFor) {
  warped_.deform(sum(amplitudes, parallelFor), u, parallelFor);
  shape_.resize(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) shape_[i] = rest_.positions[i] + u[i];
}

double LoadResponse::size(const Eigen::VectorXd &amplitudes, const ParallelFor &parallelFor) const {
  double squared = 0.0;
  const std::vector<Vec3> all = sum(amplitudes, parallelFor);
  for (const Vec3 &v : all) squared += v.squaredNorm();
  return std::sqrt(squared / static_cast<double>(all.size()));
}

double LoadResponse::distanceAfter(const RigidFit &motion) const {
  double squared = 0.0;
  for (std::size_t i = 0; i < shape_.size(); ++i) squared += (shape_[i] - motion(differentiatedAt_[i])).squaredNorm();
  return std::sqrt(squared / static_cast<double>(shape_.size()));
}

Eigen::MatrixXd LoadResponse::sensitivities(const MatchTerms &terms, double tolerance, const ParallelFor &parallelFor) {
  RigidFit motion;
  if (!differentiatedAt_.empty()) motion = rigidFit(differentiatedAt_, shape_, std::vector<double>(shape_.size(), 1.0));
  if (differentiatedAt_.empty() || distanceAfter(motion) > tolerance ||
      Eigen::AngleAxisd(motion.rotation).angle() > kReuseAngle) {
    motion = {};
    differentiatedAt_ = shape_;
    warped_.differentiate(derivatives_, parallelFor);
  }
  return terms.observe(derivatives_, count(), motion.rotation, parallelFor);
}

}  // namespace pointbased::detail
