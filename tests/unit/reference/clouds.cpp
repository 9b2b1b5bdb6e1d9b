// SPDX-License-Identifier: Apache-2.0
#include "clouds.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace clouds {

std::vector<Vec3> block(int nx, int ny, int nz, double spacing, double jitter) {
  std::vector<Vec3> points;
  Random random(5);
  for (int x = 0; x < nx; ++x)
    for (int y = 0; y < ny; ++y)
      for (int z = 0; z < nz; ++z) {
        const Vec3 centre(x + 0.5, y + 0.5, z + 0.5);
        points.push_back(spacing * (centre + jitter * random.vector()));
      }
  return points;
}

Body body(const std::vector<Vec3> &points, double spacing, std::size_t neighbors, const Errata &errata,
          const reference::Material &material) {
  const double cell = spacing * spacing * spacing;
  const std::vector<double> cells(points.size(), cell);
  return reference::buildBody(points, reference::nearestNeighbors(points, neighbors, errata), material, cells,
                              cell * static_cast<double>(points.size()), errata);
}

void deform(Body &body, const std::function<Vec3(const Vec3 &)> &to) {
  for (std::size_t i = 0; i < body.X.size(); ++i) body.u[i] = to(body.X[i]) - body.X[i];
  reference::computeForces(body);
}

Mat3 rotation(double angle, const Vec3 &axis) { return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(); }

double total(const std::vector<double> &values) { return std::accumulate(values.begin(), values.end(), 0.0); }

double largest(const std::vector<Vec3> &vectors) {
  double out = 0.0;
  for (const Vec3 &v : vectors) out = std::max(out, v.norm());
  return out;
}

double difference(const std::vector<Vec3> &a, const std::vector<Vec3> &b) {
  double out = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, (a[i] - b[i]).norm());
  return out / largest(b);
}

}  // namespace clouds
