// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/scene/toml_document.h"

namespace c3de::scene {

/// TOML text of a root table. Its tables are sections [key], lists of tables in it and in those [[key]]; what is deeper
/// is written in line, or on several lines where it is long. parseToml() reads it as an equal table.
[[nodiscard]] std::string tomlText(const TomlValue &root);

/// The same value; lines and the order of keys do not matter, the sign of zero does.
[[nodiscard]] bool areEqual(const TomlValue &a, const TomlValue &b);

[[nodiscard]] TomlValue tomlString(std::string text);
[[nodiscard]] TomlValue tomlList(std::vector<TomlValue> items);

}  // namespace c3de::scene
