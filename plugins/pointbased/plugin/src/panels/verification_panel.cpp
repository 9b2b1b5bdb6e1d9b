// SPDX-License-Identifier: Apache-2.0
#include "panels/verification_panel.h"

namespace pointbased {
namespace {

void drawBody(sdk::Ui &ui, const BodyVerification &body) {
  if (!body.refused.empty()) {
    ui.text(body.name + ": not verified: " + body.refused);
    return;
  }
  for (const std::string &limit : body.result.limits) ui.text(body.name + ": " + limit);
}

}  // namespace

void VerificationPanel::draw(sdk::Ui &ui, WorldSimulator &simulator, const Snapshot *snapshot, bool isMoving) {
  const auto state = job_ ? services_.jobs.progress(*job_) : sdk::Result<sdk::Jobs::State>(sdk::Failure{});
  if (job_ && state) {
    ui.progress(state->fraction, state->what);
    if (ui.button("cancel_verify", "Cancel")) (void)services_.jobs.cancel(*job_);
  } else {
    if (ui.button("verify", "Verify", !isMoving && snapshot && !snapshot->bodies.empty())) (void)begin(simulator);
    ui.tooltip(
        isMoving ? "Pause first: what is verified is the paused state"
                 : "Solves the present state once more with half the spacing: the displacement error is measured then");
  }
}

void VerificationPanel::drawResult(sdk::Ui &ui, const Snapshot *snapshot) {
  if (!failure_.empty()) ui.text(failure_);
  if (!snapshot || !snapshot->verification) return;
  const WorldVerification &verified = *snapshot->verification;
  if (!snapshot->verified)
    return ui.text(std::string("The last verification was of an earlier state, at ") +
                   (verified.quasiStatic ? "load factor " : "") + shortNumber(verified.clock) +
                   (verified.quasiStatic ? "" : " s"));
  for (const BodyVerification &body : verified.bodies) drawBody(ui, body);
}

sdk::Result<void> VerificationPanel::begin(WorldSimulator &simulator) {
  if (job_) return sdk::Failure{C3DE_E_STATE, "a verification is running; cancel it or wait for it"};
  failure_.clear();
  const auto shared = sdk::Ref<WorldSimulator>::share(&simulator);
  auto run = [shared](sdk::Progress progress) -> sdk::Result<void> {
    (void)shared->parts().verifier.verify(progress);
    return {};
  };
  const auto job =
      services_.jobs.submit("Verifying the present state", std::move(run),
                            [this, node = simulator.node()](const sdk::Result<void> &result) { finish(node, result); });
  if (!job) {
    failure_ = job.failure().message;
    return job.failure();
  }
  job_ = *job;
  return {};
}

void VerificationPanel::finish(c3de_handle node, const sdk::Result<void> &result) {
  job_.reset();
  if (!result) {
    failure_ =
        result.failure().status == C3DE_E_CANCELLED ? "The verification was cancelled" : result.failure().message;
    return;
  }
  // A command makes the solver publish, so that the result is shown while it is paused.
  (void)services_.simulation.post(node, [] {});
}

}  // namespace pointbased
