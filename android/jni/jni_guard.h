// Translates C++ exceptions to Java exceptions.
#pragma once

#include <jni.h>

#include <new>
#include <string>

#include "alidade/base/error.h"
#include "camera_session.h"

namespace alidade {

inline void ThrowJava(JNIEnv* env, const char* type, const char* what) {
  if (env->ExceptionCheck()) return;
  const jclass exception = env->FindClass(type);
  if (exception != nullptr) env->ThrowNew(exception, what);
}

// Runs `call`. Error becomes IllegalArgumentException, std::bad_alloc OutOfMemoryError, any other
// exception IllegalStateException. `failed` is returned then and ignored by Java.
template <typename Result, typename Call>
Result Guarded(JNIEnv* env, Result failed, Call&& call) {
  try {
    return call();
  } catch (const Error& error) {
    ThrowJava(env, "java/lang/IllegalArgumentException", error.what());
  } catch (const std::bad_alloc&) {
    ThrowJava(env, "java/lang/OutOfMemoryError", "the core has no memory left");
  } catch (const std::exception& error) {
    ThrowJava(env, "java/lang/IllegalStateException", error.what());
  } catch (...) {
    ThrowJava(env, "java/lang/IllegalStateException", "unknown error");
  }
  return failed;
}

template <typename Call>
void Guarded(JNIEnv* env, Call&& call) {
  Guarded(env, 0, [&] {
    call();
    return 0;
  });
}

// Java's modified UTF-8 differs from UTF-8 only for U+0000 and characters outside the BMP, which
// file names here do not use.
inline std::string TextOf(JNIEnv* env, jstring text) {
  if (text == nullptr) return "";
  const char* bytes = env->GetStringUTFChars(text, nullptr);
  if (bytes == nullptr) throw std::bad_alloc();
  std::string copy(bytes);
  env->ReleaseStringUTFChars(text, bytes);
  return copy;
}

inline jbyteArray BytesOf(JNIEnv* env, const std::string& bytes) {
  const auto size = static_cast<jsize>(bytes.size());
  const jbyteArray array = env->NewByteArray(size);
  if (array != nullptr) {
    env->SetByteArrayRegion(array, 0, size, reinterpret_cast<const jbyte*>(bytes.data()));
  }
  return array;
}

}  // namespace alidade
