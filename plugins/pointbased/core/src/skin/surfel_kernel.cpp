// SPDX-License-Identifier: Apache-2.0
#include "skin/surfel_kernel.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "skin/surfel_kernel.cpp"
#include "base/kernels/instruction_sets.h"  // first: selects the instruction sets for the code below

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Four components of one point; the fourth is padding.
#if HWY_TARGET == HWY_SCALAR
struct Four {
  float x[4];
};
template <class F>
HWY_INLINE Four each(const F &f) {
  return {{f(0), f(1), f(2), f(3)}};
}
HWY_INLINE Four load(const float *p) { return {{p[0], p[1], p[2], p[3]}}; }
HWY_INLINE Four all(float s) { return {{s, s, s, s}}; }
HWY_INLINE Four sub(const Four &a, const Four &b) {
  return each([&](int k) { return a.x[k] - b.x[k]; });
}
HWY_INLINE Four add(const Four &a, const Four &b) {
  return each([&](int k) { return a.x[k] + b.x[k]; });
}
HWY_INLINE Four mul(const Four &a, const Four &b) {
  return each([&](int k) { return a.x[k] * b.x[k]; });
}
HWY_INLINE Four mulAdd(const Four &a, const Four &b, const Four &c) {
  return each([&](int k) { return a.x[k] * b.x[k] + c.x[k]; });
}
HWY_INLINE Four mulSub(const Four &a, const Four &b, const Four &c) {
  return each([&](int k) { return a.x[k] * b.x[k] - c.x[k]; });
}
HWY_INLINE Four yzx(const Four &a) { return {{a.x[1], a.x[2], a.x[0], a.x[3]}}; }
HWY_INLINE void store(const Four &a, float *p) {
  for (int k = 0; k < 4; ++k) p[k] = a.x[k];
}
#else
using Tag = hn::FixedTag<float, 4>;
using Four = hn::Vec<Tag>;
HWY_INLINE Four load(const float *p) { return hn::LoadU(Tag(), p); }
HWY_INLINE Four all(float s) { return hn::Set(Tag(), s); }
HWY_INLINE Four sub(Four a, Four b) { return hn::Sub(a, b); }
HWY_INLINE Four add(Four a, Four b) { return hn::Add(a, b); }
HWY_INLINE Four mul(Four a, Four b) { return hn::Mul(a, b); }
HWY_INLINE Four mulAdd(Four a, Four b, Four c) { return hn::MulAdd(a, b, c); }
HWY_INLINE Four mulSub(Four a, Four b, Four c) { return hn::MulSub(a, b, c); }
HWY_INLINE Four yzx(Four a) {
  alignas(16) static constexpr int32_t kOrder[4] = {1, 2, 0, 3};
  return hn::TableLookupLanes(a, hn::SetTableIndices(Tag(), kOrder));
}
HWY_INLINE void store(Four a, float *p) { hn::StoreU(a, Tag(), p); }
#endif

HWY_INLINE Four cross(const Four &a, const Four &b) { return yzx(mulSub(a, yzx(b), mul(yzx(a), b))); }

HWY_INLINE void write(const Four &a, Vec3f &out) {
  float numbers[4];
  store(a, numbers);
  out = {numbers[0], numbers[1], numbers[2]};
}

// Writes the unit normal, or the normal at rest if the length is 0.
HWY_INLINE void writeNormal(float x, float y, float z, const Vec3 &rest, Vec3f &out) {
  const float squared = x * x + y * y + z * z;
  if (squared > 0.0f) {
    const float scale = 1.0f / std::sqrt(squared);
    out = {scale * x, scale * y, scale * z};
  } else {
    out = {static_cast<float>(rest[0]), static_cast<float>(rest[1]), static_cast<float>(rest[2])};
  }
}

void moveCells(const SkinJob &job, std::size_t first, std::size_t last) {
  const Four shift = load(std::array<float, 4>{job.shift[0], job.shift[1], job.shift[2], 0.0f}.data());
  for (std::size_t p = first; p < last; ++p) {
    const CellPoint &place = job.cellPoints[p];
    if (place.frame == Surfels::kRow) continue;
    const auto corner = [&](std::size_t j) { return load(job.phyxels[place.phyxels[j]].data()); };
    const Four a = all(static_cast<float>(place.at[0])), b = all(static_cast<float>(place.at[1])),
               c = all(static_cast<float>(place.at[2]));
    // Interpolates along x, then y, then z: the point and its derivatives by the three cell coordinates.
    const Four x0 = corner(0), x2 = corner(2), x4 = corner(4), x6 = corner(6);
    const Four d0 = sub(corner(1), x0), d2 = sub(corner(3), x2), d4 = sub(corner(5), x4), d6 = sub(corner(7), x6);
    const Four y0 = mulAdd(a, d0, x0), y2 = mulAdd(a, d2, x2), y4 = mulAdd(a, d4, x4), y6 = mulAdd(a, d6, x6);
    const Four e0 = sub(y2, y0), e4 = sub(y6, y4);
    const Four z0 = mulAdd(b, e0, y0), z4 = mulAdd(b, e4, y4);
    const Four gz = sub(z4, z0);
    write(add(mulAdd(c, gz, z0), shift), job.positions[p]);
    if (job.restNormals == nullptr) continue;
    const Four gy = mulAdd(c, sub(e4, e0), e0);
    const Four f0 = mulAdd(b, sub(d2, d0), d0), f4 = mulAdd(b, sub(d6, d4), d4);
    const Four gx = mulAdd(c, sub(f4, f0), f0);
    // cof(∂x/∂ξ · ∂ξ/∂X) N = cof(∂x/∂ξ) (cof(∂ξ/∂X) N)
    const Vec3 &rest = job.restNormals[p];
    const float *frame = job.frames[place.frame].data();
    float n[4];
    store(mulAdd(all(static_cast<float>(rest[0])), load(frame),
                 mulAdd(all(static_cast<float>(rest[1])), load(frame + 4),
                        mul(all(static_cast<float>(rest[2])), load(frame + 8)))),
          n);
    store(mulAdd(all(n[0]), cross(gy, gz), mulAdd(all(n[1]), cross(gz, gx), mul(all(n[2]), cross(gx, gy)))), n);
    writeNormal(n[0], n[1], n[2], rest, job.normals[p]);
  }
}

void moveRows(const SkinJob &job, std::size_t first, std::size_t last) {
  for (std::size_t row = first; row < last; ++row) {
    const Index p = job.rowOwners[row];
    // Per component of the point: ∂/∂X, ∂/∂Y, ∂/∂Z and the component.
    Four x = all(0.0f), y = x, z = x;
    for (Index e = job.rowOffsets[row]; e < job.rowOffsets[row + 1]; ++e) {
      const float *at = job.phyxels[job.rowPhyxels[e]].data();
      const Four by = load(job.rowCoefficients[e].data());
      x = mulAdd(all(at[0]), by, x);
      y = mulAdd(all(at[1]), by, y);
      z = mulAdd(all(at[2]), by, z);
    }
    float rx[4], ry[4], rz[4];
    store(x, rx);
    store(y, ry);
    store(z, rz);
    job.positions[p] = {rx[3] + job.shift[0], ry[3] + job.shift[1], rz[3] + job.shift[2]};
    if (job.restNormals == nullptr) continue;
    const Vec3 &rest = job.restNormals[p];
    const float numbers[4] = {static_cast<float>(rest[0]), static_cast<float>(rest[1]), static_cast<float>(rest[2]),
                              0.0f};
    const Four n = load(numbers);
    store(mul(n, cross(y, z)), rx);
    store(mul(n, cross(z, x)), ry);
    store(mul(n, cross(x, y)), rz);
    writeNormal(rx[0] + rx[1] + rx[2], ry[0] + ry[1] + ry[2], rz[0] + rz[1] + rz[2], rest, job.normals[p]);
  }
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointbased::kernels {

HWY_EXPORT(moveCells);
HWY_EXPORT(moveRows);

void moveCellPoints(const SkinJob &job, std::size_t first, std::size_t last) {
  HWY_DYNAMIC_DISPATCH(moveCells)(job, first, last);
}

void moveRowPoints(const SkinJob &job, std::size_t first, std::size_t last) {
  HWY_DYNAMIC_DISPATCH(moveRows)(job, first, last);
}

}  // namespace pointbased::kernels
#endif
