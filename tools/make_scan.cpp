// SPDX-License-Identifier: Apache-2.0
// Makes the project's own scan: make_scan IMAGE.nii.gz LABELS.nrrd
// A synthetic computed tomography of the upper abdomen with contrast agent and noise, and a label map of the same grid.
// Every run writes the same voxels.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "abdomen.h"
#include "c3de/imaging/writing.h"

namespace {

using namespace c3de;

constexpr std::array<std::size_t, 3> kSize{112, 80, 56};
constexpr Vec3 kSpacing_mm{2.9, 2.9, 4.0};
constexpr std::size_t kSamples = 2;  // along each axis of a voxel, for the mixture of tissues at its borders
constexpr double kNoise_HU = 9.0;
constexpr double kAirBelow_HU = -120.0, kBoneFrom_HU = 200.0;

/// Turned by 4 degrees about x and 2.5 degrees about z, as patients lie; the middle of the grid is the origin.
imaging::VolumeGeometry slightlyOblique() {
  const double a = 4.0 * 0.017453292519943295, b = 2.5 * 0.017453292519943295;
  const std::array<Vec3, 3> axes{{{std::cos(b), std::sin(b), 0.0},
                                  {-std::sin(b) * std::cos(a), std::cos(b) * std::cos(a), std::sin(a)},
                                  {std::sin(b) * std::sin(a), -std::cos(b) * std::sin(a), std::cos(a)}}};
  imaging::VolumeGeometry out;
  out.size = kSize;
  Vec3 first{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3 step = kSpacing_mm[axis] * axes[axis];
    first = first - 0.5 * static_cast<double>(kSize[axis] - 1) * step;
    for (std::size_t row = 0; row < 3; ++row) out.indexToWorld[4 * axis + row] = step[row];
  }
  // Multiples of a micrometre, which a file in single precision keeps well enough for equal grids.
  for (std::size_t row = 0; row < 3; ++row) out.indexToWorld[12 + row] = std::round(1e3 * first[row]) / 1e3;
  return out;
}

/// A sum of uniform numbers: about normal, with standard deviation 1.
class Noise {
 public:
  double next() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) {
      state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
      sum += static_cast<double>(state_ >> 40) / 16777216.0;
    }
    return sum;
  }

 private:
  std::uint64_t state_ = 20040827;
};

/// Without those that have no label; 0: there is none.
std::uint16_t mostFrequent(const std::map<std::uint16_t, int> &samples) {
  std::uint16_t found = 0;
  for (const auto &[label, count] : samples)
    if (label != 0 && (found == 0 || count > samples.at(found))) found = label;
  return found;
}

struct Scan {
  imaging::Volume image;
  imaging::LabelMap labels;
};

Scan make() {
  Scan out;
  out.image.geometry = out.labels.geometry = slightlyOblique();
  out.image.unit = "HU";
  std::vector<std::int16_t> values;
  Noise noise;
  for (std::size_t k = 0; k < kSize[2]; ++k)
    for (std::size_t j = 0; j < kSize[1]; ++j)
      for (std::size_t i = 0; i < kSize[0]; ++i) {
        const auto at = [&](double u, double v, double w) {
          return tools::tissueAt(out.image.geometry.worldAt(
              {static_cast<double>(i) + u, static_cast<double>(j) + v, static_cast<double>(k) + w}));
        };
        double mean = 0.0;
        std::map<std::uint16_t, int> samples;  // of each label
        constexpr double kStep = 1.0 / kSamples, kFirst = 0.5 * kStep - 0.5;
        for (std::size_t s = 0; s < kSamples * kSamples * kSamples; ++s) {
          const std::size_t u = s % kSamples, v = s / kSamples % kSamples, w = s / (kSamples * kSamples);
          const tools::Tissue tissue =
              at(kFirst + kStep * static_cast<double>(u), kFirst + kStep * static_cast<double>(v),
                 kFirst + kStep * static_cast<double>(w));
          mean += tissue.hounsfield;
          ++samples[tissue.label];
        }
        mean /= static_cast<double>(kSamples * kSamples * kSamples);
        values.push_back(static_cast<std::int16_t>(std::lround(std::max(-1024.0, mean + kNoise_HU * noise.next()))));
        std::uint16_t label = at(0.0, 0.0, 0.0).label;
        // What looks like bone or air at a border belongs to the label of which it has a part.
        if (label == 0 && (mean > kBoneFrom_HU || mean < kAirBelow_HU)) label = mostFrequent(samples);
        out.labels.voxels.push_back(label);
      }
  out.image.voxels = std::move(values);
  const auto linear = [](double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); };
  for (std::size_t n = 0; n < tools::abdomenLabels().size(); ++n) {
    const auto &[name, colour] = tools::abdomenLabels()[n];
    out.labels.labels.push_back({static_cast<std::uint16_t>(n + 1),
                                 name,
                                 {static_cast<float>(linear(colour[0])), static_cast<float>(linear(colour[1])),
                                  static_cast<float>(linear(colour[2]))}});
  }
  return out;
}

int fail(const std::string &why) {
  fmt::print(stderr, "make_scan: {}\nusage: make_scan IMAGE.nii.gz LABELS.nrrd\n", why);
  return 2;
}

}  // namespace

int main(int argc, char **argv) {
  if (argc != 3) return fail("two output files are expected");
  const Scan scan = make();
  if (const auto saved = imaging::writeVolume(argv[1], scan.image); !saved) return fail(saved.error().message);
  if (const auto saved = imaging::writeLabelMap(argv[2], scan.labels); !saved) return fail(saved.error().message);
  for (const auto &label : scan.labels.labels) {
    const auto voxels = std::count(scan.labels.voxels.begin(), scan.labels.voxels.end(), label.value);
    fmt::print("{:20} {:7.1f} ml\n", label.name,
               static_cast<double>(voxels) * scan.labels.geometry.voxelVolume() * 1e-3);
  }
  return 0;
}
