// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/session/recording_file.h"
#include "c3de/session/saved_session.h"

namespace c3de::session {

// A report about a problem is a recording with further members in its session. `c3de replay` repeats it.
inline constexpr const char *kReportText = "report/description.txt";
inline constexpr const char *kReportVersions = "report/versions.json";
inline constexpr const char *kReportValues = "report/values.txt";
inline constexpr const char *kReportLog = "report/log.txt";

/// What has happened in a simulation since it began.
struct ReportedPast {
  CapturedState start;
  std::filesystem::path recording;  ///< of events; its own start has no scene
};

struct ProblemReport {
  std::string description;  ///< what happened, by the user
  std::string versions;     ///< JSON: program, plugins, system
  std::string values;       ///< of parameters, one a line
  std::string log;
  std::optional<ReportedPast> past{};  ///< none: no simulation
  bool hasImage = false;               ///< the images of the scenes are in it
};

/// A text without personal data: the home folder becomes "~", the name of the user "USER".
[[nodiscard]] std::string withoutPersonalData(std::string text);

/// Whether bodies are made from an image that is not a label map of a format without names of patients. Their recording
/// needs the image.
[[nodiscard]] bool needsImage(const SimulationSource &source);
/// A simulation without the images that are only shown.
[[nodiscard]] SimulationSource withoutImages(const SimulationSource &source);

/// Writes the report with all files of its scenes. The file appears complete. Any thread. Errors: those of sessionOf(),
/// readRecording() and writeRecordingStart(); state: the bodies need the image, or a change names the home folder;
/// output; cancelled, if `progress` returns false.
[[nodiscard]] Expected<void> writeProblemReport(const ProblemReport &report, const std::filesystem::path &file,
                                                const ProgressFn &progress = {});

}  // namespace c3de::session
