// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/simulation_state.h"

#include <fmt/format.h>

#include <fstream>

#include "base/byte_fields.h"
#include "c3de/core/input_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

constexpr std::string_view kMagic = "C3DE simulation state\n";
constexpr std::uint64_t kFormat = 1;
constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 34;

/// FNV-1a: detects a truncated file or a flipped bit, not a forgery.
std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t sum = 0xcbf29ce484222325ull;
  for (const char c : bytes) sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return sum;
}

Expected<const c3de_simulator_v1 *> keepingTable(c3de_object *simulator, const SimulatorIdentity &identity) {
  const auto table = simulatorTable(simulator);
  if (!table) return table;
  if ((*table)->save_state == nullptr || (*table)->load_state == nullptr)
    return fail(ErrorCode::plugin,
                fmt::format("simulator {} of {} cannot save states", identity.classId, identity.plugin));
  return table;
}

std::string reasonOf(Session &session, c3de_status code) {
  const std::string reason = session.plugins().takeError();
  return reason.empty() ? fmt::format("status {}", code) : reason;
}

struct StateFile {
  std::string_view classId, plugin, version, state;
};

Expected<StateFile> readHeader(std::string_view bytes, const std::string &name) {
  if (!bytes.starts_with(kMagic))
    return fail(ErrorCode::input, name + ": is not a state file written by --save-state or Save state");
  std::string_view rest = bytes.substr(kMagic.size());
  const auto format = takeNumber<std::uint64_t>(rest);
  if (format && *format != kFormat)
    return fail(ErrorCode::input, fmt::format("{}: state files of format {}; accepted: {}", name, *format, kFormat));
  const auto classId = takeText<std::uint64_t>(rest), plugin = takeText<std::uint64_t>(rest),
             version = takeText<std::uint64_t>(rest), state = takeText<std::uint64_t>(rest);
  const std::string_view summed = bytes.substr(0, bytes.size() - rest.size());
  const auto sum = takeNumber<std::uint64_t>(rest);
  if (!format || !classId || !plugin || !version || !state || !sum)
    return fail(ErrorCode::input, fmt::format("{}: the state ends too early, after {} bytes", name, bytes.size()));
  if (*sum != checksum(summed) || !rest.empty())
    return fail(ErrorCode::input, name + ": the state is damaged: its checksum does not match");
  return StateFile{*classId, *plugin, *version, *state};
}

}  // namespace

Expected<std::string> stateBytes(Session &session, c3de_object *simulator, const SimulatorIdentity &identity) {
  const auto table = keepingTable(simulator, identity);
  if (!table) return tl::unexpected(table.error());
  std::string state;
  if (const c3de_status code = (*table)->save_state(simulator, scene::sinkInto(state)); code < 0)
    return fail(ErrorCode::state, "the state cannot be saved: " + reasonOf(session, code));
  std::string out(kMagic);
  putNumber(out, kFormat);
  putText<std::uint64_t>(out, identity.classId);
  putText<std::uint64_t>(out, identity.plugin);
  putText<std::uint64_t>(out, identity.version);
  putText<std::uint64_t>(out, state);
  putNumber(out, checksum(out));
  return out;
}

Expected<void> goToState(Session &session, c3de_object *simulator, const SimulatorIdentity &identity,
                         std::string_view bytes, const std::string &name) {
  const auto table = keepingTable(simulator, identity);
  if (!table) return tl::unexpected(table.error());
  const auto file = readHeader(bytes, name);
  if (!file) return tl::unexpected(file.error());
  if (file->classId != identity.classId || file->plugin != identity.plugin)
    return fail(ErrorCode::input,
                fmt::format("{}: a state of simulator {} ({}); this simulation is of {} ({})", name,
                            displayText(file->classId), displayText(file->plugin), identity.classId, identity.plugin));
  if (file->version != identity.version)
    return fail(ErrorCode::input, fmt::format("{}: a state of version {} of {}; accepted: {}", name,
                                              displayText(file->version), identity.plugin, identity.version));
  if (const c3de_status code = (*table)->load_state(simulator, file->state.data(), file->state.size()); code < 0)
    return fail(ErrorCode::input, name + ": " + reasonOf(session, code));
  return {};
}

Expected<std::string> readStateFile(const std::filesystem::path &file) {
  const std::string name = pathText(file);
  auto in = openInputFile(file);
  if (!in) return tl::unexpected(in.error());
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error || size > kMaxBytes)
    return fail(ErrorCode::input,
                fmt::format("{}: cannot be read as a state; accepted: up to {} bytes", name, kMaxBytes));
  std::string bytes(static_cast<std::size_t>(size), '\0');
  in->read(bytes.data(), static_cast<std::streamsize>(size));
  if (!*in) return fail(ErrorCode::input, name + ": cannot be read (permission, or it changed while it was read)");
  return bytes;
}

}  // namespace c3de::session
