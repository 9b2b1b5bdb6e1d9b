// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/first_size.h"
#include "c3de/core/log.h"
#include "c3de/core/text.h"

namespace c3de::session {

/// Reads the fields of one body at its points or on its surface.
class FieldReader {
 public:
  FieldReader(const c3de_simulator_v1 *table, c3de_object *simulator, c3de_handle body, std::uint32_t on,
              std::size_t count)
      : table_(table), simulator_(simulator), body_(body), on_(on), count_(count) {}

  struct Field {
    std::string name, unit;
    std::size_t components;
  };
  /// In the order of the simulator.
  [[nodiscard]] std::vector<Field> fields() const {
    struct Visit {
      std::uint32_t on;
      std::vector<Field> found;
    } visit{on_, {}};
    (void)table_->enum_fields(simulator_, body_, &visit, [](void *visitor, const c3de_sim_field *field) -> c3de_status {
      // No exception may cross the boundary.
      try {
        auto &to = *static_cast<Visit *>(visitor);
        if (const std::string problem = sizeProblem(field); !problem.empty()) {
          log(LogLevel::error, "a field of the simulator cannot be read: " + problem);
          return C3DE_E_ARG;
        }
        const bool isKnown = field->comps == 1 || field->comps == 3 || field->comps == 9;
        if (field->on == to.on && isKnown)
          to.found.push_back({std::string(fromAbi(field->name)), displayText(fromAbi(field->unit)), field->comps});
        return C3DE_OK;
      } catch (...) {
        return C3DE_E_NOMEM;
      }
    });
    return visit.found;
  }
  /// None: the body does not have the field.
  [[nodiscard]] std::optional<std::vector<double>> read(const std::string &name, std::size_t components) const {
    std::vector<double> out(count_ * components);
    if (count_ == 0) return out;
    const c3de_mview view{out.data(), count_, static_cast<std::uint32_t>(components), C3DE_F64, 0};
    if (table_->read_field(simulator_, body_, on_, toAbi(name), view) < 0) return std::nullopt;
    return out;
  }

 private:
  const c3de_simulator_v1 *table_;
  c3de_object *simulator_;
  c3de_handle body_;
  std::uint32_t on_;
  std::size_t count_;
};

}  // namespace c3de::session
