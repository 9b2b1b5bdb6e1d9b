// SPDX-License-Identifier: Apache-2.0
// Loads and stores corners of cells, and transforms them to sign sums. Private to the kernels.
#if defined(POINTBASED_KERNELS_CORNERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTBASED_KERNELS_CORNERS_INL_H_
#undef POINTBASED_KERNELS_CORNERS_INL_H_
#else
#define POINTBASED_KERNELS_CORNERS_INL_H_
#endif

#include "forces/kernels/slices.h"
#include "forces/kernels/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

template <class D, class T = hn::TFromD<D>>
HWY_INLINE Vec3Lanes<hn::Vec<D>> loadVectors(D d, const T *base, const std::uint16_t *indices) {
  const T *at = base + 4 * std::size_t{indices[0]};
  return {hn::Set(d, at[0]), hn::Set(d, at[1]), hn::Set(d, at[2])};
}

#else

/// A vector whose block b of 128 bits is block(b).
template <class D, class Block>
HWY_INLINE hn::Vec<D> fromBlocks(D d, const Block &block) {
  constexpr std::size_t kBlocks = hn::MaxLanes(D()) * sizeof(hn::TFromD<D>) / 16;
  if constexpr (kBlocks == 1) {
    return block(0);
  } else if constexpr (kBlocks == 2) {
    return hn::Combine(d, block(1), block(0));
  } else {
    static_assert(kBlocks == 4);
    const hn::Half<D> half;
    return hn::Combine(d, hn::Combine(half, block(3), block(2)), hn::Combine(half, block(1), block(0)));
  }
}

/// Loads vectors of phyxels, four numbers each, into one lane per index. Uses 128-bit loads and a transposition,
/// because gather instructions take two to three times as long on some processors.
template <class D>
requires(sizeof(hn::TFromD<D>) == 4) HWY_INLINE Vec3Lanes<hn::Vec<D>> loadVectors(D d, const float *base,
                                                                                  const std::uint16_t *indices) {
  const hn::FixedTag<float, 4> d4;
  const hn::Repartition<double, D> wide;
  const auto column = [&](std::size_t k) HWY_ATTR {
    return fromBlocks(d,
                      [&](std::size_t b) HWY_ATTR { return hn::Load(d4, base + 4 * std::size_t{indices[4 * b + k]}); });
  };
  const auto v0 = column(0), v1 = column(1), v2 = column(2), v3 = column(3);
  const auto xy0 = hn::BitCast(wide, hn::InterleaveLower(d, v0, v1)),
             xy1 = hn::BitCast(wide, hn::InterleaveLower(d, v2, v3));
  const auto z0 = hn::BitCast(wide, hn::InterleaveUpper(d, v0, v1)),
             z1 = hn::BitCast(wide, hn::InterleaveUpper(d, v2, v3));
  return {hn::BitCast(d, hn::InterleaveLower(wide, xy0, xy1)), hn::BitCast(d, hn::InterleaveUpper(wide, xy0, xy1)),
          hn::BitCast(d, hn::InterleaveLower(wide, z0, z1))};
}

template <class D>
requires(sizeof(hn::TFromD<D>) == 8) HWY_INLINE Vec3Lanes<hn::Vec<D>> loadVectors(D d, const double *base,
                                                                                  const std::uint16_t *indices) {
  const hn::FixedTag<double, 2> d2;
  const auto column = [&](std::size_t k, std::size_t part) HWY_ATTR {
    return fromBlocks(
        d, [&](std::size_t b) HWY_ATTR { return hn::Load(d2, base + 4 * std::size_t{indices[2 * b + k]} + part); });
  };
  const auto xy0 = column(0, 0), xy1 = column(1, 0), z0 = column(0, 2), z1 = column(1, 2);
  return {hn::InterleaveLower(d, xy0, xy1), hn::InterleaveUpper(d, xy0, xy1), hn::InterleaveLower(d, z0, z1)};
}

#endif

/// Consecutive records of four numbers: fields of the phyxels of a chunk.
template <class T>
class Records {
#if HWY_TARGET != HWY_SCALAR
  static constexpr bool kWhole = hn::MaxLanes(hn::CappedTag<T, 4>()) == 4;
  static constexpr bool kWholeDouble = hn::MaxLanes(hn::CappedTag<double, 4>()) == 4;
#else
  static constexpr bool kWhole = false, kWholeDouble = false;
#endif

 public:
  /// to += from
  static HWY_INLINE void add(const T *from, T *to) {
    if constexpr (kWhole) {
      const hn::CappedTag<T, 4> d;
      hn::Store(hn::Add(hn::Load(d, to), hn::Load(d, from)), d, to);
    } else {
      for (int c = 0; c < 4; ++c) to[c] += from[c];
    }
  }

  /// to += weight from; the product is rounded separately on every machine.
  static HWY_INLINE void addScaled(T weight, const T *from, T *to) {
    if constexpr (kWhole) {
      const hn::CappedTag<T, 4> d;
      hn::Store(hn::Add(hn::Load(d, to), hn::Mul(hn::Set(d, weight), hn::Load(d, from))), d, to);
    } else {
      for (int c = 0; c < 4; ++c) {
        const T product = weight * from[c];
        to[c] += product;
      }
    }
  }

  /// Vectors of phyxels relative to the first of all, in lattice axes; products and sums are rounded separately on
  /// every machine.
  static HWY_INLINE void load(const PhyxelField &field, const double (&axes)[3][3], bool turned, const Index *phyxels,
                              std::size_t count, T *out) {
    if constexpr (kWholeDouble) {
      using D4 = hn::CappedTag<double, 4>;
      const D4 d;
      HWY_ALIGN double rows[4][4] = {};
      for (int c = 0; c < 3; ++c) {
        rows[3][c] = field.at[c];
        for (int r = 0; r < 3; ++r) rows[r][c] = axes[r][c];
      }
      const auto base = hn::Load(d, rows[3]);
      const auto r0 = hn::Load(d, rows[0]), r1 = hn::Load(d, rows[1]), r2 = hn::Load(d, rows[2]);
      HWY_ALIGN double last[4] = {};
      for (int c = 0; c < 3; ++c) last[c] = field.at[3 * (field.count - 1) + static_cast<std::size_t>(c)];
      for (std::size_t l = 0; l < count; ++l, out += 4) {
        // Four numbers are loaded for each vector of three; the memory may end after the last vector.
        const double *from = phyxels[l] + std::size_t{1} == field.count ? last : field.at + 3 * std::size_t{phyxels[l]};
        auto x = hn::Sub(hn::LoadU(d, from), base);
        if (turned) {
          HWY_ALIGN double three[4];
          hn::Store(x, d, three);
          x = hn::Add(hn::Add(hn::Mul(hn::Set(d, three[0]), r0), hn::Mul(hn::Set(d, three[1]), r1)),
                      hn::Mul(hn::Set(d, three[2]), r2));
        }
        if constexpr (sizeof(T) == 8) {
          hn::Store(x, d, out);
        } else {
          const hn::Rebind<float, D4> narrow;
          hn::Store(hn::DemoteTo(narrow, x), narrow, out);
        }
      }
    } else {
      for (std::size_t l = 0; l < count; ++l, out += 4) {
        double x[3], turnedTo[3];
        for (int c = 0; c < 3; ++c)
          x[c] = field.at[3 * std::size_t{phyxels[l]} + static_cast<std::size_t>(c)] - field.at[c];
        for (int c = 0; c < 3; ++c) turnedTo[c] = (x[0] * axes[0][c] + x[1] * axes[1][c]) + x[2] * axes[2][c];
        for (int c = 0; c < 3; ++c) out[c] = static_cast<T>(turned ? turnedTo[c] : x[c]);
        out[3] = T(0);
      }
    }
  }
};

/// C_s = Σ_j s_j u_j for the products of signs s; the mean is not needed.
template <class V>
struct SignSums {
  V x, y, z, xy, xz, yz, xyz;
};

/// Hadamard transform in three times four sums and differences.
template <class V>
HWY_INLINE SignSums<V> signSums(const V (&u)[8]) {
  const V p01 = hn::Add(u[0], u[1]), p23 = hn::Add(u[2], u[3]), p45 = hn::Add(u[4], u[5]), p67 = hn::Add(u[6], u[7]);
  const V m01 = hn::Sub(u[1], u[0]), m23 = hn::Sub(u[3], u[2]), m45 = hn::Sub(u[5], u[4]), m67 = hn::Sub(u[7], u[6]);
  const V pp0 = hn::Add(p01, p23), pp4 = hn::Add(p45, p67);  // sums over the plane z
  const V y0 = hn::Sub(p23, p01), y4 = hn::Sub(p67, p45);
  const V x0 = hn::Add(m01, m23), x4 = hn::Add(m45, m67);
  const V xy0 = hn::Sub(m23, m01), xy4 = hn::Sub(m67, m45);
  return {hn::Add(x0, x4), hn::Add(y0, y4), hn::Sub(pp4, pp0), hn::Add(xy0, xy4),
          hn::Sub(x4, x0), hn::Sub(y4, y0), hn::Sub(xy4, xy0)};
}

/// f_j = -Σ_s s_j T_s, the transpose.
template <class V>
HWY_INLINE void spreadSigns(const SignSums<V> &t, V (&f)[8]) {
  // f = -(z sz + x sx + y sy + …); first over z, then y, then x.
  const V x0 = hn::Sub(t.xz, t.x), x4 = hn::Neg(hn::Add(t.xz, t.x));  // coefficients of sx at sz = -1 and +1
  const V y0 = hn::Sub(t.yz, t.y), y4 = hn::Neg(hn::Add(t.yz, t.y));
  const V xy0 = hn::Sub(t.xyz, t.xy), xy4 = hn::Neg(hn::Add(t.xyz, t.xy));
  const V c0 = t.z, c4 = hn::Neg(t.z);
  const V c00 = hn::Sub(c0, y0), c02 = hn::Add(c0, y0), c40 = hn::Sub(c4, y4), c42 = hn::Add(c4, y4);
  const V x00 = hn::Sub(x0, xy0), x02 = hn::Add(x0, xy0), x40 = hn::Sub(x4, xy4), x42 = hn::Add(x4, xy4);
  f[0] = hn::Sub(c00, x00);
  f[1] = hn::Add(c00, x00);
  f[2] = hn::Sub(c02, x02);
  f[3] = hn::Add(c02, x02);
  f[4] = hn::Sub(c40, x40);
  f[5] = hn::Add(c40, x40);
  f[6] = hn::Sub(c42, x42);
  f[7] = hn::Add(c42, x42);
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
