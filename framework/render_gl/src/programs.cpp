// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "frame.h"
#include "shaders.h"

namespace c3de::render {

Expected<Programs> buildPrograms(bool isDepthPeeled) {
  using namespace shaders;
  using Texts = std::vector<const char *>;
  const char *peeled = isDepthPeeled ? "#define PEELED\n" : "";
  struct Recipe {
    Program Programs::*member;
    const char *name;
    Texts vertex, fragment;
  };
  const Recipe recipes[] = {
      {&Programs::background, "background", {kHead, kBackgroundVertex}, {kHead, kBackgroundFragment}},
      {&Programs::mesh,
       "mesh",
       {kHead, kColourFunctions, kCutFunction, kMeshVertex},
       {kHead, peeled, kPeelFunction, kColourFunctions, kShadeFunctions, kMeshFragment}},
      {&Programs::sphere,
       "sphere",
       {kHead, kColourFunctions, kCutFunction, kSphereVertex},
       {kHead, peeled, kPeelFunction, kColourFunctions, kShadeFunctions, kSphereFragment}},
      {&Programs::line, "line", {kHead, kCutFunction, kLineVertex}, {kHead, peeled, kPeelFunction, kLineFragment}},
      {&Programs::label, "label", {kHead, kLabelVertex}, {kHead, kLabelFragment}}};
  Programs programs;
  for (const Recipe &recipe : recipes) {
    auto program = buildProgram(recipe.name, recipe.vertex, recipe.fragment);
    if (!program) return tl::unexpected(program.error());
    programs.*recipe.member = std::move(*program);
  }
  return programs;
}

void setCuts(const Frame &frame) {
  // Some drivers apply written clip distances although they are disabled.
  const Cuts &cuts = frame.cutsProxies ? frame.cuts : kNoCuts;
  glUniform4fv(shaders::kCuts, static_cast<GLsizei>(cuts.size()), cuts[0].data());
}

}  // namespace c3de::render
