// SPDX-License-Identifier: Apache-2.0
// Solution of one stage of an implicit or static step, including its contacts. Private to the core.
#pragma once

#include "stepping/implicit/stage_coupling.h"
#include "stepping/implicit/stage_problem.h"

namespace pointbased::detail {

inline constexpr double kContactMargin = 0.02;  ///< spacings

[[nodiscard]] NewtonSettings newtonSettings(const Body &body, const Environment &environment, bool isStatic);
/// Why there is no solution, as text; empty: there is one.
[[nodiscard]] std::string failureOf(const NewtonResult &result);
/// Contact points with a contact force, ascending.
[[nodiscard]] std::vector<Index> pointsInContact(const ContactState &contact);

struct StageRequest {
  double from = 0.0;                        ///< s, or load factor, for which contact planes are searched
  std::span<const Vec3> initialGuess = {};  ///< m, or empty: displacements from which the solution may start
  std::function<bool()> shouldContinue;     ///< called in every iteration; false: cancelled
  std::function<bool()> shouldFinish;       ///< called when the contacts are nearly known; false: abandoned unfinished
  double weight = 0.0;                      ///< s, or load factor: duration of the forces between bodies
};

struct StageResult {
  NewtonResult newton;
  std::string passage;  ///< obstacle that a refused solution passes through, for a person; empty: none
};

/// A body with its part of a stage; the lengths and times of the stages of all members are equal.
struct StageMember {
  Body *body = nullptr;
  const Environment *environment = nullptr;
  const ImplicitStage *stage = nullptr;
};

/// Solves a stage including its contacts. Newton's method for the known contacts and a new contact search along the
/// path of the solution alternate until the contact forces agree with those of the solution. body.state() is the end of
/// the stage. NewtonResult::worst counts the phyxels of all members.
/// @param coupling  of the members and of static bodies; null: a single body
[[nodiscard]] StageResult solveStage(std::span<const StageMember> members, StageCoupling *coupling,
                                     NewtonSolver &solver, const StageRequest &request);
[[nodiscard]] StageResult solveStage(Body &body, NewtonSolver &solver, const Environment &environment,
                                     const ImplicitStage &stage, const StageRequest &request);

/// Finds contacts of the body on the straight path from `start` to its present displacements, stored in body.contact.
/// @return  whether a point passes a surface
bool findContactsAlong(Body &body, const Environment &environment, std::span<const Vec3> start, double time, double dt);

}  // namespace pointbased::detail
