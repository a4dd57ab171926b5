#pragma once

#include <memory>

namespace kr3::sim
{

/// An OpenGL context with an off-screen surface and no display, current on the creating thread
/// while it lives.
class EglContext
{
public:
  /// @throws Unavailable  the platform has no EGL surfaceless context
  EglContext(int width, int height);
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

}  // namespace kr3::sim
