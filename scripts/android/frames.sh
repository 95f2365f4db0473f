# For scripts/test-android: builds what its parts share, and the pictures they are tried with: of real recordings where ALIDADE_DATA names
# their folder, else rendered ones. Sets FRAMES to what there is.
built() { command -v javac >/dev/null && [ -f "$PWD/build/android/classes/done" ] && [ -x "$PWD/build/bin/alidade_frames" ]; }
FRAMES=()
if command -v javac >/dev/null && [ -z "${ALIDADE_ANDROID_NO_BUILD:-}" ]; then
  scripts/build alidade_bridge_test >"$work/build.log" 2>&1 || { tail -30 "$work/build.log"; fail "the bridge builds"; }
fi
if built; then
  build/bin/alidade_frames "synth:room?width=320&height=240&frames=60" 60 320 "$work/rendered.frames" && FRAMES+=(rendered)
  if [ -n "${ALIDADE_DATA:-}" ] && [ -d "$ALIDADE_DATA/kitchen" ]; then
    build/bin/alidade_frames "$ALIDADE_DATA/kitchen" 60 400 "$work/kitchen.frames" && FRAMES+=(kitchen)
  fi
fi
