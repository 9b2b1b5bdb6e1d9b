// SPDX-License-Identifier: Apache-2.0
#include "atlas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#ifdef _MSC_VER
#pragma warning(disable : 4505)  // functions of the library that are not used here
#endif
#include <stb_easy_font.h>

namespace extremes {
namespace {

using c3de::render::Image;
using Colour = std::array<std::uint8_t, 3>;

constexpr int kCell = 24, kGap = 26, kLeft = 118, kTop = 96, kBelow = 128, kLetter = 2;  // pixels
constexpr Colour kInk{40, 40, 40};

struct Kind {
  Ending ending;
  Colour colour;
  const char *name;
};
// Distinguishable without red and green as well: they differ in brightness.
constexpr std::array<Kind, 5> kKinds{{{Ending::finite, {44, 123, 182}, "finite to the end"},
                                      {Ending::finiteSoFar, {146, 197, 222}, "finite so far"},
                                      {Ending::stopped, {253, 174, 97}, "stopped with a report"},
                                      {Ending::refused, {190, 190, 190}, "refused"},
                                      {Ending::failed, {160, 0, 30}, "failed"}}};

void fill(Image &image, int x, int y, int width, int height, const Colour &colour) {
  for (int j = std::max(0, y); j < std::min(image.height, y + height); ++j)
    for (int i = std::max(0, x); i < std::min(image.width, x + width); ++i)
      std::copy(colour.begin(), colour.end(),
                image.rgb.begin() + 3 * (static_cast<std::ptrdiff_t>(j) * image.width + i));
}

// The letters are rectangles: four corners of three coordinates and a colour each.
struct Corner {
  float x, y, z;
  std::uint8_t colour[4];
};

int widthOf(const std::string &text) { return kLetter * stb_easy_font_width(const_cast<char *>(text.c_str())); }

enum class Anchor { left, middle, right };

void write(Image &image, int x, int y, const std::string &text, Anchor anchor) {
  if (anchor != Anchor::left) x -= anchor == Anchor::middle ? widthOf(text) / 2 : widthOf(text);
  std::vector<Corner> corners(4 * 40 * (text.size() + 1));
  const int quads = stb_easy_font_print(0.0f, 0.0f, const_cast<char *>(text.c_str()), nullptr, corners.data(),
                                        static_cast<int>(corners.size() * sizeof(Corner)));
  for (int q = 0; q < quads; ++q) {
    const Corner &from = corners[static_cast<std::size_t>(4 * q)], &to = corners[static_cast<std::size_t>(4 * q + 2)];
    const auto pixel = [](float v) { return static_cast<int>(std::lround(kLetter * v)); };
    fill(image, x + pixel(from.x), y + pixel(from.y), pixel(to.x) - pixel(from.x), pixel(to.y) - pixel(from.y), kInk);
  }
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::string exponentOf(double youngsModulus) {
  if (youngsModulus < 10.0) return number(youngsModulus);
  char text[40];
  std::snprintf(text, sizeof text, "%.0e", youngsModulus);
  const std::string all = text;
  const std::size_t e = all.find('e');
  return all.substr(0, 1) + "e" + std::to_string(std::atoi(all.c_str() + e + 1));
}

std::string spacingText(double metres) { return number(1e3 * metres) + " mm"; }

std::string stepText(double seconds) {
  return seconds <= 0.0 ? "" : seconds < 1e-3 ? number(1e6 * seconds) + " us" : number(1e3 * seconds) + " ms";
}

// Values in ascending order, or in the order of their first run.
template <class T>
void collect(std::vector<T> &values, const T &value) {
  if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
}

template <class T>
int placeOf(const std::vector<T> &values, const T &value) {
  return static_cast<int>(std::find(values.begin(), values.end(), value) - values.begin());
}

const Kind &kindOf(Ending ending) {
  return *std::find_if(kKinds.begin(), kKinds.end(), [ending](const Kind &k) { return k.ending == ending; });
}

}  // namespace

Colour colourOf(Ending ending) { return kindOf(ending).colour; }

std::string atlasTable(const std::vector<AtlasRun> &runs) {
  std::string out =
      "youngs_modulus_Pa,poisson_ratio,spacing_m,integrator,dt_s,ending,steps,seconds,slowest_step_s,reason\n";
  for (const AtlasRun &run : runs) {
    std::string reason = run.reason;
    std::replace(reason.begin(), reason.end(), '"', '\'');
    out += number(run.youngsModulus) + "," + number(run.poissonRatio) + "," + number(run.spacing) + "," + run.scheme +
           "," + number(run.dt) + "," + kindOf(run.ending).name + "," + std::to_string(run.steps) + "," +
           number(run.seconds) + "," + number(run.slowestStep) + ",\"" + reason + "\"\n";
  }
  return out;
}

Image drawAtlas(const std::vector<AtlasRun> &runs) {
  std::vector<double> moduli, ratios, spacings;
  std::vector<std::pair<std::string, double>> schemes;
  std::map<Ending, int> counts;
  for (const AtlasRun &run : runs) {
    collect(moduli, run.youngsModulus);
    collect(ratios, run.poissonRatio);
    collect(spacings, run.spacing);
    collect(schemes, {run.scheme, run.dt});
    ++counts[run.ending];
  }
  const auto size = [](const auto &values) { return static_cast<int>(values.size()); };
  const int panelWidth = kCell * size(moduli), panelHeight = kCell * size(ratios);
  const int across = panelWidth + kGap, down = panelHeight + kGap;
  std::vector<std::string> legend;
  int legendWidth = 0;
  for (const Kind &kind : kKinds) {
    legend.push_back(std::string(kind.name) + ": " + std::to_string(counts[kind.ending]));
    legendWidth += kCell + 8 + widthOf(legend.back()) + 36;
  }
  Image image;
  image.width = kLeft + std::max(76 + across * size(schemes), legendWidth);
  image.height = kTop + down * size(spacings) + kBelow;
  image.rgb.assign(3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), 255);

  for (int s = 0; s < size(schemes); ++s) {
    const auto &[scheme, dt] = schemes[static_cast<std::size_t>(s)];
    const int middle = kLeft + across * s + panelWidth / 2;
    if (s == 0 || schemes[static_cast<std::size_t>(s - 1)].first != scheme) {
      const auto steps = static_cast<int>(std::count_if(
          schemes.begin(), schemes.end(), [name = &scheme](const auto &other) { return other.first == *name; }));
      write(image, kLeft + across * s + (across * steps - kGap) / 2, kTop - 78, scheme, Anchor::middle);
    }
    if (dt > 0.0) write(image, middle, kTop - 44, "dt " + stepText(dt), Anchor::middle);
    const int foot = kTop + down * size(spacings) - kGap;
    for (const int m : {0, size(moduli) - 1})
      write(image, kLeft + across * s + kCell * m + kCell / 2, foot + 8,
            exponentOf(moduli[static_cast<std::size_t>(m)]), Anchor::middle);
  }
  const int rightmost = kLeft + across * size(schemes) - kGap;
  for (int row = 0; row < size(spacings); ++row) {
    const int top = kTop + down * row;
    write(image, 8, top + panelHeight / 2 - 8, spacingText(spacings[static_cast<std::size_t>(row)]), Anchor::left);
    for (int r = 0; r < size(ratios); ++r)
      write(image, rightmost + 8, top + panelHeight - kCell * (r + 1) + 5, number(ratios[static_cast<std::size_t>(r)]),
            Anchor::left);
    for (int s = 0; s < size(schemes); ++s)
      fill(image, kLeft + across * s - 1, top - 1, panelWidth + 1, panelHeight + 1, kInk);
  }
  for (const AtlasRun &run : runs) {
    const int x = kLeft + across * placeOf(schemes, {run.scheme, run.dt}) + kCell * placeOf(moduli, run.youngsModulus);
    const int y =
        kTop + down * placeOf(spacings, run.spacing) + panelHeight - kCell * (placeOf(ratios, run.poissonRatio) + 1);
    fill(image, x, y, kCell - 1, kCell - 1, colourOf(run.ending));
  }

  write(image, 8, kTop - 44, "spacing", Anchor::left);
  write(image, rightmost + 8, kTop - 44, "nu", Anchor::left);
  const int foot = kTop + down * size(spacings) - kGap;
  write(image, 8, foot + 8, "E (Pa)", Anchor::left);
  int x = kLeft;
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    fill(image, x, foot + 62, kCell, kCell, kKinds[k].colour);
    write(image, x + kCell + 8, foot + 66, legend[k], Anchor::left);
    x += kCell + 8 + widthOf(legend[k]) + 36;
  }
  return image;
}

}  // namespace extremes
