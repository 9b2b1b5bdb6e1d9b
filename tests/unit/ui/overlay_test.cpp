// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/overlay.h"

#include "c3de/abi/iface/simulator.h"
#include "c3de/ui/image_views.h"
#include "c3de/ui/tissue_table.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;

TEST_CASE("Quantities are written in units for people", "[overlay]") {
  const Quantity stress = quantityOf(Overlay::field, "stress_of_it", "Pa");
  CHECK(stress.title == "stress of it");
  CHECK(stress.unit == "kPa");
  CHECK(stress.shown(1500.0) == 1.5);
  CHECK(stress.value(1.5) == 1500.0);
  const Quantity change = quantityOf(Overlay::volumeChange);
  CHECK_THAT(change.shown(0.93), WithinAbs(-7.0, 1e-9));
  CHECK_THAT(change.value(-7.0), WithinAbs(0.93, 1e-9));
  CHECK(quantityOf(Overlay::field, C3DE_SIM_FIELD_EQUIVALENT_STRESS, "Pa").title == "equivalent stress");
  CHECK(quantityOf(Overlay::field, "heat", "K").unit == "K");
  CHECK(quantityOf(Overlay::field, "stretch", "1").unit.empty());
  CHECK(rangeText({-5, 5}, "%") == "-5 … 5 %");
  CHECK(rangeText({0, 1.5}, "") == "0 … 1.5");
}

TEST_CASE("A range ends at round numbers, grows at once and shrinks late", "[overlay]") {
  for (const auto &[value, rounded] : {std::pair{0.8, 0.8},
                                       {0.81, 1.0},
                                       {1.0, 1.0},
                                       {1.1, 1.5},
                                       {2.1, 2.5},
                                       {9.0, 10.0},
                                       {23.0, 25.0},
                                       {0.012, 0.015}})
    CHECK_THAT(roundedUp(value), WithinAbs(rounded, 1e-9));
  StableRange range;
  range.follow(0.0, 3.3, false, 0.1);
  CHECK(range.range() == OverlayRange{0.0, 4.0});
  for (const double high : {3.9, 2.0, 1.7}) range.follow(0.0, high, false, 0.1);
  CHECK(range.range() == OverlayRange{0.0, 4.0});
  range.follow(0.0, 4.1, false, 0.1);
  CHECK(range.range() == OverlayRange{0.0, 5.0});
  range.follow(0.0, 1.9, false, 0.1);
  CHECK(range.range() == OverlayRange{0.0, 2.0});
  range.follow(0.0, 1e-9, false, 0.1);
  CHECK_THAT(range.range().high, WithinAbs(0.1, 1e-12));
  // A range with negative values has its zero in the middle; round-off does not count.
  range.follow(-1e-9, 2.0, false, 0.1);
  CHECK(range.range() == OverlayRange{0.0, 2.0});
  range.follow(-7.2, 1.0, false, 0.1);
  CHECK(range.range() == OverlayRange{-8.0, 8.0});
  range.forget();
  range.follow(0.2, 1.1, true, 0.1);
  CHECK(range.range() == OverlayRange{-1.5, 1.5});
}

TEST_CASE("A row of the table says what is known, and is found by label and tissue", "[overlay]") {
  TissueTable table;
  TissueRow row;
  row.label = "kidney_left";
  row.tissue = "kidney_cortex";
  row.reference_ml = 150.0;
  CHECK(row.volumeText() == "150.0");
  CHECK(row.changeText() == "–");
  CHECK(row.ratioText() == "–");
  row.motion = {148.5, 2.34, 8.76, 0.812};
  CHECK(row.volumeText() == "148.5");
  CHECK(row.changeText() == "-1.0");
  CHECK(row.meanText() == "2.3");
  CHECK(row.largestText() == "8.8");
  CHECK(row.ratioText() == "0.81");
  row.motion->volume_ml = 14109.4;
  CHECK(row.volumeText() == "14109");
  row.motion->volume_ml = 150.0 - 1e-9;
  CHECK(row.changeText() == "0.0");
  table.rows = {row, {"liver", "liver", {}, false, 1500.0, {}}};
  CHECK(listedRows(table, "").size() == 2);
  CHECK(listedRows(table, "left kidney") == std::vector<std::size_t>{0});
  CHECK(listedRows(table, "cortex") == std::vector<std::size_t>{0});
  CHECK(listedRows(table, "spleen").empty());
}

TEST_CASE("Rows of tissues come in the order of a column, those that nothing is known of at the end") {
  TissueTable table;
  const auto add = [&](double reference_ml, std::optional<TissueRow::Motion> motion) {
    TissueRow row;
    row.reference_ml = reference_ml;
    row.motion = motion;
    table.rows.push_back(row);
  };
  add(10.0, TissueRow::Motion{10.2, 1.0, 9.0, 0.9});
  add(50.0, std::nullopt);
  add(20.0, TissueRow::Motion{18.0, 3.0, 4.0, 0.7});
  add(40.0, TissueRow::Motion{40.0, 2.0, 2.0, 0.8});
  const auto order = [&](TissueOrder by) { return listedRows(table, "", by); };
  using Rows = std::vector<std::size_t>;
  CHECK(order(TissueOrder::labels) == Rows{0, 1, 2, 3});
  CHECK(order(TissueOrder::volume) == Rows{1, 3, 2, 0});
  CHECK(order(TissueOrder::change) == Rows{2, 0, 3, 1});
  CHECK(order(TissueOrder::mean) == Rows{2, 3, 0, 1});
  CHECK(order(TissueOrder::largest) == Rows{0, 2, 3, 1});
  CHECK(order(TissueOrder::leastRatio) == Rows{2, 3, 0, 1});
}
