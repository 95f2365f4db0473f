#!/bin/sh
# run_bridge.sh FRAMES_PROGRAM SOURCE WIDTH FILE CYCLES JAVA…: writes the first 60 pictures of a recording to FILE, and runs BridgeTest over them.
# Fails when a test does, or -Xcheck:jni has something to say. data:FOLDER is a recording of ALIDADE_DATA.
set -eu
program=$1 source=$2 width=$3 file=$4 cycles=$5
shift 5
detector=
case $source in
  data:*)
    if [ ! -d "${ALIDADE_DATA:-}/${source#data:}" ]; then
      echo "skipped: ALIDADE_DATA names no recordings"
      exit
    fi
    source=$ALIDADE_DATA/${source#data:}
    detector=$ALIDADE_DATA/../models/yolov5n_640x480.onnx ;;
esac
[ -f "$detector" ] || detector=
"$program" "$source" 60 "$width" "$file"
# One arena: with one for each thread memory grows until there are as many as the allocator ever makes.
export MALLOC_ARENA_MAX=1
status=0
"$@" -Xcheck:jni -Xms64m -Xmx64m -XX:+AlwaysPreTouch org.alidade.phone.BridgeTest "$file" "$cycles" ${detector:+"$detector"} >"$file.log" 2>&1 || status=$?
cat "$file.log"
if grep -qE 'WARNING in native|FATAL ERROR in native|WARNING: JNI' "$file.log"; then
  echo "FAIL -Xcheck:jni has something to say"
  status=1
fi
exit "$status"
