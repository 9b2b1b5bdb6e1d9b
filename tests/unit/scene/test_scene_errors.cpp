// SPDX-License-Identifier: Apache-2.0
#include "scene_text.h"

#include <set>

using namespace c3de;

namespace {

struct Refused {
  const char *what;  ///< name of the case
  std::string text;
  const char *line;      ///< ":LINE: "
  const char *contains;  ///< the wrong value or name
  const char *accepted;  ///< the accepted alternatives
};

const std::string kFix = kMinimal + "[[fix]]\nregion = { everywhere = true }\n";
const std::string kLoad = kMinimal + "[[load]]\nregion = { everywhere = true }\n";
const std::string kVolume = "format = 1\n[[body]]\nvolume = \".\"\n";

}  // namespace

TEST_CASE("Every mistake in a scene is refused with file, line, what is wrong and what is accepted") {
  const std::vector<Refused> cases{
      {"not TOML", "format = 1\ntitle = \n", ":2: ", "not valid TOML", ""},
      {"a key twice", "format = 1\nformat = 1\n", ":2: ", "not valid TOML", ""},
      {"no format", "title = \"x\"\n", ":1: ", "'format' is missing", "format = 1"},
      {"a format of the future", "format = 2\n", ":1: ", "format is 2", "accepted: 1"},
      {"a format that is text", "format = \"1\"\n", ":1: ", "the text \"1\"", "accepted: 1"},
      {"an unknown top key", "format = 1\ngravitee = 1\n", ":2: ", "unknown key 'gravitee'", "world"},
      {"a misspelt table", "format = 1\n[wrld]\ngravity = [0,0,0]\n", ":2: ", "unknown key 'wrld'",
       "did you mean 'world'?"},
      {"world as a number", "format = 1\nworld = 3\n", ":2: ", "a whole number", "[world]"},
      {"body as a table", "format = 1\n[body]\nmesh = \"beam.obj\"\n", ":2: ", "'body' is a table", "[[body]]"},
      {"no body", "format = 1\n", ":1: ", "no [[body]]", "at least one"},
      {"title as a number", "format = 1\ntitle = 3\n", ":2: ", "title is a whole number", "text in quotes"},
      {"an unknown body key", kMinimal + "scael = 2\n", ":5: ", "unknown key 'scael'", "did you mean 'scale'?"},
      {"no mesh", "format = 1\n[[body]]\nname = \"a\"\n", ":2: ", "no 'mesh'", "a mesh file"},
      {"a mesh that is not there", "format = 1\n[[body]]\nmesh = \"gone.obj\"\nmesh_unit = \"m\"\n", ":3: ", "gone.obj",
       "looked for at"},
      {"no unit", "format = 1\n[[body]]\nmesh = \"beam.obj\"\n", ":2: ", "'mesh_unit' is missing", "\"mm\""},
      {"an unknown unit", "format = 1\n[[body]]\nmesh = \"beam.obj\"\nmesh_unit = \"inch\"\n", ":4: ", "inch",
       "\"cm\""},
      {"a position with two numbers", kMinimal + "position = [1, 2]\n", ":5: ", "position is [1, 2]", "[x, y, z]"},
      {"a position with text", kMinimal + "position = [1, 2, \"3\"]\n", ":5: ", "position is [1, 2, \"3\"]",
       "[x, y, z]"},
      {"a vector with text among its numbers", kMinimal + "velocity = [0, \"abc\", 0]\n",
       ":5: ", "velocity is [0, \"abc\", 0]", "three numbers"},
      {"a vector of a material with text", kMinimal + "material = { density = [0, \"abc\", true] }\n",
       ":5: ", "is [0, \"abc\", true]", "a number"},
      {"a gravity with text", kMinimal + "[world]\ngravity = [0, \"abc\", 0]\n",
       ":6: ", "world.gravity is [0, \"abc\", 0]", "[x, y, z]"},
      {"a vector that is a long list",
       kMinimal + "position = [100000, 200000, 300000, 400000, 500000, 600000, 700000, 800000, 900000, 1000000]\n",
       ":5: ", "…], a list of 10", "[x, y, z]"},
      {"a vector of lists", kMinimal + "position = [[1], { a = 1 }, 3]\n", ":5: ", "position is [[1], { … }, 3]",
       "[x, y, z]"},
      {"a mesh that is a folder", "format = 1\n[[body]]\nmesh = \".\"\nmesh_unit = \"m\"\n",
       ":3: ", "mesh '.' is a folder", "a mesh file"},
      {"an image without a name", kMinimal + "[image]\nfile = \"\"\n", ":6: ", "file is empty", "an image file"},
      {"a threshold that is no number", kVolume + "threshold = [nan, 3]\n", ":4: ", "threshold is [nan, 3]",
       "two numbers"},
      {"a label without a name", kVolume + "label = \"\"\n", ":4: ", "label is empty", "the name of a label"},
      {"an infinite position", kMinimal + "position = [1, 2, inf]\n", ":5: ", "inf", "finite"},
      {"a scale of zero", kMinimal + "scale = 0\n", ":5: ", "scale is 0", "above 0"},
      {"a scale that is no number", kMinimal + "scale = nan\n", ":5: ", "scale", "above 0"},
      {"a scale as text", kMinimal + "scale = \"2\"\n", ":5: ", "the text \"2\"", "a number"},
      {"an unknown preset", kMinimal + "material = \"livr\"\n", ":5: ", "no material 'livr'", "did you mean 'liver'?"},
      {"a material as a number", kMinimal + "material = 3\n", ":5: ", "material is a whole number", "preset"},
      {"a material value of the wrong shape", kMinimal + "material = { density = [1, 2] }\n",
       ":5: ", "material.density", "a number"},
      {"sampling as a number", kMinimal + "sampling = 3\n", ":5: ", "sampling is", "spacing"},
      {"two bodies of one name",
       "format = 1\n[[body]]\nname = \"a\"\nmesh = \"beam.obj\"\nmesh_unit = \"m\"\n"
       "[[body]]\nname = \"a\"\nmesh = \"beam.obj\"\nmesh_unit = \"m\"\n",
       ":6: ", "second body is named 'a'", "differ"},
      {"a probe of no body", kMinimal + "[[probe]]\nbody = \"baem\"\nat = [0, 0, 0]\n", ":5: ", "no body 'baem'",
       "did you mean 'beam'?"},
      {"a probe without a place", kMinimal + "[[probe]]\nname = \"a\"\n", ":5: ", "no 'at'", "[x, y, z]"},
      {"an unknown probe key", kMinimal + "[[probe]]\nat = [0, 0, 0]\nbdy = \"beam\"\n", ":7: ", "unknown key 'bdy'",
       "did you mean 'body'?"},
      {"an unknown obstacle key", kMinimal + "[[obstacle]]\nmesh = \"block.obj\"\nmesh_unit = \"m\"\nfrction = 1\n",
       ":8: ", "unknown key 'frction'", "did you mean 'friction'?"},
      {"a box without max", "format = 1\n[world]\nbox = { min = [0, 0, 0] }\n" + kMinimal.substr(11),
       ":3: ", "no 'max'", "min = [x, y, z]"},
      {"a box without room", "format = 1\n[world]\nbox = { min = [0, 2, 0], max = [1, 1, 1] }\n" + kMinimal.substr(11),
       ":3: ", "enclose no space", "below max"},
      {"a box as a number", "format = 1\n[world]\nbox = 3\n", ":3: ", "world.box is", "min = [x, y, z]"},
      {"an empty table", kMinimal + "material = { plastic = {} }\n", ":5: ", "material.plastic is an empty table",
       "the keys of material.plastic"},
      {"a velocity that is a number", kMinimal + "velocity = 3\n", ":5: ", "velocity is a whole number", "[x, y, z]"},
      {"parts as a table", kMinimal + "parts = { region = { everywhere = true } }\n", ":5: ", "parts is a table",
       "material"},
      {"a part without material", kMinimal + "[[body.parts]]\nregion = { everywhere = true }\n",
       ":5: ", "no 'material'", "region"},
      {"a part without region", kMinimal + "parts = [ { material = \"fat\" } ]\n", ":5: ", "no 'region'", "material"},
      {"an unknown preset of a part",
       kMinimal + "parts = [ { region = { everywhere = true }, material = \"livr\" } ]\n", ":5: ", "no material 'livr'",
       "did you mean 'liver'?"},
      {"an unknown key of a part",
       kMinimal + "parts = [ { region = { everywhere = true }, material = \"fat\", densty = 1 } ]\n",
       ":5: ", "unknown key 'densty'", "region, material"},
      {"refinement without spacing", kMinimal + "sampling = { refine = [ { region = { everywhere = true } } ] }\n",
       ":5: ", "no 'spacing'", "region"},
      {"refinement to nothing",
       kMinimal + "sampling = { refine = [ { region = { everywhere = true }, spacing = 0 } ] }\n",
       ":5: ", "spacing is 0", "above 0"},
      {"refinement as a number", kMinimal + "sampling = { refine = 3 }\n", ":5: ", "sampling.refine is", "region"},
      {"an obstacle with a ramp and no motion",
       kMinimal + "[[obstacle]]\nmesh = \"block.obj\"\nmesh_unit = \"m\"\nrotation_deg = [0, 0, 9]\nramp = 1\n",
       ":5: ", "nothing that moves it", "motion_rotation_deg"},
      {"an obstacle with a ramp below zero",
       kMinimal + "[[obstacle]]\nmesh = \"block.obj\"\nmesh_unit = \"m\"\ndisplacement = [0, 0, 1]\nramp = -1\n",
       ":9: ", "ramp is -1", "at least 0"},
      {"fix as a table", kMinimal + "[fix]\nbody = \"beam\"\n", ":5: ", "'fix' is a table", "[[fix]]"},
      {"a fix without region", kMinimal + "[[fix]]\nbody = \"beam\"\n", ":5: ", "no 'region'", "everywhere = true"},
      {"a fix of no body", kFix + "body = \"baem\"\n", ":5: ", "no body 'baem'", "did you mean 'beam'?"},
      {"a misspelt key of a fix", kFix + "displacment = [0, 0, 1]\n", ":7: ", "unknown key 'displacment'",
       "did you mean 'displacement'?"},
      {"a fix with a force", kFix + "force = [0, 0, 1]\n", ":7: ", "unknown key 'force' in [[fix]]", "displacement"},
      {"a displacement that is a number", kFix + "displacement = 1\n", ":7: ", "displacement is", "[x, y, z]"},
      {"a ramp that is text", kFix + "ramp = \"1\"\n", ":7: ", "ramp is the text", "at least 0"},
      {"a ramp that never ends", kFix + "ramp = inf\n", ":7: ", "ramp is inf", "at least 0"},
      {"a name without characters", kFix + "name = \"\"\n", ":7: ", "name is", "at least one character"},
      {"two fixes of one name", kFix + "name = \"a\"\n[[fix]]\nname = \"a\"\nregion = { everywhere = true }\n",
       ":8: ", "second fix is named 'a'", "differ"},
      {"a load without region", kMinimal + "[[load]]\nforce = [0, 0, 1]\n", ":5: ", "no 'region'", "half_space"},
      {"a load of nothing", kLoad, ":5: ", "no 'force' and no 'pressure'", "one of"},
      {"a load of two kinds", kLoad + "force = [0, 0, 1]\npressure = 3\n", ":5: ", "'force' and 'pressure'", "one of"},
      {"a force that is a number", kLoad + "force = 1\n", ":7: ", "force is", "[x, y, z]"},
      {"a pressure that is a vector", kLoad + "pressure = [0, 0, 1]\n", ":7: ", "pressure is [0, 0, 1]",
       "a number, Pa"},
      {"an infinite pressure", kLoad + "pressure = inf\n", ":7: ", "pressure is inf", "a number, Pa"},
      {"a follower force", kLoad + "force = [0, 0, 1]\nfollower = false\n", ":8: ", "follower is for a pressure",
       "no 'follower'"},
      {"follower as a number", kLoad + "pressure = 1\nfollower = 1\n", ":8: ", "follower is", "true, false"},
      {"a misspelt key of a load", kLoad + "presure = 1\n", ":7: ", "unknown key 'presure'",
       "did you mean 'pressure'?"},
      {"a negative ramp of a load", kLoad + "pressure = 1\nramp = -0.5\n", ":8: ", "ramp is -0.5", "at least 0"},
      {"a load of one body of two",
       kMinimal + "[[load]]\nregion = { everywhere = true }\npressure = 1\n"
                  "[[body]]\nname = \"two\"\nmesh = \"beam.obj\"\nmesh_unit = \"m\"\n",
       ":5: ", "the load has no 'body'", "beam, two"},
      {"a region as text", kMinimal + "[[fix]]\nregion = \"left\"\n", ":6: ", "region is the text", "sphere = "},
      {"an empty region", kMinimal + "[[fix]]\nregion = {}\n", ":6: ", "a table with 0 keys", "box = "},
      {"two shapes in a region",
       kMinimal + "[[fix]]\nregion = { everywhere = true, sphere = { centre = [0,0,0], radius = 1 } }\n",
       ":6: ", "a table with 2 keys", "one of"},
      {"an unknown shape", kMinimal + "[[fix]]\nregion = { spher = { radius = 1 } }\n", ":6: ", "unknown key 'spher'",
       "did you mean 'sphere'?"},
      {"everywhere that is false", kMinimal + "[[fix]]\nregion = { everywhere = false }\n",
       ":6: ", "everywhere is false", "true"},
      {"a box without min", kMinimal + "[[fix]]\nregion = { box = { max = [1, 1, 1] } }\n", ":6: ", "no 'min'",
       "max = [x, y, z]"},
      {"a box upside down", kMinimal + "[[fix]]\nregion = { box = { min = [0, 2, 0], max = [1, 1, 1] } }\n",
       ":6: ", "[0, 2, 0] is above max [1, 1, 1]", "min up to max"},
      {"a box without end", kMinimal + "[[fix]]\nregion = { box = { min = [-inf, 0, 0], max = [1, 1, 1] } }\n",
       ":6: ", "-inf", "finite"},
      {"a sphere without radius", kMinimal + "[[fix]]\nregion = { sphere = { centre = [0, 0, 0] } }\n",
       ":6: ", "no 'radius'", "centre = [x, y, z]"},
      {"a sphere of nothing", kMinimal + "[[fix]]\nregion = { sphere = { centre = [0, 0, 0], radius = 0 } }\n",
       ":6: ", "radius is 0", "above 0"},
      {"a misspelt centre", kMinimal + "[[fix]]\nregion = { sphere = { center = [0, 0, 0], radius = 1 } }\n",
       ":6: ", "unknown key 'center'", "did you mean 'centre'?"},
      {"a half-space without direction",
       kMinimal + "[[fix]]\nregion = { half_space = { point = [0, 0, 0], normal = [0, 0, 0] } }\n",
       ":6: ", "normal is [0, 0, 0]", "a direction"},
      {"a volume", "format = 1\n[[body]]\nvolume = \"ct.nii.gz\"\n", ":3: ", "volume 'ct.nii.gz' does not exist",
       "ct.nii.gz"},
      {"a label of nothing", kMinimal + "label = 5\n", ":5: ", "'label' belongs to a body with a 'volume'", "volume"},
      {"a threshold of nothing", kMinimal + "threshold = [1, 2]\n",
       ":5: ", "'threshold' belongs to a body with a 'volume'", "volume"},
      {"a volume beside a mesh", kMinimal + "volume = \".\"\nlabel = 1\n", "", "a 'mesh' and a 'volume'",
       "one of them"},
      {"a volume without a part", kVolume, "", "neither 'label' nor 'threshold'", "threshold = [lowest, highest]"},
      {"a volume with two parts", kVolume + "label = 1\nthreshold = [1, 2]\n", "", "both 'label' and 'threshold'",
       "label = 5"},
      {"the background as a body", kVolume + "label = 0\n", ":4: ", "label is 0", "a whole number from 1"},
      {"limits the wrong way round", kVolume + "threshold = [2, 1]\n", ":4: ", "2 and 1 select nothing",
       "[lowest, highest]"},
      {"a misspelt mending", kVolume + "label = 1\nmend = { clossing = 1 }\n", ":5: ", "unknown key 'clossing'",
       "did you mean 'closing'?"},
      {"a negative opening", kVolume + "label = 1\nmend = { opening = -1 }\n", ":5: ", "mend.opening is -1",
       "mm, 0 or more"},
      {"a unit of a volume", kVolume + "label = 1\nmesh_unit = \"mm\"\n",
       ":5: ", "'mesh_unit' belongs to a body with a 'mesh'", "own voxel size"},
      {"an image without a file", kMinimal + "[image]\nwarp = true\n", "", "[image] has no 'file'", "DICOM folder"},
      {"a misspelt key of the image", kMinimal + "[image]\nfiel = \".\"\n", ":6: ", "unknown key 'fiel'",
       "did you mean 'file'?"},
      {"a time that is no number of one", kMinimal + "[image]\nfile = \".\"\ntime = 1.5\n", ":7: ", "time is 1.5",
       "a whole number from 0"},
      {"a negative time", kMinimal + "[image]\nfile = \".\"\ntime = -1\n", ":7: ", "time is -1",
       "a whole number from 0"},
      {"a series that is a list", kMinimal + "[image]\nfile = \".\"\nseries = [1]\n", ":7: ", "series is",
       "number of a DICOM series"},
      {"a series between two numbers", kMinimal + "[image]\nfile = \".\"\nseries = 4.5\n", ":7: ", "series is 4.5",
       "\"4#2\""},
      {"a series of a mesh", kMinimal + "series = 4\n", ":5: ", "'series' belongs to a body with a 'volume'", "volume"},
      {"a negative rim", kMinimal + "[image]\nfile = \".\"\nrim = -1\n", ":7: ", "rim is -1", "0 mm and more"},
  };
  for (const Refused &refused : cases) {
    INFO(refused.what << "\n" << refused.text);
    const auto scene = parse(refused.text);
    REQUIRE_FALSE(scene.has_value());
    INFO(scene.error().message);
    CHECK(scene.error().code == ErrorCode::input);
    CHECK_THAT(scene.error().message, Contains("test.toml" + std::string(refused.line)) && Contains(refused.contains) &&
                                          Contains(refused.accepted));
  }
}

TEST_CASE("A scene that is absent, a folder, or hostile is refused") {
  const auto absent = scene::loadScene(sceneFolder() / "absent.toml", nullptr);
  REQUIRE_FALSE(absent.has_value());
  CHECK_THAT(absent.error().message, Contains("absent.toml") && Contains("no such file"));
  const auto folder = scene::loadScene(sceneFolder(), nullptr);
  REQUIRE_FALSE(folder.has_value());
  CHECK(folder.error().code == ErrorCode::input);

  // Keys as deep as a line is long would exhaust the stack.
  std::string deep = "format = 1\n[a";
  for (int i = 0; i < 100000; ++i) deep += ".a";
  CHECK_THAT(errorOf(deep + "]\n"), Contains(":2: ") && Contains("bytes"));
  CHECK_THAT(errorOf("format = 1\nx = " + std::string(3000, '[')), Contains("not valid TOML"));
  CHECK_THAT(errorOf(std::string("format = 1\n\xff\xfe\x00", 14)), Contains("not valid TOML"));
}
