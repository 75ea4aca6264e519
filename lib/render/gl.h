// The OpenGL 3.3 core functions used here, as a table filled from the current context.
#pragma once

#include <GL/glcorearb.h>

namespace dexremoe {

// name in the table, name in GL, pointer type
#define DEX_GL_FUNCTIONS(X)                                    \
  X(ActiveTexture, PFNGLACTIVETEXTUREPROC)                     \
  X(AttachShader, PFNGLATTACHSHADERPROC)                       \
  X(BindBuffer, PFNGLBINDBUFFERPROC)                           \
  X(BindFramebuffer, PFNGLBINDFRAMEBUFFERPROC)                 \
  X(BindRenderbuffer, PFNGLBINDRENDERBUFFERPROC)               \
  X(BindTexture, PFNGLBINDTEXTUREPROC)                         \
  X(BindVertexArray, PFNGLBINDVERTEXARRAYPROC)                 \
  X(BlendFunc, PFNGLBLENDFUNCPROC)                             \
  X(BufferData, PFNGLBUFFERDATAPROC)                           \
  X(CheckFramebufferStatus, PFNGLCHECKFRAMEBUFFERSTATUSPROC)   \
  X(Clear, PFNGLCLEARPROC)                                     \
  X(ClearColor, PFNGLCLEARCOLORPROC)                           \
  X(ColorMask, PFNGLCOLORMASKPROC)                             \
  X(CompileShader, PFNGLCOMPILESHADERPROC)                     \
  X(CreateProgram, PFNGLCREATEPROGRAMPROC)                     \
  X(CreateShader, PFNGLCREATESHADERPROC)                       \
  X(CullFace, PFNGLCULLFACEPROC)                               \
  X(DeleteBuffers, PFNGLDELETEBUFFERSPROC)                     \
  X(DeleteFramebuffers, PFNGLDELETEFRAMEBUFFERSPROC)           \
  X(DeleteProgram, PFNGLDELETEPROGRAMPROC)                     \
  X(DeleteRenderbuffers, PFNGLDELETERENDERBUFFERSPROC)         \
  X(DeleteShader, PFNGLDELETESHADERPROC)                       \
  X(DeleteTextures, PFNGLDELETETEXTURESPROC)                   \
  X(DeleteVertexArrays, PFNGLDELETEVERTEXARRAYSPROC)           \
  X(DepthFunc, PFNGLDEPTHFUNCPROC)                             \
  X(DepthMask, PFNGLDEPTHMASKPROC)                             \
  X(Disable, PFNGLDISABLEPROC)                                 \
  X(DrawArrays, PFNGLDRAWARRAYSPROC)                           \
  X(DrawBuffer, PFNGLDRAWBUFFERPROC)                           \
  X(Enable, PFNGLENABLEPROC)                                   \
  X(EnableVertexAttribArray, PFNGLENABLEVERTEXATTRIBARRAYPROC) \
  X(FramebufferRenderbuffer, PFNGLFRAMEBUFFERRENDERBUFFERPROC) \
  X(FramebufferTexture2D, PFNGLFRAMEBUFFERTEXTURE2DPROC)       \
  X(GenBuffers, PFNGLGENBUFFERSPROC)                           \
  X(GenFramebuffers, PFNGLGENFRAMEBUFFERSPROC)                 \
  X(GenRenderbuffers, PFNGLGENRENDERBUFFERSPROC)               \
  X(GenTextures, PFNGLGENTEXTURESPROC)                         \
  X(GenVertexArrays, PFNGLGENVERTEXARRAYSPROC)                 \
  X(GetError, PFNGLGETERRORPROC)                               \
  X(GetIntegerv, PFNGLGETINTEGERVPROC)                         \
  X(GetProgramInfoLog, PFNGLGETPROGRAMINFOLOGPROC)             \
  X(GetProgramiv, PFNGLGETPROGRAMIVPROC)                       \
  X(GetShaderInfoLog, PFNGLGETSHADERINFOLOGPROC)               \
  X(GetShaderiv, PFNGLGETSHADERIVPROC)                         \
  X(GetString, PFNGLGETSTRINGPROC)                             \
  X(GetUniformLocation, PFNGLGETUNIFORMLOCATIONPROC)           \
  X(LinkProgram, PFNGLLINKPROGRAMPROC)                         \
  X(PolygonOffset, PFNGLPOLYGONOFFSETPROC)                     \
  X(ReadBuffer, PFNGLREADBUFFERPROC)                           \
  X(ReadPixels, PFNGLREADPIXELSPROC)                           \
  X(RenderbufferStorage, PFNGLRENDERBUFFERSTORAGEPROC)         \
  X(ShaderSource, PFNGLSHADERSOURCEPROC)                       \
  X(TexImage2D, PFNGLTEXIMAGE2DPROC)                           \
  X(TexParameteri, PFNGLTEXPARAMETERIPROC)                     \
  X(Uniform1f, PFNGLUNIFORM1FPROC)                             \
  X(Uniform1i, PFNGLUNIFORM1IPROC)                             \
  X(Uniform2f, PFNGLUNIFORM2FPROC)                             \
  X(Uniform3f, PFNGLUNIFORM3FPROC)                             \
  X(UniformMatrix3fv, PFNGLUNIFORMMATRIX3FVPROC)               \
  X(UniformMatrix4fv, PFNGLUNIFORMMATRIX4FVPROC)               \
  X(UseProgram, PFNGLUSEPROGRAMPROC)                           \
  X(VertexAttribPointer, PFNGLVERTEXATTRIBPOINTERPROC)         \
  X(Viewport, PFNGLVIEWPORTPROC)

struct Gl {
#define DEX_GL_MEMBER(name, type) type name = nullptr;
  DEX_GL_FUNCTIONS(DEX_GL_MEMBER)
#undef DEX_GL_MEMBER
};

}  // namespace dexremoe
