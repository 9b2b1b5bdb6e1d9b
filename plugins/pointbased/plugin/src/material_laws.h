// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <deque>
#include <memory>

#include "c3de/pointbased/material_law.hpp"
#include "parameters.h"
#include "pointbased/elastic_law.h"

namespace pointbased {

/// The material laws that other plugins offer, and the parameters of a body with those of all laws.
class MaterialLaws {
 public:
  explicit MaterialLaws(const Services &services);
  MaterialLaws(const MaterialLaws &) = delete;
  MaterialLaws &operator=(const MaterialLaws &) = delete;

  /// Finds the classes that have come since; one that cannot be taken is logged. Main thread.
  void refresh();
  /// bodyDeclarations() with the ids of laws among the choices of material.law, and their parameters behind. What was
  /// handed out stays valid as long as this. Any thread.
  [[nodiscard]] std::span<const c3de_param_decl> declarations() const { return current_.load()->declarations; }
  /// The material that values say. Errors as sdk::Error, `whose` in front: a law that fails its checks, a parameter of
  /// a law that is not the chosen one.
  /// @param own  null, or the ids that are said here; only these are held against the law
  [[nodiscard]] Material materialOf(const std::string &whose, const ParameterValues &values,
                                    const std::vector<std::string> *own = nullptr) const;

 private:
  struct Parameter {
    std::string id;  ///< with "material."
    c3de_param_decl declaration;
  };
  struct Offer {
    std::string id, plugin;
    sdk::Ref<> object;
    const c3de_material_law_v1 *table = nullptr;
    std::deque<Parameter> parameters;
    [[nodiscard]] bool has(std::string_view parameter) const;
  };
  struct Generation {
    std::vector<c3de_str> choices;
    std::vector<c3de_param_decl> declarations;
    std::vector<std::shared_ptr<const Offer>> offers;
  };
  class Law;
  void take(std::shared_ptr<Offer> offer, Generation &next) const;

  const Services &services_;
  std::deque<Generation> generations_;  // grows only
  std::atomic<const Generation *> current_{nullptr};
};

}  // namespace pointbased
