// SPDX-License-Identifier: Apache-2.0
// What acts on a simulation apart from its scene, as part of a saved state: instrument, jaws, holds, loads. The grabs
// themselves are in the bytes of StateArchive; they are found by their ids when the state was saved.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "simulator/change_types.h"
#include "simulator/object_name.h"
#include "simulator/surface_condition.h"

namespace pointbased {

/// The interactive instrument, where it was placed; its motion is in the bytes of StateArchive.
struct SavedInstrument {
  std::string name;
  double radius = 0.0, length = 0.0, friction = 0.0;  ///< of ProbeTool
  ToolPose pose;
  template <class Coder>
  void walk(Coder &coder) {
    coder(name, radius, length, friction, pose.time, pose.at, pose.axis);
  }
};

struct SavedGrasp {
  std::string name;  ///< of the scene; empty: interactive
  std::uint64_t id = 0;
  bool isReleased = false;
  /// Grasp, without its grabs.
  struct Closing {
    ObjectName body;
    JawPositions jaws;
    GraspSettings settings;
    std::array<Vec3, 2> offsets;
    Vec3 middle = Vec3::Zero();
    Mat3 rotation = Mat3::Identity();
    double initialGap = 0.0, targetGap = 0.0, commandedGap = 0.0;
    template <class Coder>
    void walk(Coder &coder) {
      coder(body, jaws, settings, offsets, middle, rotation, initialGap, targetGap, commandedGap);
    }
  };
  std::optional<Closing> now;
  template <class Coder>
  void walk(Coder &coder) {
    coder(name, id, isReleased, now);
  }
};

/// A hold of another plugin (iface.simulator).
struct SavedHold {
  std::uint64_t number = 0;
  ObjectName body;
  Vec3 fromNamed = Vec3::Zero(), target = Vec3::Zero();
  Mat3 rotation = Mat3::Identity();
  bool keepsShape = false;
  template <class Coder>
  void walk(Coder &coder) {
    coder(number, body, fromNamed, target, rotation, keepsShape);
  }
};

/// A load added while the body is simulated.
struct SavedLoad {
  std::uint64_t number = 0;
  ObjectName body;
  Load load;
  double startTime_s = 0.0;
  template <class Coder>
  void walk(Coder &coder) {
    coder(number, body, load, startTime_s);
  }
};

/// A support or load on a part of a surface, with what its ramp starts from.
struct SavedCondition {
  std::uint64_t number = 0;
  SurfaceCondition condition;
  struct Start {
    double time = 0.0;                ///< s, or load factor
    Vec3 vector = Vec3::Zero();       ///< N or m
    double pressure = 0.0;            ///< Pa
    std::vector<Vec3> displacements;  ///< [points of the patch] m, of a support; empty: zero
    template <class Coder>
    void walk(Coder &coder) {
      coder(time, vector, pressure, displacements);
    }
  } start;
  template <class Coder>
  void walk(Coder &coder) {
    coder(number, condition, start);
  }
};

/// Forces that hold a body in a matched state.
struct SavedMatch {
  ObjectName body;
  std::vector<Vec3> forces;  ///< [phyxels] N
  template <class Coder>
  void walk(Coder &coder) {
    coder(body, forces);
  }
};

struct SavedInteractions {
  std::vector<SavedInstrument> instruments;
  std::vector<SavedGrasp> grasps;
  std::vector<SavedHold> holds;
  std::vector<SavedLoad> loads;
  std::vector<SavedCondition> conditions;
  std::vector<SavedMatch> matches;
  /// States of earlier versions end before the conditions or matches, and so do states without any.
  template <class Coder>
  void walk(Coder &coder) {
    coder(instruments, grasps, holds, loads);
    if (Coder::kReads ? !coder.isAtEnd() : !conditions.empty() || !matches.empty()) coder(conditions);
    if (Coder::kReads ? !coder.isAtEnd() : !matches.empty()) coder(matches);
  }
};

}  // namespace pointbased
