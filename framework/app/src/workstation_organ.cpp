// SPDX-License-Identifier: Apache-2.0
#include "workstation_organ.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "c3de/core/log.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/imaging/masks.h"
#include "c3de/imaging/surface.h"

namespace c3de::app {
namespace {

/// The fill is finer than the phyxels, so that they find the border between its blocks.
constexpr double kBlocksPerSpacing = 4.0;
/// Of the time, the surface takes most.
constexpr double kSurfaceShare = 0.9;

/// What a body is made of.
struct Organ {
  geometry::TriangleMesh surface;
  imaging::Fill fill;
};

Expected<void> compute(const ui::OrganRequest &request, Organ &organ, const ProgressFn &progress) {
  const auto part = [&](double fraction, const std::string &what) {
    return !progress || progress(fraction < 0.0 ? fraction : kSurfaceShare * fraction, what);
  };
  auto surface = imaging::surfaceOf(request.mask, {request.edge_mm}, part);
  if (!surface) return tl::unexpected(surface.error());
  organ.surface = std::move(*surface);
  if (progress && !progress(kSurfaceShare, "filling")) return fail(ErrorCode::cancelled, "making " + request.name + " was cancelled");
  const double spacing_mm = std::cbrt(imaging::volumeOf(request.mask) / static_cast<double>(request.phyxels));
  auto fill = imaging::fillOf(request.mask, spacing_mm / kBlocksPerSpacing);
  if (!fill) return tl::unexpected(fill.error());
  organ.fill = std::move(*fill);
  return {};
}

}  // namespace

void WorkstationOrgan::makeOrgan(ui::OrganRequest request) {
  if (!job_.isNull()) session_.jobs().cancel(job_);
  const std::uint64_t serial = ++serial_;
  const auto wanted = std::make_shared<const ui::OrganRequest>(std::move(request));
  const auto organ = std::make_shared<Organ>();
  job_ = session_.jobs().submit(
      kJobOwner, "Making " + wanted->name,
      [wanted, organ](const ProgressFn &progress) { return compute(*wanted, *organ, progress); },
      [this, serial, wanted, organ](const Expected<void> &done) {
        if (serial != serial_) return;
        job_ = {};
        if (!done) return events_.failed("Could not make " + wanted->name, done.error());
        const double filled = std::accumulate(organ->fill.values.begin(), organ->fill.values.end(), 0.0) * organ->fill.geometry.voxelVolume();
        log(LogLevel::info, fmt::format("{} ({}): {:.1f} ml of voxels; surface of {} triangles around {:.1f} ml, fill of {:.1f} ml",
                                        wanted->name, wanted->material, imaging::volumeOf(wanted->mask) / 1000.0,
                                        organ->surface.triangles.size(), geometry::signedVolume(organ->surface) / 1000.0, filled / 1000.0));
      });
}

}  // namespace c3de::app
