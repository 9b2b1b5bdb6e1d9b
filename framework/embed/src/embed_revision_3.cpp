// SPDX-License-Identifier: Apache-2.0
// The functions of c3de/embed.h that revision 3 added: measurements and sensitivities.
#include "guarded_calls.h"

using namespace c3de;         // NOLINT(google-build-using-namespace): C functions below
using namespace c3de::embed;  // NOLINT(google-build-using-namespace)

c3de_status c3de_embed_match(c3de_sim sim, uint64_t body, const c3de_embed_match_options *options, const char **json) {
  return callWithResult(sim, json, "json", [&](EmbeddedSimulation &of) -> Result<const char *> {
    const auto in = readStruct(options, "options");
    if (!in) return tl::unexpected(in.error());
    return of.match(body, *in, progressOf(in->progress, in->progress_self));
  });
}

c3de_status c3de_embed_fit(c3de_sim sim, uint64_t body, const c3de_embed_fit_options *options, const char **json) {
  return callWithResult(sim, json, "json", [&](EmbeddedSimulation &of) -> Result<const char *> {
    const auto in = readStruct(options, "options");
    if (!in) return tl::unexpected(in.error());
    return of.fit(body, *in, progressOf(in->progress, in->progress_self));
  });
}

c3de_status c3de_embed_sensitivity(c3de_sim sim, uint64_t body, const double *objective, uint64_t points_n,
                                   double *forces, const char **json) {
  return callWithResult(sim, json, "json", [&](EmbeddedSimulation &of) -> Result<const char *> {
    if (auto good = notNull(objective, "objective"); !good) return tl::unexpected(good.error());
    if (auto good = notNull(forces, "forces"); !good) return tl::unexpected(good.error());
    return of.sensitivity(body, objective, points_n, forces);
  });
}
