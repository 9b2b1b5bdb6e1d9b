// SPDX-License-Identifier: Apache-2.0
#include "files/table_rows.h"

#include <charconv>
#include <cmath>
#include <fstream>

#include "c3de/core/csv.h"
#include "c3de/core/input_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"

namespace c3de::session {

std::string trimmed(const std::string &text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::optional<double> finiteNumber(const std::string &text, double largest) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !(std::abs(number) <= largest)) return std::nullopt;
  return number;
}

tl::unexpected<Error> refusedRow(const std::filesystem::path &file, int line, const std::string &what) {
  return fail(ErrorCode::input, displayMessage(pathText(file) + ":" + std::to_string(line) + ": " + what));
}

Expected<void> readRows(const std::filesystem::path &file,
                        const std::function<Expected<void>(int line, const std::vector<std::string> &cells)> &row) {
  auto opened = openInputFile(file);
  if (!opened) return tl::unexpected(opened.error());
  std::string text;
  for (int line = 1; std::getline(*opened, text); ++line) {
    if (line == 1 && text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
    text = trimmed(text);
    if (text.empty() || text.front() == '#') continue;
    auto cells = splitCsvRow(text);
    if (!cells) return refusedRow(file, line, "a quotation mark is not closed; accepted: a row of cells");
    for (std::string &cell : *cells) cell = trimmed(cell);
    if (auto good = row(line, *cells); !good) return good;
  }
  return {};
}

}  // namespace c3de::session
