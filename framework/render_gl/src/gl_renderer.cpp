// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "blended_pass.h"
#include "c3de/core/log.h"
#include "c3de/render_gl/gl_renderer.h"
#include "frame.h"
#include "gl_images.h"
#include "image_target.h"
#include "label_pass.h"
#include "layer_pass.h"
#include "opaque_pass.h"
#include "retained_renderer.h"
#include "shaders.h"

namespace c3de::render {
namespace {

constexpr std::size_t kPrograms = 5;

#ifndef NDEBUG
void GLAPIENTRY reportGlMessage(GLenum, GLenum type, GLuint id, GLenum severity, GLsizei length, const GLchar *text,
                                const void *) {
  if (type != GL_DEBUG_TYPE_ERROR && severity != GL_DEBUG_SEVERITY_HIGH) return;
  const std::string_view message(text, static_cast<std::size_t>(length));
  log(LogLevel::error, fmt::format("OpenGL message {}: {}", id, message));
}
#endif

class GlRenderer final : public RetainedRenderer {
 public:
  explicit GlRenderer(Programs programs)
      : programs_(std::move(programs)), backgroundArray_(VertexArray::create()), images_(statistics_) {
    statistics_.programsLinked = kPrograms;
    GLint renderbuffer = 0, viewport[2] = {0, 0};
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &renderbuffer);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
    largestImage_ = std::min({renderbuffer, viewport[0], viewport[1]});
#ifndef NDEBUG
    glEnable(GL_DEBUG_OUTPUT);
    glDebugMessageCallback(reportGlMessage, nullptr);
#endif
  }

  void draw(const Camera &camera, const Viewport &viewport) override { draw(camera, viewport, style_.isFinal); }
  void setPictureStyle(const PictureStyle &style) override { style_ = style; }

  Expected<Image> drawToImage(const Camera &camera, int width, int height) override {
    if (auto size = checkImageSize(width, height, largestImage_); !size) return tl::unexpected(size.error());
    auto target = ImageTarget::create(width, height);
    if (!target) return tl::unexpected(target.error());
    draw(camera, {0, 0, width, height}, true);
    return target->read();
  }

  ImageRenderer *images() override { return &images_; }
  std::uint64_t changes() const override { return changes_ + images_.changesInSpace(); }

  std::string description() const override {
    return fmt::format("OpenGL {}, {}", reinterpret_cast<const char *>(glGetString(GL_VERSION)),
                       reinterpret_cast<const char *>(glGetString(GL_RENDERER)));
  }

  RenderStatistics statistics() const override { return statistics_; }

 private:
  /// @param isFinal  a picture that is not drawn again: no part stays coarse
  void draw(const Camera &camera, const Viewport &viewport, bool isFinal) {
    if (viewport.width <= 0 || viewport.height <= 0) return;
    Frame frame = makeFrame(camera, viewport);
    images_.setCuts(frame);
    statistics_.drawCalls = statistics_.sortedPrimitives = statistics_.uploadedBytes = 0;
    statistics_.sort_ms = statistics_.upload_ms = 0.0;
    enterState(viewport);
    drawBackground();
    blended_.begin();
    labels_.begin();
    proxies_.forEach([&](Handle, Proxy &proxy) {
      if (proxy.isHidden()) return;
      if (proxy.kind == ProxyKind::label)
        labels_.add(proxy, frame);
      else if (proxy.kind == ProxyKind::legend)
        labels_.addLegend(proxy.legend);
      else if (proxy.isTransparent())
        blended_.add(proxy, frame);
    });
    drawSolids(frame);
    blended_.prepare(statistics_);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    drawOcclusionDepth(frame);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    const auto drawDepth = [this](const Frame &small) {
      glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
      drawSolids(small);
      drawOcclusionDepth(small);
      glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    };
    // Transparent surfaces are drawn between the parts of the volume, if there is one.
    if (!images_.drawVolume(camera, frame, viewport, changes_, isFinal, drawDepth, layers_))
      blended_.draw(frame, programs_, statistics_);
    drawMarks(frame);
    labels_.draw(frame, programs_, statistics_);
    leaveState();
  }

  void drawSolids(const Frame &frame) {
    {
      const CutProxies cut(frame);
      proxies_.forEach([&](Handle, Proxy &proxy) {
        const bool isText = proxy.kind == ProxyKind::label || proxy.kind == ProxyKind::legend;
        if (!proxy.isHidden() && !isText && !proxy.isTransparent() && !isMark(proxy))
          drawOpaque(proxy, frame, programs_, statistics_);
      });
    }
    images_.drawOpaque(frame);
  }

  /// Transparent primitives are hidden within the covers.
  void drawOcclusionDepth(const Frame &frame) {
    if (blended_.isEmpty()) return;
    const CutProxies cut(frame);
    proxies_.forEach([&](Handle, Proxy &proxy) {
      if (proxy.kind == ProxyKind::mesh && proxy.material.cover > 0.0f && !proxy.isHidden() && !proxy.isTransparent())
        drawOpaque(proxy, frame, programs_, statistics_, true);
    });
  }

  /// Markers of tools for a grab, which may be inside tissue or on a cut face as well as outside.
  static bool isMark(const Proxy &proxy) {
    return proxy.material.inSlices && !proxy.isTransparent() &&
           (proxy.kind == ProxyKind::spheres || proxy.kind == ProxyKind::lines);
  }

  /// Complete, and in front of everything else.
  void drawMarks(Frame frame) {
    frame.cutsProxies = false;
    glDepthFunc(GL_ALWAYS);
    proxies_.forEach([&](Handle, Proxy &proxy) {
      if (isMark(proxy) && !proxy.isHidden()) drawOpaque(proxy, frame, programs_, statistics_);
    });
    glDepthFunc(GL_LEQUAL);
  }

  Frame makeFrame(const Camera &camera, const Viewport &viewport) const {
    Frame frame;
    frame.width = viewport.width;
    frame.height = viewport.height;
    frame.scale = style_.scale > 0.0f ? style_.scale : 1.0f;
    frame.isLight = style_.isLight;
    frame.view = camera.viewMatrix();
    frame.projection = camera.projectionMatrix(static_cast<double>(viewport.width) / viewport.height);
    frame.projectionF = toFloat(frame.projection);
    frame.nearPlane = static_cast<float>(camera.nearPlane);
    GLint samples = 0;
    glGetIntegerv(GL_SAMPLE_BUFFERS, &samples);
    frame.multisampled = samples > 0;
    return frame;
  }

  /// Previous drawing code may have left any state enabled: everything relevant is set here.
  static void enterState(const Viewport &v) {
    glViewport(v.x, v.y, v.width, v.height);
    glScissor(v.x, v.y, v.width, v.height);
    glEnable(GL_SCISSOR_TEST);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LEQUAL);
    glDepthRange(0.0, 1.0);
    glClearDepth(1.0);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glCullFace(GL_BACK);
    glFrontFace(GL_CCW);
    glBlendEquation(GL_FUNC_ADD);
    // Over operator; the last pair keeps the opacity of the framebuffer correct as well.
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    for (const GLenum off : {GL_CULL_FACE, GL_BLEND, GL_STENCIL_TEST, GL_FRAMEBUFFER_SRGB, GL_SAMPLE_ALPHA_TO_COVERAGE,
                             GL_POLYGON_OFFSET_FILL, GL_PRIMITIVE_RESTART, GL_RASTERIZER_DISCARD, GL_COLOR_LOGIC_OP,
                             GL_CLIP_DISTANCE0, GL_CLIP_DISTANCE1, GL_CLIP_DISTANCE2})
      glDisable(off);
    glEnable(GL_MULTISAMPLE);
    glEnable(GL_DEPTH_TEST);
  }

  static void leaveState() {
    for (const GLenum off : {GL_DEPTH_TEST, GL_SCISSOR_TEST, GL_CULL_FACE, GL_BLEND}) glDisable(off);
    glDepthFunc(GL_LESS);
    glUseProgram(0);
    glBindVertexArray(0);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
  }

  void drawBackground() {
    glClear(GL_DEPTH_BUFFER_BIT);
    glDisable(GL_DEPTH_TEST);
    glUseProgram(programs_.background.name());
    const Background &background = style_.background ? *style_.background : background_;
    glUniform3fv(shaders::kTopColour, 1, background.top.data());
    glUniform3fv(shaders::kBottomColour, 1, background.bottom.data());
    glBindVertexArray(backgroundArray_.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glEnable(GL_DEPTH_TEST);
    ++statistics_.drawCalls;
  }

  Programs programs_;
  VertexArray backgroundArray_;
  BlendedPass blended_;
  LayerPass layers_{blended_};
  LabelPass labels_;
  RenderStatistics statistics_;
  GlImages images_;
  PictureStyle style_;
  int largestImage_ = 0;
};

}  // namespace

Expected<std::unique_ptr<Renderer>> createGlRenderer() {
  if (auto version = checkGlVersion(); !version) return tl::unexpected(version.error());
  auto programs = buildPrograms();
  if (!programs) return tl::unexpected(programs.error());
  return std::make_unique<GlRenderer>(std::move(*programs));
}

}  // namespace c3de::render
