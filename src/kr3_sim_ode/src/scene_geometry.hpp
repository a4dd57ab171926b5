#pragma once

#include <string>

#include <osg/Geometry>
#include <osg/MatrixTransform>
#include <osg/Texture2D>
#include <osg/ref_ptr>

#include "kr3_sim_ode/geometry.hpp"

namespace kr3::sim
{

/// A mipmapped, repeating texture.
///
/// @param anisotropy  samples along the slope of a surface seen at an angle; 1 is cheapest, and 4
/// on
///                    every surface of a room makes a picture cost almost three times as much
/// @throws InvalidArgument  the file is no picture, or no power of two in size
[[nodiscard]] osg::ref_ptr<osg::Texture2D> loadTexture(const std::string& path, float anisotropy);

/// A box around the origin whose texture repeats every metre on each face.
[[nodiscard]] osg::ref_ptr<osg::Geometry> tiledBox(const Vector3& size);

/// A box around the origin with the whole texture upright on its front (+x) and back; the narrower
/// faces show a strip of it, in the front's scale.
[[nodiscard]] osg::ref_ptr<osg::Geometry> coveredBox(const Vector3& size);

/// An upright cylinder around the origin with the texture wrapped once around it, its middle at +x.
[[nodiscard]] osg::ref_ptr<osg::Geometry> wrappedCylinder(double diameter, double height);

/// The colour of all vertices, used by the mask pass only.
void setFlatColor(osg::Geometry& geometry, int red);

[[nodiscard]] osg::Matrixd matrixOf(const Pose& pose);

}  // namespace kr3::sim
