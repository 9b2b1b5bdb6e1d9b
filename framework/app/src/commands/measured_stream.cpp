// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/log.h"
#include "c3de/session/change_log.h"
#include "c3de/session/export_image.h"
#include "c3de/session/match_stages.h"
#include "c3de/tracking/tracking_link.h"
#include "commands/measured_source.h"
#include "commands/scene_at_rest.h"
#include "commands/stream_messages.h"

namespace c3de::app {
namespace {

using session::Landmark;
using tracking::TrackingLink;

constexpr std::chrono::milliseconds kPoll{50};

/// The voxels of the slices `first` … `last` along k.
imaging::Volume slabOf(const imaging::Volume &image, std::size_t first, std::size_t last) {
  imaging::Volume out;
  out.geometry = image.geometry;
  out.geometry.size[2] = last - first + 1;
  const Vec3 corner = image.geometry.worldAt({0.0, 0.0, static_cast<double>(first)});
  for (std::size_t row = 0; row < 3; ++row) out.geometry.indexToWorld[12 + row] = corner[row];
  out.slope = image.slope;
  out.intercept = image.intercept;
  out.unit = image.unit;
  const auto slice = static_cast<std::ptrdiff_t>(image.geometry.size[0] * image.geometry.size[1]);
  std::visit(
      [&](const auto &voxels) {
        const auto begin = voxels.begin() + static_cast<std::ptrdiff_t>(first) * slice;
        out.voxels =
            std::decay_t<decltype(voxels)>(begin, begin + static_cast<std::ptrdiff_t>(last - first + 1) * slice);
      },
      image.voxels);
  return out;
}

class MeasuredStream : public MeasuredSource {
 public:
  MeasuredStream(std::unique_ptr<TrackingLink> link, const MatchOptions &options, StreamContext context,
                 std::vector<Landmark> landmarks)
      : link_(std::move(link)), options_(options), context_(std::move(context)), landmarks_(std::move(landmarks)) {}

  /// Reads image and its warp. Errors: the scene has no image.
  Expected<void> prepareSlice() {
    if (!context_.scene.image)
      return fail(ErrorCode::usage, "--stream-slice: the scene has no image; accepted: a scene with [image]");
    auto image = session::imageOfScene(context_.scene, context_.sources);
    if (!image) return tl::unexpected(image.error());
    auto warp = session::imageWarpOf(context_.scene, context_.sources, context_.session.materials(),
                                     context_.built.prepared.tissues);
    if (!warp) return tl::unexpected(warp.error());
    image_ = std::move(*image);
    warp_ = std::move(*warp);
    return {};
  }

  Expected<std::optional<Frame>> next(const ProgressFn &progress) override {
    if (options_.streamFrames && frames_ == static_cast<std::size_t>(*options_.streamFrames)) return std::nullopt;
    auto since = std::chrono::steady_clock::now();
    for (std::uint64_t tips = link_->status().tips;;) {
      if (auto frame = link_->takeFrame(kPoll)) return accepted(std::move(*frame));
      const tracking::LinkStatus status = link_->status();
      report(status);
      if (std::exchange(tips, status.tips) != status.tips) since = std::chrono::steady_clock::now();
      if (!progress(-1.0, fmt::format("tracking system {}: {}", textOf(link_->address()), textOf(status))))
        return std::nullopt;
      const double waited = std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
      if (waited > options_.streamTimeout_s.value_or(kTimeout_s))
        return fail(ErrorCode::input, fmt::format("no points for {:.3g} s; {}", waited, textOf(status)));
    }
  }

  std::optional<std::size_t> count() const override {
    if (!options_.streamFrames) return std::nullopt;
    return static_cast<std::size_t>(*options_.streamFrames);
  }
  bool isLive() const override { return true; }

  Expected<void> send(const session::FrameMatch &match) override {
    const Mat4 &motion = match.measuredFromBody();
    const auto landmarks = bodyLandmarks();
    if (!landmarks) return tl::unexpected(landmarks.error());
    sendMatch(*link_, motion, *landmarks);
    return image_ ? sendSlice(motion) : Expected<void>();
  }

  std::string streamJson() const override {
    const tracking::LinkStatus status = link_->status();
    return nlohmann::ordered_json{{"address", textOf(link_->address())},
                                  {"received", status.received},
                                  {"replaced", status.replaced},
                                  {"refused", status.refused}}
        .dump();
  }

 private:
  static constexpr double kTimeout_s = 10.0;

  [[nodiscard]] std::function<std::string()> takeError() const {
    return [&session = context_.session] { return session.plugins().takeError(); };
  }

  /// Logs a change of the connection.
  void report(const tracking::LinkStatus &status) {
    if (connection_.update(status.state))
      log(status.state == tracking::LinkState::lost ? LogLevel::warn : LogLevel::info,
          fmt::format("tracking system {}: {}", textOf(link_->address()), textOf(status)));
  }

  Frame accepted(tracking::TrackedFrame tracked) {
    report(link_->status());
    Frame out;
    out.measured.name = std::to_string(++frames_);
    if (tracked.time_s) {
      if (!first_s_) first_s_ = tracked.time_s;
      out.measured.time_s = *tracked.time_s - *first_s_;
    }
    out.landmarks = landmarks_;
    out.measured.measured.points_mm = takeSurfacePoints(tracked, out.landmarks);
    return out;
  }

  /// Where all landmarks of the body, and those in none, are now.
  Expected<std::vector<session::MeasuredLandmark>> bodyLandmarks() {
    std::vector<Landmark> own;
    for (const Landmark &one : landmarks_)
      if (one.body == context_.body || one.body.empty()) own.push_back(one);
    if (own.empty()) return std::vector<session::MeasuredLandmark>();
    auto measured = session::unrecorded(context_.session.changes(), [&] {
      return session::measure(context_.built.simulator.get(), {}, own, takeError());
    });
    if (!measured) return tl::unexpected(measured.error());
    return std::move(measured->landmarks);
  }

  /// The slice of the deformed image through the middle of the body, where it was measured.
  Expected<void> sendSlice(const Mat4 &motion) {
    c3de_object *const simulator = context_.built.simulator.get();
    const auto skins = session::skinsOf(simulator, context_.body, takeError());
    if (!skins) return tl::unexpected(skins.error());
    const auto u = session::presentDisplacement(context_.built.table, simulator, *image_, *warp_);
    if (!u) return tl::unexpected(u.error());
    const Mat4 indexFromWorld = imaging::affineInverse(image_->geometry.indexToWorld);
    double low = 0.0, high = 0.0, reach = 0.0;
    for (std::size_t i = 0; i < skins->present.vertices.size(); ++i) {
      const double k = transformPoint(indexFromWorld, skins->present.vertices[i])[2];
      low = i == 0 ? k : std::min(low, k);
      high = i == 0 ? k : std::max(high, k);
      reach = std::max(reach, std::abs(k - transformPoint(indexFromWorld, skins->rest.vertices[i])[2]));
    }
    const double last = static_cast<double>(image_->geometry.size[2] - 1);
    const double middle = std::round(std::clamp(0.5 * (low + high), 0.0, last));
    // The material of the slice was within this distance of it.
    constexpr double kMargin = 2.0;
    const auto first = static_cast<std::size_t>(std::max(0.0, std::floor(middle - reach - kMargin)));
    const auto end = static_cast<std::size_t>(std::min(last, std::ceil(middle + reach + kMargin)));
    auto slab = session::warpedImage(slabOf(*image_, first, end), session::isImageOfLabels(context_.scene), *u, {},
                                     &context_.session.pool());
    if (!slab) return tl::unexpected(slab.error());
    const auto at = static_cast<std::size_t>(middle) - first;
    imaging::Volume slice = slabOf(*slab, at, at);
    slice.geometry.indexToWorld = multiply(motion, slice.geometry.indexToWorld);
    link_->sendImage(kSliceMessage, slice);
    return {};
  }

  std::unique_ptr<TrackingLink> link_;
  const MatchOptions &options_;
  StreamContext context_;
  std::vector<Landmark> landmarks_;  ///< of the scene
  std::shared_ptr<const imaging::Volume> image_;
  std::optional<session::ImageWarp> warp_;
  tracking::ConnectionChange connection_;
  std::size_t frames_ = 0;
  std::optional<double> first_s_;  ///< time of the first frame
};

}  // namespace

Expected<std::unique_ptr<MeasuredSource>> measuredStream(const MatchOptions &options, StreamContext context) {
  const auto address = tracking::parseTrackingAddress(options.stream);
  if (!address) return fail(ErrorCode::usage, "--stream " + address.error().message);
  auto landmarks = session::landmarksOf(context.scene, options.run.landmarks, {});
  if (!landmarks) return tl::unexpected(landmarks.error());
  const auto found = session::unrecorded(context.session.changes(), [&] {
    return session::findBodies(context.built.simulator.get(), context.scene, *landmarks,
                               [&session = context.session] { return session.plugins().takeError(); });
  });
  if (!found) return tl::unexpected(found.error());
  if (!options.streamTool.empty() && (!options.use.empty() || options.weight))
    return fail(ErrorCode::usage,
                "--stream-tool: a tool measures no landmarks; accepted: --use and --weight without --stream-tool");
  if (landmarks->empty() && (!options.use.empty() || options.weight))
    return fail(ErrorCode::usage,
                "--use and --weight are for landmarks; accepted: landmarks of the scene, or --landmarks");
  std::optional<tracking::TrackedTool> tool;
  if (!options.streamTool.empty()) {
    tool = {options.streamTool};
    if (options.streamToolPoints) tool->frameSize = static_cast<std::size_t>(*options.streamToolPoints);
  }
  auto link = TrackingLink::open(*address, tool);
  if (!link) return fail(link.error().code, "--stream: " + link.error().message);
  auto out = std::make_unique<MeasuredStream>(std::move(*link), options, std::move(context), std::move(*landmarks));
  if (options.sendsSlice)
    if (const auto good = out->prepareSlice(); !good) return tl::unexpected(good.error());
  return out;
}

}  // namespace c3de::app
