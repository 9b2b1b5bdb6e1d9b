// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "base/services.h"

namespace pointbased {

/// Creates and moves what tools draw under a scene node: lines, labels, arrows, handles. Main thread.
class DrawnMarks {
 public:
  DrawnMarks(const Services &services, c3de_handle node) : services_(services), node_(node) {}

  /// Between pairs of points, m.
  void lines(sdk::Proxy &lines, std::span<const Vec3> points, const sdk::Material &material) const;
  /// A text at a position, m.
  void label(sdk::Proxy &label, const Vec3 &at, const std::string &text, const sdk::Material &material) const;
  /// m; removes it if its length is zero.
  void arrow(sdk::Proxy &arrow, const Vec3 &from, const Vec3 &vector, const sdk::Material &material) const;
  /// @param radius  m, when it is created
  void sphere(sdk::Proxy &sphere, const Vec3 &at, double radius, const sdk::Material &material) const;

 private:
  const Services &services_;
  c3de_handle node_;
};

}  // namespace pointbased
