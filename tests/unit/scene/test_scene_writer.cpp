// SPDX-License-Identifier: Apache-2.0
// Scenes as text: what is written is read as the same scene.
#include <cmath>
#include <limits>

#include "c3de/core/path_text.h"
#include "scene_difference.h"
#include "scene_fields.h"
#include "scene_text.h"

using namespace c3de;

namespace {

using scene::sceneText;

std::string written(const scene::SceneFile &scene) {
  const auto text = sceneText(scene, sceneFolder());
  INFO((text ? std::string() : text.error().message));
  REQUIRE(text.has_value());
  return *text;
}

scene::SceneFile read(const std::string &text) {
  auto scene = parse(text);
  INFO((scene ? text : scene.error().message + "\n" + text));
  REQUIRE(scene.has_value());
  return *scene;
}

/// The scene that its text is read as, which is the same one.
scene::SceneFile checkRoundTrip(const scene::SceneFile &scene) {
  const std::string text = written(scene);
  scene::SceneFile again = read(text);
  INFO(text);
  CHECK(difference(scene, again) == "");
  CHECK(written(again) == text);
  return again;
}

std::string refusal(const scene::SceneFile &scene) {
  const auto text = sceneText(scene, sceneFolder());
  if (text) return "not refused: " + *text;
  CHECK(text.error().code == ErrorCode::output);
  return text.error().message;
}

scene::SceneFile changed(const std::string &text, const std::vector<std::string> &assignments) {
  scene::SceneFile scene = read(text);
  for (const std::string &assignment : assignments) {
    const auto applied = scene::applyOverride(scene, assignment, &presets());
    INFO(assignment << ": " << (applied ? std::string() : applied.error().message));
    REQUIRE(applied.has_value());
  }
  return scene;
}

// Every key of every table at least once.
const std::string kEverything = R"(format = 1
title = "All \"keys\" of \\ a scene: Wärme, 肝臓\t."
[simulator]
class = "org.example.Sim/1"
[image]
file = "block.obj"
series = 4
time = 2
labels = "beam.obj"
warp = false
rim = 3
still = { labels = ["rib*", 5], above = 200, below = -400.5, outside = true }
[world]
gravity = [0, -9.81, 1e-7]
box = { min = [-1, -1, -1], max = [1, 1, 1], friction = 0.3 }
[solver]
dt = "auto"
steps = 9007199254740992
[view]
range = inf
[accuracy]
error_mm = 0.1
[contact]
self = false
friction = 0.2
[[contact.pair]]
bodies = ["scan", "mesh"]
friction = 0.05
[[contact.pair]]
bodies = ["box", "mesh"]
enabled = true
[[contact.pair]]
bodies = ["finger", "mesh"]
enabled = false
[[body]]
name = "mesh"
mesh = "beam.obj"
mesh_unit = "mm"
position = [1, 2, -0.0]
rotation_deg = [0, 90, 0.1]
scale = 2
material.preset = "liver"
material.law = "corotated"
material.plastic = { yield = 0.05, max = inf }
material.prony = [ { share = 0.3, time = 0.1 }, { share = 0.2, time = 2 } ]
sampling = { spacing = 0.01, refine = [
  { region = { sphere = { centre = [0, 0, 0], radius = 0.1 } }, spacing = 0.005 } ] }
parts = [
  { region = { box = { min = [0, 0, 0], max = [1, 1, 1] } }, material = "fat" },
  { region = { everywhere = true }, material = {} } ]
velocity = [1, 2, 3]
angular_velocity = [0, 0, 6.28]
rigid = true
free = false
[[body]]
name = "placed"
mesh = "model.glb"
matrix = [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]
[[body]]
name = "organ"
volume = "beam.obj"
series = "4#2"
time = 3
label = 7
mend = { opening = 1, closing = 2, largest = true, fill_holes = true }
edge_length = 4
region = { half_space = { point = [0, 0, 0], normal = [0, 2, 0] } }
[[body]]
name = "grey"
volume = "beam.obj"
threshold = [-inf, 300]
[[body]]
name = "named"
volume = "beam.obj"
label = 70000
[[body]]
name = "scan"
volume = "beam.obj"
tissues = [
  { label = "liver", material = { preset = "liver", youngs_modulus = 8e3 }, show = false },
  { label = ["kidney_left", 5, "a*", "b"], material = { density = 1 }, colour = [0.5, 0, 1] },
  { label = "rib*", rigid = true },
  { label = "air", empty = true },
  { name = "bone", image = "block.obj", threshold = [250, 3000], rigid = true, region = { everywhere = true } },
  { name = "capsule", margin = 2, material = "fat" } ]
background = { material = "fat", image = "beam.obj", from = -150, to = 250, series = 3, time = 2 }
slides = ["liver", ["spleen", "colon"]]
slide_friction = 0.5
[[fix]]
name = "grip"
body = "mesh"
region = { box = { min = [0, 0, 0], max = [0, 1, 1] } }
displacement = [0, 0, 0.01]
rotation_deg = [0, 90, 0]
centre = [0.1, 0.2, 0.3]
ramp = 0.25
[[fix]]
body = "scan.liver"
region = { everywhere = true }
quaternion = [0.1, 0.2, 0.3, 0.92736]
[[load]]
name = "press"
body = "mesh"
region = { everywhere = true }
pressure = -5.5
follower = false
ramp = 1
[[load]]
body = "mesh"
region = { everywhere = true }
force = [0, 0, 0]
[[obstacle]]
name = "table"
mesh = "block.obj"
mesh_unit = "cm"
position = [0, 0, 1]
rotation_deg = [0, 0, 30]
scale = 3
friction = 0.3
restitution = 1
displacement = [0, 0, -0.5]
motion_rotation_deg = [0, 45, 0]
centre = [1, 1, 1]
ramp = 2
[[obstacle]]
name = "turned"
mesh = "block.obj"
mesh_unit = "cm"
matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
motion_quaternion = [0, 0, 0.6, 0.8]
[[obstacle]]
name = "held"
mesh = "block.obj"
mesh_unit = "cm"
displacement = [0, 0, 0]
[[probe]]
name = "tip"
body = "mesh"
at = [0.2, 0.02, 0.02]
[[landmark]]
name = "apex"
on = "scan.liver"
at = [0.1, 0.02, 0.3]
target = [0.1, 0.02, 0.29]
[[landmark]]
name = "base"
at = [-0.0, 1e-3, 0.3333333333333333]
[[landmark]]
name = "side"
at = [1, 2, 3]
[[distance]]
between = ["apex", "base"]
[[distance]]
name = "width"
between = ["base", "side"]
[[angle]]
name = "tilt"
at = ["apex", "base", "side"]
[[attachment]]
bodies = ["organ", "surroundings"]
stiffness = 10000
tangential = 2e4
retardation_time = 0.02
[[attachment]]
bodies = ["scan.spleen", "surroundings"]
stiffness = 5
[[attachment]]
bodies = ["scan.rest", "surroundings"]
stiffness = 6
[[attachment]]
name = "foot"
bodies = ["mesh", "table"]
within_mm = 3.3
region = { everywhere = true }
stiffness = 1e4
tangential = 0
tears_at = 2e3
[[probe_tool]]
name = "finger"
radius_mm = 6.1
length_mm = 29.7
friction = 0.1
path = [ { time = 0, at = [0, 1, 0], axis = [1, 0, 0] }, { time = 1, at = [0, 1, 0] } ]
[[grasp]]
name = "tongs"
body = "mesh"
at = [0, 1, 0]
axis = [2, 0, 0]
jaw_mm = 8.3
opening_mm = 24.7
closed_mm = 0
force_limit = 0.5
path = [ { time = 0.3, at = [0, 1, 0] }, { time = 1, at = [0, 1.1, 0], turn_deg = [0, 0, 30] } ]
)";

// The tables that a value is or lists.
std::vector<scene::TomlValue> tablesOf(const scene::TomlValue *value) {
  if (value == nullptr) return {};
  return value->kind == scene::TomlValue::Kind::array ? value->items : std::vector<scene::TomlValue>{*value};
}

// Those under a key of each table.
std::vector<scene::TomlValue> tablesUnder(const std::vector<scene::TomlValue> &tables, const std::string &key) {
  std::vector<scene::TomlValue> all;
  for (const scene::TomlValue &table : tables)
    for (scene::TomlValue &one : tablesOf(table.find(key))) all.push_back(std::move(one));
  return all;
}

template <class Table>
std::vector<std::string> missingKeys(const scene::Fields<Table> &fields, const std::vector<scene::TomlValue> &tables) {
  std::vector<std::string> missing;
  for (const auto &field : fields.fields)
    if (std::none_of(tables.begin(), tables.end(), [&](const auto &table) { return table.find(field.key); }))
      missing.push_back(fields.place + " " + field.key);
  return missing;
}

imaging::Mask smallMask() {
  imaging::Mask mask;
  mask.geometry.size = {1, 1, 1};
  mask.voxels = {1};
  return mask;
}

}  // namespace

TEST_CASE("A scene with every key is written and read as the same scene", "[writer]") {
  const scene::SceneFile scene = read(kEverything);
  checkRoundTrip(scene);
}

TEST_CASE("Each key of each table of the scene is written", "[writer]") {
  // A key that has been added to a table has to be added to kEverything.
  const auto root = scene::parseToml(written(read(kEverything)), "text");
  REQUIRE(root.has_value());
  const std::vector<std::string> none;
  (void)scene::anyTable([&](const auto &table) {
    const std::size_t dot = table.key.find('.');
    std::vector<scene::TomlValue> tables = tablesOf(root->find(table.key.substr(0, dot)));
    if (dot != std::string::npos) tables = tablesUnder(tables, table.key.substr(dot + 1));
    CHECK(missingKeys(table, tables) == none);
    return false;
  });
  const std::vector<scene::TomlValue> bodies = tablesOf(root->find("body")), image = tablesOf(root->find("image"));
  CHECK(missingKeys(scene::kTissueFields, tablesUnder(bodies, "tissues")) == none);
  CHECK(missingKeys(scene::kBackgroundFields, tablesUnder(bodies, "background")) == none);
  CHECK(missingKeys(scene::kMendFields, tablesUnder(bodies, "mend")) == none);
  CHECK(missingKeys(scene::kImageFields, image) == none);
  CHECK(missingKeys(scene::kFixedRegionFields, tablesUnder(image, "still")) == none);
  CHECK(missingKeys(scene::kToolWaypointFields, tablesUnder(tablesOf(root->find("probe_tool")), "path")) == none);
  CHECK(missingKeys(scene::kGraspWaypointFields, tablesUnder(tablesOf(root->find("grasp")), "path")) == none);
}

TEST_CASE("A key is read as what it was written", "[writer]") {
  // Of each element of each table, key by key: what the reader and the writer of a key do is inverse.
  const scene::SceneFile scene = read(kEverything);
  (void)scene::anyTable([&](const auto &table) {
    for (const auto &element : scene.*table.list)
      for (const auto &field : table.fields) {
        scene::SceneWriter writer(sceneFolder(), {});
        const auto value = field.write(writer, field.key, element);
        if (!value) continue;
        scene::SceneFile file;
        file.source = sceneFolder() / "test.toml";
        scene::SceneReader reader(file, &presets());
        std::remove_cvref_t<decltype(element)> again;
        CAPTURE(table.key, field.key);
        const bool isRead = field.read(reader, field.key, *value, again);
        INFO(reader.error().message);
        REQUIRE(isRead);
        if (field.key == "tissues") continue;  // their parts exist once the whole body has been read
        const auto rewritten = field.write(writer, field.key, again);
        REQUIRE(rewritten.has_value());
        CHECK(scene::areEqual(*value, *rewritten));
      }
    return false;
  });
}

TEST_CASE("The scenes of the program are written and read as the same scenes", "[writer]") {
  std::size_t count = 0;
  for (const auto &entry :
       std::filesystem::directory_iterator(std::filesystem::path(testResourcesFolder()) / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    CAPTURE(entry.path().string());
    const auto scene = scene::loadScene(entry.path(), &presets());
    // Some name images that a computer may not have.
    if (!scene && scene.error().message.find("does not exist") != std::string::npos) continue;
    REQUIRE(scene.has_value());
    const auto text = sceneText(*scene, entry.path().parent_path());
    INFO((text ? *text : text.error().message));
    REQUIRE(text.has_value());
    const auto again = scene::parseScene(*text, entry.path(), &presets());
    REQUIRE(again.has_value());
    CHECK(difference(*scene, *again) == "");
    CHECK(sceneText(*again, entry.path().parent_path()).value() == *text);
    ++count;
  }
  CHECK(count >= 4);
}

TEST_CASE("Bodies whose tissues wait for their map are written", "[writer][tissues]") {
  for (const char *tissues :
       {"\"known\"", "[ { label = \"Left Kidney\" }, { label = \"rib*\" } ]", "[ { label = 3 } ]",
        "[ { label = 1, material = \"liver\" }, { label = \"tumour\", material = \"spleen\" } ]"}) {
    CAPTURE(tissues);
    checkRoundTrip(read("format = 1\n[[body]]\nname = \"scan\"\nvolume = \"beam.obj\"\ntissues = " +
                        std::string(tissues) + "\nslides = [\"liver\", 5]\n"));
  }
}

TEST_CASE("What stays in an image is written", "[writer]") {
  for (const char *still : {"\"auto\"", "\"nothing\"", "\"outside\"", "{ above = 200 }", "{ outside = true }"})
    checkRoundTrip(read(kMinimal + "[image]\nfile = \"beam.obj\"\nstill = " + still + "\n"));
}

TEST_CASE("What the command line has set is written as if the file had it", "[writer]") {
  const std::vector<std::string> assignments{"title=Other",
                                             "simulator.class=org.example.Other/1",
                                             "solver.dt=1e-3",
                                             "accuracy.error_percent=2",
                                             "body.mesh.material.youngs_modulus=6e3",
                                             "body.mesh.material.prony3.share=0.1",
                                             "body.organ.surroundings.stiffness=3e5",
                                             "body.organ.threshold=[1,2]",
                                             "body.mesh.parts.0.material.density=3",
                                             "body.scan.parts.1.material.density=900",
                                             "fix.0.displacement=[0,0,0.02]",
                                             "load.press.force=[0,0,1]",
                                             "attachment.foot.within_mm=0.7",
                                             "contact.pair.0.friction=0.1",
                                             "grasp.tongs.opening_mm=30.3"};
  scene::SceneFile scene = changed(kEverything, assignments);
  const scene::SceneFile again = read(written(scene));
  // The material of a tissue is what has been set for its part.
  scene.bodies.back().volume.tissues[1].params = scene.bodies.back().parts[1].params;
  CHECK(difference(scene, again) == "");
  CHECK(findValue(again.bodies.front().params, "material.youngs_modulus")->overridePath.empty());
}

TEST_CASE("What an override has replaced is not written", "[writer]") {
  scene::SceneFile scene = changed(kEverything, {"body.mesh.sampling.count=500",
                                                 "body.mesh.matrix=[[1,0,0,1],[0,1,0,2],"
                                                 "[0,0,1,3],[0,0,0,1]]",
                                                 "fix.grip.quaternion=[0,0,0,1]", "obstacle.turned.ramp=3"});
  scene::SceneFile again = read(written(scene));
  const scene::SceneBody &body = again.bodies.front();
  CHECK(findValue(body.params, "sampling.spacing") == nullptr);
  CHECK(findValue(body.params, "sampling.count")->value.num == 500.0);
  CHECK(body.placement.matrix == scene.bodies.front().placement.matrix);
  CHECK(body.placement.scale == 1.0);
  CHECK(again.fixes[0].motion.rotation_deg == Vec3{});
  CHECK(again.obstacles[1].motion->ramp_s == 3.0);
}

TEST_CASE("Numbers are written exactly", "[writer]") {
  const double least = std::numeric_limits<double>::denorm_min(), most = std::numeric_limits<double>::max();
  scene::SceneFile scene = read(kMinimal);
  const std::vector<double> numbers{0.1, 1e-7, least, -0.0, 0.0, 1.0, most, -most, 1.0 / 3.0, 1e16, 9007199254740993.0};
  for (std::size_t i = 0; i < numbers.size(); ++i)
    for (const bool isWhole : {false, true}) {
      if (isWhole && (numbers[i] != std::floor(numbers[i]) || std::abs(numbers[i]) > 1e18)) continue;
      scene::SceneValue value;
      value.value.id = (isWhole ? "solver.i" : "solver.x") + std::to_string(i);
      value.value.type = isWhole ? C3DE_PARAM_I64 : C3DE_PARAM_F64;
      value.value.num = isWhole ? numbers[i] + 0.0 : numbers[i];
      scene.world.push_back(value);
    }
  for (const double number : {HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    scene::SceneValue value;
    value.value.id = "view.y" + std::to_string(scene.world.size());
    value.value.num = number;
    scene.world.push_back(value);
  }
  scene.bodies[0].placement.position_m = {0.1, least, 1e-7};
  checkRoundTrip(scene);
}

TEST_CASE("Lengths that a scene says in mm are read as they were", "[writer]") {
  for (const double mm : {6.0, 0.1, 6.1, 3.3, 29.7, 1e-7, 12345.678, 1.0 / 3.0}) {
    scene::SceneFile scene =
        read(kMinimal + "[[grasp]]\nat = [0, 1, 0]\naxis = [1, 0, 0]\njaw_mm = " + formatNumber(mm) + "\n");
    const scene::SceneFile again = checkRoundTrip(scene);
    CHECK(again.grasps[0].jaw_m == 1e-3 * mm);
    CHECK_THAT(written(scene), Contains("jaw_mm = " + formatNumber(mm)));
  }
}

TEST_CASE("Names keep quotes, backslashes and letters of all languages", "[writer]") {
  for (const std::string name :
       {"it's \"quoted\"", "back\\slash\\", "Größe 肝臓 🫀", "a.b.c", "# = [x]", "'''"}) {
    scene::SceneFile scene = read(kMinimal + "[[fix]]\nregion = { everywhere = true }\n");
    scene.title = name + "\n\r\t\x7f\x01";
    scene.bodies[0].name = scene.fixes[0].body = scene.fixes[0].name = name;
    checkRoundTrip(scene);
  }
  scene::SceneFile scene = read(kMinimal);
  scene.bodies[0].name = "bad \xff";
  CHECK_THAT(refusal(scene), Contains("is not UTF-8"));
  scene.bodies[0].name = "two\nlines";
  CHECK_THAT(refusal(scene), Contains("on one line"));
  scene.bodies[0].name = "";
  CHECK_THAT(refusal(scene), Contains("no name"));
  scene.bodies[0].name = std::string(5000, 'x');
  CHECK_THAT(refusal(scene), Contains("bytes; accepted"));
}

TEST_CASE("Keys with dots, spaces and quotes come back", "[writer]") {
  checkRoundTrip(read(kMinimal + "material = { \"a b\" = 1, \"c.d\" = 2, \"e\\\"f\" = { 3 = 4 }, term1 = { x = 1 }, "
                                 "term7 = 3, list2 = { x = 1 }, more10 = { x = 1 } }\n"));
}

TEST_CASE("Long tables, lists and texts are written", "[writer]") {
  std::string labels, values;
  for (int i = 0; i < 300; ++i) {
    labels += (i == 0 ? "\"" : ",\n\"") + std::string("a label with a long name ") + std::to_string(i) + "\"";
    values += "v" + std::to_string(i) + "x = 0." + std::to_string(i + 1) + "\n";
  }
  const scene::SceneFile scene = read(
      "format = 1\n[[body]]\nname = \"scan\"\nvolume = \"beam.obj\"\n[[body.tissues]]\n"
      "label = [" +
      labels + "]\nmaterial = \"fat\"\n[solver]\n" + values);
  CHECK(scene.bodies[0].volume.tissues[0].wanted.size() == 300);
  checkRoundTrip(scene);
  checkRoundTrip(read(kMinimal + "[body.material]\n" + values));
}

TEST_CASE("Files below the folder are written relative to it", "[writer]") {
  const std::filesystem::path folder = sceneFolder() / "a folder" / "Größe";
  std::filesystem::create_directories(folder);
  std::filesystem::remove(folder / "my beam.obj");
  std::filesystem::copy_file(sceneFolder() / "beam.obj", folder / "my beam.obj");
  const scene::SceneFile scene = read(
      "format = 1\n[[body]]\nmesh = \"a folder/Größe/my beam.obj\"\nmesh_unit = \"m\"\n[image]\nfile = "
      "\"block.obj\"\n");
  CHECK_THAT(written(scene), Contains("mesh = \"a folder/Größe/my beam.obj\"") && Contains("file = \"block.obj\""));
  checkRoundTrip(scene);
  const auto text = sceneText(scene, folder / "");
  REQUIRE(text.has_value());
  const std::string image =
      pathText((std::filesystem::absolute(sceneFolder()) / "block.obj").lexically_normal().generic_string());
  CHECK_THAT(*text, Contains("mesh = \"my beam.obj\"") && Contains("file = \"" + image + "\""));
  const auto again = scene::parseScene(*text, folder / "x.toml", &presets());
  REQUIRE(again.has_value());
  CHECK(std::filesystem::equivalent(again->bodies[0].mesh, scene.bodies[0].mesh));
  CHECK(std::filesystem::equivalent(again->image->file, scene.image->file));
}

TEST_CASE("A scene of a mesh or of a mask in memory is written", "[writer]") {
  scene::SceneFile mesh = scene::sceneForMesh(sceneFolder() / "beam.obj", geometry::LengthUnit::centimetre);
  mesh.title = "beam";
  checkRoundTrip(mesh);

  scene::SceneFile scene;
  scene.title = "liver";
  CHECK_THAT(refusal(scene), Contains("it has no body"));
  scene::SceneBody body;
  body.name = "liver";
  body.volume.mask = std::make_shared<const imaging::Mask>(smallMask());
  body.volume.colour = std::array<float, 3>{1.0f, 0.5f, 0.0f};
  body.volume.edgeLength_mm = 3.5;
  scene.bodies.push_back(body);
  CHECK_THAT(refusal(scene), Contains("body 'liver': its voxels are in memory only"));
  const auto text =
      sceneText(scene, sceneFolder(), [](const scene::SceneBody &of) { return of.name == "liver" ? "block.obj" : ""; });
  REQUIRE(text.has_value());
  scene::SceneFile again = read(*text);
  CHECK(again.bodies[0].volume.file.filename() == "block.obj");
  CHECK(again.bodies[0].volume.label == 1);
  again.bodies[0].volume.file.clear();
  again.bodies[0].volume.label.reset();
  again.bodies[0].meshUnit = body.meshUnit;
  scene.bodies[0].volume.mask.reset();
  scene.bodies[0].volume.colour.reset();
  CHECK(difference(scene, again) == "");
}

TEST_CASE("What a scene file cannot contain is refused by name", "[writer]") {
  const auto refused = [](const std::vector<std::string> &assignments) {
    return refusal(changed(kEverything, assignments));
  };
  CHECK_THAT(refused({"body.scan.liver.material.density=3"}),
             Contains("piece 'scan.liver': 'material.density' cannot be written"));
  CHECK_THAT(refused({"body.scan.rest.velocity=[0,0,1]"}), Contains("piece 'scan.rest': its velocity"));
  CHECK_THAT(refused({"body.mesh.surroundings.tangential=3"}),
             Contains("body 'mesh': 'surroundings.tangential' without a stiffness"));
  CHECK_THAT(refused({"body.mesh.surroundings.stiffness=-3"}), Contains("stiffness is -3; accepted: "));
  CHECK_THAT(refused({"body.mesh.surroundings.colour=3"}), Contains("'surroundings.colour' is no value"));
  CHECK_THAT(refused({"body.mesh.material.law.x=3"}), Contains("'material.law.x' is a value and a table"));
  CHECK_THAT(refused({"body.mesh.material.optional.x=3"}), Contains("'material.optional.x' is no value"));
  CHECK_THAT(refused({"contact.pair=3"}), Contains("'contact.pair' is no value of a scene"));
  const std::string open = "format = 1\n[[body]]\nname = \"scan\"\nvolume = \"beam.obj\"\ntissues = ";
  CHECK_THAT(refusal(changed(open + "\"known\"\n", {"body.scan.parts.3.material.density=9"})),
             Contains("body 'scan': 'body.scan.parts.3.material.density=9' is for a part"));
  CHECK_THAT(refusal(changed(open + "\"known\"\n", {"body.scan.material.density=9"})),
             Contains("'material.density', is not that of the first tissue"));
  CHECK_THAT(
      refusal(changed(open + "[ { label = 1, material = \"fat\" } ]\n", {"body.scan.parts.0.material.density=9"})),
      Contains("is not that of the first tissue"));

  const auto with = [](const auto &change) {
    scene::SceneFile scene = read(kEverything);
    change(scene);
    return refusal(scene);
  };
  CHECK_THAT(with([](scene::SceneFile &s) { s.bodies.back().volume.isSettled = true; }),
             Contains("body 'scan': its label map has been resolved"));
  CHECK_THAT(with([](scene::SceneFile &s) {
               s.bodies.back().volume.ruled = std::make_shared<const std::vector<imaging::LabelMap>>();
             }),
             Contains("body 'scan': the rules of its tissues have been applied"));
  CHECK_THAT(
      with([](scene::SceneFile &s) { s.bodies[2].volume.cut = std::make_shared<const scene::SceneBodyPieces>(); }),
      Contains("body 'organ': it is a piece of a body that has been cut"));
  CHECK_THAT(with([](scene::SceneFile &s) { s.contactPairs[1].fits = true; }), Contains("pair 1: it is of pieces"));
  CHECK_THAT(with([](scene::SceneFile &s) { s.fixes[0].region.kind = scene::SceneRegion::Kind::voxels; }),
             Contains("fix 'grip': region are voxels"));
  CHECK_THAT(with([](scene::SceneFile &s) { s.fixes[0].motion.displacement_m[1] = HUGE_VAL; }),
             Contains("fix 'grip': displacement: inf is not accepted"));
  CHECK_THAT(with([](scene::SceneFile &s) { s.probeTools[0].friction = 11.0; }),
             Contains("probe tool 'finger': friction is 11; accepted: a number from 0 to 10"));
  CHECK_THAT(with([](scene::SceneFile &s) {
               s.attachments[0].names[1] = scene::kSurroundingsName;
               s.attachments[0].region.reset();
               s.attachments[0].tearsAt_Pa = 0.0;
             }),
             Contains("attachment 'foot': it is of all of the surface"));
  CHECK_THAT(with([](scene::SceneFile &s) { s.image->labels.resize(2); }), Contains("[image]: it has 2 label maps"));
  CHECK_THAT(with([](scene::SceneFile &s) { s.world[0].value.id = "wrld.x"; }), Contains("'wrld.x' is no value"));
  CHECK_THAT(with([](scene::SceneFile &s) { s.bodies[0].params[0].value.id = "mesh.x"; }),
             Contains("'mesh.x' is no value of a body"));
}

TEST_CASE("Optional values of a material are read as optional, and only as a table", "[writer]") {
  const scene::SceneFile scene =
      read(kMinimal + "material = { density = 1, optional = { youngs_modulus_low = 2.5 } }\n");
  const auto *low = findValue(scene.bodies[0].params, "material.youngs_modulus_low");
  REQUIRE(low != nullptr);
  CHECK(low->isOptional);
  CHECK_FALSE(findValue(scene.bodies[0].params, "material.density")->isOptional);
  CHECK_THAT(errorOf(kMinimal + "material = { optional = 3 }\n"), Contains("material.optional is a whole number"));
}
