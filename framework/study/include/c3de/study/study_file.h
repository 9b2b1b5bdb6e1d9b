// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de::study {

/// A scene path and its value, in the form of `--set PATH=VALUE`.
struct Setting {
  std::string path, value;
  int line = 0;  ///< in the study
};

/// The name of a study parameter, or a scene path, and the values it takes in turn.
struct StudyParameter {
  std::string name;
  std::vector<std::string> values;  ///< in the form of `--set`; texts in quotes
  int line = 0;
  [[nodiscard]] bool isPath() const { return name.find('.') != std::string::npos; }
};

/// Every combination of the values of its study parameters is run.
struct Grid {
  std::string label;
  std::vector<StudyParameter> parameters;
  int line = 0;
};

/// The quantity that is compared with the reference, and plotted.
struct Quantity {
  enum class Kind {
    probe,      ///< displacement of a probe, m
    reaction,   ///< force of a support, N
    torque,     ///< of a support, N m
    frequency,  ///< first frequency of a probe over time, Hz
    energy,     ///< over all bodies, J
    field,      ///< displacement over the volume, relative L2
    surface     ///< displacement of the skin, largest difference, mm
  };
  Kind kind = Kind::field;
  std::string name;           ///< of the probe, or of the energy as in the report
  std::size_t fix = 0;        ///< number of the support
  std::size_t component = 0;  ///< 0 x, 1 y, 2 z, 3 magnitude
  int line = 0;
  [[nodiscard]] bool isField() const { return kind == Kind::field || kind == Kind::surface; }
  [[nodiscard]] std::string unit() const;   ///< of its value: "m", "N", …
  [[nodiscard]] std::string shown() const;  ///< "z of probe 'tip'"
};

/// Source of the reference; one of value, file and richardson.
struct Reference {
  enum class Source { value, file, richardson };
  Source source = Source::value;
  double value = 0.0;        ///< in the unit of the quantity
  double uncertainty = 0.0;  ///< in the unit of the quantity; for a file m
  std::string kind, from;    ///< "formula", "finite_elements" or "measurement"; its bibliographic source
  std::filesystem::path file;
  StudyParameter parameter;  ///< for richardson: three values
  std::vector<Setting> set;  ///< for richardson: settings of these runs in addition to the case
  double share = 0.5;        ///< for richardson: upper limit of its bar, as a fraction of the median error
  int line = 0;
};

struct Case {
  std::string name;
  std::filesystem::path scene;
  std::optional<double> until_s;
  std::optional<std::uint64_t> steps;
  std::vector<Setting> set;
  Quantity quantity;
  Reference reference;
  std::vector<Grid> grids;  ///< its own grids, then those of the study
  int line = 0;
};

struct Study {
  std::filesystem::path source;
  std::string title;
  unsigned repeat = 3;           ///< number of timed runs of a point
  std::optional<unsigned> jobs;  ///< concurrent points; none: as many as there are processors for
  double timeLimit_s = 3600.0;   ///< of a run
  std::uint64_t seed = 1;
  std::size_t samples = 1000;  ///< number of points inside the bodies, and also on their skins, if fields are compared
  std::vector<std::filesystem::path> plugins;  ///< loaded by its runs in addition to those loaded by every run
  std::vector<Case> cases;

  /// "FILE:LINE"
  [[nodiscard]] std::string where(int line) const;
};

/// The names of study parameters allowed in a grid; scene paths are allowed as well.
[[nodiscard]] const std::vector<std::string> &parameterNames();

/// Reads and checks a study. Every error (ErrorCode::input) has the form "FILE:LINE: what is wrong; what is accepted".
/// An unknown key names the nearest known one. Scenes are not opened.
[[nodiscard]] Expected<Study> loadStudy(const std::filesystem::path &file);
/// Same for text; `source` is used in messages, and its folder to find scenes and references.
[[nodiscard]] Expected<Study> parseStudy(std::string_view text, const std::filesystem::path &source);

}  // namespace c3de::study
