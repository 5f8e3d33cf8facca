# Decides whether ranks are connected by MPI (PTEXP_MPI). MPI_C_COMPILER chooses one of several
# (mpicc.openmpi, mpicc.mpich): its C interface is all that is used.
set(PTEXP_MPI_FOUND FALSE)
if(NOT PTEXP_MPI STREQUAL "OFF")
  enable_language(C)  # FindMPI asks for it
  set(MPI_CXX_SKIP_MPICXX TRUE)
  # Its own mpiexec, which starts the tests.
  if(MPI_C_COMPILER MATCHES "mpicc(\\.[a-z]+)$")
    find_program(MPIEXEC_EXECUTABLE mpiexec${CMAKE_MATCH_1})
  endif()
  if(PTEXP_MPI STREQUAL "ON")
    find_package(MPI REQUIRED COMPONENTS C)
  else()
    find_package(MPI QUIET COMPONENTS C)
  endif()
  set(PTEXP_MPI_FOUND ${MPI_C_FOUND})
  if(PTEXP_MPI_FOUND)
    message(STATUS "Building with MPI (${MPI_C_COMPILER}, ${MPIEXEC_EXECUTABLE})")
  else()
    message(STATUS "Building without MPI: none was found")
  endif()
endif()
