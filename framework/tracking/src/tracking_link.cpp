// SPDX-License-Identifier: Apache-2.0
#include "c3de/tracking/tracking_link.h"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "c3de/core/text.h"
#include "message_socket.h"

namespace c3de::tracking {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point time) { return std::chrono::duration<double>(Clock::now() - time).count(); }

}  // namespace

/// Shared with the thread, which may outlive the link while the operating system tries to connect.
struct TrackingLink::Connection {
  TrackingAddress address;
  std::mutex mutex;
  std::condition_variable changed;
  bool isClosed = false;  ///< the thread is to end
  bool hasEnded = false;
  LinkStatus status;
  Clock::time_point since = Clock::now();  ///< last points, or change of state
  std::optional<TrackedFrame> newest;      ///< not taken yet
  std::optional<ToolPoints> toolPoints;    ///< for the next frame
  std::map<std::string, Bytes> outgoing;   ///< by type and device
  std::function<void()> onChange;          ///< called with `mutex` locked
  bool isSilent = false;                   ///< has been announced

  void run() {
    while (!closed()) {
      if (const auto socket = MessageSocket::connectTo(address))
        communicate(*socket);
      else
        setLost("no server accepts connections there");
      std::unique_lock lock(mutex);
      changed.wait_for(lock, std::chrono::duration<double>(kRetry_s), [this] { return isClosed; });
    }
    const std::lock_guard lock(mutex);
    hasEnded = true;
    changed.notify_all();
  }

  /// With `mutex` locked.
  void announce() {
    changed.notify_all();
    if (onChange && !isClosed) onChange();
  }

  bool closed() {
    const std::lock_guard lock(mutex);
    return isClosed;
  }

  void setLost(const std::string &reason) {
    const std::lock_guard lock(mutex);
    if (status.state != LinkState::lost) since = Clock::now();
    const bool isNew = status.state != LinkState::lost || status.reason != reason;
    status.state = LinkState::lost;
    status.reason = reason;
    outgoing.clear();
    if (isNew) announce();
  }

  void checkSilence() {
    const std::lock_guard lock(mutex);
    if (isSilent || secondsSince(since) <= kSilence_s) return;
    isSilent = true;
    announce();
  }

  void communicate(MessageSocket &socket) {
    {
      const std::lock_guard lock(mutex);
      status.state = LinkState::receiving;
      status.reason.clear();
      since = Clock::now();
      outgoing.clear();
      isSilent = false;
      announce();
    }
    TrackedFrame frame;
    while (!closed()) {
      const auto received = socket.receive(frame);
      if (!received) return setLost(received.error().message);
      if (*received == Received::refused) {
        const std::lock_guard lock(mutex);
        ++status.refused;
      } else if (*received == Received::frame && !status.tool) {
        keep(std::exchange(frame, {}));
      } else if (*received == Received::tip && status.tool) {
        collect(std::exchange(frame, {}));
      }
      checkSilence();
      if (!sendOutgoing(socket)) return setLost("the server does not read what is sent to it");
    }
    (void)sendOutgoing(socket);  // results of the last frame
  }

  void collect(TrackedFrame tip) {
    std::unique_lock lock(mutex);
    if (tip.device != status.tool->device) {
      if (status.others.size() < kMostNames) status.others.insert(tip.device);
      return;
    }
    ++status.tips;
    since = Clock::now();
    const bool wasSilent = std::exchange(isSilent, false);
    const bool isComplete = toolPoints->add(tip.points.front().at_mm);
    const bool isNew = std::exchange(status.collected, toolPoints->count()) != toolPoints->count();
    if (!isComplete) {
      if (isNew || wasSilent) announce();
      return;
    }
    tip.points.clear();
    for (const Vec3 &at_mm : toolPoints->take()) tip.points.push_back({"", at_mm});
    status.collected = 0;
    lock.unlock();
    keep(std::move(tip));
  }

  void keep(TrackedFrame frame) {
    const std::lock_guard lock(mutex);
    ++status.received;
    if (newest) ++status.replaced;
    newest = std::move(frame);
    since = Clock::now();
    isSilent = false;
    announce();
  }

  bool sendOutgoing(MessageSocket &socket) {
    std::unique_lock lock(mutex);
    const std::map<std::string, Bytes> messages = std::exchange(outgoing, {});
    lock.unlock();
    return std::all_of(messages.begin(), messages.end(), [&](const auto &one) { return socket.send(one.second); });
  }

  void send(const std::string &name, Bytes message) {
    const std::lock_guard lock(mutex);
    if (status.state == LinkState::receiving) outgoing[name] = std::move(message);
  }
};

std::string textOf(const LinkStatus &status) {
  std::string text;
  switch (status.state) {
    case LinkState::connecting: text = fmt::format("connecting for {:.0f} s", status.silence_s); break;
    case LinkState::receiving: text = "connected"; break;
    case LinkState::silent: text = fmt::format("no points for {:.1f} s", status.silence_s); break;
    case LinkState::lost: text = fmt::format("not connected for {:.1f} s: {}", status.silence_s, status.reason); break;
  }
  text += fmt::format("; {} frame{} received", status.received, status.received == 1 ? "" : "s");
  if (status.replaced > 0) text += fmt::format(", {} skipped for newer ones", status.replaced);
  if (status.refused > 0) text += fmt::format(", {} refused as invalid", status.refused);
  if (!status.tool) return text;
  text += fmt::format("; {} of {} points of tool '{}'", status.collected, status.tool->frameSize, status.tool->device);
  if (status.tips == 0 && !status.others.empty())
    for (const std::string &name : status.others)
      text += (name == *status.others.begin() ? "; tracked tools: " : ", ") + displayText(name);
  return text;
}

bool ConnectionChange::update(LinkState state) {
  if (state == LinkState::silent) state = LinkState::receiving;
  return std::exchange(last_, state) != state;
}

Expected<std::unique_ptr<TrackingLink>> TrackingLink::open(const TrackingAddress &address,
                                                           const std::optional<TrackedTool> &tool,
                                                           std::function<void()> onChange) {
  if (!MessageSocket::isAvailable())
    return fail(ErrorCode::usage, "this program was built without the library OpenIGTLink");
  auto connection = std::make_shared<Connection>();
  connection->address = address;
  if (tool) {
    connection->status.tool = {tool->device.substr(0, kNameLength), tool->frameSize};
    connection->toolPoints.emplace(tool->frameSize);
  }
  connection->onChange = std::move(onChange);
  std::thread([connection] { connection->run(); }).detach();
  return std::unique_ptr<TrackingLink>(new TrackingLink(std::move(connection)));
}

TrackingLink::TrackingLink(std::shared_ptr<Connection> connection) : connection_(std::move(connection)) {}

TrackingLink::~TrackingLink() {
  constexpr std::chrono::milliseconds kLongest{1000};  // longer only while the operating system tries to connect
  std::unique_lock lock(connection_->mutex);
  connection_->isClosed = true;
  connection_->onChange = {};
  connection_->changed.notify_all();
  connection_->changed.wait_for(lock, kLongest, [this] { return connection_->hasEnded; });
}

const TrackingAddress &TrackingLink::address() const { return connection_->address; }

LinkStatus TrackingLink::status() const {
  const std::lock_guard lock(connection_->mutex);
  LinkStatus out = connection_->status;
  out.silence_s = secondsSince(connection_->since);
  if (out.state == LinkState::receiving && out.silence_s > kSilence_s) out.state = LinkState::silent;
  return out;
}

std::optional<TrackedFrame> TrackingLink::takeFrame(std::chrono::milliseconds longest) {
  std::unique_lock lock(connection_->mutex);
  connection_->changed.wait_for(lock, longest, [this] { return connection_->newest.has_value(); });
  return std::exchange(connection_->newest, std::nullopt);
}

void TrackingLink::sendTransform(const std::string &device, const Mat4 &motion) {
  connection_->send("TRANSFORM " + device, packedTransform(device, motion));
}

void TrackingLink::sendPoints(const std::string &device, const std::vector<TrackedPoint> &points) {
  connection_->send("POINT " + device, packedPoints(device, points));
}

void TrackingLink::sendImage(const std::string &device, const imaging::Volume &image) {
  connection_->send("IMAGE " + device, packedImage(device, image));
}

}  // namespace c3de::tracking
