# One way to add a library: its name, its sources, and which of the project's libraries it may see.
#
#   placido_library(simulate SEES surface base SOURCES trace.c psf.c HEADERS simulate.h LINKS PkgConfig::fftw)
#
# FOLDER   where its private headers live, relative to the root (default: the name)
# HEADERS  the public headers in include/placido that belong to it
# The list is written to <build>/libraries.txt, which tests/architecture holds the includes against.
set_property(GLOBAL PROPERTY PLACIDO_LIBRARY_LINES "")

function(placido_library name)
  cmake_parse_arguments(arg "" "FOLDER" "SEES;SOURCES;HEADERS;LINKS" ${ARGN})
  if(NOT arg_FOLDER)
    set(arg_FOLDER ${name})
  endif()
  add_library(placido_${name} STATIC ${arg_SOURCES})
  target_include_directories(placido_${name} PUBLIC ${PROJECT_SOURCE_DIR}/include PRIVATE ${PROJECT_SOURCE_DIR})
  list(TRANSFORM arg_SEES PREPEND placido_ OUTPUT_VARIABLE seen)
  target_link_libraries(placido_${name} PUBLIC ${seen} PRIVATE placido_options ${arg_LINKS} m)
  string(JOIN "," sees ${arg_SEES})
  string(JOIN "," headers ${arg_HEADERS})
  set_property(GLOBAL APPEND PROPERTY PLACIDO_LIBRARY_LINES "${name}|${arg_FOLDER}|${sees}|${headers}")
endfunction()

# The public headers of the libraries named.
function(placido_library_headers result)
  get_property(lines GLOBAL PROPERTY PLACIDO_LIBRARY_LINES)
  set(headers "")
  foreach(line ${lines})
    string(REPLACE "|" ";" fields "${line}")
    list(GET fields 0 name)
    if(name IN_LIST ARGN)
      list(GET fields 3 some)
      string(REPLACE "," ";" some "${some}")
      list(APPEND headers ${some})
    endif()
  endforeach()
  set(${result} ${headers} PARENT_SCOPE)
endfunction()

function(placido_write_library_list)
  get_property(lines GLOBAL PROPERTY PLACIDO_LIBRARY_LINES)
  list(JOIN lines "\n" text)
  file(WRITE ${PROJECT_BINARY_DIR}/libraries.txt "${text}\n")
endfunction()

# placido_test(NAME SOURCES... LINKS libraries...): a cmocka program under CTest.
function(placido_test name)
  cmake_parse_arguments(arg "" "TIMEOUT" "SOURCES;LINKS;LABELS" ${ARGN})
  add_executable(test_${name} ${arg_SOURCES})
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(test_${name} PRIVATE
    PLACIDO_TEST_DATA="${PROJECT_SOURCE_DIR}/tests/data"
    PLACIDO_SHARED="${PROJECT_SOURCE_DIR}/../shared"
    PLACIDO_PROGRAM="$<TARGET_FILE_DIR:placido>/placido")
  target_link_libraries(test_${name} PRIVATE placido_options ${arg_LINKS} PkgConfig::cmocka m)
  add_test(NAME ${name} COMMAND test_${name})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS "${arg_LABELS}")
endfunction()
