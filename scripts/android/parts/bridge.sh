# Part of scripts/android/test: the app's JNI bridge on this machine's JVM, with -Xcheck:jni.
check "the Gradle project names nothing that is missing" cmake "-DANDROID=$PWD/android" -P tests/android/project_files.cmake
if [ ${#PICTURES[@]} -eq 0 ]; then
  skip "the bridge: no JDK (scripts/setup --android)"
else
  for pictures in "${PICTURES[@]}"; do
    bridge "bridge on the JVM" "$pictures" 1000 "$PWD/build/lib" java
  done
  [ ${#PICTURES[@]} -gt 1 ] || skip "the bridge with real pictures: ALIDADE_DATA names no recordings"
fi
