# Part of scripts/android/test: compiles the app's Java against the public API 29, made from the framework's list of
# signatures, and its resources with aapt2; checks the packaged page's hand-written bytecode against the same API and
# with the JVM's verifier.
app=android/app/src/main
framework=/usr/share/android-framework-res/framework-res.apk
stubs=
if ! command -v javac >/dev/null || ! command -v aapt2 >/dev/null || [ ! -f "$framework" ]; then
  skip "Java against API 29: no JDK, aapt2 or android-framework-res (scripts/setup --android)"
else
  stubs=$(scripts/android/stubs-jar) || { stubs=; skip "Java against API 29: the framework's signatures could not be fetched"; }
fi

# compiles FOLDER: compiles the app's Java in a folder of sources.
compiles() {
  rm -rf "$work/classes"
  javac --release 8 -Xlint:all,-options -Werror -cp "$stubs" -d "$work/classes" $(find "$1" -name '*.java') "$work/gen/org/alidade/phone/R.java"
}
resources() {
  rm -rf "$work/gen" "$work/res.zip"
  aapt2 compile --dir "$app/res" -o "$work/res.zip" &&
    # Gradle adds the package attribute.
    sed 's|<manifest |<manifest package="org.alidade.phone" |' "$1" >"$work/AndroidManifest.xml" &&
    aapt2 link -I "$framework" --manifest "$work/AndroidManifest.xml" -A "$app/assets" --java "$work/gen" --min-sdk-version 28 \
      --target-sdk-version 29 -o "$work/resources.apk" "$work/res.zip"
}
if [ -n "$stubs" ]; then
  sed 's|@string/settings|@string/no_such|' "$app/AndroidManifest.xml" >"$work/wrong.xml"
  refuses "a resource that is not there is refused by aapt2" resources "$work/wrong.xml"
  check "aapt2 takes the app's resources and manifest" resources "$app/AndroidManifest.xml"
  check "the app's Java compiles against the public API 29" compiles "$app/java"
  check "and so does what tests it" javac --release 11 -Xlint:all -cp "$stubs:$work/classes" -d "$work/classes" tests/android/java/Check.java tests/android/lens/LensTest.java
  java -cp "$work/classes:$stubs" org.alidade.phone.LensTest >"$work/lens.log" 2>&1 || true
  count "what a camera tells of its lens" "$work/lens.log"
  rm -rf "$work/wrong" && cp -r "$app/java" "$work/wrong"
  sed -i 's/\.acquireLatestImage(/.acquireLastestImage(/' "$work/wrong/org/alidade/phone/CameraFeed.java"
  refuses "a misspelt method is refused" compiles "$work/wrong"
  grep -q acquireLastestImage "$work/log" && pass "and named" || fail "and named"

  if command -v smali >/dev/null && command -v enjarify >/dev/null && [ -d build/android/classes ]; then
    smali assemble -a 24 -o "$work/page.dex" android/webview/smali
    # Debian's script requires Debian's Python.
    PATH=/usr/bin:$PATH enjarify -f -o "$work/page.jar" "$work/page.dex" >/dev/null
    java -cp "build/android/classes:$stubs:$work/page.jar" org.alidade.phone.SmaliCheck android/webview/smali org.alidade.page.Main \
      org.alidade.page.Asked org.alidade.page.Files >"$work/smali.log" 2>&1 || true
    count "the page's bytecode" "$work/smali.log"
    rm -rf "$work/smali" && cp -r android/webview/smali "$work/smali"
    sed -i 's/->loadUrl(/->loadUrls(/' "$work/smali/Main.smali"
    refuses "a misspelt method in it is refused" java -cp "build/android/classes:$stubs:$work/page.jar" org.alidade.phone.SmaliCheck "$work/smali"
    grep -q 'NoSuchMethod.*loadUrls' "$work/log" && pass "and named" || fail "and named"
  else
    skip "the page's bytecode: no smali or enjarify (scripts/setup --android)"
  fi
fi
