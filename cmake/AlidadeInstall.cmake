# cmake --install: the program with its modules, the library static and shared, and what finds it: find_package(Alidade),
# pkg-config alidade.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(ALIDADE_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/Alidade)

# What is in the library: all floors but those that only the program and tests need.
get_property(ALIDADE_FLOORS GLOBAL PROPERTY ALIDADE_FLOORS)
set(PARTS ${ALIDADE_FLOORS} alidade_module alidade_io_files alidade_onnx)
list(REMOVE_ITEM PARTS alidade_synth alidade_view alidade_ros)
set(OBJECTS)
foreach(PART ${PARTS})
  list(APPEND OBJECTS $<TARGET_OBJECTS:${PART}>)
endforeach()

# alidade_artefact(NAME KIND LINKS ...): the library as Alidade::NAME, in an export set of its own, so that who takes the
# shared one need not have what the static one must be linked with.
function(alidade_artefact NAME KIND)
  cmake_parse_arguments(ARG "" "" "LINKS" ${ARGN})
  add_library(alidade_${NAME} ${KIND} ${OBJECTS})
  set_target_properties(alidade_${NAME} PROPERTIES OUTPUT_NAME alidade EXPORT_NAME ${NAME} LINKER_LANGUAGE CXX
                        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_compile_features(alidade_${NAME} INTERFACE cxx_std_20)
  target_compile_definitions(alidade_${NAME} INTERFACE ${ALIDADE_PUBLIC_DEFINITIONS})
  target_include_directories(alidade_${NAME} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(alidade_${NAME} PUBLIC Eigen3::Eigen opencv_core PRIVATE ${ARG_LINKS})
  install(TARGETS alidade_${NAME} EXPORT Alidade_${NAME} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT Alidade_${NAME} NAMESPACE Alidade:: FILE Alidade_${NAME}.cmake DESTINATION ${ALIDADE_CMAKE_DIR})
endfunction()

set(NEEDS Threads::Threads opencv_imgproc opencv_features2d opencv_video opencv_calib3d JPEG::JPEG PNG::PNG yaml-cpp
    ${CMAKE_DL_LIBS})
find_package(JPEG REQUIRED)
find_package(PNG REQUIRED)
find_package(yaml-cpp REQUIRED)
alidade_artefact(static STATIC LINKS ${NEEDS})
alidade_artefact(shared SHARED LINKS ${NEEDS})
# Templates of other libraries, instantiated here, are nobody's business.
set(SYMBOLS ${CMAKE_CURRENT_LIST_DIR}/alidade.map)
target_link_options(alidade_shared PRIVATE -Wl,--version-script=${SYMBOLS})
set_target_properties(alidade_shared PROPERTIES LINK_DEPENDS ${SYMBOLS})
if(ALIDADE_SANITIZE)
  # Clang links the sanitizer's library into programs alone: shared libraries find its functions there.
  target_link_options(alidade_shared PRIVATE -fsanitize=${ALIDADE_SANITIZE})
else()
  target_link_options(alidade_shared PRIVATE -Wl,--no-undefined)
endif()

# The API is the headers that mark their namespace as visible, and they are what is installed. tests/architecture sees to
# it that they include no others.
install(CODE "set(ALIDADE_SOURCES \"${PROJECT_SOURCE_DIR}/src\")
set(ALIDADE_INCLUDES \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}\")")
install(SCRIPT ${CMAKE_CURRENT_LIST_DIR}/InstallHeaders.cmake)

if(TARGET alidade)
  install(TARGETS alidade RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  add_dependencies(alidade alidade_static alidade_shared alidade_media alidade_bags alidade_dnn)  # what is installed is built
  if(TARGET alidade_serve)
    add_dependencies(alidade alidade_serve)
  endif()
endif()
# The program and the library find them in this folder, see base/module: two versions of them do not mix.
install(TARGETS alidade_media alidade_bags alidade_dnn LIBRARY DESTINATION ${ALIDADE_MODULE_DIR})
if(TARGET alidade_serve)
  install(TARGETS alidade_serve LIBRARY DESTINATION ${ALIDADE_MODULE_DIR})
endif()

# The core for browsers, where scripts/wasm/build has built it: `alidade phone` serves it.
foreach(VARIANT single threads)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/build-wasm/${VARIANT}/bin/
          DESTINATION ${CMAKE_INSTALL_DATADIR}/alidade/core/${VARIANT} OPTIONAL
          FILES_MATCHING PATTERN alidade.wasm PATTERN alidade.mjs PATTERN alidade.worker.js)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/build-wasm/detector/bin/
        DESTINATION ${CMAKE_INSTALL_DATADIR}/alidade/core/detector OPTIONAL)

# Completions and manual pages: what the program says of itself.
if(TARGET alidade)
  install(CODE "set(ALIDADE_PROGRAM \"$<TARGET_FILE:alidade>\")
set(ALIDADE_SHARE \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
set(ALIDADE_MAN \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}\")
set(ALIDADE_BUILD \"${CMAKE_BINARY_DIR}\")")
  install(SCRIPT ${CMAKE_CURRENT_LIST_DIR}/InstallHelp.cmake)
endif()

configure_package_config_file(cmake/AlidadeConfig.cmake.in ${CMAKE_BINARY_DIR}/AlidadeConfig.cmake
                              INSTALL_DESTINATION ${ALIDADE_CMAKE_DIR} PATH_VARS ALIDADE_MODULE_DIR)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/AlidadeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/AlidadeConfig.cmake ${CMAKE_BINARY_DIR}/AlidadeConfigVersion.cmake
        DESTINATION ${ALIDADE_CMAKE_DIR})
list(TRANSFORM ALIDADE_PUBLIC_DEFINITIONS PREPEND -D OUTPUT_VARIABLE DEFINITIONS)
list(JOIN DEFINITIONS " " DEFINITIONS)
configure_file(cmake/alidade.pc.in ${CMAKE_BINARY_DIR}/alidade.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/alidade.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
