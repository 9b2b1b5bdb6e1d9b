// SPDX-License-Identifier: Apache-2.0
#include "pressure_field.h"

#include <cmath>
#include <stdexcept>

namespace validation {

using namespace pointbased;

namespace {

/// Pressures on the grid of the cells, with weights of three neighbours per axis.
class Grid {
 public:
  Grid(SolvedBody &body, PressureAt where, const Vec3 &min, const Vec3 &max, double spacing) {
    const bool corners = where == PressureAt::phyxels;
    for (std::size_t a = 0; a < 3; ++a)
      n_[a] = static_cast<int>(std::lround((max[static_cast<int>(a)] - min[static_cast<int>(a)]) / spacing)) +
              (corners ? 1 : 0);
    p_.assign(static_cast<std::size_t>(n_[0]) * static_cast<std::size_t>(n_[1]) * static_cast<std::size_t>(n_[2]),
              std::nan(""));
    const RestState &rest = body.rest();
    std::vector<Mat3> stresses;
    for (const Mat3 &F : body.body().gradients()) stresses.push_back(cauchyStress(body.body().material(), F));
    if (corners) {
      std::vector<Mat3> means(rest.phyxelCount());
      phyxelMeans(rest, stresses, means);
      stresses = means;
    }
    const std::vector<Vec3> &places = corners ? rest.positions : rest.pointCentres;
    for (std::size_t q = 0; q < places.size(); ++q) {
      const Vec3 t = (places[q] + rest.origin - min) / spacing;
      const auto cell = [&](int a) { return static_cast<int>(corners ? std::lround(t[a]) : std::floor(t[a])); };
      p_.at(index(cell(0), cell(1), cell(2))) = -stresses[q].trace() / 3.0;
    }
    for (const double p : p_)
      if (!std::isfinite(p)) throw std::runtime_error("the lattice does not fit the box");
  }

  [[nodiscard]] int size(int axis) const { return n_[static_cast<std::size_t>(axis)]; }
  [[nodiscard]] double at(int i, int j, int k) const { return p_[index(i, j, k)]; }
  /// Σ w_a w_b w_c p over the 27 cells.
  [[nodiscard]] double filtered(int i, int j, int k, const std::array<std::array<double, 3>, 3> &w) const {
    double sum = 0.0;
    for (int a = -1; a <= 1; ++a)
      for (int b = -1; b <= 1; ++b)
        for (int c = -1; c <= 1; ++c)
          sum += w[0][static_cast<std::size_t>(a + 1)] * w[1][static_cast<std::size_t>(b + 1)] *
                 w[2][static_cast<std::size_t>(c + 1)] * at(i + a, j + b, k + c);
    return sum;
  }

 private:
  [[nodiscard]] std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>((k * n_[1] + j) * n_[0] + i);
  }
  std::array<int, 3> n_{};
  std::vector<double> p_;
};

// 1 for a field that alternates along the axis, 0 for a linear one; and vice versa.
constexpr std::array<double, 3> kAlternates{-0.25, 0.5, -0.25}, kSmooth{0.25, 0.5, 0.25};
constexpr std::array<double, 3> kMean{1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0};  // the linear fit's value at the centre

}  // namespace

Roughness pressureRoughness(SolvedBody &body, PressureAt where, const Vec3 &min, const Vec3 &max, double spacing,
                            int away) {
  const Grid grid(body, where, min, max, spacing);
  Roughness out;
  std::array<double, 8> squares{};  // by which axes alternate
  double pressure = 0.0, off = 0.0, product = 0.0;
  for (int k = away; k < grid.size(2) - away; ++k)
    for (int j = away; j < grid.size(1) - away; ++j)
      for (int i = away; i < grid.size(0) - away; ++i) {
        ++out.cells;
        pressure += grid.at(i, j, k) * grid.at(i, j, k);
        const double d = grid.at(i, j, k) - grid.filtered(i, j, k, {kMean, kMean, kMean});
        off += d * d;
        product += (i + j + k) % 2 == 0 ? d : -d;
        for (unsigned bits = 1; bits < 8; ++bits) {
          std::array<std::array<double, 3>, 3> w{};
          for (unsigned a = 0; a < 3; ++a) w[a] = bits & (1u << a) ? kAlternates : kSmooth;
          const double f = grid.filtered(i, j, k, w);
          squares[bits] += f * f;
        }
      }
  if (out.cells == 0 || !(pressure > 0.0)) throw std::runtime_error("no pressure to look at");
  const auto part = [&](std::initializer_list<unsigned> which) {
    double most = 0.0;
    for (const unsigned bits : which) most = std::max(most, squares[bits]);
    return std::sqrt(most / pressure);
  };
  out.pressure = std::sqrt(pressure / static_cast<double>(out.cells));
  out.checkerboard = part({7});
  out.planes = part({3, 5, 6});
  out.lines = part({1, 2, 4});
  out.offLinear = std::sqrt(off / pressure);
  out.correlation = off > 0.0 ? product / std::sqrt(off * static_cast<double>(out.cells)) : 0.0;
  return out;
}

}  // namespace validation
