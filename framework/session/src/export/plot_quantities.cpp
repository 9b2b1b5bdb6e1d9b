// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/plot_quantities.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "c3de/core/vec.h"

namespace c3de::session {
namespace {

using QuantityJson = nlohmann::json;

/// Empty where it is not there.
const QuantityJson &quantityMember(const QuantityJson &from, const char *key) {
  static const QuantityJson kNone;
  if (!from.is_object()) return kNone;
  const auto found = from.find(key);
  return found == from.end() ? kNone : *found;
}

std::string quantityText(const QuantityJson &from, const char *key, const std::string &otherwise) {
  const QuantityJson &text = quantityMember(from, key);
  return text.is_string() && !text.get_ref<const std::string &>().empty() ? text.get<std::string>() : otherwise;
}

std::optional<Vec3> quantityVector(const QuantityJson &from) {
  if (!from.is_array() || from.size() != 3) return std::nullopt;
  Vec3 out{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!from[i].is_number()) return std::nullopt;
    out[i] = from[i].get<double>();
  }
  return out;
}

/// Adds a text to a set, with " 2" and so on after it if it is there already.
std::string uniqueIn(std::set<std::string> &all, const std::string &text) {
  std::string unique = text;
  for (int i = 2; !all.insert(unique).second; ++i) unique = text + " " + std::to_string(i);
  return unique;
}

/// Where an entry has no name: the number of its fix, otherwise its place in the list, from 1.
std::string quantityNumber(const QuantityJson &one, std::size_t index) {
  const QuantityJson &fix = quantityMember(one, "fix");
  return fix.is_number_integer() ? fix.dump() : std::to_string(index + 1);
}

class QuantityCollector {
 public:
  void add(const std::string &id, const std::string &label, const std::string &unit, const QuantityJson &value,
           double factor = 1.0, bool isMain = false) {
    if (value.is_number()) add(id, label, unit, factor * value.get<double>(), isMain);
  }
  void add(const std::string &id, const std::string &label, const std::string &unit, double value, bool isMain) {
    if (std::isfinite(value)) out_.push_back({uniqueIn(ids_, id), label, unit, value, isMain});
  }
  [[nodiscard]] std::vector<PlotQuantity> take() { return std::move(out_); }

 private:
  std::set<std::string> ids_;
  std::vector<PlotQuantity> out_;
};

void addBodyQuantities(QuantityCollector &to, const QuantityJson &body, const std::string &name) {
  const std::string id = "body." + name + ".";
  for (const auto &[kind, value] : quantityMember(body, "energy_J").items())
    to.add(id + "energy." + kind, name + ": " + kind + " energy", "J", value, 1.0,
           kind == "kinetic" || kind == "elastic");
  to.add(id + "min_J", name + ": smallest det F", "", quantityMember(body, "min_J"));
  to.add(id + "penetration", name + ": deepest penetration", "mm", quantityMember(body, "deepest_penetration_m"), 1e3);
}

void addProbeQuantities(QuantityCollector &to, const QuantityJson &probe, const std::string &name) {
  const auto reference = quantityVector(quantityMember(probe, "reference_m")),
             now = quantityVector(quantityMember(probe, "position_m")),
             velocity = quantityVector(quantityMember(probe, "velocity_m_s"));
  if (reference && now)
    to.add("probe." + name + ".displacement", name + ": displacement", "mm", 1e3 * norm(*now - *reference), true);
  if (velocity) to.add("probe." + name + ".speed", name + ": speed", "mm/s", 1e3 * norm(*velocity), false);
}

/// Each member that ends with "_N": a force, or its magnitude.
void addForceQuantities(QuantityCollector &to, const QuantityJson &one, const std::string &id,
                        const std::string &name) {
  if (!one.is_object()) return;
  for (const auto &[key, value] : one.items()) {
    if (key.size() < 3 || key.compare(key.size() - 2, 2, "_N") != 0) continue;
    const std::string what = key.substr(0, key.size() - 2);
    if (const auto force = quantityVector(value))
      to.add(id + "." + what, name + ": " + what, "N", norm(*force), true);
    else
      to.add(id + "." + what, name + ": " + what, "N", value, 1.0, true);
  }
}

}  // namespace

std::vector<PlotQuantity> plotQuantities(const std::string &report) {
  const QuantityJson all = QuantityJson::parse(report, nullptr, false);
  if (!all.is_object()) return {};
  QuantityCollector to;
  const auto each = [&](const char *key, const char *kind, const auto &visit) {
    const QuantityJson &list = quantityMember(all, key);
    if (!list.is_array()) return;
    std::set<std::string> names;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::string name = quantityText(list[i], "name", kind + (" " + quantityNumber(list[i], i)));
      visit(list[i], uniqueIn(names, name));
    }
  };
  each("bodies", "body", [&](const QuantityJson &one, const std::string &name) { addBodyQuantities(to, one, name); });
  each("probes", "probe", [&](const QuantityJson &one, const std::string &name) { addProbeQuantities(to, one, name); });
  for (const auto &[key, kind] : {std::pair{"reactions", "support"},
                                  {"conditions", "condition"},
                                  {"attachments", "attachment"},
                                  {"probe_tools", "tool"},
                                  {"grasps", "grasp"}})
    each(key, kind, [&, group = key](const QuantityJson &one, const std::string &name) {
      const std::string body = quantityText(one, "body", "");
      addForceQuantities(to, one, std::string(group) + "." + name, body.empty() ? name : name + " of " + body);
    });
  to.add("load_factor", "load factor", "", quantityMember(all, "load_factor"), 1.0, true);
  const QuantityJson &stages = quantityMember(all, "stages");
  if (stages.is_object())
    for (const auto &[name, stage] : stages.items())
      to.add("stage." + name, "stage " + name + " (median)", "ms", quantityMember(stage, "median_ms"));
  return to.take();
}

}  // namespace c3de::session
