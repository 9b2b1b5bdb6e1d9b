// SPDX-License-Identifier: Apache-2.0
#include "c3de/render/renderer.h"
#include "c3de/render_gl/gl_renderer.h"
#include "run_picture.h"
#include "workstation/screenshot.h"

namespace c3de::app {
namespace {

class GlPicture final : public RunPicture {
 public:
  GlPicture(std::unique_ptr<render::OffscreenContext> context, std::unique_ptr<render::Renderer> renderer)
      : context_(std::move(context)), renderer_(std::move(renderer)) {}
  render::Renderer &renderer() override { return *renderer_; }
  Expected<void> write(Session &session, const std::filesystem::path &file, int width, int height,
                       const PictureSources &sources, const Prepared &prepared) override {
    return writeScreenshot(session, *renderer_, file, width, height, sources, prepared);
  }

 private:
  std::unique_ptr<render::OffscreenContext> context_;  // outlives the renderer
  std::unique_ptr<render::Renderer> renderer_;
};

}  // namespace

Expected<std::unique_ptr<RunPicture>> RunPicture::create() {
  auto context = render::OffscreenContext::create();
  if (!context) return tl::unexpected(context.error());
  auto renderer = render::createGlRenderer();
  if (!renderer) return tl::unexpected(renderer.error());
  return std::make_unique<GlPicture>(std::move(*context), std::move(*renderer));
}

}  // namespace c3de::app
