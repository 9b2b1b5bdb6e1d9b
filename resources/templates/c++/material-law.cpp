// My plugin: a material law for the point-based plugin. A scene chooses it:
//   material = { law = "org.example.my_plugin/0", my_plugin.shear_modulus = 2e3, my_plugin.bulk_modulus = 2e4 }
#include <array>
#include <cmath>

#include "c3de/pointbased/material_law.hpp"
#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

/// W = mu/2 (tr(F^T F) - 3 - 2 ln J) + K/2 (J - 1)², J/m³. The loader checks energy, stress and differential against each
/// other before a body is made of it.
class MyPluginLaw {
 public:
  static constexpr std::array kParams{
      sdk::numberParam({.id = "my_plugin.shear_modulus", .label = "Shear modulus", .unit = "Pa", .doc = "At rest."},
                       {.min = 0.0, .max = 1e12, .softMin = 100.0, .softMax = 1e5}, 2e3, C3DE_PARAM_MIN_OPEN),
      sdk::numberParam({.id = "my_plugin.bulk_modulus", .label = "K", .unit = "Pa", .doc = "Against a change of volume."},
                       {.min = 0.0, .max = 1e12, .softMin = 1e3, .softMax = 1e6}, 2e4, C3DE_PARAM_MIN_OPEN)};

  explicit MyPluginLaw(const double *params) : mu_(params[0]), K_(params[1]) {}

  double energy(const double *f) const {
    const sdk::Deformation d(f);
    return 0.5 * mu_ * (sdk::dot(d.F, d.F) - 3.0 - 2.0 * std::log(d.J)) + 0.5 * K_ * (d.J - 1.0) * (d.J - 1.0);
  }
  // dW/dF, Pa: first Piola-Kirchhoff. dJ/dF is cof F.
  void stress(const double *f, double *P) const {
    const sdk::Deformation d(f);
    const double slope = K_ * (d.J - 1.0) - mu_ / d.J;
    for (std::size_t i = 0; i < 9; ++i) P[i] = mu_ * d.F[i] + slope * d.cof[i];
  }
  // How the stress changes with F, along df.
  void differential(const double *f, const double *df, double *dP) const {
    const sdk::Deformation d(f);
    const sdk::Matrix9 D = sdk::matrix9(df), dcof = d.cofactorChange(D);
    const double slope = K_ * (d.J - 1.0) - mu_ / d.J;
    const double slopeChange = (K_ + mu_ / (d.J * d.J)) * sdk::dot(d.cof, D);
    for (std::size_t i = 0; i < 9; ++i) dP[i] = mu_ * D[i] + slopeChange * d.cof[i] + slope * dcof[i];
  }

 private:
  double mu_, K_;
};

class MyPlugin {
 public:
  static constexpr sdk::PluginInfo info{
      .id = "org.example.my_plugin", .version = "0.1.0", .displayName = "My plugin", .vendor = "Your name", .license = "MIT"};
  static constexpr std::array needs{sdk::required<c3de_registry_v1>()};

  explicit MyPlugin(sdk::Host host) {
    sdk::orThrow(sdk::Registry(host).add<sdk::MaterialLaw<MyPluginLaw>>("org.example.my_plugin/0", "My plugin",
                                                                        "A law of my own.", *this));
  }
};

}  // namespace

C3DE_DEFINE_PLUGIN(MyPlugin)
