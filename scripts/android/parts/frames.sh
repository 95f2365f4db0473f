# Part of scripts/android/test: builds the shared programs and images. PICTURES: the test sets, rendered and, if
# ALIDADE_DATA is set, real; SOURCE and WIDTH of each.
declare -A SOURCE=([rendered]="synth:room?width=320&height=240&frames=60" [kitchen]=data:kitchen) WIDTH=([rendered]=320 [kitchen]=400)
PICTURES=()
if command -v javac >/dev/null; then
  if scripts/build alidade_bridge_test >"$work/build.log" 2>&1; then
    PICTURES+=(rendered)
    [ ! -d "${ALIDADE_DATA:-}/kitchen" ] || PICTURES+=(kitchen)
  else
    tail -30 "$work/build.log"
    fail "the bridge builds"
  fi
fi
