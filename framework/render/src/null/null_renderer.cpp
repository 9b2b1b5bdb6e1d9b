// SPDX-License-Identifier: Apache-2.0
#include "retained_images.h"
#include "retained_renderer.h"
#include "view_math.h"

namespace c3de::render {
namespace {

constexpr int kLargestImage_px = 16384;

class NullImages final : public RetainedImages {
 public:
  void drawSlice(const ImageDisplay &, const SlicePlane &, const Viewport &) override {}
  Expected<Image> drawSliceToImage(const ImageDisplay &, const SlicePlane &, int width, int height) override {
    if (auto size = checkImageSize(width, height, kLargestImage_px); !size) return tl::unexpected(size.error());
    return Image{
        width, height,
        std::vector<std::uint8_t>(std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  }
  bool wantsRefinement() const override { return false; }

 private:
  Expected<void> uploadImage(ImageSlot &slot, const ImageVoxels &image, std::string *) override {
    slot.scale = image.slope;
    slot.offset = image.intercept;
    return {};
  }
  Expected<void> uploadLabels(ImageSlot &, std::span<const std::uint16_t>) override { return {}; }
  Expected<void> uploadDisplacement(ImageSlot &, std::span<const float>, std::span<const float>) override { return {}; }
  void labelColoursChanged(ImageSlot &) override {}
  bool uploadField(ImageSlot &, std::span<const float>) override { return true; }
  void overlayColoursChanged() override {}
};

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

  ImageRenderer *images() override { return &images_; }
  std::uint64_t changes() const override { return changes_ + images_.changesInSpace(); }
  std::string description() const override { return "null (no graphics)"; }

 private:
  NullImages images_;
};

}  // namespace

std::unique_ptr<Renderer> createNullRenderer() { return std::make_unique<NullRenderer>(); }

}  // namespace c3de::render
