// SPDX-License-Identifier: Apache-2.0
#include "simulator/material_laws.h"

#include <algorithm>

#include "c3de/sdk/structs.hpp"

namespace pointbased {
namespace {

using sdk::Error;
using sdk::text;

constexpr std::string_view kLaw = "material.law", kYoung = "material.youngs_modulus",
                           kPoisson = "material.poisson_ratio";

bool equal(const c3de_param_decl &a, const c3de_param_decl &b) {
  return a.type == b.type && text(a.unit) == text(b.unit) && a.min == b.min && a.max == b.max &&
         a.fallback == b.fallback && text(a.fallback_text) == text(b.fallback_text) && a.choices_n == b.choices_n &&
         std::equal(a.choices, a.choices + a.choices_n, b.choices,
                    [](const c3de_str &x, const c3de_str &y) { return text(x) == text(y); });
}

bool isNumeric(std::uint32_t type) {
  return type == C3DE_PARAM_F64 || type == C3DE_PARAM_I64 || type == C3DE_PARAM_BOOL || type == C3DE_PARAM_CHOICE;
}

double numberOf(const ParameterValues &values, const std::string &id, const c3de_param_decl &d) {
  if (d.type != C3DE_PARAM_CHOICE) return values.number(id);
  const std::string chosen = values.text(id);
  const auto *found =
      std::find_if(d.choices, d.choices + d.choices_n, [&](const c3de_str &c) { return text(c) == chosen; });
  return static_cast<double>(found - d.choices);
}

}  // namespace

bool MaterialLaws::Offer::has(std::string_view parameter) const {
  return std::any_of(parameters.begin(), parameters.end(), [&](const Parameter &p) { return p.id == parameter; });
}

/// One law with the parameter values of one material.
class MaterialLaws::Law : public ElasticLaw {
 public:
  Law(sdk::Host host, std::shared_ptr<const Offer> offer, const ParameterValues &values)
      : host_(host), offer_(std::move(offer)) {
    for (const Parameter &p : offer_->parameters) params_.push_back(numberOf(values, p.id, p.declaration));
  }
  [[nodiscard]] std::string name() const override {
    return "law '" + offer_->id + "' of plugin '" + offer_->plugin + "'";
  }
  [[nodiscard]] Result<void> energies(std::span<const Mat3> F, std::span<double> W) const override {
    return answered(offer_->table->energy(offer_->object.get(), params_.data(), F.size(), F.front().data(), W.data()));
  }
  [[nodiscard]] Result<void> stresses(std::span<const Mat3> F, std::span<Mat3> P) const override {
    return answered(
        offer_->table->stress(offer_->object.get(), params_.data(), F.size(), F.front().data(), P.front().data()));
  }
  [[nodiscard]] Result<void> differentials(std::span<const Mat3> F, std::span<const Mat3> dF,
                                           std::span<Mat3> dP) const override {
    return answered(offer_->table->differential(offer_->object.get(), params_.data(), F.size(), F.front().data(),
                                                dF.front().data(), dP.front().data()));
  }
  [[nodiscard]] bool hasBounds() const override { return offer_->table->bounds != nullptr; }
  [[nodiscard]] Result<void> bounds(std::span<const Mat3> F, std::span<TangentBound> out) const override {
    static_assert(sizeof(TangentBound) == 2 * sizeof(double) && sizeof(Mat3) == 9 * sizeof(double));
    if (!hasBounds()) return ElasticLaw::bounds(F, out);
    return answered(
        offer_->table->bounds(offer_->object.get(), params_.data(), F.size(), F.front().data(), &out.front().wave));
  }

 private:
  [[nodiscard]] Result<void> answered(c3de_status status) const {
    if (status >= 0) return {};
    return tl::unexpected<std::string>(host_.failure(status).message);
  }

  sdk::Host host_;
  std::shared_ptr<const Offer> offer_;
  std::vector<double> params_;
};

MaterialLaws::MaterialLaws(const Services &services) : services_(services) {
  Generation &first = generations_.emplace_back();
  first.declarations.assign(bodyDeclarations().begin(), bodyDeclarations().end());
  for (const c3de_param_decl &d : first.declarations)
    if (text(d.id) == kLaw) first.choices.assign(d.choices, d.choices + d.choices_n);
  current_ = &first;
}

void MaterialLaws::refresh() {
  std::vector<std::shared_ptr<Offer>> found;
  const auto each = [](void *self, const c3de_class_info *info) noexcept -> c3de_status {
    return sdk::guard([&] {
      auto offer = std::make_shared<Offer>();
      offer->id = text(info->id);
      offer->plugin = text(info->plugin_id);
      static_cast<std::vector<std::shared_ptr<Offer>> *>(self)->push_back(std::move(offer));
    });
  };
  const auto *registry = services_.registry.table();
  sdk::orThrow(services_.host.check(
      registry->enum_classes(registry->ctx, sdk::str(C3DE_POINTBASED_MATERIAL_LAW_ID), &found, +each)));
  const auto &known = current_.load()->offers;
  std::erase_if(found, [&](const auto &offer) {
    return std::any_of(known.begin(), known.end(), [&](const auto &old) { return old->id == offer->id; });
  });
  if (found.empty()) return;
  Generation next = *current_.load();
  for (auto &offer : found) {
    const std::string name = "material law '" + offer->id + "' of plugin '" + offer->plugin + "'";
    try {
      addOffer(std::move(offer), next);
    } catch (const Error &error) {
      services_.log.error(name + " is not offered: " + std::string(error.what()));
    }
  }
  if (next.offers.size() == known.size()) return;
  Generation &stored = generations_.emplace_back(std::move(next));
  for (c3de_param_decl &d : stored.declarations)
    if (text(d.id) == kLaw) {
      d.choices = stored.choices.data();
      d.choices_n = stored.choices.size();
    }
  current_ = &stored;
}

void MaterialLaws::addOffer(std::shared_ptr<Offer> offer, Generation &next) const {
  offer->object = sdk::orThrow(services_.registry.create(offer->id));
  offer->table = offer->object.query<c3de_material_law_v1>();
  if (!offer->table)
    throw Error(C3DE_E_VERSION, std::string("its objects do not implement ") + C3DE_POINTBASED_MATERIAL_LAW_ID);
  constexpr std::uint32_t kFirstSize = 48;  // of revision 1
  static_assert(sizeof(void *) != 8 || sizeof(c3de_material_law_v1) >= kFirstSize);
  if (offer->table->size < kFirstSize)
    throw Error(C3DE_E_ARG, std::string("its table of ") + C3DE_POINTBASED_MATERIAL_LAW_ID + ": its member size is " +
                                std::to_string(offer->table->size) + ", needed are at least " +
                                std::to_string(kFirstSize));
  const c3de_param_decl *decls = nullptr;
  std::uint64_t n = 0, stride = 0;
  sdk::orThrow(services_.host.check(offer->table->declarations(offer->object.get(), &decls, &n, &stride)));
  std::vector<const Parameter *> added;
  for (std::uint64_t i = 0; i < n; ++i) {
    Parameter &p = offer->parameters.emplace_back();
    const c3de_param_decl in = sdk::readElement(decls, i, stride, "declaration");
    p.declaration = in;
    p.id = "material." + std::string(text(in.id));
    p.declaration.size = sizeof(c3de_param_decl);
    p.declaration.id = sdk::str(p.id);
    p.declaration.group = sdk::str("Material");
    if (!isNumeric(in.type) || (in.flags & C3DE_PARAM_AUTO))
      throw Error(C3DE_E_ARG, "parameter " + p.id + " is neither a number nor a boolean nor a choice");
    const auto same = std::find_if(next.declarations.begin(), next.declarations.end(),
                                   [&](const c3de_param_decl &d) { return text(d.id) == p.id; });
    if (same == next.declarations.end()) {
      added.push_back(&p);
      continue;
    }
    const bool ours = std::any_of(bodyDeclarations().begin(), bodyDeclarations().end(),
                                  [&](const c3de_param_decl &d) { return text(d.id) == p.id; });
    if (p.id == kYoung || p.id == kPoisson) {
      if (in.type != C3DE_PARAM_F64 || text(in.unit) != text(same->unit))
        throw Error(C3DE_E_ARG, p.id + " is declared otherwise than by the point-based plugin");
    } else if (ours) {
      throw Error(C3DE_E_EXISTS, p.id + " is a parameter of the point-based plugin; accepted: another id");
    } else if (!equal(p.declaration, *same)) {
      throw Error(C3DE_E_EXISTS, p.id +
                                     " is declared by another law with another type, unit, range or default; "
                                     "accepted: an id that begins with a name of the law's own");
    }
  }
  for (const Parameter *p : added) next.declarations.push_back(p->declaration);
  next.choices.push_back(sdk::str(offer->id));
  next.offers.push_back(std::move(offer));
}

Material MaterialLaws::materialOf(const std::string &whose, const ParameterValues &values,
                                  const std::vector<std::string> *own) const {
  Material material = pointbased::materialOf(values);
  const std::string chosen = values.text(kLaw);
  const Generation &now = *current_.load();
  std::shared_ptr<const Offer> law;
  for (const auto &offer : now.offers)
    if (offer->id == chosen) law = offer;
  const auto isSpecified = [&](std::string_view id) {
    return values.differs(id) && (own == nullptr || std::find(own->begin(), own->end(), id) != own->end());
  };
  const auto refuse = [&](std::string_view id) {
    std::string accepted;
    if (law)
      for (const Parameter &p : law->parameters) accepted += (accepted.empty() ? "" : ", ") + p.id;
    throw Error(C3DE_E_ARG, whose + ": " + std::string(id) + " is not a parameter of material.law = \"" + chosen +
                                "\"; accepted: " + (law ? "its own, " + accepted : "those of the built-in laws"));
  };
  for (const auto &offer : now.offers)
    for (const Parameter &p : offer->parameters)
      if (p.id != kYoung && p.id != kPoisson && isSpecified(p.id) && !(law && law->has(p.id))) refuse(p.id);
  if (!law) return material;
  for (const std::string_view id : {kYoung, kPoisson})
    if (isSpecified(id) && !law->has(id)) refuse(id);
  auto passed = checked(std::make_shared<Law>(services_.host, law, values));
  if (!passed) throw Error(C3DE_E_ARG, whose + ": " + passed.error());
  setLaw(material, std::move(*passed));
  return material;
}

}  // namespace pointbased
