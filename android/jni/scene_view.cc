#include "scene_view.h"

#ifdef ALIDADE_HAS_GLES
#include "alidade/gles/orbit.h"
#include "alidade/gles/renderer.h"
#endif

namespace alidade {
namespace {

#ifdef ALIDADE_HAS_GLES

class GlesView : public SceneView {
 public:
  void Resize(int width, int height) override {
    width_ = width;
    height_ = height;
    renderer_.Resize(width, height);
  }

  void Draw(const ViewFrame& frame) override {
    if (frame.luma) {
      renderer_.SetCameraPicture(frame.luma, frame.width, frame.height,
                                 static_cast<size_t>(frame.width), frame.rotation);
    }
    renderer_.Show(*frame.scene);
    // Keeps the whole map in view until the user moves the view.
    const size_t keyframes = frame.scene->keyframes.size();
    if (!led_ && keyframes != fitted_) {
      orbit_.Fit(*frame.scene, frame.rotation);
      fitted_ = keyframes;
    }
    gles::ViewSettings view;
    const bool upright = height_ >= width_;
    view.picture = upright ? gles::Area{0, 0, 1, 0.5} : gles::Area{0, 0, 0.5, 1};
    view.map = upright ? gles::Area{0, 0.5, 1, 0.5} : gles::Area{0.5, 0, 0.5, 1};
    orbit_.Apply(view);
    renderer_.Draw(view);
  }

  void Turn(double right, double down) override {
    orbit_.Turn(right, down, height_);
    led_ = true;
  }
  void Zoom(double factor) override {
    orbit_.Zoom(factor);
    led_ = true;
  }
  void ContextLost() override { renderer_.ContextLost(); }
  void Release() override { renderer_.Release(); }

 private:
  gles::Renderer renderer_;
  gles::Orbit orbit_;
  int width_ = 1, height_ = 1;
  bool led_ = false;   // moved by the user
  size_t fitted_ = 0;  // number of keyframes when the view was last fitted
};

#else

class NoView : public SceneView {
 public:
  void Resize(int, int) override {}
  void Draw(const ViewFrame&) override {}
  void Turn(double, double) override {}
  void Zoom(double) override {}
  void ContextLost() override {}
  void Release() override {}
};

#endif

}  // namespace

std::unique_ptr<SceneView> MakeSceneView() {
#ifdef ALIDADE_HAS_GLES
  return std::make_unique<GlesView>();
#else
  return std::make_unique<NoView>();
#endif
}

}  // namespace alidade
