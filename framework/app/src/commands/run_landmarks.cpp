// SPDX-License-Identifier: Apache-2.0
#include "commands/run_landmarks.h"

#include "app.h"
#include "c3de/core/log.h"
#include "c3de/session/report.h"

namespace c3de::app {

Expected<std::vector<Landmark>> readRunLandmarks(const RunOptions &options, const scene::SceneFile &scene) {
  auto landmarks = landmarksOf(scene, options.landmarks, options.targetLandmarks);
  if (!landmarks || options.exportLandmarks.empty()) return landmarks;
  if (const auto good = checkLandmarkPath(options.exportLandmarks, "--export-landmarks"); !good)
    return tl::unexpected(good.error());
  if (landmarks->empty())
    return fail(ErrorCode::usage,
                "--export-landmarks needs landmarks; accepted: [[landmark]] in the scene, or "
                "--landmarks FILE");
  return landmarks;
}

Expected<std::string> lostPoints(const HeadlessRun &run) {
  const auto report = run.simulatorReport();
  if (!report) return tl::unexpected(report.error());
  const auto events = eventsOf(*report, "renewed");
  return events.empty() ? std::string() : events.front();
}

Measurements measureEnd(const RunOptions &options, const std::vector<Landmark> &landmarks,
                        const scene::SceneFile &scene, Session &session, c3de_object *simulator, const HeadlessRun &run,
                        WrittenOutputs &outputs) {
  if (landmarks.empty()) return {};
  Expected<Measurements> measured;
  if (const auto lost = lostPoints(run); !lost)
    measured = tl::unexpected(lost.error());
  else if (!lost->empty())
    measured = fail(ErrorCode::input, "landmarks cannot be followed to the end: " + *lost);
  else
    measured = measure(simulator, scene, landmarks, [&session] { return session.plugins().takeError(); });
  if (!measured) {
    if (options.exportLandmarks.empty())
      log(LogLevel::warn, "no landmark is measured: " + measured.error().message);
    else
      outputs.addFailure(options.exportLandmarks, measured.error());
    return {};
  }
  if (!options.exportLandmarks.empty()) {
    std::vector<WrittenLandmark> written;
    for (const MeasuredLandmark &one : measured->landmarks)
      written.push_back({one.landmark.name, one.landmark.reference_mm, one.position_mm});
    outputs.note(options.exportLandmarks, writeLandmarks(options.exportLandmarks, written));
  }
  return std::move(*measured);
}

}  // namespace c3de::app
