# Decides whether grids of .nvdb files can be read (PTEXP_NANOVDB): NanoVDB is headers alone, and its
# files may be packed by blosc.
set(PTEXP_NANOVDB_FOUND FALSE)
if(NOT PTEXP_NANOVDB STREQUAL "OFF")
  find_path(PTEXP_NANOVDB_INCLUDE nanovdb/util/IO.h)
  find_path(PTEXP_BLOSC_INCLUDE blosc.h)
  find_library(PTEXP_BLOSC_LIBRARY blosc)
  if(PTEXP_NANOVDB_INCLUDE AND PTEXP_BLOSC_INCLUDE AND PTEXP_BLOSC_LIBRARY)
    set(PTEXP_NANOVDB_FOUND TRUE)
    add_library(ptexp_nanovdb INTERFACE)
    target_include_directories(ptexp_nanovdb SYSTEM INTERFACE
                               ${PTEXP_NANOVDB_INCLUDE} ${PTEXP_BLOSC_INCLUDE})
    target_link_libraries(ptexp_nanovdb INTERFACE ${PTEXP_BLOSC_LIBRARY})
    message(STATUS "Building with NanoVDB (${PTEXP_NANOVDB_INCLUDE}/nanovdb)")
  elseif(PTEXP_NANOVDB STREQUAL "ON")
    message(FATAL_ERROR "PTEXP_NANOVDB=ON: nanovdb/util/IO.h or blosc.h was not found; install "
                        "libnanovdb-dev and libblosc-dev")
  else()
    message(STATUS "Building without NanoVDB: nanovdb/util/IO.h or blosc.h was not found")
  endif()
endif()
