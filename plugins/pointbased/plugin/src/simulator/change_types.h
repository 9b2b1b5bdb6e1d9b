// SPDX-License-Identifier: Apache-2.0
// Parts of changes, and how types of others are coded.
#pragma once

#include <Eigen/LU>
#include <cmath>
#include <memory>

#include "base/parameters.h"
#include "base/placed_mesh.h"
#include "instruments/grasp.h"
#include "pointbased/machine_speed.h"
#include "pointbased/probe_tool.h"
#include "pointbased/supports.h"
#include "simulator/change_coder.h"

namespace pointbased {

/// A value of a parameter that owns its texts.
struct ParameterEntry {
  std::string id;
  std::uint32_t type = 0;  ///< C3DE_PARAM_*
  double num = 0.0;
  std::string text;
  Vec3 vec = Vec3::Zero();

  ParameterEntry() = default;
  explicit ParameterEntry(const c3de_param_value &value)
      : id(sdk::text(value.id)), type(value.type), num(value.num), text(sdk::text(value.text)), vec(value.vec) {}
  /// Borrowed from this.
  [[nodiscard]] c3de_param_value abi() const {
    return {sizeof(c3de_param_value), type, sdk::str(id), num, sdk::str(text), {vec[0], vec[1], vec[2]}};
  }
  template <class Coder>
  void walk(Coder &coder) {
    coder(id, type, num, text, vec);
  }
};
using ParameterEntries = std::vector<ParameterEntry>;

[[nodiscard]] inline ParameterEntries entriesOf(const ParameterValues &values) {
  ParameterEntries all;
  for (const c3de_param_decl &d : values.declarations()) all.emplace_back(sdk::orThrow(values.get(sdk::text(d.id))));
  return all;
}
/// Throws sdk::Error for values that the declarations do not accept.
[[nodiscard]] inline ParameterValues valuesOf(std::span<const c3de_param_decl> declarations,
                                              const ParameterEntries &entries) {
  ParameterValues values(declarations);
  for (const ParameterEntry &entry : entries) sdk::orThrow(values.set(entry.abi()));
  return values;
}

/// A mesh of the host, in millimetres as the host stores it.
struct MeshData {
  std::vector<Vec3> positions_mm;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  template <class Coder>
  void walk(Coder &coder) {
    coder(positions_mm, triangles);
  }
};
/// Throw sdk::Error.
[[nodiscard]] MeshData dataOf(const Services &services, c3de_handle mesh);
[[nodiscard]] sdk::MeshHandle meshOf(const Services &services, const MeshData &data);

/// What the sampling of a body depends on besides the body: recorded, so that a repetition on another machine has the
/// same phyxels.
struct SamplingInputs {
  ParameterEntries world;
  bool hasObstacles = false;
  MachineSpeed speed;
  std::vector<double> frames_ms;  ///< measured while it was built, in this order
  template <class Coder>
  void walk(Coder &coder) {
    coder(world, hasObstacles, speed, frames_ms);
  }
};

template <class Coder>
void walk(Coder &coder, MachineSpeed &speed) {
  std::uint32_t threads = speed.threads;
  coder(speed.double_ns, speed.single_ns, speed.contact_ns, speed.touch_ns, speed.surfel_ns, threads, speed.kernels);
  speed.threads = threads;
}
template <class Coder>
void walk(Coder &coder, Placement &placement) {
  coder(placement.position, placement.rotation, placement.scale);
}
template <class Coder>
void walk(Coder &coder, RigidMotion &motion) {
  coder(motion.rotation, motion.centre, motion.displacement);
}
template <class Coder>
void walk(Coder &coder, GraspSettings &settings) {
  coder(settings.jaw, settings.opening, settings.closed, settings.forceLimit);
}
template <class Coder>
void walk(Coder &coder, SkinPoint &point) {
  coder(point.corners, point.weights);
}
template <class Coder>
void walk(Coder &coder, JawPositions &jaws) {
  coder(jaws.points, jaws.axis, jaws.normal);
}
template <class Coder>
void walk(Coder &coder, Grab &grab) {
  coder(grab.phyxels, grab.weights, grab.target, grab.arms, grab.rotation, grab.frequency, grab.dampingRatio,
        grab.maxForce);
}
template <class Coder>
void walk(Coder &, EverywhereRegion &) {}
template <class Coder>
void walk(Coder &coder, BoxRegion &box) {
  coder(box.min, box.max);
}
template <class Coder>
void walk(Coder &coder, SphereRegion &sphere) {
  coder(sphere.centre, sphere.radius);
}
template <class Coder>
void walk(Coder &coder, HalfSpaceRegion &half) {
  coder(half.point, half.normal);
}
template <class Coder>
void walk(Coder &coder, Region &region) {
  auto kind = static_cast<std::uint8_t>(region.index());
  coder(kind);
  // A load added at run time accepts no fill, so voxels are not coded.
  static_assert(std::variant_size_v<Region> == 5);
  if (kind > 3) throw sdk::Error(C3DE_E_FORMAT, "a region of the change is of a kind that is not known");
  if constexpr (Coder::kReads) {
    if (kind == 0) region = EverywhereRegion{};
    if (kind == 1) region = BoxRegion{};
    if (kind == 2) region = SphereRegion{};
    if (kind == 3) region = HalfSpaceRegion{};
  }
  std::visit(
      [&coder](auto &one) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(one)>, VoxelRegion>) walk(coder, one);
      },
      region);
}
template <class Coder>
void walk(Coder &coder, Load &load) {
  coder(load.region, load.force, load.pressure, load.follower, load.ramp);
}

// Checks of decoded values. Each throws sdk::Error C3DE_E_FORMAT.
inline void require(bool isGood, const std::string &what) {
  if (!isGood) throw sdk::Error(C3DE_E_FORMAT, "the change is malformed: " + what);
}
template <class... T>
void requireFinite(const std::string &what, const T &...values) {
  const auto finite = [](const auto &value) {
    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>)
      return std::isfinite(value);
    else
      return value.allFinite();
  };
  require((finite(values) && ...), what + " is not finite");
}
/// Jaws on the skin of a body.
void requireJaws(const JawPositions &jaws, const GraspSettings &settings, const Body &body);
/// A rotation matrix to the accuracy of single precision.
inline void requireRotation(const Mat3 &rotation) {
  constexpr double kTolerance = 1e-5;
  require(rotation.allFinite() && (rotation.transpose() * rotation - Mat3::Identity()).norm() < kTolerance &&
              rotation.determinant() > 0.0,
          "a rotation is not one");
}

}  // namespace pointbased
