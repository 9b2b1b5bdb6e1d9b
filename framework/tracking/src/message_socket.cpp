// SPDX-License-Identifier: Apache-2.0
#include "message_socket.h"

#include <fmt/format.h>
#include <igtlClientSocket.h>
#include <igtlImageMessage.h>
#include <igtlMessageHeader.h>
#include <igtlPointMessage.h>
#include <igtlPositionMessage.h>
#include <igtlTimeStamp.h>
#include <igtlTransformMessage.h>
#include <igtl_util.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>

namespace c3de::tracking {
namespace {

constexpr std::size_t kHeaderSize = 58, kSizeOffset = 42, kChecksumOffset = 50;                // bytes
constexpr std::size_t kPointSize = 136, kTransformSize = 48, kPositionSizes[] = {12, 24, 28};  // of bodies
constexpr std::uint64_t kLargestBody = 64u << 20;  // bytes; an image may be sent that is skipped
constexpr int kSendTimeout_ms = 500;
constexpr double kLargest_mm = 1e6;
constexpr std::size_t kPointNameLength = 63;  // bytes

/// LPS to RAS and back.
Vec3 mirrored(const Vec3 &at) { return {-at[0], -at[1], at[2]}; }

void setMatrix(const Mat4 &motion, igtl::Matrix4x4 &out) {
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t column = 0; column < 4; ++column) {
      const double sign = (row < 2) != (column < 2) ? -1.0 : 1.0;
      out[row][column] = static_cast<float>(sign * motion[row + 4 * column]);
    }
}

template <class MessagePointer>
Bytes packed(const MessagePointer &message, const std::string &device) {
  message->SetDeviceName(device.substr(0, kNameLength).c_str());
  const auto now = igtl::TimeStamp::New();
  now->GetTime();
  igtl::TimeStamp::Pointer stamp = now;
  message->SetTimeStamp(stamp);
  message->Pack();
  const auto *bytes = static_cast<const std::byte *>(message->GetPackPointer());
  return {bytes, bytes + message->GetPackSize()};
}

/// An unsigned number, highest byte first.
std::uint64_t numberAt(std::span<const std::byte> bytes, std::size_t offset, std::size_t size) {
  std::uint64_t out = 0;
  for (std::size_t i = 0; i < size; ++i) out = out << 8 | std::to_integer<std::uint64_t>(bytes[offset + i]);
  return out;
}

void setNumberAt(std::span<std::byte> bytes, std::size_t offset, std::size_t size, std::uint64_t value) {
  for (std::size_t i = size; i-- > 0; value >>= 8) bytes[offset + i] = static_cast<std::byte>(value & 0xff);
}

std::uint64_t checksumOf(Bytes &message) {
  return crc64(reinterpret_cast<unsigned char *>(message.data() + kHeaderSize), message.size() - kHeaderSize, 0);
}

/// Removes the extended header and the metadata of protocol version 3, which 3D Slicer sends and OpenIGTLink 1.11 does
/// not know. None: the message is damaged.
/// @source  igtl_header.h of OpenIGTLink 3: igtl_extended_header
std::optional<Bytes> withoutExtension(Bytes message) {
  if (numberAt(message, 0, 2) < 2 || message.size() == kHeaderSize) return message;
  constexpr std::size_t kFields = 8;  // bytes: sizes of extended header, metadata header and metadata
  if (message.size() < kHeaderSize + kFields || numberAt(message, kChecksumOffset, 8) != checksumOf(message))
    return std::nullopt;
  const std::span<const std::byte> body = std::span(message).subspan(kHeaderSize);
  const std::uint64_t header = numberAt(body, 0, 2), metadata = numberAt(body, 2, 2) + numberAt(body, 4, 4);
  if (header < kFields || header + metadata > body.size()) return std::nullopt;
  message.resize(message.size() - metadata);
  const auto content = message.begin() + static_cast<std::ptrdiff_t>(kHeaderSize);
  message.erase(content, content + static_cast<std::ptrdiff_t>(header));
  setNumberAt(message, 0, 2, 1);
  setNumberAt(message, kSizeOffset, 8, message.size() - kHeaderSize);
  setNumberAt(message, kChecksumOffset, 8, checksumOf(message));
  return message;
}

template <class Message>
typename Message::Pointer unpacked(const Bytes &bytes, const igtl::MessageHeader::Pointer &header) {
  const auto message = Message::New();
  message->SetMessageHeader(header);
  message->AllocatePack();
  const std::size_t size = bytes.size() - kHeaderSize;
  if (size != static_cast<std::size_t>(message->GetBodySizeToRead())) return nullptr;
  std::memcpy(message->GetPackBodyPointer(), bytes.data() + kHeaderSize, size);
  if ((message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY) == 0) return nullptr;
  return message;
}

bool isPlausible(const std::array<float, 3> &at) {
  return std::all_of(at.begin(), at.end(), [](float x) { return std::abs(x) <= kLargest_mm; });
}

TrackedFrame frameOf(igtl::MessageBase &message) {
  TrackedFrame out;
  out.device = message.GetDeviceName();
  unsigned seconds = 0, fraction = 0;
  message.GetTimeStamp(&seconds, &fraction);
  if (seconds != 0) out.time_s = seconds + fraction * 0x1p-32;
  return out;
}

Received readPoints(const Bytes &bytes, const igtl::MessageHeader::Pointer &header, TrackedFrame &frame) {
  if ((bytes.size() - kHeaderSize) % kPointSize != 0) return Received::refused;
  const auto message = unpacked<igtl::PointMessage>(bytes, header);
  if (!message) return Received::refused;
  TrackedFrame out = frameOf(*message);
  for (int i = 0; i < message->GetNumberOfPointElement(); ++i) {
    igtl::PointElement::Pointer element;
    message->GetPointElement(i, element);
    std::array<float, 3> at{};
    element->GetPosition(at.data());
    if (!isPlausible(at)) return Received::refused;
    out.points.push_back({element->GetName(), mirrored({at[0], at[1], at[2]})});
  }
  if (out.points.empty()) return Received::skipped;
  frame = std::move(out);
  return Received::frame;
}

template <class Message>
Received readTip(const Bytes &bytes, const igtl::MessageHeader::Pointer &header, TrackedFrame &frame) {
  const auto message = unpacked<Message>(bytes, header);
  std::array<float, 3> at{};
  if (message) message->GetPosition(at.data());
  if (!message || !isPlausible(at)) return Received::refused;
  frame = frameOf(*message);
  frame.points = {{"", mirrored({at[0], at[1], at[2]})}};
  return Received::tip;
}

/// ClientSocket prints to standard error where it cannot connect.
class SilentSocket : public igtl::ClientSocket {
 public:
  using Self = SilentSocket;
  using Pointer = igtl::SmartPointer<Self>;
  igtlNewMacro(SilentSocket);

  bool connectTo(const TrackingAddress &address) {
    m_SocketDescriptor = CreateSocket();
    return m_SocketDescriptor >= 0 && Connect(m_SocketDescriptor, address.host.c_str(), address.port) == 0;
  }
};

class IgtlSocket : public MessageSocket {
 public:
  explicit IgtlSocket(const SilentSocket::Pointer &socket) : socket_(socket) {
    socket_->SetReceiveTimeout(kWait_ms);
    socket_->SetSendTimeout(kSendTimeout_ms);
  }
  ~IgtlSocket() override { socket_->CloseSocket(); }

  Expected<Received> receive(TrackedFrame &frame) override {
    if (const auto complete = fill(); !complete || !*complete)
      return complete ? Expected<Received>(Received::nothing) : tl::unexpected(complete.error());
    if (bytes_.size() == kHeaderSize && bodySize() > 0) {
      if (bodySize() > kLargestBody)
        return fail(ErrorCode::input,
                    fmt::format("a message of {} bytes was announced; accepted: at most {}", bodySize(), kLargestBody));
      return Received::nothing;  // its body follows
    }
    const Received out = read(frame);
    bytes_.clear();
    return out;
  }

  bool send(const Bytes &message) override {
    return socket_->Send(message.data(), static_cast<int>(message.size())) == 1;
  }

 private:
  [[nodiscard]] std::uint64_t bodySize() const { return numberAt(bytes_, kSizeOffset, 8); }

  /// Reads what is missing of the header, or then of the body. True: it is complete.
  Expected<bool> fill() {
    const std::size_t wanted = bytes_.size() < kHeaderSize ? kHeaderSize : kHeaderSize + bodySize();
    constexpr std::size_t kMostAtOnce = 1u << 20;  // a body that never arrives takes no memory
    while (bytes_.size() < wanted) {
      const std::size_t before = bytes_.size(), part = std::min(wanted - before, kMostAtOnce);
      bytes_.resize(before + part);
      const int count = socket_->Receive(bytes_.data() + before, static_cast<int>(part), 0);
      bytes_.resize(before + static_cast<std::size_t>(std::max(count, 0)));
      if (count == 0) return fail(ErrorCode::input, "the server has closed the connection");
      if (count < 0) return false;
    }
    return true;
  }

  Received read(TrackedFrame &frame) const {
    const std::optional<Bytes> bytes = withoutExtension(bytes_);
    if (!bytes) return Received::refused;
    const auto header = igtl::MessageHeader::New();
    header->InitPack();
    std::memcpy(header->GetPackPointer(), bytes->data(), kHeaderSize);
    header->Unpack();
    const std::string_view type = header->GetDeviceType();
    const std::size_t size = bytes->size() - kHeaderSize;
    if (type == "POINT") return readPoints(*bytes, header, frame);
    if (type == "TRANSFORM")
      return size == kTransformSize ? readTip<igtl::TransformMessage>(*bytes, header, frame) : Received::refused;
    if (type != "POSITION") return Received::skipped;
    const bool isKnown =
        std::find(std::begin(kPositionSizes), std::end(kPositionSizes), size) != std::end(kPositionSizes);
    return isKnown ? readTip<igtl::PositionMessage>(*bytes, header, frame) : Received::refused;
  }

  SilentSocket::Pointer socket_;
  Bytes bytes_;  ///< of the message that is being received
};

}  // namespace

bool MessageSocket::isAvailable() { return true; }

std::unique_ptr<MessageSocket> MessageSocket::connectTo(const TrackingAddress &address) {
  const SilentSocket::Pointer socket = SilentSocket::New();
  if (!socket->connectTo(address)) return nullptr;
  return std::make_unique<IgtlSocket>(socket);
}

Bytes packedTransform(const std::string &device, const Mat4 &motion) {
  const auto message = igtl::TransformMessage::New();
  igtl::Matrix4x4 matrix;
  setMatrix(motion, matrix);
  message->SetMatrix(matrix);
  return packed(message, device);
}

Bytes packedPoints(const std::string &device, const std::vector<TrackedPoint> &points) {
  const auto message = igtl::PointMessage::New();
  for (const TrackedPoint &point : points) {
    igtl::PointElement::Pointer element = igtl::PointElement::New();
    element->SetName(point.name.substr(0, kPointNameLength).c_str());
    const Vec3 at = mirrored(point.at_mm);
    element->SetPosition(static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2]));
    message->AddPointElement(element);
  }
  return packed(message, device);
}

Bytes packedImage(const std::string &device, const imaging::Volume &image) {
  const auto message = igtl::ImageMessage::New();
  const auto &size = image.geometry.size;
  const Vec3 spacing = image.geometry.spacing();
  message->SetDimensions(static_cast<int>(size[0]), static_cast<int>(size[1]), static_cast<int>(size[2]));
  message->SetSpacing(static_cast<float>(spacing[0]), static_cast<float>(spacing[1]), static_cast<float>(spacing[2]));
  message->SetScalarType(igtl::ImageMessage::TYPE_FLOAT32);
  message->SetEndian(std::endian::native == std::endian::little ? igtl::ImageMessage::ENDIAN_LITTLE
                                                                : igtl::ImageMessage::ENDIAN_BIG);
  message->SetCoordinateSystem(igtl::ImageMessage::COORDINATE_RAS);
  // Unit vectors of the index axes, and the centre of the image.
  const Mat4 &grid = image.geometry.indexToWorld;
  igtl::Matrix4x4 matrix;
  igtl::IdentityMatrix(matrix);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3 along = mirrored({grid[4 * axis], grid[4 * axis + 1], grid[4 * axis + 2]});
    for (std::size_t row = 0; row < 3; ++row) matrix[row][axis] = static_cast<float>(along[row] / spacing[axis]);
  }
  Vec3 middle{};
  for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] = 0.5 * static_cast<double>(size[axis] - 1);
  const Vec3 centre = mirrored(image.geometry.worldAt(middle));
  for (std::size_t row = 0; row < 3; ++row) matrix[row][3] = static_cast<float>(centre[row]);
  message->SetMatrix(matrix);
  message->AllocateScalars();
  auto *values = static_cast<float *>(message->GetScalarPointer());
  std::visit(
      [&](const auto &voxels) {
        std::transform(voxels.begin(), voxels.end(), values, [&](auto voxel) {
          return static_cast<float>(image.slope * static_cast<double>(voxel) + image.intercept);
        });
      },
      image.voxels);
  return packed(message, device);
}

}  // namespace c3de::tracking
