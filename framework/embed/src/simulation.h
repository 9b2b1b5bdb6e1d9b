// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "c3de/abi/iface/conditions.h"
#include "c3de/core/vec.h"
#include "c3de/embed.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/live_parameters.h"
#include "c3de/session/report.h"
#include "c3de/session/run_beginning.h"
#include "c3de/session/simulator_access.h"
#include "owner_thread.h"
#include "result.h"

namespace c3de::session {
class Recorder;
}

namespace c3de::embed {

class WarpedImage;

/// One simulation of c3de/embed.h: a session with its simulator. Calls are serialised, except cancel(). Threads: any;
/// a call from within a callback of the same simulation may only read.
class EmbeddedSimulation {
 public:
  struct Request {
    session::RunOptions options;
    ProgressFn progress;
  };
  [[nodiscard]] static Result<std::shared_ptr<EmbeddedSimulation>> open(Request request);
  ~EmbeddedSimulation();

  struct Run {
    std::uint64_t maxSteps = 0;
    double until_s = 0.0;
    std::function<bool(const c3de_embed_status &, double)> stepped;  ///< false: cancel
    double every_s = 0.0;
    bool failsWithStoppedBodies = false;  ///< at the end, although all steps were made
  };
  /// @param made  steps of this call
  [[nodiscard]] Result<void> run(const Run &run, std::uint64_t &made);
  void cancel();
  [[nodiscard]] Result<void> close();
  [[nodiscard]] Result<void> reset();
  [[nodiscard]] Result<c3de_embed_status> status();
  [[nodiscard]] Result<std::uint64_t> stateHash();

  [[nodiscard]] Result<std::uint64_t> parameterCount();
  [[nodiscard]] Result<c3de_embed_parameter> parameterAt(std::uint64_t index);
  [[nodiscard]] Result<c3de_embed_value> get(const std::string &path);
  [[nodiscard]] Result<void> set(const std::string &path, const std::string &text);

  [[nodiscard]] Result<c3de_embed_body> bodyAt(std::uint64_t index);
  [[nodiscard]] Result<std::uint64_t> findBody(std::string_view name);
  [[nodiscard]] Result<c3de_embed_field> fieldAt(std::uint64_t body, std::uint32_t on, std::uint64_t index);
  [[nodiscard]] Result<c3de_embed_array> viewField(std::uint64_t body, std::uint32_t on, std::string_view name);
  [[nodiscard]] Result<void> readField(std::uint64_t body, std::uint32_t on, std::string_view name, double *data,
                                       std::uint64_t bytes);
  [[nodiscard]] Result<c3de_embed_array> viewTriangles(std::uint64_t body);

  [[nodiscard]] Result<const char *> events();
  [[nodiscard]] Result<const char *> report();
  [[nodiscard]] Result<void> saveState(const std::filesystem::path &file);
  [[nodiscard]] Result<void> loadState(const std::filesystem::path &file);
  [[nodiscard]] Result<void> saveSession(const std::filesystem::path &file);

  [[nodiscard]] Result<std::uint64_t> hold(std::uint64_t body, const c3de_embed_hold &hold);
  [[nodiscard]] Result<void> pull(std::uint64_t hold, const double *target_m);
  [[nodiscard]] Result<c3de_embed_hold_state> holdState(std::uint64_t hold);
  [[nodiscard]] Result<void> release(std::uint64_t hold);

  /// @param number  0: a new one @return its number
  [[nodiscard]] Result<std::uint64_t> setCondition(std::uint64_t body, const c3de_embed_condition &condition,
                                                   std::uint64_t number);
  [[nodiscard]] Result<c3de_embed_condition_state> conditionState(std::uint64_t number);
  [[nodiscard]] Result<void> removeCondition(std::uint64_t number);

  /// @param what  C3DE_EMBED_IMAGE, C3DE_EMBED_LABELS
  [[nodiscard]] Result<std::shared_ptr<const WarpedImage>> warp(std::uint32_t what, const ProgressFn &progress);

  /// @return  `match` of a report
  [[nodiscard]] Result<const char *> match(std::uint64_t body, const c3de_embed_match_options &options,
                                           const ProgressFn &progress);
  /// @return  `fit` of a report
  [[nodiscard]] Result<const char *> fit(std::uint64_t body, const c3de_embed_fit_options &options,
                                         const ProgressFn &progress);
  [[nodiscard]] Result<const char *> sensitivity(std::uint64_t body, const double *objective, std::uint64_t points,
                                                 double *forces);

  /// @param hashEvery  0: chosen automatically
  [[nodiscard]] Result<void> record(const std::filesystem::path &file, std::uint64_t hashEvery);
  [[nodiscard]] Result<void> endRecording();
  [[nodiscard]] Result<void> replay(const Run &run);
  [[nodiscard]] Result<c3de_embed_replay_state> replayState();

 private:
  class Use;
  class Running;
  struct FieldMemory {
    std::uint64_t generation = 0;  ///< 0: not read
    std::vector<double> values;
    std::uint32_t comps = 0;
    const char *unit = "";
  };
  template <class Text>
  struct FieldKey {
    std::uint64_t body;
    std::uint32_t on;
    Text name;
  };
  /// Also of keys that only refer to a name.
  struct FieldOrder {
    using is_transparent = void;
    template <class A, class B>
    bool operator()(const A &a, const B &b) const {
      using Parts = std::tuple<std::uint64_t, std::uint32_t, std::string_view>;
      return Parts(a.body, a.on, a.name) < Parts(b.body, b.on, b.name);
    }
  };
  struct Described {
    std::string name, unit;
    std::uint32_t comps = 0;
  };
  struct BodyEntry {
    c3de_handle handle{};
    c3de_embed_body info{};
    std::vector<Described> fields[2];  ///< of points, of the surface
  };

  EmbeddedSimulation() = default;
  [[nodiscard]] Result<void> build(const Request &request);  // on the owner's thread
  [[nodiscard]] Result<void> begin(const Request &request, const session::RunBeginning &beginning,
                                   const session::SimulatorIdentity &chosen);
  /// @param repeats  the events of the recording are applied between the steps
  [[nodiscard]] Result<void> makeSteps(const Run &run, std::uint64_t &made, bool repeats);
  [[nodiscard]] Result<void> makeOneStep(const char *owner);
  void discardSolverMemory();
  [[nodiscard]] Result<void> repeatDue();
  [[nodiscard]] Result<void> finishRecording();
  [[nodiscard]] Failure cancelled() const;
  [[nodiscard]] bool isDone(const Run &run, std::uint64_t made, bool repeats) const;
  [[nodiscard]] double fraction(const Run &run, std::uint64_t made) const;
  [[nodiscard]] Result<void> readStatus();
  void stateChanged();
  [[nodiscard]] Failure reason(const std::string &what, c3de_status code);
  [[nodiscard]] Result<void> readBodies();
  [[nodiscard]] Result<const BodyEntry *> entryOf(std::uint64_t body);
  [[nodiscard]] Result<const Described *> describe(const BodyEntry &body, std::uint32_t on, std::string_view name);
  [[nodiscard]] Result<void> fill(const BodyEntry &body, std::uint32_t on, const Described &field, double *data,
                                  std::uint64_t rows);
  [[nodiscard]] Result<c3de_embed_array> trianglesOf(const BodyEntry &body);
  /// The skin at rest, mm.
  [[nodiscard]] Result<geometry::TriangleMesh> restSkinOf(const BodyEntry &body);
  [[nodiscard]] Result<const c3de_conditions_v0 *> conditions();
  [[nodiscard]] Result<std::string> simulatorReport();
  /// Strings returned to callers, kept until closing.
  [[nodiscard]] const char *intern(std::string_view text) { return interned_.emplace(text).first->c_str(); }

  std::recursive_mutex mutex_;
  bool isInCall_ = false;
  std::atomic<bool> isClosing_{false};  ///< calls that begin from now on are refused
  std::mutex cancelMutex_;
  bool isRunning_ = false;
  std::atomic<bool> isCancelled_{false};

  OwnerThread owner_;
  std::unique_ptr<session::Session> session_;
  std::optional<session::ObjectRef> simulator_;
  const c3de_simulator_v1 *table_ = nullptr;
  std::optional<session::LiveParameters> parameters_;
  session::SimulatorIdentity identity_;
  session::RunFacts facts_;
  c3de_sim_status status_{};
  session::SharedScene scene_;               ///< the first of the source
  session::BodySources sources_;             ///< of a scene with an image: images that were read
  std::unique_ptr<session::Replay> replay_;  ///< null: not opened from a recording
  std::shared_ptr<session::Recorder> recorder_;
  std::filesystem::path recordingFile_;
  std::optional<Failure> recordingFailure_;  ///< has ended the recording; for the caller who ends it
  std::uint64_t generation_ = 1;

  std::vector<session::LiveParameters::Parameter> listed_;  ///< of parameterAt(); empty: not asked for
  std::vector<BodyEntry> bodies_;
  std::uint64_t bodiesGeneration_ = 0;
  std::map<FieldKey<std::string>, FieldMemory, FieldOrder> fields_;
  std::set<std::string, std::less<>> interned_;
  /// Callers have them until the state changes: made once for each.
  std::optional<std::string> events_, report_;
  std::string inverse_;  ///< of the last match, fit or sensitivity
  struct LastMatch {
    std::uint64_t body = 0;
    bool isRigidFirst = true;
    Mat4 measuredFromBody = kIdentity4;
  };
  std::optional<LastMatch> lastMatch_;  ///< none: there is none, or it cannot be continued
};

}  // namespace c3de::embed
