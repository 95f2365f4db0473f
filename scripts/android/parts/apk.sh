# Part of scripts/android/test: builds the packaged page (scripts/android/apk), verifies it and unpacks it.
apk=$work/page.apk
status=0
rm -f "$apk"
scripts/android/apk "$apk" >"$work/apk.log" 2>&1 || status=$?
if [ "$status" -eq 69 ]; then
  skip "the packaged page: $(tail -1 "$work/apk.log")"
elif [ "$status" -ne 0 ]; then
  fail "the packaged page is built"
  tail -20 "$work/apk.log"
else
  pass "$(sed "s|.*/||" "$work/apk.log" | tail -1)"
  check "apksigner verifies it" apksigner verify "$apk"
  check "it is aligned" zipalign -c 4 "$apk"
  aapt dump badging "$apk" >"$work/badging" 2>&1 || true
  for word in "package: name='org.alidade.page'" "sdkVersion:'24'" "name='android.permission.CAMERA'" "launchable-activity: name='org.alidade.page.Main'"; do
    check "it says $word" grep -qF "$word" "$work/badging"
  done
  refuses "it asks for nothing but the camera" grep -E "uses-permission: name='" <(grep -vF android.permission.CAMERA "$work/badging")
  # The package contains the files tested in Chromium.
  same() {
    local from=$1 to=$2 file
    for file in "$from"/*; do
      case $file in *.gz) continue ;; esac
      cmp "$file" "$to/$(basename "$file")" || return 1
    done
  }
  rm -rf "$work/unpacked" && mkdir -p "$work/unpacked"
  (cd "$work/unpacked" && python3 -m zipfile -e "$apk" .)
  check "its page is web/phone/dist, to the byte" same web/phone/dist "$work/unpacked/assets/page"
  core=${ALIDADE_CORE:-build-wasm/single/bin}
  for file in alidade.mjs alidade.wasm; do
    check "its $file is what scripts/wasm/build built, to the byte" cmp "$core/$file" "$work/unpacked/assets/page/core/single/$file"
  done
  detector=${ALIDADE_DETECTOR:-build-wasm/detector/bin}
  if [ -f "$detector/alidade_detector.wasm" ]; then
    check "what a detector needs is in it, to the byte" same "$detector" "$work/unpacked/assets/page/core/detector"
  fi
  cp "$apk" "$work/wrong.apk"
  python3 - "$work/wrong.apk" <<'PY'
import sys
data = bytearray(open(sys.argv[1], "rb").read())
data[data.index(b"classes.dex") + 200] ^= 1
open(sys.argv[1], "wb").write(data)
PY
  refuses "a changed byte is found" apksigner verify "$work/wrong.apk"
fi
