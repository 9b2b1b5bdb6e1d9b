// SPDX-License-Identifier: Apache-2.0
#include "pointbased/constitution.h"

#include <algorithm>

#include "pointbased/elastic_law.h"

namespace pointbased {
namespace {

template <class Predicate>
bool anyOf(const Constitution &constitution, Predicate predicate) {
  return std::any_of(constitution.materials.begin(), constitution.materials.end(), predicate);
}

}  // namespace

bool Constitution::viscous() const {
  return anyOf(*this, [](const Material &m) { return m.viscosity > 0.0; });
}

bool Constitution::relaxing() const {
  return anyOf(*this, [](const Material &m) { return m.relaxes(); });
}

bool Constitution::plastic() const {
  return anyOf(*this, [](const Material &m) { return m.plastic.enabled(); });
}

std::string Constitution::consumeError() const {
  std::string all;
  for (const Material &m : materials) {
    if (m.law != MaterialLaw::custom) continue;
    if (const std::string one = m.custom->consumeError(); !one.empty()) all += (all.empty() ? "" : "; ") + one;
  }
  return all;
}

void PointHistory::reset(const Constitution &constitution, std::size_t points, bool hourglass) {
  plasticInverse.assign(constitution.plastic() ? points : 0, Mat3::Identity());
  plasticBefore.clear();
  prony.assign(constitution.relaxing() ? points : 0, PronyPoint());
  modes.assign(constitution.relaxing() && hourglass ? points : 0, HourglassHistory());
}

}  // namespace pointbased
