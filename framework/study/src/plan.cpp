// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/plan.h"

#include <algorithm>
#include <fstream>
#include <set>

#include "c3de/core/input_file.h"
#include "c3de/core/text.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/simulator_access.h"

namespace c3de::study {
namespace {

/// FNV-1a, 64 bits.
class Hash {
 public:
  Hash &add(std::string_view bytes) {
    for (const char c : bytes) value_ = (value_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    return *this;
  }
  /// Includes its length, so that different divisions into parts differ.
  Hash &addPart(std::string_view bytes) { return add(std::to_string(bytes.size()) + ':').add(bytes); }
  [[nodiscard]] std::string text() const {
    std::string out(16, '0');
    for (std::size_t i = 0; i < 16; ++i) out[i] = "0123456789abcdef"[(value_ >> (60 - 4 * i)) & 15u];
    return out;
  }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

/// Hash of a folder of images from the names and sizes of its files, since they may be gigabytes.
std::string hashOfFolder(const std::filesystem::path &folder) {
  std::set<std::string> lines;
  std::error_code code;
  for (std::filesystem::recursive_directory_iterator at(folder, code), end; !code && at != end; at.increment(code))
    if (at->is_regular_file(code))
      lines.insert(at->path().lexically_relative(folder).generic_string() + ' ' + std::to_string(at->file_size(code)));
  Hash hash;
  for (const std::string &line : lines) hash.addPart(line);
  return hash.text();
}

/// Whether the scene sets a value under one of these prefixes to other than 0.
bool sets(const std::vector<scene::SceneValue> &values, std::initializer_list<const char *> prefixes) {
  return std::any_of(values.begin(), values.end(), [&](const scene::SceneValue &value) {
    const ParameterValue &is = value.value;
    const bool isNothing = is.type == C3DE_PARAM_VEC3   ? is.vec == Vec3{}
                           : is.type == C3DE_PARAM_TEXT ? false
                                                        : is.num == 0.0;
    return !isNothing &&
           std::any_of(prefixes.begin(), prefixes.end(), [&](const char *prefix) { return is.id.starts_with(prefix); });
  });
}

bool conservesEnergy(const scene::SceneFile &scene) {
  if (!scene.loads.empty() || !scene.obstacles.empty() || !scene.probeTools.empty() || !scene.grasps.empty() ||
      sets(scene.world, {C3DE_PARAM_ID_DAMPING, "world.box"}))
    return false;
  for (const scene::SceneFix &fix : scene.fixes)
    if (fix.motion.displacement_m != Vec3{} || fix.motion.rotation_deg != Vec3{} || fix.motion.quaternion) return false;
  return std::none_of(scene.bodies.begin(), scene.bodies.end(), [](const scene::SceneBody &body) {
    return sets(body.params, {"material.viscosity", "material.plastic", "material.prony", "material.retardation",
                              C3DE_PARAM_ID_SURROUNDINGS_STIFFNESS});
  });
}

bool conservesMomentum(const scene::SceneFile &scene) {
  return scene.fixes.empty() && scene.loads.empty() && scene.obstacles.empty() && scene.probeTools.empty() &&
         scene.grasps.empty() && !sets(scene.world, {C3DE_PARAM_ID_DAMPING, "world.box", C3DE_PARAM_ID_GRAVITY}) &&
         std::none_of(scene.bodies.begin(), scene.bodies.end(), [](const scene::SceneBody &body) {
           return sets(body.params, {C3DE_PARAM_ID_SURROUNDINGS_STIFFNESS});
         });
}

class Planner {
 public:
  Planner(const Study &study, session::Session &session, const Program &program, unsigned threads)
      : study_(study), session_(session), program_(program), threads_(threads) {}

  Expected<Plan> plan() {
    identify();
    for (std::size_t c = 0; c < study_.cases.size(); ++c)
      if (auto planned = planCase(c); !planned) return tl::unexpected(planned.error());
    return std::move(plan_);
  }

 private:
  tl::unexpected<Error> refuse(int line, const std::string &what) const {
    return fail(ErrorCode::input, study_.where(line) + ": " + what);
  }
  void identify();
  Expected<void> planCase(std::size_t c);
  Expected<std::string> contentsOf(const Case &one, const scene::SceneFile &scene) const;
  Expected<void> checkQuantity(const Case &one, const scene::SceneFile &scene) const;
  Expected<void> addPoint(std::size_t c, Point point, const std::vector<Setting> &more);
  /// Sets them one after the other, so that an error has its line.
  Expected<void> apply(scene::SceneFile &scene, const std::vector<Setting> &settings) const;
  Expected<std::string> check(const Case &one, const scene::SceneFile &scene, const std::vector<Setting> &settings);

  const Study &study_;
  session::Session &session_;
  const Program &program_;
  unsigned threads_;
  Plan plan_;
  /// By the class that a scene names: the queried simulator, and its identity including the bytes of its library
  struct Asked {
    session::ObjectRef simulator;
    std::string identity;
  };
  std::map<std::string, Asked> asked_;
};

void Planner::identify() {
  plan_.identity = {{"program", program_.version + " " + program_.build},
                    {"repeat", std::to_string(study_.repeat)},
                    {"time_limit", formatNumber(study_.timeLimit_s)},
                    {"seed", std::to_string(study_.seed)},
                    {"samples", std::to_string(study_.samples)}};
}

Expected<std::string> Planner::contentsOf(const Case &one, const scene::SceneFile &scene) const {
  Hash hash;
  const auto own = hashOfFile(one.scene);
  if (!own) return tl::unexpected(own.error());
  hash.addPart(*own);
  std::vector<std::pair<std::filesystem::path, int>> files;
  for (const scene::SceneBody &body : scene.bodies)
    files.emplace_back(body.mesh.empty() ? body.volume.file : body.mesh, body.line);
  for (const scene::SceneObstacle &obstacle : scene.obstacles) files.emplace_back(obstacle.mesh, obstacle.line);
  for (const auto &[file, line] : files) {
    std::error_code code;
    if (std::filesystem::is_directory(file, code)) {
      hash.addPart(hashOfFolder(file));
      continue;
    }
    const auto bytes = hashOfFile(file);
    if (!bytes) return fail(ErrorCode::input, scene.where(line) + ": " + bytes.error().message);
    hash.addPart(*bytes);
  }
  return hash.text();
}

Expected<void> Planner::checkQuantity(const Case &one, const scene::SceneFile &scene) const {
  const Quantity &quantity = one.quantity;
  if (quantity.kind == Quantity::Kind::probe || quantity.kind == Quantity::Kind::frequency) {
    std::vector<std::string> names;
    for (const scene::SceneProbe &probe : scene.probes) names.push_back(probe.name);
    if (std::find(names.begin(), names.end(), quantity.name) == names.end()) {
      const std::string nearest = nearestName(quantity.name, names);
      return refuse(quantity.line, one.scene.string() + " has no probe '" + quantity.name + "'" +
                                       (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
  }
  const bool isOfFix = quantity.kind == Quantity::Kind::reaction || quantity.kind == Quantity::Kind::torque;
  if (isOfFix && quantity.fix >= scene.fixes.size())
    return refuse(quantity.line, one.scene.string() + " has no support " + std::to_string(quantity.fix) +
                                     "; its fixes are numbered from 0, and it has " +
                                     std::to_string(scene.fixes.size()));
  return {};
}

Expected<void> Planner::planCase(std::size_t c) {
  const Case &one = study_.cases[c];
  auto scene = scene::loadScene(one.scene, &session_.materials());
  if (!scene) return tl::unexpected(scene.error());
  if (auto good = checkQuantity(one, *scene); !good) return good;
  auto contents = contentsOf(one, *scene);
  if (!contents) return tl::unexpected(contents.error());
  if (auto applied = apply(*scene, one.set); !applied) return applied;
  PlannedCase planned{std::move(*scene), {}, std::move(*contents)};
  for (const scene::SceneBody &body : planned.scene.bodies)
    if (!scene::trueOf(body.params, C3DE_PARAM_ID_RIGID)) planned.bodies.push_back(body.name);
  if (planned.bodies.empty()) return refuse(one.line, "nothing deforms in " + one.scene.string());
  const std::string name = "case " + one.name;
  const Quantity &quantity = one.quantity;
  plan_.identity.emplace_back(name + ": scene", planned.contents);
  plan_.identity.emplace_back(name + ": end", one.until_s ? formatNumber(*one.until_s) + " s"
                                              : one.steps ? std::to_string(*one.steps) + " steps"
                                                          : "its own");
  plan_.identity.emplace_back(name + ": quantity", quantity.shown());
  std::string reference =
      one.reference.kind + " " + formatNumber(one.reference.value) + " " + formatNumber(one.reference.uncertainty);
  if (!one.reference.file.empty()) {
    const auto bytes = hashOfFile(one.reference.file);
    if (!bytes) return refuse(one.reference.line, bytes.error().message);
    reference += " " + *bytes;
  }
  plan_.identity.emplace_back(name + ": reference", reference);
  plan_.cases.push_back(std::move(planned));

  if (one.reference.source == Reference::Source::richardson)
    for (const auto &parameters : combinations({one.reference.parameter})) {
      Point point;
      point.ofCase = c;
      point.isReference = true;
      point.parameters = parameters;
      if (auto added = addPoint(c, std::move(point), one.reference.set); !added) return added;
    }
  for (std::size_t g = 0; g < one.grids.size(); ++g)
    for (const auto &parameters : combinations(one.grids[g].parameters)) {
      Point point;
      point.ofCase = c;
      point.grid = g;
      point.parameters = parameters;
      if (auto added = addPoint(c, std::move(point), {}); !added) return added;
    }
  return {};
}

Expected<void> Planner::apply(scene::SceneFile &scene, const std::vector<Setting> &settings) const {
  for (const Setting &setting : settings)
    if (const auto set = scene::applyOverride(scene, setting.path + "=" + setting.value, &session_.materials()); !set)
      return refuse(setting.line, set.error().message);
  return {};
}

Expected<std::string> Planner::check(const Case &one, const scene::SceneFile &scene,
                                     const std::vector<Setting> &settings) {
  const auto lineOf = [&](const std::string &message) {
    int line = one.line;
    for (const Setting &setting : settings)
      if (message.find("--set " + setting.path) != std::string::npos) line = setting.line;
    return line;
  };
  auto found = asked_.find(scene.simulatorClass);
  if (found == asked_.end()) {
    const auto chosen = session_.chooseSimulator(scene.simulatorClass);
    if (!chosen) {
      int line = one.line;
      for (const Setting &setting : settings)
        if (setting.path == "simulator.class") line = setting.line;
      return refuse(line, chosen.error().message);
    }
    auto created = session_.createSimulator(chosen->classId);
    if (!created) return tl::unexpected(created.error());
    std::string identity = chosen->classId + " " + chosen->version;
    for (const plugin_host::PluginInfo &plugin : session_.plugins().plugins())
      if (plugin.id == chosen->plugin && plugin.state == plugin_host::PluginState::loaded)
        identity += " " + hashOfFile(plugin.path).value_or("");
    found = asked_.emplace(scene.simulatorClass, Asked{session::ObjectRef(*created), identity}).first;
    plan_.identity.emplace_back("simulator " + chosen->classId, identity);
  }
  if (const auto good = session_.checkValues(found->second.simulator.get(), scene); !good)
    return refuse(lineOf(good.error().message), good.error().message);
  return found->second.identity;
}

Expected<void> Planner::addPoint(std::size_t c, Point point, const std::vector<Setting> &more) {
  const Case &one = study_.cases[c];
  const PlannedCase &planned = plan_.cases[c];
  std::vector<Setting> own = more;
  point.threads = threads_;
  for (const StudyParameterValue &value : point.parameters) {
    if (value.parameter == "threads") point.threads = static_cast<unsigned>(std::stoul(value.value));
    const std::vector<Setting> settings = settingsOf(value, planned.bodies);
    own.insert(own.end(), settings.begin(), settings.end());
  }
  scene::SceneFile scene = planned.scene;
  if (auto applied = apply(scene, own); !applied) return applied;
  point.settings = one.set;
  point.settings.insert(point.settings.end(), own.begin(), own.end());
  const auto simulator = check(one, scene, point.settings);
  if (!simulator) return tl::unexpected(simulator.error());

  point.conservesEnergy = conservesEnergy(scene);
  point.conservesMomentum = conservesMomentum(scene);
  Hash hash;
  hash.addPart(program_.version).addPart(program_.build).addPart(*simulator).addPart(planned.contents);
  hash.addPart(one.until_s ? formatNumber(*one.until_s) : "").addPart(one.steps ? std::to_string(*one.steps) : "");
  for (const Setting &setting : point.settings) hash.addPart(setting.path).addPart(setting.value);
  hash.addPart(std::to_string(point.threads)).addPart(std::to_string(study_.seed));
  hash.addPart(std::to_string(study_.samples)).addPart(point.isReference ? "1" : std::to_string(study_.repeat));
  hash.addPart(formatNumber(study_.timeLimit_s)).addPart(one.name).addPart(one.quantity.shown());
  point.id = hash.text();
  plan_.identity.emplace_back("case " + one.name + ": " +
                                  (point.isReference ? "reference " : one.grids[point.grid].label + " ") +
                                  shown(point.parameters),
                              point.id);
  plan_.points.push_back(std::move(point));
  return {};
}

}  // namespace

std::string hashOf(std::string_view bytes) { return Hash().add(bytes).text(); }

Expected<std::string> hashOfFile(const std::filesystem::path &file) {
  auto opened = openInputFile(file);
  if (!opened) return tl::unexpected(opened.error());
  std::ifstream &in = *opened;
  Hash hash;
  std::vector<char> buffer(std::size_t{1} << 20);
  while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || in.gcount() > 0)
    hash.add({buffer.data(), static_cast<std::size_t>(in.gcount())});
  if (in.bad()) return fail(ErrorCode::input, file.string() + ": cannot be read");
  return hash.text();
}

Expected<Plan> planStudy(const Study &study, session::Session &session, const Program &program, unsigned threads) {
  return Planner(study, session, program, threads).plan();
}

std::string difference(const std::vector<std::pair<std::string, std::string>> &present,
                       const std::vector<std::pair<std::string, std::string>> &before) {
  const auto find = [](const auto &in, const std::string &key) -> const std::string * {
    for (const auto &[name, value] : in)
      if (name == key) return &value;
    return nullptr;
  };
  std::vector<std::string> lines;
  // Ids differ whenever anything else does, so they are reported last.
  std::vector<std::string> ids;
  for (const auto &[name, value] : present) {
    const std::string *was = find(before, name);
    if (was == nullptr)
      lines.push_back("'" + name + "' is new");
    else if (*was != value && value.size() == 16 && was->size() == 16 && !name.ends_with(": scene"))
      ids.push_back("'" + name + "' has changed");
    else if (*was != value)
      lines.push_back(name.ends_with(": scene") ? "'" + name + "' has changed"
                                                : "'" + name + "' is " + value + " and was " + *was);
  }
  for (const auto &[name, value] : before)
    if (find(present, name) == nullptr) lines.push_back("'" + name + "' is gone");
  if (lines.empty()) lines = ids;
  std::string text;
  for (std::size_t i = 0; i < lines.size() && i < 3; ++i) text += (i > 0 ? "; " : "") + lines[i];
  if (lines.size() > 3) text += "; and " + std::to_string(lines.size() - 3) + " more";
  return text;
}

}  // namespace c3de::study
