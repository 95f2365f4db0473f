# Installs the API headers of ALIDADE_SOURCES/alidade to ALIDADE_INCLUDES.
file(GLOB_RECURSE HEADERS RELATIVE ${ALIDADE_SOURCES} ${ALIDADE_SOURCES}/alidade/*.h)
foreach(HEADER ${HEADERS})
  file(STRINGS ${ALIDADE_SOURCES}/${HEADER} MARK REGEX "^namespace ALIDADE_API ")
  if(MARK OR HEADER MATCHES "^alidade/(slam|version|base/api)\\.h$")
    get_filename_component(FOLDER ${HEADER} DIRECTORY)
    file(INSTALL ${ALIDADE_SOURCES}/${HEADER} DESTINATION ${ALIDADE_INCLUDES}/${FOLDER})
  endif()
endforeach()
