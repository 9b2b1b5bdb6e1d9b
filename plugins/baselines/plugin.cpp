// SPDX-License-Identifier: Apache-2.0
#include "c3de/sdk/plugin.hpp"

#include "c3de/abi/iface/parameter_ids.h"
#include "declarations.h"
#include "obstacles.h"
#include "relaxation.h"
#include "shape_body.h"
#include "spring_body.h"
#include "tetra_body.h"
#include "thesis_body.h"

namespace baselines {
namespace {

Elasticity materialOf(const ParameterValues &of) {
  return {of.number(C3DE_PARAM_ID_YOUNGS_MODULUS), of.number(C3DE_PARAM_ID_DENSITY), 0.0,
          of.number(C3DE_PARAM_ID_POISSON_RATIO)};
}

TetraBody::Law lawOf(std::string_view name) {
  return name == "stvk"        ? TetraBody::Law::stVenantKirchhoff
         : name == "corotated" ? TetraBody::Law::corotated
         : name == "linear"    ? TetraBody::Law::linear
                               : TetraBody::Law::neoHookean;
}

Method massSprings() {
  return {"mass springs",
          worldOfBaselines(),
          ofMassSprings(),
          [](const ParameterValues &of) {
            Elasticity m = materialOf(of);
            m.retardationTime_s = of.number("material.retardation_time");
            return m;
          },
          [](Lattice lattice, Surface skin, std::vector<Elasticity> materials, const ParameterValues &) {
            return std::make_unique<SpringBody>(std::move(lattice), std::move(skin), std::move(materials));
          },
          relax,
          makeObstacle,
          ofObstacles()};
}

Method shapeMatching() {
  return {"clusters of shape matching",
          worldOfBaselines(),
          ofShapeMatching(),
          materialOf,
          [](Lattice lattice, Surface skin, std::vector<Elasticity> materials, const ParameterValues &of) {
            return std::make_unique<ShapeBody>(std::move(lattice), std::move(skin), std::move(materials),
                                               static_cast<int>(of.number(kReach)), of.number(kLinear));
          },
          relax,
          makeObstacle,
          ofObstacles()};
}

Method tetrahedra() {
  return {"tetrahedra",
          worldOfBaselines(),
          ofTetrahedra(),
          materialOf,
          [](Lattice lattice, Surface skin, std::vector<Elasticity> materials, const ParameterValues &of) {
            return std::make_unique<TetraBody>(std::move(lattice), std::move(skin), std::move(materials),
                                               lawOf(of.text(kLaw)));
          },
          relax,
          makeObstacle,
          ofObstacles()};
}

Method thesis() {
  return {"phyxels of the thesis",
          worldOfBaselines(),
          ofThesis(),
          materialOf,
          [](Lattice lattice, Surface skin, std::vector<Elasticity> materials, const ParameterValues &of) {
            const auto errata =
                of.text(kErrata) == "as_printed" ? reference::Errata::literal() : reference::Errata::corrected();
            return std::make_unique<ThesisBody>(std::move(lattice), std::move(skin), std::move(materials),
                                                static_cast<std::size_t>(of.number(kNeighbours)), errata);
          },
          relax,
          makeObstacle,
          ofObstacles()};
}

/// A class per method.
class BaselinesPlugin {
 public:
  static constexpr sdk::PluginInfo info{.id = "org.c3de.baselines",
                                        .version = "1.0.0",
                                        .displayName = "Methods to compare with",
                                        .vendor = "C3DE",
                                        .license = "Apache-2.0"};
  static constexpr std::array needs{sdk::required<c3de_log_v1>(), sdk::required<c3de_registry_v1>(),
                                    sdk::required<c3de_mesh_v1>(), sdk::optional<c3de_collision_v1>()};

  explicit BaselinesPlugin(sdk::Host host)
      : springs_(host, massSprings()), clusters_(host, shapeMatching()), tetrahedra_(host, tetrahedra()),
        thesis_(host, thesis()) {
    const sdk::Registry registry(host);
    const auto add = [&](std::string_view id, std::string_view label, std::string_view doc, Context &context) {
      sdk::orThrow(registry.add<Simulator>(id, label, doc, context));
    };
    add("c3de.baselines.MassSpring/0", "Mass springs", "Masses and springs on a cubic lattice", springs_);
    add("c3de.baselines.ShapeMatching/0", "Shape matching", "Clusters that draw their points to goals", clusters_);
    add("c3de.baselines.Tetrahedra/0", "Linear tetrahedra", "Finite elements, five to a cell of a lattice",
        tetrahedra_);
    add("c3de.baselines.Thesis/0", "The thesis's method", "Phyxels as the thesis prints them", thesis_);
  }

 private:
  Context springs_, clusters_, tetrahedra_, thesis_;
};

}  // namespace
}  // namespace baselines

C3DE_DEFINE_PLUGIN(baselines::BaselinesPlugin)
