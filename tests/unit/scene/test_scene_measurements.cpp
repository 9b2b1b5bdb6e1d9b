// SPDX-License-Identifier: Apache-2.0
// Landmarks, distances and angles of a scene.
#include "scene_text.h"

using namespace c3de;

namespace {

const std::string kThree = kMinimal + R"([[landmark]]
name = "a"
at = [0.1, 0.2, 0.3]
[[landmark]]
name = "b"
on = "beam"
at = [0, 0, 0]
target = [0, 0, 0.01]
[[landmark]]
name = "c"
at = [1, 0, 0]
)";

}  // namespace

TEST_CASE("Landmarks, distances and angles are read") {
  const auto scene = parse(kThree + R"([[distance]]
between = ["a", "b"]
[[distance]]
name = "width"
between = ["c", "a"]
[[angle]]
at = ["a", "b", "c"]
)");
  INFO((scene ? std::string() : scene.error().message));
  REQUIRE(scene);
  REQUIRE(scene->landmarks.size() == 3);
  CHECK(scene->landmarks[0].name == "a");
  CHECK(scene->landmarks[0].body.empty());  // also with one body: it may lie outside of it
  CHECK(scene->landmarks[0].at_m == Vec3{0.1, 0.2, 0.3});
  CHECK_FALSE(scene->landmarks[0].target_m);
  CHECK(scene->landmarks[1].body == "beam");
  CHECK(scene->landmarks[1].target_m == Vec3{0, 0, 0.01});
  CHECK(scene->landmarks[1].line == 8);
  REQUIRE(scene->distances.size() == 2);
  CHECK(scene->distances[0].name == "distance-1");
  CHECK(scene->distances[1].name == "width");
  CHECK(scene->distances[1].between == std::array<std::string, 2>{"c", "a"});
  REQUIRE(scene->angles.size() == 1);
  CHECK(scene->angles[0].name == "angle-1");
  CHECK(scene->angles[0].at == std::array<std::string, 3>{"a", "b", "c"});
}

TEST_CASE("Wrong measurements are refused with their line and what is accepted") {
  const struct {
    std::string text, contains;
  } cases[] = {
      {kThree + "[[distance]]\nbetween = [\"a\", \"bb\"]\n",
       "test.toml:16: there is no landmark 'bb'; did you mean 'b'? accepted: a, b, c"},
      {kThree + "[[distance]]\nbetween = [\"a\", \"a\"]\n", ":16: the distance has 'a' more than once"},
      {kThree + "[[distance]]\nbetween = [\"a\"]\n", ":17: between is [\"a\"]; accepted: the names of two landmarks"},
      {kThree + "[[distance]]\n", ":16: the distance has no 'between'; accepted: the names of two"},
      {kThree + "[[angle]]\nat = [\"a\", \"b\"]\n",
       ":17: at is [\"a\", \"b\"]; accepted: the names of three landmarks"},
      {kThree + "[[angle]]\nat = [\"a\", \"b\", \"a\"]\n", ":16: the angle has 'a' more than once"},
      {kThree + "[[landmark]]\nname = \"b\"\nat = [0, 0, 0]\n", ":16: a second landmark is named 'b'"},
      {kMinimal + "[[landmark]]\nat = [0, 0, 0]\n", ":5: the landmark has no 'name'; accepted: text"},
      {kMinimal + "[[landmark]]\nname = \"a\"\n", ":5: the landmark has no 'at'; accepted: a point [x, y, z] in m"},
      {kMinimal + "[[landmark]]\nname = \"a\"\nat = [0, 0]\n", ":7: at is [0, 0]; accepted: three numbers"},
      {kMinimal + "[[landmark]]\nname = \"a\"\nat = [0, 0, inf]\n", ":7: at: inf is not accepted"},
      {kMinimal + "[[landmark]]\nname = \"a\"\nat = [0, 0, 0]\non = \"bean\"\n",
       ":5: there is no body 'bean'; did you mean 'beam'? accepted: beam"},
      {kMinimal + "[[landmark]]\nname = \"a\"\nat = [0, 0, 0]\nbody = \"beam\"\n",
       ":8: unknown key 'body' in [[landmark]]; accepted: name, on, at, target"},
      {kMinimal + "[[distance]]\nbetween = [\"a\", \"b\"]\n",
       "there is no landmark 'a'; the scene has no [[landmark]]"},
  };
  for (const auto &one : cases) {
    INFO(one.text);
    CHECK_THAT(errorOf(one.text), Contains(one.contains));
  }
}

TEST_CASE("A landmark is moved on the command line, its name is not") {
  auto scene = parse(kThree + "[[distance]]\nbetween = [\"a\", \"b\"]\n");
  REQUIRE(scene);
  REQUIRE(scene::applyOverride(*scene, "landmark.a.at=[1,2,3]", &presets()));
  CHECK(scene->landmarks[0].at_m == Vec3{1, 2, 3});
  REQUIRE(scene::applyOverride(*scene, "landmark.a.target=[1,2,4]", &presets()));
  CHECK(scene->landmarks[0].target_m == Vec3{1, 2, 4});
  const auto renamed = scene::applyOverride(*scene, "landmark.a.name=x", &presets());
  REQUIRE_FALSE(renamed);
  CHECK_THAT(renamed.error().message, Contains("the name of a landmark cannot be changed here"));
  const auto unknown = scene::applyOverride(*scene, "distance.distance-1.between=[\"a\",\"z\"]", &presets());
  REQUIRE_FALSE(unknown);
  CHECK_THAT(unknown.error().message, Contains("there is no landmark 'z'"));
}
