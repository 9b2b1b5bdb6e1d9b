// SPDX-License-Identifier: Apache-2.0
// Numbers for tests that are the same on every machine.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace support {

/// Reproducible numbers in [-1, 1).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double operator()() {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state_ >> 11) / static_cast<double>(1ull << 52) - 1.0;
  }
  Eigen::Vector3d vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace support
