# cmake --install: the program, the portable floors, and what find_package(Alidade) needs.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(ALIDADE_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/Alidade)
get_property(ALIDADE_FLOORS GLOBAL PROPERTY ALIDADE_FLOORS)

# What users link: all the floors as Alidade::Alidade.
add_library(alidade_library INTERFACE)
target_link_libraries(alidade_library INTERFACE ${ALIDADE_FLOORS})
set_target_properties(alidade_library PROPERTIES EXPORT_NAME Alidade)

install(TARGETS alidade_library alidade_flags ${ALIDADE_FLOORS} EXPORT AlidadeTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT AlidadeTargets NAMESPACE Alidade:: DESTINATION ${ALIDADE_CMAKE_DIR})
install(DIRECTORY src/alidade DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h"
        PATTERN "base/module" EXCLUDE PATTERN "io/files" EXCLUDE PATTERN "io/media" EXCLUDE
        PATTERN "detect/onnx" EXCLUDE)
if(TARGET alidade)
  install(TARGETS alidade RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  add_dependencies(alidade alidade_media alidade_dnn)  # what is installed is built
  # The program finds them beside it, see base/module.
  install(TARGETS alidade_media alidade_dnn LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
endif()
configure_package_config_file(cmake/AlidadeConfig.cmake.in ${CMAKE_BINARY_DIR}/AlidadeConfig.cmake
                              INSTALL_DESTINATION ${ALIDADE_CMAKE_DIR})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/AlidadeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/AlidadeConfig.cmake ${CMAKE_BINARY_DIR}/AlidadeConfigVersion.cmake
        DESTINATION ${ALIDADE_CMAKE_DIR})
