// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/recording_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

#include "base/byte_fields.h"
#include "c3de/core/input_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"

namespace c3de::session {
namespace {

constexpr std::string_view kRecordingMagic = "C3DE recording\n";
// A record: type, size of its content, checksum of these two, content, checksum of type, size and content.
constexpr std::size_t kTypeBytes = 4;
constexpr std::size_t kHeaderBytes = kTypeBytes + 8 + 4;
constexpr std::size_t kChecksumBytes = 4;
constexpr std::string_view kStartType = "STRT";
constexpr std::array<std::string_view, 6> kTypes{"CHNG", "RSET", "STAT", "SCEN", "HASH", "END."};  // as RecordedEvent
static_assert(kTypes.size() == std::variant_size_v<RecordedEvent>);

std::uint32_t crcOf(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(crc32_z(before, reinterpret_cast<const Bytef *>(bytes.data()), bytes.size()));
}

std::string framed(std::string_view type, std::string_view content) {
  std::string out(type);
  putNumber(out, std::uint64_t{content.size()});
  const std::uint32_t ofHeader = crcOf(out);
  putNumber(out, ofHeader);
  out += content;
  putNumber(out, crcOf(content, ofHeader));
  return out;
}

Expected<std::string> bytesOf(const SimulationChange &change) {
  std::string out;
  putNumber(out, change.steps);
  putNumber(out, change.flags);
  for (const std::string *text : {&change.id, &change.key, &change.text}) putText<std::uint32_t>(out, *text);
  return out + change.bytes;
}

Expected<std::string> bytesOf(const RecordedReset &reset) {
  std::string out;
  putNumber(out, reset.steps);
  return out;
}

Expected<std::string> bytesOf(const RecordedState &state) {
  std::string out;
  putNumber(out, state.steps);
  return out + state.bytes;
}

Expected<std::string> bytesOf(const RecordedScene &scene) {
  std::string out;
  putNumber(out, scene.steps);
  auto session = sessionBytes(scene.session);
  return session ? out + *session : session;
}

Expected<std::string> bytesOf(const RecordedHash &hash) {
  std::string out;
  putNumber(out, hash.steps);
  putNumber(out, hash.made);
  putReal(out, hash.time_s);
  putNumber(out, hash.hash);
  return out;
}

/// Reads the content of one record; a content that is too short sets isShort().
class RecordContent {
 public:
  RecordContent(std::string_view bytes, std::string place) : rest_(bytes), place_(std::move(place)) {}

  template <class Number>
  Number number() {
    return taken(takeNumber<Number>(rest_));
  }
  double real() { return taken(takeReal(rest_)); }
  std::string text() { return std::string(taken(takeText<std::uint32_t>(rest_))); }
  std::string rest() { return std::string(std::exchange(rest_, {})); }
  SessionFile session() {
    if (isShort_) return {};
    std::istringstream in(rest());
    auto read = readSession(in, place_);
    if (read) return std::move(*read);
    problem_ = read.error().message;
    return {};
  }
  /// What is wrong with the content; empty: nothing.
  [[nodiscard]] std::string problem() const {
    if (isShort_) return place_ + " is too short";
    return problem_.empty() && !rest_.empty() ? place_ + " is too long" : problem_;
  }

 private:
  template <class Value>
  Value taken(const std::optional<Value> &value) {
    isShort_ = isShort_ || !value;
    return value.value_or(Value{});
  }

  std::string_view rest_;
  std::string place_, problem_;
  bool isShort_ = false;
};

RecordedHash hashIn(RecordContent &content) {
  RecordedHash hash;
  hash.steps = content.number<std::uint64_t>();
  hash.made = content.number<std::uint64_t>();
  hash.time_s = content.real();
  hash.hash = content.number<std::uint64_t>();
  return hash;
}

RecordedEvent eventIn(std::size_t type, RecordContent &content) {
  switch (type) {
    case 0: {
      SimulationChange change;
      change.steps = content.number<std::uint64_t>();
      change.flags = content.number<std::uint32_t>();
      for (std::string *text : {&change.id, &change.key, &change.text}) *text = content.text();
      change.bytes = content.rest();
      return change;
    }
    case 1: return RecordedReset{content.number<std::uint64_t>()};
    case 2: {
      const auto steps = content.number<std::uint64_t>();
      return RecordedState{steps, content.rest()};
    }
    case 3: {
      const auto steps = content.number<std::uint64_t>();
      return RecordedScene{steps, content.session()};
    }
    case 4: return hashIn(content);
    default: return RecordedEnd{hashIn(content)};
  }
}

RecordingStart startIn(RecordContent &content) {
  RecordingStart start;
  start.hashEvery = content.number<std::uint64_t>();
  for (std::string *text : {&start.simulator.classId, &start.simulator.plugin, &start.simulator.version})
    *text = content.text();
  start.session = content.session();
  return start;
}

/// Reads one record after another.
class RecordReader {
 public:
  RecordReader(std::istream &in, std::string file, std::uint64_t size) : in_(in), file_(std::move(file)), left_(size) {}

  /// Checks the first bytes of the file.
  Expected<void> readHead() {
    const auto magic = take(kRecordingMagic.size());
    const auto number = take(sizeof kRecordingFormat);
    if (!magic || *magic != kRecordingMagic || !number)
      return fail(ErrorCode::input, file_ + ": is no recording; accepted: files that `c3de run --record` has written");
    std::string_view bytes = *number;
    const std::uint32_t format = takeNumber<std::uint32_t>(bytes).value_or(0);
    if (format == 0 || format > kRecordingFormat)
      return fail(ErrorCode::input,
                  fmt::format("{}: a recording of format {}; accepted: up to {}", file_, format, kRecordingFormat));
    return {};
  }

  struct Record {
    std::string type, content;
  };
  /// None: the file ends, here or within the record.
  Expected<std::optional<Record>> next() {
    ++number_;
    place_ = fmt::format("{}: record {} at byte {}", file_, number_, at_);
    auto header = take(kHeaderBytes);
    if (!header) return std::optional<Record>();
    std::string_view rest = std::string_view(*header).substr(kTypeBytes);
    const auto size = takeNumber<std::uint64_t>(rest);
    const auto ofHeader = takeNumber<std::uint32_t>(rest);
    const std::uint32_t sum = crcOf(std::string_view(*header).substr(0, kHeaderBytes - kChecksumBytes));
    if (sum != *ofHeader) {
      // A file system may have made the file longer before the power failed.
      if (isZero(*header) && isZeroToEnd()) return std::optional<Record>();
      return fail(ErrorCode::input, place_ + " is damaged: its header has another checksum");
    }
    Record record;
    record.type = header->substr(0, kTypeBytes);
    if (*size > left_ || left_ - *size < kChecksumBytes) return std::optional<Record>();
    auto content = take(static_cast<std::size_t>(*size));
    const auto ofContent = take(kChecksumBytes);
    if (!content || !ofContent) return std::optional<Record>();
    std::string_view bytes = *ofContent;
    if (takeNumber<std::uint32_t>(bytes) != crcOf(*content, sum))
      return fail(ErrorCode::input,
                  fmt::format("{} ({}) is damaged: another checksum", place_, displayText(record.type)));
    record.content = std::move(*content);
    return std::optional(std::move(record));
  }
  /// Of the last record, for messages.
  [[nodiscard]] const std::string &place() const { return place_; }
  [[nodiscard]] std::uint64_t left() const { return left_; }

 private:
  std::optional<std::string> take(std::size_t size) {
    if (size > left_) return std::nullopt;
    std::string bytes(size, '\0');
    in_.read(bytes.data(), static_cast<std::streamsize>(size));
    if (static_cast<std::size_t>(in_.gcount()) != size) return std::nullopt;
    left_ -= size;
    at_ += size;
    return bytes;
  }
  static bool isZero(std::string_view bytes) {
    return std::all_of(bytes.begin(), bytes.end(), [](char c) { return c == '\0'; });
  }
  bool isZeroToEnd() {
    constexpr std::uint64_t kChunk = std::uint64_t{1} << 16;
    while (left_ > 0) {
      const auto bytes = take(static_cast<std::size_t>(std::min(left_, kChunk)));
      if (!bytes || !isZero(*bytes)) return false;
    }
    return true;
  }

  std::istream &in_;
  std::string file_, place_;
  std::uint64_t left_, at_ = 0;
  std::size_t number_ = 0;
};

tl::unexpected<Error> unknownType(const std::string &place, const std::string &type) {
  std::string known(kStartType);
  for (const std::string_view one : kTypes) known.append(", ").append(one);
  return fail(ErrorCode::input, fmt::format("{} has the type '{}', which this version of the program does not know; "
                                            "accepted: {}",
                                            place, displayText(type), known));
}

Expected<Recording> readRecords(RecordReader &reader, const std::string &file) {
  if (const auto head = reader.readHead(); !head) return tl::unexpected(head.error());
  Recording recording;
  const auto first = reader.next();
  if (!first) return tl::unexpected(first.error());
  if (!*first) return fail(ErrorCode::input, file + ": ends before the state that it begins with is complete");
  if ((*first)->type != kStartType)
    return fail(ErrorCode::input, fmt::format("{} has the type '{}'; accepted: {}", reader.place(),
                                              displayText((*first)->type), kStartType));
  RecordContent beginning((*first)->content, reader.place());
  recording.start = startIn(beginning);
  if (const std::string problem = beginning.problem(); !problem.empty()) return fail(ErrorCode::input, problem);
  while (!recording.isComplete()) {
    const auto record = reader.next();
    if (!record) return tl::unexpected(record.error());
    if (!*record) return recording;
    const auto type = std::find(kTypes.begin(), kTypes.end(), (*record)->type);
    if (type == kTypes.end()) return unknownType(reader.place(), (*record)->type);
    RecordContent content((*record)->content, reader.place());
    recording.events.push_back(eventIn(static_cast<std::size_t>(type - kTypes.begin()), content));
    if (const std::string problem = content.problem(); !problem.empty()) return fail(ErrorCode::input, problem);
  }
  if (reader.left() > 0)
    return fail(ErrorCode::input, fmt::format("{}: is damaged: {} bytes follow its end", file, reader.left()));
  return recording;
}

}  // namespace

std::uint64_t stepsOf(const RecordedEvent &event) {
  return std::visit([](const auto &one) { return one.steps; }, event);
}

bool Recording::isComplete() const { return !events.empty() && std::holds_alternative<RecordedEnd>(events.back()); }

const RecordedHash *hashOf(const RecordedEvent &event) {
  if (const auto *end = std::get_if<RecordedEnd>(&event)) return end;
  return std::get_if<RecordedHash>(&event);
}

const RecordedHash *Recording::lastHash() const {
  for (auto event = events.rbegin(); event != events.rend(); ++event)
    if (const RecordedHash *hash = hashOf(*event)) return hash;
  return nullptr;
}

std::string Recording::whyIncomplete() const {
  if (isComplete()) return {};
  return fmt::format("ends early, after step {}", events.empty() ? start.session.steps : stepsOf(events.back()));
}

bool isRecordingPath(const std::filesystem::path &path) { return path.extension() == ".c3dr"; }

Expected<std::string> recordingBytes(const RecordingStart &start) {
  std::string content;
  putNumber(content, start.hashEvery);
  for (const std::string *text : {&start.simulator.classId, &start.simulator.plugin, &start.simulator.version})
    putText<std::uint32_t>(content, *text);
  const auto session = sessionBytes(start.session);
  if (!session) return session;
  std::string out(kRecordingMagic);
  putNumber(out, kRecordingFormat);
  return out + framed(kStartType, content + *session);
}

Expected<std::string> recordingBytes(const RecordedEvent &event) {
  auto content = std::visit([](const auto &one) { return bytesOf(one); }, event);
  if (!content) return content;
  return framed(kTypes[event.index()], *content);
}

Expected<Recording> readRecording(const std::filesystem::path &path) {
  const std::string file = pathText(path);
  auto in = openInputFile(path);
  if (!in) return tl::unexpected(in.error());
  in->seekg(0, std::ios::end);
  const std::streamoff size = in->tellg();
  in->seekg(0);
  if (size < 0 || !*in) return fail(ErrorCode::input, file + ": cannot be read");
  const auto bytes = static_cast<std::uint64_t>(size);
  if (const std::uint64_t free = availableMemory(); free != 0 && bytes > free)
    return fail(ErrorCode::input, fmt::format("{}: has {} bytes; the free memory has {}", file, bytes, free));
  RecordReader reader(*in, file, bytes);
  return readRecords(reader, file);
}

}  // namespace c3de::session
