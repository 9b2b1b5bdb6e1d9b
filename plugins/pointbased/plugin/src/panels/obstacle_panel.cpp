// SPDX-License-Identifier: Apache-2.0
#include "panels/obstacle_panel.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/file_text.h"
#include "base/number_text.h"
#include "panels/contact_panel.h"

namespace pointbased {
namespace {

const std::array<std::string, 4> kUnitNames{"mm", "cm", "m", "inch"};
constexpr std::array<double, 4> kUnits_mm{1.0, 10.0, 1000.0, 25.4};
const std::array<std::string, 3> kPlaceNames{"at the cross-hair", "on the nearest surface", "as in the file"};
enum Place : std::uint32_t { kAtCrossHair, kOnSurface };
constexpr double kMillimetres = 1e3;
constexpr double kInside = 0.5;      // winding number
constexpr double kClearance = 0.05;  // mm, between the skin and what is placed on it

std::uint32_t unitIndexOf(std::uint32_t unit) { return unit == C3DE_UNIT_M ? 2u : unit == C3DE_UNIT_CM ? 1u : 0u; }

std::string lengthText(double mm) { return fixed(mm, mm < 10.0 ? 2 : mm < 100.0 ? 1 : 0); }

std::string sizeText(const Vec3 &extent_mm) {
  return lengthText(extent_mm[0]) + " × " + lengthText(extent_mm[1]) + " × " + lengthText(extent_mm[2]) + " mm";
}

std::string placeText(const Vec3 &at_mm) {
  return fixed(at_mm[0], 1) + "  " + fixed(at_mm[1], 1) + "  " + fixed(at_mm[2], 1) + " mm";
}

/// A point of the present skin and its outward normal, m.
struct SkinSite {
  Vec3 at, normal;
};

/// The point of a segment that is nearest to another point.
Vec3 nearestOf(const Vec3 &a, const Vec3 &b, const Vec3 &point) {
  const Vec3 along = b - a;
  const double length = along.squaredNorm();
  return length > 0.0 ? Vec3(a + std::clamp((point - a).dot(along) / length, 0.0, 1.0) * along) : a;
}

/// The point of a triangle that is nearest to another point.
Vec3 nearestOf(const std::array<Vec3, 3> &corners, const Vec3 &point) {
  const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0], w = point - corners[0];
  Eigen::Matrix2d gram;
  gram << u.dot(u), u.dot(v), u.dot(v), v.dot(v);
  if (gram.determinant() > 0.0) {
    const Eigen::Vector2d weights = gram.inverse() * Eigen::Vector2d(u.dot(w), v.dot(w));
    if (weights.minCoeff() >= 0.0 && weights.sum() <= 1.0) return corners[0] + weights[0] * u + weights[1] * v;
  }
  Vec3 nearest = corners[0];
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 at = nearestOf(corners[k], corners[(k + 1) % 3], point);
    if ((at - point).squaredNorm() < (nearest - point).squaredNorm()) nearest = at;
  }
  return nearest;
}

/// The point nearest to `point` on triangles that share the nearest surfel; nothing without a body.
std::optional<SkinSite> nearestSkin(const Snapshot &snapshot, const Vec3 &point) {
  const BodySnapshot *body = nullptr;
  std::size_t surfel = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (const BodySnapshot &one : snapshot.bodies)
    for (std::size_t i = 0; i < one.surfels.size(); ++i)
      if (const double distance = (vectorOf(one.surfels[i]) - point).squaredNorm(); distance < nearest) {
        nearest = distance;
        body = &one;
        surfel = i;
      }
  if (!body) return std::nullopt;
  SkinSite site{vectorOf(body->surfels[surfel]), vectorOf(body->normals[surfel])};
  for (const auto &triangle : body->surface->triangles) {
    if (std::find(triangle.begin(), triangle.end(), surfel) == triangle.end()) continue;
    const std::array<Vec3, 3> corners{vectorOf(body->surfels[triangle[0]]), vectorOf(body->surfels[triangle[1]]),
                                      vectorOf(body->surfels[triangle[2]])};
    const Vec3 at = nearestOf(corners, point);
    if ((at - point).squaredNorm() < nearest) {
      nearest = (at - point).squaredNorm();
      site.at = at;
    }
  }
  site.normal.normalize();
  return site;
}

/// z along the normal, x as near to the world's x as it can be.
Mat3 frameOf(const Vec3 &normal) {
  const Vec3 along = std::abs(normal[0]) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  Mat3 frame;
  frame.col(2) = normal;
  frame.col(0) = (along - along.dot(normal) * normal).normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

}  // namespace

void ObstaclePanel::setSimulator(WorldSimulator *simulator) {
  if (simulator_.get() == simulator) return;
  for (const c3de_handle step : std::exchange(steps_, {})) services_.history.remove(step);
  simulator_ = simulator ? sdk::Ref<WorldSimulator>::share(simulator) : sdk::Ref<WorldSimulator>();
  ++serial_;
  candidate_.reset();
  resets_.clear();
}

void ObstaclePanel::draw(sdk::Ui &ui, const Snapshot *snapshot) {
  ui.heading("Obstacles and implants");
  std::erase_if(resets_, [this](const Reset &one) {
    if (!*one.hasMade) return false;
    (void)services_.notifier.notify(C3DE_LOG_WARN, "The simulation has restarted",
                                    "Tissue was inside the position of " + one.name + ". The previous state is lost.");
    return true;
  });
  if (ui.fileButton("obstacle_browse", "Add from a file…", "obj;stl;ply;vtk", path_)) read();
  ui.tooltip("A closed surface that bodies cannot enter: an implant, a plate, a bone. You choose its unit next");
  std::vector<std::string> shapes;
  for (const ImplantShape &shape : implantShapes()) shapes.emplace_back(shape.name);
  (void)ui.choice("obstacle_shape", "Shape", shape_, shapes);
  ui.tooltip("Built-in shapes; you choose their size next");
  if (ui.button("obstacle_new", "New " + shapes[shape_], snapshot && !job_)) takeShape(implantShapes()[shape_]);
  if (job_)
    if (const auto state = services_.jobs.progress(*job_)) {
      ui.progress(state->fraction, state->what);
      if (ui.button("obstacle_cancel_job", "Cancel")) (void)services_.jobs.cancel(*job_);
    }
  if (candidate_) drawCandidate(ui, snapshot);
  drawPlacement(ui, move_, snapshot);
  if (move_.chosen() != 0 && ui.button("obstacle_remove", "Remove") && snapshot) remove(*snapshot);
}

void ObstaclePanel::drawCandidate(sdk::Ui &ui, const Snapshot *snapshot) {
  Candidate &one = *candidate_;
  const Vec3 extent = one.max_mm - one.min_mm;
  ui.value("New obstacle", one.name);
  if (one.shape) {
    bool isChanged = false;
    for (std::size_t i = 0; i < one.sizes_mm.size(); ++i) {
      const ImplantSize &size = one.shape->sizes[i];
      isChanged |= (ui.slider("obstacle_" + std::string(size.id), size.label, "mm", one.sizes_mm[i], size.least_mm,
                              size.most_mm) &
                    C3DE_UI_CHANGED) != 0;
      one.sizes_mm[i] = std::clamp(one.sizes_mm[i], size.least_mm, size.most_mm);
    }
    if (isChanged) makeShape(one);
  } else {
    if (ui.choice("obstacle_unit", "Unit of the file", one.unit, kUnitNames)) one.overlapped.clear();
    ui.tooltip("What a length of 1 in the file means");
  }
  ui.value("Size", sizeText(kUnits_mm[one.unit] / one.read_mm * extent));
  if (snapshot && !snapshot->bodies.empty()) {
    Vec3 low = snapshot->bodies.front().surface->min, high = snapshot->bodies.front().surface->max;
    for (const BodySnapshot &body : snapshot->bodies) {
      low = low.cwiseMin(body.surface->min);
      high = high.cwiseMax(body.surface->max);
    }
    ui.value("The bodies", sizeText(kMillimetres * (high - low)));
    ui.tooltip("To compare the size with");
  }
  // A shape has no file with a position.
  if (ui.choice("obstacle_place", "Place", one.place, std::span(kPlaceNames).first(one.shape ? 2 : 3)))
    one.overlapped.clear();
  ui.tooltip(
      "The cross-hair of the slices; without an image the point that the camera turns about. On a surface, the "
      "underside touches the skin nearest to it");
  const Placement placement = placementOf(one, snapshot);
  const Vec3 middle = PlacementTransform(placement).metres(0.5 * (one.min_mm + one.max_mm));
  const std::string at = placeText(kMillimetres * middle);
  ui.value("Centre", at);
  if (at != one.middle) one.overlapped.clear();
  one.middle = at;
  const bool isConfirmed = !one.overlapped.empty();
  if (isConfirmed) {
    ui.value("Tissue in the way", one.overlapped);
    ui.text("Added there, it restarts the simulation. Elsewhere the state of the simulation is kept.");
  }
  if (ui.button("obstacle_add", isConfirmed ? "Add, and restart" : "Add", snapshot && !job_)) {
    if (!isConfirmed && snapshot->steps > 0) one.overlapped = bodiesIn(one, *snapshot);
    if (isConfirmed || one.overlapped.empty()) add(*snapshot);
  }
  ui.tooltip(isConfirmed ? "Can be undone, with the present state of the simulation"
                         : "Can be undone. The state of the simulation is kept");
  ui.sameLine();
  if (ui.button("obstacle_cancel", "Cancel")) candidate_.reset();
}

void ObstaclePanel::read() {
  if (!simulator_ || path_.empty()) return;
  const auto mesh = std::make_shared<sdk::MeshHandle>();
  submit(
      "Reading " + fileName(path_),
      [this, mesh, path = path_](sdk::Progress progress) -> sdk::Result<void> {
        auto read = services_.meshes.load(path, C3DE_UNIT_UNKNOWN, progress.abi());
        if (!read) return read.failure();
        *mesh = std::move(*read);
        return {};
      },
      [this, mesh, name = fileStem(path_)] { take(name, std::move(*mesh)); });
}

void ObstaclePanel::take(const std::string &name, sdk::MeshHandle mesh) {
  const auto info = services_.meshes.info(mesh.handle());
  if (!info) return fail(info.failure().message);
  Candidate one;
  one.name = name;
  one.mesh = std::make_shared<const sdk::MeshHandle>(std::move(mesh));
  one.min_mm = Vec3(info->min_mm);
  one.max_mm = Vec3(info->max_mm);
  one.unit = unitIndexOf(info->unit);
  one.read_mm = kUnits_mm[one.unit];
  one.contactPlane_mm = one.min_mm[2];
  candidate_ = std::move(one);
}

void ObstaclePanel::takeShape(const ImplantShape &shape) {
  Candidate one;
  one.name = shape.name;
  one.shape = &shape;
  one.place = kOnSurface;
  for (const ImplantSize &size : shape.sizes) one.sizes_mm.push_back(size.value_mm);
  makeShape(one);
  candidate_ = std::move(one);
}

void ObstaclePanel::makeShape(Candidate &candidate) {
  ImplantSurface surface = candidate.shape->surface(candidate.sizes_mm);
  candidate.min_mm = candidate.max_mm = surface.positions_mm.front();
  for (const Vec3 &at : surface.positions_mm) {
    candidate.min_mm = candidate.min_mm.cwiseMin(at);
    candidate.max_mm = candidate.max_mm.cwiseMax(at);
  }
  candidate.contactPlane_mm = surface.contactPlane_mm;
  candidate.mesh = std::make_shared<const sdk::MeshHandle>(
      meshOf(services_, MeshData{std::move(surface.positions_mm), std::move(surface.triangles)}));
  candidate.overlapped.clear();
}

double ObstaclePanel::clearanceShift(const Candidate &candidate, const Snapshot &snapshot,
                                     const PlacementTransform &transform, const Mat3 &rotation) {
  const Vec3 extent = candidate.max_mm - candidate.min_mm;
  const double highest = 0.5 * std::max(extent[0], extent[1]);  // above it is tissue that only hangs over
  double lift = 0.0;
  for (const BodySnapshot &body : snapshot.bodies)
    for (std::size_t i = 0; i < body.surfels.size(); ++i) {
      const Vec3 at = transform.millimetres(vectorOf(body.surfels[i]));
      const bool isCovered = (at.array() > candidate.min_mm.array()).head<2>().all() &&
                             (at.array() < candidate.max_mm.array()).head<2>().all();
      const double height = at[2] - candidate.contactPlane_mm;
      if (!isCovered || height > highest || vectorOf(body.normals[i]).dot(rotation.col(2)) < 0.0) continue;
      lift = std::max(lift,
                      height - (candidate.shape ? candidate.shape->underside(at[0], at[1], candidate.sizes_mm) : 0.0));
    }
  return lift + kClearance * candidate.read_mm / kUnits_mm[candidate.unit];
}

Placement ObstaclePanel::placementOf(const Candidate &candidate, const Snapshot *snapshot) const {
  Placement placement;
  placement.scale = kUnits_mm[candidate.unit] / candidate.read_mm;
  if (candidate.place > kOnSurface) return placement;
  const auto marked = sdk::markedPoint(services_.host);
  const auto matrix = services_.scene.worldFromNode(simulator_->node());
  if (!marked || !matrix) return placement;
  const Eigen::Matrix4d world = Eigen::Map<const Eigen::Matrix4d>(matrix->data());
  const Vec3 at = (world.inverse() * Vec3(marked->data()).homogeneous()).head<3>();
  Vec3 contactPlane_mm = 0.5 * (candidate.min_mm + candidate.max_mm);
  const auto site = candidate.place == kOnSurface && snapshot ? nearestSkin(*snapshot, at) : std::nullopt;
  if (site) {
    placement.rotation = frameOf(site->normal);
    contactPlane_mm[2] = candidate.contactPlane_mm;
  }
  const PlacementTransform turned(placement);
  placement.position = (site ? site->at : at) - turned.metres(contactPlane_mm);
  if (!site || (candidate.shape && !candidate.shape->underside)) return placement;
  const double lift = clearanceShift(candidate, *snapshot, PlacementTransform(placement), placement.rotation);
  placement.position += turned.metres(Vec3(0.0, 0.0, lift));
  return placement;
}

std::string ObstaclePanel::bodiesIn(const Candidate &candidate, const Snapshot &snapshot) const {
  const PlacementTransform transform(placementOf(candidate, &snapshot));
  std::string names;
  for (const BodySnapshot &body : snapshot.bodies) {
    std::vector<Vec3> points;
    for (const Vec3f &surfel : body.surfels) {
      const Vec3 at = transform.millimetres(vectorOf(surfel));
      if ((at.array() > candidate.min_mm.array()).all() && (at.array() < candidate.max_mm.array()).all())
        points.push_back(at);
    }
    std::vector<double> windings(points.size());
    if (points.empty() || !services_.meshes.windingNumbers(candidate.mesh->handle(), viewOf(points), windings))
      continue;
    if (std::any_of(windings.begin(), windings.end(), [](double w) { return std::abs(w) > kInside; }))
      names += (names.empty() ? "" : ", ") + body.name;
  }
  return names;
}

void ObstaclePanel::add(const Snapshot &snapshot) {
  const Placement placement = placementOf(*candidate_, &snapshot);
  std::string name = candidate_->name;
  const auto isTaken = [&](const std::string &wanted) {
    return std::any_of(snapshot.obstacles.begin(), snapshot.obstacles.end(),
                       [&](const ObstacleSnapshot &o) { return o.name == wanted; });
  };
  for (int k = 2; isTaken(name); ++k) name = candidate_->name + " " + std::to_string(k);
  const auto change = std::make_shared<AddObstacle>();
  submit(
      "Adding " + name,
      [this, change, simulator = simulator_, name, mesh = candidate_->mesh,
       placement](sdk::Progress progress) -> sdk::Result<void> {
        const ParameterValues values(obstacleDeclarations());
        *change = {name, dataOf(services_, mesh->handle()), placement, values.number("friction"),
                   values.number("restitution")};
        change->prepare(simulator->parts(), progress);
        return {};
      },
      [this, change, name, restarts = !candidate_->overlapped.empty()] {
        if (!restarts || !services_.history.canCapture()) return insert(name, change, false);
        simulator_->abandonLongStep();
        const auto captured = services_.history.capture([this, change, name, serial = serial_] {
          if (serial == serial_) insert(name, change, true);
        });
        if (!captured) fail(captured.failure().message);
      });
}

void ObstaclePanel::insert(const std::string &name, const std::shared_ptr<AddObstacle> &change, bool isCaptured) {
  const auto obstacle = std::make_shared<ObjectName>();
  const auto posted = post(name, [change, obstacle](Changes &changes) {
    const AddObstacle made = changes.make(std::move(*change));
    *obstacle = made.added;
    return made.hasReset;
  });
  if (!posted) return fail(posted.failure().message);
  if (!isCaptured || !services_.history.addCaptured("add " + name)) keepStep("add ", name, obstacle, true);
  candidate_.reset();
}

void ObstaclePanel::remove(const Snapshot &snapshot) {
  const ObstacleSnapshot *chosen = snapshot.obstacle(move_.chosen());
  move_.choose(0);
  if (!chosen) return;
  const auto obstacle = std::make_shared<ObjectName>();
  const auto posted = post(chosen->name, [id = chosen->id, obstacle, simulator = simulator_](Changes &changes) {
    *obstacle = simulator->parts().queries.nameOfObstacle(id);
    (void)changes.make(RemoveObject{RemoveObject::What::obstacle, *obstacle});
    return false;
  });
  if (posted) keepStep("remove ", chosen->name, obstacle, false);
}

/// @param isIn  whether the obstacle is present after the step
void ObstaclePanel::keepStep(const std::string &what, const std::string &name, const Obstacle &obstacle, bool isIn) {
  if (!services_.history) return;
  const auto in = [this, name, obstacle] {
    return post(name, [obstacle](Changes &changes) { return changes.make(RestoreObstacle{*obstacle}).hasReset; });
  };
  const auto out = [this, name, obstacle] {
    return post(name, [obstacle](Changes &changes) {
      (void)changes.make(RemoveObject{RemoveObject::What::obstacle, *obstacle});
      return false;
    });
  };
  const auto step = isIn ? services_.history.add(what + name, out, in) : services_.history.add(what + name, in, out);
  if (step) steps_.push_back(*step);
}

sdk::Result<void> ObstaclePanel::post(const std::string &name, std::function<bool(Changes &)> change) {
  const Reset reset{name};
  simulator_->abandonLongStep();
  auto posted = services_.simulation.post(
      simulator_->node(), [simulator = simulator_, change = std::move(change), hasMade = reset.hasMade] {
        *hasMade = change(simulator->parts().changes);
      });
  if (posted) resets_.push_back(reset);
  return posted;
}

void ObstaclePanel::submit(const std::string &title, std::function<sdk::Result<void>(sdk::Progress)> work,
                           std::function<void()> whenDone) {
  const auto job =
      services_.jobs.submit(title, std::move(work),
                            [this, whenDone = std::move(whenDone), serial = serial_](const sdk::Result<void> &result) {
                              job_.reset();
                              if (serial != serial_) return;
                              if (result)
                                whenDone();
                              else if (result.failure().status != C3DE_E_CANCELLED)
                                fail(result.failure().message);
                            });
  if (job)
    job_ = *job;
  else
    fail(job.failure().message);
}

void ObstaclePanel::fail(const std::string &text) {
  services_.log.info("an obstacle was not added: " + text);
  (void)services_.notifier.notify(C3DE_LOG_ERROR, "The obstacle was not added", text);
}

}  // namespace pointbased
