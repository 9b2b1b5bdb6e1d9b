// SPDX-License-Identifier: Apache-2.0
#include "commands/info_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/core/text.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/imaging/reading.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/build_scene.h"
#include "c3de/session/progress_line.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/tissues.h"

namespace c3de::app {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no representation of infinity.
Json jsonNumber(double x) { return std::isfinite(x) ? Json(x) : Json(formatNumber(x)); }

void describeValues(const std::vector<scene::SceneValue> &values, std::ostringstream &text, Json &json) {
  for (const scene::SceneValue &value : values) {
    text << "  " << value.value.id << " = " << value.value.display() << "\n";
    switch (value.value.type) {
      case C3DE_PARAM_BOOL: json[value.value.id] = value.value.num != 0.0; break;
      case C3DE_PARAM_I64:
      case C3DE_PARAM_F64: json[value.value.id] = jsonNumber(value.value.num); break;
      case C3DE_PARAM_VEC3: json[value.value.id] = value.value.vec; break;
      default: json[value.value.id] = value.value.text;
    }
  }
}

Json jsonOf(const scene::SceneRegion &region) {
  switch (region.kind) {
    case scene::SceneRegion::Kind::box: return {{"box", {{"min", region.a}, {"max", region.b}}}};
    case scene::SceneRegion::Kind::sphere: return {{"sphere", {{"centre", region.a}, {"radius", region.radius}}}};
    case scene::SceneRegion::Kind::halfSpace: return {{"half_space", {{"point", region.a}, {"normal", region.b}}}};
    case scene::SceneRegion::Kind::everywhere: break;
    case scene::SceneRegion::Kind::voxels: return {{"voxels", true}};
  }
  return {{"everywhere", true}};
}

Json jsonOf(const scene::SceneMotion &motion) {
  Json json{{"displacement", motion.displacement_m}, {"rotation_deg", motion.rotation_deg}, {"ramp", motion.ramp_s}};
  if (motion.centre_m) json["centre"] = *motion.centre_m;
  return json;
}

/// Materials of tissues and regions, and finer sampling of a body.
void describeRegions(const scene::SceneBody &body, std::ostringstream &text, Json &json) {
  auto tissue = body.volume.tissues.begin();
  for (const scene::ScenePart &part : body.parts) {
    Json region = jsonOf(part.region);
    if (part.region.kind == scene::SceneRegion::Kind::voxels) {
      while (tissue->isRigid || tissue->isEmpty) ++tissue;
      region = {{"label", tissue++->label}};
    }
    text << "  part " << json["parts"].size() << " in " << region.dump() << "\n";
    Json params = Json::object();
    describeValues(part.params, text, params);
    json["parts"].push_back(Json{{"region", std::move(region)}, {"params", std::move(params)}});
  }
  for (const scene::SceneTissue &one : body.volume.tissues)
    if (one.isRigid) {
      text << "  rigid: label " << one.label << "\n";
      json["rigid_labels"].push_back(one.label);
    }
  for (const scene::SceneRefinement &refinement : body.refinements) {
    text << "  spacing " << formatNumber(refinement.spacing_m) << " m in " << jsonOf(refinement.region).dump() << "\n";
    json["refinements"].push_back(Json{{"region", jsonOf(refinement.region)}, {"spacing_m", refinement.spacing_m}});
  }
}

/// Supports and loads of the bodies.
void describeSupports(const scene::SceneFile &scene, std::ostringstream &text, Json &json) {
  const auto title = [&](const char *what, std::size_t number, const std::string &name, const std::string &body) {
    text << what << " " << number << (name.empty() ? "" : " \"" + name + "\"") << " of body \"" << body << "\"\n";
  };
  json["fixes"] = Json::array();
  for (const scene::SceneFix &fix : scene.fixes) {
    title("fix", json["fixes"].size(), fix.name, fix.body);
    Json one{{"name", fix.name}, {"body", fix.body}, {"region", jsonOf(fix.region)}, {"motion", jsonOf(fix.motion)}};
    text << "  region " << one["region"].dump() << "\n";
    if (fix.motion.displacement_m != Vec3{} || fix.motion.rotation_deg != Vec3{})
      text << "  motion " << one["motion"].dump() << "\n";
    json["fixes"].push_back(std::move(one));
  }
  json["loads"] = Json::array();
  for (const scene::SceneLoad &load : scene.loads) {
    title("load", json["loads"].size(), load.name, load.body);
    Json one{{"name", load.name}, {"body", load.body}, {"region", jsonOf(load.region)}};
    if (load.force_N) one["force_N"] = *load.force_N;
    if (load.pressure_Pa) {
      one["pressure_Pa"] = *load.pressure_Pa;
      one["follower"] = load.follower;
    }
    one["ramp"] = load.ramp_s;
    text << "  region " << one["region"].dump() << "\n";
    if (load.force_N) text << "  force " << one["force_N"].dump() << " N\n";
    if (load.pressure_Pa) text << "  pressure " << one["pressure_Pa"].dump() << " Pa\n";
    json["loads"].push_back(std::move(one));
  }
}

/// Describes the mesh of a body or obstacle; the error names the line of the scene.
Expected<Json> describePart(const geometry::MeshFormats &formats, const scene::SceneFile &scene, int line,
                            const std::filesystem::path &mesh, std::optional<geometry::LengthUnit> stated,
                            bool mustBeFillable, std::ostringstream &text) {
  const auto unit = formats.unitOf(mesh, stated);
  if (!unit) return failInScene(unit.error(), scene, line);
  const auto loaded = formats.load(mesh, *unit);
  if (!loaded) return failInScene(loaded.error(), scene, line);
  const geometry::MeshReport &report = loaded->report;
  if (mustBeFillable)
    if (const auto fillable = geometry::checkFillable(loaded->mesh, report); !fillable)
      return failInScene(fillable.error(), scene, line);
  text << "  mesh " << mesh.string() << " (" << geometry::unitName(*unit) << "): " << report.vertices << " vertices, "
       << report.triangles << " triangles, " << (report.closed ? "closed" : "open") << "\n";
  for (const std::string &repair : report.repairs) text << "  repaired: " << repair << "\n";
  for (const std::string &warning : report.warnings) text << "  warning: " << warning << "\n";
  Json json = Json::parse(report.json(), nullptr, false);
  if (!json.is_object()) json = Json::object();
  json["file"] = mesh.string();
  return json;
}

/// A number among the values of a part or body; nothing if it is not specified.
std::optional<double> numberOf(const std::vector<scene::SceneValue> &values, const std::string &id) {
  for (const scene::SceneValue &value : values)
    if (value.value.id == id) return value.value.num;
  return std::nullopt;
}

std::string kiloPascal(double pascal) { return fmt::format("{:.6g}", 1e-3 * pascal); }

/// For each label of a body: its tissue, stiffness, the source of that, and its volume.
void describeTissues(const scene::SceneBody &body, const scene::MaterialLibrary &materials, const TissueVoxels &places,
                     std::ostringstream &text, Json &json) {
  std::size_t part = 0;
  json = Json::array();
  for (std::size_t t = 0; t <= places.tissues.size(); ++t) {
    const bool isBackground = t == places.tissues.size();
    if (isBackground && !body.volume.background) break;
    const scene::SceneTissue tissue = places.tissueAt(t);
    const bool isPart = !isBackground && !tissue.isRigid && !tissue.isEmpty;
    Json one{{"label", tissue.label}, {"labels", Json::array()}};
    std::size_t voxels = 0;
    std::string labels;
    for (const LabelVoxels &label : places.labels) {
      if (label.tissue != t) continue;
      voxels += label.voxels;
      if (label.value == 0) continue;
      one["labels"].push_back(Json{{"value", label.value}, {"name", label.name}, {"voxels", label.voxels}});
      labels += (labels.empty() ? "" : ", ") + label.name;
    }
    if (tissue.isEmpty)
      for (const scene::SceneLabel &label : tissue.labels) {
        one["labels"].push_back(Json{{"value", label.value}, {"name", label.name}, {"voxels", 0}});
        labels += (labels.empty() ? "" : ", ") + label.name;
      }
    const double millilitres = 1e-3 * places.voxel_mm3 * static_cast<double>(voxels);
    text << "  tissue " << tissue.label << ": ";
    one["rigid"] = tissue.isRigid;
    one["empty"] = tissue.isEmpty;
    if (isPart) one["part"] = part;
    if (tissue.isRigid) text << "rigid";
    if (tissue.isEmpty) text << "empty";
    if (isPart || isBackground) {
      const std::vector<scene::SceneValue> &values = isPart ? body.parts[part++].params : body.params;
      const auto stiffness = numberOf(values, C3DE_PARAM_ID_YOUNGS_MODULUS);
      const auto low = numberOf(values, C3DE_PARAM_ID_YOUNGS_MODULUS_LOW);
      const auto high = numberOf(values, C3DE_PARAM_ID_YOUNGS_MODULUS_HIGH);
      text << (stiffness ? kiloPascal(*stiffness) + " kPa" : std::string("stiffness of the simulator"));
      if (stiffness) one["youngs_modulus"] = *stiffness;
      if (low && high) {
        text << " (" << kiloPascal(*low) << " … " << kiloPascal(*high) << ")";
        one["youngs_modulus_range"] = {*low, *high};
      }
    }
    if (const scene::MaterialPreset *preset = materials.find(tissue.preset)) {
      text << ", " << preset->name << " (" << preset->source << ")";
      one["material"] = preset->name;
      one["source"] = preset->source;
    }
    if (!tissue.remark.empty()) {
      text << "; " << tissue.remark;
      one["remark"] = tissue.remark;
    }
    text << "\n    " << voxels << " voxels, " << millilitres << " ml" << (labels.empty() ? "" : " of ") << labels
         << "\n";
    one["voxels"] = voxels;
    one["volume_ml"] = millilitres;
    json.push_back(std::move(one));
  }
}

Expected<Json> describeMask(const scene::SceneFile &scene, const scene::SceneBody &body,
                            const scene::MaterialLibrary &materials, BodySources &sources, std::ostringstream &text) {
  Preparation took;
  const auto picked = sources.pick(body.volume, {}, took);
  if (!picked) return failInScene(picked.error(), scene, body.line);
  sources.reportNotices(body.volume.file);
  const std::size_t voxels = imaging::voxelCount(picked->mask);
  const double millilitres = imaging::volumeOf(picked->mask) / 1000.0;
  text << "  volume " << body.volume.file.string() << ": " << voxels << " voxels, " << millilitres << " ml\n";
  Json json{{"file", body.volume.file.string()}, {"voxels", voxels}, {"volume_ml", millilitres}};
  if (body.volume.region) {
    json["region"] = jsonOf(*body.volume.region);
    text << "  within " << json["region"].dump() << "\n";
  }
  if (!picked->tissues) return json;
  const auto places = sources.placesOf(body, *picked);
  if (!places) return failInScene(places.error(), scene, body.line);
  describeTissues(body, materials, *places, text, json["tissues"]);
  return json;
}

/// Properties of the built body as reported by the simulator; nothing if it reports none.
void describeBuilt(c3de_object *simulator, std::size_t index, std::ostringstream &text, Json &json) {
  const auto table = simulatorTable(simulator);
  c3de_handle body{};
  c3de_sim_body_info info{};
  info.size = sizeof info;
  if (!table || (*table)->body_at(simulator, index, &body) < 0 || (*table)->body_info(simulator, body, &info) < 0)
    return;
  json["points"] = info.points;
  json["spacing_m"] = info.spacing_m;
  json["mass_kg"] = info.mass_kg;
  text << "  " << info.points << " points, spacing " << info.spacing_m << " m, " << info.mass_kg << " kg\n";
}

/// Stages of a step and the reasons for them; nothing if the simulator reports none.
void describeComposition(c3de_object *simulator, std::ostringstream &text, Json &json) {
  const auto table = simulatorTable(simulator);
  std::string report;
  if (!table || (*table)->report(simulator, scene::sinkInto(report)) < 0) return;
  const Json said = Json::parse(report, nullptr, false);
  if (!said.is_object() || !said.contains("composition") || !said["composition"].is_array()) return;
  json["composition"] = said["composition"];
  for (const Json &body : said["composition"]) {
    if (!body.is_object()) continue;
    text << "step of \"" << body.value("body", "") << "\"\n";
    for (const Json &stage : body.value("stages", Json::array()))
      if (stage.is_object())
        text << (stage.value("runs", false) ? "  + " : "  - ") << stage.value("name", "") << ": "
             << stage.value("why", "") << "\n";
  }
}

/// The checks of `run`, as far as possible. Their extent is reported as text and as "checked_by_simulator", "built".
/// @returns  the simulator with its bodies, empty if they were not built
Expected<ObjectRef> checkAsRun(Session &session, const scene::SceneFile &scene, bool isQuick, BodySources &sources,
                               std::string &howFar, Json &json) {
  auto created = session.createSimulator(scene.simulatorClass);
  ObjectRef simulator(created ? *created : nullptr);
  json["checked_by_simulator"] = created.has_value();
  json["built"] = created && !isQuick;
  if (created && !isQuick) {
    ProgressLine progress(false);
    const auto built =
        buildScene(session, simulator.get(), scene, sources, [&](double fraction, const std::string &what) {
          progress.update(fraction, what);
          return true;
        });
    progress.finish();
    if (!built) return tl::unexpected(built.error());
    howFar = "checked as for a run: every key is known to the simulator, and its bodies were built\n";
    return simulator;
  }
  if (auto read = readSceneImage(scene, sources, {}); !read) return tl::unexpected(read.error());
  const std::string unbuilt = "sampling, and whether fixes, loads and probes meet their bodies, ";
  if (!created) {
    howFar = "not checked: keys and values of materials, sampling, solver and world; " + unbuilt + "because " +
             created.error().message + "\n";
    return ObjectRef();
  }
  if (auto good = session.checkValues(simulator.get(), scene); !good) return tl::unexpected(good.error());
  howFar =
      "every key is known to the simulator; not checked: " + unbuilt + "because bodies are not built with --quick\n";
  return ObjectRef();
}

/// Describes the image of the simulation, and whether its labels can be read.
Expected<Json> describeSceneImage(const scene::SceneFile &scene, std::ostringstream &text) {
  const scene::SceneImage &image = *scene.image;
  const auto named = [&](const Error &error) { return failInScene(error, scene, image.line); };
  imaging::ReadOptions options;
  options.time = image.time;
  options.series = image.series;
  const auto described = describeVolume(image.file, options);
  if (!described) return named(described.error());
  text << "image " << image.file.string() << "\n";
  std::istringstream lines(described->text);
  for (std::string line; std::getline(lines, line);) text << "  " << line << "\n";
  Json json = described->json;
  json["labels"] = Json::array();
  for (const std::filesystem::path &labels : image.labels) {
    if (const auto loaded = imaging::readLabelMap(labels); !loaded) return named(loaded.error());
    text << "  labels " << labels.string() << "\n";
    json["labels"].push_back(labels.string());
  }
  return json;
}

/// @param simulator  with the bodies; null: they were not built
Expected<void> describeBodies(Session &session, const scene::SceneFile &scene, c3de_object *simulator,
                              BodySources &sources, std::ostringstream &text, Json &json) {
  json["bodies"] = Json::array();
  for (const scene::SceneBody &body : scene.bodies) {
    text << "body \"" << body.name << "\"\n";
    const auto source =
        body.mesh.empty() ? describeMask(scene, body, session.materials(), sources, text)
                          : describePart(session.meshFormats(), scene, body.line, body.mesh, body.meshUnit, true, text);
    if (!source) return tl::unexpected(source.error());
    Json one{{"name", body.name}, {body.mesh.empty() ? "volume" : "mesh", *source}, {"params", Json::object()}};
    if (simulator != nullptr) describeBuilt(simulator, json["bodies"].size(), text, one);
    describeValues(body.params, text, one["params"]);
    describeRegions(body, text, one);
    if (body.velocity_m_s != Vec3{}) one["velocity"] = body.velocity_m_s;
    if (body.angularVelocity_rad_s != Vec3{}) one["angular_velocity"] = body.angularVelocity_rad_s;
    json["bodies"].push_back(std::move(one));
  }
  return {};
}

Expected<void> describeObstacles(const geometry::MeshFormats &formats, const scene::SceneFile &scene,
                                 std::ostringstream &text, Json &json) {
  json["obstacles"] = Json::array();
  for (const scene::SceneObstacle &obstacle : scene.obstacles) {
    text << "obstacle \"" << obstacle.name << "\"\n";
    const auto mesh = describePart(formats, scene, obstacle.line, obstacle.mesh, obstacle.meshUnit, false, text);
    if (!mesh) return tl::unexpected(mesh.error());
    Json one{{"name", obstacle.name}, {"mesh", *mesh}, {"params", Json::object()}};
    describeValues(obstacle.params, text, one["params"]);
    if (obstacle.motion) {
      one["motion"] = jsonOf(*obstacle.motion);
      text << "  motion " << one["motion"].dump() << "\n";
    }
    json["obstacles"].push_back(std::move(one));
  }
  return {};
}

/// A value of the world as specified in the scene, otherwise as declared by the simulator; nothing if it is not
/// declared.
std::optional<double> worldValue(const scene::SceneFile &scene, const std::vector<ParameterDecl> &declared,
                                 const std::string &id) {
  for (const scene::SceneValue &value : scene.world)
    if (value.value.id == id) return value.value.num;
  for (const ParameterDecl &decl : declared)
    if (decl.id == id) return decl.fallback;
  return std::nullopt;
}

/// Contacts that are switched on or off, and their friction.
/// @param simulator  null: its defaults are unknown
void describeContact(const scene::SceneFile &scene, c3de_object *simulator, std::ostringstream &text, Json &json) {
  const auto declared = simulator != nullptr ? simulatorDeclarations(simulator, C3DE_SIM_SCOPE_WORLD)
                                             : Expected<std::vector<ParameterDecl>>(std::vector<ParameterDecl>());
  if (!declared) return;
  const auto enabled = worldValue(scene, *declared, C3DE_PARAM_ID_CONTACT_ENABLED);
  const auto self = worldValue(scene, *declared, C3DE_PARAM_ID_CONTACT_SELF);
  const auto friction = worldValue(scene, *declared, C3DE_PARAM_ID_CONTACT_FRICTION);
  if (!enabled && !self && !friction && scene.contactPairs.empty()) return;
  const auto state = [](bool isOn, const std::optional<double> &mu) {
    return !isOn ? std::string("off") : mu ? "on, friction " + formatNumber(*mu) : std::string("on");
  };
  Json &contact = json["contact"];
  contact = Json::object();
  if (enabled) contact["enabled"] = *enabled != 0.0;
  if (self) contact["self"] = *self != 0.0;
  if (friction) contact["friction"] = *friction;
  if (enabled && scene.bodies.size() > 1)
    text << "contact between bodies: " << state(*enabled != 0.0, friction)
         << (scene.contactPairs.empty() ? "" : ", where no pair says otherwise") << "\n";
  if (self) text << "contact of bodies with themselves: " << state(*self != 0.0, friction) << "\n";
  contact["pairs"] = Json::array();
  for (const scene::SceneContactPair &pair : scene.contactPairs) {
    const auto isBody = [&](const std::string &name) {
      return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                         [&](const scene::SceneBody &body) { return body.name == name; });
    };
    const bool areBodies = isBody(pair.names[0]) && isBody(pair.names[1]);
    const bool isOn = pair.enabled && (!areBodies || !enabled || *enabled != 0.0);
    const std::optional<double> mu = pair.friction.has_value() || !areBodies ? pair.friction : friction;
    text << "contact of \"" << pair.names[0] << "\" and \"" << pair.names[1] << "\": " << state(isOn, mu) << "\n";
    Json one{{"bodies", pair.names}, {"enabled", isOn}};
    one["friction"] = mu ? Json(mu.value()) : Json();
    contact["pairs"].push_back(std::move(one));
  }
}

void describeMeasurements(const scene::SceneFile &scene, std::ostringstream &text, Json &json) {
  const auto mm = [](const Vec3 &at_m) { return 1e3 * at_m; };
  const auto display = [&](const Vec3 &at_m) {
    const Vec3 at = mm(at_m);
    return formatNumber(at[0]) + ", " + formatNumber(at[1]) + ", " + formatNumber(at[2]) + " mm";
  };
  json["landmarks"] = Json::array();
  for (const scene::SceneLandmark &landmark : scene.landmarks) {
    text << "landmark \"" << landmark.name << "\"";
    if (!landmark.body.empty()) text << " of body \"" << landmark.body << "\"";
    text << " at " << display(landmark.at_m);
    if (landmark.target_m) text << ", target " << display(*landmark.target_m);
    text << "\n";
    Json one{{"name", landmark.name}, {"at_mm", mm(landmark.at_m)}};
    if (!landmark.body.empty()) one["body"] = landmark.body;
    if (landmark.target_m) one["target_mm"] = mm(*landmark.target_m);
    json["landmarks"].push_back(std::move(one));
  }
  json["distances"] = Json::array();
  for (const scene::SceneDistance &distance : scene.distances) {
    text << "distance \"" << distance.name << "\" between \"" << distance.between[0] << "\" and \""
         << distance.between[1] << "\"\n";
    json["distances"].push_back(Json{{"name", distance.name}, {"between", distance.between}});
  }
  json["angles"] = Json::array();
  for (const scene::SceneAngle &angle : scene.angles) {
    text << "angle \"" << angle.name << "\" of \"" << angle.at[0] << "\", \"" << angle.at[1] << "\" (vertex) and \""
         << angle.at[2] << "\"\n";
    json["angles"].push_back(Json{{"name", angle.name}, {"at", angle.at}});
  }
}

void describeAttachments(const scene::SceneFile &scene, std::ostringstream &text, Json &json) {
  if (scene.attachments.empty()) return;
  json["attachments"] = Json::array();
  for (const scene::SceneAttachment &attachment : scene.attachments) {
    text << "attachment \"" << attachment.name << "\": \"" << attachment.names[0] << "\" to \"" << attachment.names[1]
         << "\", " << formatNumber(attachment.stiffness_Pa_m) << " Pa/m";
    if (attachment.tangential_Pa_m() != attachment.stiffness_Pa_m)
      text << " (" << formatNumber(attachment.tangential_Pa_m()) << " across)";
    if (attachment.within_m) text << ", within " << formatNumber(1e3 * *attachment.within_m) << " mm";
    if (attachment.region) text << ", in a region";
    if (attachment.tearsAt_Pa > 0.0) text << ", tears at " << formatNumber(attachment.tearsAt_Pa) << " Pa";
    text << "\n";
    Json one{{"name", attachment.name},
             {"bodies", attachment.names},
             {"stiffness", attachment.stiffness_Pa_m},
             {"tangential", attachment.tangential_Pa_m()},
             {"tears_at", attachment.tearsAt_Pa}};
    if (attachment.within_m) one["within_mm"] = 1e3 * *attachment.within_m;
    json["attachments"].push_back(std::move(one));
  }
}

void describeProbeTools(const scene::SceneFile &scene, std::ostringstream &text, Json &json) {
  if (scene.probeTools.empty()) return;
  json["probe_tools"] = Json::array();
  for (const scene::SceneProbeTool &tool : scene.probeTools) {
    text << "probe tool \"" << tool.name << "\": radius " << formatNumber(1e3 * tool.radius_m) << " mm";
    if (tool.length_m > 0.0) text << ", length " << formatNumber(1e3 * tool.length_m) << " mm";
    text << ", " << tool.path.size() << " places from " << formatNumber(tool.path.front().time_s) << " to "
         << formatNumber(tool.path.back().time_s) << " s\n";
    Json path = Json::array();
    for (const scene::SceneToolWaypoint &place : tool.path) {
      Json one{{"time", place.time_s}, {"at", place.at_m}};
      if (place.axis) one["axis"] = *place.axis;
      path.push_back(std::move(one));
    }
    json["probe_tools"].push_back(Json{{"name", tool.name},
                                       {"radius_mm", 1e3 * tool.radius_m},
                                       {"length_mm", 1e3 * tool.length_m},
                                       {"friction", tool.friction},
                                       {"path", std::move(path)}});
  }
}

void describeGrasps(const scene::SceneFile &scene, std::ostringstream &text, Json &json) {
  if (scene.grasps.empty()) return;
  json["grasps"] = Json::array();
  for (const scene::SceneGrasp &grasp : scene.grasps) {
    text << "grasp \"" << grasp.name << "\" of \"" << grasp.body << "\": jaws of " << formatNumber(1e3 * grasp.jaw_m)
         << " mm, from " << formatNumber(1e3 * grasp.opening_m()) << " to " << formatNumber(1e3 * grasp.closed_m())
         << " mm";
    if (grasp.forceLimit_N > 0.0) text << " or " << formatNumber(grasp.forceLimit_N) << " N";
    text << ", " << grasp.path.size() << (grasp.path.size() == 1 ? " place\n" : " places\n");
    Json path = Json::array();
    for (const scene::SceneGraspWaypoint &place : grasp.path)
      path.push_back(Json{{"time", place.time_s}, {"at", place.at_m}, {"turn_deg", place.turn_deg}});
    json["grasps"].push_back(Json{{"name", grasp.name},
                                  {"body", grasp.body},
                                  {"at", grasp.at_m},
                                  {"axis", grasp.axis},
                                  {"jaw_mm", 1e3 * grasp.jaw_m},
                                  {"opening_mm", 1e3 * grasp.opening_m()},
                                  {"closed_mm", 1e3 * grasp.closed_m()},
                                  {"force_limit", grasp.forceLimit_N},
                                  {"path", std::move(path)}});
  }
}

}  // namespace

Expected<Described> describeScene(Session &session, const std::filesystem::path &file, const std::string *toml,
                                  bool isQuick) {
  auto scene = toml != nullptr ? scene::parseScene(*toml, file, &session.materials())
                               : scene::loadScene(file, &session.materials());
  if (!scene) return tl::unexpected(scene.error());
  Described out;
  BodySources sources;
  Preparation took;
  if (auto settled = resolveTissues(*scene, session.materials(), sources, {}, took); !settled)
    return tl::unexpected(settled.error());
  std::string howFar;
  const auto built = checkAsRun(session, *scene, isQuick, sources, howFar, out.json);
  if (!built) return tl::unexpected(built.error());
  std::ostringstream text;
  text << "scene \"" << scene->title << "\"\n";
  out.json["file"] = file.string();
  out.json["kind"] = "scene";
  out.json["title"] = scene->title;
  out.json["world"] = Json::object();
  describeValues(scene->world, text, out.json["world"]);
  if (scene->image) {
    auto image = describeSceneImage(*scene, text);
    if (!image) return tl::unexpected(image.error());
    out.json["image"] = std::move(*image);
  }
  if (auto good = describeBodies(session, *scene, built->get(), sources, text, out.json); !good)
    return tl::unexpected(good.error());
  describeSupports(*scene, text, out.json);
  if (auto good = describeObstacles(session.meshFormats(), *scene, text, out.json); !good)
    return tl::unexpected(good.error());
  out.json["probes"] = Json::array();
  for (const scene::SceneProbe &probe : scene->probes) {
    text << "probe \"" << probe.name << "\" of body \"" << probe.body << "\"\n";
    out.json["probes"].push_back(Json{{"name", probe.name}, {"body", probe.body}, {"at_m", probe.at_m}});
  }
  describeMeasurements(*scene, text, out.json);
  describeAttachments(*scene, text, out.json);
  describeProbeTools(*scene, text, out.json);
  describeGrasps(*scene, text, out.json);
  describeContact(*scene, built->get(), text, out.json);
  if (built->get() != nullptr) describeComposition(built->get(), text, out.json);
  out.json["notices"] = sources.reportedNotices();
  for (const std::string &notice : sources.reportedNotices()) text << "notice: " << notice << "\n";
  text << howFar;
  out.text = text.str();
  return out;
}

}  // namespace c3de::app
