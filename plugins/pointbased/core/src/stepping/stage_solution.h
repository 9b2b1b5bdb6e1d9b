// SPDX-License-Identifier: Apache-2.0
// The solution of one stage of an implicit or static step, with its contacts. Private to the core.
#pragma once

#include "stepping/stage_coupling.h"
#include "stepping/stage_problem.h"

namespace pointbased::detail {

inline constexpr double kContactMargin = 0.02;  ///< spacings

[[nodiscard]] NewtonSettings newtonSettings(const Body &body, const Environment &environment, bool isStatic);
/// Why there is no solution, for a person; empty: there is one.
[[nodiscard]] std::string failureOf(const NewtonResult &result);
/// Contact points that press on something, ascending.
[[nodiscard]] std::vector<Index> pressingPoints(const ContactState &contact);

struct StageRequest {
  double from = 0.0;                     ///< s, or load factor, at which planes of contact are looked for
  std::span<const Vec3> offer = {};      ///< m, or empty: displacements from which the solution may begin
  std::function<bool()> shouldContinue;  ///< asked in every iteration; false: cancelled
  std::function<bool()> goesOn;          ///< asked when the contacts are about known; false: given up unfinished
  double weight = 0.0;                   ///< s, or load factor: for which the forces between bodies count
};

struct StageResult {
  NewtonResult newton;
  std::string passage;  ///< which obstacle a refused solution passes through, for a person; empty: none
};

/// A body with its part of a stage; lengths and times are the same for all.
struct StageMember {
  Body *body = nullptr;
  const Environment *environment = nullptr;
  const ImplicitStage *stage = nullptr;
};

/// Solves a stage with its contacts: Newton for the contacts that are known, then these anew along the way of the
/// solution, until their forces are those it was found with. body.state() is the end of the stage.
/// NewtonResult::worst counts the phyxels of all members.
/// @param coupling  of the members and of those that stand still; null: of one body alone
[[nodiscard]] StageResult solveStage(std::span<const StageMember> members, StageCoupling *coupling,
                                     NewtonSolver &solver, const StageRequest &request);
[[nodiscard]] StageResult solveStage(Body &body, NewtonSolver &solver, const Environment &environment,
                                     const ImplicitStage &stage, const StageRequest &request);

/// Contacts of the body on the straight way from `start` to its present displacements, kept in body.contact.
/// @return whether a point passes a surface
bool findContactsAlong(Body &body, const Environment &environment, std::span<const Vec3> start, double time, double dt);

}  // namespace pointbased::detail
