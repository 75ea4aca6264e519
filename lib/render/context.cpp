#include "render/context.h"

#include <GL/osmesa.h>

#include <array>
#include <cstdint>

#include "base/error.h"

namespace dexremoe {

// OSMesa wants a surface to draw on; all drawing goes to framebuffer objects, so a small one does.
struct RenderContext::Impl {
  static constexpr int kSide = 16;
  OSMesaContext context = nullptr;
  std::array<std::uint8_t, 4 * kSide * kSide> surface{};

  ~Impl() {
    if (context == nullptr) return;
    if (OSMesaGetCurrentContext() == context) OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0);
    OSMesaDestroyContext(context);
  }
};

RenderContext::RenderContext() : impl_(std::make_unique<Impl>()) {
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            0,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  impl_->context = OSMesaCreateContextAttribs(attributes, nullptr);
  if (impl_->context == nullptr)
    Fail("OSMesa: expected an OpenGL 3.3 core context, found none (is libosmesa6 whole?)");
  MakeCurrent();
#define DEX_GL_LOAD(name, type)                                        \
  gl_.name = reinterpret_cast<type>(OSMesaGetProcAddress("gl" #name)); \
  if (gl_.name == nullptr) Fail("OSMesa: expected the function gl" #name ", found none");
  DEX_GL_FUNCTIONS(DEX_GL_LOAD)
#undef DEX_GL_LOAD
  driver_ = reinterpret_cast<const char*>(gl_.GetString(GL_RENDERER));
}

RenderContext::~RenderContext() = default;

void RenderContext::MakeCurrent() {
  if (OSMesaGetCurrentContext() == impl_->context) return;
  if (!OSMesaMakeCurrent(impl_->context, impl_->surface.data(), GL_UNSIGNED_BYTE, Impl::kSide,
                         Impl::kSide))
    Fail("OSMesa: the context cannot be made current");
}

}  // namespace dexremoe
