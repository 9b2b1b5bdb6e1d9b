// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/picture_view.h"

#include <algorithm>
#include <array>
#include <utility>

namespace c3de::session {
namespace {

constexpr std::array<std::pair<PictureView, const char *>, 5> kNames{{{PictureView::space, "3d"},
                                                                      {PictureView::axial, "axial"},
                                                                      {PictureView::sagittal, "sagittal"},
                                                                      {PictureView::coronal, "coronal"},
                                                                      {PictureView::four, "four-up"}}};

}  // namespace

const char *nameOf(PictureView view) {
  return std::find_if(kNames.begin(), kNames.end(), [&](const auto &name) { return name.first == view; })->second;
}

std::optional<PictureView> pictureViewOf(const std::string &name) {
  const auto found = std::find_if(kNames.begin(), kNames.end(), [&](const auto &one) { return one.second == name; });
  if (found == kNames.end()) return {};
  return found->first;
}

PictureOverlay pictureOverlayOf(const std::string &name) {
  using Kind = PictureOverlay::Kind;
  if (name == "none") return {Kind::none, {}};
  if (name == "displacement") return {Kind::displacement, {}};
  if (name == "volume_change") return {Kind::volumeChange, {}};
  return {Kind::field, name};
}

}  // namespace c3de::session
