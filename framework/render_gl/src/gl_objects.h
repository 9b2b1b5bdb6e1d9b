// SPDX-License-Identifier: Apache-2.0
// Owners of OpenGL names. The context that created them must be current when they are destroyed.
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <span>
#include <string_view>
#include <utility>

#include "c3de/core/expected.h"

namespace c3de::render {

/// One OpenGL name; `Traits` defines how it is created and deleted.
template <class Traits>
class GlObject {
 public:
  GlObject() = default;
  [[nodiscard]] static GlObject create() {
    GlObject object;
    object.name_ = Traits::create();
    return object;
  }
  [[nodiscard]] static GlObject adopt(GLuint name) {
    GlObject object;
    object.name_ = name;
    return object;
  }
  GlObject(GlObject &&other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject &operator=(GlObject &&other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlObject() {
    if (name_ != 0) Traits::destroy(name_);
  }
  [[nodiscard]] GLuint name() const { return name_; }

 private:
  GLuint name_ = 0;
};

struct BufferTraits {
  static GLuint create() {
    GLuint n = 0;
    glGenBuffers(1, &n);
    return n;
  }
  static void destroy(GLuint n) { glDeleteBuffers(1, &n); }
};
struct VertexArrayTraits {
  static GLuint create() {
    GLuint n = 0;
    glGenVertexArrays(1, &n);
    return n;
  }
  static void destroy(GLuint n) { glDeleteVertexArrays(1, &n); }
};
struct TextureTraits {
  static GLuint create() {
    GLuint n = 0;
    glGenTextures(1, &n);
    return n;
  }
  static void destroy(GLuint n) { glDeleteTextures(1, &n); }
};
struct RenderbufferTraits {
  static GLuint create() {
    GLuint n = 0;
    glGenRenderbuffers(1, &n);
    return n;
  }
  static void destroy(GLuint n) { glDeleteRenderbuffers(1, &n); }
};
struct FramebufferTraits {
  static GLuint create() {
    GLuint n = 0;
    glGenFramebuffers(1, &n);
    return n;
  }
  static void destroy(GLuint n) { glDeleteFramebuffers(1, &n); }
};
struct ShaderTraits {
  static void destroy(GLuint n) { glDeleteShader(n); }
};
struct ProgramTraits {
  static void destroy(GLuint n) { glDeleteProgram(n); }
};

using Buffer = GlObject<BufferTraits>;
using VertexArray = GlObject<VertexArrayTraits>;
using Texture = GlObject<TextureTraits>;
using Renderbuffer = GlObject<RenderbufferTraits>;
using Framebuffer = GlObject<FramebufferTraits>;
using Shader = GlObject<ShaderTraits>;
using Program = GlObject<ProgramTraits>;

/// Replaces the contents of a buffer. Re-specifying the storage lets the driver return fresh memory while earlier
/// frames still read the old one.
template <class T>
void uploadBuffer(GLenum target, const Buffer &buffer, std::span<const T> values) {
  glBindBuffer(target, buffer.name());
  glBufferData(target, static_cast<GLsizeiptr>(values.size_bytes()), values.data(), GL_DYNAMIC_DRAW);
}

/// Float attribute `location` of the bound vertex array, read from the buffer bound to GL_ARRAY_BUFFER.
void setFloatAttribute(GLuint location, GLint components, std::size_t stride, std::size_t offset);
/// As above, four bytes that represent 0 … 1.
void setColourAttribute(GLuint location, std::size_t stride, std::size_t offset);

/// Compiles and links stages passed in pieces; the error contains the driver's log.
[[nodiscard]] Expected<Program> buildProgram(std::string_view name, std::span<const char *const> vertexTexts,
                                             std::span<const char *const> fragmentTexts);

}  // namespace c3de::render
