// SPDX-License-Identifier: Apache-2.0
// Writes fields into rows provided by the caller. Throws sdk::Error.
#pragma once

#include <cstddef>
#include <string>

#include "base/services.h"
#include "c3de/sdk/result.hpp"
#include "c3de/sdk/view.hpp"
#include "pointbased/types.h"

namespace pointbased {

template <std::uint32_t N>
sdk::Rows<double, N> room(const c3de_mview &out, std::size_t count) {
  auto rows = sdk::orThrow(sdk::asMutableRows<double, N>(out, "field"));
  if (rows.size() < count)
    throw sdk::Error(C3DE_E_ARG,
                     "field: room for " + std::to_string(rows.size()) + " rows, needed " + std::to_string(count));
  return rows;
}

template <class Get>
void writeVectors(const c3de_mview &out, std::size_t count, Get &&get) {
  const auto rows = room<3>(out, count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 v = get(i);
    for (int c = 0; c < 3; ++c) rows[i][c] = v[c];
  }
}

template <class Get>
void writeScalars(const c3de_mview &out, std::size_t count, Get &&get) {
  const auto rows = room<1>(out, count);
  for (std::size_t i = 0; i < count; ++i) rows[i][0] = get(i);
}

template <class Get>
void writeMatrices(const c3de_mview &out, std::size_t count, Get &&get) {
  const auto rows = room<9>(out, count);
  for (std::size_t i = 0; i < count; ++i) {
    const Mat3 m = get(i);  // column-major, like the field
    for (int c = 0; c < 9; ++c) rows[i][c] = m.data()[c];
  }
}

}  // namespace pointbased
