// SPDX-License-Identifier: Apache-2.0
#include "commands/scene_at_rest.h"

#include "c3de/core/output_file.h"
#include "c3de/session/build_scene.h"

namespace c3de::app {

RunFacts SceneAtRest::facts(const HeadlessRun &run, const scene::SceneFile &scene,
                            const std::filesystem::path &source) const {
  RunFacts out = run.facts();
  if (const auto hash = stateHash(table, simulator.get()); hash) out.stateHash = *hash;
  out.prepared = prepared;
  out.scene = scene.title;
  out.source = source.string();
  out.simulator = identity;
  return out;
}

Expected<SceneAtRest> buildAtRest(Session &session, const scene::SceneFile &scene, BodySources &sources,
                                  const ProgressFn &progress) {
  auto chosen = session.chooseSimulator(scene.simulatorClass);
  if (!chosen) return failInScene(chosen.error(), scene, scene.simulatorLine);
  auto created = session.createSimulator(chosen->classId);
  if (!created) return tl::unexpected(created.error());
  SceneAtRest out{std::move(*chosen), ObjectRef(*created), nullptr, {}};
  const auto table = simulatorTable(out.simulator.get());
  if (!table) return tl::unexpected(table.error());
  out.table = *table;
  if (auto built = buildScene(session, out.simulator.get(), scene, sources, progress, &out.prepared); !built)
    return tl::unexpected(built.error());
  return out;
}

Expected<void> writeReport(const std::filesystem::path &file, const RunFacts &facts, const HeadlessRun &run,
                           WrittenOutputs &outputs) {
  const auto simulatorJson = run.simulatorReport();
  if (!simulatorJson) return tl::unexpected(simulatorJson.error());
  const auto json = reportJson(facts, *simulatorJson);
  if (!json) return tl::unexpected(json.error());
  outputs.note(file, writeWholeFile(file, *json));
  return {};
}

}  // namespace c3de::app
