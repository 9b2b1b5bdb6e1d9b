// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace c3de {

/// A CSV cell: in quotes if it contains special characters.
[[nodiscard]] std::string csvCell(const std::string &text);
/// The cells of one row, without its end of line; quotes are removed. None: a quote is not closed.
[[nodiscard]] std::optional<std::vector<std::string>> splitCsvRow(std::string_view row);

}  // namespace c3de
