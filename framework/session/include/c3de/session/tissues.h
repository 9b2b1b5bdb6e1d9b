// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/preparation.h"

namespace c3de::session {

class BodySources;

/// Resolves which labels of its map each tissue of each body has, and the properties of tissues specified only by name.
/// Creates their parts, and then applies the `--set` overrides for them. Reads the label maps. Bodies with sliding
/// labels become several, one for each piece (SceneVolume::cut), with contact between them; whatever acts on the whole
/// body acts on its pieces. A scene whose tissues are resolved stays unchanged. Notices go to the log.
/// @param took  the reading time is added
/// Errors begin with the location in the scene: a tissue without a label of its own, an unknown name, labels of
/// different tissues under one name, nothing that can move, a sliding name that is no label, rigid or empty, those of
/// readers and overrides. Any thread.
[[nodiscard]] Expected<void> resolveTissues(scene::SceneFile &scene, const scene::MaterialLibrary &materials,
                                            BodySources &sources, const ProgressFn &progress, Preparation &took);

}  // namespace c3de::session
