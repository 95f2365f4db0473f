# alidade_floor(NAME FOLDERS ... LINKS ... APART ...): the folder src/alidade/NAME, with its folders FOLDERS, as the
# static library alidade_NAME. Files are compiled several at a time (see AlidadeFlags), except those listed in APART:
# long files, and files whose names clash with others'. LINKS is the floor plan of docs/development/architecture.md;
# tests/architecture_test checks the includes against it, and that floors WITHOUT_POINTER_CASTS have none: these and
# their tests are compiled without checks of alignment where sanitizers are on.
function(alidade_floor NAME)
  cmake_parse_arguments(ARG "WITHOUT_POINTER_CASTS" "" "FOLDERS;LINKS;APART" ${ARGN})
  list(TRANSFORM ARG_FOLDERS REPLACE "(.+)" "${CMAKE_CURRENT_SOURCE_DIR}/${NAME}/\\1/*.cc")
  file(GLOB SOURCES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${NAME}/*.cc ${ARG_FOLDERS})
  if(NOT SOURCES)
    return()
  endif()
  add_library(alidade_${NAME} STATIC ${SOURCES})
  foreach(FILE ${ARG_APART})
    set_source_files_properties(${NAME}/${FILE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endforeach()
  set_target_properties(alidade_${NAME} PROPERTIES ALIDADE_WITHOUT_POINTER_CASTS ${ARG_WITHOUT_POINTER_CASTS})
  target_include_directories(alidade_${NAME} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
                             $<INSTALL_INTERFACE:include>)
  target_include_directories(alidade_${NAME} SYSTEM PUBLIC ${OpenCV_INCLUDE_DIRS})
  target_link_libraries(alidade_${NAME} PUBLIC alidade_flags ${ARG_LINKS})
  if(NOT NAME STREQUAL "base")
    alidade_precompile(alidade_${NAME})
  endif()
  set_property(GLOBAL APPEND PROPERTY ALIDADE_FLOORS alidade_${NAME})
endfunction()

# alidade_unoptimized_when_sanitized(TARGET ...): the server and the words of commands, where no loop takes long. Without
# optimization they compile in half the time (server: 26 instead of 73 s).
function(alidade_unoptimized_when_sanitized)
  if(ALIDADE_SANITIZE AND NOT ALIDADE_FUZZ)
    foreach(TARGET ${ARGN})
      target_compile_options(${TARGET} PRIVATE -O0)
    endforeach()
  endif()
endfunction()

# alidade_precompile(TARGET): with sanitizers, libraries from floor 1 on share a precompiled header, which the first
# call builds: 1.6 s of each file are headers of Eigen and OpenCV. The other builds find missing includes.
function(alidade_precompile TARGET)
  if(NOT ALIDADE_SANITIZE OR ALIDADE_FUZZ)
    return()
  endif()
  get_property(OWNER GLOBAL PROPERTY ALIDADE_PRECOMPILED)
  if(OWNER)
    target_precompile_headers(${TARGET} REUSE_FROM ${OWNER})
  else()
    target_precompile_headers(${TARGET} PRIVATE <algorithm> <array> <cmath> <functional> <map> <memory> <optional> <span>
                              <string> <utility> <vector> <Eigen/Dense> <opencv2/core.hpp> <opencv2/imgproc.hpp>)
    set_property(GLOBAL PROPERTY ALIDADE_PRECOMPILED ${TARGET})
  endif()
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    target_compile_options(${TARGET} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
endfunction()

# alidade_test(FOLDER LINKS ...): tests/FOLDER/*_test.cc as one GoogleTest program. Each test is registered with CTest
# under the folder's label. Tests are compiled several files at a time, so each file has its own namespace,
# alidade::FILE. Problem generators shared with the benchmarks are in tests/problems.
# With FOLDERS, the tests of several small folders are one program.
# With END_TO_END the tests get this label instead, and are not part of the target unit_tests. With WAITS, too, the
# label is end_to_end_waits, and they run beside others (scripts/tools/run_tests.py).
# Builds with the address sanitizer leave out the files NOT_SANITIZED (names without _test.cc); builds with the thread
# sanitizer compile only the files THREADED, where given. docs/development/ci.md has the reasons.
# With sanitizers, tests UNOPTIMIZED compile in 40 % of the time. Not for tests of what is made of Eigen's templates: the
# linker would take the tests' copies for the library as well, which made them 6 times slower.
# Test programs share the precompiled header of the target tests_precompiled (tests/CMakeLists.txt): headers of
# GoogleTest, Eigen and OpenCV took a third of the time to compile a test.
function(alidade_test FOLDER)
  cmake_parse_arguments(ARG "END_TO_END;WAITS;UNOPTIMIZED" "" "LINKS;FOLDERS;NOT_SANITIZED;THREADED" ${ARGN})
  if(NOT ARG_FOLDERS)
    set(ARG_FOLDERS ${FOLDER})
  endif()
  list(TRANSFORM ARG_FOLDERS REPLACE "(.+)" "${CMAKE_CURRENT_SOURCE_DIR}/\\1/*.cc")
  file(GLOB SOURCES CONFIGURE_DEPENDS ${ARG_FOLDERS})
  if(ALIDADE_SANITIZE MATCHES "thread" AND ARG_THREADED)
    list(JOIN ARG_THREADED "|" FILES)
    list(FILTER SOURCES INCLUDE REGEX "/(${FILES})_test\\.cc$")
  elseif(ALIDADE_SANITIZE MATCHES "address" AND ARG_NOT_SANITIZED)
    list(JOIN ARG_NOT_SANITIZED "|" FILES)
    list(FILTER SOURCES EXCLUDE REGEX "/(${FILES})_test\\.cc$")
  endif()
  if(NOT SOURCES)
    return()
  endif()
  add_executable(test_${FOLDER} ${SOURCES})
  target_include_directories(test_${FOLDER} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(test_${FOLDER} PRIVATE ${ARG_LINKS} GTest::gtest_main GTest::gmock)
  target_compile_options(test_${FOLDER} PRIVATE ${ALIDADE_TEST_OPTIONS})
  target_link_options(test_${FOLDER} PRIVATE ${ALIDADE_TEST_LINKER})
  if(ALIDADE_SANITIZE AND CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    # All files in one go, as each has a namespace of its own: GCC's time grows faster than the file, clang's does not.
    set_target_properties(test_${FOLDER} PROPERTIES UNITY_BUILD_BATCH_SIZE 64)
  endif()
  if(TARGET alidade_${FOLDER})
    get_target_property(WITHOUT_POINTER_CASTS alidade_${FOLDER} ALIDADE_WITHOUT_POINTER_CASTS)
    set_target_properties(test_${FOLDER} PROPERTIES ALIDADE_WITHOUT_POINTER_CASTS ${WITHOUT_POINTER_CASTS})
  endif()
  if(ALIDADE_SANITIZE AND ARG_UNOPTIMIZED)
    target_compile_options(test_${FOLDER} PRIVATE -O0)
    target_precompile_headers(test_${FOLDER} REUSE_FROM tests_precompiled_unoptimized)
  else()
    target_precompile_headers(test_${FOLDER} REUSE_FROM tests_precompiled)
  endif()
  if(ARG_END_TO_END)
    gtest_discover_tests(test_${FOLDER} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 600
                         LABELS end_to_end$<$<BOOL:${ARG_WAITS}>:_waits> FIXTURES_REQUIRED recordings)
  else()
    gtest_discover_tests(test_${FOLDER} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 600 LABELS ${FOLDER})
    add_dependencies(unit_tests test_${FOLDER})
  endif()
endfunction()
