// SPDX-License-Identifier: Apache-2.0
// Some lanes of a slice of cells with functions of second order: transforms from corners and edges to G and the second
// derivatives, and back. Private to the kernels.
#if defined(POINTBASED_KERNELS_QUADRATIC_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTBASED_KERNELS_QUADRATIC_INL_H_
#undef POINTBASED_KERNELS_QUADRATIC_INL_H_
#else
#define POINTBASED_KERNELS_QUADRATIC_INL_H_
#endif

#include "forces/kernels/cell_run-inl.h"
#include "forces/kernels/quadratic_slices.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

/// B_0, B_i, B_j and B_ij of the edges along an axis.
template <class V>
struct EdgeSums {
  V sum, i, j, ij;
};
template <class V>
HWY_INLINE EdgeSums<V> edgeSums(const V (&e)[4]) {
  const V low = hn::Add(e[0], e[1]), high = hn::Add(e[2], e[3]);
  const V lowChange = hn::Sub(e[1], e[0]), highChange = hn::Sub(e[3], e[2]);
  return {hn::Add(low, high), hn::Add(lowChange, highChange), hn::Sub(high, low), hn::Sub(highChange, lowChange)};
}
/// f = -(sum + s_i i + s_j j + s_i s_j ij), the transpose.
template <class V>
HWY_INLINE void spreadEdges(const EdgeSums<V> &t, V (&f)[4]) {
  const V low = hn::Sub(t.sum, t.j), high = hn::Add(t.sum, t.j);
  const V lowChange = hn::Sub(t.i, t.ij), highChange = hn::Add(t.i, t.ij);
  f[0] = hn::Sub(lowChange, low);
  f[1] = hn::Neg(hn::Add(low, lowChange));
  f[2] = hn::Sub(highChange, high);
  f[3] = hn::Neg(hn::Add(high, highChange));
}

/// Second derivatives: xx, yy, zz, xy, xz, yz.
template <class V>
struct SecondLanes {
  Vec3Lanes<V> xx, yy, zz, xy, xz, yz;
};
template <class V>
HWY_INLINE SecondLanes<V> operator+(const SecondLanes<V> &a, const SecondLanes<V> &b) {
  return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
}
template <class V>
HWY_INLINE SecondLanes<V> times(const Mat3Lanes<V> &a, const SecondLanes<V> &b) {
  return {times(a, b.xx), times(a, b.yy), times(a, b.zz), times(a, b.xy), times(a, b.xz), times(a, b.yz)};
}
/// aᵀ b
template <class V>
HWY_INLINE SecondLanes<V> transposeTimes(const Mat3Lanes<V> &a, const SecondLanes<V> &b) {
  return {transposeTimes(a, b.xx), transposeTimes(a, b.yy), transposeTimes(a, b.zz),
          transposeTimes(a, b.xy), transposeTimes(a, b.xz), transposeTimes(a, b.yz)};
}
/// a bᵀ
template <class V>
HWY_INLINE Mat3Lanes<V> timesTransposed(const SecondLanes<V> &a, const SecondLanes<V> &b) {
  const auto column = [&](V xx, V yy, V zz, V xy, V xz, V yz) HWY_ATTR {
    return mulAdd(xx, a.xx, mulAdd(yy, a.yy, mulAdd(zz, a.zz, mulAdd(xy, a.xy, mulAdd(xz, a.xz, scaled(yz, a.yz))))));
  };
  return {column(b.xx.x, b.yy.x, b.zz.x, b.xy.x, b.xz.x, b.yz.x),
          column(b.xx.y, b.yy.y, b.zz.y, b.xy.y, b.xz.y, b.yz.y),
          column(b.xx.z, b.yy.z, b.zz.z, b.xy.z, b.xz.z, b.yz.z)};
}
template <class V>
HWY_INLINE V product(const SecondLanes<V> &a, const SecondLanes<V> &b) {
  return hn::Add(hn::Add(hn::Add(dot(a.xx, b.xx), dot(a.yy, b.yy)), hn::Add(dot(a.zz, b.zz), dot(a.xy, b.xy))),
                 hn::Add(dot(a.xz, b.xz), dot(a.yz, b.yz)));
}

/// G = F - 1, second derivatives times h/2, and Σ s u of the mode xyz.
template <class V>
struct SecondOrderFit {
  Mat3Lanes<V> G;
  SecondLanes<V> H;
  Vec3Lanes<V> xyz;
};

template <class D>
struct QuadraticRun {
  using T = Real<D>;
  using V = hn::Vec<D>;
  static constexpr std::size_t kSlice = kLanes<T>;

  D d;
  CellRun<D> cell;
  const QuadraticSlices<T> &second;
  const T *numbers;
  FitRows<V> rows;

  HWY_INLINE QuadraticRun(const CellRun<D> &run, const QuadraticSlices<Real<D>> &of)
      : d(run.d), cell(run), second(of), numbers(of.numbers.data() + run.slice * kQuadraticNumbers * kSlice + run.lane),
        rows(run.rows()) {}

  HWY_INLINE V number(std::size_t which) const { return hn::Load(d, numbers + which * kSlice); }

  // What does not depend on the law is no part of the functions of each law: these are large enough.
  HWY_NOINLINE SecondOrderFit<V> fit(const T *field) const {
    SignSums<V> x, y, z;
    cell.gatherCorners(field, x, y, z);
    Component cx(*this, x), cy(*this, y), cz(*this, z);
    addEdges<0>(field, cx, cy, cz);
    addEdges<1>(field, cx, cy, cz);
    addEdges<2>(field, cx, cy, cz);
    return {{{cx.gx, cy.gx, cz.gx}, {cx.gy, cy.gy, cz.gy}, {cx.gz, cy.gz, cz.gz}},
            {{cx.xx, cy.xx, cz.xx},
             {cx.yy, cy.yy, cz.yy},
             {cx.zz, cy.zz, cz.zz},
             {cx.xy, cy.xy, cz.xy},
             {cx.xz, cy.xz, cz.xz},
             {cx.yz, cy.yz, cz.yz}},
            {x.xyz, y.xyz, z.xyz}};
  }

  /// dU/dB of QuadraticEnergy for moduli of HourglassEnergy, Pa.
  HWY_NOINLINE SecondLanes<V> conjugate(T ofMu, T ofLambda, const SecondLanes<V> &B) const {
    const Sym3Lanes<V> ex = symmetric(B.xx, B.xy, B.xz), ey = symmetric(B.xy, B.yy, B.yz),
                       ez = symmetric(B.xz, B.yz, B.zz);
    const V xx = number(kCovariance), yy = number(kCovariance + 1), zz = number(kCovariance + 2),
            xy = number(kCovariance + 3), xz = number(kCovariance + 4), yz = number(kCovariance + 5);
    const V two = hn::Set(d, 2 * ofMu), lambda = hn::Set(d, ofLambda);
    const auto stress = [&](V a, V b, V c) HWY_ATTR {
      const Sym3Lanes<V> mean = mulAdd(a, ex, mulAdd(b, ey, scaled(c, ez)));
      Sym3Lanes<V> out = scaled(two, mean);
      const V pressure = hn::Mul(lambda, trace(mean));
      out.xx = hn::Add(out.xx, pressure);
      out.yy = hn::Add(out.yy, pressure);
      out.zz = hn::Add(out.zz, pressure);
      return out;
    };
    const Sym3Lanes<V> sx = stress(xx, xy, xz), sy = stress(xy, yy, yz), sz = stress(xz, yz, zz);
    return {{sx.xx, sx.xy, sx.xz},
            {sy.xy, sy.yy, sy.yz},
            {sz.xz, sz.yz, sz.zz},
            {hn::Add(sx.xy, sy.xx), hn::Add(sx.yy, sy.xy), hn::Add(sx.yz, sy.xz)},
            {hn::Add(sx.xz, sz.xx), hn::Add(sx.yz, sz.xy), hn::Add(sx.zz, sz.xz)},
            {hn::Add(sy.xz, sz.xy), hn::Add(sy.yz, sz.yy), hn::Add(sy.zz, sz.yz)}};
  }
  HWY_INLINE SecondLanes<V> conjugate(const SecondLanes<V> &B) const {
    return conjugate(cell.law.hourglassMu, cell.law.hourglassLambda, B);
  }

  /// CellRun::hourglassStiffness() with the trace of the covariance, which bounds it in any direction.
  HWY_INLINE V secondStiffness(const SecondLanes<V> &H) const {
    const V across = hn::Add(hn::Add(dot(H.xy, H.xy), dot(H.xz, H.xz)), dot(H.yz, H.yz));
    const V sum = hn::Add(hn::Add(hn::Add(dot(H.xx, H.xx), dot(H.yy, H.yy)), dot(H.zz, H.zz)), hn::Add(across, across));
    const V extent = hn::Add(hn::Add(number(kCovariance), number(kCovariance + 1)), number(kCovariance + 2));
    return hn::Mul(hn::Mul(hn::Set(d, 2 * cell.law.hourglassMu + cell.law.hourglassLambda), extent), sum);
  }

  /// Distributes v P, the conjugates of H and those of xyz to corners and edges.
  /// @param k  stored with the forces of the corners
  HWY_NOINLINE void scatter(const Mat3Lanes<V> &S, const SecondLanes<V> &pull, const Vec3Lanes<V> &twisted,
                            const V (&k)[kCorners]) const {
    const Component cx{S.c0.x, S.c1.x, S.c2.x, pull.xx.x, pull.yy.x, pull.zz.x, pull.xy.x, pull.xz.x, pull.yz.x},
        cy{S.c0.y, S.c1.y, S.c2.y, pull.xx.y, pull.yy.y, pull.zz.y, pull.xy.y, pull.xz.y, pull.yz.y},
        cz{S.c0.z, S.c1.z, S.c2.z, pull.xx.z, pull.yy.z, pull.zz.z, pull.xy.z, pull.xz.z, pull.yz.z};
    cell.scatter(cornerSums(cx, twisted.x), cornerSums(cy, twisted.y), cornerSums(cz, twisted.z), k);
    scatterEdges<0>(cx, cy, cz);
    scatterEdges<1>(cx, cy, cz);
    scatterEdges<2>(cx, cy, cz);
  }

 private:
  // One component of the rows of G and H, or of their conjugates.
  struct Component {
    V gx, gy, gz, xx, yy, zz, xy, xz, yz;

    HWY_INLINE Component(V ofX, V ofY, V ofZ, V ofXX, V ofYY, V ofZZ, V ofXY, V ofXZ, V ofYZ)
        : gx(ofX), gy(ofY), gz(ofZ), xx(ofXX), yy(ofYY), zz(ofZZ), xy(ofXY), xz(ofXZ), yz(ofYZ) {}
    HWY_INLINE Component(const QuadraticRun &run, const SignSums<V> &c) {
      const FitRows<V> &r = run.rows;
      CellRun<D>::fit(r, c, gx, gy, gz);
      xx = yy = zz = hn::Zero(run.d);
      xy = hn::MulAdd(r.g, c.xy, hn::Mul(r.pz, c.xyz));
      xz = hn::MulAdd(r.g, c.xz, hn::Mul(r.py, c.xyz));
      yz = hn::MulAdd(r.g, c.yz, hn::Mul(r.px, c.xyz));
    }
    template <std::size_t kAxis>
    HWY_INLINE V &gradient() {
      return kAxis == 0 ? gx : kAxis == 1 ? gy : gz;
    }
    template <std::size_t kAxis>
    HWY_INLINE V gradient() const {
      return kAxis == 0 ? gx : kAxis == 1 ? gy : gz;
    }
    // Of the pair of axes kA and kB.
    template <std::size_t kA, std::size_t kB>
    HWY_INLINE V &derivative() {
      if constexpr (kA == kB) return kA == 0 ? xx : kA == 1 ? yy : zz;
      return kA + kB == 1 ? xy : kA + kB == 2 ? xz : yz;
    }
    template <std::size_t kA, std::size_t kB>
    HWY_INLINE V derivative() const {
      if constexpr (kA == kB) return kA == 0 ? xx : kA == 1 ? yy : zz;
      return kA + kB == 1 ? xy : kA + kB == 2 ? xz : yz;
    }
  };

  // Coefficients of the edges along an axis; see QuadraticNumber.
  struct AxisRows {
    V g, fa, fi, fj, ma, mi, mj, triple, square, cubicI, cubicJ;
  };
  template <std::size_t kAxis>
  HWY_INLINE V first() const {
    return kAxis == 0 ? rows.px : kAxis == 1 ? rows.py : rows.pz;
  }
  template <std::size_t kAxis>
  HWY_INLINE V mixed() const {
    return kAxis == 0 ? rows.mx : kAxis == 1 ? rows.my : rows.mz;
  }
  template <std::size_t kAxis>
  HWY_INLINE AxisRows axisRows() const {
    constexpr std::size_t kI = (kAxis + 1) % 3, kJ = (kAxis + 2) % 3;
    return {rows.g,
            first<kAxis>(),
            first<kI>(),
            first<kJ>(),
            mixed<kAxis>(),
            mixed<kI>(),
            mixed<kJ>(),
            number(kTriple),
            number(kSquare + kAxis),
            number(kCubic + 2 * kAxis),
            number(kCubic + 2 * kAxis + 1)};
  }

  template <std::size_t kAxis>
  HWY_INLINE const std::uint16_t *edges() const {
    return second.edges.data() + (cell.slice * kCellEdges + 4 * kAxis) * kSlice + cell.lane;
  }

  template <std::size_t kAxis>
  HWY_INLINE void addEdges(const T *field, Component &x, Component &y, Component &z) const {
    V ex[4], ey[4], ez[4];
    for (std::size_t e = 0; e < 4; ++e) {
      const Vec3Lanes<V> at = loadVectors(d, field, edges<kAxis>() + e * kSlice);
      ex[e] = at.x;
      ey[e] = at.y;
      ez[e] = at.z;
    }
    const AxisRows r = axisRows<kAxis>();
    add<kAxis>(r, edgeSums(ex), x);
    add<kAxis>(r, edgeSums(ey), y);
    add<kAxis>(r, edgeSums(ez), z);
  }
  template <std::size_t kAxis>
  static HWY_INLINE void add(const AxisRows &r, const EdgeSums<V> &e, Component &to) {
    constexpr std::size_t kI = (kAxis + 1) % 3, kJ = (kAxis + 2) % 3;
    V &ga = to.template gradient<kAxis>(), &gi = to.template gradient<kI>(), &gj = to.template gradient<kJ>();
    ga = hn::MulAdd(r.fa, e.sum, hn::MulAdd(r.mj, e.i, hn::MulAdd(r.mi, e.j, hn::MulAdd(r.triple, e.ij, ga))));
    gi = hn::MulAdd(r.square, e.i, hn::MulAdd(r.cubicJ, e.ij, gi));
    gj = hn::MulAdd(r.square, e.j, hn::MulAdd(r.cubicI, e.ij, gj));
    V &aa = to.template derivative<kAxis, kAxis>(), &ai = to.template derivative<kAxis, kI>(),
      &aj = to.template derivative<kAxis, kJ>(), &ij = to.template derivative<kI, kJ>();
    aa = hn::MulAdd(r.g, e.sum, hn::MulAdd(r.fi, e.i, hn::MulAdd(r.fj, e.j, hn::Mul(r.ma, e.ij))));
    ai = hn::MulAdd(r.fa, e.i, hn::MulAdd(r.mi, e.ij, ai));
    aj = hn::MulAdd(r.fa, e.j, hn::MulAdd(r.mj, e.ij, aj));
    ij = hn::MulAdd(r.square, e.ij, ij);
  }

  HWY_INLINE SignSums<V> cornerSums(const Component &c, V twisted) const {
    return CellRun<D>::unfit(rows, c.gx, c.gy, c.gz, hn::Mul(rows.g, c.xy), hn::Mul(rows.g, c.xz),
                             hn::Mul(rows.g, c.yz),
                             hn::MulAdd(rows.pz, c.xy, hn::MulAdd(rows.py, c.xz, hn::MulAdd(rows.px, c.yz, twisted))));
  }
  template <std::size_t kAxis>
  static HWY_INLINE EdgeSums<V> sums(const AxisRows &r, const Component &c) {
    constexpr std::size_t kI = (kAxis + 1) % 3, kJ = (kAxis + 2) % 3;
    const V ga = c.template gradient<kAxis>(), gi = c.template gradient<kI>(), gj = c.template gradient<kJ>(),
            aa = c.template derivative<kAxis, kAxis>(), ai = c.template derivative<kAxis, kI>(),
            aj = c.template derivative<kAxis, kJ>(), ij = c.template derivative<kI, kJ>();
    EdgeSums<V> t;
    t.sum = hn::MulAdd(r.fa, ga, hn::Mul(r.g, aa));
    t.i = hn::MulAdd(r.mj, ga, hn::MulAdd(r.square, gi, hn::MulAdd(r.fi, aa, hn::Mul(r.fa, ai))));
    t.j = hn::MulAdd(r.mi, ga, hn::MulAdd(r.square, gj, hn::MulAdd(r.fj, aa, hn::Mul(r.fa, aj))));
    t.ij = hn::MulAdd(
        r.triple, ga,
        hn::MulAdd(
            r.cubicJ, gi,
            hn::MulAdd(r.cubicI, gj,
                       hn::MulAdd(r.ma, aa, hn::MulAdd(r.mi, ai, hn::MulAdd(r.mj, aj, hn::Mul(r.square, ij)))))));
    return t;
  }
  template <std::size_t kAxis>
  HWY_INLINE void scatterEdges(const Component &x, const Component &y, const Component &z) const {
    const AxisRows r = axisRows<kAxis>();
    V fx[4], fy[4], fz[4];
    spreadEdges(sums<kAxis>(r, x), fx);
    spreadEdges(sums<kAxis>(r, y), fy);
    spreadEdges(sums<kAxis>(r, z), fz);
    T *out = cell.fields.entries + 4 * ((kCorners + 4 * kAxis) * kSlice + cell.lane);
    for (std::size_t e = 0; e < 4; ++e)
      hn::StoreInterleaved4(fx[e], fy[e], fz[e], hn::Zero(d), d, out + 4 * e * kSlice);
  }

  static HWY_INLINE Sym3Lanes<V> symmetric(const Vec3Lanes<V> &c0, const Vec3Lanes<V> &c1, const Vec3Lanes<V> &c2) {
    const V half = hn::Set(D(), T(0.5));
    return {c0.x,
            c1.y,
            c2.z,
            hn::Mul(half, hn::Add(c0.y, c1.x)),
            hn::Mul(half, hn::Add(c0.z, c2.x)),
            hn::Mul(half, hn::Add(c1.z, c2.y))};
  }
};

/// Edges of a chunk: the field in the functions of edges from that of phyxels, and forces back to these.
template <class T>
class EdgeLocals {
 public:
  HWY_INLINE EdgeLocals(const QuadraticSlices<T> &of, std::size_t chunk)
      : of_(of), first_(of.firstEdges[chunk]), last_(of.firstEdges[chunk + 1]),
        phyxels_(of.cells.firstLocals[chunk + 1] - of.cells.firstLocals[chunk]) {}
  /// Including the record of zeros.
  [[nodiscard]] HWY_INLINE std::size_t all() const { return phyxels_ + (last_ - first_) + 1; }
  HWY_INLINE void follow(T *field) const {
    T *edge = field + 4 * phyxels_;
    for (std::size_t row = first_; row < last_; ++row, edge += 4) {
      for (int c = 0; c < 4; ++c) edge[c] = T(0);
      for (std::size_t k = kOfEdge * row; k < kOfEdge * (row + 1); ++k)
        Records<T>::addScaled(of_.weights[k], field + 4 * std::size_t{of_.rows[k]}, edge);
    }
    for (int c = 0; c < 4; ++c) edge[c] = T(0);
  }
  HWY_INLINE void handOn(T *sums) const {
    const T *edge = sums + 4 * phyxels_;
    for (std::size_t row = first_; row < last_; ++row, edge += 4)
      for (std::size_t k = kOfEdge * row; k < kOfEdge * (row + 1); ++k)
        Records<T>::addScaled(of_.weights[k], edge, sums + 4 * std::size_t{of_.rows[k]});
  }

 private:
  const QuadraticSlices<T> &of_;
  std::size_t first_, last_, phyxels_;
};

/// forChunk() of cells of second order; fields.entries are those of corners, then of edges.
template <Sums kSums, class T, class OfSlice>
HWY_INLINE void forQuadraticChunk(const CellJob<T> &job, const QuadraticSlices<T> &second, std::size_t chunk,
                                  const OfSlice &ofSlice) {
  const CellSlices<T> &cells = second.cells;
  HWY_ALIGN_MAX T displacements[4 * kMaxQuadraticLocals];
  HWY_ALIGN_MAX T velocities[4 * kMaxQuadraticLocals];
  // Padded for the reason given in forChunk().
  HWY_ALIGN_MAX T padded[4 * kMaxQuadraticLocals + 2304 / sizeof(T)];
  T *const sums = padded + 2304 / sizeof(T);
  HWY_ALIGN_MAX T entries[4 * kCellNodes * kLanes<T>];
  const std::size_t first = cells.firstLocals[chunk], count = cells.firstLocals[chunk + 1] - first;
  const EdgeLocals<T> edges(second, chunk);
  const auto load = [&](const PhyxelField &from, T *to) HWY_ATTR {
    Records<T>::load(from, job.axes, job.turned, cells.phyxels.data() + first, count, to);
    edges.follow(to);
  };
  load(job.displacements, displacements);
  ChunkFields<T> fields{displacements, nullptr, entries};
  if (job.velocities.at) {
    load(job.velocities, velocities);
    fields.velocities = velocities;
  }
  if constexpr (kSums == Sums::perPhyxel)
    for (std::size_t k = 0; k < 4 * edges.all(); ++k) sums[k] = T(0);
  const std::size_t end = HWY_MIN(cells.count(), (chunk + 1) * kChunkSlices<T>);
  for (std::size_t slice = chunk * kChunkSlices<T>; slice < end; ++slice) {
    ofSlice(slice, fields);
    if constexpr (kSums == Sums::perPhyxel) {
      const auto add = [&](const std::uint16_t *locals, std::size_t nodes, const T *from) HWY_ATTR {
        for (std::size_t k = 0; k < nodes * kLanes<T>; ++k)
          Records<T>::add(from + 4 * k, sums + 4 * std::size_t{locals[k]});
      };
      add(cells.corners.data() + slice * kCorners * kLanes<T>, kCorners, entries);
      add(second.edges.data() + slice * kCellEdges * kLanes<T>, kCellEdges, entries + 4 * kCorners * kLanes<T>);
    }
  }
  if constexpr (kSums == Sums::perPhyxel) {
    edges.handOn(sums);
    for (std::size_t k = 0; k < 4 * count; ++k) job.partials[4 * first + k] = sums[k];
  }
}

/// Calls of(law, slice, fields) for the slices of some chunks.
template <Sums kSums, class T, class Of>
HWY_INLINE void forQuadraticSlices(const CellJob<T> &job, const QuadraticSlices<T> &second, std::size_t begin,
                                   std::size_t end, const Of &of) {
  for (std::size_t chunk = begin; chunk < end; ++chunk)
    forQuadraticChunk<kSums>(job, second, chunk, [&](std::size_t slice, const ChunkFields<T> &fields) HWY_ATTR {
      withLaw(job.laws[job.cells->materials[slice]].law, [&](auto law) HWY_ATTR { of(law, slice, fields); });
    });
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
