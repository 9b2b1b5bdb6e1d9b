// SPDX-License-Identifier: Apache-2.0
// A table of material_law.h from a class with the functions of one point.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <c3de/sdk/ids.hpp>
#include <c3de/sdk/object.hpp>

#include "material_law.h"

namespace c3de::sdk {

template <>
inline constexpr std::string_view kTableId<c3de_material_law_v1>{C3DE_POINTBASED_MATERIAL_LAW_ID};

/// Nine doubles, column-major, as the interface has them.
using Matrix9 = std::array<double, 9>;

inline Matrix9 matrix9(const double *m) {
  Matrix9 out{};
  std::copy_n(m, 9, out.begin());
  return out;
}
/// A : B.
inline double dot(const Matrix9 &a, const Matrix9 &b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 9; ++i) sum += a[i] * b[i];
  return sum;
}

/// What most laws need of a deformation gradient: J = det F and cof F = dJ/dF.
struct Deformation {
  Matrix9 F, cof;
  double J;

  explicit Deformation(const double *f)
      : F(matrix9(f)), cof(crossed(F, F)), J((F[0] * cof[0] + F[1] * cof[1]) + F[2] * cof[2]) {}
  /// d cof F for a change D of F.
  [[nodiscard]] Matrix9 cofactorChange(const Matrix9 &D) const {
    Matrix9 out = crossed(D, F);
    const Matrix9 other = crossed(F, D);
    for (std::size_t i = 0; i < 9; ++i) out[i] += other[i];
    return out;
  }

 private:
  // Column k of the result is column k+1 of a x column k+2 of b.
  static Matrix9 crossed(const Matrix9 &a, const Matrix9 &b) {
    Matrix9 out{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double *u = &a[3 * ((k + 1) % 3)], *v = &b[3 * ((k + 2) % 3)];
      for (std::size_t r = 0; r < 3; ++r)
        out[3 * k + r] = u[(r + 1) % 3] * v[(r + 2) % 3] - u[(r + 2) % 3] * v[(r + 1) % 3];
    }
    return out;
  }
};

namespace detail {

// Its members take one point; the loop stands here, where the compiler sees through them.
template <class D>
struct LawThunks {
  static c3de_status C3DE_CALL declarations(c3de_object *, const c3de_param_decl **decls, std::uint64_t *n,
                                            std::uint64_t *stride) noexcept {
    *decls = std::data(D::kParams);
    *n = std::size(D::kParams);
    *stride = sizeof(c3de_param_decl);
    return C3DE_OK;
  }
  static c3de_status C3DE_CALL energy(c3de_object *, const double *params, std::uint64_t n, const double *F,
                                      double *W) noexcept {
    const D law(params);
    for (std::uint64_t i = 0; i < n; ++i) W[i] = law.energy(F + 9 * i);
    return C3DE_OK;
  }
  static c3de_status C3DE_CALL stress(c3de_object *, const double *params, std::uint64_t n, const double *F,
                                      double *P) noexcept {
    const D law(params);
    for (std::uint64_t i = 0; i < n; ++i) law.stress(F + 9 * i, P + 9 * i);
    return C3DE_OK;
  }
  static c3de_status C3DE_CALL differential(c3de_object *, const double *params, std::uint64_t n, const double *F,
                                            const double *dF, double *dP) noexcept {
    const D law(params);
    for (std::uint64_t i = 0; i < n; ++i) law.differential(F + 9 * i, dF + 9 * i, dP + 9 * i);
    return C3DE_OK;
  }
  static c3de_status C3DE_CALL bounds(c3de_object *, const double *params, std::uint64_t n, const double *F,
                                      double *out) noexcept {
    const D law(params);
    for (std::uint64_t i = 0; i < n; ++i) law.bounds(F + 9 * i, out + 2 * i);
    return C3DE_OK;
  }
  static constexpr decltype(c3de_material_law_v1::bounds) boundsSlot() {
    if constexpr (requires { &D::bounds; })
      return &bounds;
    else
      return nullptr;
  }
};

template <class D>
inline constexpr c3de_material_law_v1 kMaterialLawTable{sizeof(c3de_material_law_v1), 1,
                                                        &LawThunks<D>::declarations,  &LawThunks<D>::energy,
                                                        &LawThunks<D>::stress,        &LawThunks<D>::differential,
                                                        LawThunks<D>::boundsSlot()};

}  // namespace detail

/// The object of a law D, to be registered: registry.add<MaterialLaw<D>>(id, label, doc, factory). D is made from the
/// parameters' values for each call and answers for one point, without exceptions:
///
///   static constexpr std::array kParams{sdk::numberParam(…)};
///   explicit D(const double *params);
///   double energy(const double *F) const;
///   void stress(const double *F, double *P) const;
///   void differential(const double *F, const double *dF, double *dP) const;
///   void bounds(const double *F, double *waveAndAll) const;    // may be missing
template <class D>
class MaterialLaw : public Object<MaterialLaw<D>> {
 public:
  template <class Factory>
  explicit MaterialLaw(Factory &) {}
  static std::array<Interface, 1> interfaces() { return {interfaceOf(detail::kMaterialLawTable<D>)}; }
};

}  // namespace c3de::sdk
