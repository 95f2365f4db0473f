// For the bridge's tests: an OpenGL ES 3 context without a screen, as GLSurfaceView gives its
// thread one, and the colours that were drawn. Native methods of org.alidade.phone.Screen; a
// library of its own, no part of the app.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>
#include <jni.h>

namespace {
EGLDisplay g_display = EGL_NO_DISPLAY;
}  // namespace

extern "C" JNIEXPORT jlong JNICALL Java_org_alidade_phone_Screen_nativeOpen(JNIEnv*, jclass,
                                                                            jint width,
                                                                            jint height) {
  if (g_display == EGL_NO_DISPLAY) {
    g_display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA,
                                      reinterpret_cast<void*>(EGL_DEFAULT_DISPLAY), nullptr);
    if (g_display == EGL_NO_DISPLAY || !eglInitialize(g_display, nullptr, nullptr)) return 0;
  }
  const EGLint wanted[] = {EGL_SURFACE_TYPE,
                           EGL_PBUFFER_BIT,
                           EGL_RENDERABLE_TYPE,
                           EGL_OPENGL_ES3_BIT,
                           EGL_RED_SIZE,
                           8,
                           EGL_GREEN_SIZE,
                           8,
                           EGL_BLUE_SIZE,
                           8,
                           EGL_DEPTH_SIZE,
                           16,
                           EGL_NONE};
  EGLConfig config = nullptr;
  EGLint found = 0;
  if (!eglChooseConfig(g_display, wanted, &config, 1, &found) || found == 0) return 0;
  const EGLint size[] = {EGL_WIDTH, width, EGL_HEIGHT, height, EGL_NONE};
  const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE};
  const EGLSurface surface = eglCreatePbufferSurface(g_display, config, size);
  eglBindAPI(EGL_OPENGL_ES_API);
  const EGLContext context = eglCreateContext(g_display, config, EGL_NO_CONTEXT, version);
  if (context == EGL_NO_CONTEXT || !eglMakeCurrent(g_display, surface, surface, context)) return 0;
  return reinterpret_cast<jlong>(context);
}

// The context of this thread goes, with all that is in it.
extern "C" JNIEXPORT void JNICALL Java_org_alidade_phone_Screen_nativeClose(JNIEnv*, jclass) {
  const EGLContext context = eglGetCurrentContext();
  const EGLSurface surface = eglGetCurrentSurface(EGL_DRAW);
  eglMakeCurrent(g_display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(g_display, context);
  eglDestroySurface(g_display, surface);
  eglReleaseThread();
}

extern "C" JNIEXPORT void JNICALL Java_org_alidade_phone_Screen_nativeRead(JNIEnv* env, jclass,
                                                                           jint width, jint height,
                                                                           jobject into) {
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, env->GetDirectBufferAddress(into));
}
