// Shader programs and framebuffers: small owners of graphics resources.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>

#include "render/gl.h"

namespace dexremoe {

// A linked pair of shaders. A compile error is a bug and aborts with the compiler's log.
class Program {
 public:
  Program(const Gl& gl, const std::string& vertex, const std::string& fragment);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void Use() const { gl_.UseProgram(program_); }
  // Uniforms of the program in use. A name that the compiler optimised away is ignored.
  void Set(const char* name, int value) const;
  void Set(const char* name, double value) const;
  void Set(const char* name, const Eigen::Vector2d& value) const;
  void Set(const char* name, const Eigen::Vector3d& value) const;
  void Set(const char* name, const Eigen::Matrix3d& value) const;
  void Set(const char* name, const Eigen::Matrix4d& value) const;

 private:
  GLint Location(const char* name) const;
  const Gl& gl_;
  GLuint program_;
  mutable std::map<std::string, GLint> locations_;
};

enum class TargetKind {
  kDepthMap,    // depth texture
  kFloatImage,  // RGBA half-float texture with a depth buffer
  kByteMap,     // one 8-bit channel
};

// Something to draw into, and to read from afterwards.
class Target {
 public:
  // Throws Error when the driver refuses (an image too large).
  Target(const Gl& gl, TargetKind kind, int width, int height);
  ~Target();
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  // Draws go here from now on.
  void Bind() const;
  // Makes the texture readable as unit `unit`.
  void BindTexture(int unit) const;
  GLuint framebuffer() const { return framebuffer_; }

 private:
  void MakeTexture(GLenum attachment, GLint internal, GLenum format, GLenum type);
  void MakeDepthBuffer();
  const Gl& gl_;
  int width_, height_;
  GLuint framebuffer_ = 0, texture_ = 0, depth_ = 0;
};

}  // namespace dexremoe
