// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/sample_points.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <map>

#include "c3de/core/csv.h"
#include "c3de/core/input_file.h"
#include "c3de/core/output_file.h"
#include "c3de/core/text.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

constexpr std::array<const char *, 3> kAt{"x [m]", "y [m]", "z [m]"};
constexpr std::array<const char *, 3> kAtEnd{"x at the end [m]", "y at the end [m]", "z at the end [m]"};

tl::unexpected<Error> refuse(const std::filesystem::path &file, int line, const std::string &what) {
  return fail(ErrorCode::input, file.string() + ":" + std::to_string(line) + ": " + what);
}

std::string rowOf(const Vec3 &v) {
  return ',' + formatNumber(v[0]) + ',' + formatNumber(v[1]) + ',' + formatNumber(v[2]);
}

std::string headOf(const std::array<const char *, 3> &axes) {
  std::string text;
  for (const char *axis : axes) text += std::string(",") + axis;
  return text;
}

}  // namespace

Expected<std::vector<SamplePoint>> readSamplePoints(const std::filesystem::path &file,
                                                    const std::array<const char *, 3> &axes) {
  auto opened = openInputFile(file);
  if (!opened) return tl::unexpected(opened.error());
  std::ifstream &in = *opened;
  std::string row;
  if (!std::getline(in, row))
    return fail(ErrorCode::input, file.string() +
                                      ": is empty or cannot be read; accepted: a table (CSV) with the columns body, " +
                                      std::string(axes[0]) + ", " + axes[1] + ", " + axes[2]);
  const auto head = splitCsvRow(row);
  std::array<std::size_t, 4> columns{};
  const std::array<const char *, 4> names{"body", axes[0], axes[1], axes[2]};
  for (std::size_t c = 0; c < 4; ++c) {
    const auto found =
        head ? std::find(head->begin(), head->end(), names[c]) : std::vector<std::string>::const_iterator();
    if (!head || found == head->end())
      return refuse(file, 1,
                    std::string("the column '") + names[c] + "' is missing; accepted: a heading with body, " + axes[0] +
                        ", " + axes[1] + ", " + axes[2]);
    columns[c] = static_cast<std::size_t>(found - head->begin());
  }
  std::vector<SamplePoint> points;
  for (int line = 2; std::getline(in, row); ++line) {
    if (row.empty() || row == "\r") continue;
    const auto cells = splitCsvRow(row);
    if (!cells || cells->size() != head->size())
      return refuse(file, line, "the row has not the " + std::to_string(head->size()) + " cells of the heading");
    SamplePoint point{(*cells)[columns[0]], {}, line};
    for (std::size_t a = 0; a < 3; ++a) {
      const std::string &cell = (*cells)[columns[a + 1]];
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), point.at_m[a]);
      if (error != std::errc() || end != cell.data() + cell.size() || !(std::abs(point.at_m[a]) <= 1e9))
        return refuse(file, line, "'" + displayText(cell) + "' is not a number in m");
    }
    if (points.size() == kMaxSamplePoints)
      return refuse(file, line, "more than " + std::to_string(kMaxSamplePoints) + " points");
    points.push_back(std::move(point));
  }
  if (points.empty()) return refuse(file, 1, "there is no point after the heading");
  return points;
}

Expected<std::vector<SamplePoint>> readSamplePoints(const std::filesystem::path &file) {
  return readSamplePoints(file, kAt);
}

Expected<void> writeSamplePoints(const std::filesystem::path &file, const std::vector<SamplePoint> &points) {
  std::string text = "body" + headOf(kAt) + "\n";
  for (const SamplePoint &point : points) text += csvCell(point.body) + rowOf(point.at_m) + '\n';
  return writeWholeFile(file, text);
}

Expected<std::vector<Vec3>> positionsOf(c3de_object *simulator, const std::vector<SamplePoint> &points,
                                        const std::string &where, const std::function<std::string()> &takeError) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  const auto refused = [&](ErrorCode kind, int line, const std::string &what, c3de_status code) {
    const std::string reason = takeError ? takeError() : "";
    return fail(kind, where + (line > 0 ? ":" + std::to_string(line) : "") + ": " +
                          (reason.empty() ? what + " (status " + std::to_string(code) + ")" : reason));
  };
  c3de_sim_status status{};
  status.size = sizeof status;
  if (const c3de_status code = (*table)->status(simulator, &status); code < 0)
    return refused(ErrorCode::plugin, 0, "the simulator does not say its status", code);
  std::map<std::string, c3de_handle> bodies;
  std::vector<std::string> names;
  for (std::uint64_t i = 0; i < status.bodies; ++i) {
    c3de_handle handle{};
    c3de_sim_body_info info{};
    info.size = sizeof info;
    if (const c3de_status code = (*table)->body_at(simulator, i, &handle); code < 0)
      return refused(ErrorCode::plugin, 0, "the simulator does not give a body", code);
    if (const c3de_status code = (*table)->body_info(simulator, handle, &info); code < 0)
      return refused(ErrorCode::plugin, 0, "the simulator does not give the name of a body", code);
    names.emplace_back(fromAbi(info.name));
    bodies.emplace(names.back(), handle);
  }

  struct Added {
    const c3de_simulator_v1 *table;
    c3de_object *simulator;
    std::vector<c3de_handle> probes;
    ~Added() {
      for (const c3de_handle probe : probes) (void)table->remove(simulator, probe);
    }
  } added{*table, simulator, {}};
  // The scene's probes come first, the added ones after them.
  const auto before = readProbes(*table, simulator);
  if (!before) return tl::unexpected(before.error());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SamplePoint &point = points[i];
    const auto body = bodies.find(point.body);
    if (body == bodies.end()) {
      const std::string nearest = nearestName(point.body, names);
      return fail(ErrorCode::input, where + ":" + std::to_string(point.line) + ": there is no body '" +
                                        displayText(point.body) + "'" +
                                        (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
    c3de_handle probe{};
    const std::string name = "sample point " + std::to_string(i + 1);
    if (const c3de_status code = (*table)->add_probe(simulator, toAbi(name), body->second, point.at_m.data(), &probe);
        code < 0)
      return refused(ErrorCode::input, point.line, "the point cannot be followed", code);
    added.probes.push_back(probe);
  }
  const auto samples = readProbes(*table, simulator);
  if (!samples) return tl::unexpected(samples.error());
  if (samples->size() != before->size() + points.size())
    return fail(ErrorCode::plugin, "the simulator has " + std::to_string(samples->size()) + " probes where " +
                                       std::to_string(before->size() + points.size()) + " were added");
  std::vector<Vec3> positions;
  for (std::size_t i = before->size(); i < samples->size(); ++i) positions.push_back((*samples)[i].position_m);
  return positions;
}

Expected<void> writeSampled(const std::filesystem::path &file, const std::vector<SamplePoint> &points,
                            const std::vector<Vec3> &positions_m) {
  std::string text = "body" + headOf(kAt) + headOf(kAtEnd) + "\n";
  for (std::size_t i = 0; i < points.size(); ++i)
    text += csvCell(points[i].body) + rowOf(points[i].at_m) + rowOf(positions_m[i]) + '\n';
  return writeWholeFile(file, text);
}

Expected<std::vector<Vec3>> readSampled(const std::filesystem::path &file) {
  const auto read = readSamplePoints(file, kAtEnd);
  if (!read) return tl::unexpected(read.error());
  std::vector<Vec3> positions;
  for (const SamplePoint &point : *read) positions.push_back(point.at_m);
  return positions;
}

}  // namespace c3de::session
