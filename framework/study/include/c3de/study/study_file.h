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

/// A scene path and what it is set to, as `--set PATH=VALUE` takes it.
struct Setting {
  std::string path, value;
  int line = 0;  ///< of the study
};

/// A name of a lever, or a scene path, and the values that it takes in turn.
struct Lever {
  std::string name;
  std::vector<std::string> values;  ///< as `--set` takes them; texts in quotes
  int line = 0;
  [[nodiscard]] bool isPath() const { return name.find('.') != std::string::npos; }
};

/// Every combination of the values of its levers is run.
struct Grid {
  std::string label;
  std::vector<Lever> levers;
  int line = 0;
};

/// What is compared with the reference, and drawn.
struct Quantity {
  enum class Kind {
    probe,      ///< displacement of a probe, m
    reaction,   ///< force of a support, N
    torque,     ///< of a support, N m
    frequency,  ///< first one of a probe over time, Hz
    energy,     ///< over all bodies, J
    field,      ///< displacement over the volume, relative L2
    surface     ///< displacement of the skin, largest difference, mm
  };
  Kind kind = Kind::field;
  std::string name;           ///< of the probe, or of the energy as the report has it
  std::size_t fix = 0;        ///< number of the support
  std::size_t component = 0;  ///< 0 x, 1 y, 2 z, 3 magnitude
  int line = 0;
  [[nodiscard]] bool isField() const { return kind == Kind::field || kind == Kind::surface; }
  [[nodiscard]] std::string unit() const;   ///< of its value: "m", "N", …
  [[nodiscard]] std::string shown() const;  ///< "z of probe 'tip'"
};

/// Where truth comes from; one of value, file and richardson.
struct Reference {
  enum class Source { value, file, richardson };
  Source source = Source::value;
  double value = 0.0;        ///< in the unit of the quantity
  double uncertainty = 0.0;  ///< likewise; of a file m
  std::string kind, from;    ///< "formula", "finite_elements" or "measurement"; where it can be looked up
  std::filesystem::path file;
  Lever lever;               ///< of richardson: three values
  std::vector<Setting> set;  ///< of richardson: what these runs have beside the case
  double share = 0.5;        ///< of richardson: the most that its bar may be of the median error
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
  std::vector<Grid> grids;  ///< its own, then those of the study
  int line = 0;
};

struct Study {
  std::filesystem::path source;
  std::string title;
  unsigned repeat = 3;           ///< timed runs of a point
  std::optional<unsigned> jobs;  ///< points at a time; none: as many as there are processors for
  double timeLimit_s = 3600.0;   ///< of a run
  std::uint64_t seed = 1;
  std::size_t samples = 1000;  ///< points inside the bodies and as many on their skins, where fields are compared
  std::vector<std::filesystem::path> plugins;  ///< that its runs load beside those that every run does
  std::vector<Case> cases;

  /// "FILE:LINE"
  [[nodiscard]] std::string where(int line) const;
};

/// The names of levers, as they may stand in a grid; beside them any scene path.
[[nodiscard]] const std::vector<std::string> &leverNames();

/// Reads and checks a study. Every error (ErrorCode::input) reads "FILE:LINE: what is wrong; what is accepted"; an
/// unknown key names the nearest known one. Scenes are not opened.
[[nodiscard]] Expected<Study> loadStudy(const std::filesystem::path &file);
/// The same for text; `source` is used in messages, and its folder to find scenes and references.
[[nodiscard]] Expected<Study> parseStudy(std::string_view text, const std::filesystem::path &source);

}  // namespace c3de::study
