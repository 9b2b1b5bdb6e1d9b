// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"
#include "c3de/imaging/volume.h"
#include "c3de/tracking/tracked_tool.h"
#include "c3de/tracking/tracking_address.h"

namespace c3de::tracking {

struct TrackedPoint {
  std::string name;  ///< may be empty
  Vec3 at_mm{};      ///< LPS
};

/// The points of one POINT message, or of a tool.
struct TrackedFrame {
  std::string device;            ///< name of the sender
  std::optional<double> time_s;  ///< s since 1970, by the clock of the sender, of the last point; none: not stated
  std::vector<TrackedPoint> points;
};

enum class LinkState {
  connecting,  ///< not connected before
  receiving,   ///< the last points are less than kSilence_s old
  silent,      ///< connected, but without points for longer
  lost,        ///< was connected, or could not be connected; it is tried again
};
/// s without points after which a link counts as silent.
inline constexpr double kSilence_s = 1.0;

struct LinkStatus {
  LinkState state = LinkState::connecting;
  std::string reason;               ///< why it is lost; otherwise empty
  double silence_s = 0.0;           ///< since the last points, the connection, its loss, or the beginning
  std::uint64_t received = 0;       ///< frames
  std::uint64_t replaced = 0;       ///< frames that a newer one replaced before they were taken
  std::uint64_t refused = 0;        ///< messages with a wrong checksum, or with points that are not finite
  std::optional<TrackedTool> tool;  ///< whose tip is tracked
  std::size_t collected = 0;        ///< points of the tool for the next frame
  std::uint64_t tips = 0;           ///< positions of the tool's tip
  std::set<std::string> others;     ///< at most kMostNames other tools whose positions have arrived
};
inline constexpr std::size_t kMostNames = 8;
/// A clause for people: "connected; 12 frames received".
[[nodiscard]] std::string textOf(const LinkStatus &status);

/// Selects the changes of a connection that a message reports. A silence is none: some systems send only what is new.
class ConnectionChange {
 public:
  /// Whether the connection has been made or lost since the last call.
  [[nodiscard]] bool update(LinkState state);

 private:
  LinkState last_ = LinkState::connecting;
};

/// A connection to an OpenIGTLink server, in a thread of its own. A frame is a POINT message, or positions of the tip of a
/// tool, which are TRANSFORM or POSITION messages with its name; other messages are skipped. A lost connection is tried
/// again every kRetry_s. Positions are converted between the RAS of OpenIGTLink and LPS. Any thread.
/// @source  Tokuda et al., OpenIGTLink: an open network protocol for image-guided therapy environment, 2009
class TrackingLink {
 public:
  /// Begins to connect. Errors (usage): the program was built without the library OpenIGTLink.
  /// @param tool      whose tip is tracked; none: frames are POINT messages
  /// @param onChange  called for each frame and each change of the state, in the thread of the link and until this
  ///                  object ends; must not call this object; may be empty
  [[nodiscard]] static Expected<std::unique_ptr<TrackingLink>> open(const TrackingAddress &address,
                                                                    const std::optional<TrackedTool> &tool,
                                                                    std::function<void()> onChange = {});
  ~TrackingLink();
  TrackingLink(const TrackingLink &) = delete;
  TrackingLink &operator=(const TrackingLink &) = delete;

  [[nodiscard]] const TrackingAddress &address() const;
  [[nodiscard]] LinkStatus status() const;
  /// The newest frame that was not taken before. Waits for one up to `longest`.
  [[nodiscard]] std::optional<TrackedFrame> takeFrame(std::chrono::milliseconds longest);

  /// Queue a message; one that has not been sent yet is replaced by a newer one of the same device. Without a connection
  /// messages are discarded.
  /// @param device  name of the message, at most 20 bytes
  /// @param motion  rigid, LPS mm
  void sendTransform(const std::string &device, const Mat4 &motion);
  void sendPoints(const std::string &device, const std::vector<TrackedPoint> &points);
  /// The rescaled values as 32-bit floating point numbers. The grid must have orthogonal axes.
  void sendImage(const std::string &device, const imaging::Volume &image);

  static constexpr double kRetry_s = 0.5;

 private:
  struct Connection;
  explicit TrackingLink(std::shared_ptr<Connection> connection);
  std::shared_ptr<Connection> connection_;
};

}  // namespace c3de::tracking
