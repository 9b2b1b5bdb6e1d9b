// SPDX-License-Identifier: Apache-2.0
// Rows of tables of numbers, which instruments and spreadsheets write. Private to the session.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de::session {

/// Without blanks, tabs and carriage returns at both ends.
[[nodiscard]] std::string trimmed(const std::string &text);
/// None: the text is no number, or one that is not finite or exceeds the largest magnitude.
[[nodiscard]] std::optional<double> finiteNumber(const std::string &text, double largest);
/// An error (ErrorCode::input) that begins with file and line.
[[nodiscard]] tl::unexpected<Error> refusedRow(const std::filesystem::path &file, int line, const std::string &what);

/// Reads the rows of a CSV in their order; empty rows and those that begin with `#` are omitted. Errors
/// (ErrorCode::input): the file cannot be read, a quotation mark that is not closed, the first error of the function.
/// @param row  receives the number of the line and its trimmed cells
[[nodiscard]] Expected<void> readRows(
    const std::filesystem::path &file,
    const std::function<Expected<void>(int line, const std::vector<std::string> &cells)> &row);

}  // namespace c3de::session
