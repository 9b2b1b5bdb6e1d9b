// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pointbased/contact.h"
#include "pointbased/lattice.h"
#include "pointbased/neighborhood.h"
#include "pointbased/sampling.h"
#include "pointbased/supports.h"
#include "pointbased/surfels.h"

namespace pointbased {

enum class Evaluation {
  stressPoints,  ///< one point per lattice cell that the body cuts: accurate; needs a shape to fill
  phyxels        ///< one point per phyxel (Müller et al. 2004): any cloud
};

/// What holds and loads a body, resolved onto its phyxels.
struct BoundaryConditions {
  std::vector<Fix> fixes;
  std::vector<ConstrainedRegion> held;  ///< one per fix
  std::vector<Load> loads;
  std::vector<LoadedPart> loaded;  ///< one per load
};

/// The body inside a closed surface, world, m: how a deformed skin becomes a shape to fill. Errors: why it is none.
using Reshape = std::function<Result<BodyShape>(const Surface &skin)>;

/// How many neighbours phyxels have.
struct Neighbours {
  std::size_t min = 0, max = 0;
  double mean = 0.0;
};

/// What follows from the reference shape; const once it is built. Positions are relative to `origin`, so that a body
/// far from the world's origin loses no digits.
struct RestState {
  Evaluation evaluation = Evaluation::phyxels;
  Vec3 origin = Vec3::Zero();         ///< world, m
  double spacing = 0.0;               ///< m, of lattices the edge of the coarsest cells
  Vec3 latticeCorner = Vec3::Zero();  ///< m, where the coarsest cells begin, along stencils.axes from there
  double shapeVolume = 0.0;           ///< m³, of the shape that was filled: what its surface encloses
  double countedVolume = 0.0;         ///< m³, that the sampling has found inside of it; 0: nobody has counted
  std::vector<Vec3> positions;        ///< [phyxels] X, m
  std::vector<double> volumes;        ///< [phyxels] m³
  /// [phyxels] m³, shares of a load on the material of a held body; empty: `volumes`
  std::vector<double> weightVolumes;
  std::vector<double> heldVolumes;  ///< [phyxels] m³, part of `weightVolumes` that supports carry; empty: none
  /// [phyxels] m³, part of `volumes`, of the mass, that supports carry; empty: none
  std::vector<double> supportVolumes;
  /// Of clouds: [phyxels] those of their stencils; symmetric, without itself; see neighboursOf()
  Csr neighbors;
  Neighbours latticeNeighbours;            ///< of lattices: countNeighbours()
  StencilSet stencils;                     ///< evaluation points
  std::vector<Vec3> pointCentres;          ///< [points] m
  NeighborChoice neighborChoice;           ///< of Evaluation::phyxels
  LatticeSampling sampling;                ///< of Evaluation::stressPoints, as asked for
  Reshape reshape;                         ///< empty: a lattice cannot be renewed
  Surfels surfels;                         ///< the vertices of the surface
  std::vector<std::array<Index, 3>> skin;  ///< triangles between surfels; may be empty
  std::vector<Vec3> surfelNormals;         ///< unit; empty: points without normals
  ContactPoints contact;
  /// [phyxels] how far the body goes with a phyxel, of the phyxel's own way: maxInfluencesOf(). Empty: as far.
  std::vector<float> maxInfluence;
  Binder bind;  ///< material points, frame of the phyxels
  BoundaryConditions conditions;
  std::size_t components = 1;  ///< connected parts
  // Of a reference that has been renewed (rereferencing.h); empty in the first one:
  /// [phyxels] way from the first reference to this one, m: supports move what was there
  std::vector<Vec3> referenceShift;
  std::vector<double> materialShares;  ///< [phyxels][materials] of the mass; empty: by the points around

  [[nodiscard]] std::size_t phyxelCount() const { return positions.size(); }
  [[nodiscard]] std::size_t pointCount() const { return stencils.pointCount(); }
};

/// Of lattices: a corner that only a sliver of the body reaches moves hardly anything, so it may be fast. The most that
/// a phyxel moves a point of contact (more than 1: the point lies outside of its cell), or changes F of a point by,
/// compared with a phyxel amid whole cells, where at most 1 counts.
[[nodiscard]] std::vector<float> maxInfluencesOf(const RestState &rest);

/// How a shape becomes a body.
struct BodyRecipe {
  Evaluation evaluation = Evaluation::stressPoints;
  LatticeSampling sampling;  ///< `held` is filled from `fixes`
  NeighborChoice neighbors;  ///< of Evaluation::phyxels
  std::vector<Fix> fixes;
  std::vector<Load> loads;
  Reshape reshape;  ///< lattices: for renewed references (rereferencing.h); may be empty
};

/// Fills a shape and binds everything that belongs to it: surfels at the vertices of shape.surface with the given
/// normals, contact points, supports and loads.
///
/// Errors: those of fillLattice() and fill(); "fix 2: …" and "load 0: …" for regions that meet no part of the body.
[[nodiscard]] Result<std::shared_ptr<const RestState>> buildRestState(const BodyShape &shape, const BodyRecipe &recipe,
                                                                      std::span<const Vec3> surfelNormals,
                                                                      const ParallelFor &parallelFor,
                                                                      const SamplingProgress &progress = {});

/// A cloud of phyxels as it is, evaluated at the phyxels; without a surface it touches with balls of contactRadii.
/// @param surface  world, m; may be empty
[[nodiscard]] std::shared_ptr<const RestState> buildRestState(const PhyxelCloud &cloud, const NeighborChoice &choice,
                                                              double shapeVolume, const Surface &surface,
                                                              std::span<const Vec3> surfelNormals,
                                                              const ParallelFor &parallelFor);

/// [phyxels] those that share an evaluation point, ascending; symmetric, without itself. Of lattices worked out anew.
[[nodiscard]] Csr neighboursOf(const RestState &rest);

[[nodiscard]] Neighbours countNeighbours(const RestState &rest);

/// Where a load acts on a body that is there. Region and surface are in world coordinates at rest, m.
/// Errors: a region that validate() refuses, or that meets no part of the body.
[[nodiscard]] Result<LoadedPart> loadOn(const Load &load, const RestState &rest, const Surface &surface);

/// F of every phyxel from those of the points: itself for Evaluation::phyxels, else the volume-weighted mean of the
/// points it belongs to.
void phyxelGradients(const RestState &rest, std::span<const Mat3> pointGradients, std::span<Mat3> out);
/// The same mean of any quantity of the points. Stress is averaged as such: near incompressibility that of a mean F is
/// far off, and the mean over the cells around a phyxel holds no checkerboard.
void phyxelMeans(const RestState &rest, std::span<const Mat3> pointValues, std::span<Mat3> out);

}  // namespace pointbased
