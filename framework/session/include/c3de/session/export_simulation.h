// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/geometry/mesh_formats.h"
#include "c3de/geometry/vtk_writer.h"
#include "c3de/session/body_states.h"

namespace c3de::session {

/// Frames of a simulation for ParaView: FILE.pvd lists, with times in seconds, what lies in the folder FILE_frames:
/// points_NNNNNN.vtu and skin_NNNNNN.vtp with all bodies, told apart by the array "body".
class SimulationExport {
 public:
  explicit SimulationExport(std::filesystem::path list) : list_(std::move(list)) {}
  SimulationExport(const SimulationExport &) = delete;
  SimulationExport &operator=(const SimulationExport &) = delete;
  ~SimulationExport();  ///< lists what was written, as far as that is possible

  /// The list grows with the frames, so that ParaView can look while the simulation runs.
  [[nodiscard]] Expected<void> addFrame(double time_s, const std::vector<BodyState> &bodies);
  [[nodiscard]] Expected<void> finish();

 private:
  [[nodiscard]] Expected<void> writeList();
  std::filesystem::path list_;
  std::vector<geometry::PvdEntry> entries_;
  std::size_t frames_ = 0;
  bool isListed_ = true;
  std::chrono::steady_clock::time_point listedAt_{};
};

/// The folder of the frames of a list.
[[nodiscard]] std::filesystem::path framesFolder(const std::filesystem::path &list);

/// Whether a sequence can be written there, asked before anything is simulated; leaves nothing behind. ErrorCode::usage
/// for another extension than .pvd, ErrorCode::output with the reason.
[[nodiscard]] Expected<void> checkSimulationExport(const std::filesystem::path &list);

/// One file per body: FILE itself for one, FILE-NAME for several (with a number where two would be the same).
[[nodiscard]] std::vector<std::filesystem::path> surfaceFiles(const std::filesystem::path &file,
                                                              std::span<const std::string> bodies);
/// Likewise before anything is simulated; names the extensions that are accepted.
[[nodiscard]] Expected<void> checkSurfaceExport(const geometry::MeshFormats &formats, const std::filesystem::path &file,
                                                std::span<const std::string> bodies);
/// Told of each file of writeSurfaces(): that it is written, or why not.
using SurfaceTold = std::function<void(const std::filesystem::path &file, const Expected<void> &result)>;
/// Writes the skins; one that fails does not keep the others from being written. Errors: ErrorCode::output,
/// ErrorCode::state when there is no body, or one without triangles.
void writeSurfaces(const geometry::MeshFormats &formats, const std::filesystem::path &file,
                   const std::vector<BodyState> &bodies, const SurfaceTold &told);

}  // namespace c3de::session
