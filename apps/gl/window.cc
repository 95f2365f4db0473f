#include "window.h"

#define GLFW_INCLUDE_NONE
#include <GLES3/gl3.h>
#include <GLFW/glfw3.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/gles/orbit.h"
#include "alidade/gles/renderer.h"
#include "alidade/io/files/image_file.h"

namespace alidade::gl_app {
namespace {

// What mouse and keys change.
struct Hands {
  gles::Orbit orbit;
  gles::ViewSettings view;
  bool led = false;  // by hand: no longer fitted to the map
  bool paused = false;
  double x = 0, y = 0;  // of the mouse
};

Hands& HandsOf(GLFWwindow* window) {
  return *static_cast<Hands*>(glfwGetWindowUserPointer(window));
}

void OnKey(GLFWwindow* window, int key, int, int action, int) {
  if (action != GLFW_PRESS) return;
  Hands& hands = HandsOf(window);
  gles::ViewSettings& view = hands.view;
  const auto flip = [](bool& layer) { layer = !layer; };
  switch (key) {
    case GLFW_KEY_ESCAPE:
    case GLFW_KEY_Q:
      glfwSetWindowShouldClose(window, GLFW_TRUE);
      break;
    case GLFW_KEY_SPACE:
      flip(hands.paused);
      break;
    case GLFW_KEY_F:
      hands.led = false;
      break;
    case GLFW_KEY_L:
      flip(view.landmarks);
      break;
    case GLFW_KEY_P:
      flip(view.points);
      break;
    case GLFW_KEY_K:
      flip(view.keyframes);
      break;
    case GLFW_KEY_T:
      flip(view.path);
      break;
    case GLFW_KEY_M:
      flip(view.features);
      break;
    case GLFW_KEY_O:
      view.other_maps = view.other_maps > 0 ? 0 : 0.3;
      break;
    default:
      break;
  }
}

void OnMove(GLFWwindow* window, double x, double y) {
  Hands& hands = HandsOf(window);
  const double right = x - hands.x, down = y - hands.y;
  hands.x = x;
  hands.y = y;
  int width = 1, height = 1;
  glfwGetWindowSize(window, &width, &height);
  height = std::max(height, 1);
  const auto held = [window](int button) {
    return glfwGetMouseButton(window, button) == GLFW_PRESS;
  };
  if (held(GLFW_MOUSE_BUTTON_LEFT)) {
    hands.orbit.Turn(right, down, height);
  } else if (held(GLFW_MOUSE_BUTTON_RIGHT) || held(GLFW_MOUSE_BUTTON_MIDDLE)) {
    hands.orbit.Pan(right, down, height, hands.view.fov);
  } else {
    return;
  }
  hands.led = true;
}

void OnWheel(GLFWwindow* window, double, double up) {
  Hands& hands = HandsOf(window);
  hands.orbit.Zoom(std::exp2(up / 4));
  hands.led = true;
}

// Closes GLFW with everything that is open.
struct Glfw {
  Glfw() {
    if (!glfwInit()) Refuse();
  }
  ~Glfw() { glfwTerminate(); }
  Glfw(const Glfw&) = delete;
  Glfw& operator=(const Glfw&) = delete;
  [[noreturn]] static void Refuse() {
    const char* why = nullptr;
    glfwGetError(&why);
    ThrowInput(std::string("cannot open a window with OpenGL ES 3 (") +
               (why ? why : "unknown reason") +
               "); without a screen, `alidade view` shows the run in a browser on another device");
  }
};

GLFWwindow* Open(const WindowSettings& settings) {
  glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_ES_API);
  glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 0);
  glfwWindowHint(GLFW_DEPTH_BITS, 24);
  if (!settings.screenshot.empty()) glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  GLFWwindow* window =
      glfwCreateWindow(settings.width, settings.height, "alidade-gl", nullptr, nullptr);
  if (!window) Glfw::Refuse();
  glfwMakeContextCurrent(window);
  glfwSwapInterval(1);
  return window;
}

// In the upper left corner, three tenths of the window wide and not over half of it high.
gles::Area CornerFor(const cv::Size& picture, int width, int height) {
  const double most = std::min(0.3 * width, 0.5 * height * picture.width / picture.height);
  return {0, 0, most / width, most * picture.height / picture.width / height};
}

void Save(const std::string& path, int width, int height) {
  cv::Mat rgba(height, width, CV_8UC4), bgr;
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data);
  cv::cvtColor(rgba, bgr, cv::COLOR_RGBA2BGR);
  cv::flip(bgr, bgr, 0);  // OpenGL's rows begin at the bottom
  WriteImage(path, bgr);
}

}  // namespace

void ShowRun(StreamPlayer& player, const WindowSettings& settings) {
  const Glfw glfw;
  GLFWwindow* window = Open(settings);
  Hands hands;
  float density = 1, density_y = 1;
  glfwGetWindowContentScale(window, &density, &density_y);
  for (double* size : {&hands.view.landmark_size, &hands.view.point_size, &hands.view.feature_size,
                       &hands.view.line_width})
    *size *= density;
  glfwSetWindowUserPointer(window, &hands);
  glfwSetKeyCallback(window, OnKey);
  glfwSetCursorPosCallback(window, OnMove);
  glfwSetScrollCallback(window, OnWheel);

  const bool at_once = settings.speed == 0 || !settings.screenshot.empty();
  gles::Renderer renderer;
  using Clock = std::chrono::steady_clock;
  Clock::time_point before = Clock::now();
  double played = 0;  // seconds of the recording
  uint64_t fitted = 0;
  cv::Size size;  // of the camera's picture
  while (!glfwWindowShouldClose(window)) {
    const Clock::time_point now = Clock::now();
    if (!hands.paused)
      played += settings.speed * std::chrono::duration<double>(now - before).count();
    before = now;
    player.PlayTo(at_once ? std::numeric_limits<double>::infinity() : played);
    const StreamScene& scene = player.scene();
    if (const cv::Mat picture = player.TakePicture(); !picture.empty()) {
      renderer.SetCameraPicture(picture.data, picture.cols, picture.rows, picture.step, 0);
      size = picture.size();
    }
    if (!hands.led && fitted != scene.told) hands.orbit.Fit(scene);
    fitted = hands.led ? 0 : scene.told;
    int width = 1, height = 1;
    glfwGetFramebufferSize(window, &width, &height);
    if (width > 0 && height > 0) {  // not while it is an icon
      if (!size.empty()) hands.view.picture = CornerFor(size, width, height);
      renderer.Resize(width, height);
      renderer.Show(scene);
      hands.orbit.Apply(hands.view);
      renderer.Draw(hands.view);
      if (!settings.screenshot.empty()) {
        Save(settings.screenshot, width, height);
        break;
      }
      glfwSwapBuffers(window);
    }
    glfwSetWindowTitle(window, player.Title().c_str());
    glfwWaitEventsTimeout(hands.paused || player.ended() ? 0.1 : 0.015);
  }
  renderer.Release();
}

}  // namespace alidade::gl_app
