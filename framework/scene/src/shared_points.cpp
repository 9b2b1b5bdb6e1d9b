// SPDX-License-Identifier: Apache-2.0
#include "shared_points.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

namespace c3de::scene {
namespace {

// Larger than a point, so that writing one row too many is detected.
constexpr std::size_t kMargin = 32;
// A NaN pattern that no computation produces.
constexpr std::uint64_t kUntouched = 0x7ff4c3dec3dec3deu;

bool isUntouched(const double *margin) {
  return std::all_of(margin, margin + kMargin,
                     [](const double &x) { return std::bit_cast<std::uint64_t>(x) == kUntouched; });
}

}  // namespace

void SharedPoints::lend(const c3de_sim_points &points) {
  const auto n = static_cast<std::size_t>(points.count);
  arrays_ = {Array{"positions_m", points.positions_m, 3 * n, nullptr},
             Array{"velocities_m_s", points.velocities_m_s, 3 * n, nullptr},
             Array{"masses_kg", points.masses_kg, n, nullptr}, Array{"forces_N", points.forces_N, 3 * n, nullptr}};
  const std::size_t bytes = (10 * n + (arrays_.size() + 1) * kMargin) * sizeof(double);
  if (memory_.size() < bytes) memory_ = GuardedMemory(bytes);
  // The last margin ends where the guarded memory begins.
  auto *at = reinterpret_cast<double *>(memory_.data() + memory_.size() - bytes);
  std::fill_n(at, kMargin, std::bit_cast<double>(kUntouched));
  for (Array &array : arrays_) {
    array.begin = at + kMargin;
    std::memcpy(array.begin, array.source, array.numbers * sizeof(double));
    at = array.begin + array.numbers;
    std::fill_n(at, kMargin, std::bit_cast<double>(kUntouched));
  }
  given_ = lent_ = points;
  lent_.positions_m = arrays_[0].begin;
  lent_.velocities_m_s = arrays_[1].begin;
  lent_.masses_kg = arrays_[2].begin;
  lent_.forces_N = arrays_[3].begin;
}

const char *SharedPoints::overrun() const {
  if (!isUntouched(arrays_.front().begin - kMargin)) return arrays_.front().name;
  for (const Array &array : arrays_)
    if (!isUntouched(array.begin + array.numbers)) return array.name;
  return nullptr;
}

const char *SharedPoints::restoreReadOnly() {
  const char *changed = nullptr;
  for (std::size_t a = 0; a + 1 < arrays_.size(); ++a) {
    const Array &array = arrays_[a];
    if (std::memcmp(array.begin, array.source, array.numbers * sizeof(double)) == 0) continue;
    changed = array.name;
    std::memcpy(array.begin, array.source, array.numbers * sizeof(double));
  }
  return changed;
}

void SharedPoints::returnForces() const {
  std::memcpy(given_.forces_N, arrays_.back().begin, arrays_.back().numbers * sizeof(double));
}

}  // namespace c3de::scene
