// SPDX-License-Identifier: Apache-2.0
#include "gl_objects.h"

#include <fmt/format.h>

#include <cstdint>
#include <string>

namespace c3de::render {
namespace {

template <class GetParameter, class GetLog>
std::string readLog(GLuint name, GetParameter getParameter, GetLog getLog) {
  GLint length = 0;
  getParameter(name, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(length > 0 ? length : 1), '\0');
  GLsizei written = 0;
  getLog(name, static_cast<GLsizei>(log.size()), &written, log.data());
  log.resize(static_cast<std::size_t>(written));
  return log;
}

Expected<Shader> compile(GLenum stage, std::string_view name, std::span<const char *const> texts) {
  Shader shader = Shader::adopt(glCreateShader(stage));
  glShaderSource(shader.name(), static_cast<GLsizei>(texts.size()), texts.data(), nullptr);
  glCompileShader(shader.name());
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  const std::string log = readLog(
      shader.name(), [](GLuint n, GLenum p, GLint *v) { glGetShaderiv(n, p, v); },
      [](GLuint n, GLsizei m, GLsizei *w, GLchar *t) { glGetShaderInfoLog(n, m, w, t); });
  return fail(ErrorCode::graphics, fmt::format("the {} shader of '{}' does not compile: {}",
                                               stage == GL_VERTEX_SHADER ? "vertex" : "fragment", name, log));
}

}  // namespace

void setFloatAttribute(GLuint location, GLint components, std::size_t stride, std::size_t offset) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, components, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                        reinterpret_cast<const void *>(static_cast<std::uintptr_t>(offset)));
}

void setColourAttribute(GLuint location, std::size_t stride, std::size_t offset) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, 4, GL_UNSIGNED_BYTE, GL_TRUE, static_cast<GLsizei>(stride),
                        reinterpret_cast<const void *>(static_cast<std::uintptr_t>(offset)));
}

Expected<Program> buildProgram(std::string_view name, std::span<const char *const> vertexTexts,
                               std::span<const char *const> fragmentTexts) {
  auto vertex = compile(GL_VERTEX_SHADER, name, vertexTexts);
  if (!vertex) return tl::unexpected(vertex.error());
  auto fragment = compile(GL_FRAGMENT_SHADER, name, fragmentTexts);
  if (!fragment) return tl::unexpected(fragment.error());
  Program program = Program::adopt(glCreateProgram());
  glAttachShader(program.name(), vertex->name());
  glAttachShader(program.name(), fragment->name());
  glLinkProgram(program.name());
  GLint linked = GL_FALSE;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  const std::string log = readLog(
      program.name(), [](GLuint n, GLenum p, GLint *v) { glGetProgramiv(n, p, v); },
      [](GLuint n, GLsizei m, GLsizei *w, GLchar *t) { glGetProgramInfoLog(n, m, w, t); });
  return fail(ErrorCode::graphics, fmt::format("the shader program '{}' does not link: {}", name, log));
}

}  // namespace c3de::render
