// SPDX-License-Identifier: Apache-2.0
#include "ui/workstation_state.h"

#include <cmath>
#include <cstdlib>
#include <sstream>

namespace c3de::test {

using nlohmann::json;

std::string textOf(const json &state, const std::string &key) { return state["values"].value(key, std::string()); }

double numberOf(const json &state, const std::string &key) {
  const std::string text = textOf(state, key);
  char *end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  return end == text.c_str() ? std::nan("") : number;
}

Vec3 vectorOf(const json &state, const std::string &key) {
  Vec3 at{};
  std::istringstream(textOf(state, key)) >> at[0] >> at[1] >> at[2];
  return at;
}

std::string row(const json &state, const std::string &name) { return textOf(state, kPanel + name); }
std::string imageText(const json &state, const std::string &key) { return textOf(state, "image/" + key); }
double imageNumber(const json &state, const std::string &key) { return numberOf(state, "image/" + key); }

double displacement_mm(const json &state, const std::string &pane) {
  const std::string readout = imageText(state, pane + ".readout");
  const std::size_t at = readout.find("|u| ");
  return at == std::string::npos ? std::nan("") : std::strtod(readout.c_str() + at + 4, nullptr);
}

std::string mode(const json &state) { return state["transport"]["mode"]; }

}  // namespace c3de::test
