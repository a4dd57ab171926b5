#include "egl_context.hpp"

#include <cstdlib>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <kr3_common/error.hpp>

namespace kr3::sim
{

struct EglContext::Handles
{
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLSurface surface = EGL_NO_SURFACE;
  EGLContext context = EGL_NO_CONTEXT;

  ~Handles()
  {
    // The display itself stays initialised: it is shared by all contexts of the process.
    if (display != EGL_NO_DISPLAY)
    {
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    if (context != EGL_NO_CONTEXT)
    {
      eglDestroyContext(display, context);
    }
    if (surface != EGL_NO_SURFACE)
    {
      eglDestroySurface(display, surface);
    }
  }
};

EglContext::EglContext(int width, int height) : handles_(std::make_unique<Handles>())
{
  // Mesa's software renderer on this thread alone: its worker threads meet at barriers for every
  // picture, and on a busy machine each barrier waits for the scheduler (2 cores, load 8: 5
  // pictures took 11 s with workers, 0.2 s without). A user's own setting stays.
  setenv("LP_NUM_THREADS", "0", 0);
  const auto get_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (get_display == nullptr)
  {
    throw Unavailable("EGL has no eglGetPlatformDisplayEXT");
  }
  EGLDisplay display = get_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE)
  {
    throw Unavailable("EGL has no surfaceless display");
  }
  handles_->display = display;
  const EGLint config_attributes[] = {EGL_SURFACE_TYPE,
                                      EGL_PBUFFER_BIT,
                                      EGL_RENDERABLE_TYPE,
                                      EGL_OPENGL_BIT,
                                      EGL_RED_SIZE,
                                      8,
                                      EGL_GREEN_SIZE,
                                      8,
                                      EGL_BLUE_SIZE,
                                      8,
                                      EGL_DEPTH_SIZE,
                                      24,
                                      EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE ||
      eglChooseConfig(display, config_attributes, &config, 1, &count) == EGL_FALSE || count == 0)
  {
    throw Unavailable("EGL has no OpenGL configuration with an off-screen surface");
  }
  const EGLint surface_attributes[] = {EGL_WIDTH, width, EGL_HEIGHT, height, EGL_NONE};
  handles_->surface = eglCreatePbufferSurface(display, config, surface_attributes);
  handles_->context = eglCreateContext(display, config, EGL_NO_CONTEXT, nullptr);
  if (handles_->surface == EGL_NO_SURFACE || handles_->context == EGL_NO_CONTEXT ||
      eglMakeCurrent(display, handles_->surface, handles_->surface, handles_->context) == EGL_FALSE)
  {
    throw Unavailable("EGL cannot create an off-screen surface of " + std::to_string(width) +
                      " x " + std::to_string(height));
  }
}

EglContext::~EglContext() = default;

}  // namespace kr3::sim
