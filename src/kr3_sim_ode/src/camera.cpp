#include "kr3_sim_ode/camera.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <osg/CullFace>
#include <osg/Geode>
#include <osg/Group>
#include <osg/Light>
#include <osg/LightSource>
#include <osg/Material>
#include <osgUtil/RenderBin>
#include <osgViewer/Viewer>

#include <kr3_common/error.hpp>

#include "egl_context.hpp"
#include "kr3_sim_ode/random.hpp"
#include "lens.hpp"
#include "scene_geometry.hpp"

namespace kr3::sim
{

namespace
{
constexpr double kNear = 0.05;  // m
constexpr double kFar = 50.0;   // m
const char* const kNearFirst = "kr3_near_first";

// Texture samples: large surfaces cost, objects are what is looked for.
constexpr float kRoomAnisotropy = 1.0F;
constexpr float kObjectAnisotropy = 4.0F;

/// Copies what was drawn into memory, bottom row first, as OpenGL has it.
class Capture : public osg::Camera::DrawCallback
{
public:
  Capture(int width, int height) : pixels_(height, width, CV_8UC3) {}

  void operator()(osg::RenderInfo& /*info*/) const override
  {
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, pixels_.cols, pixels_.rows, GL_BGR, GL_UNSIGNED_BYTE, pixels_.data);
  }

  [[nodiscard]] cv::Mat upright() const
  {
    cv::Mat result;
    cv::flip(pixels_, result, 0);
    return result;
  }

private:
  mutable cv::Mat pixels_;
};

struct SceneObject
{
  osg::ref_ptr<osg::MatrixTransform> node;
  osg::ref_ptr<osg::Geometry> geometry;
};

/// The lamp of one place.
struct Lamp
{
  osg::Vec4 position;
  osg::Vec4 diffuse;
  osg::Vec4 ambient;
};
}  // namespace

double CameraModel::focalLengthPixels() const
{
  return width / 2.0 / std::tan(horizontal_fov_rad / 2.0);
}

class Renderer::Impl
{
public:
  Impl(const Building& building, std::vector<ObjectModel> models, const CameraModel& camera)
    : lens_(camera)
    , context_(lens_.sourceWidth(), lens_.sourceHeight())
    , building_(building)
    , models_(std::move(models))
    , root_(new osg::Group)
    , light_source_(new osg::LightSource)
    , capture_(new Capture(lens_.sourceWidth(), lens_.sourceHeight()))
  {
    root_->addChild(light_source_);
    osg::StateSet& state = *root_->getOrCreateStateSet();
    light_source_->setStateSetModes(state, osg::StateAttribute::ON);
    state.setMode(GL_LIGHTING, osg::StateAttribute::ON);
    osg::ref_ptr<osg::Material> white = new osg::Material;
    white->setAmbient(osg::Material::FRONT_AND_BACK, {1, 1, 1, 1});
    white->setDiffuse(osg::Material::FRONT_AND_BACK, {1, 1, 1, 1});
    state.setAttributeAndModes(white);
    // What is near is drawn first, so that what it hides is not shaded; nothing is seen from
    // within.
    osgUtil::RenderBin::addRenderBinPrototype(
        kNearFirst, new osgUtil::RenderBin(osgUtil::RenderBin::SORT_FRONT_TO_BACK));
    state.setRenderBinDetails(0, kNearFirst);
    state.setAttributeAndModes(new osg::CullFace(osg::CullFace::BACK));

    addBuilding();
    // Now, so that one that cannot be read is an error here and not in the first picture of it.
    for (const ObjectModel& model : models_)
      (void)texture(model.texture, kObjectAnisotropy);
    setLight(0);

    viewer_.setThreadingModel(osgViewer::Viewer::SingleThreaded);
    viewer_.setUpViewerAsEmbeddedInWindow(0, 0, lens_.sourceWidth(), lens_.sourceHeight());
    viewer_.setSceneData(root_);
    viewer_.setLightingMode(osg::View::NO_LIGHT);
    osg::Camera& view = *viewer_.getCamera();
    view.setViewport(0, 0, lens_.sourceWidth(), lens_.sourceHeight());
    const double right = kNear * lens_.sourceWidth() / 2.0 / camera.focalLengthPixels();
    const double top = kNear * lens_.sourceHeight() / 2.0 / camera.focalLengthPixels();
    view.setProjectionMatrixAsFrustum(-right, right, -top, top, kNear, kFar);
    view.setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
    view.setFinalDrawCallback(capture_);
    viewer_.realize();
  }

  void setLight(std::uint64_t seed)
  {
    std::mt19937_64 generator = makeGenerator(seed, Stream::kLight);
    lamps_.clear();
    for (const Place& place : building_.places)
    {
      const Rectangle& r = place.rectangle;
      const double brightness = uniform(generator, 0.8, 1.15);
      const double warmth = uniform(generator, -0.06, 0.06);
      const auto tinted = [&](double level) {
        return osg::Vec4(static_cast<float>(level * (1.0 + warmth)), static_cast<float>(level),
                         static_cast<float>(level * (1.0 - warmth)), 1.0F);
      };
      const double x = (r.x0 + r.x1) / 2.0 + uniform(generator, -0.3, 0.3) * (r.x1 - r.x0);
      const double y = (r.y0 + r.y1) / 2.0 + uniform(generator, -0.3, 0.3) * (r.y1 - r.y0);
      const double z = building_.wall_height_m + 0.5;
      lamps_.push_back({{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), 1.0F},
                        tinted(0.5 * brightness),
                        tinted(0.55 * brightness)});
    }
  }

  cv::Mat draw(const Pose& T_world_camera, const std::vector<ObjectState>& objects, bool as_mask)
  {
    updateObjects(objects, as_mask);
    applyLamp(T_world_camera.position);
    const auto off = osg::StateAttribute::OFF | osg::StateAttribute::OVERRIDE;
    osg::StateSet& state = *root_->getOrCreateStateSet();
    if (as_mask)
    {
      state.setMode(GL_LIGHTING, off);
      state.setTextureMode(0, GL_TEXTURE_2D, off);
    }
    osg::Camera& view = *viewer_.getCamera();
    view.setClearColor(as_mask ? osg::Vec4(0, 0, 0, 1) : osg::Vec4(0.82F, 0.84F, 0.86F, 1));
    const auto vec = [](const Vector3& v) { return osg::Vec3d(v.x, v.y, v.z); };
    const osg::Vec3d eye = vec(T_world_camera.position);
    view.setViewMatrixAsLookAt(eye, eye + vec(rotated(T_world_camera.orientation, {1, 0, 0})),
                               vec(rotated(T_world_camera.orientation, {0, 0, 1})));
    viewer_.frame(0.0);
    if (as_mask)
    {
      state.setMode(GL_LIGHTING, osg::StateAttribute::ON);
      state.removeTextureMode(0, GL_TEXTURE_2D);
    }
    return lens_.bent(capture_->upright(), as_mask ? cv::INTER_NEAREST : cv::INTER_LINEAR);
  }

private:
  /// Loaded at its first use, with the anisotropy of that use.
  osg::ref_ptr<osg::Texture2D> texture(const std::string& path, float anisotropy)
  {
    osg::ref_ptr<osg::Texture2D>& image = textures_[path];
    if (!image)
    {
      image = loadTexture(path, anisotropy);
    }
    return image;
  }

  osg::ref_ptr<osg::MatrixTransform> add(const osg::ref_ptr<osg::Geometry>& geometry,
                                         const std::string& texture_path, float anisotropy,
                                         const osg::Matrixd& pose)
  {
    osg::ref_ptr<osg::Geode> geode = new osg::Geode;
    geode->addDrawable(geometry);
    osg::ref_ptr<osg::MatrixTransform> node = new osg::MatrixTransform(pose);
    node->addChild(geode);
    node->getOrCreateStateSet()->setTextureAttributeAndModes(0, texture(texture_path, anisotropy));
    root_->addChild(node);
    return node;
  }

  void addBuilding()
  {
    const Rectangle all = building_.extent();
    add(tiledBox({all.x1 - all.x0, all.y1 - all.y0, 0.02}), building_.floor_texture,
        kRoomAnisotropy,
        osg::Matrixd::translate((all.x0 + all.x1) / 2.0, (all.y0 + all.y1) / 2.0, -0.01));
    for (const Box& wall : wallsOf(building_))
    {
      add(tiledBox(wall.size), building_.wall_texture, kRoomAnisotropy,
          osg::Matrixd::translate(wall.center.x, wall.center.y, wall.center.z));
    }
    for (const Furniture& furniture : building_.furniture)
    {
      add(tiledBox(furniture.size), furniture.texture, kRoomAnisotropy,
          matrixOf(poseOf(furniture.pose, furniture.size.z / 2.0)));
    }
  }

  void updateObjects(const std::vector<ObjectState>& objects, bool as_mask)
  {
    for (auto& [name, object] : objects_)
    {
      object.node->setNodeMask(0);
    }
    int index = 0;
    for (const ObjectState& state : objects)
    {
      ++index;
      const auto key = state.name + '\n' + state.model;
      SceneObject& object = objects_[key];
      if (!object.node)
      {
        const ObjectModel& model = findModel(models_, state.model);
        object.geometry = model.shape == Shape::kBox ? coveredBox(model.size)
                                                     : wrappedCylinder(model.size.x, model.size.z);
        object.node =
            add(object.geometry, model.texture, kObjectAnisotropy, osg::Matrixd::identity());
      }
      if (as_mask)
      {
        setFlatColor(*object.geometry, index);
      }
      object.node->setMatrix(matrixOf(state.pose));
      object.node->setNodeMask(~0U);
    }
  }

  void applyLamp(const Vector3& eye)
  {
    const Place* const place = building_.placeAt(eye.x, eye.y);
    const auto index = place == nullptr ? 0 : place - building_.places.data();
    const Lamp& lamp = lamps_[static_cast<std::size_t>(index)];
    osg::Light& light = *light_source_->getLight();
    light.setPosition(lamp.position);
    light.setDiffuse(lamp.diffuse);
    light.setAmbient(lamp.ambient);
    light.setSpecular({0, 0, 0, 1});
  }

  Lens lens_;
  EglContext context_;  // everything below needs it, also while it is destroyed
  Building building_;
  std::vector<ObjectModel> models_;
  std::map<std::string, osg::ref_ptr<osg::Texture2D>> textures_;
  std::map<std::string, SceneObject> objects_;
  std::vector<Lamp> lamps_;
  osg::ref_ptr<osg::Group> root_;
  osg::ref_ptr<osg::LightSource> light_source_;
  osg::ref_ptr<Capture> capture_;
  osgViewer::Viewer viewer_;
};

Renderer::Renderer(const Building& building, std::vector<ObjectModel> models,
                   const CameraModel& camera)
  : impl_(std::make_unique<Impl>(building, std::move(models), camera))
{
}

Renderer::~Renderer() = default;

void Renderer::setLight(std::uint64_t seed)
{
  impl_->setLight(seed);
}

cv::Mat Renderer::image(const Pose& T_world_camera, const std::vector<ObjectState>& objects)
{
  return impl_->draw(T_world_camera, objects, false);
}

cv::Mat Renderer::mask(const Pose& T_world_camera, const std::vector<ObjectState>& objects)
{
  if (objects.size() > 254)
  {
    throw InvalidArgument(std::to_string(objects.size()) + " objects in a mask, at most 254");
  }
  cv::Mat red;
  cv::extractChannel(impl_->draw(T_world_camera, objects, true), red, 2);
  return red;
}

ImageNoise::ImageNoise(const CameraModel& camera, const CameraNoise& noise, std::uint64_t seed)
  : noise_(noise)
  , generator_(makeGenerator(seed, Stream::kCamera))
  , pattern_(camera.height + 64, camera.width + 64, CV_16SC3)
{
  cv::RNG random(generator_());
  random.fill(pattern_, cv::RNG::NORMAL, 0.0, noise_.pixel_stddev);
}

void ImageNoise::apply(cv::Mat& image)
{
  const double exposure =
      1.0 + noise_.exposure_stddev * std::normal_distribution<double>()(generator_);
  const auto x = static_cast<int>(uniformIndex(generator_, 65));
  const auto y = static_cast<int>(uniformIndex(generator_, 65));
  const cv::Mat window = pattern_(cv::Rect(x, y, image.cols, image.rows));
  image.convertTo(image, CV_8UC3, exposure);
  cv::add(image, window, image, cv::noArray(), CV_8UC3);
}

}  // namespace kr3::sim
