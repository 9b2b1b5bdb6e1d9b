// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "gl/frame.h"
#include "gl/shaders.h"

namespace c3de::render {

Expected<Programs> buildPrograms() {
  using namespace shaders;
  using Texts = std::vector<const char *>;
  struct Recipe {
    Program Programs::*member;
    const char *name;
    Texts vertex, fragment;
  };
  const Recipe recipes[] = {
      {&Programs::background, "background", {kHead, kBackgroundVertex}, {kHead, kBackgroundFragment}},
      {&Programs::mesh, "mesh", {kHead, kColourFunctions, kMeshVertex},
       {kHead, kColourFunctions, kShadeFunctions, kMeshFragment}},
      {&Programs::sphere, "sphere", {kHead, kColourFunctions, kSphereVertex},
       {kHead, kColourFunctions, kShadeFunctions, kSphereFragment}},
      {&Programs::line, "line", {kHead, kLineVertex}, {kHead, kLineFragment}},
      {&Programs::label, "label", {kHead, kLabelVertex}, {kHead, kLabelFragment}}};
  Programs programs;
  for (const Recipe &recipe : recipes) {
    auto program = buildProgram(recipe.name, recipe.vertex, recipe.fragment);
    if (!program) return tl::unexpected(program.error());
    programs.*recipe.member = std::move(*program);
  }
  return programs;
}

}  // namespace c3de::render
