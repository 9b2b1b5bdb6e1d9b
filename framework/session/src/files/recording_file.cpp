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
#include "files/archive_stream.h"

namespace c3de::session {
namespace {

constexpr std::string_view kRecordingMagic = "C3DE recording\n";
// A record: type, size of its content, checksum of these two, content, checksum of type, size and content.
constexpr std::size_t kTypeBytes = 4;
constexpr std::size_t kHeaderBytes = kTypeBytes + 8 + 4;
constexpr std::size_t kChecksumBytes = 4;
constexpr std::string_view kStartType = "STRT";
constexpr std::uint64_t kLongestHead = std::uint64_t{1} << 16;  // of a start, before its session
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
  [[nodiscard]] std::size_t left() const { return rest_.size(); }
  [[nodiscard]] bool isShort() const { return isShort_; }
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

/// What is before the session.
RecordingStart startIn(RecordContent &content) {
  RecordingStart start;
  start.hashEvery = content.number<std::uint64_t>();
  for (std::string *text : {&start.simulator.classId, &start.simulator.plugin, &start.simulator.version})
    *text = content.text();
  return start;
}

std::string headOf(const RecordingStart &start) {
  std::string head;
  putNumber(head, start.hashEvery);
  for (const std::string *text : {&start.simulator.classId, &start.simulator.plugin, &start.simulator.version})
    putText<std::uint32_t>(head, *text);
  return head;
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
  /// Where the content of a record is in the file.
  struct Extent {
    std::string type;
    std::uint64_t begin = 0, size = 0;
    std::uint32_t checksum = 0;  ///< of the header
  };
  /// None: the file ends, here or within the record.
  Expected<std::optional<Record>> next() {
    const auto extent = nextExtent();
    if (!extent) return tl::unexpected(extent.error());
    if (!*extent) return std::optional<Record>();
    Record record{(*extent)->type, {}};
    if (const std::uint64_t free = availableMemory(); free != 0 && (*extent)->size > free)
      return fail(ErrorCode::input,
                  fmt::format("{} has {} bytes; the free memory has {}", place_, (*extent)->size, free));
    auto read = readContent(**extent, [&record](std::string_view piece) { record.content += piece; });
    if (!read) return tl::unexpected(read.error());
    return *read ? std::optional(std::move(record)) : std::optional<Record>();
  }
  /// Reads the content in pieces and compares its checksum. False: the file ends within it.
  template <class Take>
  Expected<bool> readContent(const Extent &extent, const Take &take) {
    constexpr std::uint64_t kPiece = std::uint64_t{1} << 20;
    std::uint32_t sum = extent.checksum;
    for (std::uint64_t rest = extent.size; rest > 0;) {
      const auto piece = this->take(static_cast<std::size_t>(std::min(rest, kPiece)));
      if (!piece) return false;
      sum = crcOf(*piece, sum);
      take(*piece);
      rest -= piece->size();
    }
    const auto ofContent = this->take(kChecksumBytes);
    if (!ofContent) return false;
    std::string_view bytes = *ofContent;
    if (takeNumber<std::uint32_t>(bytes) != sum)
      return fail(ErrorCode::input,
                  fmt::format("{} ({}) is damaged: another checksum", place_, displayText(extent.type)));
    return true;
  }
  /// The header of the next record. None: the file ends, here or within the record.
  Expected<std::optional<Extent>> nextExtent() {
    ++number_;
    place_ = fmt::format("{}: record {} at byte {}", file_, number_, at_);
    auto header = take(kHeaderBytes);
    if (!header) return std::optional<Extent>();
    std::string_view rest = std::string_view(*header).substr(kTypeBytes);
    const auto size = takeNumber<std::uint64_t>(rest);
    const auto ofHeader = takeNumber<std::uint32_t>(rest);
    const std::uint32_t sum = crcOf(std::string_view(*header).substr(0, kHeaderBytes - kChecksumBytes));
    if (sum != *ofHeader) {
      // A file system may have made the file longer before the power failed.
      if (isZero(*header) && isZeroToEnd()) return std::optional<Extent>();
      return fail(ErrorCode::input, place_ + " is damaged: its header has another checksum");
    }
    if (*size > left_ || left_ - *size < kChecksumBytes) return std::optional<Extent>();
    return std::optional(Extent{header->substr(0, kTypeBytes), at_, *size, sum});
  }
  [[nodiscard]] std::istream &stream() { return in_; }
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

/// The start, and where its archive is in the file.
struct FoundStart {
  RecordingStart start;  ///< without the session
  std::uint64_t begin = 0, size = 0;
};

/// @param extent  of the first record
Expected<FoundStart> findStart(RecordReader &reader, const RecordReader::Extent &extent) {
  std::string head(static_cast<std::size_t>(std::min(extent.size, kLongestHead)), '\0');
  std::istream &in = reader.stream();
  const auto place = in.tellg();
  in.seekg(static_cast<std::streamoff>(extent.begin));
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  in.clear();
  in.seekg(place);
  RecordContent content(head, reader.place());
  FoundStart found{startIn(content), 0, 0};
  if (content.isShort()) return fail(ErrorCode::input, content.problem());
  const std::uint64_t before = head.size() - content.left();
  found.begin = extent.begin + before;
  found.size = extent.size - before;
  return found;
}

Expected<RecordReader::Extent> firstExtent(RecordReader &reader, const std::string &file) {
  const auto first = reader.nextExtent();
  if (!first) return tl::unexpected(first.error());
  if (!*first) return fail(ErrorCode::input, file + ": ends before the state that it begins with is complete");
  if ((*first)->type != kStartType)
    return fail(ErrorCode::input, fmt::format("{} has the type '{}'; accepted: {}", reader.place(),
                                              displayText((*first)->type), kStartType));
  return **first;
}

/// Embedded files stay in the file.
Expected<RecordingStart> readStart(RecordReader &reader, const std::string &file) {
  const auto extent = firstExtent(reader, file);
  if (!extent) return tl::unexpected(extent.error());
  const auto isWhole = reader.readContent(*extent, [](std::string_view) {});
  if (!isWhole) return tl::unexpected(isWhole.error());
  if (!*isWhole) return fail(ErrorCode::input, file + ": ends before the state that it begins with is complete");
  auto found = findStart(reader, *extent);
  if (!found) return tl::unexpected(found.error());
  const auto place = reader.stream().tellg();
  StreamPart archive(reader.stream(), found->begin, found->size);
  auto session = readSession(archive, reader.place(), EmbeddedContent::stays);
  if (!session) return tl::unexpected(session.error());
  reader.stream().clear();
  reader.stream().seekg(place);
  found->start.session = std::move(*session);
  return std::move(found->start);
}

Expected<Recording> readRecords(RecordReader &reader, const std::string &file) {
  if (const auto head = reader.readHead(); !head) return tl::unexpected(head.error());
  Recording recording;
  auto start = readStart(reader, file);
  if (!start) return tl::unexpected(start.error());
  recording.start = std::move(*start);
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

Expected<void> writeRecordingStart(const RecordingStart &start,
                                   const std::function<Expected<void>(std::string_view)> &sink,
                                   const ProgressFn &progress) {
  const std::string head = headOf(start);
  std::uint64_t size = head.size();
  if (auto packed = packSession(
          start.session, [&size](std::string_view piece) { size += piece.size(); }, progress);
      !packed)
    return packed;
  std::string header(kStartType);
  putNumber(header, size);
  std::uint32_t checksum = crcOf(header);
  putNumber(header, checksum);
  std::string first(kRecordingMagic);
  putNumber(first, kRecordingFormat);
  Expected<void> written = sink(first + header + head);
  checksum = crcOf(head, checksum);
  std::uint64_t again = head.size();
  const auto packed = packSession(
      start.session,
      [&](std::string_view piece) {
        again += piece.size();
        checksum = crcOf(piece, checksum);
        if (written) written = sink(piece);
      },
      [&](double fraction, const std::string &what) { return written && (!progress || progress(fraction, what)); });
  if (!written) return written;
  if (!packed) return packed;
  if (again != size) return fail(ErrorCode::input, "files have changed while they were embedded");
  std::string end;
  putNumber(end, checksum);
  return sink(end);
}

Expected<std::string> recordingBytes(const RecordingStart &start) {
  std::string bytes;
  const auto written = writeRecordingStart(start, [&bytes](std::string_view piece) {
    bytes += piece;
    return Expected<void>();
  });
  if (!written) return tl::unexpected(written.error());
  return bytes;
}

Expected<std::string> recordingBytes(const RecordedEvent &event) {
  auto content = std::visit([](const auto &one) { return bytesOf(one); }, event);
  if (!content) return content;
  return framed(kTypes[event.index()], *content);
}

namespace {

Expected<std::uint64_t> sizeOf(std::istream &in, const std::string &file) {
  in.seekg(0, std::ios::end);
  const std::streamoff size = in.tellg();
  in.seekg(0);
  if (size < 0 || !in) return fail(ErrorCode::input, file + ": cannot be read");
  return static_cast<std::uint64_t>(size);
}

}  // namespace

Expected<Recording> readRecording(const std::filesystem::path &path) {
  const std::string file = pathText(path);
  auto in = openInputFile(path);
  if (!in) return tl::unexpected(in.error());
  const auto bytes = sizeOf(*in, file);
  if (!bytes) return tl::unexpected(bytes.error());
  RecordReader reader(*in, file, *bytes);
  return readRecords(reader, file);
}

Expected<std::unique_ptr<Archive>> openArchive(const std::filesystem::path &path) {
  auto in = openInputFile(path);
  if (!in) return tl::unexpected(in.error());
  auto archive = std::make_unique<Archive>();
  archive->file = std::move(*in);
  std::string magic(kRecordingMagic.size(), '\0');
  archive->file.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  archive->file.clear();
  if (magic != kRecordingMagic) return archive;
  const std::string file = pathText(path);
  const auto bytes = sizeOf(archive->file, file);
  if (!bytes) return tl::unexpected(bytes.error());
  RecordReader reader(archive->file, file, *bytes);
  if (const auto head = reader.readHead(); !head) return tl::unexpected(head.error());
  const auto extent = firstExtent(reader, file);
  if (!extent) return tl::unexpected(extent.error());
  const auto found = findStart(reader, *extent);
  if (!found) return tl::unexpected(found.error());
  archive->part = std::make_unique<StreamPart>(archive->file, found->begin, found->size);
  return archive;
}

}  // namespace c3de::session
