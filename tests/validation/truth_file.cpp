// SPDX-License-Identifier: Apache-2.0
#include "truth_file.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace validation {

std::optional<ReferenceSolution> truth(const std::string &name) {
  std::ifstream in(C3DE_TRUTHS, std::ios::binary);
  const auto cases = nlohmann::json::parse(in, nullptr, false);
  if (!cases.is_array()) throw std::runtime_error("cannot read " C3DE_TRUTHS);
  for (const auto &entry : cases)
    if (entry.value("name", "") == name)
      return ReferenceSolution{entry.at("value").get<double>(), entry.at("uncertainty").get<double>(),
                               entry.value("unit", ""),
                               entry.at("parameters").value("gravity", std::array<double, 3>{})};
  return std::nullopt;
}

}  // namespace validation
