# alidade_viewer_page(OUT): makes the C++ file OUT that holds the files of the pages (web/viewer/dist, web/phone/dist), which npm
# builds when Node.js is there; without, a plain page stands for it. Built again only when something in web/ has changed.
# PREBUILT takes the pages as they are in web/: where packages are built there is no network (scripts/package/build).
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
  # Not what npm puts there itself: node_modules, dist, generated.
  file(GLOB SOURCES CONFIGURE_DEPENDS ${WEB}/*.json ${WEB}/*/package.json ${WEB}/tools/* ${WEB}/scene/src/* ${WEB}/viewer/src/*
       ${WEB}/phone/src/* ${WEB}/core/src/*)
  set(SCRIPT ${PROJECT_SOURCE_DIR}/cmake/BuildViewerPage.cmake)
  add_custom_command(
    OUTPUT ${OUT}
    COMMAND ${CMAKE_COMMAND} -DWEB=${WEB} -DNPM=${NPM} -DMODE=${ALIDADE_WEB} -DOUT=${OUT} -P ${SCRIPT}
    DEPENDS ${SCRIPT} ${SOURCES} ${PROJECT_SOURCE_DIR}/src/alidade/stream/stream.fbs
    COMMENT "The viewer's page" VERBATIM)
endfunction()
