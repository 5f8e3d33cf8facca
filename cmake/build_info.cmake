# Run at every build: writes build_info.cpp with the commit, only when it has changed. An archive has
# it in a file, which git archive fills in, and may lie in a repository that it does not belong to.
file(READ ${SOURCE_DIR}/cmake/archive_commit.txt archive)
if(archive MATCHES "^([0-9a-f]+) ([0-9-]+)")
  string(SUBSTRING ${CMAKE_MATCH_1} 0 12 commit)
  set(date ${CMAKE_MATCH_2})
else()
  execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty --abbrev=12
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND git -C ${SOURCE_DIR} log -1 --format=%cs
                  OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
foreach(fact commit date)
  if(NOT ${fact})
    set(${fact} unknown)
  endif()
endforeach()
configure_file(${SOURCE_DIR}/cmake/build_info.cpp.in ${OUTPUT} @ONLY)
