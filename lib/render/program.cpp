#include "render/program.h"

#include "base/check.h"
#include "base/error.h"

namespace dexremoe {
namespace {

GLuint Compile(const Gl& gl, GLenum kind, const std::string& source) {
  const GLuint shader = gl.CreateShader(kind);
  const char* text = source.c_str();
  gl.ShaderSource(shader, 1, &text, nullptr);
  gl.CompileShader(shader);
  GLint good = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &good);
  char log[2048] = "";
  if (!good) gl.GetShaderInfoLog(shader, sizeof log, nullptr, log);
  DEX_CHECK_EQ(std::string(log), std::string());
  return shader;
}

}  // namespace

Program::Program(const Gl& gl, const std::string& vertex, const std::string& fragment) : gl_(gl) {
  const GLuint parts[] = {Compile(gl, GL_VERTEX_SHADER, vertex),
                          Compile(gl, GL_FRAGMENT_SHADER, fragment)};
  program_ = gl_.CreateProgram();
  for (GLuint part : parts) gl_.AttachShader(program_, part);
  gl_.LinkProgram(program_);
  for (GLuint part : parts) gl_.DeleteShader(part);
  GLint good = 0;
  gl_.GetProgramiv(program_, GL_LINK_STATUS, &good);
  char log[2048] = "";
  if (!good) gl_.GetProgramInfoLog(program_, sizeof log, nullptr, log);
  DEX_CHECK_EQ(std::string(log), std::string());
}

Program::~Program() { gl_.DeleteProgram(program_); }

GLint Program::Location(const char* name) const {
  const auto [at, fresh] = locations_.try_emplace(name, -1);
  if (fresh) at->second = gl_.GetUniformLocation(program_, name);
  return at->second;
}

void Program::Set(const char* name, int value) const { gl_.Uniform1i(Location(name), value); }

void Program::Set(const char* name, double value) const {
  gl_.Uniform1f(Location(name), float(value));
}

void Program::Set(const char* name, const Eigen::Vector2d& value) const {
  gl_.Uniform2f(Location(name), float(value.x()), float(value.y()));
}

void Program::Set(const char* name, const Eigen::Vector3d& value) const {
  gl_.Uniform3f(Location(name), float(value.x()), float(value.y()), float(value.z()));
}

void Program::Set(const char* name, const Eigen::Matrix3d& value) const {
  const Eigen::Matrix3f f = value.cast<float>();
  gl_.UniformMatrix3fv(Location(name), 1, GL_FALSE, f.data());
}

void Program::Set(const char* name, const Eigen::Matrix4d& value) const {
  const Eigen::Matrix4f f = value.cast<float>();
  gl_.UniformMatrix4fv(Location(name), 1, GL_FALSE, f.data());
}

Target::Target(const Gl& gl, TargetKind kind, int width, int height)
    : gl_(gl), width_(width), height_(height) {
  gl_.GenFramebuffers(1, &framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  switch (kind) {
    case TargetKind::kDepthMap:
      MakeTexture(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_FLOAT);
      gl_.DrawBuffer(GL_NONE);
      gl_.ReadBuffer(GL_NONE);
      break;
    case TargetKind::kFloatImage:
      MakeTexture(GL_COLOR_ATTACHMENT0, GL_RGBA16F, GL_RGBA, GL_FLOAT);
      MakeDepthBuffer();
      break;
    case TargetKind::kByteMap:
      MakeTexture(GL_COLOR_ATTACHMENT0, GL_R8, GL_RED, GL_UNSIGNED_BYTE);
      break;
  }
  if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    Fail("OSMesa: no framebuffer of {} x {} pixels", width, height);
}

Target::~Target() {
  gl_.DeleteFramebuffers(1, &framebuffer_);
  gl_.DeleteTextures(1, &texture_);
  gl_.DeleteRenderbuffers(1, &depth_);
}

void Target::MakeTexture(GLenum attachment, GLint internal, GLenum format, GLenum type) {
  gl_.GenTextures(1, &texture_);
  gl_.BindTexture(GL_TEXTURE_2D, texture_);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, internal, width_, height_, 0, format, type, nullptr);
  // Between depths of different surfaces there is nothing to interpolate.
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture_, 0);
}

void Target::MakeDepthBuffer() {
  gl_.GenRenderbuffers(1, &depth_);
  gl_.BindRenderbuffer(GL_RENDERBUFFER, depth_);
  gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width_, height_);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
}

void Target::Bind() const {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.Viewport(0, 0, width_, height_);
}

void Target::BindTexture(int unit) const {
  gl_.ActiveTexture(GL_TEXTURE0 + unit);
  gl_.BindTexture(GL_TEXTURE_2D, texture_);
}

}  // namespace dexremoe
