// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/study/study_file.h"

namespace c3de::study {

/// One value of a study parameter.
struct StudyParameterValue {
  std::string parameter, value;  ///< the value in the form of `--set`
  int line = 0;                  ///< in the study
};

/// Every combination of the values, in the order of the file; the last study parameter changes fastest.
[[nodiscard]] std::vector<std::vector<StudyParameterValue>> combinations(const std::vector<StudyParameter> &parameters);

/// The settings of a scene for a study parameter; nothing for "threads".
/// @param bodies  names of the deformable bodies: parameters of sampling and material apply to all of them
[[nodiscard]] std::vector<Setting> settingsOf(const StudyParameterValue &value, const std::vector<std::string> &bodies);

/// The text of a value: the part between its quotes, or all of it.
[[nodiscard]] std::string withoutQuotes(const std::string &value);

/// Display text: "10 mm" for spacing = 0.01, "stvk" for law; for a path the value itself.
[[nodiscard]] std::string shownValue(const StudyParameterValue &value);
/// "spacing 10 mm, law stvk"
[[nodiscard]] std::string shown(const std::vector<StudyParameterValue> &values);

/// The size that tends to 0 in Richardson's extrapolation: the value itself, 1/substeps, count^(-1/3).
[[nodiscard]] double refinementOf(const StudyParameterValue &value);

}  // namespace c3de::study
