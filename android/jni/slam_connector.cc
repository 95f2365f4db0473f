// Native methods of org.alidade.phone.SlamConnector. `handle` is a CameraSession*, never 0; the
// Java side ensures that it is not closed during a call.
#include <jni.h>

#include <array>
#include <string>
#include <vector>

#include "alidade/base/log.h"
#include "camera_session.h"
#include "jni_guard.h"
#ifdef __ANDROID__
#include <android/log.h>
#endif

namespace alidade {
namespace {

CameraSession& SessionOf(jlong handle) { return *reinterpret_cast<CameraSession*>(handle); }

LensNumbers LensOf(JNIEnv* env, jdoubleArray lens) {
  if (lens == nullptr) return {};
  LensNumbers numbers(static_cast<size_t>(env->GetArrayLength(lens)));
  env->GetDoubleArrayRegion(lens, 0, static_cast<jsize>(numbers.size()), numbers.data());
  return numbers;
}

// In the order of SlamConnector.Numbers.
std::array<double, 17> ListOf(const SessionNumbers& now) {
  const PhoneFrame& frame = now.frame;
  return {static_cast<double>(frame.result.state),
          frame.result.predicted ? 1.0 : 0.0,
          static_cast<double>(frame.keyframes),
          static_cast<double>(frame.landmarks),
          static_cast<double>(frame.matches),
          static_cast<double>(frame.features),
          static_cast<double>(frame.maps),
          frame.milliseconds,
          frame.fov,
          frame.fov_sigma,
          static_cast<double>(frame.camera_changes),
          static_cast<double>(now.frames),
          static_cast<double>(now.skipped),
          static_cast<double>(now.failed),
          static_cast<double>(now.inertial.samples),
          now.inertial.metric ? 1.0 : 0.0,
          now.inertial.scale_sigma};
}

}  // namespace
}  // namespace alidade

using alidade::CameraSession;
using alidade::Guarded;
using alidade::SessionOf;

#define ALIDADE_NATIVE(TYPE, NAME) \
  extern "C" JNIEXPORT TYPE JNICALL Java_org_alidade_phone_SlamConnector_##NAME

extern "C" JNIEXPORT jint JNICALL JNI_OnLoad(JavaVM*, void*) {
#ifdef __ANDROID__
  alidade::SetWarningListener([](const std::string& message) {
    __android_log_write(ANDROID_LOG_WARN, "alidade", message.c_str());
  });
#endif
  return JNI_VERSION_1_6;
}

ALIDADE_NATIVE(jlong, nativeOpen)
(JNIEnv* env, jclass, jint width, jint height, jdoubleArray lens, jstring settings,
 jstring detector) {
  return Guarded(env, jlong{0}, [&] {
    return reinterpret_cast<jlong>(new CameraSession(width, height, alidade::LensOf(env, lens),
                                                     alidade::TextOf(env, settings),
                                                     alidade::TextOf(env, detector)));
  });
}

ALIDADE_NATIVE(void, nativeClose)(JNIEnv* env, jclass, jlong handle) {
  Guarded(env, [&] { delete &SessionOf(handle); });
}

ALIDADE_NATIVE(void, nativeOffer)
(JNIEnv* env, jclass, jlong handle, jdouble seconds, jobject plane, jint row_stride) {
  Guarded(env, [&] {
    const void* pixels = plane == nullptr ? nullptr : env->GetDirectBufferAddress(plane);
    if (pixels == nullptr) alidade::ThrowUsage("a picture comes in a direct ByteBuffer");
    SessionOf(handle).Offer(static_cast<const uint8_t*>(pixels),
                            static_cast<size_t>(env->GetDirectBufferCapacity(plane)), row_stride,
                            seconds);
  });
}

ALIDADE_NATIVE(void, nativeMoved)(JNIEnv* env, jclass, jlong handle, jdoubleArray readings) {
  Guarded(env, [&] {
    if (readings == nullptr) alidade::ThrowUsage("inertial readings are missing");
    std::vector<double> numbers(static_cast<size_t>(env->GetArrayLength(readings)));
    env->GetDoubleArrayRegion(readings, 0, static_cast<jsize>(numbers.size()), numbers.data());
    SessionOf(handle).Moved(numbers);
  });
}

ALIDADE_NATIVE(void, nativeCameraGone)(JNIEnv* env, jclass, jlong handle) {
  Guarded(env, [&] { SessionOf(handle).CameraGone(); });
}

ALIDADE_NATIVE(void, nativeCameraBack)(JNIEnv* env, jclass, jlong handle) {
  Guarded(env, [&] { SessionOf(handle).CameraBack(); });
}

ALIDADE_NATIVE(void, nativeSurfaceCreated)(JNIEnv* env, jclass, jlong handle) {
  Guarded(env, [&] { SessionOf(handle).SurfaceCreated(); });
}

ALIDADE_NATIVE(void, nativeSurfaceGone)(JNIEnv* env, jclass, jlong handle) {
  Guarded(env, [&] { SessionOf(handle).SurfaceGone(); });
}

ALIDADE_NATIVE(void, nativeSurfaceChanged)
(JNIEnv* env, jclass, jlong handle, jint width, jint height) {
  Guarded(env, [&] { SessionOf(handle).SurfaceChanged(width, height); });
}

ALIDADE_NATIVE(void, nativeTurn)
(JNIEnv* env, jclass, jlong handle, jdouble right, jdouble down) {
  Guarded(env, [&] { SessionOf(handle).Turn(right, down); });
}

ALIDADE_NATIVE(void, nativeZoom)(JNIEnv* env, jclass, jlong handle, jdouble factor) {
  Guarded(env, [&] { SessionOf(handle).Zoom(factor); });
}

ALIDADE_NATIVE(jboolean, nativeDraw)(JNIEnv* env, jclass, jlong handle, jint rotation) {
  return Guarded(env, jboolean{JNI_FALSE}, [&]() -> jboolean {
    return SessionOf(handle).Draw(rotation) ? JNI_TRUE : JNI_FALSE;
  });
}

ALIDADE_NATIVE(void, nativeNumbers)(JNIEnv* env, jclass, jlong handle, jdoubleArray into) {
  Guarded(env, [&] {
    const auto list = alidade::ListOf(SessionOf(handle).Numbers());
    env->SetDoubleArrayRegion(into, 0, static_cast<jsize>(list.size()), list.data());
  });
}

ALIDADE_NATIVE(jstring, nativeReason)(JNIEnv* env, jclass, jlong handle) {
  return Guarded(env, jstring{nullptr}, [&] {
    return env->NewStringUTF(SessionOf(handle).Numbers().frame.result.reason());
  });
}

ALIDADE_NATIVE(jstring, nativeWords)(JNIEnv* env, jclass, jlong handle) {
  return Guarded(env, jstring{nullptr},
                 [&] { return env->NewStringUTF(SessionOf(handle).Words().c_str()); });
}

ALIDADE_NATIVE(jbyteArray, nativeMap)(JNIEnv* env, jclass, jlong handle) {
  return Guarded(env, jbyteArray{nullptr},
                 [&] { return alidade::BytesOf(env, SessionOf(handle).Map()); });
}

ALIDADE_NATIVE(jbyteArray, nativeTrajectory)(JNIEnv* env, jclass, jlong handle) {
  return Guarded(env, jbyteArray{nullptr},
                 [&] { return alidade::BytesOf(env, SessionOf(handle).Trajectory()); });
}

ALIDADE_NATIVE(void, nativeWaitUntilIdle)(JNIEnv* env, jclass, jlong handle) {
  Guarded(env, [&] { SessionOf(handle).WaitUntilIdle(); });
}
