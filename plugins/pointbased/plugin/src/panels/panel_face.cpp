// SPDX-License-Identifier: Apache-2.0
#include "panels/panel_face.h"

namespace pointbased {

PanelFace::PanelFace(sdk::Host host) : settings_(host) {
  isSimple_ = settings_.get(kSetting).value_or(std::string(kSimple)) != kAll;
}

void PanelFace::draw(sdk::Ui &ui) {
  // Ids of the view: a replay does not lock them.
  if (ui.button("view.face.simple", isSimple_ ? "● Simple" : "Simple", !isSimple_)) choose(true);
  ui.tooltip("What is needed first: tissue, stiffness, supports, gravity, accuracy");
  ui.sameLine();
  if (ui.button("view.face.all", isSimple_ ? "All" : "● All", isSimple_)) choose(false);
  ui.tooltip("Every value and setting. Ctrl+F searches them");
}

void PanelFace::choose(bool isSimple) {
  isSimple_ = isSimple;
  // A file that cannot be written is reported in the log of the program; the choice holds for this run.
  (void)settings_.set(kSetting, isSimple ? kSimple : kAll);
}

}  // namespace pointbased
