// SPDX-License-Identifier: Apache-2.0
#include "workstation/workstation_export.h"

#include <utility>

#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/session/export_simulation.h"
#include "c3de/session/recorder.h"
#include "c3de/session/simulation_state.h"

namespace c3de::app {
namespace {

/// Runs `write` on the simulation's thread and passes its result to the main thread.
void runBetweenSteps(Session &session, std::function<Expected<std::string>(scene::Simulation &)> write,
                     ExportCallback told) {
  scene::Simulation *simulation = session.simulation();
  if (simulation == nullptr) return;
  simulation->post([simulation, queue = &session.mainQueue(), write = std::move(write), told = std::move(told)] {
    queue->post([told, answer = write(*simulation)] { told(answer); });
  });
}

}  // namespace

Expected<SimulatorIdentity> presentSimulator(Session &session) {
  const scene::Simulation *simulation = session.simulation();
  if (simulation == nullptr) return fail(ErrorCode::state, "no simulation is open");
  const std::string owner = session.plugins().ownerOf(simulation->object());
  std::vector<SimulatorIdentity> found = session.simulators();
  std::erase_if(found, [&](const SimulatorIdentity &one) { return one.plugin != owner; });
  if (found.size() == 1) return std::move(found.front());
  return fail(ErrorCode::plugin, owner + " offers several classes that simulate; accepted: one");
}

void savePresentState(Session &session, const std::filesystem::path &file, ExportCallback told) {
  const auto identity = presentSimulator(session);
  if (!identity) return told(tl::unexpected(identity.error()));
  runBetweenSteps(
      session,
      [&session, file, identity = *identity](scene::Simulation &simulation) -> Expected<std::string> {
        const auto bytes = stateBytes(session, simulation.object(), identity);
        if (!bytes) return tl::unexpected(bytes.error());
        if (auto written = writeWholeFile(file, *bytes); !written) return tl::unexpected(written.error());
        return pathText(file);
      },
      std::move(told));
}

void goToStateOf(Session &session, const std::filesystem::path &file, ExportCallback told) {
  const auto identity = presentSimulator(session);
  if (!identity) return told(tl::unexpected(identity.error()));
  runBetweenSteps(
      session,
      [&session, file, identity = *identity,
       recorders = session.recorders()](scene::Simulation &simulation) -> Expected<std::string> {
        const auto bytes = readStateFile(file);
        if (!bytes) return tl::unexpected(bytes.error());
        const std::string name = pathText(file);
        const auto before = simulatorStatus(simulation.table(), simulation.object());
        if (auto gone = goToState(session, simulation.object(), identity, *bytes, name); !gone)
          return tl::unexpected(gone.error());
        for (const auto &recorder : recorders)
          if (before) recorder->addState(before->steps, *bytes);
        return name;
      },
      std::move(told));
}

void exportPresentSurface(Session &session, const std::filesystem::path &file, ExportCallback told) {
  plugin_host::PluginHost *host = &session.plugins();
  const auto write = [host, file,
                      formats = &session.meshFormats()](scene::Simulation &simulation) -> Expected<std::string> {
    const auto states = readBodyStates(simulation.object(), BodyParts::skin, [host] { return host->takeError(); });
    if (!states) return tl::unexpected(states.error());
    std::string written, failed;
    ErrorCode code = ErrorCode::output;
    writeSurfaces(*formats, file, *states, [&](const std::filesystem::path &one, const Expected<void> &result) {
      std::string &text = result ? written : failed;
      text += (text.empty() ? "" : "\n") + (result ? pathText(one) : result.error().message);
      if (!result) code = result.error().code;
    });
    if (failed.empty()) return written;
    return fail(code, failed + (written.empty() ? "" : "\nWritten:\n" + written));
  };
  runBetweenSteps(session, write, std::move(told));
}

void exportPresentFrame(Session &session, const std::filesystem::path &file, ExportCallback told) {
  plugin_host::PluginHost *host = &session.plugins();
  const auto write = [host, file](scene::Simulation &simulation) -> Expected<std::string> {
    const auto states =
        readBodyStates(simulation.object(), BodyParts::skinAndInside, [host] { return host->takeError(); });
    if (!states) return tl::unexpected(states.error());
    c3de_sim_status status{};
    status.size = sizeof status;
    if (simulation.table()->status(simulation.object(), &status) < 0)
      return fail(ErrorCode::plugin, "the simulator does not report its time");
    SimulationExport frame(file);
    if (auto added = frame.addFrame(status.time_s, *states); !added) return tl::unexpected(added.error());
    if (auto finished = frame.finish(); !finished) return tl::unexpected(finished.error());
    return pathText(file) + "\n" + pathText(framesFolder(file));
  };
  runBetweenSteps(session, write, std::move(told));
}

void exportPresentImage(Session &session, const PresentImages &images, const ImageWarp &how, const ImageExport &wanted,
                        ExportCallback told) {
  scene::Simulation *simulation = session.simulation();
  const std::shared_ptr<const scene::StoredImage> image = images.image;
  if (simulation == nullptr || !image) return;
  const std::filesystem::path file = !wanted.image.empty()    ? wanted.image
                                     : !wanted.labels.empty() ? wanted.labels
                                                              : wanted.displacement;
  if (auto good = checkImageFile(file); !good) return told(tl::unexpected(good.error()));
  const auto write = [&session, images, wanted, file, told](std::shared_ptr<const imaging::DisplacementGrid> u) {
    const auto written = std::make_shared<std::string>();
    (void)session.jobs().submit(
        kJobOwner, "Writing " + pathText(file.filename()),
        [images, wanted, u, written](const ProgressFn &progress) -> Expected<void> {
          std::vector<const imaging::LabelMap *> layers;
          for (const auto &layer : images.layers) layers.push_back(&layer->map);
          auto answer = wanted.labels.empty()
                            ? writeImages(wanted, images.image->volume, images.areLabels, *u, progress, nullptr)
                            : writeLabels(wanted.labels, layers, images.image->volume.geometry, *u, progress, nullptr);
          if (!answer) return tl::unexpected(answer.error());
          *written = std::move(*answer);
          return {};
        },
        [written, told](const Expected<void> &result) {
          if (result) return told(*written);
          if (result.error().code != ErrorCode::cancelled) told(tl::unexpected(result.error()));
        });
  };
  simulation->post([simulation, queue = &session.mainQueue(), image, how, write, told] {
    auto u = presentDisplacement(simulation->table(), simulation->object(), image->volume, how);
    if (!u) return queue->post([told, error = u.error()] { told(tl::unexpected(error)); });
    queue->post([write, shared = std::make_shared<const imaging::DisplacementGrid>(std::move(*u))] { write(shared); });
  });
}

void exportPresentTissues(Session &session, std::shared_ptr<const std::vector<TissueVoxels>> bodies,
                          const std::filesystem::path &file, ExportCallback told) {
  scene::Simulation *simulation = session.simulation();
  if (simulation == nullptr || !bodies) return;
  const auto write = [&session, bodies, file, told](std::shared_ptr<const TissueSnapshot> snapshot) {
    (void)session.jobs().submit(
        kJobOwner, "Writing " + pathText(file.filename()),
        [bodies, file, snapshot](const ProgressFn &progress) -> Expected<void> {
          const auto motions =
              followTissues(*snapshot, *bodies, [&] { return !progress || progress(-1.0, "tracking the labels"); });
          if (!motions) return tl::unexpected(motions.error());
          return writeTissueTable(file, *motions);
        },
        [file, told](const Expected<void> &result) {
          if (result) return told(pathText(file));
          if (result.error().code != ErrorCode::cancelled) told(tl::unexpected(result.error()));
        });
  };
  simulation->post([simulation, queue = &session.mainQueue(), write, told] {
    auto snapshot = readTissues(simulation->table(), simulation->object());
    if (!snapshot) return queue->post([told, error = snapshot.error()] { told(tl::unexpected(error)); });
    queue->post([write, shared = std::make_shared<const TissueSnapshot>(std::move(*snapshot))] { write(shared); });
  });
}

}  // namespace c3de::app
