// SPDX-License-Identifier: Apache-2.0
#include "simulator/snapshot_writer.h"

#include <algorithm>

#include "report/advice.h"
#include "report/composition.h"
#include "report/report.h"
#include "simulator/obstacle_overlap.h"

namespace pointbased {

SnapshotWriter::SnapshotWriter(const Services &services, Simulator &simulator, const BodyTable &table,
                               EvaluationPoints &points)
    : services_(services), simulator_(simulator), table_(table), points_(points) {
  colouring_.setPressures(
      [this](std::uint64_t body, std::vector<double> &out) { simulator_.diagnostics().contactPressures(body, out); });
}

void SnapshotWriter::publish(const ViewSettings &view, std::vector<GraspSnapshot> grasps,
                             std::vector<ConditionSnapshot> conditions, bool isShowing) {
  const std::shared_ptr<Snapshot> s = exchange_.writable();
  s->generation = ++generation_;
  s->time = simulator_.time();
  s->dt = simulator_.stepper().stepSize();
  s->steps = simulator_.steps();
  s->historyEpoch = simulator_.archive().historyEpoch();
  s->hash = simulator_.stateHash();
  s->failed = simulator_.failed();
  s->quasiStatic = simulator_.quasiStatic();
  s->box = simulator_.world().settings().box;
  s->gravity = simulator_.world().settings().gravity;
  s->stages = simulator_.diagnostics().stageTimes();
  s->compositions = compositionsOf(simulator_);
  s->events = simulator_.diagnostics().events();
  s->view = view;
  s->grasps = std::move(grasps);
  s->conditions = std::move(conditions);
  takeBodies(*s, isShowing);
  takeContact(*s);
  takeView(*s);
  exchange_.publish(s);
}

void SnapshotWriter::takeBodies(Snapshot &s, bool isShowing) {
  s.bodies.resize(table_.bodies().size());
  std::size_t k = 0;
  for (const auto &[id, record] : table_.bodies()) {
    const Body &body = *simulator_.body(id);
    BodySnapshot &b = s.bodies[k++];
    const bool sameBody = b.id == id && b.rest == body.sharedRest();
    if (!sameBody) b.neighbours = countNeighbours(body.rest());
    const std::uint64_t changes = simulator_.stepper().changes(id);
    const bool samePlaces = sameBody && b.changes == changes;
    b.changes = changes;
    b.asleep = simulator_.stepper().asleep(id);
    b.rigid = body.rigid();
    b.isStatic = body.isStatic();
    b.stableStep = body.stableStepAtRest();
    b.isExplicit = simulator_.stepper().integratorOf(id) == Integrator::explicitVerlet;
    b.computed = describeComputation(simulator_, id);
    b.id = id;
    b.name = record.name;
    b.tissues = record.source.tissues;
    if (b.supports != record.source.fixNames) b.supports = record.source.fixNames;
    b.rest = body.sharedRest();
    b.surface = record.surface;
    b.values = record.values;
    b.promise = record.promise;
    b.adaptive = record.adaptive;
    b.addedMass = addedMassText(body);
    b.colour = record.source.colour;
    if (!samePlaces) {
      b.phyxels.resize(body.rest().phyxelCount());
      for (std::size_t i = 0; i < b.phyxels.size(); ++i)
        b.phyxels[i] = body.rest().origin + body.rest().positions[i] + body.state().displacements[i];
      simulator_.world().surfels(id, b.surfels, b.normals);
    }
    estimate(record, !samePlaces && !isShowing, b);
    b.cost = simulator_.diagnostics().costOf(id);
    b.mass = body.totalMass();
    b.held = heldPhyxels(body.rest());
    b.youngsModulus = body.material().youngsModulus;
    b.energy = simulator_.diagnostics().energy(id);
    b.grab = simulator_.stepper().grabStatus(id);
  }
  std::vector<std::string> errors;
  for (const BodySnapshot &b : s.bodies)
    if (b.promise) errors.push_back(noticeOf(b.name, *b.promise));
  s.notices = noticesOf(simulator_, errors);
}

void SnapshotWriter::takeContact(Snapshot &s) const {
  s.contacts.clear();
  for (const ContactSummary &one : simulator_.diagnostics().contacts())
    s.contacts.push_back({one, table_.nameOf(one.first), table_.nameOf(one.second)});
  s.attachments.clear();
  for (const auto &[id, record] : table_.bodies())
    if (const Body &body = *simulator_.body(id); body.foundation().acts())
      s.attachments.push_back(
          {"surroundings", record.name, "surroundings", body.foundationReaction().force.norm(), 0.0});
  for (const AttachmentSummary &now : simulator_.world().attachments())
    s.attachments.push_back(
        {now.name, table_.nameOf(now.first), table_.nameOfAttached(now.second), now.force.norm(), now.tornPart});
  s.obstacles.clear();
  for (const auto &[id, record] : table_.obstacles()) {
    ObstacleSnapshot o{id, record.name, record.mesh, simulator_.world().obstacleMotion(id)};
    o.tool = record.tool;
    o.isInstrument = simulator_.world().isInstrument(id);
    o.hasOwnMotion = record.motion != nullptr;
    for (const ContactSnapshot &contact : s.contacts) o.touch.add(contact, id);
    if (o.touch.points > 0) o.touch.displaced = displacedVolume(simulator_, table_, id);
    s.obstacles.push_back(std::move(o));
  }
}

// Updated at intervals, so that it uses at most a fiftieth of the time.
void SnapshotWriter::estimate(const BodyRecord &record, bool moved, BodySnapshot &out) {
  using Clock = std::chrono::steady_clock;
  Estimated &last = estimated_[out.id];
  const Clock::time_point begin = Clock::now();
  out.hasTrials = record.trials != nullptr;
  if (out.rigid) {
    out.accuracy = {};
    return;
  }
  const std::shared_ptr<const WorldVerification> verified = verificationOfNow();
  const bool isNew = last.trials != record.trials || last.verification != verified;
  if (isNew || (moved && begin >= last.next)) {
    last.trials = record.trials;
    last.verification = verified;
    last.statement = stateAccuracy(
        simulator_, out.id,
        {areaOf(*out.surface), record.source.fixNames, record.trials.get(), verified ? verified->body(out.id) : nullptr,
         [this](std::size_t id) { return table_.nameOf(id); }},
        last.scratch, services_.parallelFor());
    const Clock::time_point end = Clock::now();
    last.next = end + std::max<Clock::duration>(50 * (end - begin), std::chrono::milliseconds(200));
  }
  out.accuracy = last.statement;
}

// Interior points and colours, if they are shown.
void SnapshotWriter::takeView(Snapshot &s) {
  Colouring::Bodies bodies;
  for (const auto &[id, record] : table_.bodies()) bodies.emplace(id, simulator_.body(id));
  s.verification = verification_;
  s.verified = verification_ && isOfNow(*verification_);
  // The verified state is no longer the present one.
  if (s.view.colourBy == ColourBy::verified && !s.verified) s.view.colourBy = ColourBy::material;
  colouring_.setVerification(s.verified ? verification_ : nullptr);
  const ParallelFor parallelFor = services_.parallelFor();
  s.areColoursOutdated = !colouring_.update(bodies, s.view, parallelFor);
  s.colours = colouring_.scale();
  for (BodySnapshot &b : s.bodies) {
    const Body &body = *bodies.at(b.id);
    b.points.clear();
    if (s.view.showsPoints()) {
      if (s.view.points == PointsShown::phyxels) {
        b.points = b.phyxels;
      } else {
        const Interpolation &points = points_.of(b.id, body.sharedRest());
        b.points.resize(points.count());
        interpolateDisplacements(points, body.rest().positions, body.state().displacements, b.points, parallelFor);
        for (std::size_t q = 0; q < b.points.size(); ++q) b.points[q] += body.rest().origin + points.positions[q];
      }
    }
    const Colouring::Colours *colours = colouring_.of(b.id);
    if (!colours) {
      b.surfelColours.clear();
      b.pointColours.clear();
      b.colours = 0;
    } else if (b.colours != colouring_.generation() || b.surfelColours.size() != colours->surfels.size()) {
      b.surfelColours = colours->surfels;
      b.pointColours = colours->points;
      b.colours = colouring_.generation();
    }
  }
}

bool SnapshotWriter::isOfNow(const WorldVerification &verification) const {
  if (verification.bodies.size() != table_.bodies().size()) return false;
  for (const BodyVerification &body : verification.bodies)
    if (!table_.hasBody(body.id) || simulator_.stepper().changes(body.id) != body.changes) return false;
  return true;
}

}  // namespace pointbased
