// SPDX-License-Identifier: Apache-2.0
#include "simulator/body_verifier.h"

#include "base/build_request.h"

namespace pointbased {
namespace {

using sdk::Error;

// A body in the state at which the verification was requested.
struct VerifiedBody {
  VerificationTarget body;
  BodySource source;
  std::shared_ptr<const ParameterValues> values;
};

}  // namespace

std::shared_ptr<const WorldVerification> BodyVerifier::verify(const sdk::Progress &progress) {
  const auto begin = std::chrono::steady_clock::now();
  auto out = std::make_shared<WorldVerification>();
  std::vector<VerifiedBody> all;
  {
    const StateLock lock(world_);
    out->quasiStatic = simulator_.quasiStatic();
    out->clock = out->quasiStatic ? simulator_.loadFactor() : simulator_.time();
    for (const auto &[id, record] : table_.bodies()) {
      if (!simulator_.body(id)->liveSupports().empty())
        throw Error(C3DE_E_STATE, "body '" + record.name +
                                      "' has supports that were set by hand, which the fine reference has not; "
                                      "remove them first");
      all.push_back({verificationTarget(simulator_, id), record.source, record.values});
      out->bodies.push_back({id, simulator_.stepper().changes(id), record.name, record.source.fixNumbers, {}, {}});
    }
  }
  BuildRequest request(progress);
  const ParallelFor parallelFor = world_.context.services.parallelFor();
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double share = 1.0 / static_cast<double>(all.size());
    const VerifyProgress reportPart = [&](double fraction, const std::string &what) {
      return request.report(share * (static_cast<double>(k) + fraction), out->bodies[k].name + ": " + what);
    };
    if (!reportPart(0.0, "filling the fine reference")) throw Error(C3DE_E_CANCELLED, "cancelled");
    const VerifiedBody &one = all[k];
    BodyVerification &body = out->bodies[k];
    const BodyFilling filling = fillingOf(world_.context.services, body.name, one.source, *one.values, parallelFor);
    auto verified = pointbased::verify(one.body, filling.shape, filling.recipe, parallelFor, reportPart, &request);
    if (verified)
      body.result = std::move(*verified);
    else if (verified.error() == "cancelled")
      throw Error(C3DE_E_CANCELLED, "cancelled");
    else
      body.refused = verified.error();
  }
  out->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const std::lock_guard lock(world_.mutex);
  snapshots_.setVerification(out);
  return out;
}

void BodyVerifier::report(const c3de_progress *progress, c3de_sink json) {
  const auto verified = verify(sdk::Progress(progress));
  if (const c3de_status status = sdk::put(json, verificationJson(*verified)); status < 0)
    throw Error(status, "the text was not taken");
}

}  // namespace pointbased
