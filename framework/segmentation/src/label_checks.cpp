// SPDX-License-Identifier: Apache-2.0
#include "c3de/segmentation/label_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "c3de/core/text.h"
#include "c3de/imaging/statistics.h"
#include "c3de/imaging/warp_grid.h"

namespace c3de::segmentation {
namespace {

using imaging::LabelMap;
using imaging::Volume;

constexpr std::size_t kMaxNames = 6;
constexpr std::size_t kMaxLabels = 60000;    // with separate histograms
constexpr double kReach_mm = 10.0;           // of contrast agent from its vessel: branches without a label
constexpr double kStep_HU = 20.0;            // of the proposed limits
constexpr std::size_t kDenseNeighbours = 3;  // of six: corners of structures two voxels thick have them
constexpr double kMaxOfHoles_HU = 700.0;     // of contrast agent in arteries and veins; cortical bone has more
constexpr double kMetal_HU = 2000.0;
constexpr double kMaxContrast_HU = 1200.0;  // undiluted, in the vein of injection

/// Histogram with bins of 10 HU.
class Histogram {
 public:
  void add(double hu) {
    ++counts_[static_cast<std::size_t>(std::clamp((hu - kFirst) / kWidth, 0.0, kBins - 1.0))];
    ++total_;
  }
  [[nodiscard]] std::size_t total() const { return total_; }
  /// The value below which this fraction of the counts is.
  [[nodiscard]] double quantile(double share) const {
    const double wanted = share * static_cast<double>(total_);
    double sum = 0.0;
    for (std::size_t b = 0; b < counts_.size(); ++b) {
      const auto here = static_cast<double>(counts_[b]);
      if (here > 0.0 && sum + here >= wanted)
        return kFirst + kWidth * (static_cast<double>(b) + std::clamp((wanted - sum) / here, 0.0, 1.0));
      sum += here;
    }
    return kFirst;
  }

 private:
  static constexpr double kFirst = -1100.0, kWidth = 10.0, kBins = 420.0;
  std::array<std::uint32_t, 420> counts_{};
  std::size_t total_ = 0;
};

/// Classification of a voxel on the labels' grid.
enum Mark : std::uint8_t { kOther, kRigidLabel, kSoftLabel, kContrastLabel, kUnlabelled };

/// Values of an image at the voxels of another grid.
class ValueAt {
 public:
  ValueAt(const Volume &image, const imaging::VolumeGeometry &grid)
      : image_(image), toIndex_(multiply(imaging::affineInverse(image.geometry.indexToWorld), grid.indexToWorld)) {}
  /// NaN outside the image.
  [[nodiscard]] double operator()(std::size_t i, std::size_t j, std::size_t k) const {
    const Vec3 at = transformPoint(toIndex_, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
    std::array<std::size_t, 3> index{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double nearest = std::floor(at[a] + 0.5);
      if (!(nearest >= 0.0 && nearest < static_cast<double>(image_.geometry.size[a]))) return std::nan("");
      index[a] = static_cast<std::size_t>(nearest);
    }
    return image_.value(index[0], index[1], index[2]);
  }

 private:
  const Volume &image_;
  Mat4 toIndex_;
};

/// The fraction of an image's voxels that a grid covers, sampled at up to 64 positions along each axis.
double coverageOf(const imaging::VolumeGeometry &image, const imaging::VolumeGeometry &labels) {
  constexpr std::size_t kSamples = 64;  // along an axis
  const Mat4 toLabels = multiply(imaging::affineInverse(labels.indexToWorld), image.indexToWorld);
  std::array<std::size_t, 3> count{};
  for (std::size_t a = 0; a < 3; ++a) count[a] = std::min(kSamples, image.size[a]);
  std::size_t covered = 0;
  for (std::size_t k = 0; k < count[2]; ++k)
    for (std::size_t j = 0; j < count[1]; ++j)
      for (std::size_t i = 0; i < count[0]; ++i) {
        Vec3 index{};
        const std::array<std::size_t, 3> at{i, j, k};
        for (std::size_t a = 0; a < 3; ++a)
          index[a] =
              (static_cast<double>(at[a]) + 0.5) * static_cast<double>(image.size[a]) / static_cast<double>(count[a]) -
              0.5;
        const Vec3 there = transformPoint(toLabels, index);
        bool isInside = true;
        for (std::size_t a = 0; a < 3; ++a)
          isInside = isInside && there[a] >= -0.5 && there[a] <= static_cast<double>(labels.size[a]) - 0.5;
        covered += isInside ? 1 : 0;
      }
  return static_cast<double>(covered) / static_cast<double>(count[0] * count[1] * count[2]);
}

std::optional<LabelFinding> coverageFinding(const LabelCheck &check) {
  const imaging::VolumeGeometry &image = check.image->geometry, &labels = check.layers.front()->geometry;
  const double coverage = coverageOf(image, labels);
  if (coverage >= kMinCoverage) return std::nullopt;
  const imaging::WorldBox whole = imaging::boxOf(image), part = imaging::boxOf(labels);
  std::string along;
  for (std::size_t a = 0; a < 3; ++a) {
    const double shared = std::min(whole.high[a], part.high[a]) - std::max(whole.low[a], part.low[a]);
    if (shared >= kMinCoverage * (whole.high[a] - whole.low[a])) continue;
    along += fmt::format("{}along {} from {:.0f} to {:.0f} mm of {:.0f} to {:.0f} mm", along.empty() ? ": " : ", ",
                         "xyz"[a], part.low[a], part.high[a], whole.low[a], whole.high[a]);
  }
  LabelFinding out;
  out.kind = LabelFinding::Kind::coverage;
  out.text = fmt::format("The label map covers {:.0f} % of the image{}; tissue outside the map belongs to no body",
                         std::min(std::round(100.0 * coverage), 100.0 * kMinCoverage - 1.0), along);
  out.advice = "use a label map of the whole image, or limit the body with 'region'";
  return out;
}

/// Names of labels, each with a value in HU.
std::string listOf(const std::vector<std::pair<std::string, double>> &labels) {
  std::string text;
  for (std::size_t i = 0; i < std::min(labels.size(), kMaxNames); ++i)
    text += fmt::format("{}{} ({:.0f} HU)", i == 0 ? "" : ", ", labels[i].first, labels[i].second);
  if (labels.size() > kMaxNames) text += fmt::format(" and {} more", labels.size() - kMaxNames);
  return text;
}

/// Labels and grey values on the grid of the labels.
class GreyValues {
 public:
  explicit GreyValues(const LabelCheck &check)
      : check_(check), grid_(check.layers.front()->geometry), valueAt_(*check.image, grid_) {}

  Expected<void> read(const ProgressFn &progress) {
    const auto &n = grid_.size;
    std::vector<std::vector<std::uint16_t>> entryOf;
    for (std::size_t layer = 0; layer < check_.layers.size(); ++layer) {
      entryOf.emplace_back(0x10000, 0);
      const auto &labels = check_.layers[layer]->labels;
      for (std::size_t l = 0; l < labels.size(); ++l) {
        entryOf[layer][labels[l].value] = static_cast<std::uint16_t>(entries_.size() + 1);
        entries_.push_back({labels[l].name, check_.roles[layer][l], {}});
      }
    }
    owner_.assign(grid_.voxelCount(), 0);
    values_.assign(grid_.voxelCount(), 0);
    std::size_t v = 0;
    for (std::size_t k = 0; k < n[2]; ++k) {
      if (progress && !progress(static_cast<double>(k) / static_cast<double>(n[2]), "comparing labels with the image"))
        return fail(ErrorCode::cancelled, "cancelled");
      for (std::size_t j = 0; j < n[1]; ++j)
        for (std::size_t i = 0; i < n[0]; ++i, ++v) {
          if (check_.region != nullptr && check_.region->voxels[v] == 0) {
            owner_[v] = kOutside;
            continue;
          }
          // The last layer with a tissue counts.
          for (std::size_t layer = check_.layers.size(); layer-- > 0;) {
            const std::uint16_t entry = entryOf[layer][check_.layers[layer]->voxels[v]];
            if (entry == 0) continue;
            if (owner_[v] == 0 || entries_[owner_[v] - 1].role == LabelRole::background) owner_[v] = entry;
          }
          const double hu = valueAt_(i, j, k);
          if (std::isnan(hu)) {
            if (owner_[v] == 0) owner_[v] = kOutside;
            continue;
          }
          values_[v] = static_cast<std::int16_t>(std::clamp(hu, -32000.0, 32000.0));
          if (owner_[v] != 0) entries_[owner_[v] - 1].values.add(hu);
        }
    }
    return {};
  }

  [[nodiscard]] std::optional<LabelFinding> rigidFinding() const {
    std::vector<std::pair<std::string, double>> labels;
    std::size_t rigid = 0;
    for (const Entry &entry : entries_) {
      if (entry.role != LabelRole::rigid || entry.values.total() == 0) continue;
      ++rigid;
      const double median = entry.values.quantile(0.5);
      if (median < kSpongyBone_HU && entry.values.quantile(0.9) < kCorticalBone_HU)
        labels.emplace_back(entry.name, median);
    }
    if (labels.empty()) return std::nullopt;
    LabelFinding out;
    out.kind = LabelFinding::Kind::rigid;
    out.text = fmt::format(
        "{} of {} rigid labels {} grey values below those of bone (median in brackets, of bone at least {:.0f} HU): {}",
        labels.size(), rigid, labels.size() == 1 ? "has" : "have", kSpongyBone_HU, listOf(labels));
    out.advice =
        "check that numbers and names of the labels fit and that the map belongs to this image, or give these "
        "labels a material";
    return out;
  }

  /// Findings about unlabelled voxels that are outside the background's range, or counted as its material.
  [[nodiscard]] std::vector<LabelFinding> unlabelledFindings() {
    std::vector<LabelFinding> out;
    if (!check_.background) return out;
    markVoxels();
    if (auto contrast = contrastFinding()) out.push_back(std::move(*contrast));
    if (auto bone = boneFinding()) out.push_back(std::move(*bone));
    return out;
  }

 private:
  static constexpr std::uint16_t kOutside = 0xffff;
  struct Entry {
    std::string name;
    LabelRole role = LabelRole::background;
    Histogram values;
  };

  void markVoxels() {
    std::vector<Mark> markOf;
    for (const Entry &entry : entries_) {
      // Without contrast agent no soft tissue reaches these values; of a displaced label only some voxels do.
      const bool isContrast = entry.role == LabelRole::soft && entry.values.total() > 0 &&
                              entry.values.quantile(0.5) > kUnlabelledBone_HU &&
                              entry.values.quantile(0.9) > kCorticalBone_HU;
      markOf.push_back(entry.role == LabelRole::rigid ? kRigidLabel : isContrast ? kContrastLabel : kSoftLabel);
      if (isContrast) contrastLabels_.emplace_back(entry.name, entry.values.quantile(0.5));
    }
    marks_.assign(values_.size(), kOther);
    for (std::size_t v = 0; v < owner_.size(); ++v)
      if (owner_[v] != kOutside) marks_[v] = owner_[v] == 0 ? kUnlabelled : markOf[owner_[v] - 1u];
    owner_ = {};
  }

  /// Calls `each` for the voxels that share a face with v.
  template <class Each>
  void forNeighbours(std::size_t v, const Each &each) const {
    const auto &n = grid_.size;
    const std::array<std::size_t, 3> at{v % n[0], v / n[0] % n[1], v / (n[0] * n[1])}, stride{1, n[0], n[0] * n[1]};
    for (std::size_t a = 0; a < 3; ++a) {
      if (at[a] > 0) each(v - stride[a]);
      if (at[a] + 1 < n[a]) each(v + stride[a]);
    }
  }

  [[nodiscard]] double millilitres(std::size_t voxels) const {
    return 1e-3 * grid_.voxelVolume() * static_cast<double>(voxels);
  }

  /// Region growing from labels with contrast agent through unlabelled voxels that show it, or its border.
  [[nodiscard]] std::optional<LabelFinding> contrastFinding() {
    if (contrastLabels_.empty()) return std::nullopt;
    const double to = check_.background->to;
    const Vec3 spacing = grid_.spacing();
    const auto reach = static_cast<int>(std::ceil(kReach_mm / std::min({spacing[0], spacing[1], spacing[2]})));
    std::vector<std::size_t> front, next;
    for (std::size_t v = 0; v < marks_.size(); ++v)
      if (marks_[v] == kContrastLabel) front.push_back(v);
    isContrast_.assign(marks_.size(), 0);
    Histogram left;
    for (int step = 0; step < reach && !front.empty(); ++step) {
      next.clear();
      for (const std::size_t v : front)
        forNeighbours(v, [&](std::size_t w) {
          if (marks_[w] != kUnlabelled || isContrast_[w] != 0 || values_[w] < kUnlabelledBone_HU ||
              values_[w] > kMaxContrast_HU)
            return;
          // The border of a bone also has values of contrast agent.
          bool isBorder = false;
          forNeighbours(w, [&](std::size_t x) { isBorder = isBorder || marks_[x] == kRigidLabel; });
          if (isBorder) return;
          isContrast_[w] = 1;
          if (values_[w] > to) left.add(values_[w]);
          next.push_back(w);
        });
      front.swap(next);
    }
    if (millilitres(left.total()) < kMinContrast_ml) return std::nullopt;
    LabelFinding out;
    out.kind = LabelFinding::Kind::contrast;
    const double least = left.quantile(0.05), most = left.quantile(0.95);
    out.to = kStep_HU * std::ceil(left.quantile(0.995) / kStep_HU);
    out.text = fmt::format(
        "{:.3g} ml of contrast agent without a label ({:.0f} to {:.0f} HU) next to {} exceed the background's upper "
        "limit "
        "of {} HU and would be holes",
        millilitres(left.total()), least, most, listOf(contrastLabels_), formatNumber(to));
    out.advice = fmt::format("let the background reach to {} HU; bone without a label up to there is {} then",
                             formatNumber(*out.to), check_.background->material);
    return out;
  }

  /// Requires so many dense neighbours that noise rarely causes it. Excludes the border of labelled bone, which is
  /// partial volume.
  [[nodiscard]] bool isBone(std::size_t v) const {
    const auto isDense = [&](std::size_t w) {
      return marks_[w] == kUnlabelled && values_[w] >= kUnlabelledBone_HU && values_[w] < kMetal_HU &&
             (isContrast_.empty() || isContrast_[w] == 0);
    };
    if (!isDense(v)) return false;
    std::size_t dense = 0;
    forNeighbours(v, [&](std::size_t w) { dense += isDense(w) ? 1 : 0; });
    return dense >= kDenseNeighbours && !touchesRigid(v);
  }

  /// Through a face, an edge or a corner.
  [[nodiscard]] bool touchesRigid(std::size_t v) const {
    const auto &n = grid_.size;
    const std::array<std::size_t, 3> at{v % n[0], v / n[0] % n[1], v / (n[0] * n[1])};
    std::array<std::size_t, 3> low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = at[a] > 0 ? at[a] - 1 : 0;
      high[a] = std::min(at[a] + 1, n[a] - 1);
    }
    for (std::size_t k = low[2]; k <= high[2]; ++k)
      for (std::size_t j = low[1]; j <= high[1]; ++j)
        for (std::size_t i = low[0]; i <= high[0]; ++i)
          if (marks_[i + n[0] * (j + n[1] * k)] == kRigidLabel) return true;
    return false;
  }

  [[nodiscard]] std::optional<LabelFinding> boneFinding() const {
    Histogram holes;
    std::size_t taken = 0;
    for (std::size_t v = 0; v < marks_.size(); ++v) {
      if (marks_[v] != kUnlabelled || values_[v] < kUnlabelledBone_HU || !isBone(v)) continue;
      const double hu = values_[v];
      if (hu > check_.background->to)
        holes.add(hu);
      else if (hu >= check_.background->from)
        ++taken;
    }
    const double holes_ml = millilitres(holes.total()), taken_ml = millilitres(taken);
    if (holes_ml + taken_ml < kMinBone_ml) return std::nullopt;
    LabelFinding out;
    out.kind = LabelFinding::Kind::bone;
    out.text = fmt::format("{:.3g} ml without a label look like bone or contrast agent (from {:.0f} HU on)",
                           holes_ml + taken_ml, kUnlabelledBone_HU);
    if (taken > 0) out.text += fmt::format(": {:.3g} ml would be {}", taken_ml, check_.background->material);
    if (holes.total() > 0) out.text += fmt::format("{} {:.3g} ml would be holes", taken > 0 ? "," : ":", holes_ml);
    out.advice = fmt::format(
        "label them, or add a tissue {{ name = \"bone\", image = \"…\", threshold = [{:.0f}, {:.0f}], rigid = true }}",
        kUnlabelledBone_HU, kMetal_HU + 1000.0);
    // Cortical bone has higher values.
    const double most = holes.total() > 0 ? holes.quantile(0.995) : 0.0;
    if (holes_ml < kMinContrast_ml || most > kMaxOfHoles_HU) return out;
    out.to = kStep_HU * std::ceil(most / kStep_HU);
    out.advice += fmt::format("; where it is contrast agent, let the background reach to {} HU", formatNumber(*out.to));
    return out;
  }

  const LabelCheck &check_;
  const imaging::VolumeGeometry &grid_;
  ValueAt valueAt_;
  std::vector<Entry> entries_;
  std::vector<std::uint16_t> owner_;  ///< 1 plus the entry; 0: no label
  std::vector<std::int16_t> values_;  ///< HU
  std::vector<std::uint8_t> marks_, isContrast_;
  std::vector<std::pair<std::string, double>> contrastLabels_;  ///< with their medians
};

}  // namespace

Expected<std::vector<LabelFinding>> checkLabels(const LabelCheck &check, const ProgressFn &progress) {
  std::vector<LabelFinding> out;
  if (check.layers.empty() || check.image == nullptr) return out;
  for (const LabelMap *layer : check.layers)
    if (layer->voxels.size() != check.layers.front()->voxels.size())
      return fail(ErrorCode::input, "the layers of the label map have different grids");
  if (check.region == nullptr)
    if (auto coverage = coverageFinding(check)) out.push_back(std::move(*coverage));
  std::size_t labels = 0;
  for (const LabelMap *layer : check.layers) labels += layer->labels.size();
  if (labels > kMaxLabels || !imaging::isLikelyHounsfield(*check.image)) return out;
  GreyValues values(check);
  if (auto read = values.read(progress); !read) return tl::unexpected(read.error());
  if (auto rigid = values.rigidFinding()) out.push_back(std::move(*rigid));
  for (LabelFinding &finding : values.unlabelledFindings()) out.push_back(std::move(finding));
  return out;
}

}  // namespace c3de::segmentation
