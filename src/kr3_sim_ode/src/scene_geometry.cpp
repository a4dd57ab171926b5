#include "scene_geometry.hpp"

#include <algorithm>
#include <cmath>

#include <osgDB/ReadFile>

#include <kr3_common/error.hpp>

namespace kr3::sim
{

namespace
{
struct MeshArrays
{
  osg::ref_ptr<osg::Vec3Array> vertices = new osg::Vec3Array;
  osg::ref_ptr<osg::Vec3Array> normals = new osg::Vec3Array;
  osg::ref_ptr<osg::Vec2Array> texture = new osg::Vec2Array;

  void add(const osg::Vec3& vertex, const osg::Vec3& normal, const osg::Vec2& uv)
  {
    vertices->push_back(vertex);
    normals->push_back(normal);
    texture->push_back(uv);
  }

  /// A rectangle seen from the side to which `right` x `up` points.
  void addFace(const osg::Vec3& center, const osg::Vec3& half_right, const osg::Vec3& half_up,
               float repeat_u, float repeat_v)
  {
    osg::Vec3 normal = half_right ^ half_up;
    normal.normalize();
    add(center - half_right - half_up, normal, {0.0F, 0.0F});
    add(center + half_right - half_up, normal, {repeat_u, 0.0F});
    add(center + half_right + half_up, normal, {repeat_u, repeat_v});
    add(center - half_right + half_up, normal, {0.0F, repeat_v});
  }

  [[nodiscard]] osg::ref_ptr<osg::Geometry> geometry(GLenum primitive) const
  {
    osg::ref_ptr<osg::Geometry> result = new osg::Geometry;
    result->setVertexArray(vertices);
    result->setNormalArray(normals, osg::Array::BIND_PER_VERTEX);
    result->setTexCoordArray(0, texture);
    result->setColorArray(new osg::Vec4Array(1), osg::Array::BIND_OVERALL);
    result->addPrimitiveSet(
        new osg::DrawArrays(primitive, 0, static_cast<GLsizei>(vertices->size())));
    result->setUseDisplayList(false);
    result->setUseVertexBufferObjects(true);
    setFlatColor(*result, 0);
    return result;
  }
};

struct FaceRepeats
{
  float front_u, front_v, side_u, side_v, top_u, top_v;
};

osg::ref_ptr<osg::Geometry> box(const Vector3& size, const FaceRepeats& repeats)
{
  const auto x = static_cast<float>(size.x / 2.0);
  const auto y = static_cast<float>(size.y / 2.0);
  const auto z = static_cast<float>(size.z / 2.0);
  MeshArrays mesh;
  mesh.addFace({x, 0, 0}, {0, y, 0}, {0, 0, z}, repeats.front_u, repeats.front_v);
  mesh.addFace({-x, 0, 0}, {0, -y, 0}, {0, 0, z}, repeats.front_u, repeats.front_v);
  mesh.addFace({0, y, 0}, {-x, 0, 0}, {0, 0, z}, repeats.side_u, repeats.side_v);
  mesh.addFace({0, -y, 0}, {x, 0, 0}, {0, 0, z}, repeats.side_u, repeats.side_v);
  mesh.addFace({0, 0, z}, {0, y, 0}, {-x, 0, 0}, repeats.top_u, repeats.top_v);
  mesh.addFace({0, 0, -z}, {0, -y, 0}, {-x, 0, 0}, repeats.top_u, repeats.top_v);
  return mesh.geometry(GL_QUADS);
}

bool isPowerOfTwo(int value)
{
  return value > 0 && (value & (value - 1)) == 0;
}
}  // namespace

osg::ref_ptr<osg::Texture2D> loadTexture(const std::string& path, float anisotropy)
{
  const osg::ref_ptr<osg::Image> image = osgDB::readRefImageFile(path);
  if (!image || !isPowerOfTwo(image->s()) || !isPowerOfTwo(image->t()))
  {
    throw InvalidArgument("texture '" + path +
                          "' must be a PNG whose width and height are powers of two");
  }
  osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D(image.get());
  texture->setWrap(osg::Texture::WRAP_S, osg::Texture::REPEAT);
  texture->setWrap(osg::Texture::WRAP_T, osg::Texture::REPEAT);
  texture->setFilter(osg::Texture::MIN_FILTER, osg::Texture::LINEAR_MIPMAP_LINEAR);
  texture->setMaxAnisotropy(anisotropy);
  return texture;
}

osg::ref_ptr<osg::Geometry> tiledBox(const Vector3& size)
{
  const auto x = static_cast<float>(size.x);
  const auto y = static_cast<float>(size.y);
  const auto z = static_cast<float>(size.z);
  return box(size, {y, z, x, z, y, x});
}

osg::ref_ptr<osg::Geometry> coveredBox(const Vector3& size)
{
  const auto side = static_cast<float>(std::min(1.0, size.x / size.y));
  const auto top = static_cast<float>(std::min(1.0, size.x / size.z));
  return box(size, {1.0F, 1.0F, side, 1.0F, 1.0F, top});
}

osg::ref_ptr<osg::Geometry> wrappedCylinder(double diameter, double height)
{
  constexpr int kSides = 32;
  const double radius = diameter / 2.0;
  const auto z = static_cast<float>(height / 2.0);
  MeshArrays mesh;
  for (int i = 0; i < kSides; ++i)
  {
    // From the back around the front (u = 1/2) to the back again.
    for (const int corner : {0, 1})
    {
      const double u = static_cast<double>(i + corner) / kSides;
      const double angle = 2.0 * M_PI * u + M_PI;
      const osg::Vec3 normal(static_cast<float>(std::cos(angle)),
                             static_cast<float>(std::sin(angle)), 0.0F);
      const osg::Vec3 side = normal * static_cast<float>(radius);
      const osg::Vec3 low = side - osg::Vec3(0, 0, z);
      const osg::Vec3 high = side + osg::Vec3(0, 0, z);
      const auto uf = static_cast<float>(u);
      mesh.add(corner == 0 ? high : low, normal, {uf, corner == 0 ? 1.0F : 0.0F});
      mesh.add(corner == 0 ? low : high, normal, {uf, corner == 0 ? 0.0F : 1.0F});
    }
  }
  // The lid, as quads around its centre; it shows the texture's upper edge.
  for (int i = 0; i < kSides; i += 2)
  {
    const osg::Vec3 up(0, 0, 1);
    mesh.add({0, 0, z}, up, {0.5F, 0.9F});
    for (int k = 0; k <= 2; ++k)
    {
      const double angle = 2.0 * M_PI * (i + k) / kSides + M_PI;
      const auto u = static_cast<float>(i + k) / kSides;
      mesh.add({static_cast<float>(radius * std::cos(angle)),
                static_cast<float>(radius * std::sin(angle)), z},
               up, {u, 1.0F});
    }
  }
  return mesh.geometry(GL_QUADS);
}

void setFlatColor(osg::Geometry& geometry, int red)
{
  auto& colors = dynamic_cast<osg::Vec4Array&>(*geometry.getColorArray());
  const osg::Vec4 color(static_cast<float>(red) / 255.0F, 0.0F, 0.0F, 1.0F);
  if (colors[0] != color)
  {
    colors[0] = color;
    colors.dirty();
  }
}

osg::Matrixd matrixOf(const Pose& pose)
{
  const Quaternion& q = pose.orientation;
  return osg::Matrixd::rotate(osg::Quat(q.x, q.y, q.z, q.w)) *
         osg::Matrixd::translate(pose.position.x, pose.position.y, pose.position.z);
}

}  // namespace kr3::sim
