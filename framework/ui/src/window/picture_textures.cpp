// SPDX-License-Identifier: Apache-2.0
#include "window/picture_textures.h"

#include <epoxy/gl.h>

#include <cstdint>

namespace c3de::ui {

ImTextureID PictureTextures::of(const std::shared_ptr<const render::Image> &picture) {
  auto found = textures_.find(picture);
  if (found == textures_.end()) {
    GLint before = 0;
    glGetIntegerv(GL_TEXTURE_BINDING_2D, &before);
    GLuint name = 0;
    glGenTextures(1, &name);
    glBindTexture(GL_TEXTURE_2D, name);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, picture->width, picture->height, 0, GL_RGB, GL_UNSIGNED_BYTE,
                 picture->rgb.data());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glBindTexture(GL_TEXTURE_2D, static_cast<GLuint>(before));
    found = textures_.emplace(picture, name).first;
  }
  return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(found->second));
}

void PictureTextures::clear() {
  for (const auto &[picture, name] : textures_) glDeleteTextures(1, &name);
  textures_.clear();
}

}  // namespace c3de::ui
