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

/// Supports and loads of a body, resolved onto its phyxels.
struct BoundaryConditions {
  std::vector<Fix> fixes;
  std::vector<ConstrainedRegion> held;  ///< one per fix
  std::vector<Load> loads;
  std::vector<LoadedPart> loaded;  ///< one per load
};

/// Creates the shape of the body inside a closed surface, world, m: converts a deformed skin into a shape to fill.
/// Errors: why this is impossible.
using Reshape = std::function<Result<BodyShape>(const Surface &skin)>;

/// Number of neighbours of the phyxels.
struct Neighbours {
  std::size_t min = 0, max = 0;
  double mean = 0.0;
};

/// Data derived from the reference shape; const once built. Positions are relative to `origin`, so that a body far from
/// the world's origin loses no precision.
struct RestState {
  Evaluation evaluation = Evaluation::phyxels;
  Vec3 origin = Vec3::Zero();         ///< world, m
  double spacing = 0.0;               ///< m; for lattices the edge of the coarsest cells
  Vec3 latticeCorner = Vec3::Zero();  ///< m, corner of the coarsest cells, along stencils.axes from there
  double shapeVolume = 0.0;           ///< m³, of the filled shape: enclosed by its surface
  double countedVolume = 0.0;         ///< m³, found inside of it by the sampling; 0: not determined
  std::vector<Vec3> positions;        ///< [phyxels] X, m
  std::vector<double> volumes;        ///< [phyxels] m³
  /// [phyxels] m³, shares of a load on the material of a held body; empty: `volumes`
  std::vector<double> weightVolumes;
  std::vector<double> heldVolumes;  ///< [phyxels] m³, part of `weightVolumes` that supports carry; empty: none
  /// [phyxels] m³, part of `volumes`, of the mass, that supports carry; empty: none
  std::vector<double> supportVolumes;
  /// For clouds: [phyxels] neighbours in their stencils; symmetric, without the phyxel itself; see neighboursOf()
  Csr neighbors;
  Neighbours latticeNeighbours;            ///< for lattices: countNeighbours()
  StencilSet stencils;                     ///< evaluation points
  std::vector<Vec3> pointCentres;          ///< [points] m
  NeighborChoice neighborChoice;           ///< of Evaluation::phyxels
  LatticeSampling sampling;                ///< of Evaluation::stressPoints, as requested
  Reshape reshape;                         ///< empty: a lattice cannot be renewed
  Surfels surfels;                         ///< the vertices of the surface
  std::vector<std::array<Index, 3>> skin;  ///< triangles between surfels; may be empty
  std::vector<Vec3> surfelNormals;         ///< unit; empty: points without normals
  ContactPoints contact;
  /// [phyxels] upper bound of the body's travel over that of the phyxel that causes it: maxInfluencesOf(). Empty: 1.
  std::vector<float> maxInfluence;
  Binder bind;  ///< binds material points, frame of the phyxels
  BoundaryConditions conditions;
  std::size_t components = 1;  ///< connected parts
  // For a reference that has been renewed (rereferencing.h); empty in the first one:
  /// [phyxels] displacement from the first reference to this one, m, for supports, whose motion refers to the first
  std::vector<Vec3> referenceShift;
  std::vector<double> materialShares;  ///< [phyxels][materials] of the mass; empty: from the surrounding points

  [[nodiscard]] std::size_t phyxelCount() const { return positions.size(); }
  [[nodiscard]] std::size_t pointCount() const { return stencils.pointCount(); }
};

/// For lattices: a corner that only a sliver of the body reaches moves hardly any material, so it may be fast. Returns
/// the largest displacement of a contact point per displacement of the phyxel (more than 1: the point is outside of its
/// cell), or the largest change of F of a point, relative to a phyxel amid whole cells, for which it is at most 1.
[[nodiscard]] std::vector<float> maxInfluencesOf(const RestState &rest);

/// Recipe for building a body from a shape.
struct BodyRecipe {
  Evaluation evaluation = Evaluation::stressPoints;
  LatticeSampling sampling;  ///< `held` is filled from `fixes`
  NeighborChoice neighbors;  ///< of Evaluation::phyxels
  std::vector<Fix> fixes;
  std::vector<Load> loads;
  Reshape reshape;  ///< lattices: for renewed references (rereferencing.h); may be empty
};

/// Fills a shape and binds all associated data: surfels at the vertices of shape.surface with the given normals,
/// contact points, supports and loads.
///
/// Errors: those of fillLattice() and fill(); "fix 2: …" and "load 0: …" for regions that contain no part of the body.
[[nodiscard]] Result<std::shared_ptr<const RestState>> buildRestState(const BodyShape &shape, const BodyRecipe &recipe,
                                                                      std::span<const Vec3> surfelNormals,
                                                                      const ParallelFor &parallelFor,
                                                                      const SamplingProgress &progress = {});

/// Uses a cloud of phyxels as it is, evaluated at the phyxels; without a surface it collides as balls of contactRadii.
/// @param surface  world, m; may be empty
[[nodiscard]] std::shared_ptr<const RestState> buildRestState(const PhyxelCloud &cloud, const NeighborChoice &choice,
                                                              double shapeVolume, const Surface &surface,
                                                              std::span<const Vec3> surfelNormals,
                                                              const ParallelFor &parallelFor);

/// [phyxels] those that share an evaluation point, ascending; symmetric, without the phyxel itself. Recomputed for
/// lattices.
[[nodiscard]] Csr neighboursOf(const RestState &rest);

[[nodiscard]] Neighbours countNeighbours(const RestState &rest);

/// Resolves a load on an existing body. Region and surface are in world coordinates at rest, m.
/// Errors: a region that validate() refuses, or that contains no part of the body.
[[nodiscard]] Result<LoadedPart> loadOn(const Load &load, const RestState &rest, const Surface &surface);

/// F of every phyxel from those of the points: the same point for Evaluation::phyxels, otherwise the volume-weighted
/// mean of the points it belongs to.
void phyxelGradients(const RestState &rest, std::span<const Mat3> pointGradients, std::span<Mat3> out);
/// Same mean for any quantity of the points. Stress is averaged directly: near incompressibility the stress of a mean F
/// is far off, and the mean over the cells around a phyxel contains no checkerboard mode.
void phyxelMeans(const RestState &rest, std::span<const Mat3> pointValues, std::span<Mat3> out);

}  // namespace pointbased
