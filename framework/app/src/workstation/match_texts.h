// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app.h"
#include "c3de/session/rigid_match.h"
#include "c3de/ui/match_panel.h"

namespace c3de::app {

/// The result of a match for its panel, with the words of `c3de match`.
/// @param chosen  candidate that the user has chosen; none: the best
[[nodiscard]] ui::MatchTexts textsOf(const MatchTargets &targets, const RigidMatch &match, const ElasticMatch &elastic,
                                     std::optional<std::size_t> chosen);

}  // namespace c3de::app
