// SPDX-License-Identifier: Apache-2.0
// The part of JSON Schema (draft 2020-12) that resources/schemas uses.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

/// Every departure of a document from a schema, as "/path: what". An unknown keyword of the schema is one as well, so
/// that no part of a schema is silently without effect.
std::vector<std::string> departuresFrom(const nlohmann::json &schema, const nlohmann::json &document);
