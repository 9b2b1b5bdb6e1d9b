// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/csv.h"

namespace c3de {

std::string csvCell(const std::string &text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

std::optional<std::vector<std::string>> splitCsvRow(std::string_view row) {
  if (!row.empty() && row.back() == '\r') row.remove_suffix(1);
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (quoted) {
      if (row[i] != '"')
        cells.back() += row[i];
      else if (i + 1 < row.size() && row[i + 1] == '"')
        cells.back() += row[i++];
      else
        quoted = false;
    } else if (row[i] == '"' && cells.back().empty()) {
      quoted = true;
    } else if (row[i] == ',') {
      cells.emplace_back();
    } else {
      cells.back() += row[i];
    }
  }
  if (quoted) return std::nullopt;
  return cells;
}

}  // namespace c3de
