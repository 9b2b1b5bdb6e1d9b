// SPDX-License-Identifier: Apache-2.0
#include "matching/load_response.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sensitivity/equilibrium_tangent.h"
#include "stepping/implicit/stage_problem.h"

namespace pointbased::detail {
namespace {

constexpr double kTolerance = 1e-3;  // of responses
constexpr int kMaxIterations = 2000;
constexpr std::size_t kBlock = 64;  // vertices whose derivatives are one product of matrices

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
  for (std::size_t p = 0; p < patterns.count(); ++p) {
    patterns.forces(p, forces);
    std::vector<Vec3> &response = out->linear_.emplace_back(at.size(), Vec3::Zero());
    if (auto done = tangent.solve(problem, forces, response, kTolerance, kMaxIterations, Preconditioner::automatic,
                                  environment.stop);
        !done)
      return tl::unexpected(done.error());
  }
  std::vector<Vec3> u = at;
  out->deform(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(out->count())), u, *environment.parallelFor);
  return out;
}

std::vector<Vec3> LoadResponse::sum(const Eigen::VectorXd &amplitudes) const {
  std::vector<Vec3> out(linear_.front().size(), Vec3::Zero());
  for (std::size_t p = 0; p < count(); ++p) {
    const double amplitude = amplitudes[static_cast<Eigen::Index>(p)];
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += amplitude * linear_[p][i];
  }
  return out;
}

void LoadResponse::deform(const Eigen::VectorXd &amplitudes, std::span<Vec3> u, const ParallelFor &parallelFor) {
  warped_.deform(sum(amplitudes), u, parallelFor);
  shape_.assign(u.begin(), u.end());
}

double LoadResponse::size(const Eigen::VectorXd &amplitudes) const {
  double squared = 0.0;
  const std::vector<Vec3> all = sum(amplitudes);
  for (const Vec3 &v : all) squared += v.squaredNorm();
  return std::sqrt(squared / static_cast<double>(all.size()));
}

void LoadResponse::findColumns(const Interpolation &binding, std::span<const Index> points,
                               std::span<Eigen::VectorXf *> out, const ParallelFor &parallelFor) const {
  constexpr std::size_t kTogether = WarpedResponse::kTogether;
  parallelFor((points.size() + kTogether - 1) / kTogether, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) {
      const std::size_t first = block * kTogether, last = std::min(points.size(), first + kTogether);
      WarpedResponse::Columns weights =
          WarpedResponse::Columns::Zero(static_cast<Eigen::Index>(linear_.front().size()), kTogether);
      for (std::size_t k = first; k < last; ++k)
        for (Index e = binding.phyxels.offsets[points[k]]; e < binding.phyxels.offsets[points[k] + 1]; ++e)
          weights(binding.phyxels.indices[e], static_cast<Eigen::Index>(k - first)) += binding.weights[e];
      warped_.solve(weights);
      for (std::size_t k = first; k < last; ++k)
        *out[k] = weights.col(static_cast<Eigen::Index>(k - first)).cast<float>();
    }
  });
}

void LoadResponse::differentiate(double tolerance, const ParallelFor &parallelFor) {
  double squared = 0.0;
  for (std::size_t i = 0; i < differentiatedAt_.size(); ++i)
    squared += (shape_[i] - differentiatedAt_[i]).squaredNorm();
  if (!differentiatedAt_.empty() && squared <= tolerance * tolerance * static_cast<double>(shape_.size())) return;
  differentiatedAt_ = shape_;
  moved_.clear();
  derivatives_.setZero(static_cast<Eigen::Index>(shape_.size()), static_cast<Eigen::Index>(3 * count()));
  parallelFor(count(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      warped_.addDerivative(linear_[p], derivatives_.middleCols(static_cast<Eigen::Index>(3 * p), 3));
  });
}

void LoadResponse::moveVertices(const Interpolation &skin, std::span<const Index> vertices,
                                const ParallelFor &parallelFor) {
  std::vector<Index> missing, unsolved;
  std::vector<Eigen::RowVectorXf *> rows;
  std::vector<Eigen::VectorXf *> columns;
  for (const Index vertex : vertices)
    if (const auto [at, isNew] = moved_.try_emplace(vertex); isNew) {
      missing.push_back(vertex);
      rows.push_back(&at->second);
      if (const auto [column, isUnsolved] = columns_.try_emplace(vertex); isUnsolved) {
        unsolved.push_back(vertex);
        columns.push_back(&column->second);
      }
    }
  findColumns(skin, unsolved, columns, parallelFor);
  parallelFor((missing.size() + kBlock - 1) / kBlock, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) {
      const std::size_t first = block * kBlock, last = std::min(missing.size(), first + kBlock);
      Eigen::MatrixXf together(derivatives_.rows(), static_cast<Eigen::Index>(last - first));
      for (std::size_t k = first; k < last; ++k)
        together.col(static_cast<Eigen::Index>(k - first)) = columns_.find(missing[k])->second;
      const Eigen::MatrixXf product = together.transpose() * derivatives_;
      for (std::size_t k = first; k < last; ++k) *rows[k] = product.row(static_cast<Eigen::Index>(k - first));
    }
  });
}

Eigen::MatrixXd LoadResponse::sensitivities(const MatchTerms &terms, double tolerance, const ParallelFor &parallelFor) {
  differentiate(tolerance, parallelFor);
  const std::vector<Index> vertices = terms.vertices();
  moveVertices(terms.skinBinding(), vertices, parallelFor);
  const Interpolation &landmarks = terms.landmarkBinding();
  std::vector<Eigen::VectorXf> columns(landmarks.count());
  std::vector<Eigen::VectorXf *> found;
  for (Eigen::VectorXf &column : columns) found.push_back(&column);
  std::vector<Index> all(landmarks.count());
  std::iota(all.begin(), all.end(), Index{0});
  findColumns(landmarks, all, found, parallelFor);

  Eigen::MatrixXd moved(static_cast<Eigen::Index>(vertices.size() + landmarks.count()), derivatives_.cols());
  for (std::size_t k = 0; k < vertices.size(); ++k)
    moved.row(static_cast<Eigen::Index>(k)) = moved_.find(vertices[k])->second.cast<double>();
  for (std::size_t l = 0; l < columns.size(); ++l)
    moved.row(static_cast<Eigen::Index>(vertices.size() + l)) = (columns[l].transpose() * derivatives_).cast<double>();
  Eigen::MatrixXd out(terms.rows(), static_cast<Eigen::Index>(count()));
  for (std::size_t p = 0; p < count(); ++p)
    terms.observe(vertices, moved.middleCols(static_cast<Eigen::Index>(3 * p), 3),
                  out.col(static_cast<Eigen::Index>(p)));
  return out;
}

}  // namespace pointbased::detail
