// SPDX-License-Identifier: Apache-2.0
// 3x3 algebra with one evaluation point per lane. Private to the kernels; compiled once per instruction set.
#if defined(POINTBASED_KERNELS_VECTORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTBASED_KERNELS_VECTORS_INL_H_
#undef POINTBASED_KERNELS_VECTORS_INL_H_
#else
#define POINTBASED_KERNELS_VECTORS_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
using Real = hn::TFromD<D>;

template <class V>
struct Vec3Lanes {
  V x, y, z;
};

/// Columns.
template <class V>
struct Mat3Lanes {
  Vec3Lanes<V> c0, c1, c2;
};

template <class V>
HWY_INLINE Vec3Lanes<V> operator+(const Vec3Lanes<V> &a, const Vec3Lanes<V> &b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class V>
HWY_INLINE Vec3Lanes<V> operator-(const Vec3Lanes<V> &a, const Vec3Lanes<V> &b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class V>
HWY_INLINE Vec3Lanes<V> scaled(V s, const Vec3Lanes<V> &a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
/// s a + b
template <class V>
HWY_INLINE Vec3Lanes<V> mulAdd(V s, const Vec3Lanes<V> &a, const Vec3Lanes<V> &b) {
  return {hn::MulAdd(s, a.x, b.x), hn::MulAdd(s, a.y, b.y), hn::MulAdd(s, a.z, b.z)};
}
template <class V>
HWY_INLINE V dot(const Vec3Lanes<V> &a, const Vec3Lanes<V> &b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
template <class V>
HWY_INLINE Vec3Lanes<V> cross(const Vec3Lanes<V> &a, const Vec3Lanes<V> &b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

template <class V>
HWY_INLINE Mat3Lanes<V> operator+(const Mat3Lanes<V> &a, const Mat3Lanes<V> &b) {
  return {a.c0 + b.c0, a.c1 + b.c1, a.c2 + b.c2};
}
template <class V>
HWY_INLINE Mat3Lanes<V> operator-(const Mat3Lanes<V> &a, const Mat3Lanes<V> &b) {
  return {a.c0 - b.c0, a.c1 - b.c1, a.c2 - b.c2};
}
template <class V>
HWY_INLINE Mat3Lanes<V> scaled(V s, const Mat3Lanes<V> &a) {
  return {scaled(s, a.c0), scaled(s, a.c1), scaled(s, a.c2)};
}
template <class V>
HWY_INLINE Mat3Lanes<V> mulAdd(V s, const Mat3Lanes<V> &a, const Mat3Lanes<V> &b) {
  return {mulAdd(s, a.c0, b.c0), mulAdd(s, a.c1, b.c1), mulAdd(s, a.c2, b.c2)};
}
template <class V>
HWY_INLINE Mat3Lanes<V> transposed(const Mat3Lanes<V> &a) {
  return {{a.c0.x, a.c1.x, a.c2.x}, {a.c0.y, a.c1.y, a.c2.y}, {a.c0.z, a.c1.z, a.c2.z}};
}
template <class V>
HWY_INLINE Vec3Lanes<V> times(const Mat3Lanes<V> &a, const Vec3Lanes<V> &b) {
  return mulAdd(b.x, a.c0, mulAdd(b.y, a.c1, scaled(b.z, a.c2)));
}
template <class V>
HWY_INLINE Mat3Lanes<V> times(const Mat3Lanes<V> &a, const Mat3Lanes<V> &b) {
  return {times(a, b.c0), times(a, b.c1), times(a, b.c2)};
}
/// aᵀ b
template <class V>
HWY_INLINE Vec3Lanes<V> transposeTimes(const Mat3Lanes<V> &a, const Vec3Lanes<V> &b) {
  return {dot(a.c0, b), dot(a.c1, b), dot(a.c2, b)};
}
template <class V>
HWY_INLINE Mat3Lanes<V> transposeTimes(const Mat3Lanes<V> &a, const Mat3Lanes<V> &b) {
  return {transposeTimes(a, b.c0), transposeTimes(a, b.c1), transposeTimes(a, b.c2)};
}
/// a + s 1
template <class V>
HWY_INLINE Mat3Lanes<V> plusDiagonal(const Mat3Lanes<V> &a, V s) {
  Mat3Lanes<V> r = a;
  r.c0.x = hn::Add(r.c0.x, s);
  r.c1.y = hn::Add(r.c1.y, s);
  r.c2.z = hn::Add(r.c2.z, s);
  return r;
}
template <class V>
HWY_INLINE V trace(const Mat3Lanes<V> &a) {
  return hn::Add(hn::Add(a.c0.x, a.c1.y), a.c2.z);
}
template <class V>
HWY_INLINE V squaredNorm(const Mat3Lanes<V> &a) {
  return hn::Add(hn::Add(dot(a.c0, a.c0), dot(a.c1, a.c1)), dot(a.c2, a.c2));
}
template <class V>
HWY_INLINE V product(const Mat3Lanes<V> &a, const Mat3Lanes<V> &b) {
  return hn::Add(hn::Add(dot(a.c0, b.c0), dot(a.c1, b.c1)), dot(a.c2, b.c2));
}
template <class V>
HWY_INLINE Mat3Lanes<V> cofactor(const Mat3Lanes<V> &a) {
  return {cross(a.c1, a.c2), cross(a.c2, a.c0), cross(a.c0, a.c1)};
}
/// d cof(F) for dF
template <class V>
HWY_INLINE Mat3Lanes<V> cofactorDifferential(const Mat3Lanes<V> &F, const Mat3Lanes<V> &dF) {
  return {cross(dF.c1, F.c2) + cross(F.c1, dF.c2), cross(dF.c2, F.c0) + cross(F.c2, dF.c0),
          cross(dF.c0, F.c1) + cross(F.c0, dF.c1)};
}

/// Symmetric.
template <class V>
struct Sym3Lanes {
  V xx, yy, zz, xy, xz, yz;
};
/// aᵀ a
template <class V>
HWY_INLINE Sym3Lanes<V> gram(const Mat3Lanes<V> &a) {
  return {dot(a.c0, a.c0), dot(a.c1, a.c1), dot(a.c2, a.c2), dot(a.c0, a.c1), dot(a.c0, a.c2), dot(a.c1, a.c2)};
}
template <class V>
HWY_INLINE Sym3Lanes<V> operator+(const Sym3Lanes<V> &a, const Sym3Lanes<V> &b) {
  return {hn::Add(a.xx, b.xx), hn::Add(a.yy, b.yy), hn::Add(a.zz, b.zz),
          hn::Add(a.xy, b.xy), hn::Add(a.xz, b.xz), hn::Add(a.yz, b.yz)};
}
template <class V>
HWY_INLINE Sym3Lanes<V> scaled(V s, const Sym3Lanes<V> &a) {
  return {hn::Mul(s, a.xx), hn::Mul(s, a.yy), hn::Mul(s, a.zz), hn::Mul(s, a.xy), hn::Mul(s, a.xz), hn::Mul(s, a.yz)};
}
/// s a + b
template <class V>
HWY_INLINE Sym3Lanes<V> mulAdd(V s, const Sym3Lanes<V> &a, const Sym3Lanes<V> &b) {
  return {hn::MulAdd(s, a.xx, b.xx), hn::MulAdd(s, a.yy, b.yy), hn::MulAdd(s, a.zz, b.zz),
          hn::MulAdd(s, a.xy, b.xy), hn::MulAdd(s, a.xz, b.xz), hn::MulAdd(s, a.yz, b.yz)};
}
template <class V>
HWY_INLINE V squaredNorm(const Sym3Lanes<V> &a) {
  const V across = hn::MulAdd(a.xy, a.xy, hn::MulAdd(a.xz, a.xz, hn::Mul(a.yz, a.yz)));
  return hn::MulAdd(a.xx, a.xx, hn::MulAdd(a.yy, a.yy, hn::MulAdd(a.zz, a.zz, hn::Add(across, across))));
}
template <class V>
HWY_INLINE V trace(const Sym3Lanes<V> &a) {
  return hn::Add(hn::Add(a.xx, a.yy), a.zz);
}
template <class V>
HWY_INLINE Mat3Lanes<V> full(const Sym3Lanes<V> &a) {
  return {{a.xx, a.xy, a.xz}, {a.xy, a.yy, a.yz}, {a.xz, a.yz, a.zz}};
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
