// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "reference/neighborhood.h"

namespace reference {

struct Plasticity {
  double yield = 0.05;     ///< |eps_e| from which it flows, in the strain that is used (2E with factorFour)
  double maximum = 1.0;    ///< |eps_p| is scaled back to this
  double creep = 0.1;      ///< part per step, 0 … 1; creepPerStep
  double creepTime = 0.1;  ///< tau, s; otherwise
};

struct Material {
  double youngsModulus = 6000.0;  ///< Pa
  double poissonRatio = 0.3;
  double density = 1000.0;       ///< kg/m³
  double volumeStiffness = 0.0;  ///< k_v, Pa; counts volume a second time beside Poisson's ratio
  std::optional<Plasticity> plasticity;
};

/// sigma = C eps of an isotropic body: E/((1+nu)(1-2nu)) times 1-nu, nu, and 1-2nu for the tensor shears.
[[nodiscard]] Mat3 stress(const Material &material, const Mat3 &strain);

/// eps from J = I + (grad u)^T, with its errata.
[[nodiscard]] Mat3 strain(const Mat3 &J, const Errata &errata);

/// Phyxels as the thesis has them: arrays, and loops over phyxels and their neighbours.
struct Body {
  Errata errata = Errata::corrected();
  Material material;
  Neighborhoods neighborhoods;

  std::vector<Vec3> X;         ///< reference positions, m
  std::vector<Vec3> u;         ///< displacements, m
  std::vector<Vec3> velocity;  ///< m/s; with forwardEuler those of half a step before
  std::vector<Vec3> force;     ///< N

  std::vector<double> mass;     ///< kg
  std::vector<double> density;  ///< rho_i, kg/m³
  std::vector<double> volume;   ///< v_i, m³

  std::vector<Vec3> singularValues;  ///< of A, largest first, 1/m
  std::vector<int> rank;             ///< 3: A is regular; less: flat directions
  std::vector<Mat3> frame;           ///< eigenvectors of A, largest first
  std::vector<Vec3> d;               ///< per neighbour: d_j = A_i^-1 X_ij w_ij, 1/m
  std::vector<Vec3> dSelf;           ///< d_i = -sum d_j
  std::vector<Mat3> J;               ///< of the last force evaluation
  std::vector<Mat3> plasticStrain;
};

/// Cut-offs of singular values of A: as printed in the unit of A, 1/length; and relative to the largest.
inline constexpr double kAbsoluteCutOff = 1e-3;
inline constexpr double kRelativeCutOff = 1e-2;

/// Mass, density, volume, moment matrices and d of a body at rest.
///
/// @param cellVolumes  [phyxels] m³, used without densityVolumes and scaled to sum to bodyVolume
/// @source  m_i = s d_i³ rho, rho_i = sum_j m_j w_ij (i included), v_i = m_i/rho_i; s is the mean over i of
///          1/sum_j d_j³ w_ij, which makes the densities about rho
[[nodiscard]] Body buildBody(std::span<const Vec3> positions, Neighborhoods neighborhoods, const Material &material,
                             std::span<const double> cellVolumes, double bodyVolume, const Errata &errata);

/// J = I + (grad u)^T of phyxel i, grad u = sum_j d_j (u_j - u_i)^T; completed in flat directions without truncatedFit.
[[nodiscard]] Mat3 deformation(const Body &body, std::size_t i);

/// The loop of the thesis: J, eps, sigma and the forces of every phyxel on its neighbours and itself; fills J and
/// force.
///
/// f_j = -2 v_i J sigma d_j,  f_i = -2 v_i J sigma d_i,  and of the volume  -v_i k_v (|J| - 1) cof(J) d.
/// Without factorFour the 2 is 1.
void computeForces(Body &body);

/// sum v_i (1/2 eps:sigma + k_v/2 (|J| - 1)²), J, at the present displacements.
[[nodiscard]] double elasticEnergy(const Body &body);
[[nodiscard]] double kineticEnergy(const Body &body);

/// Lets the plastic strain grow, by what the J of the last force evaluation says.
void flow(Body &body, double dt);

/// One step of (6.9) as printed or of (6.10), by errata.forwardEuler; with plasticity it flows at the end.
/// @pre  force belongs to the present displacements
void step(Body &body, double dt);

}  // namespace reference
