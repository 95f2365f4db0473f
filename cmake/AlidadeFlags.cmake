# Compiler flags of all targets. For determinism: no fused multiply-adds, no -march=native.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
if(NOT EMSCRIPTEN)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -g1 -DNDEBUG")
if(EMSCRIPTEN)
  set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")  # debug names would be a fifth of the download
endif()
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)

# Only symbols of headers marked ALIDADE_API are visible (base/api.h).
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)

# A fixed baseline (SSE4.2, popcnt) instead of the build machine's instruction set: the same bits everywhere.
set(ALIDADE_ARCH "x86-64-v2" CACHE STRING "What -march= gets on x86-64; empty: the compiler's own default. Other values: other bits")

# Other flags apply to Alidade's own files only. Users of the library must define this one as well, because it aligns
# Eigen's fixed-size matrices to 16 bytes for every instruction set (32 with AVX otherwise).
set(ALIDADE_PUBLIC_DEFINITIONS EIGEN_MAX_STATIC_ALIGN_BYTES=16)
add_library(alidade_flags INTERFACE)
target_compile_features(alidade_flags INTERFACE cxx_std_20)
target_compile_definitions(alidade_flags INTERFACE ${ALIDADE_PUBLIC_DEFINITIONS})
option(ALIDADE_WERROR "A warning fails the build; packages, built by compilers we have not seen, switch it off" ON)
target_compile_options(alidade_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow $<$<BOOL:${ALIDADE_WERROR}>:-Werror> -ffp-contract=off)
if(ALIDADE_ARCH AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(alidade_flags INTERFACE -march=${ALIDADE_ARCH})
endif()
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  # In unity builds clang reports a constant within a function as shadowing one of another file.
  target_compile_options(alidade_flags INTERFACE -Wno-shadow)
endif()
if(EMSCRIPTEN)
  # OpenCV's headers use WebAssembly's SIMD only while OpenCV itself is built; without this every lane is processed in a
  # loop.
  target_compile_definitions(alidade_flags INTERFACE CV_WASM_SIMD=1)
  target_compile_options(alidade_flags INTERFACE "SHELL:-include wasm_simd128.h")
endif()
if(ANDROID)
  target_compile_options(alidade_flags INTERFACE -Wno-error)  # Google's compilers are not tested
endif()
# Tests have fifty programs, and lld links them in a quarter of ld's processor time. What is installed is linked by the
# compiler's own choice.
find_program(LLD_PROGRAM ld.lld)
if(LLD_PROGRAM AND NOT CMAKE_CROSSCOMPILING)
  set(ALIDADE_TEST_LINKER -fuse-ld=lld)
endif()

if(ALIDADE_SANITIZE)
  set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1")  # compiles in half the time of -O2 -g, runs nearly as fast
  if(ALIDADE_FUZZ)
    set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O2 -g1")  # fuzzers run far longer than they compile
  endif()
  target_compile_options(alidade_flags INTERFACE -fsanitize=${ALIDADE_SANITIZE} -fno-sanitize-recover=all
                         -fno-omit-frame-pointer)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang" AND ALIDADE_SANITIZE MATCHES "address" AND ALIDADE_SANITIZE MATCHES "undefined")
    # The address sanitizer detects these on access, and they make reference-heavy code slow to compile.
    target_compile_options(alidade_flags INTERFACE -fno-sanitize=null,object-size)
    # Where no pointer is made of one to another type (alidade_floor): a fifth of the time to compile Eigen's references.
    target_compile_options(alidade_flags INTERFACE
                           $<$<BOOL:$<TARGET_PROPERTY:ALIDADE_WITHOUT_POINTER_CASTS>>:-fno-sanitize=alignment>)
  endif()
  # Warnings are checked by the other builds. GCC reports uninitialized values in the sanitizers' own code.
  target_compile_options(alidade_flags INTERFACE -Wno-error)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(alidade_flags INTERFACE -Wno-maybe-uninitialized -Wno-tsan)
  endif()
  target_link_options(alidade_flags INTERFACE -fsanitize=${ALIDADE_SANITIZE} ${ALIDADE_TEST_LINKER})
endif()

# Most compile time goes into the headers and templates of Eigen and OpenCV: 16 files together take little longer than
# one. Switch it off to work on one file repeatedly.
option(CMAKE_UNITY_BUILD "Compile several files in one go" ON)
set(CMAKE_UNITY_BUILD_BATCH_SIZE 16 CACHE STRING "Files compiled in one go, at most")

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # With paths relative to the sources, all clones share the cache.
  # CCACHE_SLOPPINESS: required for precompiled headers.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
      CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
endif()
