// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>

#include "pointbased/fields.h"

namespace pointbased {

/// How the evaluation points of bodies follow their phyxels (bindPoints()), cached between queries. The mutex of
/// SimulatedWorld is held in every call.
class EvaluationPoints {
 public:
  /// Valid until the next call.
  [[nodiscard]] const Interpolation &of(std::uint64_t body, const std::shared_ptr<const RestState> &rest) {
    Bound &bound = bound_[body];
    if (bound.rest != rest) bound = {rest, bindPoints(*rest)};
    return bound.points;
  }
  /// Called for a body that has been removed.
  void forget(std::uint64_t body) { bound_.erase(body); }

 private:
  struct Bound {
    std::shared_ptr<const RestState> rest;
    Interpolation points;
  };
  std::map<std::uint64_t, Bound> bound_;
};

}  // namespace pointbased
