// SPDX-License-Identifier: Apache-2.0
// Some lanes of a slice of cells: transforms from the corners to G and back. Private to the kernels.
#if defined(POINTBASED_KERNELS_CELL_RUN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTBASED_KERNELS_CELL_RUN_INL_H_
#undef POINTBASED_KERNELS_CELL_RUN_INL_H_
#else
#define POINTBASED_KERNELS_CELL_RUN_INL_H_
#endif

#include <type_traits>

#include "forces/kernels/corners-inl.h"
#include "forces/kernels/slices.h"
#include "forces/kernels/stress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

/// Fields of the phyxels of the current chunk, and forces of the current slice.
template <class T>
struct ChunkFields {
  const T *displacements = nullptr, *velocities = nullptr;  ///< [locals][4]
  T *entries = nullptr;                                     ///< [kCorners][lanes][4] out
};

/// Coefficients of the mean gradient over the corners: kGradient to kMixedZ.
template <class V>
struct FitRows {
  V g, px, py, pz, mx, my, mz;
};

/// A stress, v P, that is distributed by separate rows.
template <class V>
struct FitStress {
  FitRows<V> rows;
  Mat3Lanes<V> S;
};

template <class D>
struct CellRun {
  using T = Real<D>;
  using V = hn::Vec<D>;
  static constexpr std::size_t kSlice = kLanes<T>;

  D d;
  const CellJob<T> &job;
  const LawNumbers<T> &law;
  const ChunkFields<T> &fields;
  std::size_t slice, lane;
  const T *numbers;

  HWY_INLINE CellRun(D tag, const CellJob<T> &of, const ChunkFields<T> &chunk, std::size_t s, std::size_t l)
      : d(tag), job(of), law(of.laws[of.cells->materials[s]]), fields(chunk), slice(s), lane(l),
        numbers(of.cells->numbers.data() + of.cells->blocks[s] * kCellNumbers * kSlice + l) {}

  HWY_INLINE V number(CellNumber which) const { return hn::Load(d, numbers + which * kSlice); }

  /// Numbers of LaminateNumber; null: every lane has a single material.
  [[nodiscard]] HWY_INLINE const T *laminate() const {
    const Index which = job.cells->laminates[slice];
    return which == kNoLaminate ? nullptr
                                : job.cells->laminateNumbers.data() + which * kLaminateNumbers * kSlice + lane;
  }

  [[nodiscard]] HWY_INLINE std::size_t material() const { return job.cells->materials[slice]; }

  HWY_INLINE void gatherCorners(const T *field, SignSums<V> &x, SignSums<V> &y, SignSums<V> &z) const {
    const std::uint16_t *corners = job.cells->corners.data() + slice * kCorners * kSlice + lane;
    V ux[kCorners], uy[kCorners], uz[kCorners];
    for (std::size_t j = 0; j < kCorners; ++j) {
      const Vec3Lanes<V> u = loadVectors(d, field, corners + j * kSlice);
      ux[j] = u.x;
      uy[j] = u.y;
      uz[j] = u.z;
    }
    x = signSums(ux);
    y = signSums(uy);
    z = signSums(uz);
  }

  HWY_INLINE FitRows<V> rows() const {
    return {number(kGradient), number(kFirstX), number(kFirstY), number(kFirstZ),
            number(kMixedX),   number(kMixedY), number(kMixedZ)};
  }

  // One row of G (and of the amplitudes) per component.
  static HWY_INLINE void fit(const FitRows<V> &r, const SignSums<V> &c, V &gx, V &gy, V &gz) {
    gx = hn::MulAdd(r.g, c.x, hn::MulAdd(r.py, c.xy, hn::MulAdd(r.pz, c.xz, hn::Mul(r.mx, c.xyz))));
    gy = hn::MulAdd(r.g, c.y, hn::MulAdd(r.px, c.xy, hn::MulAdd(r.pz, c.yz, hn::Mul(r.my, c.xyz))));
    gz = hn::MulAdd(r.g, c.z, hn::MulAdd(r.px, c.xz, hn::MulAdd(r.py, c.yz, hn::Mul(r.mz, c.xyz))));
  }

  // Sign sums from one component of the stress and of the conjugates of the modes.
  static HWY_INLINE SignSums<V> unfit(const FitRows<V> &r, V sx, V sy, V sz, V mxy, V mxz, V myz, V mxyz) {
    SignSums<V> t;
    t.x = hn::Mul(r.g, sx);
    t.y = hn::Mul(r.g, sy);
    t.z = hn::Mul(r.g, sz);
    t.xy = hn::MulAdd(r.py, sx, hn::MulAdd(r.px, sy, mxy));
    t.xz = hn::MulAdd(r.pz, sx, hn::MulAdd(r.px, sz, mxz));
    t.yz = hn::MulAdd(r.pz, sy, hn::MulAdd(r.py, sz, myz));
    t.xyz = hn::MulAdd(r.mx, sx, hn::MulAdd(r.my, sy, hn::MulAdd(r.mz, sz, mxyz)));
    return t;
  }

  /// Contribution of modes with these amplitudes to τ v (λ + 2 μ), in the same unit. The second derivative of their
  /// energy by F is that of v s μ |Fᵀa|², which grows with the square of the amplitudes and vanishes at rest.
  HWY_INLINE V hourglassStiffness(const Mat3Lanes<V> &A) const {
    const Vec3Lanes<V> root = roots();
    const V vx = hn::Mul(root.x, root.x), vy = hn::Mul(root.y, root.y), vz = hn::Mul(root.z, root.z);
    const V sum = hn::MulAdd(hn::Add(vx, vy), dot(A.c0, A.c0),
                             hn::MulAdd(hn::Add(vx, vz), dot(A.c1, A.c1), hn::Mul(hn::Add(vy, vz), dot(A.c2, A.c2))));
    return hn::Mul(hn::Set(d, 2 * law.hourglassMu + law.hourglassLambda), sum);
  }

  /// τ v (λ + 2 μ) |g_j|² of the corners, or `atLeast` |g_j|² if that is larger.
  HWY_INLINE void stiffnesses(V ratio, V atLeast, V (&k)[kCorners]) const {
    const V g = number(kGradient);
    V scale = hn::Mul(hn::Mul(ratio, number(kVolume)), hn::Set(d, law.waveAtRest));
    // The maximum of NaN and a number may be the number.
    scale = hn::IfThenElse(hn::Eq(scale, scale), hn::Max(scale, atLeast), scale);
    if (job.cells->whole[job.cells->blocks[slice]] != 0) {
      const V all = hn::Mul(scale, hn::Mul(hn::Set(d, T(3)), hn::Mul(g, g)));
      for (V &at : k) at = all;
      return;
    }
    const V px = number(kFirstX), py = number(kFirstY), pz = number(kFirstZ), zero = hn::Zero(d);
    V gx[kCorners], gy[kCorners], gz[kCorners];  // negated: only squares are used
    spreadSigns(SignSums<V>{g, zero, zero, py, pz, zero, number(kMixedX)}, gx);
    spreadSigns(SignSums<V>{zero, g, zero, px, zero, pz, number(kMixedY)}, gy);
    spreadSigns(SignSums<V>{zero, zero, g, zero, px, py, number(kMixedZ)}, gz);
    for (std::size_t j = 0; j < kCorners; ++j)
      k[j] = hn::Mul(scale, hn::MulAdd(gx[j], gx[j], hn::MulAdd(gy[j], gy[j], hn::Mul(gz[j], gz[j]))));
  }

  HWY_INLINE void scatter(const SignSums<V> &x, const SignSums<V> &y, const SignSums<V> &z,
                          const V (&k)[kCorners]) const {
    V fx[kCorners], fy[kCorners], fz[kCorners];
    spreadSigns(x, fx);
    spreadSigns(y, fy);
    spreadSigns(z, fz);
    T *out = fields.entries + 4 * lane;
    for (std::size_t j = 0; j < kCorners; ++j)
      hn::StoreInterleaved4(fx[j], fy[j], fz[j], k[j], d, out + 4 * j * kSlice);
  }

  static HWY_INLINE Mat3Lanes<V> gradient(const FitRows<V> &r, const SignSums<V> &x, const SignSums<V> &y,
                                          const SignSums<V> &z) {
    Mat3Lanes<V> G;
    fit(r, x, G.c0.x, G.c1.x, G.c2.x);
    fit(r, y, G.c0.y, G.c1.y, G.c2.y);
    fit(r, z, G.c0.z, G.c1.z, G.c2.z);
    return G;
  }
  HWY_INLINE Mat3Lanes<V> gradient(const SignSums<V> &x, const SignSums<V> &y, const SignSums<V> &z) const {
    return gradient(rows(), x, y, z);
  }
  HWY_INLINE Mat3Lanes<V> amplitudes(const SignSums<V> &x, const SignSums<V> &y, const SignSums<V> &z) const {
    const V kxy = number(kModeXY), kxz = number(kModeXZ), kyz = number(kModeYZ);
    return {{hn::Mul(kxy, x.xy), hn::Mul(kxy, y.xy), hn::Mul(kxy, z.xy)},
            {hn::Mul(kxz, x.xz), hn::Mul(kxz, y.xz), hn::Mul(kxz, z.xz)},
            {hn::Mul(kyz, x.yz), hn::Mul(kyz, y.yz), hn::Mul(kyz, z.yz)}};
  }
  HWY_INLINE Vec3Lanes<V> roots() const { return {number(kRootX), number(kRootY), number(kRootZ)}; }
  HWY_INLINE V twist() const { return hn::Mul(hn::Set(d, law.hourglassTwist), number(kTwist)); }

  /// Distributes v P, the conjugates of the modes and those of xyz to the corners.
  /// @param k  stored with the forces
  /// @param more  FitStress
  template <class... More>
  HWY_INLINE void scatterStress(const Mat3Lanes<V> &S, const V (&k)[kCorners], const More &...more) const {
    const V zero = hn::Zero(d);
    const Vec3Lanes<V> none{zero, zero, zero};
    scatterPulled(S, {none, none, none}, none, k, more...);
  }
  template <class... More>
  HWY_INLINE void scatterStress(const Mat3Lanes<V> &S, const Mat3Lanes<V> &pull, const Vec3Lanes<V> &twisted,
                                const V (&k)[kCorners], const More &...more) const {
    scatterPulled(
        S, {scaled(number(kModeXY), pull.c0), scaled(number(kModeXZ), pull.c1), scaled(number(kModeYZ), pull.c2)},
        twisted, k, more...);
  }

 private:
  template <class... More>
  HWY_INLINE void scatterPulled(const Mat3Lanes<V> &S, const Mat3Lanes<V> &m, const Vec3Lanes<V> &xyz,
                                const V (&k)[kCorners], const More &...more) const {
    const FitRows<V> r = rows();
    SignSums<V> x = unfit(r, S.c0.x, S.c1.x, S.c2.x, m.c0.x, m.c1.x, m.c2.x, xyz.x);
    SignSums<V> y = unfit(r, S.c0.y, S.c1.y, S.c2.y, m.c0.y, m.c1.y, m.c2.y, xyz.y);
    SignSums<V> z = unfit(r, S.c0.z, S.c1.z, S.c2.z, m.c0.z, m.c1.z, m.c2.z, xyz.z);
    (addStress(more, x, y, z), ...);
    scatter(x, y, z, k);
  }
  static HWY_INLINE void addStress(const FitStress<V> &of, SignSums<V> &x, SignSums<V> &y, SignSums<V> &z) {
    const auto add = [&](V sx, V sy, V sz, SignSums<V> &to) HWY_ATTR {
      const SignSums<V> t = unfit(of.rows, sx, sy, sz, to.xy, to.xz, to.yz, to.xyz);
      to = {hn::Add(to.x, t.x), hn::Add(to.y, t.y), hn::Add(to.z, t.z), t.xy, t.xz, t.yz, t.xyz};
    };
    add(of.S.c0.x, of.S.c1.x, of.S.c2.x, x);
    add(of.S.c0.y, of.S.c1.y, of.S.c2.y, y);
    add(of.S.c0.z, of.S.c1.z, of.S.c2.z, z);
  }
};

/// Hanging corners of a chunk: they interpolate the fields of the phyxels stored before them, and distribute forces to
/// them.
template <class T>
class HangingLocals {
 public:
  HWY_INLINE HangingLocals(const CellSlices<T> &cells, std::size_t chunk)
      : cells_(cells), first_(cells.firstHanging[chunk]), last_(cells.firstHanging[chunk + 1]),
        phyxels_(cells.firstLocals[chunk + 1] - cells.firstLocals[chunk]) {}
  [[nodiscard]] HWY_INLINE bool any() const { return first_ != last_; }
  [[nodiscard]] HWY_INLINE std::size_t all() const { return phyxels_ + (last_ - first_); }
  HWY_INLINE void follow(T *field) const {
    forAll([&](T *corner, std::size_t phyxel, T weight)
               HWY_ATTR { Records<T>::addScaled(weight, field + 4 * phyxel, corner); },
           field, true);
  }
  HWY_INLINE void handOn(T *sums) const {
    forAll([&](const T *corner, std::size_t phyxel, T weight)
               HWY_ATTR { Records<T>::addScaled(weight, corner, sums + 4 * phyxel); },
           sums, false);
  }

 private:
  template <class Of>
  HWY_INLINE void forAll(const Of &of, T *field, bool clear) const {
    for (std::size_t row = first_; row < last_; ++row) {
      T *corner = field + 4 * (phyxels_ + row - first_);
      if (clear)
        for (int c = 0; c < 4; ++c) corner[c] = T(0);
      for (Index e = cells_.followedRows[row]; e < cells_.followedRows[row + 1]; ++e)
        of(corner, cells_.followed[e], cells_.followedWeights[e]);
    }
  }

  const CellSlices<T> &cells_;
  std::size_t first_, last_, phyxels_;
};

enum class Sums : bool { none, perPhyxel };

/// Calls ofSlice(slice, fields) for the slices of a chunk. With Sums::perPhyxel, fields.entries are then summed for
/// every phyxel of the chunk, slice by slice, corner by corner, lane by lane.
template <Sums kSums, class T, class OfSlice>
HWY_INLINE void forChunk(const CellJob<T> &job, std::size_t chunk, const OfSlice &ofSlice) {
  const CellSlices<T> &cells = *job.cells;
  HWY_ALIGN_MAX T displacements[4 * kMaxLocals];
  HWY_ALIGN_MAX T velocities[4 * kMaxLocals];
  // Padded so that the distance to the displacements is not a multiple of the page size. Otherwise loads wait for
  // stores to addresses that differ by whole pages, which doubles the run time.
  HWY_ALIGN_MAX T padded[4 * kMaxLocals + 2304 / sizeof(T)];
  T *const withHanging = padded + 2304 / sizeof(T);
  HWY_ALIGN_MAX T entries[4 * kCorners * kLanes<T>];
  const std::size_t first = cells.firstLocals[chunk], count = cells.firstLocals[chunk + 1] - first;
  const HangingLocals<T> hanging(cells, chunk);
  const auto load = [&](const PhyxelField &from, T *to) HWY_ATTR {
    Records<T>::load(from, job.axes, job.turned, cells.phyxels.data() + first, count, to);
    hanging.follow(to);
  };
  load(job.displacements, displacements);
  ChunkFields<T> fields{displacements, nullptr, entries};
  if (job.velocities.at) {
    load(job.velocities, velocities);
    fields.velocities = velocities;
  }
  T *sums = hanging.any() ? withHanging : job.partials + 4 * first;
  if constexpr (kSums == Sums::perPhyxel)
    for (std::size_t k = 0; k < 4 * hanging.all(); ++k) sums[k] = T(0);
  const std::size_t end = HWY_MIN(cells.count(), (chunk + 1) * kChunkSlices<T>);
  for (std::size_t slice = chunk * kChunkSlices<T>; slice < end; ++slice) {
    ofSlice(slice, fields);
    if constexpr (kSums == Sums::perPhyxel) {
      const std::uint16_t *corners = cells.corners.data() + slice * kCorners * kLanes<T>;
      for (std::size_t k = 0; k < kCorners * kLanes<T>; ++k)
        Records<T>::add(entries + 4 * k, sums + 4 * std::size_t{corners[k]});
    }
  }
  if constexpr (kSums == Sums::perPhyxel) {
    if (!hanging.any()) return;
    hanging.handOn(sums);
    for (std::size_t k = 0; k < 4 * count; ++k) job.partials[4 * first + k] = sums[k];
  }
}

/// Calls step(run) for all lanes of a slice.
template <class T, class Step>
HWY_INLINE void forLanes(const CellJob<T> &job, const ChunkFields<T> &fields, std::size_t slice, const Step &step) {
  using D = hn::CappedTag<T, kLanes<T>>;
  const D d;
  for (std::size_t lane = 0; lane < kLanes<T>; lane += hn::Lanes(d)) step(CellRun<D>(d, job, fields, slice, lane));
}

/// Sets job.energies of a slice: energies(run, strain, modes) of its lanes, J.
template <class T, class Energies>
HWY_INLINE void storeEnergies(const CellJob<T> &job, const ChunkFields<T> &fields, std::size_t slice,
                              const Energies &energies) {
  HWY_ALIGN T strain[kLanes<T>];
  HWY_ALIGN T modes[kLanes<T>];
  forLanes(job, fields, slice, [&](const auto &run) HWY_ATTR {
    hn::Vec<std::remove_const_t<decltype(run.d)>> strainEnergy, hourglassEnergy;
    energies(run, strainEnergy, hourglassEnergy);
    hn::Store(strainEnergy, run.d, strain + run.lane);
    hn::Store(hourglassEnergy, run.d, modes + run.lane);
  });
  // Summed sequentially: the same result for any register width.
  double strainSum = 0.0, hourglassSum = 0.0;
  for (std::size_t lane = 0; lane < kLanes<T>; ++lane) {
    strainSum += static_cast<double>(strain[lane]);
    hourglassSum += static_cast<double>(modes[lane]);
  }
  job.energies[2 * slice] = strainSum;
  job.energies[2 * slice + 1] = hourglassSum;
}

/// Calls of(law, slice, fields) for the slices of some chunks.
template <Sums kSums, class T, class Of>
HWY_INLINE void forSlices(const CellJob<T> &job, std::size_t begin, std::size_t end, const Of &of) {
  for (std::size_t chunk = begin; chunk < end; ++chunk)
    forChunk<kSums>(job, chunk, [&](std::size_t slice, const ChunkFields<T> &fields) HWY_ATTR {
      withLaw(job.laws[job.cells->materials[slice]].law, [&](auto law) HWY_ATTR { of(law, slice, fields); });
    });
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
