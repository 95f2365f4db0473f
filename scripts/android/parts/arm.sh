# Part of scripts/android/test: core and bridge built for 64-bit ARM and run by qemu.
root=
if ! command -v aarch64-linux-gnu-g++ >/dev/null || ! command -v qemu-aarch64-static >/dev/null; then
  skip "the core on ARM: no cross-compiler or qemu (scripts/setup --android)"
elif [ ${#PICTURES[@]} -eq 0 ]; then
  skip "the core on ARM: no JDK, whose headers the bridge needs (scripts/setup --android)"
else
  root=$(scripts/android/arm64-sysroot) || { root=; skip "the core on ARM: its libraries could not be fetched"; }
fi

if [ -n "$root" ]; then
  arm=build-android/aarch64
  lib=$root/usr/lib/aarch64-linux-gnu
  build_arm() {
    ALIDADE_SYSROOT=$root cmake --preset aarch64 && cmake --build "$arm" --target alidade_jni alidade_dnn alidade_replay test_features
  }
  check "core, bridge and detector's module compile for ARM" build_arm
  emulated=(env "QEMU_LD_PREFIX=$root" "QEMU_SET_ENV=LD_LIBRARY_PATH=$lib:$lib/lapack:$lib/blas" qemu-aarch64-static)

  # The same images on both processors give the same map, or poses that differ by less than 1e-4 of the map's unit.
  for pictures in "${PICTURES[@]}"; do
    replay_both() {
      build/bin/alidade_frames "${SOURCE[$pictures]/data:/${ALIDADE_DATA:-}/}" 60 "${WIDTH[$pictures]}" "$work/$pictures.frames" &&
        build/bin/alidade_replay "$work/$pictures.frames" "$work/$pictures.here.txt" "$work/$pictures.here.map" &&
        "${emulated[@]}" "$arm/bin/alidade_replay" "$work/$pictures.frames" "$work/$pictures.arm.txt" "$work/$pictures.arm.map"
    }
    check "the core runs over 60 $pictures pictures on both" replay_both
    tail -2 "$work/log"
    here=$work/$pictures.here on_arm=$work/$pictures.arm
    check "$pictures: places are less than 1e-4 of the unit apart" python3 tests/android/compare.py "$here.txt" "$on_arm.txt" 1e-4
    tail -1 "$work/log"
    cmp -s "$here.txt" "$on_arm.txt" && echo "     the trajectory is the same bytes" || echo "     the trajectory differs in its last digits"
    # Sines, exponentials and similar functions round differently in the C library of each processor.
    echo "     of the map's $(stat -c %s "$here.map") bytes $(cmp -l "$here.map" "$on_arm.map" | wc -l) differ"
  done

  # tests/features compares NEON code with scalar code, OpenCV and closed forms.
  if "${emulated[@]}" "$arm/bin/test_features" >"$work/features.log" 2>&1; then
    pass "tests/features on ARM: $(grep -oE '[0-9]+ tests? ran|PASSED.*' "$work/features.log" | tail -1)"
  else
    fail "tests/features on ARM"
    grep -E '^\[  FAILED' "$work/features.log" | head
  fi
  java=$root/usr/lib/jvm/java-17-openjdk-arm64/bin/java
  bridge "bridge on a JVM for ARM" "${PICTURES[-1]}" 20 "$PWD/$arm/lib" "${emulated[@]}" "$java"
fi
