# For scripts/test-android: the app's JNI bridge on this machine's JVM, with -Xcheck:jni.
check "the Gradle project names nothing that is missing" cmake "-DANDROID=$PWD/android" -P tests/android/project_files.cmake
if [ ${#FRAMES[@]} -eq 0 ]; then
  skip "the bridge: no JDK (scripts/setup --android)"
else
  for frames in "${FRAMES[@]}"; do
    cycles=1000
    bridge "bridge on the JVM, $frames pictures" "$PWD/build/lib" "$work/$frames.frames" "$cycles" java
  done
  [ ${#FRAMES[@]} -gt 1 ] || skip "the bridge with real pictures: ALIDADE_DATA names no recordings"
fi
