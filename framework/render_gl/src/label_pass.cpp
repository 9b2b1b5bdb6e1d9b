// SPDX-License-Identifier: Apache-2.0
#include "label_pass.h"

#include <algorithm>
#include <cmath>

#include "c3de/core/platform.h"
#include "shaders.h"

namespace c3de::render {
namespace {

constexpr auto kTextHeight_px = static_cast<float>(Renderer::kLegendText_px);
constexpr float kGap_px = 6.0f;      // between the point and the text
constexpr float kFinestText = 4.0f;  // beyond it characters are magnified

}  // namespace

LabelPass::LabelPass() : array_(VertexArray::create()), buffer_(Buffer::create()) {
  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.name());
  setFloatAttribute(0, 2, sizeof(Vertex), offsetof(Vertex, x));
  setFloatAttribute(1, 2, sizeof(Vertex), offsetof(Vertex, u));
  setColourAttribute(2, sizeof(Vertex), offsetof(Vertex, colour));
  glBindVertexArray(0);
}

void LabelPass::begin() {
  labels_.clear();
  legends_.clear();
  vertices_.clear();
}

void LabelPass::add(const Proxy &proxy, const Frame &frame) {
  const Vec3f &at = proxy.positions.front();
  const Vec3 p = c3de::transformPoint(multiply(frame.view, proxy.transform), {at[0], at[1], at[2]});
  if (!(-p[2] > frame.nearPlane)) return;
  const double w = -p[2];
  const double x = frame.projection[0] * p[0] / w, y = frame.projection[5] * p[1] / w;
  if (!(std::abs(x) < 2.0 && std::abs(y) < 2.0)) return;  // far outside, or not finite
  const auto [width, height] = frame.scaledSize();
  labels_.push_back({&proxy, 0.5f * static_cast<float>(x + 1.0) * width, 0.5f * static_cast<float>(y + 1.0) * height,
                     static_cast<float>(w)});
}

void LabelPass::useAtlas(float scale) {
  scale_ = std::clamp(scale, 1.0f, kFinestText);
  const auto known =
      std::find_if(atlases_.begin(), atlases_.end(), [this](const auto &a) { return a.scale == scale_; });
  if (known != atlases_.end()) {
    atlas_ = &known->atlas;
    glBindTexture(GL_TEXTURE_2D, known->texture.name());
    return;
  }
  // That of windows, and that of the last pictures.
  while (atlases_.size() > 1) atlases_.pop_back();
  SizedAtlas &made = atlases_.emplace_back();
  made.scale = scale_;
  const auto directories = fontDirectories();
  made.atlas = buildFontAtlas(directories, scale_ * kTextHeight_px);
  atlas_ = &made.atlas;
  made.texture = Texture::create();
  glBindTexture(GL_TEXTURE_2D, made.texture.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RG8, atlas_->width, atlas_->height, 0, GL_RG, GL_UNSIGNED_BYTE,
               atlas_->pixels.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
}

float LabelPass::widthOf(std::u32string_view line) const {
  float width = 0.0f;
  for (const char32_t character : line) width += atlas_->glyph(character).advance;
  return width / scale_;
}

void LabelPass::addLine(std::u32string_view line, float x, float baseLine, Rgba8 colour) {
  float pen = x;
  for (const char32_t character : line) {
    const Glyph &glyph = atlas_->glyph(character);
    // Integer pixels keep the strokes sharp.
    const float x0 = (std::round(scale_ * pen) + glyph.left) / scale_,
                y1 = (std::round(scale_ * baseLine) - glyph.top) / scale_;
    const float x1 = x0 + static_cast<float>(glyph.width) / scale_, y0 = y1 - static_cast<float>(glyph.height) / scale_;
    const auto u0 = static_cast<float>(glyph.x), v0 = static_cast<float>(glyph.y);
    const float u1 = u0 + static_cast<float>(glyph.width), v1 = v0 + static_cast<float>(glyph.height);
    pen += glyph.advance / scale_;
    if (glyph.width == 0) continue;
    const Vertex a{x0, y0, u0, v1, colour}, b{x1, y0, u1, v1, colour};
    const Vertex c{x1, y1, u1, v0, colour}, d{x0, y1, u0, v0, colour};
    vertices_.insert(vertices_.end(), {a, b, c, a, c, d});
  }
}

void LabelPass::layOut(const Placed &label) {
  const std::u32string text = decodeUtf8(label.proxy->text);
  const Rgba8 colour = toRgba8(label.proxy->material.colour);
  const auto lines = 1 + std::count(text.begin(), text.end(), U'\n');
  // y is up here; the last line ends above the point.
  float baseLine = label.y + kGap_px + (static_cast<float>(lines) * lineHeight() - ascent());
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(U'\n', begin), text.size());
    const std::u32string_view line = std::u32string_view(text).substr(begin, end - begin);
    addLine(line, label.x - 0.5f * widthOf(line), baseLine, colour);
    baseLine -= lineHeight();
    begin = end + 1;
  }
}

void LabelPass::draw(const Frame &frame, const Programs &programs, RenderStatistics &statistics) {
  if (labels_.empty() && legends_.empty()) return;
  glActiveTexture(GL_TEXTURE0);
  useAtlas(frame.scale);
  // Closer labels cover farther ones.
  std::stable_sort(labels_.begin(), labels_.end(), [](const Placed &a, const Placed &b) { return a.depth > b.depth; });
  for (const Placed &label : labels_) layOut(label);
  layOutLegends(frame);
  if (vertices_.empty()) return;

  glUseProgram(programs.label.name());
  glUniform2fv(shaders::kViewportSize, 1, frame.scaledSize().data());
  glUniform1i(shaders::kAtlas, 0);
  glBindSampler(0, 0);
  glBindVertexArray(array_.name());
  uploadBuffer(GL_ARRAY_BUFFER, buffer_, std::span<const Vertex>(vertices_));
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices_.size()));
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glBindTexture(GL_TEXTURE_2D, 0);
  ++statistics.drawCalls;
}

}  // namespace c3de::render
