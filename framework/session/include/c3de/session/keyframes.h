// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "c3de/session/change_log.h"
#include "c3de/session/replay.h"

namespace c3de::session {

/// A state of a simulation at a position of its replay.
struct Keyframe {
  Replay::Position at;
  std::string state;                               ///< as stateBytes() gives it
  std::shared_ptr<const SimulationSource> source;  ///< what the simulation was built from up to then
  bool isExtra = false;                            ///< the recorded simulation stored no state here
  bool isVerified = false;                         ///< a recorded state hash after it was equal
};

/// Keyframes in order of their position, within a limit of memory. Where it is exceeded, those closest to their
/// neighbours are removed, so that the rest remains evenly distributed.
class Keyframes {
 public:
  explicit Keyframes(std::size_t limitBytes) : limitBytes_(limitBytes) {}

  /// Replaces one at the same position. One that is larger than the limit is not added.
  void add(std::shared_ptr<Keyframe> keyframe);
  /// The last one up to a position that is accepted; null: none.
  [[nodiscard]] std::shared_ptr<const Keyframe> lastUpTo(std::uint64_t made,
                                                         const std::function<bool(const Keyframe &)> &accepts) const;
  void removeIf(const std::function<bool(const Keyframe &)> &isRemoved);
  /// All between two positions, the first one excluded, are verified.
  void verify(std::uint64_t after, std::uint64_t upTo);
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] const std::vector<std::shared_ptr<Keyframe>> &all() const { return all_; }

 private:
  void thinOut();

  std::size_t limitBytes_, bytes_ = 0;
  std::vector<std::shared_ptr<Keyframe>> all_;
};

}  // namespace c3de::session
