// An off-screen OpenGL context in main memory: no display, no graphics card.
#pragma once

#include <memory>
#include <string>

#include "render/gl.h"

namespace dexremoe {

// An OSMesa context of OpenGL 3.3, core profile, current in the thread that made it.
class RenderContext {
 public:
  // Throws Error when the installed Mesa cannot give such a context.
  RenderContext();
  ~RenderContext();
  RenderContext(const RenderContext&) = delete;
  RenderContext& operator=(const RenderContext&) = delete;

  const Gl& gl() const { return gl_; }
  // The driver's own name, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)".
  const std::string& driver() const { return driver_; }
  // Makes the context current again (another one may have been made since).
  void MakeCurrent();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  Gl gl_;
  std::string driver_;
};

}  // namespace dexremoe
