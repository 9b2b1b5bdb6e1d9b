// SPDX-License-Identifier: Apache-2.0
// The scan of the scene, deformed with the bodies.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "c3de/imaging/warp.h"
#include "c3de/session/export_image.h"
#include "running.h"
#include "use.h"
#include "warped_image.h"

namespace c3de::embed {
namespace {

using Layers = WarpedImage::Layers;

/// Each layer takes an equal part of the whole progress.
ProgressFn partOf(const ProgressFn &whole, std::size_t part, std::size_t parts) {
  return [&whole, part, parts](double fraction, const std::string &what) {
    return whole((static_cast<double>(part) + std::max(fraction, 0.0)) / static_cast<double>(parts), what);
  };
}

/// The caller wrote no option.
Error withoutOption(Error error) {
  constexpr std::string_view kOption = "--export-labels needs";
  if (error.message.starts_with(kOption))
    error.message = "a warped label map needs" + error.message.substr(kOption.size());
  return error;
}

}  // namespace

Result<std::shared_ptr<const WarpedImage>> EmbeddedSimulation::warp(std::uint32_t what, const ProgressFn &progress) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  if (what != C3DE_EMBED_IMAGE && what != C3DE_EMBED_LABELS)
    return refuse(C3DE_E_ARG, fmt::format("what is {}; accepted: {} (image), {} (labels)", what, C3DE_EMBED_IMAGE,
                                          C3DE_EMBED_LABELS));
  const scene::SceneFile &scene = *scene_;
  if (!scene.image)
    return refuse(C3DE_E_ARG,
                  "a warped image needs a scene with an [image], whose grid it takes; " + scene.where(1) + " has none");
  const Running running(*this);
  const ProgressFn shown = running.progress(progress);
  const auto image = session::imageOfScene(scene, sources_);
  if (!image) return refuse(image.error());
  std::shared_ptr<const Layers> layers;
  if (what == C3DE_EMBED_LABELS) {
    const auto found = session::labelsToExport(scene, sources_);
    if (!found) return refuse(withoutOption(found.error()));
    layers = *found;
  }
  const auto how = session::imageWarpOf(scene, sources_, session_->materials(), facts_.prepared.tissues);
  if (!how) return refuse(how.error());
  if (running.isOver()) return refuse(C3DE_E_CANCELLED, "the warp was cancelled");
  const auto u = session::presentDisplacement(table_, simulator_->get(), **image, *how);
  if (!u) return refuse(u.error());
  if (!layers) {
    auto warped = session::warpedImage(**image, session::isImageOfLabels(scene), *u, shown, &session_->pool());
    if (!warped) return refuse(warped.error());
    return std::make_shared<const WarpedImage>(std::move(*warped));
  }
  Layers warped;
  for (const imaging::LabelMap &layer : *layers) {
    auto one =
        imaging::warped(layer, *u, (*image)->geometry, partOf(shown, warped.size(), layers->size()), &session_->pool());
    if (!one) return refuse(one.error());
    warped.push_back(std::move(*one));
  }
  return std::make_shared<const WarpedImage>(std::move(warped));
}

}  // namespace c3de::embed
