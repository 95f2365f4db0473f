# alidade_viewer_page(OUT): generates the C++ file OUT with the files of the pages (web/viewer/dist, web/phone/dist).
# They are built with npm if Node.js is available, else replaced by a plain page, and rebuilt when files in web/ change.
# PREBUILT uses existing pages in web/, for package builds without network access (scripts/package/build).
set(ALIDADE_WEB ON CACHE STRING "ON: build the pages with npm; PREBUILT: take those in web/*/dist; OFF: none")

function(alidade_viewer_page OUT)
  set(WEB ${PROJECT_SOURCE_DIR}/web)
  set(NPM "")
  if(ALIDADE_WEB AND NOT ALIDADE_WEB STREQUAL "PREBUILT")
    find_program(NODE_PROGRAM NAMES node nodejs)
    find_program(NPM_PROGRAM npm)
    if(NODE_PROGRAM AND NPM_PROGRAM AND EXISTS ${WEB}/package-lock.json)
      execute_process(COMMAND ${NODE_PROGRAM} --version OUTPUT_VARIABLE VERSION OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
      string(REGEX REPLACE "^v" "" VERSION "${VERSION}")
      if(VERSION VERSION_GREATER_EQUAL 18)
        set(NPM ${NPM_PROGRAM})
      endif()
    endif()
  endif()
  # Without the folders created by npm: node_modules, dist, generated.
  file(GLOB SOURCES LIST_DIRECTORIES false CONFIGURE_DEPENDS ${WEB}/*.json ${WEB}/*/package.json ${WEB}/tools/* ${WEB}/scene/src/* ${WEB}/shared/src/*
       ${WEB}/viewer/src/* ${WEB}/phone/src/* ${WEB}/core/src/*)
  set(SCRIPT ${PROJECT_SOURCE_DIR}/cmake/BuildViewerPage.cmake)
  add_custom_command(
    OUTPUT ${OUT}
    COMMAND ${CMAKE_COMMAND} -DWEB=${WEB} -DNPM=${NPM} -DMODE=${ALIDADE_WEB} -DOUT=${OUT} -P ${SCRIPT}
    DEPENDS ${SCRIPT} ${SOURCES} ${PROJECT_SOURCE_DIR}/src/alidade/stream/stream.fbs
            ${PROJECT_SOURCE_DIR}/src/alidade/tracking/track_failure.h ${PROJECT_SOURCE_DIR}/src/alidade/tracking/track_failure.cc
            ${PROJECT_SOURCE_DIR}/wasm/frame_numbers.h
    COMMENT "The viewer's page" VERBATIM)
endfunction()
