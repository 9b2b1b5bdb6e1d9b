// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/study/study_file.h"

namespace c3de::study {

/// One value of a lever.
struct LeverValue {
  std::string lever, value;  ///< the value as `--set` takes it
  int line = 0;              ///< of the study
};

/// Every combination of the values, in the order of the file; the last lever changes fastest.
[[nodiscard]] std::vector<std::vector<LeverValue>> combinations(const std::vector<Lever> &levers);

/// What a lever sets in a scene; nothing for "threads".
/// @param bodies  names of those that deform: levers of sampling and material are of all of them
[[nodiscard]] std::vector<Setting> settingsOf(const LeverValue &value, const std::vector<std::string> &bodies);

/// The text of a value: what stands between its quotes, or all of it.
[[nodiscard]] std::string withoutQuotes(const std::string &value);

/// For people: "10 mm" of spacing = 0.01, "stvk" of law, the value as it is of a path.
[[nodiscard]] std::string shownValue(const LeverValue &value);
/// "spacing 10 mm, law stvk"
[[nodiscard]] std::string shown(const std::vector<LeverValue> &values);

/// The size that Richardson's extrapolation takes to 0: the value itself, 1/substeps, count^(-1/3).
[[nodiscard]] double refinementOf(const LeverValue &value);

}  // namespace c3de::study
