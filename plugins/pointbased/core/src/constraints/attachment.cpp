// SPDX-License-Identifier: Apache-2.0
#include "pointbased/attachment.h"

#include <cmath>

#include "base/number_text.h"

namespace pointbased {

Result<void> validate(const Attachment &a) {
  const auto refuse = [](const char *what, double value, const char *unit, const char *accepted) {
    return tl::make_unexpected(std::string(what) + " of the attachment is " + detail::number(value) + " " + unit +
                               "; accepted: " + accepted);
  };
  const auto good = [](double value) { return std::isfinite(value) && value >= 0.0; };
  const char *notNegative = "a finite number >= 0";
  if (!good(a.stiffness)) return refuse("the stiffness", a.stiffness, "Pa/m", notNegative);
  if (!good(a.tangential)) return refuse("the tangential stiffness", a.tangential, "Pa/m", notNegative);
  if (!good(a.tearsAt)) return refuse("the strength", a.tearsAt, "Pa", notNegative);
  if (!(a.within > 0.0)) return refuse("the largest gap", 1e3 * a.within, "mm", "a number > 0");
  return validate(a.region);
}

}  // namespace pointbased
