// SPDX-License-Identifier: Apache-2.0
#include "scene_difference.h"

#include <cmath>

#include "scene_text.h"

using namespace c3de;

namespace {

// A member-by-member comparison without lines. `different` is the first member that differs.
struct Comparison {
  std::string different;
  std::string place;

  void differ(const std::string &what) {
    if (different.empty()) different = place + what;
  }
  template <class T>
  void check(const char *what, const T &a, const T &b) {
    if (!(a == b)) differ(what);
  }
  void check(const char *what, double a, double b) {
    const bool isSame = (a == b && std::signbit(a) == std::signbit(b)) || (std::isnan(a) && std::isnan(b));
    if (!isSame) differ(what);
  }
  void check(const char *what, const std::vector<scene::SceneValue> &a, const std::vector<scene::SceneValue> &b) {
    if (a.size() != b.size()) differ(std::string(what) + ": number of values");
    for (const scene::SceneValue &value : a) {
      const scene::SceneValue *other = findValue(b, value.value.id);
      if (other == nullptr) return differ(what + (": no " + value.value.id));
      check(value.value.id.c_str(), value.value.num, other->value.num);
      if (value.value.type != other->value.type || value.value.text != other->value.text ||
          value.value.vec != other->value.vec || value.isOptional != other->isOptional ||
          value.isPieceOverride != other->isPieceOverride)
        differ(what + (": " + value.value.id));
    }
  }
  void check(const char *what, const scene::SceneRegion &a, const scene::SceneRegion &b) {
    if (a.kind != b.kind || a.a != b.a || a.b != b.b || a.radius != b.radius || a.voxels != b.voxels) differ(what);
  }
  void check(const char *what, const scene::SceneMotion &a, const scene::SceneMotion &b) {
    if (a.displacement_m != b.displacement_m || a.rotation_deg != b.rotation_deg || a.quaternion != b.quaternion ||
        a.centre_m != b.centre_m || a.ramp_s != b.ramp_s)
      differ(what);
  }
  void check(const char *what, const scene::ScenePlacement &a, const scene::ScenePlacement &b) {
    if (a.position_m != b.position_m || a.rotation_deg != b.rotation_deg || a.scale != b.scale || a.matrix != b.matrix)
      differ(what);
  }
  void check(const char *what, const std::vector<scene::SceneLabel> &a, const std::vector<scene::SceneLabel> &b) {
    if (!a.empty() || !b.empty()) differ(what);
  }
  void check(const char *what, const imaging::MaskCleanUp &a, const imaging::MaskCleanUp &b) {
    if (a.opening_mm != b.opening_mm || a.closing_mm != b.closing_mm || a.largest != b.largest ||
        a.fillHoles != b.fillHoles)
      differ(what);
  }
  void check(const char *what, const scene::ScenePart &a, const scene::ScenePart &b) {
    check(what, a.name, b.name);
    check(what, a.region, b.region);
    check(what, a.params, b.params);
  }
  void check(const char *what, const scene::SceneRefinement &a, const scene::SceneRefinement &b) {
    check(what, a.region, b.region);
    check(what, a.spacing_m, b.spacing_m);
  }
  void check(const char *what, const scene::SceneTissueRule &a, const scene::SceneTissueRule &b) {
    check(what, a.threshold, b.threshold);
    check(what, a.image, b.image);
    check(what, a.margin_mm, b.margin_mm);
    check(what, a.region, b.region);
  }
  void check(const char *what, const scene::SceneTissue &a, const scene::SceneTissue &b) {
    check(what, a.label, b.label);
    check(what, a.wanted, b.wanted);
    check(what, a.isMaterialByName, b.isMaterialByName);
    check(what, a.isRigid, b.isRigid);
    check(what, a.isEmpty, b.isEmpty);
    check(what, a.isShown, b.isShown);
    check(what, a.colour, b.colour);
    check(what, a.params, b.params);
    check(what, a.preset, b.preset);
    check(what, a.remark, b.remark);
    check(what, a.labels, b.labels);
    check(what, a.rule, b.rule);
  }
  void check(const char *what, const scene::SceneBackground &a, const scene::SceneBackground &b) {
    if (a.image != b.image || a.series != b.series || a.time != b.time || a.from != b.from || a.to != b.to)
      differ(what);
  }
  void check(const char *what, const scene::ScenePiece &a, const scene::ScenePiece &b) {
    check(what, a.params, b.params);
    check(what, a.velocity_m_s, b.velocity_m_s);
  }
  void check(const char *what, const scene::SceneSlidingPart &a, const scene::SceneSlidingPart &b) {
    check(what, static_cast<const scene::ScenePiece &>(a), static_cast<const scene::ScenePiece &>(b));
    check(what, a.names, b.names);
    check(what, a.labels, b.labels);
  }
  void check(const char *what, const scene::SceneToolWaypoint &a, const scene::SceneToolWaypoint &b) {
    if (a.time_s != b.time_s || a.at_m != b.at_m || a.axis != b.axis) differ(what);
  }
  void check(const char *what, const scene::SceneGraspWaypoint &a, const scene::SceneGraspWaypoint &b) {
    if (a.time_s != b.time_s || a.at_m != b.at_m || a.turn_deg != b.turn_deg) differ(what);
  }
  template <class T>
  void check(const char *what, const std::optional<T> &a, const std::optional<T> &b) {
    if (a.has_value() != b.has_value()) return differ(what);
    if (a) check(what, *a, *b);
  }
  template <class T>
  requires std::is_class_v<T>
  void check(const char *what, const std::vector<T> &a, const std::vector<T> &b) {
    if (a.size() != b.size()) return differ(std::string(what) + ": number");
    for (std::size_t i = 0; i < a.size(); ++i) check(what, a[i], b[i]);
  }
  void check(const char *what, const std::string &a, const std::string &b) {
    if (a != b) differ(what + (" '" + a + "' | '" + b + "'"));
  }

  void check(const char *, const scene::SceneImage &a, const scene::SceneImage &b) {
    check("image file", a.file, b.file);
    check("image time", a.time, b.time);
    check("image labels", a.labels, b.labels);
    check("image warp", a.warp, b.warp);
    check("image series", a.series, b.series);
    check("image rim", a.rim_mm, b.rim_mm);
    check("image still", a.still, b.still);
  }
  void check(const char *, const scene::SceneVolume &a, const scene::SceneVolume &b) {
    check("file", a.file, b.file);
    check("time", a.time, b.time);
    check("mask", a.mask, b.mask);
    check("colour", a.colour, b.colour);
    check("label", a.label, b.label);
    check("labelName", a.labelName, b.labelName);
    check("series", a.series, b.series);
    check("threshold", a.threshold, b.threshold);
    check("tissues", a.tissues, b.tissues);
    check("usesKnownTissues", a.usesKnownTissues, b.usesKnownTissues);
    check("ruled", a.ruled, b.ruled);
    check("isSettled", a.isSettled, b.isSettled);
    check("overridesOfParts", a.overridesOfParts, b.overridesOfParts);
    check("background", a.background, b.background);
    check("slides", a.slides, b.slides);
    check("rest", a.rest, b.rest);
    check("slidingFriction", a.slidingFriction, b.slidingFriction);
    check("cut", a.cut, b.cut);
    check("piece", a.piece, b.piece);
    check("region", a.region, b.region);
    check("mend", a.mend, b.mend);
    check("edgeLength", a.edgeLength_mm, b.edgeLength_mm);
  }
  void check(const char *, const scene::SceneBody &a, const scene::SceneBody &b) {
    place = "body " + a.name + " ";
    check("name", a.name, b.name);
    check("mesh", a.mesh, b.mesh);
    check("volume", a.volume, b.volume);
    check("meshUnit", a.meshUnit, b.meshUnit);
    check("placement", a.placement, b.placement);
    check("velocity", a.velocity_m_s, b.velocity_m_s);
    check("angularVelocity", a.angularVelocity_rad_s, b.angularVelocity_rad_s);
    check("params", a.params, b.params);
    check("parts", a.parts, b.parts);
    check("refinements", a.refinements, b.refinements);
    check("rigidTissue", a.rigidTissue, b.rigidTissue);
    place.clear();
  }
  void check(const char *, const scene::SceneFix &a, const scene::SceneFix &b) {
    check("fix name", a.name, b.name);
    check("fix body", a.body, b.body);
    check("fix region", a.region, b.region);
    check("fix motion", a.motion, b.motion);
  }
  void check(const char *, const scene::SceneLoad &a, const scene::SceneLoad &b) {
    check("load name", a.name, b.name);
    check("load body", a.body, b.body);
    check("load region", a.region, b.region);
    check("load force", a.force_N, b.force_N);
    check("load pressure", a.pressure_Pa, b.pressure_Pa);
    check("load follower", a.follower, b.follower);
    check("load ramp", a.ramp_s, b.ramp_s);
  }
  void check(const char *, const scene::SceneObstacle &a, const scene::SceneObstacle &b) {
    check("obstacle name", a.name, b.name);
    check("obstacle mesh", a.mesh, b.mesh);
    check("obstacle meshUnit", a.meshUnit, b.meshUnit);
    check("obstacle placement", a.placement, b.placement);
    check("obstacle params", a.params, b.params);
    check("obstacle motion", a.motion, b.motion);
  }
  void check(const char *, const scene::SceneProbe &a, const scene::SceneProbe &b) {
    check("probe name", a.name, b.name);
    check("probe body", a.body, b.body);
    check("probe at", a.at_m, b.at_m);
  }
  void check(const char *, const scene::SceneLandmark &a, const scene::SceneLandmark &b) {
    check("landmark name", a.name, b.name);
    check("landmark body", a.body, b.body);
    check("landmark at", a.at_m, b.at_m);
    check("landmark target", a.target_m, b.target_m);
  }
  void check(const char *, const scene::SceneDistance &a, const scene::SceneDistance &b) {
    check("distance name", a.name, b.name);
    check("distance between", a.between, b.between);
  }
  void check(const char *, const scene::SceneAngle &a, const scene::SceneAngle &b) {
    check("angle name", a.name, b.name);
    check("angle at", a.at, b.at);
  }
  void check(const char *, const scene::SceneAttachment &a, const scene::SceneAttachment &b) {
    check("attachment name", a.name, b.name);
    check("attachment names", a.names, b.names);
    check("attachment region", a.region, b.region);
    check("attachment within", a.within_m, b.within_m);
    check("attachment stiffness", a.stiffness_Pa_m, b.stiffness_Pa_m);
    check("attachment tangential", a.givenTangential_Pa_m, b.givenTangential_Pa_m);
    check("attachment tears at", a.tearsAt_Pa, b.tearsAt_Pa);
  }
  void check(const char *, const scene::SceneContactPair &a, const scene::SceneContactPair &b) {
    check("pair names", a.names, b.names);
    check("pair friction", a.friction, b.friction);
    check("pair enabled", a.enabled, b.enabled);
    check("pair fits", a.fits, b.fits);
  }
  void check(const char *, const scene::SceneProbeTool &a, const scene::SceneProbeTool &b) {
    check("tool name", a.name, b.name);
    check("tool radius", a.radius_m, b.radius_m);
    check("tool length", a.length_m, b.length_m);
    check("tool friction", a.friction, b.friction);
    check("tool path", a.path, b.path);
  }
  void check(const char *, const scene::SceneGrasp &a, const scene::SceneGrasp &b) {
    check("grasp name", a.name, b.name);
    check("grasp body", a.body, b.body);
    check("grasp at", a.at_m, b.at_m);
    check("grasp axis", a.axis, b.axis);
    check("grasp jaw", a.jaw_m, b.jaw_m);
    check("grasp opening", a.givenOpening_m, b.givenOpening_m);
    check("grasp closed", a.givenClosed_m, b.givenClosed_m);
    check("grasp force limit", a.forceLimit_N, b.forceLimit_N);
    check("grasp path", a.path, b.path);
  }
};

}  // namespace

std::string difference(const scene::SceneFile &a, const scene::SceneFile &b) {
  Comparison c;
  c.check("title", a.title, b.title);
  c.check("simulator", a.simulatorClass, b.simulatorClass);
  c.check("image", a.image, b.image);
  c.check("world", a.world, b.world);
  c.check("bodies", a.bodies, b.bodies);
  c.check("fixes", a.fixes, b.fixes);
  c.check("loads", a.loads, b.loads);
  c.check("obstacles", a.obstacles, b.obstacles);
  c.check("probes", a.probes, b.probes);
  c.check("landmarks", a.landmarks, b.landmarks);
  c.check("distances", a.distances, b.distances);
  c.check("angles", a.angles, b.angles);
  c.check("attachments", a.attachments, b.attachments);
  c.check("contact pairs", a.contactPairs, b.contactPairs);
  c.check("probe tools", a.probeTools, b.probeTools);
  c.check("grasps", a.grasps, b.grasps);
  return c.different;
}
