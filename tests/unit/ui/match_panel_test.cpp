// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/match_panel.h"

#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;

TEST_CASE("a form of a match has the file of the chosen source only, and states what is missing") {
  MatchForm form;
  CHECK_THAT(form.whyNot(), Contains("measured points"));
  form.wanted.points = "points.csv";
  form.wanted.surface = "part.stl";
  form.wanted.labels.file = "labels.nrrd";
  form.wanted.unit = geometry::LengthUnit::metre;
  CHECK_THAT(form.whyNot(), Contains("the body"));
  form.wanted.body = "liver";
  CHECK(form.whyNot().empty());
  CHECK(form.match().points == "points.csv");
  CHECK(form.match().surface.empty());
  CHECK(form.match().labels.file.empty());
  CHECK(form.match().unit == geometry::LengthUnit::metre);

  form.source = MatchSource::labels;
  CHECK_THAT(form.whyNot(), Contains("label"));
  form.label = "7";
  CHECK(form.whyNot().empty());
  CHECK(form.match().points.empty());
  // Images state their unit.
  CHECK_FALSE(form.match().unit);

  form.wanted.isRigidFirst = form.wanted.deforms = false;
  CHECK_THAT(form.whyNot(), Contains("nothing is found"));
}

TEST_CASE("a form of a match is filled with what a scene requests") {
  scene::SceneMatch match;
  match.labels.file = "followup.nrrd";
  match.labels.label = std::uint16_t{3};
  match.noise_mm = 2.5;
  const MatchForm form = matchFormOf(match);
  CHECK(form.source == MatchSource::labels);
  CHECK(form.label == "3");
  CHECK(form.wanted.noise_mm == 2.5);
  match.labels.label.reset();
  match.labels.labelName = "liver";
  CHECK(matchFormOf(match).label == "liver");
  match.labels = {};
  match.surface = "part.stl";
  CHECK(matchFormOf(match).source == MatchSource::surface);
}
