// SPDX-License-Identifier: Apache-2.0
// [match]: what was measured of a body.
#include <algorithm>

#include "scene_fields.h"

namespace c3de::scene {
namespace {

const char *const kSources =
    "one of surface = \"part.stl\", points = \"points.csv\", and labels = \"followup.nii.gz\" with label = 1";
const char *const kUses = "\"fit\" (they take part in the fit), \"judge\" (only their error is reported)";

struct FileReader {
  const char *accepted;
  bool operator()(SceneReader &reader, const std::string &key, const TomlValue &value,
                  std::filesystem::path &out) const {
    return reader.readFile(key, accepted, value, out);
  }
};

bool readUse(SceneReader &reader, const std::string &key, const TomlValue &value, bool &out) {
  std::string text;
  if (!reader.read(key, value, text)) return false;
  out = text == "fit";
  return out || text == "judge" || reader.refuse(value.line, key + " is \"" + text + "\"; accepted: " + kUses);
}
std::optional<TomlValue> writeUse(SceneWriter &writer, const std::string &key, bool fits) {
  return writer.write(key, std::string(fits ? "fit" : "judge"));
}

Expected<void> refused(const std::string &what) { return fail(ErrorCode::input, what); }

}  // namespace

const Fields<SceneMatch> kMatchFields{
    "[match]",
    "[match]",
    {{"body", &SceneMatch::body},
     {"surface", &SceneMatch::surface, FileReader{"a mesh file"}},
     {"points", &SceneMatch::points, FileReader{"a table of points, .csv, .fcsv or .mrk.json"}},
     {"labels", in(&SceneMatch::labels, &SceneVolume::file)},
     {"label", &SceneMatch::labels, Codec{&SceneReader::readLabelOf, &SceneWriter::labelOf}},
     {"time", in(&SceneMatch::labels, &SceneVolume::time)},
     {"unit", &SceneMatch::unit},
     {"landmarks", &SceneMatch::landmarks, FileReader{"a table of landmarks, .csv, .fcsv or .mrk.json"}},
     {"use", &SceneMatch::fitsLandmarks, Codec{&readUse, &writeUse}},
     {"weight", &SceneMatch::landmarkWeight,
      NumberReader{
          .accepted = "a number above 0: measured points that one landmark counts as", .low = 0.0, .isAbove = true}},
     {"rigid_first", &SceneMatch::isRigidFirst},
     {"deform", &SceneMatch::deforms},
     {"noise_mm", &SceneMatch::noise_mm, above0("mm")}}};

bool SceneReader::readMatch(const TomlValue &table) {
  if (table.kind != TomlValue::Kind::table)
    return refuse(table.line, "'match' is " + table.kindName() + "; accepted: a table, [match]");
  SceneMatch match;
  match.line = table.line;
  if (!readFields(kMatchFields, table, match)) return false;
  // These have no effect on their own, and a default would hide that they were written.
  if (match.landmarks.empty())
    for (const char *key : {"use", "weight"})
      if (const TomlValue *value = table.find(key); value != nullptr)
        return refuse(value->line, std::string("[match] has '") + key + "' and no 'landmarks'; accepted: both");
  if (const TomlValue *weight = table.find("weight"); weight != nullptr && !match.fitsLandmarks)
    return refuse(weight->line, "[match] has 'weight', and its landmarks only judge; accepted: with use = \"fit\"");
  if (const TomlValue *time = table.find("time"); time != nullptr && match.labels.file.empty())
    return refuse(time->line, "[match] has 'time' and no 'labels'; accepted: both");
  scene_.match = std::move(match);
  return true;
}

bool SceneReader::checkMatch() {
  if (!scene_.match) return true;
  const auto good = completeMatch(scene_, *scene_.match);
  return good || refuse(scene_.match->line, good.error().message);
}

bool SceneReader::overrideMatch(const std::string &key, const TomlValue &value) {
  SceneMatch match = scene_.match.value_or(SceneMatch{});
  // A source on the command line replaces that of the file.
  if (key == "surface" || key == "points" || key == "labels") {
    match.surface.clear();
    match.points.clear();
    if (key != "labels") match.labels = {};
  }
  if (!readField(kMatchFields, key, value, match)) return false;
  scene_.match = std::move(match);
  return true;
}

Expected<void> completeMatch(const SceneFile &scene, SceneMatch &match) {
  const bool isOfLabels = !match.labels.file.empty();
  const int sources = (match.surface.empty() ? 0 : 1) + (match.points.empty() ? 0 : 1) + (isOfLabels ? 1 : 0);
  if (sources != 1)
    return refused(std::string("[match] has ") + (sources == 0 ? "nothing that was measured" : "several sources") +
                   "; accepted: " + kSources);
  const bool hasLabel = match.labels.label || !match.labels.labelName.empty();
  if (isOfLabels && !hasLabel)
    return refused("[match] has 'labels' and no 'label'; accepted: the number or the name of a label");
  if (!isOfLabels && hasLabel)
    return refused(std::string("[match] has 'label' and no 'labels'; accepted: ") + kSources);
  if (isOfLabels && match.unit)
    return refused("[match] has 'unit', and images state theirs; accepted: with 'surface' or 'points'");
  if (!match.isRigidFirst && !match.deforms)
    return refused(
        "[match] has rigid_first = false and deform = false, so nothing is found; accepted: one of them true");
  const std::vector<std::string> names = referableNames(scene);
  if (match.body.empty() && names.size() == 1) match.body = names.front();
  if (match.body.empty())
    return refused("[match] has no 'body', and the scene has " + std::to_string(names.size()) +
                   "; accepted: " + joined(names));
  if (std::find(names.begin(), names.end(), match.body) == names.end())
    return refused("there is no body '" + match.body + "' for [match]; " + suggestion(match.body, names));
  return {};
}

}  // namespace c3de::scene
