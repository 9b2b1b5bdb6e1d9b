// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/session/match_stages.h"
#include "commands/measured_source.h"

namespace c3de::app {
namespace {

class MeasuredFiles : public MeasuredSource {
 public:
  MeasuredFiles(std::vector<session::MeasuredFrame> frames, std::vector<std::vector<session::Landmark>> landmarks)
      : frames_(std::move(frames)), landmarks_(std::move(landmarks)) {}

  Expected<std::optional<Frame>> next(const ProgressFn &) override {
    if (taken_ == frames_.size()) return std::nullopt;
    Frame out{std::move(frames_[taken_]), std::move(landmarks_[taken_])};
    ++taken_;
    return out;
  }
  std::optional<std::size_t> count() const override { return frames_.size(); }
  Expected<void> send(const session::FrameMatch &) override { return {}; }

 private:
  std::vector<session::MeasuredFrame> frames_;
  std::vector<std::vector<session::Landmark>> landmarks_;
  std::size_t taken_ = 0;
};

}  // namespace

Expected<std::unique_ptr<MeasuredSource>> measuredFiles(const MatchOptions &options, const scene::SceneFile &scene,
                                                        const scene::SceneMatch &wanted) {
  auto frames = session::readMeasuredFrames(options.frames, wanted.unit);
  if (!frames) return tl::unexpected(frames.error());
  auto all = session::landmarksOf(scene, options.run.landmarks, {});
  if (!all) return tl::unexpected(all.error());
  std::vector<std::vector<session::Landmark>> landmarks;
  bool areMeasured = false;
  for (const session::MeasuredFrame &frame : *frames) {
    if (const auto good = session::setTargets(frame.measured.landmarks, *all); !good)
      return tl::unexpected(good.error());
    landmarks.push_back(session::withTargets(*all));
    areMeasured = areMeasured || !frame.measured.landmarks.empty();
  }
  if (!areMeasured && (!options.use.empty() || options.weight || !options.run.landmarks.empty()))
    return fail(ErrorCode::usage, pathText(options.frames) +
                                      ": no landmark was measured, so --landmarks, --use and --weight have no effect; "
                                      "accepted: rows with a name in the column 'landmark'");
  return std::make_unique<MeasuredFiles>(std::move(*frames), std::move(landmarks));
}

}  // namespace c3de::app
