// SPDX-License-Identifier: Apache-2.0
// Which preconditioner serves Newton's method best, at which size and stiffness?
//
//   bench_newton [--least PHYXELS] [--most PHYXELS] [--csv FILE] [--json FILE]
//
// A cantilever of 0.2 x 0.04 x 0.04 m on an uncut lattice (one evaluation point per cell, neo-Hookean, stabilised), its
// end held:
//   static    a force on the other end that bends it down by about a fifth of its length, found in one solve from rest
//   implicit  steps of backward Euler, dt = 1/60 s, falling under gravity from rest: the first, and the mean of five
//   more
// The state is solved to 1e-7 m. Times are of the processor, one thread, so what else the machine does counts little.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/report.h"
#include "bench/timing.h"
#include "pointbased/engine.h"
#include "pointbased/newton.h"

namespace {

using namespace pointbased;

using bench::processor_ms;

struct Beam {
  std::vector<Vec3> positions;
  std::vector<double> volumes;
  std::vector<std::uint8_t> held;
  std::vector<std::size_t> end;
  StencilSet stencils;
};

// Whole cells of a box, so stencils are those of trilinear cells: mean gradients, coefficients of the four modes.
Beam makeBeam(int layers) {
  constexpr double kLength = 0.2, kHeight = 0.04;
  const double h = kHeight / layers;
  const int nx = static_cast<int>(std::lround(kLength / h)), ny = layers;
  Beam beam;
  // Slice after slice along the beam: the order of a sampling that is sorted in space.
  const auto id = [&](int x, int y, int z) { return static_cast<std::size_t>((x * (ny + 1) + z) * (ny + 1) + y); };
  const std::size_t n = id(nx, ny, ny) + 1;
  beam.volumes.assign(n, 0.0);
  beam.held.assign(n, 0);
  for (int x = 0; x <= nx; ++x)
    for (int z = 0; z <= ny; ++z)
      for (int y = 0; y <= ny; ++y) {
        beam.positions.push_back(h * Vec3(x, y, z));
        if (x == 0) beam.held[id(x, y, z)] = 1;
        if (x == nx) beam.end.push_back(id(x, y, z));
      }
  StencilSet &s = beam.stencils;
  const double volume = h * h * h;
  for (int x = 0; x < nx; ++x)
    for (int z = 0; z < ny; ++z)
      for (int y = 0; y < ny; ++y) {
        for (int corner = 0; corner < 8; ++corner) {
          const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
          const Vec3 sign(2 * i - 1, 2 * j - 1, 2 * k - 1);
          const std::size_t at = id(x + i, y + j, z + k);
          s.phyxels.indices.push_back(static_cast<Index>(at));
          s.gradients.push_back(sign / (4.0 * h));
          s.modes.push_back(
              Eigen::Vector4d(sign[0] * sign[1], sign[0] * sign[2], sign[1] * sign[2], 2.0 / h * sign.prod()) /
              (2.0 * h * h));
          beam.volumes[at] += volume / 8.0;
        }
        s.phyxels.offsets.push_back(static_cast<Index>(s.phyxels.indices.size()));
        s.variances.push_back(Vec3::Constant(h * h / 12.0));
        s.volumes.push_back(volume);
        s.rank.push_back(3);
        s.frameOf.push_back(StencilSet::kNoFrame);
      }
  buildGather(s, n);
  return beam;
}

// Σ U(u) - f·u + 1/(2 dt²) Σ m |u - target|²; inverseDt = 0: statics.
class BeamProblem : public IncrementalPotential {
 public:
  BeamProblem(const Beam &beam, const Material &material) : beam_(beam) {
    constitution_.materials = {material};
    constitution_.stabilisation = kLatticeStabilisation;
    const std::size_t n = beam.positions.size(), points = beam.stencils.pointCount();
    forces.assign(n, Vec3::Zero());
    target.assign(n, Vec3::Zero());
    u_.resize(n);
    gradients_.resize(points);
    stresses_.resize(points);
    ratios_.resize(points);
    entries_.resize(beam.stencils.phyxels.indices.size());
  }
  [[nodiscard]] std::size_t phyxels() const override { return u_.size(); }
  [[nodiscard]] std::span<const std::uint8_t> prescribed() const override { return beam_.held; }
  [[nodiscard]] bool setState(std::span<const Vec3> u) override {
    std::copy(u.begin(), u.end(), u_.begin());
    deformationGradients(beam_.stencils, u_, gradients_, serialFor());
    return true;
  }
  [[nodiscard]] double energy() override {
    const ElasticEnergy elastic = elasticEnergy(constitution_, beam_.stencils, beam_.positions, u_, gradients_, {});
    double e = elastic.strain + elastic.stabilisation;
    for (std::size_t i = 0; i < u_.size(); ++i)
      e += 0.5 * inertia(i) * (u_[i] - target[i]).squaredNorm() - forces[i].dot(u_[i]);
    return e;
  }
  void gradient(std::span<Vec3> out) override {
    pointStresses(constitution_, beam_.stencils, gradients_, {}, {}, 0.0, nullptr, stresses_, ratios_, serialFor());
    internalForces(constitution_, beam_.stencils, beam_.positions, u_, gradients_, stresses_, entries_, out,
                   serialFor());
    for (std::size_t i = 0; i < u_.size(); ++i) out[i] = inertia(i) * (u_[i] - target[i]) - out[i] - forces[i];
  }
  void product(std::span<const Vec3> du, std::span<Vec3> out) override {
    const double begin = processor_ms();
    forceDifferential(constitution_, beam_.stencils, beam_.positions, u_, gradients_, {}, 0.0, 0.0, du, scratch_, out,
                      serialFor());
    for (std::size_t i = 0; i < u_.size(); ++i) out[i] = inertia(i) * du[i] - out[i];
    productTime += processor_ms() - begin;
    ++products;
  }
  void diagonalBlocks(std::span<Mat3> out) override {
    const double begin = processor_ms();
    stiffnessBlocks(constitution_, beam_.stencils, beam_.positions, u_, gradients_, {}, 0.0, 0.0, out, serialFor());
    for (std::size_t i = 0; i < u_.size(); ++i) out[i].diagonal().array() += inertia(i);
    blocksTime += processor_ms() - begin;
    ++blocks;
  }
  [[nodiscard]] bool assemble(Eigen::SparseMatrix<double> &out) override {
    const double begin = processor_ms();
    stiffnessTriplets(constitution_, beam_.stencils, beam_.positions, u_, gradients_, {}, 0.0, 0.0, triplets_);
    for (std::size_t i = 0; i < 3 * u_.size(); ++i)
      triplets_.emplace_back(static_cast<int>(i), static_cast<int>(i), inertia(i / 3));
    const auto size = static_cast<Eigen::Index>(3 * u_.size());
    out.resize(size, size);
    out.setFromTriplets(triplets_.begin(), triplets_.end());
    assemblyTime += processor_ms() - begin;
    ++assemblies;
    return true;
  }

  std::vector<Vec3> forces, target;
  double inverseDt = 0.0;
  double productTime = 0.0, assemblyTime = 0.0, blocksTime = 0.0;  // ms
  int products = 0, blocks = 0, assemblies = 0;

 private:
  [[nodiscard]] double inertia(std::size_t i) const {
    return beam_.volumes[i] * constitution_.materials[0].restDensity * inverseDt * inverseDt;
  }

  const Beam &beam_;
  Constitution constitution_;
  std::vector<Vec3> u_, entries_;
  std::vector<Mat3> gradients_, stresses_;
  std::vector<double> ratios_;
  TangentScratch scratch_;
  std::vector<Eigen::Triplet<double>> triplets_;
};

struct Cost {
  NewtonResult result;
  double ms = 0.0;
  bool good = true;

  void add(const Cost &other) {
    result.iterations += other.result.iterations;
    result.linearIterations += other.result.linearIterations;
    result.factorisations += other.result.factorisations;
    ms += other.ms;
    good = good && other.good;
  }
};

Cost timed(NewtonSolver &solver, BeamProblem &problem, std::vector<Vec3> &u, const NewtonSettings &settings) {
  Cost cost;
  const double begin = processor_ms();
  cost.result = solver.solve(problem, u, settings);
  cost.ms = processor_ms() - begin;
  cost.good = cost.result.good();
  return cost;
}

constexpr std::pair<Preconditioner, const char *> kPreconditioners[] = {{Preconditioner::blockJacobi, "blockJacobi"},
                                                                        {Preconditioner::incomplete, "incomplete"},
                                                                        {Preconditioner::factorised, "factorised"},
                                                                        {Preconditioner::automatic, "automatic"}};

class Rows {
 public:
  explicit Rows(bench::Report &report) : report_(report) {
    report_.table("solves", {{"phyxels", "phyxels"},
                             {"case", "case"},
                             {"youngs_modulus_Pa", "E Pa", 0},
                             {"poisson_ratio", "nu", 2},
                             {"preconditioner", "precond.   "},
                             {"newton_iterations", "newton", 1},
                             {"linear_iterations", "linear", 1},
                             {"factorisations", "factor.", 1},
                             {"processor_ms", "ms", 2},
                             {"tip_mm", "tip mm"},
                             {"product_ms", "product ms"},
                             {"blocks_ms", "blocks ms", 2},
                             {"assembly_ms", "assembly ms", 2},
                             {"converged", "converged"}});
  }
  void row(const BeamProblem &problem, const char *name, const Material &m, const char *preconditioner,
           const Cost &cost, double per, double tip) {
    report_.row({problem.phyxels(), name, m.youngsModulus, m.poissonRatio, preconditioner, cost.result.iterations / per,
                 cost.result.linearIterations / per, cost.result.factorisations / per, cost.ms / per, 1e3 * tip,
                 mean(problem.productTime, problem.products), mean(problem.blocksTime, problem.blocks),
                 mean(problem.assemblyTime, problem.assemblies), cost.good});
  }

 private:
  static bench::Report::Cell mean(double sum, int count) {
    return count > 0 ? bench::Report::Cell(sum / count) : bench::Report::Cell();
  }
  bench::Report &report_;
};

void statics(const Beam &beam, const Material &material, Preconditioner p, const char *name, Rows &rows) {
  BeamProblem problem(beam, material);
  for (const std::size_t i : beam.end)  // -2.03 mm of tip for 1.6 mN at 10 kPa, in proportion
    problem.forces[i] = Vec3(0, 0, -20 * 1.6e-3 * material.youngsModulus / 1e4 / static_cast<double>(beam.end.size()));
  NewtonSolver solver;
  NewtonSettings settings;
  settings.preconditioner = p;
  std::vector<Vec3> u(beam.positions.size(), Vec3::Zero());
  const Cost cost = timed(solver, problem, u, settings);
  rows.row(problem, "static", material, name, cost, 1.0, u[beam.end[0]][2]);
}

void implicit(const Beam &beam, const Material &material, Preconditioner p, const char *name, Rows &rows) {
  constexpr double kDt = 1.0 / 60.0;
  constexpr int kSteps = 5;
  BeamProblem problem(beam, material);
  problem.inverseDt = 1.0 / kDt;
  NewtonSolver solver;
  NewtonSettings settings;
  settings.preconditioner = p;
  const std::size_t n = beam.positions.size();
  std::vector<Vec3> u(n, Vec3::Zero()), v(n, Vec3::Zero());
  Cost later;
  for (int step = 0; step <= kSteps; ++step) {
    const std::vector<Vec3> before = u;
    for (std::size_t i = 0; i < n; ++i) problem.target[i] = u[i] + kDt * v[i] + kDt * kDt * Vec3(0, 0, -9.81);
    const Cost cost = timed(solver, problem, u, settings);
    for (std::size_t i = 0; i < n; ++i) v[i] = (u[i] - before[i]) / kDt;
    if (step == 0) {
      rows.row(problem, "first", material, name, cost, 1.0, u[beam.end[0]][2]);
    } else {
      later.add(cost);
    }
  }
  rows.row(problem, "step", material, name, later, kSteps, u[beam.end[0]][2]);
}

}  // namespace

int main(int argc, char **argv) {
  std::size_t least = 0, most = 11000;
  bench::CommandLine line("bench_newton");
  line.add("--least", "PHYXELS", [&](const std::string &text) { least = std::strtoul(text.c_str(), nullptr, 10); });
  line.add("--most", "PHYXELS", [&](const std::string &text) { most = std::strtoul(text.c_str(), nullptr, 10); });
  if (const auto exit = line.parse(argc, argv)) return *exit;
  bench::Report report(line.name(), line.options());
  report.fact("tolerance_m", NewtonSettings{}.toleranceDisplacement);
  Rows rows(report);
  for (const int layers : {4, 8, 12}) {
    const Beam beam = makeBeam(layers);
    if (beam.positions.size() < least || beam.positions.size() > most) continue;
    for (const double nu : {0.3, 0.49})
      for (const auto &[p, name] : kPreconditioners) {
        Material material{MaterialLaw::neoHookean, 1e4, nu, 1060.0};
        statics(beam, material, p, name, rows);
        for (const double E : {1e4, 1e6}) {
          material.youngsModulus = E;
          implicit(beam, material, p, name, rows);
        }
      }
  }
  return report.write();
}
