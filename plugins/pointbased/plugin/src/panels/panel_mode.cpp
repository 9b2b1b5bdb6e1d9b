// SPDX-License-Identifier: Apache-2.0
#include "panels/panel_mode.h"

namespace pointbased {

PanelMode::PanelMode(sdk::Host host) : settings_(host) {
  isSimple_ = settings_.get(kSetting).value_or(std::string(kSimple)) != kAll;
}

void PanelMode::draw(sdk::Ui &ui) {
  // Ids of the view: a replay does not lock them.
  if (ui.button("view.mode.simple", isSimple_ ? "● Simple" : "Simple", !isSimple_)) choose(true);
  ui.tooltip("What is needed first: tissue, stiffness, supports, gravity, accuracy");
  ui.sameLine();
  if (ui.button("view.mode.all", isSimple_ ? "All" : "● All", isSimple_)) choose(false);
  ui.tooltip("Every value and setting. Ctrl+F searches them");
}

void PanelMode::choose(bool isSimple) {
  isSimple_ = isSimple;
  // A file that cannot be written is reported in the log of the program; the choice holds for this run.
  (void)settings_.set(kSetting, isSimple ? kSimple : kAll);
}

}  // namespace pointbased
