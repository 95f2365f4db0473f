# cmake -DWEB=web -DNPM=npm -DMODE=ON -DOUT=page_files.cc -P: builds the web pages and embeds them in a C++ file. On
# failure the build continues without the pages.
set(PROBLEM "")
set(MARK ${WEB}/node_modules/.alidade-lock)  # the lock file for which node_modules was installed

function(run)
  if(PROBLEM)
    return()
  endif()
  execute_process(COMMAND ${NPM} ${ARGN} WORKING_DIRECTORY ${WEB} RESULT_VARIABLE STATUS OUTPUT_VARIABLE TEXT
                  ERROR_VARIABLE TEXT TIMEOUT 600)
  if(NOT STATUS EQUAL 0)
    list(JOIN ARGN " " WHAT)
    file(WRITE ${OUT}.log "${TEXT}")
    set(PROBLEM "npm ${WHAT} failed, see ${OUT}.log" PARENT_SCOPE)
  endif()
endfunction()

if(NPM)
  file(SHA256 ${WEB}/package-lock.json LOCK)
  set(INSTALLED "")
  if(EXISTS ${MARK})
    file(READ ${MARK} INSTALLED)
  endif()
  if(NOT INSTALLED STREQUAL LOCK)
    run(ci --ignore-scripts --no-audit --no-fund)
    if(NOT PROBLEM)
      file(WRITE ${MARK} ${LOCK})
    endif()
  endif()
  run(run build)
elseif(MODE STREQUAL "PREBUILT")
  if(NOT EXISTS ${WEB}/viewer/dist/index.html)
    set(PROBLEM "there is no ${WEB}/viewer/dist")
  endif()
elseif(NOT MODE)
  set(PROBLEM "it was switched off (ALIDADE_WEB)")
else()
  set(PROBLEM "Node.js 18 with npm was not found (scripts/setup)")
endif()
if(PROBLEM)
  message("warning: built without the viewer's page: ${PROBLEM}; touch web/package.json to try again")
endif()

# Copies the files, because those in web/ change with the next build. Embeds them by assembler, because compiling an
# array of a million numbers takes seconds.
get_filename_component(FOLDER ${OUT} DIRECTORY)
set(FOLDER ${FOLDER}/page)
file(REMOVE_RECURSE ${FOLDER})
set(DATA "")
set(NAMES "")
set(NUMBER 0)
# Adds the files of web/PAGE/dist to DATA and NAMES, and their table to TABLE_<PAGE>.
foreach(PAGE viewer phone)
  set(FILES "")
  if(NOT PROBLEM)
    file(GLOB FILES ${WEB}/${PAGE}/dist/*)
  endif()
  set(TABLE_${PAGE} "")
  foreach(FILE ${FILES})
    get_filename_component(NAME ${FILE} NAME)
    file(COPY ${FILE} DESTINATION ${FOLDER}/${PAGE})
    file(SHA256 ${FILE} HASH)
    set(SYMBOL alidade_page_${NUMBER})
    string(APPEND DATA "// ${PAGE}/${NAME} ${HASH}
asm(R\"(
.pushsection .rodata
.hidden ${SYMBOL}
.hidden ${SYMBOL}_end
.global ${SYMBOL}
.global ${SYMBOL}_end
${SYMBOL}:
.incbin \"${FOLDER}/${PAGE}/${NAME}\"
${SYMBOL}_end:
.byte 0
.popsection
)\");
")
    string(APPEND NAMES "extern \"C\" [[gnu::visibility(\"hidden\")]] const char ${SYMBOL}[], ${SYMBOL}_end[];\n")
    string(APPEND TABLE_${PAGE} "      {\"${NAME}\", Between(${SYMBOL}, ${SYMBOL}_end)},\n")
    math(EXPR NUMBER "${NUMBER} + 1")
  endforeach()
endforeach()
file(WRITE ${OUT} "// Made by cmake/BuildViewerPage.cmake.
#include \"alidade/serve/response.h\"

${DATA}
${NAMES}
namespace alidade {
namespace {
[[maybe_unused]] std::string_view Between(const char* begin, const char* end) {
  return {begin, static_cast<size_t>(end - begin)};
}
}  // namespace
const std::vector<PageFile>& PageFiles() {
  static const std::vector<PageFile> files = {
${TABLE_viewer}  };
  return files;
}
const std::vector<PageFile>& PhoneFiles() {
  static const std::vector<PageFile> files = {
${TABLE_phone}  };
  return files;
}
}  // namespace alidade
")
