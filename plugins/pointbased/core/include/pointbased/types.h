// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace pointbased {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Index = std::uint32_t;

/// Runs body(begin, end) over disjoint ranges that cover [0, n), possibly on several threads. Every loop of this
/// library writes only data of its range and sums in a fixed order, so results do not depend on the assignment of
/// ranges to threads.
using ParallelFor =
    std::function<void(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)> &body)>;

/// Precision of the force kernels. State, masses, supports and contact are always double.
enum class Precision {
  doublePrecision,
  singlePrecision  ///< about half the time; forces to about 1e-6 of E times the area of a cell
};

[[nodiscard]] inline ParallelFor serialFor() {
  return [](std::size_t n, std::size_t, const std::function<void(std::size_t, std::size_t)> &body) {
    if (n > 0) body(0, n);
  };
}

/// Error text: the quantity, its value and the accepted range.
template <class T>
using Result = tl::expected<T, std::string>;

}  // namespace pointbased
