// SPDX-License-Identifier: Apache-2.0
// Small clouds for the tests of the reference.
#pragma once

#include <functional>

#include "reference/body.h"
#include "support/random.h"

namespace clouds {

using reference::Body;
using reference::Errata;
using reference::Mat3;
using reference::Vec3;
using support::Random;

/// A block of nx x ny x nz cell centres, x outermost; jitter is a fraction of the spacing.
[[nodiscard]] std::vector<Vec3> block(int nx, int ny, int nz, double spacing, double jitter = 0.0);

/// A body of these points, with equal cells of spacing³.
[[nodiscard]] Body body(const std::vector<Vec3> &points, double spacing, std::size_t neighbors, const Errata &errata,
                        const reference::Material &material = {});

/// u = to(X) - X, and the forces there.
void deform(Body &body, const std::function<Vec3(const Vec3 &)> &to);

[[nodiscard]] Mat3 rotation(double angle, const Vec3 &axis);
[[nodiscard]] double total(const std::vector<double> &values);
[[nodiscard]] double largest(const std::vector<Vec3> &vectors);
/// Largest |a - b| over the largest |b|.
[[nodiscard]] double difference(const std::vector<Vec3> &a, const std::vector<Vec3> &b);

}  // namespace clouds
