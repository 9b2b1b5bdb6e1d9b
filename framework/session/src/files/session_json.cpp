// SPDX-License-Identifier: Apache-2.0
#include "files/session_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "c3de/core/text.h"
#include "files/embedded_names.h"

namespace c3de::session {
namespace {

// Sorted keys; a file with very many of them is read in time, unlike with ordered_json.
using Json = nlohmann::json;
using Pointer = Json::json_pointer;

constexpr int kDeepest = 64;

std::string hashText(std::uint64_t value) { return fmt::format("{:016x}", value); }

const char *kindOf(const Json &value) {
  switch (value.type()) {
    case Json::value_t::null: return "null";
    case Json::value_t::boolean: return "true or false";
    case Json::value_t::string: return "a text";
    case Json::value_t::array: return "a list";
    case Json::value_t::object: return "an object";
    default: return "a number";
  }
}

/// Removes keys from an object while it reads them; what remains is unknown. The first error is kept.
class KeyReader {
 public:
  /// @param place  "" or "view." in messages
  KeyReader(Json object, std::string place, std::string &error)
      : object_(std::move(object)), place_(std::move(place)), error_(&error) {}

  void text(const char *key, std::string &out) {
    read(key, "a text", [&](const Json &value) {
      if (!value.is_string()) return false;
      out = value.get<std::string>();
      return true;
    });
  }
  void texts(const char *key, std::vector<std::string> &out) {
    read(key, "a list of texts", [&](const Json &value) {
      if (!value.is_array()) return false;
      for (const Json &one : value) {
        if (!one.is_string()) return false;
        out.push_back(one.get<std::string>());
      }
      return true;
    });
  }
  void count(const char *key, std::uint64_t &out) {
    read(key, "a whole number, 0 or more", [&](const Json &value) {
      if (!value.is_number_unsigned()) return false;
      out = value.get<std::uint64_t>();
      return true;
    });
  }
  void counts(const char *key, std::vector<std::uint64_t> &out) {
    read(key, "a list of whole numbers, 0 or more", [&](const Json &value) {
      if (!value.is_array()) return false;
      for (const Json &one : value) {
        if (!one.is_number_unsigned()) return false;
        out.push_back(one.get<std::uint64_t>());
      }
      return true;
    });
  }
  void flag(const char *key, bool &out) {
    read(key, "true or false", [&](const Json &value) {
      if (!value.is_boolean()) return false;
      out = value.get<bool>();
      return true;
    });
  }
  void number(const char *key, double &out) {
    read(key, "a number", [&](const Json &value) { return takeNumber(value, out); });
  }
  void number(const char *key, std::optional<double> &out) {
    double value = 0.0;
    if (!object_.contains(key)) return;
    number(key, value);
    out = value;
  }
  void point(const char *key, Vec3 &out) {
    read(key, "a list of three numbers", [&](const Json &value) {
      return value.is_array() && value.size() == 3 && takeNumber(value[0], out[0]) && takeNumber(value[1], out[1]) &&
             takeNumber(value[2], out[2]);
    });
  }
  void point(const char *key, std::optional<Vec3> &out) {
    if (!object_.contains(key)) return;
    point(key, out.emplace());
  }
  void digits(const char *key, std::size_t count, std::string &out) {
    const std::string accepted = fmt::format("a text of {} digits 0 … 9, a … f", count);
    read(key, accepted, [&](const Json &value) {
      if (!value.is_string() || !isHexadecimal(value.get_ref<const std::string &>(), count)) return false;
      out = value.get<std::string>();
      return true;
    });
  }
  /// Null if there is none, or of the wrong type.
  Json object(const char *key) { return child(key, "an object", &Json::is_object); }
  Json list(const char *key) { return child(key, "a list", &Json::is_array); }

  [[nodiscard]] bool has(const char *key) const { return object_.contains(key); }
  void require(const char *key) {
    if (!has(key) && error_->empty()) *error_ = fmt::format("the key {}{} is missing", place_, key);
  }
  void refuse(const std::string &why) {
    if (error_->empty()) *error_ = why;
  }
  /// Keys that were not read, below a JSON pointer.
  void keepRest(const Pointer &below, std::map<std::string, std::string> &unknown) const {
    for (const auto &[key, value] : object_.items()) unknown[(below / key).to_string()] = value.dump();
  }

 private:
  static bool takeNumber(const Json &value, double &out) {
    if (!value.is_number()) return false;
    out = value.get<double>();
    return std::isfinite(out);
  }
  Json child(const char *key, std::string_view accepted, bool (Json::*isKind)() const noexcept) {
    Json out;
    read(key, accepted, [&](const Json &value) {
      if (!(value.*isKind)()) return false;
      out = value;
      return true;
    });
    return out;
  }
  template <class Take>
  void read(const char *key, std::string_view accepted, const Take &take) {
    const auto found = object_.find(key);
    if (found == object_.end()) return;
    if (!take(*found) && error_->empty())
      *error_ =
          fmt::format("the key {}{} is {}: {}; accepted: {}", place_, key, kindOf(*found), shown(*found), accepted);
    object_.erase(found);
  }
  static std::string shown(const Json &value) {
    if (value.is_structured()) return fmt::format("of {} entries", value.size());
    return displayMessage(value.dump().substr(0, 60));
  }

  Json object_;
  std::string place_;
  std::string *error_;
};

void readFiles(const Json &list, ParsedSession &out, std::string &error) {
  std::set<std::string> paths;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string place = fmt::format("files[{}]", i);
    if (!list[i].is_object()) {
      if (error.empty()) error = fmt::format("the key {} is {}; accepted: an object", place, kindOf(list[i]));
      return;
    }
    KeyReader reader(list[i], place + ".", error);
    ReferencedFile file;
    for (const char *key : {"path", "sha256", "bytes"}) reader.require(key);
    reader.text("path", file.path);
    reader.digits("sha256", kSha256Digits, file.sha256);
    reader.count("bytes", file.bytes);
    reader.flag("embedded", file.isEmbedded);
    if (!paths.insert(file.path).second)
      reader.refuse(fmt::format("the key {}.path occurs twice: {}", place, displayMessage(file.path)));
    reader.keepRest(Pointer() / "files" / file.path, out.session.unknown);
    out.session.files.push_back(std::move(file));
  }
}

void readChanges(const Json &list, ParsedSession &out, std::string &error) {
  std::uint64_t built = 1;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string place = fmt::format("changes[{}]", i);
    if (!list[i].is_object()) {
      if (error.empty()) error = fmt::format("the key {} is {}; accepted: an object", place, kindOf(list[i]));
      return;
    }
    KeyReader reader(list[i], place + ".", error);
    SavedChange change;
    for (const char *key : {"id", "flags", "scenes", "member"}) reader.require(key);
    reader.text("id", change.id);
    reader.text("key", change.key);
    reader.text("text", change.text);
    std::uint64_t flags = 0;
    reader.count("flags", flags);
    change.flags = static_cast<std::uint32_t>(flags);
    reader.count("scenes", change.scenes);
    if (flags > std::numeric_limits<std::uint32_t>::max()) reader.refuse(place + ".flags is too large");
    if (change.scenes < built || change.scenes > out.names.scenes.size())
      reader.refuse(fmt::format("the key {}.scenes is {}; accepted: {} to {}", place, change.scenes, built,
                                out.names.scenes.size()));
    built = change.scenes;
    reader.text("member", out.names.changes.emplace_back());
    out.session.changes.push_back(std::move(change));
  }
}

Json changesJson(const SessionFile &session, const MemberNames &names) {
  Json list = Json::array();
  for (std::size_t i = 0; i < session.changes.size(); ++i) {
    const SavedChange &change = session.changes[i];
    list.push_back(Json{{"id", change.id},
                        {"key", change.key},
                        {"text", change.text},
                        {"flags", change.flags},
                        {"scenes", change.scenes},
                        {"member", names.changes[i]}});
  }
  return list;
}

void readMeasurements(Json object, SavedMeasurements &out, std::string &error) {
  KeyReader reader(std::move(object), "view.measurements.", error);
  std::set<std::string> names;
  const auto each = [&](const char *key, const auto &take) {
    const Json list = reader.list(key);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::string place = fmt::format("view.measurements.{}[{}]", key, i);
      if (!list[i].is_object())
        return reader.refuse(fmt::format("the key {} is {}; accepted: an object", place, kindOf(list[i])));
      KeyReader keys(list[i], place + ".", error);
      keys.require("name");
      std::string name;
      keys.text("name", name);
      if (name.empty() || !names.insert(name).second)
        keys.refuse(
            fmt::format("the key {}.name is '{}'; accepted: a name that no other has", place, displayMessage(name)));
      bool isHidden = false, isOfScene = false;
      keys.flag("hidden", isHidden);
      keys.flag("of_scene", isOfScene);
      take(keys, place, name, isHidden, isOfScene);
    }
  };
  each("points", [&](KeyReader &keys, const std::string &, const std::string &name, bool isHidden, bool isOfScene) {
    SavedMeasurements::Point point{name, {}, {}, {}, isHidden, isOfScene};
    keys.require("at_mm");
    keys.text("body", point.body);
    keys.point("at_mm", point.at_mm);
    keys.point("target_mm", point.target_mm);
    out.points.push_back(std::move(point));
  });
  each("measures",
       [&](KeyReader &keys, const std::string &place, const std::string &name, bool isHidden, bool isOfScene) {
         SavedMeasurements::Between between{name, {}, isHidden, isOfScene};
         keys.texts("points", between.points);
         const bool isKnown = std::all_of(between.points.begin(), between.points.end(), [&](const std::string &point) {
           return std::any_of(out.points.begin(), out.points.end(), [&](const auto &one) { return one.name == point; });
         });
         if (!isKnown || between.points.size() < 2 || between.points.size() > 3)
           keys.refuse(fmt::format("the key {}.points is of {} names; accepted: two or three names of points", place,
                                   between.points.size()));
         out.measures.push_back(std::move(between));
       });
}

void readComparison(Json object, ParsedSession &out, std::string &error) {
  SavedComparison &second = out.session.view.comparison.emplace();
  if (!object.is_object()) return;
  KeyReader keys(std::move(object), "view.comparison.", error);
  keys.require("image");
  keys.text("image", second.image);
  keys.text("series", second.series);
  keys.count("time", second.time);
  keys.point("translation_mm", second.translation_mm);
  keys.point("rotation_deg", second.rotation_deg);
  keys.point("centre_mm", second.centre_mm);
  keys.flag("hidden", second.isHidden);
  keys.flag("checkerboard", second.isCheckerboard);
  keys.number("blend", second.blend);
  keys.number("square_mm", second.square_mm);
  keys.number("window", second.window);
  keys.number("level", second.level);
  if (second.image.empty()) keys.refuse("the key view.comparison.image is empty; accepted: the path of an image");
  if (!(second.blend >= 0.0 && second.blend <= 1.0))
    keys.refuse(fmt::format("the key view.comparison.blend is {}; accepted: 0 to 1", second.blend));
  if (!(second.square_mm > 0.0))
    keys.refuse(fmt::format("the key view.comparison.square_mm is {}; accepted: above 0", second.square_mm));
  keys.keepRest(Pointer() / "view" / "comparison", out.session.unknown);
}

void readMatch(Json object, ParsedSession &out, std::string &error) {
  SavedMatch &match = out.session.view.match.emplace();
  if (!object.is_object()) return;
  KeyReader keys(std::move(object), "view.match.", error);
  keys.text("body", match.body);
  keys.text("points", match.points);
  keys.text("surface", match.surface);
  keys.text("labels", match.labels);
  keys.text("landmarks", match.landmarks);
  keys.text("source", match.source);
  keys.text("server", match.server);
  keys.text("tool", match.tool);
  keys.count("tool_points", match.toolPoints);
  keys.text("label", match.label);
  keys.count("time", match.time);
  keys.text("unit", match.unit);
  keys.number("noise_mm", match.noise_mm);
  keys.number("weight", match.landmarkWeight);
  keys.flag("fit", match.fitsLandmarks);
  keys.flag("rigid_first", match.isRigidFirst);
  keys.flag("deform", match.deforms);
  if (match.source != "points" && match.source != "surface" && match.source != "labels" && match.source != "stream")
    keys.refuse(fmt::format("the key view.match.source is '{}'; accepted: points, surface, labels, stream",
                            displayMessage(match.source)));
  if (!match.unit.empty() && match.unit != "m" && match.unit != "mm" && match.unit != "cm")
    keys.refuse(fmt::format("the key view.match.unit is '{}'; accepted: m, mm, cm", displayMessage(match.unit)));
  for (const auto &[key, value] : {std::pair("noise_mm", match.noise_mm), std::pair("weight", match.landmarkWeight)})
    if (!(value > 0.0)) keys.refuse(fmt::format("the key view.match.{} is {}; accepted: above 0", key, value));
  keys.keepRest(Pointer() / "view" / "match", out.session.unknown);
}

void readView(const Json &object, ParsedSession &out, std::string &error) {
  if (object.is_null()) return;
  SessionView &view = out.session.view;
  KeyReader reader(object, "view.", error);
  reader.text("image", view.image);
  reader.text("series", view.series);
  reader.count("time", view.time);
  reader.texts("labels", view.labels);
  reader.point("cross_hair_mm", view.crossHair_mm);
  reader.number("window", view.window);
  reader.number("level", view.level);
  if (reader.has("camera")) {
    const Json pose = reader.object("camera");
    SessionView::CameraPose camera;
    if (pose.is_object()) {
      KeyReader keys(pose, "view.camera.", error);
      for (const char *key : {"focus_mm", "yaw_rad", "pitch_rad", "distance_mm"}) keys.require(key);
      keys.point("focus_mm", camera.focus_mm);
      keys.number("yaw_rad", camera.yaw_rad);
      keys.number("pitch_rad", camera.pitch_rad);
      keys.number("distance_mm", camera.distance_mm);
      keys.keepRest(Pointer() / "view" / "camera", out.session.unknown);
    }
    view.camera = camera;
  }
  if (reader.has("measurements")) readMeasurements(reader.object("measurements"), view.measurements.emplace(), error);
  if (reader.has("comparison")) readComparison(reader.object("comparison"), out, error);
  if (reader.has("match")) readMatch(reader.object("match"), out, error);
  if (reader.has("selection")) {
    const Json selection = reader.object("selection");
    SavedSelection &picked = view.selection.emplace();
    if (selection.is_object()) {
      KeyReader keys(selection, "view.selection.", error);
      keys.text("mask", picked.mask);
      keys.counts("labels", picked.labels);
      keys.text("name", picked.name);
      keys.number("low", picked.low);
      keys.number("high", picked.high);
      keys.keepRest(Pointer() / "view" / "selection", out.session.unknown);
    }
  }
  reader.keepRest(Pointer() / "view", out.session.unknown);
}

Json measurementsJson(const SavedMeasurements &measurements) {
  Json points = Json::array(), measures = Json::array();
  const auto flags = [](const auto &one, Json &json) {
    if (one.isHidden) json["hidden"] = true;
    if (one.isOfScene) json["of_scene"] = true;
  };
  for (const auto &one : measurements.points) {
    Json json{{"name", one.name}, {"at_mm", one.at_mm}};
    if (!one.body.empty()) json["body"] = one.body;
    if (one.target_mm) json["target_mm"] = *one.target_mm;
    flags(one, json);
    points.push_back(std::move(json));
  }
  for (const auto &one : measurements.measures) {
    Json json{{"name", one.name}, {"points", one.points}};
    flags(one, json);
    measures.push_back(std::move(json));
  }
  return Json{{"points", std::move(points)}, {"measures", std::move(measures)}};
}

Json viewJson(const SessionView &view) {
  Json json = Json::object();
  if (!view.image.empty()) json["image"] = view.image;
  if (!view.series.empty()) json["series"] = view.series;
  if (view.time != 0) json["time"] = view.time;
  if (!view.labels.empty()) json["labels"] = view.labels;
  if (view.crossHair_mm) json["cross_hair_mm"] = *view.crossHair_mm;
  if (view.window) json["window"] = *view.window;
  if (view.level) json["level"] = *view.level;
  if (view.measurements) json["measurements"] = measurementsJson(*view.measurements);
  if (view.selection) {
    const SavedSelection &picked = *view.selection;
    Json &selection = json["selection"] =
        Json{{"labels", picked.labels}, {"name", picked.name}, {"low", picked.low}, {"high", picked.high}};
    if (!picked.mask.empty()) selection["mask"] = picked.mask;
  }
  if (view.comparison) {
    const SavedComparison &second = *view.comparison;
    Json &comparison = json["comparison"] = Json{{"image", second.image},
                                                 {"translation_mm", second.translation_mm},
                                                 {"rotation_deg", second.rotation_deg},
                                                 {"centre_mm", second.centre_mm},
                                                 {"checkerboard", second.isCheckerboard},
                                                 {"blend", second.blend},
                                                 {"square_mm", second.square_mm}};
    if (!second.series.empty()) comparison["series"] = second.series;
    if (second.time != 0) comparison["time"] = second.time;
    if (second.isHidden) comparison["hidden"] = true;
    if (second.window) comparison["window"] = *second.window;
    if (second.level) comparison["level"] = *second.level;
  }
  if (view.match) {
    const SavedMatch &match = *view.match;
    Json &out = json["match"] = Json{{"body", match.body},         {"source", match.source},
                                     {"noise_mm", match.noise_mm}, {"weight", match.landmarkWeight},
                                     {"fit", match.fitsLandmarks}, {"rigid_first", match.isRigidFirst},
                                     {"deform", match.deforms}};
    for (const auto &[key, text] :
         {std::pair("points", &match.points), std::pair("surface", &match.surface), std::pair("labels", &match.labels),
          std::pair("landmarks", &match.landmarks), std::pair("label", &match.label), std::pair("unit", &match.unit),
          std::pair("server", &match.server), std::pair("tool", &match.tool)})
      if (!text->empty()) out[key] = *text;
    if (match.time != 0) out["time"] = match.time;
    if (match.toolPoints != SavedMatch().toolPoints) out["tool_points"] = match.toolPoints;
  }
  if (view.camera)
    json["camera"] = Json{{"focus_mm", view.camera->focus_mm},
                          {"yaw_rad", view.camera->yaw_rad},
                          {"pitch_rad", view.camera->pitch_rad},
                          {"distance_mm", view.camera->distance_mm}};
  return json;
}

/// Path of the first text that is not UTF-8 or number that is not finite; empty: none.
std::string refusedValue(const Json &json, const std::string &place) {
  if (json.is_string() && !isUtf8(json.get_ref<const std::string &>())) return place + " is not UTF-8";
  if (json.is_number_float() && !std::isfinite(json.get<double>())) return place + " is not a finite number";
  if (json.is_structured())
    for (const auto &[key, value] : json.items())
      if (std::string found = refusedValue(value, place.empty() ? key : place + "." + key); !found.empty())
        return found;
  return {};
}

/// Before it is parsed: values that are nested very deeply are written and destroyed by recursion.
bool isNestedTooDeeply(std::string_view text) {
  int depth = 0;
  bool isInText = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (isInText && c == '\\') {
      ++i;
    } else if (c == '"') {
      isInText = !isInText;
    } else if (!isInText && (c == '[' || c == '{')) {
      if (++depth > kDeepest) return true;
    } else if (!isInText && (c == ']' || c == '}')) {
      --depth;
    }
  }
  return false;
}

/// Adds a key that this version does not know. False: it is no key of a session, or not unknown.
bool addUnknown(const std::string &pointer, const Json &value, const SessionFile &session, Json &json) {
  if (!pointer.starts_with('/')) return false;
  try {
    Pointer at(pointer);
    const std::string key = at.back();
    at.pop_back();
    Json *object = nullptr;
    const Pointer files = Pointer() / "files";
    if (at.empty() || at == Pointer() / "view" || at == Pointer() / "view" / "camera" ||
        at == Pointer() / "view" / "selection" || at == Pointer() / "view" / "comparison" ||
        at == Pointer() / "view" / "match") {
      // What they described is not in this session.
      if (!at.empty() && !json.contains(at)) return true;
      object = &json[at];
    } else if (at.parent_pointer() == files) {
      const std::string path = at.back();
      const auto file = std::find_if(session.files.begin(), session.files.end(),
                                     [&](const ReferencedFile &one) { return one.path == path; });
      if (file == session.files.end()) return true;
      object = &json["files"][static_cast<std::size_t>(file - session.files.begin())];
    }
    if (object == nullptr || object->contains(key)) return false;
    (*object)[key] = value;
    return true;
  } catch (const Json::exception &) {
    return false;
  }
}

}  // namespace

Expected<std::string> sessionJson(const SessionFile &session, const MemberNames &names) {
  Json json{{"format", kSessionFormat},
            {"program", session.program},
            {"saved_at", session.savedAt},
            {"title", session.title},
            {"simulator", session.simulatorClass},
            {"scenes", names.scenes},
            {"overrides", session.overrides},
            {"changes", changesJson(session, names)},
            {"view", viewJson(session.view)},
            {"steps", session.steps},
            {"time_s", session.time_s},
            {"members", names.all}};
  if (session.stateHash) json["state_hash"] = hashText(*session.stateHash);
  if (!names.state.empty()) json["state"] = names.state;
  Json &files = json["files"] = Json::array();
  std::set<std::string> paths;
  for (const ReferencedFile &file : session.files) {
    if (!isHexadecimal(file.sha256, kSha256Digits))
      return fail(ErrorCode::usage, fmt::format("the SHA-256 of {} is '{}'; accepted: {} digits 0 … 9, a … f",
                                                displayMessage(file.path), displayMessage(file.sha256), kSha256Digits));
    if (!paths.insert(file.path).second)
      return fail(ErrorCode::usage, fmt::format("the file {} occurs twice", displayMessage(file.path)));
    files.push_back(
        Json{{"path", file.path}, {"sha256", file.sha256}, {"bytes", file.bytes}, {"embedded", file.isEmbedded}});
  }
  for (const auto &[pointer, text] : session.unknown) {
    const Json value = isNestedTooDeeply(text) ? Json(Json::value_t::discarded) : Json::parse(text, nullptr, false);
    if (value.is_discarded() || !isUtf8(pointer) || !addUnknown(pointer, value, session, json))
      return fail(ErrorCode::usage, fmt::format("the unknown key '{}' cannot be saved: it is no JSON, or the name of a "
                                                "key that is known",
                                                displayMessage(pointer)));
  }
  if (const std::string refused = refusedValue(json, ""); !refused.empty())
    return fail(ErrorCode::usage, displayMessage(refused));
  return json.dump(2) + "\n";
}

Expected<ParsedSession> parseSessionJson(const std::string &text) {
  const auto refused = [](const std::string &why) { return fail(ErrorCode::input, why); };
  if (isNestedTooDeeply(text)) return refused(fmt::format("is nested more than {} times", kDeepest));
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return refused("is no JSON object");
  const auto format = json.find("format");
  if (format == json.end()) return refused("the key format is missing");
  if (!format->is_number_integer() || format->get<std::int64_t>() < 1)
    return refused(fmt::format("the key format is {}; accepted: a whole number, 1 or more", kindOf(*format)));
  if (format->get<std::int64_t>() > kSessionFormat)
    return refused(fmt::format("was saved by version {} of the format; this program reads up to {}",
                               format->get<std::int64_t>(), kSessionFormat));
  json.erase(format);

  ParsedSession out;
  std::string error;
  KeyReader reader(std::move(json), "", error);
  reader.text("program", out.session.program);
  reader.text("saved_at", out.session.savedAt);
  reader.text("title", out.session.title);
  reader.text("simulator", out.session.simulatorClass);
  reader.texts("scenes", out.names.scenes);
  reader.texts("overrides", out.session.overrides);
  readChanges(reader.list("changes"), out, error);
  readFiles(reader.list("files"), out, error);
  readView(reader.object("view"), out, error);
  reader.count("steps", out.session.steps);
  reader.number("time_s", out.session.time_s);
  std::string hash;
  reader.digits("state_hash", 16, hash);
  std::uint64_t number = 0;
  if (!hash.empty()) {
    std::from_chars(hash.data(), hash.data() + hash.size(), number, 16);
    out.session.stateHash = number;
  }
  reader.text("state", out.names.state);
  std::vector<std::string> members;
  reader.texts("members", members);
  out.names.all.insert(members.begin(), members.end());
  out.names.all.insert(out.names.scenes.begin(), out.names.scenes.end());
  out.names.all.insert(out.names.changes.begin(), out.names.changes.end());
  if (!out.names.state.empty()) out.names.all.insert(out.names.state);
  reader.keepRest(Pointer(), out.session.unknown);
  if (!error.empty()) return refused(error);
  return out;
}

}  // namespace c3de::session
