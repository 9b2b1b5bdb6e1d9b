// SPDX-License-Identifier: Apache-2.0
#include "formats/label_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <type_traits>

#include "c3de/core/text.h"
#include "formats/image_header.h"

namespace c3de::imaging {
namespace {

// A scale factor in single precision displaces numbers up to 65535 by up to 0.004; interpolated values between two
// labels are farther off nearly everywhere.
constexpr double kTolerance = 0.01;
constexpr double kLargest = 9007199254740992.0;  // doubles represent all integers up to it
constexpr double kSingleExact = 16777216.0;      // same for float
constexpr std::uint64_t kMaxLabels = 65535;
constexpr std::size_t kMaxNames = 6;

/// The interpretation of a voxel's value.
struct Meaning {
  enum class Kind { label, notFinite, negative, fraction } kind = Kind::label;
  double number = 0.0;  ///< rounded
};

Meaning meaningOf(double value) {
  if (!std::isfinite(value)) return {Meaning::Kind::notFinite};
  const double whole = std::round(value);
  if (std::abs(value - whole) > kTolerance || whole > kLargest) return {Meaning::Kind::fraction};
  return {whole < 0.0 ? Meaning::Kind::negative : Meaning::Kind::label, whole};
}

/// Result of a first pass over all voxels.
struct Survey {
  std::size_t notFinite = 0, rounded = 0, negatives = 0;
  double farthest = 0.0;  ///< from an integer
  std::optional<std::size_t> firstRounded;
  std::optional<double> negative;
  std::vector<bool> small = std::vector<bool>(kMaxLabels + 1, false);
  std::set<std::uint64_t> large;  ///< above kMaxLabels
};

std::string placeOf(const VolumeGeometry &grid, std::size_t v) {
  return "voxel (" + std::to_string(v % grid.size[0]) + ", " + std::to_string(v / grid.size[0] % grid.size[1]) + ", " +
         std::to_string(v / (grid.size[0] * grid.size[1])) + ")";
}

constexpr const char *kAccepted =
    "; accepted as labels: whole numbers from 0, which may be off by 0.01, up to 65535 different ones";

/// @param valueAt  the value of a voxel
template <class ValueAt>
Expected<Survey> surveyOf(const std::filesystem::path &path, const VolumeGeometry &grid, const ValueAt &valueAt) {
  Survey found;
  for (std::size_t v = 0; v < grid.voxelCount(); ++v) {
    const double value = valueAt(v);
    const Meaning meaning = meaningOf(value);
    switch (meaning.kind) {
      case Meaning::Kind::notFinite: ++found.notFinite; continue;
      case Meaning::Kind::fraction:
        return refuse(path, "is no label map: " + placeOf(grid, v) + " is " + formatNumber(value) + kAccepted);
      case Meaning::Kind::negative:
        if (found.negative && *found.negative != meaning.number)
          return refuse(path, "is no label map: it holds " + formatNumber(*found.negative) + " and, at " +
                                  placeOf(grid, v) + ", " + formatNumber(value) +
                                  "; one negative value is treated as background" + kAccepted);
        found.negative = meaning.number;
        ++found.negatives;
        break;
      case Meaning::Kind::label: {
        const auto number = static_cast<std::uint64_t>(meaning.number);
        if (number <= kMaxLabels)
          found.small[static_cast<std::size_t>(number)] = true;
        else if (found.large.size() <= kMaxLabels)
          found.large.insert(number);
        break;
      }
    }
    if (value == meaning.number) continue;
    ++found.rounded;
    found.farthest = std::max(found.farthest, std::abs(value - meaning.number));
    if (!found.firstRounded) found.firstRounded = v;
  }
  return found;
}

std::string voxels(std::size_t count) { return std::to_string(count) + (count == 1 ? " voxel" : " voxels"); }

template <class ValueAt>
Expected<LabelValues> valuesOf(const std::filesystem::path &path, const VolumeGeometry &grid, const LabelTable &named,
                               bool isSingle, const ValueAt &valueAt) {
  const auto found = surveyOf(path, grid, valueAt);
  if (!found) return tl::unexpected(found.error());
  LabelValues out;
  std::map<std::uint64_t, std::uint16_t> renumbered;
  std::uint64_t next = 1;
  for (const std::uint64_t number : found->large) {
    while (next <= kMaxLabels && (found->small[static_cast<std::size_t>(next)] || named.contains(next))) ++next;
    if (next > kMaxLabels)
      return refuse(path, "is no label map: it holds more than 65535 different numbers" + std::string(kAccepted));
    renumbered[number] = static_cast<std::uint16_t>(next);
    out.original[static_cast<std::uint16_t>(next++)] = number;
  }
  out.voxels.resize(grid.voxelCount());
  for (std::size_t v = 0; v < out.voxels.size(); ++v) {
    const Meaning meaning = meaningOf(valueAt(v));
    if (meaning.kind != Meaning::Kind::label) continue;
    const auto number = static_cast<std::uint64_t>(meaning.number);
    out.voxels[v] = number <= kMaxLabels ? static_cast<std::uint16_t>(number) : renumbered.at(number);
  }
  if (found->notFinite > 0)
    out.notices.push_back(
        voxels(found->notFinite) +
        (found->notFinite == 1 ? " is not a finite number and is" : " are not finite numbers and are") +
        " treated as background.");
  if (found->negative)
    out.notices.push_back(voxels(found->negatives) + " of " + formatNumber(*found->negative) +
                          (found->negatives == 1 ? " is" : " are") + " treated as background, like those of 0.");
  if (found->rounded > 0)
    out.notices.push_back(voxels(found->rounded) + (found->rounded == 1 ? " is" : " are") +
                          " not a whole number, by up to " + fmt::format("{:.2g}", found->farthest) +
                          ", and rounded to the label: " + placeOf(grid, *found->firstRounded) + " is " +
                          formatNumber(valueAt(*found->firstRounded)) + ".");
  if (!renumbered.empty()) {
    std::string list;
    std::size_t count = 0;
    for (const auto &[before, now] : renumbered)
      if (count++ < kMaxNames)
        list += (list.empty() ? "" : ", ") + std::to_string(before) + " is " + std::to_string(now);
    if (count > kMaxNames) list += " and " + std::to_string(count - kMaxNames) + " more";
    out.notices.push_back(std::to_string(count) + (count == 1 ? " label above 65535 is" : " labels above 65535 are") +
                          " renumbered: " + list + ".");
    if (isSingle && static_cast<double>(renumbered.rbegin()->first) > kSingleExact)
      out.notices.push_back("Labels above 16777216 are stored in single precision, which merges neighbouring numbers.");
  }
  return out;
}

}  // namespace

Expected<LabelValues> labelValuesOf(const std::filesystem::path &path, const Volume &volume, const LabelTable &named) {
  return std::visit(
      [&](const auto &all) {
        constexpr bool isSingle = std::is_same_v<typename std::decay_t<decltype(all)>::value_type, float>;
        const bool isPlain = volume.slope == 1.0 && volume.intercept == 0.0;
        return valuesOf(path, volume.geometry, named, isSingle, [&](std::size_t v) {
          const auto stored = static_cast<double>(all[v]);
          return isPlain ? stored : volume.slope * stored + volume.intercept;
        });
      },
      volume.voxels);
}

}  // namespace c3de::imaging
