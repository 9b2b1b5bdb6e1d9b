// SPDX-License-Identifier: Apache-2.0
#include "scene_text.h"

#include <set>

using namespace c3de;

namespace {

struct Refused {
  const char *what;       ///< name of the case
  std::string text;
  const char *line;       ///< ":LINE: "
  const char *contains;   ///< the value or name that is wrong
  const char *accepted;   ///< what would be right
};

}  // namespace

TEST_CASE("Every mistake in a scene is refused with file, line, what is wrong and what is accepted") {
  const std::vector<Refused> cases{
      {"not TOML", "format = 1\ntitle = \n", ":2: ", "not valid TOML", ""},
      {"a key twice", "format = 1\nformat = 1\n", ":2: ", "not valid TOML", ""},
      {"no format", "title = \"x\"\n", ":1: ", "'format' is missing", "format = 1"},
      {"a format of the future", "format = 2\n", ":1: ", "format is 2", "accepted: 1"},
      {"a format that is text", "format = \"1\"\n", ":1: ", "the text \"1\"", "accepted: 1"},
      {"an unknown top key", "format = 1\ngravitee = 1\n", ":2: ", "unknown key 'gravitee'", "world"},
      {"a misspelt table", "format = 1\n[wrld]\ngravity = [0,0,0]\n", ":2: ", "unknown key 'wrld'", "did you mean 'world'?"},
      {"world as a number", "format = 1\nworld = 3\n", ":2: ", "a whole number", "[world]"},
      {"body as a table", "format = 1\n[body]\nmesh = \"beam.obj\"\n", ":2: ", "'body' is a table", "[[body]]"},
      {"no body", "format = 1\n", ":1: ", "no [[body]]", "at least one"},
      {"title as a number", "format = 1\ntitle = 3\n", ":2: ", "title is a whole number", "text in quotes"},
      {"an unknown body key", kMinimal + "scael = 2\n", ":5: ", "unknown key 'scael'", "did you mean 'scale'?"},
      {"no mesh", "format = 1\n[[body]]\nname = \"a\"\n", ":2: ", "no 'mesh'", "a mesh file"},
      {"a mesh that is not there", "format = 1\n[[body]]\nmesh = \"gone.obj\"\nmesh_unit = \"m\"\n", ":3: ", "gone.obj",
       "looked for at"},
      {"no unit", "format = 1\n[[body]]\nmesh = \"beam.obj\"\n", ":2: ", "'mesh_unit' is missing", "\"mm\""},
      {"an unknown unit", "format = 1\n[[body]]\nmesh = \"beam.obj\"\nmesh_unit = \"inch\"\n", ":4: ", "inch", "\"cm\""},
      {"a position with two numbers", kMinimal + "position = [1, 2]\n", ":5: ", "a list of 2", "[x, y, z]"},
      {"a position with text", kMinimal + "position = [1, 2, \"3\"]\n", ":5: ", "position", "[x, y, z]"},
      {"an infinite position", kMinimal + "position = [1, 2, inf]\n", ":5: ", "inf", "finite"},
      {"a scale of zero", kMinimal + "scale = 0\n", ":5: ", "scale is 0", "above 0"},
      {"a scale that is no number", kMinimal + "scale = nan\n", ":5: ", "scale", "above 0"},
      {"a scale as text", kMinimal + "scale = \"2\"\n", ":5: ", "the text \"2\"", "a number"},
      {"an unknown preset", kMinimal + "material = \"livr\"\n", ":5: ", "no material 'livr'", "did you mean 'liver'?"},
      {"a material as a number", kMinimal + "material = 3\n", ":5: ", "material is a whole number", "preset"},
      {"a material value of the wrong shape", kMinimal + "material = { density = [1, 2] }\n", ":5: ", "material.density",
       "a number"},
      {"sampling as a number", kMinimal + "sampling = 3\n", ":5: ", "sampling is", "spacing"},
      {"two ways to sample", kMinimal + "sampling = { spacing = 0.1, count = 3 }\n", ":5: ", "spacing and count", "one of them"},
      {"two ways to choose neighbours", kMinimal + "sampling = { neighbours = 20, support = 2.0 }\n", ":5: ",
       "neighbours and support", "one of them"},
      {"two bodies of one name",
       "format = 1\n[[body]]\nname = \"a\"\nmesh = \"beam.obj\"\nmesh_unit = \"m\"\n"
       "[[body]]\nname = \"a\"\nmesh = \"beam.obj\"\nmesh_unit = \"m\"\n",
       ":6: ", "second body is named 'a'", "differ"},
      {"a probe of no body", kMinimal + "[[probe]]\nbody = \"baem\"\nat = [0, 0, 0]\n", ":5: ", "no body 'baem'",
       "did you mean 'beam'?"},
      {"a probe without a place", kMinimal + "[[probe]]\nname = \"a\"\n", ":5: ", "no 'at'", "[x, y, z]"},
      {"an unknown probe key", kMinimal + "[[probe]]\nat = [0, 0, 0]\nbdy = \"beam\"\n", ":7: ", "unknown key 'bdy'",
       "did you mean 'body'?"},
      {"an unknown obstacle key", kMinimal + "[[obstacle]]\nmesh = \"block.obj\"\nmesh_unit = \"m\"\nfrction = 1\n", ":8: ",
       "unknown key 'frction'", "did you mean 'friction'?"},
      {"a box without max", "format = 1\n[world]\nbox = { min = [0, 0, 0] }\n" + kMinimal.substr(11), ":3: ", "no 'max'",
       "min = [x, y, z]"},
      {"a box without room", "format = 1\n[world]\nbox = { min = [0, 2, 0], max = [1, 1, 1] }\n" + kMinimal.substr(11), ":3: ",
       "no room", "below max"},
      {"a box as a number", "format = 1\n[world]\nbox = 3\n", ":3: ", "world.box is", "min = [x, y, z]"},
      {"fix", kMinimal + "[[fix]]\nbody = \"beam\"\n", ":5: ", "'fix' is not served yet", "this version serves"},
      {"load", kMinimal + "[[load]]\nbody = \"beam\"\n", ":5: ", "'load' is not served yet", "this version serves"},
      {"a volume", "format = 1\n[[body]]\nvolume = \"ct.nii.gz\"\n", ":3: ", "'volume' is not served yet", "mesh"},
      {"a label", kMinimal + "label = 5\n", ":5: ", "'label' is not served yet", "mesh"},
      {"a threshold", kMinimal + "threshold = [1, 2]\n", ":5: ", "'threshold' is not served yet", "mesh"},
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
