# alidade_schema(NAME FILE): compiles src/alidade/NAME/FILE.fbs to the header "alidade/NAME/FILE_generated.h", for
# alidade_NAME only. FlatBuffers is used header-only; its compiler runs on the build machine.
find_program(FLATC_PROGRAM flatc REQUIRED)
find_path(FLATBUFFERS_INCLUDE_DIR flatbuffers/flatbuffers.h PATHS /usr/include REQUIRED NO_CMAKE_FIND_ROOT_PATH)
# Only these headers, because a cross-compiler must not see others of /usr/include.
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/generated)
file(CREATE_LINK ${FLATBUFFERS_INCLUDE_DIR}/flatbuffers ${CMAKE_BINARY_DIR}/generated/flatbuffers SYMBOLIC)

function(alidade_schema NAME FILE)
  if(NOT TARGET alidade_${NAME})
    return()
  endif()
  set(SCHEMA ${CMAKE_CURRENT_SOURCE_DIR}/${NAME}/${FILE}.fbs)
  set(FOLDER ${CMAKE_BINARY_DIR}/generated/alidade/${NAME})
  add_custom_command(
    OUTPUT ${FOLDER}/${FILE}_generated.h
    COMMAND ${FLATC_PROGRAM} --cpp --gen-mutable --scoped-enums -o ${FOLDER} ${SCHEMA}
    DEPENDS ${SCHEMA} VERBATIM)
  target_sources(alidade_${NAME} PRIVATE ${FOLDER}/${FILE}_generated.h)
  target_include_directories(alidade_${NAME} SYSTEM PRIVATE ${CMAKE_BINARY_DIR}/generated)
endfunction()
