// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace c3de {

/// A cell as CSV wants it: in quotes where it holds what CSV means something by.
[[nodiscard]] std::string csvCell(const std::string &text);
/// The cells of one row, without its end of line; quotes are taken off. None: a quote is not closed.
[[nodiscard]] std::optional<std::vector<std::string>> splitCsvRow(std::string_view row);

}  // namespace c3de
