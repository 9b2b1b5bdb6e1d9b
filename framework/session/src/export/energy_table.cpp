// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/energy_table.h"

#include <nlohmann/json.hpp>

#include "c3de/core/csv.h"
#include "c3de/core/text.h"

namespace c3de::session {

Expected<std::map<std::string, double>> energiesOf(const std::string &simulatorJson) {
  const auto json = nlohmann::json::parse(simulatorJson, nullptr, false);
  std::map<std::string, double> sums;
  if (json.is_object() && json.contains("bodies"))
    for (const auto &body : json["bodies"])
      if (body.is_object() && body.contains("energy_J") && body["energy_J"].is_object())
        for (const auto &[name, value] : body["energy_J"].items())
          if (value.is_number()) sums[name] += value.get<double>();
  if (sums.empty()) return fail(ErrorCode::plugin, "the simulator reports no energies");
  return sums;
}

Expected<EnergyTable> EnergyTable::create(const std::filesystem::path &file, const std::string &simulatorJson) {
  const auto energies = energiesOf(simulatorJson);
  if (!energies) return tl::unexpected(energies.error());
  auto rows = OutputRows::open(file);
  if (!rows) return tl::unexpected(rows.error());
  std::string head = "time [s]";
  std::vector<std::string> names;
  for (const auto &[name, value] : *energies) {
    names.push_back(name);
    head += ',' + csvCell(displayText(name) + " [J]");
  }
  if (const auto added = rows->add(head + '\n'); !added) return tl::unexpected(added.error());
  return EnergyTable(std::move(*rows), std::move(names));
}

Expected<void> EnergyTable::add(double time_s, const std::string &simulatorJson) {
  const auto energies = energiesOf(simulatorJson);
  if (!energies) return tl::unexpected(energies.error());
  std::string row = formatNumber(time_s);
  for (const std::string &name : names_) {
    const auto found = energies->find(name);
    row += ',' + (found == energies->end() ? std::string() : formatNumber(found->second));
  }
  return rows_.add(row + '\n');
}

}  // namespace c3de::session
