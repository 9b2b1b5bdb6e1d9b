// SPDX-License-Identifier: Apache-2.0
#include "retained_renderer.h"
#include "view_math.h"

namespace c3de::render {
namespace {

constexpr int kLargestImage_px = 16384;

class NullRenderer final : public RetainedRenderer {
 public:
  void draw(const Camera &, const Viewport &) override {}

  Expected<Image> drawToImage(const Camera &, int width, int height) override {
    if (auto size = checkImageSize(width, height, kLargestImage_px); !size) return tl::unexpected(size.error());
    const Rgba8 flat = toRgba8(background_.top);
    Image image{width, height, {}};
    image.rgb.resize(std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = flat[i % 3];
    return image;
  }

  std::string description() const override { return "null (no graphics)"; }
};

}  // namespace

std::unique_ptr<Renderer> createNullRenderer() { return std::make_unique<NullRenderer>(); }

}  // namespace c3de::render
