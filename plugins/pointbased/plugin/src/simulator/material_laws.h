// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <deque>
#include <memory>

#include "base/parameters.h"
#include "c3de/pointbased/material_law.hpp"
#include "pointbased/elastic_law.h"

namespace pointbased {

/// The material laws offered by other plugins, and the body parameters including those of all laws.
class MaterialLaws {
 public:
  explicit MaterialLaws(const Services &services);
  MaterialLaws(const MaterialLaws &) = delete;
  MaterialLaws &operator=(const MaterialLaws &) = delete;

  /// Discovers newly registered classes; one that cannot be used is logged. Main thread.
  void refresh();
  /// bodyDeclarations() with the ids of laws among the choices of material.law, followed by their parameters. Returned
  /// spans remain valid as long as this object. Any thread.
  [[nodiscard]] std::span<const c3de_param_decl> declarations() const { return current_.load()->declarations; }
  /// The material specified by the values. Throws sdk::Error, prefixed with `whose`, for a law that fails its checks
  /// and for a parameter of a law that is not the chosen one.
  /// @param own  null, or the ids specified here; only these are checked against the law
  [[nodiscard]] Material materialOf(const std::string &whose, const ParameterValues &values,
                                    const std::vector<std::string> *own = nullptr) const;

 private:
  struct Parameter {
    std::string id;  ///< including "material."
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
  void addOffer(std::shared_ptr<Offer> offer, Generation &next) const;

  const Services &services_;
  std::deque<Generation> generations_;  // only grows
  std::atomic<const Generation *> current_{nullptr};
};

}  // namespace pointbased
