# Debian's cross-compiler for 64-bit ARM with the libraries unpacked by scripts/android/arm64-sysroot. The programs run in
# qemu-aarch64-static. -DCMAKE_TOOLCHAIN_FILE=cmake/aarch64.cmake -DALIDADE_SYSROOT=FOLDER (preset aarch64)
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(ALIDADE_SYSROOT "$ENV{ALIDADE_SYSROOT}" CACHE PATH "What scripts/android/arm64-sysroot printed")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES ALIDADE_SYSROOT)
set(CMAKE_SYSROOT ${ALIDADE_SYSROOT})
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

# The packages are not configured, so the alternatives of LAPACK and BLAS are missing: use their actual folders.
set(LIBRARIES ${ALIDADE_SYSROOT}/usr/lib/aarch64-linux-gnu)
set(ALIDADE_SYSROOT_PATHS ${LIBRARIES}:${LIBRARIES}/lapack:${LIBRARIES}/blas)
set(FLAGS "-Wl,-rpath-link,${ALIDADE_SYSROOT_PATHS} -Wl,--allow-shlib-undefined")
foreach(KIND EXE SHARED MODULE)
  set(CMAKE_${KIND}_LINKER_FLAGS_INIT "${FLAGS}")
endforeach()
set(CMAKE_CROSSCOMPILING_EMULATOR ${CMAKE_COMMAND} -E env QEMU_LD_PREFIX=${ALIDADE_SYSROOT}
    QEMU_SET_ENV=LD_LIBRARY_PATH=${ALIDADE_SYSROOT_PATHS} qemu-aarch64-static)
