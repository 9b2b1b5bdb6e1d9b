// SPDX-License-Identifier: Apache-2.0
#include "workstation/stretch_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "c3de/session/body_states.h"
#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"

namespace c3de::app {
namespace {

namespace fs = std::filesystem;

constexpr double kFilmPoll_s = 0.1;
constexpr std::size_t kKeptOutput = 600;

/// A folder for pictures that are removed when the film is made.
fs::path temporaryFolder() {
  static std::atomic<unsigned> count{0};
  std::error_code ignored;
  return fs::temp_directory_path(ignored) / fmt::format("c3de-film-{}-{}", processId(), ++count);
}

std::string endOf(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (text.size() > kKeptOutput) text.erase(0, text.size() - kKeptOutput);
  return text;
}

/// In the pattern for the names of pictures, % begins a number.
std::string escaped(const std::string &text) {
  std::string out;
  for (const char c : text) out.append(c == '%' ? 2 : 1, c);
  return out;
}

std::optional<std::uint64_t> nextOf(const std::vector<std::uint64_t> &positions, std::uint64_t at) {
  const auto next = std::upper_bound(positions.begin(), positions.end(), at);
  return next == positions.end() ? std::nullopt : std::optional(*next);
}

}  // namespace

StretchWriter::StretchWriter(ui::StretchExport wanted, const ui::Stretch &stretch, const ui::TimeAt &timeAt_s)
    : wanted_(std::move(wanted)), stretch_(stretch), files_(filesOf(wanted_)),
      isStatic_(timeAt_s(stretch.end) <= timeAt_s(stretch.begin)) {
  if (wanted_.hasFrames) {
    frameAt_ = framePositions(stretch, timeAt_s, 1e-3 * wanted_.frameEvery_ms);
    frameAt_.erase(std::unique(frameAt_.begin(), frameAt_.end()), frameAt_.end());
  }
  if (wanted_.hasPictures || wanted_.hasFilm) {
    pictureAt_ = framePositions(stretch, timeAt_s, 1.0 / wanted_.pictureRate);
    picturesFolder_ = wanted_.hasPictures ? files_.picturesFolder : temporaryFolder();
  }
}

StretchWriter::~StretchWriter() {
  std::error_code ignored;
  if (wanted_.hasFilm && !wanted_.hasPictures) fs::remove_all(picturesFolder_, ignored);
}

Expected<void> StretchWriter::prepare() {
  if (pictureAt_.empty()) return {};
  std::error_code error;
  fs::create_directories(picturesFolder_, error);
  if (!error) return {};
  return fail(ErrorCode::output, pathText(picturesFolder_) + ": the folder cannot be made: " + error.message());
}

void StretchWriter::restart() {
  frames_.reset();
  probes_.reset();
  picture_.reset();
  framesWritten_ = pictures_ = 0;
  writtenAt_.reset();
  lastTime_s_ = resetOffset_s_ = 0.0;
}

/// Where steps are longer than the interval, one picture is several in the sequence.
Expected<void> StretchWriter::writePictures(std::uint64_t at) {
  for (; pictures_ < pictureAt_.size() && pictureAt_[pictures_] == at; ++pictures_)
    if (auto written = render::writePng(pathText(picturesFolder_ / ui::pictureName(pictures_)), *picture_); !written)
      return written;
  picture_.reset();
  return {};
}

Expected<void> StretchWriter::writeProbes(const Timeline::Target &target, double time_s) {
  c3de_object *simulator = target.simulation.object();
  const auto samples = readProbes(target.simulation.table(), simulator);
  if (!samples) return tl::unexpected(samples.error());
  const auto tools = readProbeTools(simulator);
  if (!tools) return tl::unexpected(tools.error());
  if (!probes_) {
    auto created = ProbeTable::create(files_.probes, *samples, *tools);
    if (!created) return tl::unexpected(created.error());
    probes_ = std::move(*created);
  }
  return probes_->add(time_s, *samples, *tools);
}

Expected<void> StretchWriter::writeDue(const Timeline::Target &target, std::uint64_t at) {
  if (writtenAt_ && *writtenAt_ >= at) return {};
  writtenAt_ = at;
  const auto status = simulatorStatus(target.simulation.table(), target.simulation.object());
  if (!status) return tl::unexpected(status.error());
  const double present_s = isStatic_ ? static_cast<double>(status->steps) : status->time_s;
  // After a reset the simulation's time begins again. Times of a series must increase.
  if (resetOffset_s_ + present_s < lastTime_s_) resetOffset_s_ = lastTime_s_;
  lastTime_s_ = resetOffset_s_ + present_s;
  if (wanted_.hasProbes)
    if (auto written = writeProbes(target, lastTime_s_); !written) return written;
  if (!std::binary_search(frameAt_.begin(), frameAt_.end(), at)) return {};
  const auto states = readBodyStates(target.simulation.object(), BodyParts::skinAndInside,
                                     [&target] { return target.session.plugins().takeError(); });
  if (!states) return tl::unexpected(states.error());
  if (!frames_) frames_ = std::make_unique<SimulationExport>(files_.frames);
  if (auto added = frames_->addFrame(lastTime_s_, *states); !added) return added;
  ++framesWritten_;
  return {};
}

/// Probes need each step.
std::uint64_t StretchWriter::nextStop(std::uint64_t at) const {
  if (wanted_.hasProbes) return at + 1;
  return std::min(
      {nextOf(frameAt_, at).value_or(stretch_.end), nextOf(pictureAt_, at).value_or(stretch_.end), stretch_.end});
}

Expected<StretchWriter::Reached> StretchWriter::advance(Timeline &timeline, const Timeline::Target &target,
                                                        Timeline::Limits limits) {
  for (;;) {
    const std::uint64_t at = timeline.position();
    if (picture_)
      if (auto written = writePictures(at); !written) return tl::unexpected(written.error());
    const bool isStop = !writtenAt_ || at >= stretch_.end || at == nextStop(*writtenAt_);
    if (isStop)
      if (auto written = writeDue(target, at); !written) return tl::unexpected(written.error());
    if (pictures_ < pictureAt_.size() && pictureAt_[pictures_] == at) return Reached::picture;
    if (at >= stretch_.end) return Reached::end;
    limits.until = nextStop(at);
    const auto advanced = timeline.advance(target, limits);
    if (!advanced) return tl::unexpected(advanced.error());
    if (advanced->outcome == Timeline::Outcome::retry) return Reached::retry;
    if (advanced->outcome == Timeline::Outcome::paused) return Reached::paused;
  }
}

/// Pictures of a longer sequence with the same name would become part of this one.
Expected<void> StretchWriter::finish() {
  Expected<void> result;
  if (frames_) result = frames_->finish();
  if (probes_)
    if (auto closed = probes_->close(); !closed && result) result = closed;
  if (!wanted_.hasPictures || pictures_ < pictureAt_.size()) return result;
  std::error_code error;
  for (std::size_t i = pictures_; fs::remove(picturesFolder_ / ui::pictureName(i), error); ++i) continue;
  if (error && result)
    result =
        fail(ErrorCode::output, pathText(picturesFolder_) + ": older pictures cannot be removed: " + error.message());
  return result;
}

std::string StretchWriter::written() const {
  std::string text;
  const auto add = [&](const fs::path &file) { text += (text.empty() ? "" : "\n") + pathText(file); };
  if (framesWritten_ > 0) {
    add(files_.frames);
    add(files_.framesFolder);
  }
  if (probes_) add(files_.probes);
  if (wanted_.hasPictures && pictures_ > 0) add(picturesFolder_);
  return text;
}

Expected<void> writeFilm(const StretchWriter &writer, const fs::path &program, const ProgressFn &progress) {
  const fs::path film = filesOf(writer.wanted()).film, log = writer.picturesFolder() / "film.log";
  fs::path part = film;
  part.replace_extension(".part.mp4");
  const auto failed = [&](const std::string &why) { return fail(ErrorCode::output, pathText(film) + ": " + why); };
  std::error_code error;
  auto process = ChildProcess::start(
      {pathText(program), "-nostdin", "-y", "-loglevel", "error", "-framerate",
       formatNumber(writer.wanted().pictureRate), "-i",
       escaped(pathText(writer.picturesFolder())) + "/picture_%06d.png", "-pix_fmt", "yuv420p", pathText(part)},
      log);
  if (!process) return failed(process.error().message);
  while (process->isRunning()) {
    if (progress && !progress(-1.0, "encoding")) {
      process->kill();
      break;
    }
    (void)process->wait(kFilmPoll_s);
  }
  const bool isCancelled = progress && !progress(-1.0, "encoding");
  const auto code = process->wait(kFilmPoll_s);
  const std::string output = endOf(log);
  fs::remove(log, error);
  if (!isCancelled && code && *code == 0) {
    fs::rename(part, film, error);
    if (!error) return {};
    return failed(error.message());
  }
  fs::remove(part, error);
  if (isCancelled) return fail(ErrorCode::cancelled, pathText(film) + ": cancelled");
  return failed(pathText(program.filename()) + " failed" + (output.empty() ? "" : ": " + output));
}

}  // namespace c3de::app
